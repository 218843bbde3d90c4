//! Neighbouring blocks that are simulated together. Each block has its own observer.
//!
//! Some schemes advance all their paths together, one macro step after the other. More paths than
//! in a block fill the registers better. The sums and files of a block do not depend on whether it
//! is simulated with others.

use crate::model::{Event, Problem};
use crate::scheme::{Instant, Observer, Segment, Snapshot};

/// The observers of blocks of `lanes` paths each, except perhaps the last one, which may have
/// fewer. Lane i of the flight is lane `i % lanes` of block `i / lanes`.
pub(crate) struct Flight<O> {
    pub observers: Vec<O>,
    pub lanes: usize,
}

impl<O: Observer> Observer for Flight<O> {
    #[inline]
    fn event(&mut self, lane: usize, event: Event) {
        self.observers[lane / self.lanes].event(lane % self.lanes, event);
    }

    fn realised(&mut self, lane: usize, model: &Problem) {
        self.observers[lane / self.lanes].realised(lane % self.lanes, model);
    }

    fn follows(&self) -> bool {
        self.observers.iter().any(Observer::follows)
    }

    fn segment(&mut self, lane: usize, segment: &Segment) {
        self.observers[lane / self.lanes].segment(lane % self.lanes, segment);
    }

    fn snapshot(&mut self, instant: Instant, all: Snapshot<'_>) {
        let all_lanes = all.displacement.len();
        for (observer, first) in self.observers.iter_mut().zip((0..).step_by(self.lanes)) {
            let lanes = first..all_lanes.min(first + self.lanes);
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
