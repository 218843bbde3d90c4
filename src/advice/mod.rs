//! Facts about a scenario that are known before it is run. These are pure functions of the
//! scenario; nothing is simulated.
//!
//! ```text
//! derived     derived quantities: ratios, limits of the step, cost
//!   amplitude   the expected amplitude of the body
//!   size        the size of the file
//! warnings    warnings
//! ```

mod amplitude;
mod derived;
mod size;
#[cfg(test)]
mod tests;
mod warnings;

pub use derived::{Derived, DerivedQuantity};
pub use warnings::{Class, Warning};
