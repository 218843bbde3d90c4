//! Without noise and with any force: phases are integrated to rounding, or nearly so, and events
//! are roots.
//!
//! ```text
//! cascade       the one path that there is, segment by segment
//!   forces        b(x, x', t), near a time
//!   slip_motion   a slip by extrapolation, with steps that adapt to the force
//!   collocation   the same where damping is far faster than the motion
//!   slip_search   the first zero of the velocity in a step
//!   stick_search  the first time at which a force that depends on time exceeds f_s
//! ```

mod cascade;
mod collocation;
mod forces;
mod slip_motion;
mod slip_search;
mod stick_search;
#[cfg(test)]
mod tests;

pub use cascade::GeneralNoiseless;
