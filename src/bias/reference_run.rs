//! The bias by comparison with a reference run of event-driven paths, which have no step.
//!
//! The number of paths of the reference run follows from a given share of the cost of the run. Its
//! statistics are the limits of those of the run as h decreases, so the bias is the difference of
//! the two. Nothing is extrapolated, and any scheme with a step can be compared. The error is that
//! of two finite ensembles, mostly of the smaller reference run.

use super::extrapolation::is_smooth;
use crate::ensemble::{Plan, in_order_while};
use crate::model::Problem;
use crate::scheme::{
    DEFAULT_TOLERANCE, EventDriven, Scheme, Simulate as _, Simulated, Simulation, Timeline,
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
    model: Problem,
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
        model: &Problem,
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
        let scheme = Scheme::from(EventDriven::default());
        if scheme.resolution(&self.model, &self.timeline).is_some() {
            return None;
        }
        let simulation = scheme.simulation(&self.model, &self.timeline);
        let costs = if simulation.vectorised_paths() > 1 {
            IN_LANES
        } else {
            ONE_BY_ONE
        };
        let budget = self.path_steps as u64 / self.one_part_in;
        let paths = self.affordable(&simulation, budget / costs.path_steps_per_evaluation, stop)?;
        let size = costs.piece_size(paths);
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
    /// are stopped if they exceed the whole budget. None if it is too small.
    fn affordable(
        &self,
        simulation: &Simulation,
        evaluations: u64,
        stop: &AtomicBool,
    ) -> Option<u64> {
        if evaluations < FEWEST {
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
        let limited = simulation.clone().with_work_limit(evaluations / FIRST);
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
        let more_paths = run.valid_paths() as f64 / self.paths as f64;
        let both = run.estimates.iter().zip(&self.estimates);
        both.filter_map(|(run, exact)| Some((run.statistic, difference(run, exact, more_paths)?)))
            .collect()
    }
}

/// The error of a reference run is used if it is at least this fraction of that implied by the run.
/// The law at the step is broader than without one for some statistics: the sticks of `rho025` at
/// h = 0.01 scatter 1.5 times as much.
const TYPICAL: f64 = 0.5;

/// The distances to the lower and to the upper end of the range in which an estimate lies at 95 %.
/// Those of a mean follow from its standard error, because the interval of a bias has equal arms.
/// The arms of a median may differ by any factor. If all paths agree, the interval allows for
/// values that by chance none of them has.
fn arms(e: &Estimate) -> [f64; 2] {
    if is_smooth(e.statistic) && e.standard_error > 0.0 {
        [NORMAL * e.standard_error; 2]
    } else {
        [e.estimate - e.low, e.high - e.estimate]
    }
}

/// The statistic of the run minus that of the reference run. The two are independent, so their
/// errors add in squares, separately for each side: the lower end of the bias combines a low run
/// with a high reference run. The uncertainty is that of the longer side.
///
/// The run has `more_paths` times as many paths, of nearly the same law. It may contain rare events
/// of which the reference run has too few. So the error of the reference run is at least that
/// implied by the run for its number of paths, if its own is much smaller or its paths are too few
/// for an interval. A median does not depend on rare events. The error due to the tolerance is
/// the same for every seed, so it is added linearly. None if the run has no bounded interval.
fn difference(run: &Estimate, exact: &Estimate, more_paths: f64) -> Option<Bias> {
    let least = NORMAL * run.standard_error * more_paths.sqrt();
    let has_interval = exact.half_width().is_finite();
    let at_least = |arm: f64| {
        if !is_smooth(run.statistic) || has_interval && arm >= TYPICAL * least {
            arm
        } else if arm.is_finite() {
            arm.max(least)
        } else {
            least
        }
    };
    let [run_below, run_above] = arms(run);
    let [exact_below, exact_above] = arms(exact).map(at_least);
    let below = run_below.hypot(exact_above);
    let above = run_above.hypot(exact_below);
    let uncertainty = below.max(above) + DEFAULT_TOLERANCE * exact.estimate.abs();
    let estimate = run.estimate - exact.estimate;
    let is_bounded = run.half_width().is_finite() && below.is_finite() && above.is_finite();
    (estimate.is_finite() && is_bounded).then_some(Bias {
        estimate,
        uncertainty,
        order: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mean with this standard error and interval.
    fn mean(estimate: f64, standard_error: f64, [low, high]: [f64; 2]) -> Estimate {
        Estimate {
            statistic: Statistic::StickDurationMean,
            estimate,
            standard_error,
            low,
            high,
            bias: None,
        }
    }

    fn median(e: Estimate) -> Estimate {
        Estimate {
            statistic: Statistic::StickDurationMedian,
            ..e
        }
    }

    const NOWHERE: [f64; 2] = [f64::NAN; 2];

    fn uncertainty(run: Estimate, exact: Estimate, more_paths: f64) -> f64 {
        let bias = difference(&run, &exact, more_paths).expect("bounded");
        assert_eq!(bias.estimate, run.estimate - exact.estimate);
        (bias.uncertainty - DEFAULT_TOLERANCE * exact.estimate.abs()) / NORMAL
    }

    /// The squares of 3 and 4 add to that of 5, whatever the intervals.
    #[test]
    fn the_squares_of_two_standard_errors_add() {
        let (run, exact) = (mean(9.0, 3.0, [2.0, 14.0]), mean(7.0, 4.0, [0.0, 30.0]));
        assert!((uncertainty(run, exact, 1.0) - 5.0).abs() < 1e-12);
        // All paths of the run agree, and its interval allows for 3 standard errors.
        let agreeing = mean(9.0, 0.0, [9.0, 9.0 + 3.0 * NORMAL]);
        assert!((uncertainty(agreeing, exact, 1.0) - 5.0).abs() < 1e-12);
    }

    /// The median of the run is 4, in [4, 7], and that of the reference run is 1, in [1, 5]. The
    /// bias is 3, and may be lower by sqrt(0 + 4^2) or higher by sqrt(3^2 + 0). The uncertainty is
    /// the longer side. Half the width of the two intervals, 2.5, would cover neither side.
    #[test]
    fn the_uncertainty_of_a_median_is_that_of_the_longer_side() {
        let of = |estimate, low, high| median(mean(estimate, 0.1, [low, high]));
        let found = uncertainty(of(4.0, 4.0, 7.0), of(1.0, 1.0, 5.0), 1.0);
        assert!((found - 4.0 / NORMAL).abs() < 1e-12, "{found}");
        let found = uncertainty(of(4.0, 1.0, 4.0), of(1.0, -3.0, 1.0), 1.0);
        assert!((found - 4.0 / NORMAL).abs() < 1e-12, "{found}");
    }

    /// The run has a standard error of 0.3 and a hundred times as many paths as the reference run,
    /// whose error is therefore 3. The reference run says that it is 0 or 1, because it has no rare
    /// event, or 4 without an interval. It is right if it says 1.6.
    #[test]
    fn a_reference_run_is_no_more_certain_than_the_run_says() {
        let run = mean(1.2, 0.3, [0.6, 1.8]);
        for (own, interval, used) in [
            (0.0, [1.0, 1.0], 3.0),
            (1.0, [-1.0, 3.0], 3.0),
            (1.6, [-2.0, 4.0], 1.6),
            (1.6, NOWHERE, 3.0),
            (4.0, NOWHERE, 4.0),
            (f64::NAN, NOWHERE, 3.0),
            (4.0, [0.0, f64::INFINITY], 4.0),
            (0.0, NOWHERE, 3.0),
        ] {
            let found = uncertainty(run, mean(1.0, own, interval), 100.0);
            assert!(
                (found - f64::hypot(0.3, used)).abs() < 1e-12,
                "{own}: {found}"
            );
        }
        let narrow = mean(1.0, 0.1, [1.0 - 0.1 * NORMAL, 1.0 + 0.1 * NORMAL]);
        let wide = mean(1.2, 0.3, [1.2 - 0.3 * NORMAL, 1.2 + 0.3 * NORMAL]);
        let found = uncertainty(median(wide), median(narrow), 100.0);
        assert!((found - f64::hypot(0.3, 0.1)).abs() < 1e-12, "{found}");
    }

    #[test]
    fn a_run_without_a_bounded_interval_has_no_bias() {
        let known = mean(4.0, 1.0, [2.0, 6.0]);
        for run in [NOWHERE, [0.0, f64::INFINITY]] {
            assert_eq!(difference(&mean(4.0, 1.0, run), &known, 1.0), None);
        }
        let missing = mean(f64::NAN, f64::NAN, NOWHERE);
        assert_eq!(difference(&missing, &known, 1.0), None);
        assert_eq!(difference(&known, &missing, 1.0), None);
    }
}
