//! `mc replay`: simulates one path of a stored ensemble again, with its events and the finest
//! trajectory that its scheme has.

use crate::arguments::extension::writable_hdf5;
use crate::inputs::files;
use crate::inputs::results;
use crate::session::progress::during;
use crate::{Failure, note, print};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use stickslip::engine::{self, ReplayRows, Status};
use stickslip::ensemble::Plan;
use stickslip::scenario::Scenario;
use stickslip::stats::Record;
use stickslip_files::store::{self, Writer};

/// Arguments of `mc replay`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/replay.txt"))]
pub struct Arguments {
    /// A file that `mc run` wrote
    file: PathBuf,
    /// Number of the path, from 0
    #[arg(long, value_name = "N")]
    path: u64,
    /// Output file [default: FILE-path-N.h5 in the current directory]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrite the file if it exists
    #[arg(long)]
    force: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let stored = files::read(&self.file, store::read)?;
        results::check_path(&stored, self.path)?;
        let scenario = results::scenario(&self.file.display().to_string(), &stored, &[])?;
        if let Some(other) = stored.header.program.other() {
            note(&format!("warning: {} was {other}", self.file.display()));
        }
        self.check_path(&scenario)?;
        let default = || results::default_output(&self.file, &format!("-path-{}.h5", self.path));
        let output = self.output.clone().unwrap_or_else(default);
        writable_hdf5(&output, self.force, [self.file.as_path()])?;
        replay(&scenario, self.path, &output, self.force)
    }

    /// Checks that the path is the one that the file holds.
    fn check_path(&self, scenario: &Scenario) -> Result<(), Failure> {
        if self.file.is_dir() || !self.file.exists() {
            // An unfinished run has no rows of paths yet.
            return Ok(());
        }
        let Some(held) = store::read_path(&self.file, self.path)? else {
            return Ok(());
        };
        let record = Record {
            paths: true,
            ..Record::NOTHING
        };
        let plan = Plan {
            record,
            ..scenario.plan()
        };
        let again = during("simulating the path again", || plan.replay(self.path));
        let made = again.rows.path_columns.unwrap_or_default();
        if held.is_same(&made) {
            return Ok(());
        }
        Err(Failure::run_of(
            &self.file,
            format!(
                "path {} of its scenario differs from the one in the file",
                self.path
            ),
            "use the unmodified file (its scenario, seed or rows were changed), or the program that wrote it",
        ))
    }
}

/// Simulates one path, writes it, and prints its events.
fn replay(scenario: &Scenario, path: u64, output: &Path, force: bool) -> Result<(), Failure> {
    let replay = during("simulating the trajectory", || {
        engine::Replay::of(scenario, path)
    });
    note(&format!("trajectory: {}", rows(replay.rows)));
    let mut writer = Writer::create(output, &replay.provenance(), &replay.record, force)?;
    writer.append(&replay.block.rows)?;
    writer.finish(&replay.block.totals.summary(), Status::Complete)?;
    print(&format!("path {path}\n"))?;
    if replay.is_lost() {
        let why = scenario.plan().why_lost(path, &AtomicBool::new(false));
        return print(&why.map_or("it diverged\n".to_string(), |why| {
            format!("it was given up: {why}\n")
        }));
    }
    let events = replay.block.rows.events.unwrap_or_default();
    print(&format!(
        "{:>6} {:>14} {:>14} {:>14}\n",
        "event", "time", "displacement", "force b"
    ))?;
    for i in 0..events.time.len() {
        let what = ["stick", "slip", "turn"][events.kind[i] as usize & 3];
        let (time, displacement, force) = (events.time[i], events.displacement[i], events.force[i]);
        print(&format!(
            "{what:>6} {time:14.6} {displacement:14.6} {force:14.6}\n"
        ))?;
    }
    let columns = replay.block.rows.path_columns.unwrap_or_default();
    print(&format!(
        "x(t_end) {}, {} sticks; in {}\n",
        columns.displacement_end[0],
        columns.sticks[0],
        output.display()
    ))
}

/// How fine the rows of the trajectory are, in words.
fn rows(rows: ReplayRows) -> String {
    match rows {
        ReplayRows::Steps { stride: 1, .. } => "every step".into(),
        ReplayRows::Steps { stride, of } => format!("one in {stride} of the {of} steps"),
        ReplayRows::Finer(times) => format!("{times} times finer than the output grid of the run"),
    }
}
