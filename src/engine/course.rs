//! A run while it is simulated: portions are passed to the sinks, summed and judged, until all
//! blocks are done or something ends the run earlier.

use super::ending::{Endings, Look};
use super::{Asked, EndedBy, Moment, Outcome, Portion, Progress, RunError, Sink, SinkError};
use crate::ensemble::BLOCK_SIZE;
use crate::stats::{Counts, RunTotals};
use crate::sums::Merge;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The wall-clock time of a run, together with that of the processes that began it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    before: Duration,
    start: Instant,
}

impl Clock {
    pub fn after(before: Duration) -> Self {
        Clock { before, start: Instant::now() }
    }

    pub fn spent(&self) -> Duration {
        self.before + self.start.elapsed()
    }
}

/// What a run has come to, and what has ended it.
pub(super) struct Course<'r, 's, X> {
    asked: &'r Asked,
    endings: &'r Endings,
    /// Makes the threads give up their unfinished blocks.
    halt: &'r AtomicBool,
    clock: Clock,
    progress: &'r mut dyn Progress,
    sinks: Vec<&'s mut dyn Sink>,
    pub totals: RunTotals<X>,
    /// The counts of the blocks that were done before.
    counts: Counts,
    /// What ended the run before its last block.
    pub ended_by: Option<EndedBy>,
    /// The error of a sink, which ends the run as well.
    pub broken: Option<SinkError>,
    /// Whether a portion is being taken. After a panic, the totals may then be half done.
    is_taking: bool,
}

impl<'r, 's, X: Merge + Clone> Course<'r, 's, X> {
    pub fn new(
        asked: &'r Asked,
        endings: &'r Endings,
        halt: &'r AtomicBool,
        clock: Clock,
        progress: &'r mut dyn Progress,
        sinks: Vec<&'s mut dyn Sink>,
        totals: RunTotals<X>,
    ) -> Self {
        let counts = totals.counts().clone();
        Course {
            asked,
            endings,
            halt,
            clock,
            progress,
            sinks,
            totals,
            counts,
            ended_by: None,
            broken: None,
            is_taking: false,
        }
    }

    /// The blocks that are left. None are if an earlier process reached the end of the run, and was
    /// interrupted before it could finish.
    pub fn left(&mut self) -> Range<u64> {
        let Range { start, end } = self.asked.blocks();
        let first = self.done();
        match self.look(first) {
            Look::Stop(reason) if first > start => {
                self.ended_by = Some(reason);
                first..first
            }
            _ => first..end,
        }
    }

    /// The number of the first block that is not done. Blocks are done in order, so those that are
    /// done are the first ones.
    pub fn done(&self) -> u64 {
        self.totals.blocks().last().map_or(self.asked.blocks().start, |done| done.end)
    }

    /// Where other processes may write rows. Each sink would need such a place of its own, so there
    /// is one only if there is a single sink.
    pub fn outlet(&mut self) -> Option<Vec<u8>> {
        if let [sink] = self.sinks.as_mut_slice() { sink.outlet() } else { None }
    }

    /// Whether the run ends after this many blocks.
    fn look(&self, blocks: u64) -> Look {
        match self.endings.look(blocks, &self.totals, self.clock.spent()) {
            // A run of which all blocks are done needs no more time.
            Look::Stop(EndedBy::TimeLimit { blocks }) if blocks == self.asked.blocks().end => Look::GoOn(None),
            look => look,
        }
    }

    /// The number of paths of this run before the end of a block.
    fn paths_before(&self, end: u64) -> u64 {
        let first = self.asked.blocks().start * BLOCK_SIZE;
        (end * BLOCK_SIZE).min(self.asked.paths).saturating_sub(first)
    }

    /// Take the next portion, and say whether more are wanted.
    pub fn deliver(&mut self, portion: Portion<X>) -> Result<ControlFlow<()>, RunError> {
        self.is_taking = true;
        let taken = self.take(portion);
        self.is_taking = false;
        taken
    }

    fn take(&mut self, portion: Portion<X>) -> Result<ControlFlow<()>, RunError> {
        let end = portion.end();
        let handed = self.hand_on(&portion);
        portion.add_to(&mut self.totals, &self.counts)?;
        if let Err(error) = handed.and_then(|()| self.save(end, false)) {
            self.broken = Some(error);
            return Ok(self.stop());
        }
        if let Some(statistic) = self.progress.watches() {
            self.progress.estimate(&self.totals.estimate(statistic));
        }
        Ok(match self.look(end) {
            Look::GoOn(needed) => {
                let all = self.asked.own_paths();
                self.progress.paths(self.paths_before(end), needed.unwrap_or(all).min(all));
                ControlFlow::Continue(())
            }
            Look::Stop(reason) => {
                self.ended_by = Some(reason);
                self.stop()
            }
        })
    }

    fn stop(&self) -> ControlFlow<()> {
        self.halt.store(true, Ordering::Relaxed);
        ControlFlow::Break(())
    }

    fn hand_on(&mut self, portion: &Portion<X>) -> Result<(), SinkError> {
        for block in portion.results() {
            self.sinks.iter_mut().try_for_each(|sink| sink.block(block))?;
        }
        for receipt in portion.receipts() {
            self.sinks.iter_mut().try_for_each(|sink| sink.left_in_outlet(receipt))?;
        }
        Ok(())
    }

    /// Let the sinks save the run as it is after this block.
    fn save(&mut self, end: u64, is_last: bool) -> Result<(), SinkError> {
        let (spent, paths) = (self.clock.spent(), self.paths_before(end));
        let moment = Moment { spent, paths, is_last, state: &|| self.totals.to_bytes() };
        self.sinks.iter_mut().try_for_each(|sink| sink.save(&moment))
    }

    /// No more portions come after this block.
    pub fn settle(&mut self, end: u64) {
        self.totals.settle();
        if self.broken.is_none() && !self.is_taking {
            self.broken = self.save(end, true).err();
        }
    }

    /// Pass the outcome to the sinks.
    pub fn finish(&mut self, outcome: &Outcome) {
        if self.broken.is_none() {
            self.broken = self.sinks.iter_mut().try_for_each(|sink| sink.finish(outcome)).err();
        }
    }

    pub fn progress(&mut self) -> &mut dyn Progress {
        self.progress
    }
}
