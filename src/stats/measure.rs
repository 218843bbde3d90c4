//! The measures of a run. Each has its sums over paths in its own file, and computes its statistics
//! from them.
//!
//! ```text
//! cascade     sticks, slips, jumps and work        periods     x from period to period
//! laws        of slips, jumps, recurrences         energy      the work of every force
//! extremes    largest |x - x0| and |x'|
//! ```

use super::Statistic;
use crate::scheme::Timeline;
use crate::sums::Replicate;
use crate::sums::interval::Measured;

/// Sums over paths from which some of the statistics follow.
pub(super) trait Measure {
    /// A statistic with its interval; none if it belongs to another measure.
    fn measured(&self, statistic: Statistic, of: &Sampled) -> Option<Measured>;
}

/// Common properties of the summed paths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sampled<'a> {
    pub timeline: &'a Timeline,
    pub unit: Replicate,
}
