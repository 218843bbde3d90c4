//! The buffers of a snapshot, for the schemes that simulate events.

use super::Snapshot;
use crate::lanes::{Lanes, ROW};

/// x, x', T and whether the path is static.
pub(super) type Seen = (f64, f64, f64, bool);

/// The observed state of a path that was given up.
pub(super) const LOST: Seen = (f64::NAN, f64::NAN, f64::NAN, false);

/// The state of every path at one time, one entry a lane.
#[derive(Clone, Debug)]
pub(super) struct StateColumns {
    lanes: usize,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    temperature: Vec<f64>,
    is_static: Vec<bool>,
}

impl StateColumns {
    /// Buffers for `lanes` lanes.
    pub(super) fn new(lanes: usize) -> Self {
        // There is room for a whole register at the end.
        let zeros = vec![0.0; lanes + ROW];
        StateColumns {
            lanes,
            displacement: zeros.clone(),
            velocity: zeros.clone(),
            temperature: zeros,
            is_static: vec![true; lanes + ROW],
        }
    }

    /// Sets x, x', T and whether the path is static, for one lane.
    pub(super) fn set(&mut self, lane: usize, (x, v, temperature, is_static): Seen) {
        self.displacement[lane] = x;
        self.velocity[lane] = v;
        self.temperature[lane] = temperature;
        self.is_static[lane] = is_static;
    }

    /// Sets x, x', T and whether the paths are static (one bit a path), for a register of lanes
    /// from `lane` on.
    #[inline(always)]
    pub(super) fn set_lanes<L: Lanes>(
        &mut self,
        lane: usize,
        (x, v, temperature): (L, L, L),
        is_static: u32,
    ) {
        x.store(&mut self.displacement[lane..]);
        v.store(&mut self.velocity[lane..]);
        temperature.store(&mut self.temperature[lane..]);
        for (i, to) in self.is_static[lane..lane + L::WIDTH].iter_mut().enumerate() {
            *to = is_static >> i & 1 == 1;
        }
    }

    /// Sets the same values for every lane.
    pub(super) fn fill(&mut self, (x, v, temperature, is_static): Seen) {
        self.displacement.fill(x);
        self.velocity.fill(v);
        self.temperature.fill(temperature);
        self.is_static.fill(is_static);
    }

    /// The buffers as the snapshot that an observer receives.
    pub(super) fn snapshot(&self, time: f64) -> Snapshot<'_> {
        Snapshot {
            time,
            displacement: &self.displacement[..self.lanes],
            velocity: &self.velocity[..self.lanes],
            temperature: &self.temperature[..self.lanes],
            is_static: &self.is_static[..self.lanes],
        }
    }
}
