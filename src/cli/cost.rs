//! What a run will need, estimated before it begins: time and memory.

use super::failure::{Failure, note};
use super::numbers::{bytes, counted, time};
use std::time::Duration;
use stick_slip::advice::Derived;
use stick_slip::scenario::Scenario;
use stick_slip::study::pace::seconds_per_path;

/// Approximate CPU seconds of one step of one path of a discrete scheme, on a processor of about
/// 2025.
const PATH_STEP: f64 = 1.5e-9;
/// A run that is expected to take more seconds than this is announced or warned about.
pub const LONG: f64 = 3600.0;
/// How long paths are simulated to measure the time of a path.
const MEASURING_TIME: Duration = Duration::from_millis(100);
/// If the work of a path is not known beforehand, only runs of at least so many paths are timed
/// before they begin.
const MANY: u64 = 100_000;
/// Bytes of the program itself (`PROGRAM`), and of the sums for one row of the output grid (`ROW`).
/// Measured: 253 MB with 10 001 rows on one thread, and 105 MB more with a second thread.
const PROGRAM: f64 = 50e6;
const ROW: f64 = 10e3;
/// How many blocks each thread holds in memory with what is recorded of single paths: one that is
/// simulated, one that waits for its turn, one that is being written. Measured: 2.3.
const BLOCKS: f64 = 3.0;

/// CPU seconds of all paths of a scenario on this machine, from the time that some of its paths
/// take. Where they take too long to be timed, the seconds follow from the number of steps. None if
/// that is not known either.
pub fn measured_cpu_seconds(scenario: &Scenario) -> Option<f64> {
    cpu_seconds_of(scenario, scenario.ensemble.paths)
}

/// The same of so many paths.
pub fn cpu_seconds_of(scenario: &Scenario, paths: u64) -> Option<f64> {
    seconds_per_path(scenario, MEASURING_TIME).map(|each| each * paths as f64).or_else(|| cpu_seconds(scenario, paths))
}

/// CPU seconds of so many paths. None if the number of steps is not known beforehand.
fn cpu_seconds(scenario: &Scenario, paths: u64) -> Option<f64> {
    scenario.steps().map(|steps| steps as f64 * paths as f64 * PATH_STEP)
}

/// Approximate bytes of memory that a run needs.
fn memory(scenario: &Scenario, threads: usize) -> f64 {
    let Derived { rows, thread_bytes, .. } = scenario.derived();
    PROGRAM + rows as f64 * ROW + threads as f64 * (thread_bytes + BLOCKS * scenario.block_bytes())
}

/// Announces a run that takes long. Refuses a run that does not fit into the memory.
pub fn announce(scenario: &Scenario, paths: u64, threads: usize, is_quiet: bool) -> Result<(), Failure> {
    let needed = memory(scenario, threads);
    if let Some(free) = free_memory().filter(|free| *free < needed) {
        let problem = format!(
            "a run of {} rows on {} takes about {} of memory, and {} are free",
            scenario.timeline().rows(),
            counted(threads as u64, "thread"),
            bytes(needed),
            bytes(free)
        );
        return Err(Failure::usage(
            problem,
            "give fewer --threads, a larger `time.output_step`, or record less of single paths",
        ));
    }
    if is_quiet {
        return Ok(());
    }
    let seconds = match scenario.steps() {
        Some(_) => cpu_seconds(scenario, paths),
        None if paths < MANY => None,
        None => seconds_per_path(scenario, MEASURING_TIME).map(|each| each * paths as f64),
    };
    if let Some(seconds) = seconds.map(|seconds| seconds / threads as f64).filter(|seconds| *seconds > LONG) {
        note(&format!(
            "this takes about {} on {}; --max-time bounds it, and Ctrl-C saves it",
            time(seconds),
            counted(threads as u64, "thread")
        ));
    }
    Ok(())
}

/// Bytes of memory that this process can still get; none where the system does not say.
fn free_memory() -> Option<f64> {
    let number = |file: &str, name: &str| -> Option<f64> {
        let text = std::fs::read_to_string(file).ok()?;
        let line = text.lines().find_map(|line| line.strip_prefix(name))?;
        line.split_whitespace().next()?.parse().ok()
    };
    let machine = number("/proc/meminfo", "MemAvailable:").map(|kilobytes| kilobytes * 1024.0);
    // The limit that `ulimit -v` has set. It counts address space, so it includes the libraries and
    // the stacks of threads.
    let limit = number("/proc/self/limits", "Max address space");
    [machine, limit].into_iter().flatten().reduce(f64::min)
}
