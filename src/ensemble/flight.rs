//! Neighbouring blocks that are simulated together. Each block has its own observer.
//!
//! Some schemes advance all their paths together over one cell of time after the other. Such a
//! scheme fills its registers better with more paths than a block has. The sums and files of a
//! block do not depend on whether it is simulated with others.

use crate::model::Event;
use crate::scheme::{Glide, Instant, Observer, Snapshot};

/// The observers of the blocks. All blocks have `LANES` paths except perhaps the last one, which
/// may have fewer. Lane i of the flight is lane `i % LANES` of block `i / LANES`; since the number
/// is a constant, this takes no division.
pub(super) struct Flight<O, const LANES: usize>(pub Vec<O>);

impl<O: Observer, const LANES: usize> Observer for Flight<O, LANES> {
    #[inline]
    fn event(&mut self, lane: usize, event: Event) {
        self.0[lane / LANES].event(lane % LANES, event);
    }

    fn follows(&self) -> bool {
        self.0.iter().any(Observer::follows)
    }

    fn glide(&mut self, lane: usize, glide: &Glide) {
        self.0[lane / LANES].glide(lane % LANES, glide);
    }

    fn snapshot(&mut self, instant: Instant, all: Snapshot<'_>) {
        for (block, observer) in self.0.iter_mut().enumerate() {
            let first = block * LANES;
            let lanes = first..all.displacement.len().min(first + LANES);
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
