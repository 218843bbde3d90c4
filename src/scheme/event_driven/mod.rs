//! Scheme B: event-driven, the paper's step-by-step construction of stick and slip phases.
//!
//! Without diffusion every phase is a closed form and every event a root: [`Noiseless`].

mod draws;
mod exact_time;
mod first_root;
#[cfg(test)]
mod harness;
mod noiseless;
mod scene;
mod stick;

pub use noiseless::Noiseless;
