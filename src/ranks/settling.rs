//! Blocks that have come back to rank 0, on their way to a run that can be saved.
//!
//! What is saved of a run are the sums of some blocks and the counts of just these blocks. Sums come
//! back with each lease. Counts are large, so they come seldom: rank 0 asks all ranks for their
//! counts of the blocks before a certain one, and hands the blocks on when every rank has answered.
//! Meanwhile the ranks go on with later blocks.

use super::lease::Stretch;
use super::snapshots::Counted;
use crate::engine::Portion;
use crate::ensemble::Plan;
use crate::stats::{Counts, Overlap};
use std::time::{Duration, Instant};

/// The shortest time between two questions. A run is saved after each of them, so that this, and
/// the time until all have answered, is what a crash loses beside the leases in work.
const SHORTEST: Duration = Duration::from_secs(1);

/// Joining the counts of all ranks takes at most one part in so many of the time of rank 0.
const PART: u32 = 20;

/// Blocks are handed on when they have so many bytes of rows, however short the time.
const MOST: usize = 64 << 20;

/// Takes blocks in their order, and hands them on with their counts.
pub(super) struct Settling<'a> {
    plan: &'a Plan,
    ranks: usize,
    /// Blocks of which no counts were asked for, and the bytes of their rows.
    open: Option<Stretch>,
    bytes: usize,
    waiting: Option<Waiting>,
    /// When counts were asked for last.
    last: Instant,
    /// Time that it took to join them, the last time that it was done.
    cost: Duration,
}

/// Blocks whose counts were asked for.
struct Waiting {
    stretch: Stretch,
    /// Those of the ranks that have answered.
    counts: Counts,
    receipts: Vec<Vec<u8>>,
    answers: usize,
    cost: Duration,
}

impl<'a> Settling<'a> {
    /// For so many ranks.
    pub fn new(plan: &'a Plan, ranks: usize) -> Self {
        Settling { plan, ranks, open: None, bytes: 0, waiting: None, last: Instant::now(), cost: Duration::ZERO }
    }

    /// Whether every block was handed on.
    pub fn is_empty(&self) -> bool {
        self.open.is_none() && self.waiting.is_none()
    }

    /// Take the next blocks, whose rows have so many bytes.
    pub fn add(&mut self, stretch: Stretch, bytes: usize) -> Result<(), Overlap> {
        self.bytes += bytes;
        match &mut self.open {
            None => self.open = Some(stretch),
            Some(open) => {
                open.blocks.end = stretch.blocks.end;
                open.results.extend(stretch.results);
                open.totals.merge(stretch.totals)?;
            }
        }
        Ok(())
    }

    /// The block before which all counts are to be asked for now, if they are; `is_last` says that
    /// no block follows.
    pub fn ask(&mut self, is_last: bool) -> Option<u64> {
        let is_due = is_last || self.bytes >= MOST || self.last.elapsed() >= SHORTEST.max(self.cost * PART);
        if !is_due || self.waiting.is_some() {
            return None;
        }
        let stretch = self.open.take()?;
        (self.bytes, self.last) = (0, Instant::now());
        let end = stretch.blocks.end;
        let counts = Counts::empty(self.plan.model(), self.plan.timeline());
        self.waiting = Some(Waiting { stretch, counts, receipts: Vec::new(), answers: 0, cost: Duration::ZERO });
        Some(end)
    }

    /// Take the answer of a rank. The last answer makes a portion for the run.
    pub fn take(&mut self, counted: Option<Counted>) -> Option<Portion> {
        let start = Instant::now();
        let waiting = self.waiting.as_mut()?;
        if let Some(Counted { counts, receipt }) = counted {
            waiting.counts.merge(&counts);
            waiting.receipts.extend((!receipt.is_empty()).then_some(receipt));
        }
        waiting.answers += 1;
        waiting.cost += start.elapsed();
        if waiting.answers < self.ranks {
            return None;
        }
        let Waiting { stretch: Stretch { blocks, results, totals }, counts, receipts, cost, .. } =
            self.waiting.take()?;
        self.cost = cost;
        Some(Portion::Stretch { blocks, results, receipts, sums: Box::new(totals), counts: Box::new(counts) })
    }
}
