//! Time and memory of a run, estimated before it begins.

use crate::arguments::threads::enough_memory;
use crate::output::failure::{Failure, note};
use crate::output::numbers::{counted, time};
use std::time::Duration;
use stickslip::scenario::Scenario;
use stickslip::study::path_cost::seconds_per_path;

/// Approximate CPU seconds of one step of one path of a discrete scheme, on a processor of about
/// 2025.
const PATH_STEP: f64 = 1.5e-9;
/// A run that is expected to take more seconds than this is announced or warned about.
pub const LONG: f64 = 3600.0;
/// How long paths are simulated to measure the time per path.
const MEASURING_TIME: Duration = Duration::from_millis(100);
/// If the work per path is not known in advance, only runs with at least this number of paths are
/// timed before they begin.
const MANY: u64 = 100_000;

/// CPU seconds of this number of paths of a scenario on this machine, measured with some of its
/// paths. If these take too long, the estimate follows from the number of steps. None if that is
/// not known either.
pub fn measured_cpu_seconds(scenario: &Scenario, paths: u64) -> Option<f64> {
    seconds_per_path(scenario, MEASURING_TIME)
        .map(|each| each * paths as f64)
        .or_else(|| cpu_seconds(scenario, paths))
}

/// CPU seconds of this number of paths. None if the number of steps is not known in advance.
fn cpu_seconds(scenario: &Scenario, paths: u64) -> Option<f64> {
    scenario
        .steps()
        .map(|steps| steps as f64 * paths as f64 * PATH_STEP)
}

/// Refuses a run that does not fit in memory.
pub fn check_memory(scenario: &Scenario, paths: u64, threads: usize) -> Result<(), Failure> {
    let run = format!(
        "a run of {}",
        counted(scenario.timeline().rows() as u64, "row")
    );
    enough_memory(&run, scenario.run_bytes(paths, threads), threads)
}

/// Announces a run that takes long.
pub fn announce(scenario: &Scenario, paths: u64, threads: usize) {
    let seconds = match cpu_seconds(scenario, paths) {
        None if paths >= MANY => measured_cpu_seconds(scenario, paths),
        known => known,
    };
    if let Some(seconds) = seconds
        .map(|seconds| seconds / threads as f64)
        .filter(|seconds| *seconds > LONG)
    {
        note(&format!(
            "this takes about {} on {}; bound it with --max-time, or press Ctrl-C to save and stop",
            time(seconds),
            counted(threads as u64, "thread")
        ));
    }
}
