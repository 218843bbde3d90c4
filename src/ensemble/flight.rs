//! Neighbouring blocks that are simulated together. Each block has its own observer.
//!
//! Some schemes advance all their paths together over one cell of time after the other. Such a
//! scheme fills its registers better with more paths than a block has. The sums and files of a
//! block do not depend on whether it is simulated with others.

use crate::model::Event;
use crate::scheme::{Instant, Observer, Snapshot};

/// The observers of the blocks. All blocks are full except perhaps the last one.
pub(super) struct Flight<O> {
    pub blocks: Vec<O>,
    /// Number of paths of a full block. Lane i of the flight is lane `i % lanes` of block `i /
    /// lanes`.
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
