//! Stability at the extremes: what is predicted happens, what is refused is explained, and no
//! result is wrong without a warning.
//!
//! ```text
//! stability       where the explicit step diverges and where it does not, predicted and simulated
//! equal_friction  f_s = f_d under noise: which statistics have a limit at fine resolution
//! long_runs       1e9 steps, 1e6 forcing periods, 300 days
//! survey          random scenarios over 24 decades of every parameter
//!   draw            one scenario, as a user would write it
//!   invariants      what holds on every path of every scheme, checked by an observer
//! ```
//!
//! docs/model.md and docs/event-driven.md describe this for users, and docs/validation.md lists the
//! tests.

#[path = "../common/mod.rs"]
mod common;

mod draw;
mod equal_friction;
mod invariants;
mod long_runs;
mod stability;
mod stopped;
mod survey;
