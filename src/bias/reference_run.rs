//! The bias by comparison with a reference run of event-driven paths, which have no step.
//!
//! The number of paths of the reference run follows from a given share of the cost of the run. Its
//! statistics are the limits of those of the run as h decreases, so the bias is the difference of
//! the two. Nothing is extrapolated, and any scheme with a step can be compared. The error is that
//! of two finite ensembles, mostly of the smaller reference run.

use super::widening::widening_factor;
use crate::ensemble::{Plan, in_order_while};
use crate::model::Model;
use crate::scheme::{
    DEFAULT_TOLERANCE, EventDrivenSimulation, Simulate as _, Simulated, Simulation, Timeline,
};
use crate::stats::{Bias, BlockObserver, Estimate, Record, Statistic, Summary, Totals};
use crate::sums::range::NORMAL;
use crate::sums::{Merge as _, Replicate};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

/// The number of pieces of work into which the reference run is divided if their size permits it,
/// so that threads can share the work.
const PIECES: u64 = 8;

/// How event-driven paths are simulated for a reference run.
struct Pricing {
    /// The largest number of paths in a piece of work lies between these two. A path takes less
    /// time in a large piece, so pieces grow with the number of paths.
    piece: [u64; 2],
    /// The cost of one evaluation in path-steps. A path-step takes 0.75 ns with AVX-512. Other
    /// instruction sets take longer for both.
    path_steps_per_evaluation: u64,
}

/// Paths that are simulated one by one: 63 to 84 ns per evaluation.
const ONE_BY_ONE: Pricing = Pricing {
    piece: [16, 16],
    path_steps_per_evaluation: 100,
};

/// Paths that are simulated together in lanes: 17 to 20 ns per evaluation.
const IN_LANES: Pricing = Pricing {
    piece: [256, 1024],
    path_steps_per_evaluation: 23,
};

impl Pricing {
    /// The number of paths in a piece, if there are this many paths. All pieces are nearly equal,
    /// so that no thread waits long for another.
    fn piece_size(&self, paths: u64) -> u64 {
        let [smallest, largest] = self.piece;
        let most = (paths / PIECES).clamp(smallest, largest);
        paths.div_ceil(paths.div_ceil(most))
    }
}

/// The cost of a row of the output grid, per path of the run, in path-steps. A row takes 8 ns if
/// there are 100 000 paths, and 21 ns if there are 10 000.
const PATH_STEPS_PER_ROW: f64 = 19.0;

/// The number of paths from which the cost of a path is measured.
const FIRST: u64 = 16;

/// The smallest number of paths. With fewer paths, many intervals are not bounded.
const FEWEST: u64 = 32;

/// A reference run of event-driven paths.
#[derive(Clone, Debug)]
pub struct ReferenceRun {
    model: Model,
    timeline: Timeline,
    seed: u64,
    /// The number of path-steps of the run.
    path_steps: f64,
    /// The reference run may cost one part in this many of the run.
    one_part_in: u64,
    /// The number of paths of the run, which the reference run does not exceed.
    paths: u64,
    /// The records of the run, except those of single paths.
    pub(super) record: Record,
}

impl ReferenceRun {
    /// A reference run for a run of this many paths with this step and seed. It may cost one part
    /// in `one_part_in` of the run.
    pub fn new(
        model: &Model,
        timeline: &Timeline,
        h: f64,
        seed: u64,
        paths: u64,
        one_part_in: u64,
    ) -> Self {
        let path_steps =
            (timeline.end / h + PATH_STEPS_PER_ROW * timeline.rows() as f64) * paths as f64;
        // Rows of the output grid are omitted, because the bands have no bias estimate. The seed
        // gives other random numbers than those of the run.
        let (model, timeline, record) = (model.clone(), timeline.without_rows(), Record::NOTHING);
        ReferenceRun {
            model,
            timeline,
            seed: !seed,
            path_steps,
            one_part_in,
            paths,
            record,
        }
    }

    /// The same reference run, which may cost as much as the run.
    pub fn at_any_rate(&self) -> Self {
        ReferenceRun {
            one_part_in: 1,
            ..self.clone()
        }
    }

    /// The bias of the statistics of a run, without an order; none if the reference run costs too
    /// much, or does not resolve all slips (f_s and f_d nearly equal under noise).
    pub fn estimate(
        &self,
        run: &Summary,
        threads: usize,
        stop: &AtomicBool,
    ) -> Option<Vec<(Statistic, Bias)>> {
        Some(self.simulate(threads, stop)?.biases(run))
    }

    /// The statistics of the reference run; none where it costs too much, or does not resolve all
    /// slips.
    pub(super) fn simulate(&self, threads: usize, stop: &AtomicBool) -> Option<Referenced> {
        let exact = EventDrivenSimulation::new(&self.model, &self.timeline, DEFAULT_TOLERANCE);
        let costs = if exact.vectorised_paths() > 1 {
            IN_LANES
        } else {
            ONE_BY_ONE
        };
        let budget = self.path_steps as u64 / self.one_part_in;
        let paths = self.affordable(&exact, budget / costs.path_steps_per_evaluation, stop)?;
        let size = costs.piece_size(paths);
        let simulation = Simulation::EventDriven(Box::new(exact));
        let plan = Plan {
            simulation,
            record: self.record,
            seed: self.seed,
            paths,
            antithetic: false,
        };
        let mut totals = Totals::empty(plan.model(), plan.timeline(), &plan.record);
        let make = |index: u64| {
            Some(
                plan.piece_until(index * size, size.min(paths - index * size), stop)?
                    .totals,
            )
        };
        let deliver = |piece: Totals| -> Result<_, Infallible> {
            totals.merge(&piece);
            Ok(ControlFlow::Continue(()))
        };
        let pieces = paths.div_ceil(size);
        let Ok(delivered) = in_order_while(pieces, threads, stop, make, deliver);
        let is_whole = delivered == pieces && totals.diverged().is_empty();
        is_whole.then(|| Referenced {
            paths,
            estimates: totals.estimates(),
        })
    }

    /// The number of paths that this many evaluations allow, estimated from the first paths, which
    /// are stopped if they exceed the whole budget. None if it is too small, or if the scheme does
    /// not resolve all slips.
    fn affordable(
        &self,
        exact: &EventDrivenSimulation,
        evaluations: u64,
        stop: &AtomicBool,
    ) -> Option<u64> {
        if exact.resolution().is_some() || evaluations < FEWEST {
            return None;
        }
        let first: Vec<u64> = (0..FIRST).collect();
        let own = BlockObserver::new(
            &self.model,
            &self.timeline,
            &Record::NOTHING,
            &first,
            Replicate::Path,
        );
        let mut observer = (own, stop);
        let limited = exact.clone().with_work_limit(evaluations / FIRST);
        let Simulated {
            lost,
            evaluations: spent,
            ..
        } = limited.simulate_counting(self.seed, &first, &mut observer);
        let paths = (evaluations * FIRST / spent.max(1)).min(self.paths);
        (lost.is_empty() && paths >= FEWEST).then_some(paths)
    }
}

/// The statistics of a reference run.
#[derive(Clone, Debug)]
pub(super) struct Referenced {
    paths: u64,
    estimates: [Estimate; Statistic::ALL.len()],
}

impl Referenced {
    /// The bias of the statistics of a run that has this reference run.
    pub fn biases(&self, run: &Summary) -> Vec<(Statistic, Bias)> {
        let widening_factor = widening_factor(self.paths);
        let more_paths = run.valid_paths() as f64 / self.paths as f64;
        let both = run.estimates.iter().zip(&self.estimates);
        both.filter_map(|(run, exact)| {
            Some((
                run.statistic,
                difference(run, exact, more_paths, widening_factor)?,
            ))
        })
        .collect()
    }
}

/// The error of a reference run is used if it is at least this fraction of that implied by the run.
/// With 32 normal numbers it is smaller in 1 % of all cases.
const TYPICAL: f64 = 0.7;

/// The statistic of the run minus that of the reference run. The two are independent, so their
/// errors add in squares, separately for each side: the lower end of the bias combines a low run
/// with a high reference run. The uncertainty is that of the longer side.
///
/// The run has `more_paths` times as many paths, of nearly the same law. It may contain rare events
/// of which the reference run has too few. If the error of the reference run is much smaller than
/// the run implies for its number of paths, the latter is used. The error due to the tolerance is
/// the same for every seed, so it is added linearly. None if one of the two has no bounded
/// interval.
fn difference(
    run: &Estimate,
    exact: &Estimate,
    more_paths: f64,
    widening_factor: f64,
) -> Option<Bias> {
    let least = NORMAL * run.standard_error * more_paths.sqrt();
    // A missing arm remains NaN.
    let at_least = |arm: f64| if arm < TYPICAL * least { least } else { arm };
    let below = (run.estimate - run.low).hypot(at_least(exact.high - exact.estimate));
    let above = (run.high - run.estimate).hypot(at_least(exact.estimate - exact.low));
    let uncertainty = widening_factor * below.max(above) + DEFAULT_TOLERANCE * exact.estimate.abs();
    let estimate = run.estimate - exact.estimate;
    let is_bounded = estimate.is_finite() && below.is_finite() && above.is_finite();
    is_bounded.then_some(Bias {
        estimate,
        uncertainty,
        order: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(estimate: f64, low: f64, high: f64) -> Estimate {
        let (statistic, standard_error) = (Statistic::StickDurationMedian, 0.1);
        Estimate {
            statistic,
            estimate,
            standard_error,
            low,
            high,
            bias: None,
        }
    }

    /// The median of the run is 4, in [4, 7], and that of the reference run is 1, in [1, 5]. The
    /// bias is 3, and may be lower by sqrt(0 + 4^2) or higher by sqrt(3^2 + 0). The uncertainty is
    /// 1.5 times the longer side, plus 0.1 % of 1. Half the width of the two intervals, 2.5, would
    /// cover neither side.
    #[test]
    fn the_uncertainty_is_that_of_the_longer_side() {
        let bias = difference(&of(4.0, 4.0, 7.0), &of(1.0, 1.0, 5.0), 1.0, 1.5);
        let expected = Some(Bias {
            estimate: 3.0,
            uncertainty: 1.5 * 4.0 + 0.001,
            order: None,
        });
        assert_eq!(bias, expected);
        let uncertainty = difference(&of(4.0, 1.0, 4.0), &of(1.0, -3.0, 1.0), 1.0, 1.0)
            .expect("bounded")
            .uncertainty;
        assert!((uncertainty - 4.001).abs() < 1e-12, "{uncertainty}");
    }

    #[test]
    fn a_statistic_without_a_bounded_interval_has_no_bias() {
        let run = of(4.0, 4.0, 4.0);
        assert_eq!(
            difference(&run, &of(1.0, 0.0, f64::INFINITY), 1.0, 1.0),
            None
        );
        assert_eq!(
            difference(&run, &of(1.0, f64::NAN, f64::NAN), 1.0, 1.0),
            None
        );
        assert_eq!(
            difference(&of(f64::NAN, f64::NAN, f64::NAN), &run, 1.0, 1.0),
            None
        );
    }

    /// The reference run has a hundredth of the paths of the run, and has seen no rare event: all its
    /// values are 1. The run, with a standard error of 0.1, says that its error is 1.
    #[test]
    fn a_reference_run_is_no_more_certain_than_the_run_says() {
        let bias = difference(&of(1.2, 1.2, 1.2), &of(1.0, 1.0, 1.0), 100.0, 1.0).expect("bounded");
        assert!(
            (bias.uncertainty - 1.959_964 - 0.001).abs() < 1e-6,
            "{bias:?}"
        );
    }
}
