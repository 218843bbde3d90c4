//! Randomness: one stream a path, normals by inversion, the Ornstein-Uhlenbeck process exactly.

mod stream;

pub use stream::Stream;
