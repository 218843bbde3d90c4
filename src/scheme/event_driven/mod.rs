//! Scheme B: event-driven, the paper's step-by-step construction of stick and slip phases.
//!
//! Without diffusion every phase is a closed form and every event a root: [`Noiseless`]. With it, phases are simulated in
//! law: [`Noisy`].

mod draws;
mod exact_time;
mod first_root;
mod first_stop;
#[cfg(test)]
mod harness;
mod noiseless;
mod noisy;
mod scene;
mod stick;

pub use noiseless::Noiseless;
pub use noisy::Noisy;
