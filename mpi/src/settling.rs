//! Blocks that have come back to rank 0 and wait for their counts, before they are delivered to the
//! run.
//!
//! A saved run consists of the sums of some blocks and of the counts of exactly these blocks. Sums
//! come back with each lease. Counts are large, so they are sent seldom: rank 0 asks all ranks for
//! the counts of their blocks before a certain block, and delivers the blocks before it when every
//! rank has answered. Meanwhile the ranks continue with later blocks.

use super::lease::Stretch;
use super::snapshots::Counted;
use std::time::{Duration, Instant};
use stick_slip::engine::Portion;
use stick_slip::ensemble::Plan;
use stick_slip::stats::Counts;
use stick_slip::sums::Overlap;

/// The shortest time between two questions for counts. A run is saved after each of them, so a
/// crash loses the work of this time, of the time until all ranks have answered, and of the leases
/// that are being simulated.
const SHORTEST: Duration = Duration::from_secs(1);

/// Rank 0 spends at most one part in this many of its time on merging the counts of all ranks.
const PART: u32 = 20;

/// Number of bytes of rows at which counts are asked for before the shortest time is over.
const MOST: usize = 64 << 20;

/// Takes blocks in their order, and returns them together with their counts.
pub(super) struct Settling<'a> {
    plan: &'a Plan,
    ranks: usize,
    /// Blocks for whose counts the ranks have not been asked yet; `bytes` are the bytes of their
    /// rows.
    open: Option<Stretch>,
    bytes: usize,
    waiting: Option<Waiting>,
    /// When counts were last asked for.
    last: Instant,
    /// The time that the last merging of counts took.
    cost: Duration,
}

/// Blocks for whose counts the ranks have been asked.
struct Waiting {
    stretch: Stretch,
    /// The merged counts of the ranks that have answered.
    counts: Counts,
    receipts: Vec<Vec<u8>>,
    answers: usize,
    cost: Duration,
}

impl<'a> Settling<'a> {
    /// With no blocks yet, for this number of ranks.
    pub fn new(plan: &'a Plan, ranks: usize) -> Self {
        Settling { plan, ranks, open: None, bytes: 0, waiting: None, last: Instant::now(), cost: Duration::ZERO }
    }

    /// Whether no block waits for its counts.
    pub fn is_empty(&self) -> bool {
        self.open.is_none() && self.waiting.is_none()
    }

    /// Take the next blocks, with the number of bytes of their rows.
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

    /// If counts are to be asked for now, begin to wait for them, and return the block before which
    /// all blocks are to be counted. `is_last` states that no block follows.
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

    /// Take the answer of a rank, which is `None` if it has done none of these blocks. After the
    /// last answer, return the blocks with their counts.
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
