//! `mc replay`: one path of a stored ensemble alone, with its events and as fine a trajectory as it has.

use super::failure::{Failure, note, print, writable};
use super::results;
use std::path::{Path, PathBuf};
use stick_slip::ensemble::Plan;
use stick_slip::scenario::{MAX_ROWS, MAX_TRAJECTORIES, Scenario};
use stick_slip::stats::Record;
use stick_slip::store::{self, Header, Status};

const EXAMPLE: &str = "\
Example:
  mc replay rho025.h5 --path 4711 -o path-4711.h5

The trajectory holds every step of a time-stepping scheme, or every so many where there would be more than 10000 rows.
Without noise, an event-driven or quasi-static trajectory is ten times finer than the run's output grid; with noise it stays
on that grid, whose instants are part of what the path draws. The events are always all there.";

/// Arguments of `mc replay`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLE)]
pub struct Replay {
    /// A file that `mc run` wrote
    file: PathBuf,
    /// Number of the path, from 0
    #[arg(long, value_name = "N")]
    path: u64,
    /// Where to write it [default: FILE-path-N.h5 in the current directory]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrite the file if it exists
    #[arg(long)]
    force: bool,
}

impl Replay {
    pub fn call(&self) -> Result<(), Failure> {
        let stored = store::read(&self.file)?;
        // Any path can be simulated, but one the ensemble does not have is more likely a slip of the pen.
        if self.path >= stored.header.paths {
            let problem = format!("--path {}: the ensemble has {} paths", self.path, stored.header.paths);
            let remedy = format!("give a number from 0 to {}", stored.header.paths.saturating_sub(1));
            return Err(Failure::usage(problem, remedy));
        }
        let scenario = Scenario::parse(&self.file.display().to_string(), &stored.header.scenario_text, &[])?;
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let output = self.output.clone().unwrap_or_else(|| format!("{stem}-path-{}.h5", self.path).into());
        writable(&output, self.force)?;
        replay(scenario, self.path, &output, self.force)
    }
}

/// Simulate one path, keep its events and its trajectory, write them.
fn replay(mut scenario: Scenario, path: u64, output: &Path, force: bool) -> Result<(), Failure> {
    let (output_step, remark) = finest_grid(&scenario);
    scenario.time.output_step = output_step;
    let record = Record { paths: true, events: true, trajectories: path + 1 };
    // What the file says must read back as a scenario, and no scenario keeps more.
    scenario.record = Record { trajectories: record.trajectories.min(MAX_TRAJECTORIES), ..record };
    note(&remark);
    let block = Plan { record, ..scenario.plan() }.replay(path);
    let has_step = scenario.scheme.step().is_some();
    // A file of one path, whatever its number in the ensemble.
    let header = Header { paths: 1, ..results::header(&scenario) };
    let mut writer = results::start(&header, &record, output, force)?;
    writer.append(&block)?;
    let summary = block.totals.summary();
    writer.finish(&summary, Status::Complete)?;
    let columns = block.path_columns.unwrap_or_default();
    print(&format!("path {path}\n"))?;
    if summary.diverged.contains(&path) {
        return print(if has_step { "it diverged\n" } else { "it was given up\n" });
    }
    let events = block.events.unwrap_or_default();
    print(&format!("{:>6} {:>14} {:>14} {:>14}\n", "event", "time", "displacement", "force b"))?;
    for i in 0..events.time.len() {
        let what = ["stick", "slip", "turn"][events.kind[i] as usize & 3];
        let line =
            format!("{what:>6} {:14.6} {:14.6} {:14.6}\n", events.time[i], events.displacement[i], events.force[i]);
        print(&line)?;
    }
    print(&format!("x(t_end) {}, {} sticks; in {}\n", columns.displacement_end[0], columns.sticks[0], output.display()))
}

/// How many times finer than the run's grid a trajectory is where that is free: without steps, and without noise.
const REFINEMENT: usize = 10;

/// The spacing of the finest trajectory that is the same path and has no more than [`MAX_ROWS`] rows, and what it is in words.
fn finest_grid(scenario: &Scenario) -> (f64, String) {
    let time = &scenario.time;
    let most = MAX_ROWS as u64 - 1;
    if let (Some(step), Some(steps)) = (scenario.scheme.step(), scenario.steps()) {
        let stride = stride(steps, most);
        let what = if stride == 1 { "every step".into() } else { format!("one in {stride} of the {steps} steps") };
        return (stride as f64 * step, format!("trajectory: {what}"));
    }
    if scenario.model.temperature.is_random() {
        // Observed at other instants, the scheme draws other numbers: that would be another path.
        return (time.output_step, "trajectory: on the output grid of the run".into());
    }
    let rows = scenario.timeline().rows().saturating_sub(1);
    let refinement = (most as usize).checked_div(rows).unwrap_or(1).clamp(1, REFINEMENT);
    (
        time.output_step / refinement as f64,
        format!("trajectory: {refinement} times as fine as the output grid of the run"),
    )
}

/// The least number of steps between rows that makes no more than `most` rows besides the first; one that divides the steps, if
/// there is one up to twice that.
fn stride(steps: u64, most: u64) -> u64 {
    let least = steps.div_ceil(most).max(1);
    (least..=2 * least).take(MAX_ROWS).find(|stride| steps.is_multiple_of(*stride)).unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stick_slip::config::Override;

    fn scenario(name: &str, set: &[&str]) -> Scenario {
        let text = stick_slip::config::shipped(name).expect("shipped").text;
        let set: Vec<Override> = set.iter().map(|set| Override::set(set).expect("well formed")).collect();
        Scenario::parse(name, text, &set).expect("sound")
    }

    #[test]
    fn a_stride_keeps_the_rows_within_bounds_and_ends_at_the_end_where_it_can() {
        assert_eq!([0, 1, 9_999, 10_000, 60_000, 10_000_000].map(|steps| stride(steps, 9_999)), [1, 1, 1, 2, 8, 1_250]);
        for steps in [10_007, 99_991, 123_457, 1 << 53] {
            assert!(steps / stride(steps, 9_999) <= 9_999, "{steps}");
        }
    }

    #[test]
    fn the_grid_of_a_replay_is_never_too_long_and_still_a_scenario() {
        for (name, set, spacing) in [
            ("rho025", &[][..], 0.01),
            ("rho025", &["time.step=1e-6"], 0.00625),
            ("rho025", &["scheme.kind=event-driven"], 0.5),
            ("shaw", &["scheme.kind=event-driven"], 0.05),
            ("shaw", &["scheme.kind=quasi-static", "time.output_step=0.01"], 0.01),
            ("viaduct", &[], 3600.0),
        ] {
            let mut scenario = scenario(name, set);
            let (output_step, remark) = finest_grid(&scenario);
            assert!((output_step / spacing - 1.0).abs() < 1e-12, "{name} {set:?}: {output_step}");
            assert!(remark.starts_with("trajectory: "));
            scenario.time.output_step = output_step;
            assert!(scenario.timeline().rows() <= MAX_ROWS);
            assert_eq!(Scenario::parse(name, &scenario.to_toml(), &[]).expect("sound"), scenario);
        }
    }
}
