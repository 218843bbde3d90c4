//! The bias from paths of a scheme without a step.
//!
//! As many event-driven paths as a share of the run pays for have the statistics to which those of the run tend as h falls. What
//! remains of the difference is the bias, with nothing extrapolated and for any scheme with a step; its error is that of two finite ensembles, of
//! which theirs is the smaller one.

use crate::ensemble::in_order;
use crate::model::Model;
use crate::scheme::{DEFAULT_TOLERANCE, EventDriven, Simulated, Timeline};
use crate::stats::{Bias, BlockObserver, Estimate, Record, Statistic, Summary, Totals};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

/// What an evaluation of the event-driven scheme costs, in path-steps: 34 to 77 ns beside 0.8 to 1.25 (AVX-512; fewer path-steps elsewhere).
const EVALUATION: u64 = 64;

/// Paths of a piece of work.
const PIECE: u64 = 16;

/// With fewer paths their intervals say little.
const FEWEST: u64 = 32;

/// Event-driven paths beside a run.
#[derive(Clone, Debug)]
pub struct Anchor {
    model: Model,
    timeline: Timeline,
    seed: u64,
    /// Evaluations that may be spent.
    budget: u64,
    /// Paths of the run; there is no point in more.
    paths: u64,
}

impl Anchor {
    /// For a run of so many paths with this step and seed, of whose cost they may take one part in `share`.
    pub fn new(model: &Model, timeline: &Timeline, h: f64, seed: u64, paths: u64, share: u64) -> Self {
        let path_steps = timeline.end / h * paths as f64;
        // No rows but the first: the bands have no bias.
        let timeline = Timeline { output_step: 2.0 * timeline.end, ..*timeline };
        // other random numbers than those of the run
        Anchor { model: model.clone(), timeline, seed: !seed, budget: path_steps as u64 / (share * EVALUATION), paths }
    }

    /// The bias of the statistics of a run, without an order; none where the paths cost too much, or resolve less than there is (f_s and f_d
    /// all but meeting under noise).
    pub fn estimate(&self, run: &Summary, threads: usize, stop: &AtomicBool) -> Option<Vec<(Statistic, Bias)>> {
        let exact = self.simulate(threads, stop)?.summary();
        let both = run.estimates.iter().zip(&exact.estimates);
        Some(both.filter_map(|(run, exact)| Some((run.statistic, difference(run, exact)?))).collect())
    }

    fn simulate(&self, threads: usize, stop: &AtomicBool) -> Option<Totals> {
        let scheme = EventDriven::new(&self.model, &self.timeline, DEFAULT_TOLERANCE);
        if scheme.resolution().is_some() || self.budget < FEWEST {
            return None;
        }
        let piece = |scheme: &EventDriven, index: u64, paths: u64| {
            let first = index * PIECE;
            let numbers: Vec<u64> = (first..first + paths).collect();
            let nothing = Record { paths: false, events: false, trajectories: 0 };
            let mut observer = BlockObserver::new(&self.model, &self.timeline, &nothing, &numbers);
            let Simulated { lost, evaluations } = scheme.simulate_counting(self.seed, &numbers, &mut observer);
            lost.is_empty().then(|| (observer.finish(first, paths, Vec::new()).totals, evaluations))
        };
        // What the first ones take tells how many can be paid for. They may not take more than all of it themselves.
        let (_, evaluations) = piece(&scheme.clone().with_work_limit(self.budget / PIECE), 0, PIECE)?;
        let count = (self.budget * PIECE / evaluations.max(1)).min(self.paths);
        if count < FEWEST {
            return None;
        }
        let mut totals = Some(Totals::empty(&self.model, &self.timeline));
        let make = |index: u64| piece(&scheme, index, PIECE.min(count - index * PIECE));
        let deliver = |made: Option<(Totals, u64)>| -> Result<_, Infallible> {
            match (&mut totals, made) {
                (Some(totals), Some((more, _))) => totals.merge(&more),
                (totals, _) => *totals = None,
            }
            Ok(ControlFlow::Continue(()))
        };
        let pieces = count.div_ceil(PIECE);
        let Ok(delivered) = in_order(pieces, threads, stop, make, deliver);
        totals.filter(|_| delivered == pieces)
    }
}

/// What the run has and the paths without a step have not. They are independent, so errors add up in squares; the tolerance is the same
/// for every seed.
fn difference(run: &Estimate, exact: &Estimate) -> Option<Bias> {
    let uncertainty = run.reach().hypot(exact.reach()) + DEFAULT_TOLERANCE * exact.estimate.abs();
    let estimate = run.estimate - exact.estimate;
    (estimate.is_finite() && uncertainty.is_finite()).then_some(Bias { estimate, uncertainty, order: None })
}
