//! Statistics of the cascade: folded over one block of paths, merged along a binary tree of blocks,
//! and summed up with intervals.
//!
//! ```text
//! BlockObserver   watches one block of paths (implements scheme::Observer)
//!   -> BlockResult   the result of the block: Totals, and what is kept of each path on request
//!        -> RunTotals     the tree of sums over blocks: push, merge, write, read
//!             -> Totals::summary -> Summary   estimates, intervals, bands, histograms
//! Tally            a statistic of a user's own, folded beside them
//! ```
//!
//! Floating-point sums are formed path by path in time order, then over the paths of a block in
//! order, then over blocks along a binary tree; counts are integers. So no statistic depends on the
//! threads, the lanes, the vector width, or the way in which a run is cut into parts.

mod bands;
mod batches;
mod bins;
mod catalogue;
mod certain;
mod codec;
mod corrected;
mod dimension;
mod durations;
mod dyadic;
mod goal;
mod groups;
mod interval;
pub(crate) mod jackknife;
mod log_bins;
mod moments;
mod observer;
mod ordered;
mod path;
mod period_displacements;
mod periods;
mod quantile;
mod range;
mod rare;
mod record;
mod run_totals;
mod settling;
mod sketch;
mod spread;
mod steps;
mod summary;
mod survival;
#[cfg(test)]
mod synthetic;
mod tally;
mod totals;
mod tree;
mod unit;

pub use catalogue::Statistic;
pub use codec::{Codec, Damaged, Reader};
pub use corrected::Corrected;
pub use dimension::{Dimension, Units};
pub use goal::{Bound, Goal, GoalError, Verdict};
pub use groups::{GROUPS, Grouping, Groups, Values};
pub(crate) use interval::student;
pub use moments::Moments;
pub use observer::BlockObserver;
pub use record::{BlockResult, EventColumns, PathColumns, Record, TrajectoryRows};
pub use run_totals::RunTotals;
pub use summary::{
    Band, Bands, Bias, Ends, Estimate, Histogram, Measurement, PeriodMoments, QUANTILE_LEVELS, StickDurations,
    SubPhaseCounts, Summary, Transient,
};
pub use tally::{Companion, PathMeans, PathState, Tallied, Tally};
pub use totals::{Counts, SUB_PHASE_CAP, Sums, Totals};
pub use tree::{Merge, Overlap, Tree};
pub use unit::Unit;
