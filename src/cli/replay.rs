//! `mc replay`: one path of a stored ensemble alone, with its events and every step.

use super::failure::{Failure, print, writable};
use super::results;
use std::path::{Path, PathBuf};
use stick_slip::scenario::Scenario;
use stick_slip::stats::Record;
use stick_slip::store::{self, Status};

/// Arguments of `mc replay`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  mc replay rho025.h5 --path 4711 -o path-4711.h5")]
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

/// Simulate one path, keep its events and its state at every step, write them.
fn replay(mut scenario: Scenario, path: u64, output: &Path, force: bool) -> Result<(), Failure> {
    scenario.time.output_step = scenario.time.step;
    scenario.record = Record { paths: true, events: true, trajectories: path + 1 };
    let block = scenario.plan().replay(path);
    let mut writer = results::create(&scenario, output, force)?;
    writer.append(&block)?;
    let summary = block.totals.summary();
    writer.finish(&summary, Status::Complete)?;
    let columns = block.path_columns.unwrap_or_default();
    print(&format!("path {path}\n"))?;
    if summary.diverged.contains(&path) {
        return print("it diverged\n");
    }
    let events = block.events.unwrap_or_default();
    for i in 0..events.time.len() {
        let what = ["stick", "slip", "turn"][events.kind[i] as usize & 3];
        let line =
            format!("{what:>6} {:14.6} {:14.6} {:14.6}\n", events.time[i], events.displacement[i], events.force[i]);
        print(&line)?;
    }
    print(&format!("x(t_end) {}, {} sticks; in {}\n", columns.displacement_end[0], columns.sticks[0], output.display()))
}
