//! Statistics of the cascade: folded over one block of paths, merged along a binary tree of blocks,
//! and summed up with intervals.
//!
//! ```text
//! BlockObserver   watches one block of paths (implements scheme::Observer)
//!   -> BlockResult   the result of the block: Totals, and what is kept of each path on request
//!        -> RunTotals     the tree of sums over blocks: push, merge, write, read
//!             -> Totals::summary -> Summary   estimates, intervals, bands, histograms
//! Tally            a user-defined statistic, folded with them
//! ```
//!
//! Floating-point sums are formed path by path in time order, then over the paths of a block in
//! order, then over blocks along a binary tree; counts are integers. So no statistic depends on the
//! threads, the lanes, the vector width, or the way in which a run is cut into parts.

mod absence;
mod bands;
mod cascade;
mod catalogue;
pub mod column;
mod corrected;
mod cycle;
mod density;
mod deterministic;
mod dimension;
mod energy;
mod extremes;
mod folds;
mod goal;
mod groups;
mod law;
mod law_counts;
mod laws;
mod measure;
mod motion;
mod need;
mod observer;
mod path;
mod period_displacements;
mod periods;
mod record;
mod request;
mod run_totals;
mod settling;
mod spectrum;
mod sub_phases;
mod summary;
mod survival;
#[cfg(test)]
#[path = "tests/synthetic.rs"]
mod synthetic;
mod tally;
mod totals;

pub use catalogue::Statistic;
pub(crate) use catalogue::StepError;
pub use corrected::Corrected;
pub use cycle::{LimitCycle, Repeats};
pub use dimension::{Dimension, Units};
pub use goal::{Bound, Goal, GoalError, Verdict};
pub use groups::{GROUPS, GroupValues, Grouping, Groups};
pub use law::PhaseLaw;
pub use observer::BlockObserver;
pub use record::{BlockResult, BlockRows, EventColumns, PathColumns, TrajectoryRows};
pub use record::{EVENT_COUNT, ON_THE_GRID};
pub use request::{PassageLevels, Record};
pub use run_totals::RunTotals;
pub use sub_phases::SUB_PHASE_CAP;
pub use summary::{
    Band, Bands, Bias, Densities, DensityCurve, Distribution, Estimate, Extremes, FirstSticks,
    Fluctuations, Histogram, Line, Passages, PeriodMoments, QUANTILE_LEVELS, Spectrum,
    SubPhaseCounts, Summary, Transient,
};
pub use tally::{AuxiliaryObserver, PathMeans, PathState, Tallied, Tally};
pub use totals::{Counts, Sums, Totals};
