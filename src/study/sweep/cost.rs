//! A rough prediction of the time that a sweep takes, from a few paths at a few of its points.

use super::Question;
use crate::ensemble::{BLOCK_SIZE, Plan};
use crate::scenario::{Ensemble, Scenario};
use crate::stats::Record;
use crate::study::clock::thread_seconds;
use std::time::{Duration, Instant};

/// Number of points that are timed, spread evenly over all points.
const TIMED: usize = 12;

/// Number of paths per timing, which fills the vector registers a few times.
const PATHS: u64 = 64;

/// Wall-clock time after which no further point is timed.
const MAX_TIMING: Duration = Duration::from_secs(3);

/// Estimating the bias of the step costs up to this share of a run in addition.
const BIAS_SHARE: f64 = 0.125;

/// Rough number of wall-clock seconds that a sweep takes on so many threads of an idle machine.
pub fn estimated_seconds(question: &Question, threads: usize) -> f64 {
    let points = &question.points;
    let start = Instant::now();
    let (mut seconds, mut paths) = (0.0, 0);
    for k in 0..TIMED.min(points.len()) {
        let scenario = &points[(2 * k + 1) * points.len() / (2 * TIMED.min(points.len()))];
        let timed = scenario.ensemble.paths.min(PATHS);
        seconds += cpu_seconds(scenario, timed);
        paths += timed;
        if start.elapsed() > MAX_TIMING {
            break;
        }
    }
    let all: f64 = points.iter().map(|point| point.ensemble.paths as f64).sum();
    let has_bias = question.with_bias && question.scenario.scheme.step().is_some();
    let bias = if has_bias { 1.0 + BIAS_SHARE } else { 1.0 };
    // A sweep takes at least as long as one block on one thread.
    seconds / paths as f64 * (all / threads as f64).max((BLOCK_SIZE as f64).min(all)) * bias
}

fn cpu_seconds(scenario: &Scenario, paths: u64) -> f64 {
    let timeline = scenario.timeline().without_rows();
    let simulation = scenario.scheme.simulation(&scenario.model, &timeline);
    let Ensemble { seed, antithetic, .. } = scenario.ensemble;
    let plan = Plan { simulation, record: Record::NOTHING, seed, paths, antithetic };
    let start = thread_seconds();
    std::hint::black_box(plan.piece(0, paths));
    thread_seconds() - start
}
