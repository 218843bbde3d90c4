//! Stability at the extremes: what is predicted happens, what is refused says why, and nothing in
//! between is silent nonsense.
//!
//! ```text
//! stability       where the explicit step grows and where it does not, predicted and shown
//! equal_friction  f_s = f_d under noise: what has a limit as the resolution gets finer, and what has not
//! long_runs       1e9 steps, 1e6 forcing periods, 300 days
//! survey          scenarios at random over 24 decades of every parameter
//!   draw            one scenario, as a user would write it
//!   invariants      what holds on every path of every scheme, checked by an observer
//! ```
//!
//! docs/extremes.md says the same for users.

#[path = "../common/mod.rs"]
mod common;

mod draw;
mod equal_friction;
mod invariants;
mod long_runs;
mod stability;
mod survey;
