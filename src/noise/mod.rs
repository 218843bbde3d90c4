//! Randomness: the random numbers of a path, normals by inversion, and the exact laws of the
//! Ornstein-Uhlenbeck process and its bridges.

mod addressed;
mod bent_threshold;
mod first_passage;
mod mirror;
mod normal;
mod ornstein_uhlenbeck;
mod rng;
mod stream;

pub use addressed::AddressedDraws;
pub use addressed::{LaneDraws, observation_place};
pub use bent_threshold::BentThreshold;
pub use first_passage::{
    Distances, first_meeting_probability, meeting_probability, misses_other, no_meeting_probability,
};
pub use mirror::{MIRROR, antithetic};
pub use normal::cells;
pub use normal::{MAX_NORMAL_ERROR, standard_normal};
pub use ornstein_uhlenbeck::Transition;
pub use ornstein_uhlenbeck::{
    TimeChange, bridge_at, bridge_middle, increment_variance, short_bridge_at, short_bridge_middle,
};
pub use stream::LaneNormals;
pub use stream::{LaneStreams, Stream};

/// The description of the random numbers in files.
pub const GENERATOR: &str = "schemes with a step: xoshiro256+, one stream a path seeded by SplitMix64 from (seed, path); \
    others: SplitMix64 with two keys from (seed, path), at addresses (cell, place); normals by inversion";
