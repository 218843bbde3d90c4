//! `mc show`: the results in a file, and where they come from.

use super::failure::{Failure, print};
use super::report::{self, RunInfo};
use super::results;
use super::terminal::Letters;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use stick_slip::provenance::Provenance;
use stick_slip::scenario::Scenario;
use stick_slip::store::{self, Stored};

/// Arguments of `mc show`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  mc show rho025.h5\n  mc show rho025.h5 --plot\n  mc show rho025.h5 --json | jq .statistics"
)]
pub struct Show {
    /// A file that `mc run` wrote
    file: PathBuf,
    /// Print one JSON object instead
    #[arg(long)]
    json: bool,
    /// Add histograms of stick durations and sub-phases, and the share of sticks that last longer, drawn with letters
    #[arg(long, conflicts_with = "json")]
    plot: bool,
}

impl Show {
    pub fn call(&self) -> Result<(), Failure> {
        let stored = store::read(&self.file)?;
        let scenario = Scenario::parse("scenario", &stored.header.scenario_text, &[]).ok();
        let info = info(&self.file, &stored, scenario.as_ref());
        if let Some(scenario) = &scenario {
            results::warn(scenario, stored.summary.has_bias());
        }
        results::warn_of_bias(&stored.summary);
        if self.json {
            return print(&report::json(&stored.summary, &info));
        }
        let mut text = report::table(&stored.summary, &info);
        if self.plot {
            text.push('\n');
            text += &report::plots(&stored.summary, &info.units, Letters::of_locale());
            text.push('\n');
        }
        print(&(text + &provenance(&stored.header)))
    }
}

fn info(file: &Path, stored: &Stored, scenario: Option<&Scenario>) -> RunInfo {
    let Stored { header, status, ended_by, .. } = stored;
    RunInfo {
        scenario: header.title.clone(),
        title: header.title.clone(),
        scheme: header.scheme.clone(),
        step: header.step,
        resolution: header.resolution,
        seed: header.seed,
        paths: header.paths,
        antithetic: header.antithetic,
        threads: None,
        seconds: None,
        bias_seconds: None,
        no_bias: scenario
            .and_then(|scenario| scenario.bias_plan(stored.summary.completed_paths).err())
            .map(|reason| reason.to_string()),
        steps_per_path: scenario.and_then(Scenario::steps),
        file: file.display().to_string(),
        status: *status,
        ended_by: ended_by.clone(),
        units: header.units.clone(),
    }
}

fn provenance(header: &Provenance) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "written by mc {} ({})", header.program_version, header.git_hash);
    let _ = writeln!(text, "noise   {}, seed {}", header.generator, header.seed);
    let _ = writeln!(text, "blocks  of {} paths\n", header.block_size);
    let _ = writeln!(text, "scenario:");
    for line in header.scenario_text.lines() {
        let _ = writeln!(text, "{}", format!("  {line}").trim_end());
    }
    text
}
