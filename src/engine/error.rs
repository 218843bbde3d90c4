//! The errors of a run.

use super::{Outcome, SinkError};
use crate::ensemble::{Flaw, ThreadsError};
use crate::scheme::CheckError;
use crate::sums::Overlap;

/// Why a run has no outcome, or why its outcome could not be stored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// A value of the scenario is out of its range, or values cannot be used together. Nothing was
    /// begun.
    #[error("{0}")]
    Scenario(#[from] CheckError),
    /// A sink failed. What happens to the blocks that it received before depends on the sink.
    #[error("{error}")]
    Sink {
        /// The error of the sink.
        error: SinkError,
        /// The outcome of the paths that were simulated before; `None` if the run had not begun.
        outcome: Option<Box<Outcome>>,
    },
    /// The system cannot start this number of threads. Nothing was begun.
    #[error("{0}")]
    Threads(#[from] ThreadsError),
    /// A thread has panicked. The blocks before were passed to the sinks like those of a run that is
    /// interrupted.
    #[error("{flaw}")]
    Flaw {
        /// The panic.
        flaw: Flaw,
        /// The outcome of the paths that were simulated before.
        outcome: Box<Outcome>,
    },
    /// The motion of a path was requested, but the path is lost.
    #[error("path {path} is lost: {why}")]
    Lost {
        /// The number of the path.
        path: u64,
        /// Why it is.
        why: String,
    },
    /// A block was delivered twice, which is a bug in this program.
    #[error("internal error: {0}")]
    Overlap(#[from] Overlap),
}
