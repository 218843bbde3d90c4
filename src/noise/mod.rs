//! Randomness: one stream a path, normals by inversion, the Ornstein-Uhlenbeck process exactly.

mod normal;
mod normal_table;
mod ornstein_uhlenbeck;
mod stream;

pub use normal::{MAX_NORMAL_ERROR, standard_normal};
pub use ornstein_uhlenbeck::Transition;
pub use stream::{LaneStreams, Stream};

/// What a file says about where its random numbers come from.
pub const GENERATOR: &str =
    "xoshiro256+, one stream a path seeded by SplitMix64 from (seed, path); normals by inversion";
