//! The share of the counted time that the body spends in each part of its phase plane.
//!
//! Times are those along the motion ([`Glide`]) and in sticks, from the end of the burn-in on, of
//! all paths; they do not depend on the output grid. A body in a stick has x' = 0 exactly, so its
//! time is an atom of the law of x', which is kept apart. The density of x' and that of (x, x') are
//! those of the time in motion, and their integrals are its share. The density of x is that of all
//! time.
//!
//! Times are counted in whole ticks, which merge exactly in any order.

use super::motion::counted_part;
use super::{Densities, DensityCurve};
use crate::model::{Event, EventKind, Phase};
use crate::scheme::{Along, Glide, Timeline};
use crate::sums::Ends;
use crate::sums::batches::{BATCHES, Share, batch_of};
use crate::sums::codec::sums;
use crate::sums::grid::Grid;
use ndarray::Array2;

/// The largest number of cells of a density of one variable, and along each axis of two.
const ONE: [usize; 2] = [256, 1];
const TWO: [usize; 2] = [64, 64];

/// States are counted when so many of them wait.
const WAITING: usize = 1 << 12;

/// Ticks of the counted time of a path.
const TICKS: f64 = (1u64 << 38) as f64;

/// A bin that fewer batches of paths have visited than this has no interval: where bodies wander,
/// a few visits do not show how many there may be.
const FEWEST: usize = 8;

/// The states of a glide that are counted, each at the same place of an equal part of its time.
const PARTS: u32 = 8;

/// The place in a part, from 0 to 1, of a glide that begins at this tick. It looks random, so that
/// many slips of one form are seen at all their velocities, and not at eight of them.
fn place(tick: u64) -> f64 {
    (tick.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11) as f64 / (1u64 << 53) as f64
}

sums! {
    /// Counts of ticks.
    #[derive(Clone, Debug, PartialEq)]
    pub(super) struct DensityCounts {
        /// x at all times.
        displacement: Grid,
        /// x' in motion.
        velocity: Grid,
        /// (x, x') in motion.
        joint: Grid,
        /// All ticks of each batch of paths, and those at rest.
        all: [u64; BATCHES],
        at_rest: [u64; BATCHES],
    }
}

impl Default for DensityCounts {
    fn default() -> Self {
        let one = || Grid::empty(ONE, BATCHES);
        let (displacement, velocity, joint) = (one(), one(), Grid::empty(TWO, 1));
        DensityCounts { displacement, velocity, joint, all: [0; BATCHES], at_rest: [0; BATCHES] }
    }
}

impl DensityCounts {
    /// The densities. `chance` is the number of units, if these are random.
    pub fn summary(&self, chance: Option<u64>) -> Densities {
        let curve = |grid: &Grid| {
            let edges = grid.axes()[0].edges();
            let widths: Vec<f64> = edges.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let share = |counts: &[u64]| {
                // In units of the time of a path, so that a share that is never taken has the interval
                // of so many paths.
                Share::of(counts.iter().zip(&self.all).map(|(count, all)| (*count as f64 / TICKS, *all as f64 / TICKS)))
            };
            let shares: Vec<Share> = grid.cells().map(share).collect();
            let density = shares.iter().zip(&widths).map(|(share, width)| share.estimate / width).collect();
            let ends = grid.cells().zip(&shares).zip(&widths).map(|((counts, share), width)| {
                let visited = counts.iter().filter(|count| **count > 0).count();
                if visited < FEWEST { [f64::NAN; 2] } else { share.interval(chance).map(|end| end / width) }
            });
            DensityCurve { density, ends: ends.collect::<Ends>(), edges }
        };
        let all: f64 = self.all.iter().map(|ticks| *ticks as f64).sum();
        let [rows, columns] = self.joint.axes();
        let edges = [rows.edges(), columns.edges()];
        let area = |edges: &[Vec<f64>; 2]| edges.iter().map(|edges| edges[1] - edges[0]).product::<f64>();
        let joint = self.joint.cells().map(|count| count[0] as f64 / (all * area(&edges))).collect();
        let shape = (rows.cells(), columns.cells());
        let at_rest = Share::of(self.at_rest.iter().zip(&self.all).map(|(rest, all)| (*rest as f64, *all as f64)));
        Densities {
            displacement: curve(&self.displacement),
            velocity: curve(&self.velocity),
            joint: Array2::from_shape_vec(shape, joint).unwrap_or_default(),
            joint_edges: edges,
            at_rest: at_rest.estimate,
            at_rest_ends: at_rest.interval(chance),
        }
    }
}

/// A state (x, x'), its ticks and its batch.
type State = ([f64; 2], u64, usize);

/// Counts the times of one block of paths.
pub(super) struct DensityFold {
    timeline: Timeline,
    /// The batch of each lane, and where it is at rest since when, if it is.
    batches: Vec<usize>,
    rests: Vec<Option<(f64, f64)>>,
    /// The states that wait to be counted.
    resting: Vec<State>,
    moving: Vec<State>,
    counts: DensityCounts,
}

impl DensityFold {
    /// The paths of these units, at rest at x0.
    pub fn new(timeline: &Timeline, x0: f64, units: &[u64]) -> Self {
        DensityFold {
            timeline: *timeline,
            batches: units.iter().map(|unit| batch_of(*unit)).collect(),
            rests: vec![Some((0.0, x0)); units.len()],
            resting: Vec::new(),
            moving: Vec::new(),
            counts: DensityCounts::default(),
        }
    }

    /// The ticks of a time.
    fn ticks(&self, time: f64) -> u64 {
        (time / self.timeline.counted() * TICKS).round() as u64
    }

    /// Add an event.
    pub fn event(&mut self, lane: usize, event: &Event) {
        self.leave(lane, event.time);
        if event.kind == EventKind::StickEntered {
            self.rests[lane] = Some((event.time, event.displacement));
        }
        debug_assert_eq!(event.kind.phase() == Phase::Static, self.rests[lane].is_some());
    }

    /// The stick of a path, if it is in one, is over at this time.
    fn leave(&mut self, lane: usize, time: f64) {
        let Some((since, x)) = self.rests[lane].take() else { return };
        let ticks = self.ticks((time - since.max(self.timeline.after)).max(0.0));
        if ticks > 0 {
            let batch = self.batches[lane];
            self.counts.at_rest[batch] += ticks;
            self.resting.push(([x, 0.0], ticks, batch));
            self.count_if_many();
        }
    }

    /// Add a piece of the motion.
    pub fn glide(&mut self, lane: usize, glide: &Glide) {
        let ([from, to], batch) = (counted_part(&self.timeline, glide), self.batches[lane]);
        let parts = if let Along::Step { .. } = glide.along { 1 } else { PARTS };
        let ticks = self.ticks((to - from) * glide.length / f64::from(parts));
        let place = place(self.ticks(glide.start));
        for i in 0..if ticks > 0 { parts } else { 0 } {
            let part = (f64::from(i) + place) / f64::from(parts);
            let [way, v, _] = match glide.along {
                Along::Step { .. } => glide.at(0.0),
                Along::Smooth { .. } => glide.at(from + (to - from) * part),
            };
            let state = [glide.displacement + way, v];
            // A path that diverges is left out later, and must not stretch the bins until then.
            if state.iter().all(|number| number.is_finite()) {
                self.moving.push((state, ticks, batch));
            }
        }
        self.count_if_many();
    }

    fn count_if_many(&mut self) {
        if self.resting.len() + self.moving.len() >= WAITING {
            self.count();
        }
    }

    fn count(&mut self) {
        let DensityFold { resting, moving, counts, .. } = self;
        for (_, ticks, batch) in resting.iter().chain(&*moving) {
            counts.all[*batch] += ticks;
        }
        let of = |variable: usize| move |(state, ticks, batch): &State| ([state[variable], 0.0], *ticks, *batch);
        counts.displacement.count(resting.iter().chain(&*moving).map(of(0)));
        counts.velocity.count(moving.iter().map(of(1)));
        counts.joint.count(moving.iter().map(|(state, ticks, _)| (*state, *ticks, 0)));
        resting.clear();
        moving.clear();
    }

    /// The counts of the whole time.
    pub fn finish(mut self) -> DensityCounts {
        (0..self.rests.len()).for_each(|lane| self.leave(lane, self.timeline.end));
        self.count();
        self.counts
    }
}
