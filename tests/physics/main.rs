//! The schemes compared with what they were not derived from: closed forms, other programs, and
//! each other. No test here writes a file or starts a process.

#[path = "../common/mod.rs"]
mod common;

mod absorbed;
mod all_schemes;
mod corrected_vi;
mod damping;
mod discrete_vi;
mod event_driven;
mod event_driven_limits;
mod general_force;
mod identities;
mod initial_velocity;
mod inputs;
mod laws;
mod load;
mod measures;
mod motion;
mod noise;
mod quasi_static;
mod random_inputs;
mod reference;
mod series;
mod two_noises;
mod white;
