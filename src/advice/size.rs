//! Estimates of the size of the output file and of the memory of a run.

use crate::ensemble::{BLOCK_SIZE, Plan};
use crate::model::Problem;
use crate::scenario::Scenario;
use crate::stats::column::Columns as _;
use crate::stats::{EventColumns, ON_THE_GRID, PathColumns, TrajectoryRows};
use std::f64::consts::PI;

/// Bytes of one row of the bands: the time; and x, x' and T, each with mean, sd and five quantiles,
/// and P(static), each of these with the two ends of its interval.
const ROW_BYTES: f64 = 8.0 * (3.0 * (3.0 * 7.0 + 1.0) + 1.0);
/// Bytes of the number of a path, and of one reading of a sensor at the bearing.
const NUMBER_BYTES: usize = 8;
const SENSOR_BYTES: usize = 8;
/// Bytes of a sample of a measured temperature: its time and its value.
const SAMPLE_BYTES: f64 = 8.0 * 2.0;
/// Bytes of a file without any data.
const EMPTY_BYTES: f64 = 65_536.0;

/// Bytes of the program itself, and of the sums for one row of the output grid: the minimum for few
/// paths, and the maximum for a block or more. Measured: 253 MB with 10 001 rows on one thread; and
/// with 20 001 rows 75 MB for 8 paths, 141 MB for 64 and 378 MB for 512 and more.
const PROGRAM_BYTES: f64 = 50e6;
const ROW_OF_ANY_BYTES: f64 = 2e3;
const SUMS_ROW_BYTES: f64 = 8e3;
/// Bytes of a full block for one row of the output grid, and of the tables of one thread. Measured
/// with 1 to 256 threads: 5.8 kB and 3.6 MB.
const BLOCK_ROW_BYTES: f64 = 6e3;
const TABLES_BYTES: f64 = 4e6;

impl Scenario {
    /// Estimated memory of a run with these numbers of paths and threads, in bytes.
    pub fn run_bytes(&self, paths: u64, threads: usize) -> f64 {
        let rows = self.timeline().rows() as f64;
        let together = BLOCK_SIZE.min(paths) as f64;
        let share = together / BLOCK_SIZE as f64;
        let block = share * rows * BLOCK_ROW_BYTES + rows_bytes(self, together);
        PROGRAM_BYTES
            + rows * (ROW_OF_ANY_BYTES + share * SUMS_ROW_BYTES)
            + threads as f64 * TABLES_BYTES
            + Plan {
                paths,
                ..self.plan()
            }
            .blocks_held(threads) as f64
                * block
    }
}

/// Bytes of the records of this many single paths.
fn rows_bytes(scenario: &Scenario, paths: f64) -> f64 {
    let record = &scenario.record;
    let events = scenario
        .steps()
        .map_or(f64::INFINITY, |steps| steps as f64)
        .min(events(scenario))
        + 1.0;
    let sensor = if scenario.bearing.is_some() {
        SENSOR_BYTES
    } else {
        0
    };
    let rows = scenario.timeline().rows() as f64;
    let of_path = (NUMBER_BYTES + PathColumns::bytes_along(&["path"])) as f64;
    let [count, of_event] =
        [["path"], ["event"]].map(|axes| EventColumns::bytes_along(&axes) as f64);
    let of_row = (TrajectoryRows::bytes_along(ON_THE_GRID) + sensor) as f64;
    let scalars = if record.paths { paths * of_path } else { 0.0 };
    let events = if record.events {
        paths * (count + events * of_event)
    } else {
        0.0
    };
    scalars + events + paths.min(record.trajectories as f64) * rows * of_row
}

/// Estimated size of the output file in bytes, uncompressed.
pub(super) fn output_bytes(scenario: &Scenario) -> f64 {
    let rows = scenario.timeline().rows() as f64;
    let samples: usize = scenario
        .written
        .measured
        .iter()
        .map(|measured| measured.series.times().len())
        .sum();
    EMPTY_BYTES
        + rows * ROW_BYTES
        + rows_bytes(scenario, scenario.ensemble.paths as f64)
        + samples as f64 * SAMPLE_BYTES
}

/// Number of events of a path, a rough estimate, rather too large. It is two (a slip and a stick)
/// per half-cycle of the oscillator, or two per slip that the temperature can cause, if that is
/// fewer. A slip releases 2 (f_s - f_d) of the force. A harmonic builds up (2/pi) K beta a w per
/// unit of time, and a series as much as it varies. The noise builds up 2 (f_s - f_d) in a time of
/// ((2 f_s
/// - 2 f_d)/(K beta rho sigma))^2.
fn events(scenario: &Scenario) -> f64 {
    let Problem {
        oscillator,
        friction,
        temperature,
        ..
    } = &scenario.model;
    let end = scenario.time.end;
    let half_cycles = end * oscillator.natural_frequency() / PI;
    let gap = 2.0 * (friction.static_force - friction.dynamic_force);
    let gain = oscillator.force_per_temperature().abs();
    let harmonic: f64 = temperature
        .harmonics
        .iter()
        .map(|h| gain * h.amplitude.abs() * h.angular_frequency)
        .sum();
    let measured = temperature
        .series
        .as_ref()
        .map_or(0.0, |series| gain * series.variation() / series.end());
    let trend = gain * temperature.trend.abs();
    let noise = temperature
        .effective_noises()
        .map(|noise| gain * noise.intensity * noise.diffusion)
        .fold(0.0, f64::hypot);
    let slips =
        end * (2.0 / PI * harmonic / gap + measured / gap + trend / gap + (noise / gap).powi(2));
    // Without a gap the number of slips is infinite or 0/0, and the half-cycles are used. Without a
    // spring there are none.
    let has_spring = oscillator.stiffness > 0.0;
    2.0 * if slips < half_cycles || (!has_spring && slips.is_finite()) {
        slips
    } else {
        half_cycles
    }
}
