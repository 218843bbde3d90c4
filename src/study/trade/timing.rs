//! CPU times of paths.

use super::setting::Cost;
use crate::ensemble::Plan;
use crate::scenario::Scenario;
use crate::scheme::{CheckError, Scheme};
use crate::study::clock::thread_seconds;

/// The ensemble that a scheme simulates for the estimates, those on request included, without an
/// output grid and without rows of single paths.
pub(super) fn bare_plan(scenario: &Scenario, scheme: Scheme) -> Result<Plan, CheckError> {
    let mut scenario = scenario.with_scheme(scheme)?;
    scenario.time.output_step = scenario.time.end;
    scenario.record = scenario.record.of_no_path();
    Ok(scenario.plan())
}

/// CPU seconds that `paths` paths take on this thread.
pub(super) fn timed(plan: &Plan, paths: u64) -> f64 {
    let start = thread_seconds();
    std::hint::black_box(plan.piece(0, paths));
    thread_seconds() - start
}

/// Number of repetitions of a timing. The shortest one counts, because disturbances only make a
/// timing longer.
const REPETITIONS: usize = 3;
/// Numbers of paths per timing: the second if it fits into the time for timing, else the first.
const TIMED_PATHS: [u64; 2] = [32, 256];

/// The cost of the paths of an ensemble, measured for about this many CPU seconds.
pub(super) fn cost(plan: &Plan, seconds: f64) -> Cost {
    let least = |paths: u64| {
        (0..REPETITIONS)
            .map(|_| timed(plan, paths))
            .fold(f64::INFINITY, f64::min)
    };
    let [few, many] = TIMED_PATHS;
    // The first run only warms up tables, caches and the clock of the processor.
    let first = timed(plan, 1);
    if first * REPETITIONS as f64 > seconds {
        return Cost { first, each: first };
    }
    let first = least(1);
    let warm = timed(plan, few);
    let growth = (many / few) as f64 * REPETITIONS as f64;
    let paths = if warm * growth <= seconds { many } else { few };
    let each = if warm > seconds {
        warm / few as f64
    } else {
        least(paths) / paths as f64
    };
    Cost { first, each }
}
