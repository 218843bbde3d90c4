//! Sums over paths, and the intervals that follow from them, independent of sticks and slips.
//!
//! ```text
//! moments, spread, rare      means, standard deviations and fourth powers of numbers per path
//! merge, tree                partial sums, merged along a binary tree over blocks
//! codec                      sums as bytes
//! dyadic, bins, log_scale    exact counts in bins, which merge in any order
//! sketch, ordered, steps     many numbers in order, in bounded memory
//! grid, fourier              counts of pairs in cells of a plane, and the discrete Fourier transform
//! batches, jackknife         groups of paths, and the errors that follow from their scatter
//! interval, range, quantile  an estimate with its 95 % interval
//! measurement                plain numbers and curves with their intervals
//! replicate                  what is independent: a path, or a pair of paths
//! ```

pub(crate) mod batches;
pub(crate) mod bins;
pub(crate) mod codec;
#[cfg(test)]
#[path = "tests/coverage.rs"]
pub(crate) mod coverage;
pub(crate) mod dyadic;
pub(crate) mod fourier;
pub(crate) mod grid;
pub(crate) mod interval;
pub(crate) mod jackknife;
pub(crate) mod log_scale;
mod measurement;
mod merge;
pub(crate) mod moments;
pub(crate) mod ordered;
pub(crate) mod quantile;
pub(crate) mod range;
pub(crate) mod rare;
mod replicate;
pub(crate) mod sketch;
pub(crate) mod spread;
pub(crate) mod steps;
mod tree;

pub use codec::{Codec, Damaged, Reader};
pub use measurement::{Ends, Measurement};
pub use merge::Merge;
pub use moments::Moments;
pub use replicate::Replicate;
pub use tree::{Overlap, Tree};
