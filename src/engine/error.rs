//! Why a run comes to nothing.

use super::{Outcome, SinkError};
use crate::stats::Overlap;

/// Why a run has no outcome.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A sink failed. What it was handed before is its own.
    #[error("{error}")]
    Sink {
        /// What it says.
        error: SinkError,
        /// What was simulated nevertheless; nothing where the run had not begun.
        outcome: Option<Box<Outcome>>,
    },
    /// A block was delivered twice: a flaw of this program.
    #[error("a flaw in the program: {0}")]
    Overlap(#[from] Overlap),
}
