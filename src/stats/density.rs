//! The fraction of the counted time that the body spends in each part of its phase plane.
//!
//! Times are those along the motion ([`Segment`]) and in sticks, from the end of the burn-in on, of
//! all paths; they do not depend on the output grid. A body in a stick has x' = 0 exactly, so its
//! time is an atom of the law of x', which is stored separately. The density of x' and that of (x,
//! x') are those of the time in motion, and their integrals are its share. The density of x is that
//! of all time.
//!
//! A segment of the motion is a polynomial, and the time that it spends in a bin is that between
//! its passages of the edges. Passages are rounded to whole ticks before they are subtracted, so
//! times are whole numbers of ticks, which merge exactly in any order, and bins into coarser bins.

use super::motion::counted_part;
use super::{Densities, DensityCurve};
use crate::model::{Event, EventKind, Phase};
use crate::scheme::{Along, Segment, Timeline};
use crate::sums::Ends;
use crate::sums::batches::{BATCHES, Share, batch_of};
use crate::sums::codec::sums;
use crate::sums::dyadic::nearest;
use crate::sums::grid::Grid;
use ndarray::Array2;

/// The largest number of cells of a density of one variable, and along each axis of two.
const ONE: [usize; 2] = [256, 1];
const TWO: [usize; 2] = [64, 64];

/// Ticks of the counted time of a path.
const TICKS: f64 = (1u64 << 38) as f64;

/// A bin visited by fewer batches of paths than this has no interval: if bodies wander, a few
/// visits do not show how many there may be.
const FEWEST: usize = 8;

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
        DensityCounts {
            displacement,
            velocity,
            joint,
            all: [0; BATCHES],
            at_rest: [0; BATCHES],
        }
    }
}

impl DensityCounts {
    /// The densities. `random_units` is the number of units, if these are random.
    pub fn summary(&self, random_units: Option<u64>) -> Densities {
        let curve = |grid: &Grid| {
            let edges = grid.axes()[0].edges();
            let widths: Vec<f64> = edges.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let share = |counts: &[u64]| {
                // In units of the time of a path, so that a share of zero has the interval of this
                // many paths.
                Share::of(
                    counts
                        .iter()
                        .zip(&self.all)
                        .map(|(count, all)| (*count as f64 / TICKS, *all as f64 / TICKS)),
                )
            };
            let shares: Vec<Share> = grid.cells().map(share).collect();
            let density = shares
                .iter()
                .zip(&widths)
                .map(|(share, width)| share.estimate / width)
                .collect();
            let ends = grid
                .cells()
                .zip(&shares)
                .zip(&widths)
                .map(|((counts, share), width)| {
                    let visited = counts.iter().filter(|count| **count > 0).count();
                    if visited < FEWEST {
                        [f64::NAN; 2]
                    } else {
                        share.interval(random_units).map(|end| end / width)
                    }
                });
            DensityCurve {
                density,
                ends: ends.collect::<Ends>(),
                edges,
            }
        };
        let all: f64 = self.all.iter().map(|ticks| *ticks as f64).sum();
        let [rows, columns] = self.joint.axes();
        let edges = [rows.edges(), columns.edges()];
        let area = |edges: &[Vec<f64>; 2]| {
            edges
                .iter()
                .map(|edges| edges[1] - edges[0])
                .product::<f64>()
        };
        let joint = self
            .joint
            .cells()
            .map(|count| count[0] as f64 / (all * area(&edges)))
            .collect();
        let shape = (rows.cells(), columns.cells());
        let at_rest = Share::of(
            self.at_rest
                .iter()
                .zip(&self.all)
                .map(|(rest, all)| (*rest as f64, *all as f64)),
        );
        Densities {
            displacement: curve(&self.displacement),
            velocity: curve(&self.velocity),
            joint: Array2::from_shape_vec(shape, joint).unwrap_or_default(),
            joint_edges: edges,
            at_rest: at_rest.estimate,
            at_rest_ends: at_rest.interval(random_units),
        }
    }
}

/// The tick of a time after the burn-in, with `rate` ticks in a unit of time. A step that is counted may
/// begin before the end of the burn-in, so that ticks begin earlier.
fn tick(time: f64, rate: f64) -> u64 {
    nearest((TICKS + time * rate).max(0.0)) as u64
}

/// Counts the times of one block of paths.
pub(super) struct DensityFold {
    timeline: Timeline,
    /// Ticks of a unit of time.
    rate: f64,
    /// The batch of each lane, and where it is at rest since when, if it is.
    batches: Vec<usize>,
    rests: Vec<Option<(f64, f64)>>,
    counts: DensityCounts,
}

impl DensityFold {
    /// The paths of these units, at rest at x0.
    pub fn new(timeline: &Timeline, x0: f64, units: &[u64]) -> Self {
        DensityFold {
            timeline: *timeline,
            rate: TICKS / timeline.counted(),
            batches: units.iter().map(|unit| batch_of(*unit)).collect(),
            rests: vec![Some((0.0, x0)); units.len()],
            counts: DensityCounts::default(),
        }
    }

    /// Add an event.
    pub fn event(&mut self, lane: usize, event: &Event) {
        self.leave(lane, event.time);
        if event.kind == EventKind::StickEntered {
            self.rests[lane] = Some((event.time, event.displacement));
        }
        debug_assert_eq!(
            event.kind.phase() == Phase::Static,
            self.rests[lane].is_some()
        );
    }

    /// The stick of a path, if it is in one, is over at this time.
    fn leave(&mut self, lane: usize, time: f64) {
        let Some((since, x)) = self.rests[lane].take() else {
            return;
        };
        let DensityFold {
            timeline: Timeline { after, .. },
            rate,
            ..
        } = *self;
        let (ticks, batch) = (
            [since.max(after), time].map(|time| tick(time - after, rate)),
            self.batches[lane],
        );
        if ticks[0] < ticks[1] {
            self.counts.at_rest[batch] += ticks[1] - ticks[0];
            self.counts.all[batch] += ticks[1] - ticks[0];
            self.counts
                .displacement
                .pass([[x, 0.0]; 2], ticks, batch, |_, _| 0);
        }
    }

    /// Add a segment of the motion: the time that it spends in each bin. A step is in the bin of
    /// its start.
    pub fn segment(&mut self, lane: usize, segment: &Segment) {
        let counted = counted_part(&self.timeline, segment);
        if let Along::Step { .. } = segment.along {
            let state = [segment.displacement, segment.velocity[0]];
            self.pass(lane, segment, counted, [state; 2], |_, _| 0.0);
        } else {
            let course = segment.course();
            for part in course.turns(counted).pairs() {
                let ends = part.map(|place| course.at(place));
                self.pass(lane, segment, part, ends, |variable, edge| {
                    course.passes(variable, edge, part)
                });
            }
        }
    }

    /// Count the time between two places of a segment, between which x and x' are monotone and pass
    /// edges at `place`.
    fn pass(
        &mut self,
        lane: usize,
        segment: &Segment,
        part: [f64; 2],
        ends: [[f64; 2]; 2],
        place: impl Fn(usize, f64) -> f64,
    ) {
        let (after, rate) = (self.timeline.after, self.rate);
        let tick = |place: f64| tick(segment.start + place * segment.length - after, rate);
        let (ticks, batch) = (part.map(tick), self.batches[lane]);
        if ticks[0] >= ticks[1] {
            return;
        }
        let crossing = |variable, edge| tick(place(variable, edge));
        let one = |variable: usize| ends.map(|state| [state[variable], 0.0]);
        self.counts.all[batch] += ticks[1] - ticks[0];
        self.counts
            .displacement
            .pass(one(0), ticks, batch, |_, edge| crossing(0, edge));
        self.counts
            .velocity
            .pass(one(1), ticks, batch, |_, edge| crossing(1, edge));
        self.counts.joint.pass(ends, ticks, 0, crossing);
    }

    /// The counts of the whole time.
    pub fn finish(mut self) -> DensityCounts {
        (0..self.rests.len()).for_each(|lane| self.leave(lane, self.timeline.end));
        self.counts
    }
}
