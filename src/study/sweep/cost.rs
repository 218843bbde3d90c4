//! A rough prediction of the time that a sweep takes, from a few paths at a few of its points.

use super::SweepQuestion;
use crate::ensemble::BLOCK_SIZE;
use crate::study::path_cost::seconds_per_path;
use std::time::Duration;

/// Number of points that are timed, spread evenly over all points.
const TIMED: usize = 12;

/// CPU time that all timings take together.
const MAX_TIMING: Duration = Duration::from_secs(3);

/// Estimating the bias of the step costs up to this share of a run in addition.
const BIAS_SHARE: f64 = 0.125;

/// Rough number of wall-clock seconds that a sweep takes on this number of threads of an idle
/// machine; `None` if no path progressed far enough for an estimate.
pub fn estimated_seconds(question: &SweepQuestion, threads: usize) -> Option<f64> {
    let points = &question.points;
    let timed = TIMED.min(points.len());
    let scenarios = (0..timed).map(|k| &points[(2 * k + 1) * points.len() / (2 * timed)]);
    let of_path: Vec<f64> = scenarios
        .filter_map(|scenario| seconds_per_path(scenario, MAX_TIMING / TIMED as u32))
        .collect();
    let mean = (!of_path.is_empty()).then(|| of_path.iter().sum::<f64>() / of_path.len() as f64)?;
    let all: f64 = points.iter().map(|point| point.ensemble.paths as f64).sum();
    let has_bias = question.with_bias && question.scenario.scheme.step().is_some();
    let bias = if has_bias { 1.0 + BIAS_SHARE } else { 1.0 };
    // A sweep takes at least as long as one block on one thread.
    Some(mean * (all / threads as f64).max((BLOCK_SIZE as f64).min(all)) * bias)
}
