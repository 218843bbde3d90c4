//! A run in progress: blocks are passed to the sinks, summed and judged, until all are done or
//! something ends the run earlier.

use super::ending::{Endings, Judgement};
use super::{Asked, EndedBy, Moment, Outcome, Progress, RunError, Sink, SinkError};
use crate::ensemble::{BLOCK_SIZE, Delivered};
use crate::stats::RunTotals;
use crate::sums::Merge;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The wall-clock time of a run, together with that of the processes that began it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Elapsed {
    before: Duration,
    start: Instant,
}

impl Elapsed {
    pub fn after(before: Duration) -> Self {
        Elapsed {
            before,
            start: Instant::now(),
        }
    }

    pub fn spent(&self) -> Duration {
        self.before + self.start.elapsed()
    }
}

/// The progress of a run, and what has ended it.
pub(super) struct Course<'r, 's, X> {
    pub asked: &'r Asked,
    pub endings: &'r Endings,
    /// Makes the threads give up their unfinished blocks.
    pub halt: &'r AtomicBool,
    pub clock: Elapsed,
    pub progress: &'r mut dyn Progress,
    pub sinks: Vec<&'s mut dyn Sink>,
    pub totals: RunTotals<X>,
    /// What ended the run before its last block.
    pub ended_by: Option<EndedBy>,
    /// The error of a sink, which ends the run as well.
    pub broken: Option<SinkError>,
    /// Whether a portion is being taken. After a panic, the totals may then be inconsistent.
    pub is_taking: bool,
}

impl<X: Merge + Clone> Course<'_, '_, X> {
    /// The remaining blocks. There are none if an earlier process reached the end of the run but
    /// was interrupted before it could finish.
    pub fn left(&mut self) -> Range<u64> {
        let Range { start, end } = self.asked.blocks();
        let first = self.done();
        match self.judge(first) {
            Judgement::Stop(reason) if first > start => {
                self.ended_by = Some(reason);
                first..first
            }
            _ => first..end,
        }
    }

    /// The number of the first block that is not done. Blocks are done in order, so the finished
    /// ones are the first.
    pub fn done(&self) -> u64 {
        self.totals
            .blocks()
            .last()
            .map_or(self.asked.blocks().start, |done| done.end)
    }

    /// Whether the run ends after this many blocks.
    fn judge(&self, blocks: u64) -> Judgement {
        match self.endings.judge(blocks, &self.totals, self.clock.spent()) {
            // A run whose blocks are all done needs no more time.
            Judgement::Stop(EndedBy::TimeLimit { blocks }) if blocks == self.asked.blocks().end => {
                Judgement::GoOn(None)
            }
            look => look,
        }
    }

    /// The number of paths of this run before the end of a block.
    fn paths_before(&self, end: u64) -> u64 {
        let first = self.asked.blocks().start * BLOCK_SIZE;
        (end * BLOCK_SIZE)
            .min(self.asked.paths)
            .saturating_sub(first)
    }

    /// Take the next block, and return whether more are wanted.
    pub fn deliver(&mut self, block: Delivered<X>) -> Result<ControlFlow<()>, RunError> {
        self.is_taking = true;
        let taken = self.take(block);
        self.is_taking = false;
        taken
    }

    fn take(&mut self, block: Delivered<X>) -> Result<ControlFlow<()>, RunError> {
        let Delivered {
            index,
            result,
            auxiliary_sums,
            ..
        } = block;
        let end = index + 1;
        let handed = self
            .sinks
            .iter_mut()
            .try_for_each(|sink| sink.block(&result));
        self.totals
            .push_with(index, result.totals, auxiliary_sums)?;
        if let Err(error) = handed.and_then(|()| self.save(end, false)) {
            self.broken = Some(error);
            return Ok(self.stop());
        }
        if let Some(statistic) = self.progress.watches() {
            self.progress.estimate(&self.totals.estimate(statistic));
        }
        Ok(match self.judge(end) {
            Judgement::GoOn(needed) => {
                let all = self.asked.own_paths();
                self.progress
                    .paths(self.paths_before(end), needed.unwrap_or(all).min(all));
                ControlFlow::Continue(())
            }
            Judgement::Stop(reason) => {
                self.ended_by = Some(reason);
                self.stop()
            }
        })
    }

    fn stop(&self) -> ControlFlow<()> {
        self.halt.store(true, Ordering::Relaxed);
        ControlFlow::Break(())
    }

    /// Let the sinks save the state of the run after this block.
    fn save(&mut self, end: u64, is_last: bool) -> Result<(), SinkError> {
        let (spent, paths) = (self.clock.spent(), self.paths_before(end));
        let moment = Moment {
            spent,
            paths,
            is_last,
            state: &|| self.totals.to_bytes(),
        };
        self.sinks
            .iter_mut()
            .try_for_each(|sink| sink.save(&moment))
    }

    /// No more blocks come after this one.
    pub fn settle(&mut self, end: u64) {
        self.totals.settle();
        if self.broken.is_none() && !self.is_taking {
            self.broken = self.save(end, true).err();
        }
    }

    /// Pass the outcome to the sinks.
    pub fn finish(&mut self, outcome: &Outcome) {
        if self.broken.is_none() {
            self.broken = self
                .sinks
                .iter_mut()
                .try_for_each(|sink| sink.finish(outcome))
                .err();
        }
    }
}
