//! The bias by comparison with a reference run of event-driven paths, which have no step.
//!
//! The reference run has as many paths as a given share of the cost of the run allows. Its
//! statistics are those to which the run tends as h falls, so that the bias is the difference of
//! the two. Nothing is extrapolated, and any scheme with a step can be compared. The error is that
//! of two finite ensembles, of which the reference run is the smaller one.

use super::widening_factor;
use crate::ensemble::{Plan, in_order};
use crate::model::Model;
use crate::scheme::{DEFAULT_TOLERANCE, EventDrivenSimulation, Simulate as _, Simulated, Simulation, Timeline};
use crate::stats::{Bias, BlockObserver, Estimate, Record, Statistic, Summary, Totals};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

/// How event-driven paths are simulated beside a run.
struct PieceCost {
    /// Number of paths in a piece of work.
    paths: u64,
    /// The cost of one evaluation in path-steps. A path-step takes 0.8 to 1.25 ns (with AVX-512;
    /// otherwise it takes longer, and an evaluation costs fewer of them).
    path_steps_per_evaluation: u64,
}

/// Paths that are simulated one by one: 63 to 77 ns per evaluation.
const ONE_BY_ONE: PieceCost = PieceCost { paths: 16, path_steps_per_evaluation: 64 };

/// Paths that are simulated together in lanes: 25 to 40 ns per evaluation with 64 paths and more.
const IN_LANES: PieceCost = PieceCost { paths: 128, path_steps_per_evaluation: 32 };

/// The number of paths from which the cost of a path is measured.
const FIRST: u64 = 16;

/// The smallest number of paths. With fewer paths, many intervals are not bounded.
const FEWEST: u64 = 32;

/// A reference run of event-driven paths beside a run.
#[derive(Clone, Debug)]
pub struct ReferenceRun {
    model: Model,
    timeline: Timeline,
    seed: u64,
    /// The number of path-steps that the reference run may cost.
    budget: u64,
    /// The number of paths of the run, which the reference run does not exceed.
    paths: u64,
}

impl ReferenceRun {
    /// A reference run beside a run of this many paths with this step and seed. It may cost one
    /// part in `one_part_in` of the run.
    pub fn new(model: &Model, timeline: &Timeline, h: f64, seed: u64, paths: u64, one_part_in: u64) -> Self {
        let path_steps = timeline.end / h * paths as f64;
        let budget = path_steps as u64 / one_part_in;
        // Rows of the output grid are left out, because the bands have no bias estimate. The seed
        // gives other random numbers than those of the run.
        ReferenceRun { model: model.clone(), timeline: timeline.without_rows(), seed: !seed, budget, paths }
    }

    /// The bias of the statistics of a run, without an order; none where the reference run costs
    /// too much, or does not resolve all slips (f_s and f_d nearly equal under noise).
    pub fn estimate(&self, run: &Summary, threads: usize, stop: &AtomicBool) -> Option<Vec<(Statistic, Bias)>> {
        Some(biases(run, &self.simulate(threads, stop)?))
    }

    /// The statistics of the reference run; none where it costs too much, or does not resolve all
    /// slips.
    pub(super) fn simulate(&self, threads: usize, stop: &AtomicBool) -> Option<Summary> {
        let exact = EventDrivenSimulation::new(&self.model, &self.timeline, DEFAULT_TOLERANCE);
        let cost = if exact.paths_abreast() > 1 { IN_LANES } else { ONE_BY_ONE };
        let paths = self.affordable(&exact, self.budget / cost.path_steps_per_evaluation)?;
        let size = cost.paths;
        let simulation = Simulation::EventDriven(Box::new(exact));
        let plan = Plan { simulation, record: Record::NOTHING, seed: self.seed, paths, antithetic: false };
        let mut totals = Totals::empty(plan.model(), plan.timeline());
        let make = |index: u64| plan.piece(index * size, size.min(paths - index * size)).totals;
        let deliver = |piece: Totals| -> Result<_, Infallible> {
            totals.merge(&piece);
            Ok(ControlFlow::Continue(()))
        };
        let pieces = paths.div_ceil(size);
        let Ok(delivered) = in_order(pieces, threads, stop, make, deliver);
        Some(totals.summary()).filter(|summary| delivered == pieces && summary.diverged.is_empty())
    }

    /// The number of paths that this many evaluations allow, judged by the cost of the first paths,
    /// which are stopped if they exceed the whole budget. None if it is too small, or if the scheme
    /// does not resolve all slips.
    fn affordable(&self, exact: &EventDrivenSimulation, evaluations: u64) -> Option<u64> {
        if exact.resolution().is_some() || evaluations < FEWEST {
            return None;
        }
        let first: Vec<u64> = (0..FIRST).collect();
        let mut observer = BlockObserver::new(&self.model, &self.timeline, &Record::NOTHING, &first);
        let limited = exact.clone().with_work_limit(evaluations / FIRST);
        let Simulated { lost, evaluations: spent } = limited.simulate_counting(self.seed, &first, &mut observer);
        let paths = (evaluations * FIRST / spent.max(1)).min(self.paths);
        (lost.is_empty() && paths >= FEWEST).then_some(paths)
    }
}

/// The bias of the statistics of a run, given those of its reference run.
pub(super) fn biases(run: &Summary, exact: &Summary) -> Vec<(Statistic, Bias)> {
    let widening_factor = widening_factor(exact.completed_paths);
    let both = run.estimates.iter().zip(&exact.estimates);
    both.filter_map(|(run, exact)| Some((run.statistic, difference(run, exact, widening_factor)?))).collect()
}

/// The statistic of the run minus that of the reference run. The two are independent, so their
/// errors add in squares, separately for each side: the lower end of the bias is where the run is
/// low and the reference run is high. The uncertainty is that of the longer side. The error that
/// the tolerance leaves is the same for every seed, so it is added as it is. None where one of the
/// two has no bounded interval.
fn difference(run: &Estimate, exact: &Estimate, widening_factor: f64) -> Option<Bias> {
    let below = (run.estimate - run.low).hypot(exact.high - exact.estimate);
    let above = (run.high - run.estimate).hypot(exact.estimate - exact.low);
    let uncertainty = widening_factor * below.max(above) + DEFAULT_TOLERANCE * exact.estimate.abs();
    let estimate = run.estimate - exact.estimate;
    let is_bounded = estimate.is_finite() && below.is_finite() && above.is_finite();
    is_bounded.then_some(Bias { estimate, uncertainty, order: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(estimate: f64, low: f64, high: f64) -> Estimate {
        let (statistic, standard_error) = (Statistic::StickDurationMedian, 0.1);
        Estimate { statistic, estimate, standard_error, low, high, bias: None }
    }

    /// The median of the run is 4, in [4, 7], and that of the reference run is 1, in [1, 5]. The
    /// bias is 3, and may be lower by sqrt(0 + 4^2) or higher by sqrt(3^2 + 0). The uncertainty is
    /// 1.5 times the longer side, plus 0.1 % of 1. Half the width of the two intervals, 2.5, would
    /// cover neither side.
    #[test]
    fn the_uncertainty_is_that_of_the_longer_side() {
        let bias = difference(&of(4.0, 4.0, 7.0), &of(1.0, 1.0, 5.0), 1.5);
        let expected = Some(Bias { estimate: 3.0, uncertainty: 1.5 * 4.0 + 0.001, order: None });
        assert_eq!(bias, expected);
        let uncertainty = difference(&of(4.0, 1.0, 4.0), &of(1.0, -3.0, 1.0), 1.0).expect("bounded").uncertainty;
        assert!((uncertainty - 4.001).abs() < 1e-12, "{uncertainty}");
    }

    #[test]
    fn a_statistic_without_a_bounded_interval_has_no_bias() {
        let run = of(4.0, 4.0, 4.0);
        assert_eq!(difference(&run, &of(1.0, 0.0, f64::INFINITY), 1.0), None);
        assert_eq!(difference(&run, &of(1.0, f64::NAN, f64::NAN), 1.0), None);
        assert_eq!(difference(&of(f64::NAN, f64::NAN, f64::NAN), &run, 1.0), None);
    }
}
