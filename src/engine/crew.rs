//! Who simulates the blocks of a run: the threads of this process, or a crew of several processes.

use super::{Asked, RunError};
use crate::ensemble::{Delivered, Plan, Stops};
use crate::scenario::Scenario;
use crate::stats::{BlockResult, Companion, Counts, Merge, Overlap, RunTotals};
use std::ops::{ControlFlow, Range};
use std::slice;

/// What there is to do.
#[derive(Clone, Debug)]
pub struct Work<'a> {
    /// What is simulated.
    pub scenario: &'a Scenario,
    /// What else is asked of the run.
    pub asked: &'a Asked,
    /// The ensemble that the two make.
    pub plan: &'a Plan,
    /// The blocks that are left.
    pub blocks: Range<u64>,
    /// Threads of a process.
    pub threads: usize,
    /// When to end before the last of them.
    pub stops: Stops<'a>,
    /// Where the sink of the run lets other processes write, if it does ([`super::Sink::outlet`]).
    pub outlet: Option<Vec<u8>>,
}

/// Blocks that are done, on their way to whoever sums and keeps them.
#[derive(Clone, Debug)]
pub enum Portion<X = ()> {
    /// One block.
    Block(Box<Delivered<X>>),
    /// Neighbouring blocks, whose sums come in one piece.
    Stretch {
        /// Their numbers.
        blocks: Range<u64>,
        /// What is kept of their paths, block by block, unless it was left in the outlet of the
        /// sink; their totals are empty.
        results: Vec<BlockResult>,
        /// Receipts of processes that have left something there.
        receipts: Vec<Vec<u8>>,
        /// What they sum to, without counts.
        sums: Box<RunTotals<X>>,
        /// The counts of all blocks that the crew has delivered, these included.
        counts: Box<Counts>,
    },
}

/// Takes portions in the order of their blocks; says whether there are to be more.
pub type Deliver<'a, X = ()> = dyn FnMut(Portion<X>) -> Result<ControlFlow<()>, RunError> + Send + 'a;

/// Simulates blocks, and delivers all of them in order.
///
/// Whoever makes a block makes the same bits, and sums of any blocks can be joined to the bits of
/// the whole, so no number depends on the crew.
pub trait Crew<X = ()> {
    /// Do the work, until all of it is delivered, `deliver` breaks or fails, or a stop is raised.
    /// Returns the number of blocks delivered.
    fn simulate(&self, work: &Work<'_>, deliver: &mut Deliver<'_, X>) -> Result<u64, RunError>;

    /// Threads of all processes together, given those of one.
    fn threads(&self, of_one: usize) -> usize {
        of_one
    }
}

/// The threads of this process, with a companion that watches every block.
pub(super) struct Threads<'a, C>(pub &'a C);

impl<C: Companion> Crew<C::Sums> for Threads<'_, C> {
    fn simulate(&self, work: &Work<'_>, deliver: &mut Deliver<'_, C::Sums>) -> Result<u64, RunError> {
        let Work { plan, blocks, threads, stops, .. } = work;
        let deliver = |block: Delivered<C::Sums>| deliver(Portion::Block(Box::new(block)));
        plan.run_beside(self.0, blocks.clone(), *threads, *stops, deliver)
    }
}

impl<X: Merge + Clone> Portion<X> {
    /// What is kept of its paths, block by block.
    pub(super) fn results(&self) -> &[BlockResult] {
        match self {
            Portion::Block(block) => slice::from_ref(&block.result),
            Portion::Stretch { results, .. } => results,
        }
    }

    /// Receipts for what was left in the outlet of the sink.
    pub(super) fn receipts(&self) -> &[Vec<u8>] {
        match self {
            Portion::Block(_) => &[],
            Portion::Stretch { receipts, .. } => receipts,
        }
    }

    /// How many blocks it is.
    pub fn blocks(&self) -> u64 {
        match self {
            Portion::Block(_) => 1,
            Portion::Stretch { blocks, .. } => blocks.end - blocks.start,
        }
    }

    /// The number of the block after it.
    pub(super) fn end(&self) -> u64 {
        match self {
            Portion::Block(block) => block.index + 1,
            Portion::Stretch { blocks, .. } => blocks.end,
        }
    }

    /// Add it to the totals of a run, which had these counts before the crew began.
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
