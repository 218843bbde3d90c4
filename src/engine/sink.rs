//! Where the rows and the outcome of a run go: a file, memory, a socket, whatever implements
//! [`Sink`].

use super::{Asked, Outcome};
use crate::scenario::Scenario;
use crate::stats::BlockResult;
use std::time::Duration;

/// Why a sink cannot go on.
pub type SinkError = Box<dyn std::error::Error + Send + Sync>;

/// Is handed every finished block of a run in the order of its paths, and the outcome. The first
/// error ends the run.
///
/// ```
/// use stick_slip::engine::{Run, Sink, SinkError};
/// use stick_slip::scenario::Scenario;
/// use stick_slip::stats::BlockResult;
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
    /// A run of this scenario begins, or goes on.
    fn begin(&mut self, scenario: &Scenario, asked: &Asked) -> Result<(), SinkError> {
        let _ = (scenario, asked);
        Ok(())
    }

    /// The next block is finished. Its totals are empty where a crew of several processes simulates
    /// the run: the sums of many blocks then come in one piece, as part of [`Moment::state`].
    fn block(&mut self, block: &BlockResult) -> Result<(), SinkError>;

    /// Where other processes may write what is kept of the paths that they simulate, in words that
    /// only the sink and its kin understand. Those blocks are not handed over. Most sinks have no
    /// such place.
    fn outlet(&mut self) -> Option<Vec<u8>> {
        None
    }

    /// Another process has written there, and this is the receipt that it was given. All that was
    /// handed over or written so far belongs to the blocks that are summed up.
    fn left_in_outlet(&mut self, receipt: &[u8]) -> Result<(), SinkError> {
        let _ = receipt;
        Ok(())
    }

    /// Every block that it was handed is summed up. It is told so after each of them, and once more
    /// when the paths are done: whoever keeps what a run can go on from should do so seldom.
    fn save(&mut self, moment: &Moment<'_>) -> Result<(), SinkError> {
        let _ = moment;
        Ok(())
    }

    /// The run is over.
    fn finish(&mut self, outcome: &Outcome) -> Result<(), SinkError> {
        let _ = outcome;
        Ok(())
    }
}

/// A run between two blocks.
pub struct Moment<'a> {
    /// Time spent so far, that of earlier sittings included.
    pub spent: Duration,
    /// Paths that are summed up, those of earlier sittings included.
    pub paths: u64,
    /// Whether no more blocks follow.
    pub is_last: bool,
    pub(super) state: &'a dyn Fn() -> Vec<u8>,
}

impl Moment<'_> {
    /// The sums so far as bytes, which [`crate::stats::RunTotals::read`] turns into the same bits.
    pub fn state(&self) -> Vec<u8> {
        (self.state)()
    }
}

/// Keeps the rows of a run in memory: what `scenario.record` asks for, block by block.
///
/// ```
/// use stick_slip::engine::{Memory, Run};
/// use stick_slip::scenario::Scenario;
///
/// let mut scenario = Scenario::shipped("shaw")?;
/// scenario.record.events = true;
/// let mut memory = Memory::default();
/// Run::of(&scenario).into_sink(&mut memory).simulate()?;
/// let events = memory.blocks[0].events.as_ref().expect("the scenario asks for them");
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
