//! Statistics of the cascade: folded over one block of paths, merged in block order, summed up with intervals.
//!
//! ```text
//! BlockObserver   watches one block of paths (implements scheme::Observer)
//!   -> BlockResult   what the block leaves behind: Totals, and what was asked to be kept of each path
//!        -> Totals::merge, in block order
//!             -> Totals::summary -> Summary   estimates, intervals, bands, histograms
//! ```
//!
//! Floating-point sums are formed path by path in time order, then over the paths of a block in order, then over blocks
//! in order; counts are integers. So no statistic depends on threads, lanes or vector width.

mod bands;
mod catalogue;
mod durations;
mod goal;
mod interval;
pub(crate) mod jackknife;
mod moments;
mod observer;
mod path;
mod periods;
mod record;
mod sketch;
mod summary;
#[cfg(test)]
mod synthetic;
mod totals;

pub use catalogue::{Dimension, Statistic};
pub use goal::{Bound, Goal, GoalError, Verdict};
pub use moments::Moments;
pub use observer::BlockObserver;
pub use record::{BlockResult, EventColumns, PathColumns, Record, TrajectoryRows};
pub use summary::{
    Band, Bands, Bias, Estimate, Histogram, PeriodMoments, QUANTILE_LEVELS, StickDurations, SubPhaseCounts, Summary,
};
pub use totals::{SUB_PHASE_CAP, Totals};
