//! Randomness: one stream a path, normals by inversion, the Ornstein-Uhlenbeck process exactly.

mod first_passage;
mod slip_transition;
mod stream;

pub use first_passage::{mean_touching_spread, meeting_place, meeting_probability};
pub use slip_transition::{DrivenOscillator, HarmonicResponse, SlipTransition};
pub use stream::Stream;
