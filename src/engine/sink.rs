//! The destinations of the rows and of the outcome of a run: a file, memory, a socket, or anything
//! else that implements [`Sink`].

use super::{Asked, Outcome};
use crate::scenario::Scenario;
use crate::stats::BlockResult;
use std::time::Duration;

/// Why a sink cannot continue.
pub type SinkError = Box<dyn std::error::Error + Send + Sync>;

/// Receives every finished block of a run, in the order of its paths, and the outcome. The first
/// error ends the run.
///
/// ```
/// use stickslip::engine::{Run, Sink, SinkError};
/// use stickslip::scenario::Scenario;
/// use stickslip::stats::BlockResult;
///
/// /// Prints how many paths of each block diverged.
/// struct Divergence(Vec<usize>);
///
/// impl Sink for Divergence {
///     fn block(&mut self, block: &BlockResult) -> Result<(), SinkError> {
///         self.0.push(block.diverged.len());
///         Ok(())
///     }
/// }
///
/// let mut scenario = Scenario::shipped("rho025")?;
/// scenario.ensemble.paths = 600;
/// let mut divergence = Divergence(Vec::new());
/// Run::of(&scenario).into_sink(&mut divergence).simulate()?;
/// assert_eq!(divergence.0, [0, 0, 0]); // blocks of 256, 256 and 88 paths
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Sink: Send {
    /// A run of this scenario begins or is continued.
    fn begin(&mut self, _scenario: &Scenario, _asked: &Asked) -> Result<(), SinkError> {
        Ok(())
    }

    /// The next block is finished.
    fn block(&mut self, _block: &BlockResult) -> Result<(), SinkError> {
        Ok(())
    }

    /// All received blocks are summed up. This is called after each block, and again when the paths
    /// are done. A sink that saves the run should do so only from time to time.
    fn save(&mut self, _moment: &Moment<'_>) -> Result<(), SinkError> {
        Ok(())
    }

    /// The run is over, with this outcome.
    fn finish(&mut self, _outcome: &Outcome) -> Result<(), SinkError> {
        Ok(())
    }
}

/// The state of a run between two blocks.
pub struct Moment<'a> {
    /// Wall-clock time spent so far, including that before an interruption.
    pub spent: Duration,
    /// Number of summed paths, including those before an interruption.
    pub paths: u64,
    /// Whether no more blocks follow.
    pub is_last: bool,
    pub(super) state: &'a dyn Fn() -> Vec<u8>,
}

impl Moment<'_> {
    /// The sums so far as bytes, from which [`crate::stats::RunTotals::read`] restores the same
    /// bits.
    pub fn state(&self) -> Vec<u8> {
        (self.state)()
    }
}

/// Keeps the rows of a run in memory, block by block. `record` in the scenario determines which
/// rows there are.
///
/// ```
/// use stickslip::engine::{Memory, Run};
/// use stickslip::scenario::Scenario;
///
/// let mut scenario = Scenario::shipped("shaw")?;
/// scenario.record.events = true;
/// let mut memory = Memory::default();
/// Run::of(&scenario).into_sink(&mut memory).simulate()?;
/// let events = memory.blocks[0].rows.events.as_ref().expect("the scenario asks for them");
/// assert!((events.time[0] - 2.574).abs() < 0.02); // the first slip of Shaw's case
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Memory {
    /// Every block, in the order of its paths.
    pub blocks: Vec<BlockResult>,
}

impl Sink for Memory {
    fn block(&mut self, block: &BlockResult) -> Result<(), SinkError> {
        self.blocks.push(block.clone());
        Ok(())
    }
}
