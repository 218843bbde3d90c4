//! Why a scenario cannot be measured.

use crate::scheme::CheckError;

/// Why nothing can be measured.
#[derive(Debug, thiserror::Error)]
pub enum TradeError {
    /// A scheme is inconsistent with the scenario.
    #[error(transparent)]
    CheckError(#[from] CheckError),
    /// The duration of the scenario, `time.end`, is 0.
    #[error("`time.end` = 0 leaves nothing to compare; it must be above 0")]
    NothingHappens,
    /// Not even the reference fits into the budget.
    #[error(
        "an event-driven path takes about {path_seconds:.3} s of CPU time, so {least} paths do not fit into the budget"
    )]
    BudgetTooSmall {
        /// CPU seconds of a path.
        path_seconds: f64,
        /// Number of paths needed.
        least: u64,
    },
}
