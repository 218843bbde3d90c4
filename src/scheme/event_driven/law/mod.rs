//! The laws of a path between two times at which it is known, whatever the order of computation.
//!
//! ```text
//! scene, two_noises     the constants of a scene, with noise measured as a force
//! step_grid, macro_step the macro steps, and the forcing in them
//! step_rules            the step lengths that follow from the tolerance
//! stick_band,           a stick between two values of n: may it be left, is it, and when?
//!   stick_step
//! slip_transition,      an exact step of (x, x', n) in a slip
//!   slip_step
//! first_stop,           a slip between two known states: does it stop, and where?
//!   velocity_bounds
//! inside                the state at an instant between two known ones
//! ```

mod first_stop;
mod forced_step;
mod inside;
mod macro_step;
mod scene;
mod slip_step;
mod slip_transition;
mod step_grid;
mod step_rules;
mod stick_band;
mod stick_step;
#[cfg(test)]
pub mod tests;
mod two_noises;
mod velocity_bounds;

pub use first_stop::*;
pub use forced_step::*;
pub use inside::*;
pub use macro_step::*;
pub use scene::*;
pub use slip_step::*;
pub use slip_transition::*;
pub use step_grid::*;
pub use step_rules::*;
pub use stick_band::*;
pub use stick_step::*;
