//! What follows from a scenario before it is run. These are pure functions of the scenario; nothing
//! is simulated.
//!
//! ```text
//! derived     quantities that follow from it: ratios, limits of the step, cost
//!   amplitude   how far the body may be expected to move
//!   size        how large the file will be
//! warnings    what to know before trusting the run
//! ```

mod amplitude;
mod derived;
mod size;
#[cfg(test)]
mod tests;
mod warnings;

pub use derived::{Derived, DerivedQuantity};
pub use warnings::{Class, Warning};
