//! The laws: what holds between two times at which a path is known, in whatever order paths are
//! worked on.
//!
//! ```text
//! scene, two_noises     the constants of a scene, with noise measured as a force
//! ladder, cells         the cells of time, and the forcing in them
//! step_rules            the step lengths that follow from the tolerance
//! band, stick_step  a stick between two values of n: may it be left, is it, and when?
//! slip_transition,      an exact step of (x, x', n) in a slip
//!   slip_step
//! first_stop,           a slip between two known states: does it stop, and where?
//!   velocity_bounds
//! inside                the state at an instant between two known ones
//! ```

mod cells;
mod first_stop;
mod inside;
mod ladder;
mod scene;
mod slip_step;
mod slip_transition;
mod step_rules;
mod stick_band;
mod stick_step;
#[cfg(test)]
pub mod tests;
mod two_noises;
mod velocity_bounds;

pub use cells::*;
pub use first_stop::*;
pub use inside::*;
pub use ladder::*;
pub use scene::*;
pub use slip_step::*;
pub use slip_transition::*;
pub use step_rules::*;
pub use stick_band::*;
pub use stick_step::*;
