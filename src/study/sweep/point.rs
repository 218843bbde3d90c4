//! The stored results of a point of a sweep.

use crate::stats::{Estimate, GroupValues, LimitCycle, Statistic};

/// The results at one point.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The estimates of a run of the point's scenario, one for each of `Statistic::ALL`, in that
    /// order.
    pub estimates: [Estimate; Statistic::ALL.len()],
    /// Number of paths simulated, including diverged ones.
    pub completed_paths: u64,
    /// Number of paths that diverged or were given up; they are not part of any statistic.
    pub diverged_paths: u64,
    /// CPU seconds that the point took.
    pub seconds: f64,
    /// The long-term motion, if nothing is random.
    pub cycle: Option<LimitCycle>,
    /// For each group of paths, the values of all statistics without that group.
    pub without: Vec<GroupValues>,
}
