//! A crew simulates the blocks of a run: the threads of this process, or several processes.

use super::{Asked, RunError};
use crate::ensemble::{Delivered, Plan, Stops};
use crate::scenario::Scenario;
use crate::stats::{BlockResult, Companion, Counts, RunTotals};
use crate::sums::{Merge, Overlap};
use std::ops::{ControlFlow, Range};
use std::slice;

/// What a crew is to do.
#[derive(Clone, Debug)]
pub struct Work<'a> {
    /// What is simulated.
    pub scenario: &'a Scenario,
    /// What is asked of the run besides its scenario.
    pub asked: &'a Asked,
    /// The ensemble that follows from the scenario and from what is asked.
    pub plan: &'a Plan,
    /// The blocks that have not been simulated yet.
    pub blocks: Range<u64>,
    /// Number of threads of each process.
    pub threads: usize,
    /// Flags that end the work before the last block.
    pub stops: Stops<'a>,
    /// Where other processes may write rows, if the sink of the run has such a place
    /// ([`super::Sink::outlet`]).
    pub outlet: Option<Vec<u8>>,
}

/// Simulated blocks, as a crew delivers them.
#[derive(Clone, Debug)]
pub enum Portion<X = ()> {
    /// One block.
    Block(Box<Delivered<X>>),
    /// Neighbouring blocks, whose sums are merged.
    Stretch {
        /// The numbers of the blocks.
        blocks: Range<u64>,
        /// What is recorded of the paths, block by block, unless it was written to the outlet of
        /// the sink. The totals of these blocks are empty.
        results: Vec<BlockResult>,
        /// The receipts of the processes that have written to the outlet.
        receipts: Vec<Vec<u8>>,
        /// The sums of the blocks, without counts.
        sums: Box<RunTotals<X>>,
        /// The counts of all blocks that the crew has delivered, including these.
        counts: Box<Counts>,
    },
}

/// Takes portions in the order of their blocks, and returns whether more are wanted.
pub type Deliver<'a, X = ()> = dyn FnMut(Portion<X>) -> Result<ControlFlow<()>, RunError> + Send + 'a;

/// Simulates blocks, and delivers all of them in order.
///
/// A block has the same bits on whichever thread or process it is simulated, and sums of any blocks
/// can be merged to the bits of the whole, so no number depends on the crew.
pub trait Crew<X = ()> {
    /// Do the work, until all blocks are delivered, `deliver` breaks or fails, or a flag of
    /// `work.stops` is set. Returns the number of delivered blocks. An error is that of `deliver`,
    /// or one of the crew.
    fn simulate(&self, work: &Work<'_>, deliver: &mut Deliver<'_, X>) -> Result<u64, RunError>;

    /// Number of threads of all processes together, given that of one process.
    fn threads(&self, of_one: usize) -> usize {
        of_one
    }
}

/// The threads of this process, with a companion that observes every block.
pub(super) struct Threads<'a, C>(pub &'a C);

impl<C: Companion> Crew<C::Sums> for Threads<'_, C> {
    fn simulate(&self, work: &Work<'_>, deliver: &mut Deliver<'_, C::Sums>) -> Result<u64, RunError> {
        let Work { plan, blocks, threads, stops, .. } = work;
        let deliver = |block: Delivered<C::Sums>| deliver(Portion::Block(Box::new(block)));
        plan.run_beside(self.0, blocks.clone(), *threads, *stops, deliver)
    }
}

impl<X: Merge + Clone> Portion<X> {
    /// What is recorded of the paths, block by block.
    pub(super) fn results(&self) -> &[BlockResult] {
        match self {
            Portion::Block(block) => slice::from_ref(&block.result),
            Portion::Stretch { results, .. } => results,
        }
    }

    /// The receipts for what was written to the outlet of the sink.
    pub(super) fn receipts(&self) -> &[Vec<u8>] {
        match self {
            Portion::Block(_) => &[],
            Portion::Stretch { receipts, .. } => receipts,
        }
    }

    /// Number of blocks.
    pub fn blocks(&self) -> u64 {
        match self {
            Portion::Block(_) => 1,
            Portion::Stretch { blocks, .. } => blocks.end - blocks.start,
        }
    }

    /// The number of the block after the last one.
    pub(super) fn end(&self) -> u64 {
        match self {
            Portion::Block(block) => block.index + 1,
            Portion::Stretch { blocks, .. } => blocks.end,
        }
    }

    /// Add the blocks to the totals of a run. `before` are the counts that the totals had before
    /// the crew began.
    pub(super) fn add_to(self, totals: &mut RunTotals<X>, before: &Counts) -> Result<(), Overlap> {
        match self {
            Portion::Block(block) => totals.push_with(block.index, block.result.totals, block.beside),
            Portion::Stretch { sums, mut counts, .. } => {
                totals.merge(*sums)?;
                counts.merge(before);
                totals.set_counts(*counts);
                Ok(())
            }
        }
    }
}
