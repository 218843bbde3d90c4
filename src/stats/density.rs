//! The share of the counted time that the body spends in each part of its phase plane.
//!
//! The states are those on the rows of the output grid from the end of the burn-in on, of all
//! paths, with equal weights. A body in a stick has x' = 0 exactly, so its time is an atom of the
//! law of x', which is kept apart. The density of x' and that of (x, x') are those of the time in
//! motion, and their integrals are its share. The density of x is that of all time.

use super::{Densities, DensityCurve};
use crate::scheme::{Snapshot, Timeline};
use crate::sums::Ends;
use crate::sums::Unit;
use crate::sums::batches::{BATCHES, Share, batch_of};
use crate::sums::codec::codec_of_fields;
use crate::sums::grid::Grid;
use ndarray::Array2;

/// The largest number of cells of a density of one variable, and along each axis of two.
const ONE: [usize; 2] = [256, 1];
const TWO: [usize; 2] = [64, 64];

/// States are counted when so many of them wait.
const WAITING: usize = 1 << 12;

/// Counts of states.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DensityCounts {
    /// x at all times.
    displacement: Grid,
    /// x' in motion.
    velocity: Grid,
    /// (x, x') in motion.
    joint: Grid,
    /// The number of all states of each batch of paths, and of those at rest.
    states: [u64; BATCHES],
    at_rest: [u64; BATCHES],
}

codec_of_fields!(DensityCounts { displacement, velocity, joint, states, at_rest });

impl Default for DensityCounts {
    fn default() -> Self {
        let one = || Grid::empty(ONE, BATCHES);
        let (displacement, velocity, joint) = (one(), one(), Grid::empty(TWO, 1));
        DensityCounts { displacement, velocity, joint, states: [0; BATCHES], at_rest: [0; BATCHES] }
    }
}

impl DensityCounts {
    pub fn merge(&mut self, other: &DensityCounts) {
        self.displacement.merge(&other.displacement);
        self.velocity.merge(&other.velocity);
        self.joint.merge(&other.joint);
        self.states.iter_mut().zip(&other.states).for_each(|(mine, more)| *mine += more);
        self.at_rest.iter_mut().zip(&other.at_rest).for_each(|(mine, more)| *mine += more);
    }

    /// The densities. `chance` is the number of units, if these are random.
    pub fn summary(&self, chance: Option<u64>) -> Densities {
        let curve = |grid: &Grid| {
            let edges = grid.axes()[0].edges();
            let widths: Vec<f64> = edges.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let share = |counts: &[u64]| {
                Share::of(counts.iter().zip(&self.states).map(|(count, all)| (*count as f64, *all as f64)))
            };
            let shares: Vec<Share> = grid.cells().map(share).collect();
            let density = shares.iter().zip(&widths).map(|(share, width)| share.estimate / width).collect();
            let ends = shares.iter().zip(&widths).map(|(share, width)| share.interval(chance).map(|end| end / width));
            DensityCurve { density, ends: ends.collect::<Ends>(), edges }
        };
        let all: u64 = self.states.iter().sum();
        let [rows, columns] = self.joint.axes();
        let edges = [rows.edges(), columns.edges()];
        let area = |edges: &[Vec<f64>; 2]| edges.iter().map(|edges| edges[1] - edges[0]).product::<f64>();
        let joint = self.joint.cells().map(|count| count[0] as f64 / (all as f64 * area(&edges))).collect();
        let shape = (rows.cells(), columns.cells());
        let at_rest = Share::of(self.at_rest.iter().zip(&self.states).map(|(rest, all)| (*rest as f64, *all as f64)));
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

/// Counts the states of one block of paths.
pub(super) struct DensityFold {
    /// The first row that is counted.
    first_row: usize,
    /// The batch of each lane.
    batches: Vec<usize>,
    /// x of the states that wait, row after row, and the states in motion among them with their
    /// batches.
    displacement: Vec<f64>,
    moving: Vec<([f64; 2], usize)>,
    counts: DensityCounts,
}

impl DensityFold {
    /// The paths with these numbers.
    pub fn new(timeline: &Timeline, paths: &[u64]) -> Self {
        DensityFold {
            first_row: timeline.first_row(),
            batches: paths.iter().map(|path| batch_of(*path)).collect(),
            displacement: Vec::with_capacity(WAITING + paths.len()),
            moving: Vec::with_capacity(WAITING + paths.len()),
            counts: DensityCounts::default(),
        }
    }

    /// Set another independent unit than the path.
    pub fn set_unit(&mut self, unit: Unit, paths: &[u64]) {
        self.batches = paths.iter().map(|path| batch_of(unit.of(*path))).collect();
    }

    /// Add a row of the output grid.
    pub fn row(&mut self, row: usize, snapshot: &Snapshot<'_>) {
        if row < self.first_row {
            return;
        }
        let Snapshot { displacement, velocity, is_static, .. } = snapshot;
        self.displacement.extend_from_slice(displacement);
        for (lane, &batch) in self.batches.iter().enumerate() {
            self.counts.states[batch] += 1;
            if is_static[lane] {
                self.counts.at_rest[batch] += 1;
            } else {
                self.moving.push(([displacement[lane], velocity[lane]], batch));
            }
        }
        if self.displacement.len() >= WAITING {
            self.count();
        }
    }

    fn count(&mut self) {
        let DensityFold { batches, displacement, moving, counts, .. } = self;
        let rows = displacement.chunks(batches.len().max(1));
        counts.displacement.count(rows.flat_map(|row| row.iter().zip(&*batches)).map(|(x, batch)| ([*x, 0.0], *batch)));
        counts.velocity.count(moving.iter().map(|([_, v], batch)| ([*v, 0.0], *batch)));
        counts.joint.count(moving.iter().map(|(state, _)| (*state, 0)));
        displacement.clear();
        moving.clear();
    }

    /// The counts of all rows.
    pub fn finish(mut self) -> DensityCounts {
        self.count();
        self.counts
    }
}
