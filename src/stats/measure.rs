//! What a run measures: a list of measures, each of which has its sums over paths in a file of its
//! own, and knows the statistics that follow from them.
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
    /// A statistic with its interval; none if it is of another measure.
    fn measured(&self, statistic: Statistic, of: &Sampled) -> Option<Measured>;
}

/// What the paths that were summed have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sampled<'a> {
    pub timeline: &'a Timeline,
    pub unit: Replicate,
}
