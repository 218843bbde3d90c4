//! Randomness: one stream a path, normals by inversion, the Ornstein-Uhlenbeck process exactly.

mod first_passage;
mod stream;

pub use first_passage::{mean_touching_spread, meeting_place, meeting_probability};
pub use stream::Stream;
