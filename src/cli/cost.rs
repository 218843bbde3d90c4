//! What a run will take, before it begins: time and memory.

use super::failure::{Failure, note};
use super::numbers::{bytes, counted, time};
use std::time::Duration;
use stick_slip::advice::Derived;
use stick_slip::scenario::Scenario;
use stick_slip::study::pace::seconds_per_path;

/// CPU seconds of a path-step of the discrete schemes, roughly, on a processor of these years.
const PATH_STEP: f64 = 1.5e-9;
/// Runs that are expected to take longer than these seconds are warned of.
pub const LONG: f64 = 3600.0;
/// How long paths are simulated to find out how long they take.
const PATIENCE: Duration = Duration::from_millis(100);
/// A run of fewer paths, of a scheme whose work is not known beforehand, begins without a measurement.
const MANY: u64 = 100_000;
/// Bytes of the program itself, and of the sums of a row of the output grid. Measured: 253 MB with 10 001 rows on one thread, and
/// 105 MB more with a second one.
const PROGRAM: f64 = 50e6;
const ROW: f64 = 10e3;
/// Blocks of which a thread holds what is recorded of single paths: one in work, one that waits, one that is written. Measured: 2.3.
const BLOCKS: f64 = 3.0;

/// CPU seconds of the paths of a scenario on this machine, as some of them say; where they do not come far enough to say anything,
/// the number of steps does.
pub fn measured_cpu_seconds(scenario: &Scenario) -> Option<f64> {
    let paths = scenario.ensemble.paths;
    seconds_per_path(scenario, PATIENCE).map(|each| each * paths as f64).or_else(|| cpu_seconds(scenario, paths))
}

/// CPU seconds of so many paths, where the number of their steps is known.
fn cpu_seconds(scenario: &Scenario, paths: u64) -> Option<f64> {
    scenario.steps().map(|steps| steps as f64 * paths as f64 * PATH_STEP)
}

/// Bytes of memory that a run takes, roughly.
fn memory(scenario: &Scenario, threads: usize) -> f64 {
    let Derived { rows, thread_bytes, .. } = scenario.derived();
    PROGRAM + rows as f64 * ROW + threads as f64 * (thread_bytes + BLOCKS * scenario.block_bytes())
}

/// Say what takes long, and refuse what does not fit.
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
        None => seconds_per_path(scenario, PATIENCE).map(|each| each * paths as f64),
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

/// Bytes of memory that this process may still have; none where the system does not say.
fn free_memory() -> Option<f64> {
    let number = |file: &str, name: &str| -> Option<f64> {
        let text = std::fs::read_to_string(file).ok()?;
        let line = text.lines().find_map(|line| line.strip_prefix(name))?;
        line.split_whitespace().next()?.parse().ok()
    };
    let machine = number("/proc/meminfo", "MemAvailable:").map(|kilobytes| kilobytes * 1024.0);
    // What a shell has allowed with `ulimit -v`; the library and the stacks of threads are within it.
    let limit = number("/proc/self/limits", "Max address space");
    [machine, limit].into_iter().flatten().reduce(f64::min)
}
