//! Neighbouring blocks that are simulated together, each watched by its own observer.
//!
//! A scheme that takes all its paths across a cell of time together fills its registers better the
//! more paths there are. What a block is for sums and files does not change with it.

use crate::model::Event;
use crate::scheme::{Instant, Observer, Snapshot};

/// The observers of blocks in flight, all of them full but for the last.
pub(super) struct Flight<O> {
    pub blocks: Vec<O>,
    /// The paths of a full block: lane i of the flight is lane `i % lanes` of block `i / lanes`.
    pub lanes: usize,
}

impl<O: Observer> Observer for Flight<O> {
    #[inline]
    fn event(&mut self, lane: usize, event: Event) {
        self.blocks[lane / self.lanes].event(lane % self.lanes, event);
    }

    fn snapshot(&mut self, instant: Instant, all: Snapshot<'_>) {
        for (block, observer) in self.blocks.iter_mut().enumerate() {
            let first = block * self.lanes;
            let lanes = first..all.displacement.len().min(first + self.lanes);
            let snapshot = Snapshot {
                time: all.time,
                displacement: &all.displacement[lanes.clone()],
                velocity: &all.velocity[lanes.clone()],
                temperature: &all.temperature[lanes.clone()],
                is_static: &all.is_static[lanes],
            };
            observer.snapshot(instant, snapshot);
        }
    }
}
