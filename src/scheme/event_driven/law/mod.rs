//! The laws: what holds between two times at which a path is known, in whatever order paths are
//! worked on.
//!
//! ```text
//! scene, two_noises     the constants of a scene, with noise measured as a force
//! ladder, cells         the cells of time, and the forcing in them
//! step_rules            the step lengths that follow from the tolerance
//! corridor, stick_step  a stick between two values of n: may it be left, is it, and when?
//! slip_transition,      an exact step of (x, x', n) in a slip
//!   slip_step
//! first_stop,           a slip between two known states: does it stop, and where?
//!   velocity_bounds
//! inside                the state at an instant between two known ones
//! ```

pub mod cells;
pub mod corridor;
pub mod first_stop;
pub mod inside;
pub mod ladder;
pub mod scene;
pub mod slip_step;
pub mod slip_transition;
pub mod step_rules;
pub mod stick_step;
#[cfg(test)]
pub mod tests;
pub mod two_noises;
mod velocity_bounds;
