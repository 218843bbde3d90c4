//! `mc trade`: measures what accuracy costs with each scheme, and which is the cheapest for a
//! target.

use crate::arguments::extension::writable_hdf5;
use crate::arguments::overrides::Settings;
use crate::commands::plot;
use crate::output::dataset;
use crate::output::numbers::{counted, parse_duration};
use crate::report;
use crate::session::progress::measuring;
use crate::{Failure, Threads, note, print, print_data, stop_on_signals, warn, writable};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Duration;
use stickslip::config::{Override, input_files};
use stickslip::dataset::Dataset;
use stickslip::scenario::Scenario;
use stickslip::stats::Statistic;
use stickslip::study::trade::{self, CostCurves, Limits, Trade, TradeError};
use stickslip_figure::{Style, Subject};
use stickslip_files::store;

/// Arguments of `mc trade`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/trade.txt"))]
pub struct Arguments {
    /// The scenario: a TOML file, or the name of a shipped one
    scenario: PathBuf,
    /// How long to measure, e.g. 60s, 5m, 1h; a plain number is seconds
    #[arg(long, value_name = "TIME", default_value = "30s", value_parser = budget)]
    budget: Duration,
    /// Statistic to plot [default: the first with an estimate]
    #[arg(long, value_name = "NAME", value_parser = crate::arguments::completion::STATISTIC, hide_possible_values = true)]
    statistic: Option<Statistic>,
    #[command(flatten)]
    set: Settings,
    /// Seed [ensemble.seed]
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    seed: Option<String>,
    #[command(flatten)]
    threads: Threads,
    /// Write all measurements to FILE, and a picture next to it as SVG and PNG
    #[arg(short, long, value_name = "FILE.h5")]
    output: Option<PathBuf>,
    /// Overwrite earlier files
    #[arg(long, requires = "output")]
    force: bool,
    /// Print only one JSON object to standard output
    #[arg(long)]
    json: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let mut overrides = self.set.list()?;
        overrides.extend(
            self.seed
                .iter()
                .map(|seed| Override::flag("--seed", "ensemble.seed", seed)),
        );
        let scenario = Scenario::read(&self.scenario, &overrides)?;
        if let Some(output) = &self.output {
            self.refuse_to_lose(output, &input_files(&self.scenario, &overrides))?;
        }
        let used = scenario.run_bytes(scenario.ensemble.paths, self.threads.number());
        let threads = self.threads.ready("a measurement of this scenario", used)?;
        note(&format!(
            "measuring for about {} s on {}",
            self.budget.as_secs(),
            counted(threads as u64, "thread")
        ));
        let stop = stop_on_signals()?;
        let measure =
            |limits: Limits<'_>| trade::measure_within(&scenario, self.budget, threads, limits);
        let trade = measuring(self.budget, false, &stop, measure)?;
        let shown = self
            .statistic
            .or_else(|| trade.answerable().first().copied());
        let asked = shown.map(|statistic| (self.scenario.as_path(), statistic));
        if let Some(output) = &self.output {
            self.write(output, &scenario, &trade, shown)?;
        }
        match self.json {
            true => print_data(&dataset::json(
                &Dataset::of_trade(&scenario, &trade),
                self.output.as_deref(),
            ))?,
            false => print(&report::text(&report::trade(
                &scenario.title,
                &trade,
                asked,
            )))?,
        }
        if stop.load(Ordering::Relaxed) {
            Err(Failure::Interrupted)
        } else {
            Ok(())
        }
    }

    fn refuse_to_lose(&self, output: &Path, inputs: &[PathBuf]) -> Result<(), Failure> {
        if pictures(output).iter().any(|picture| picture == output) {
            let problem = format!("{} has the extension of a picture", output.display());
            return Err(Failure::usage(
                problem,
                "name the HDF5 file, e.g. -o trade.h5; the pictures go next to it",
            ));
        }
        writable_hdf5(output, self.force, inputs)?;
        pictures(output)
            .iter()
            .try_for_each(|picture| writable(picture, self.force, inputs))
    }

    fn write(
        &self,
        output: &Path,
        scenario: &Scenario,
        trade: &Trade,
        shown: Option<Statistic>,
    ) -> Result<(), Failure> {
        store::write_dataset(output, Dataset::of_trade(scenario, trade), self.force)?;
        let costs = shown.map(|statistic| CostCurves::of(trade, statistic, scenario));
        let draw = |costs: &CostCurves| {
            stickslip_figure::page(
                stickslip_figure::TRADE.iter(),
                &Subject::Trade(costs),
                &Style::default(),
            )
            .ok()
        };
        let Some(scene) = costs.as_ref().and_then(draw) else {
            let why = shown.map_or("no statistic can be estimated".to_string(), |s| {
                trade.standing(s).to_string()
            });
            warn(format!("no picture: {why}"));
            return Ok(());
        };
        let [svg, png] = pictures(output);
        plot::write(&scene, &svg, self.force)?;
        plot::write(&scene, &png, self.force)
    }
}

/// The names of the SVG and the PNG next to a file.
fn pictures(output: &Path) -> [PathBuf; 2] {
    ["svg", "png"].map(|extension| output.with_extension(extension))
}

/// The longest budget, a week. A longer one is probably a typing error.
const LONGEST: Duration = Duration::from_secs(7 * 86_400);

/// Reads a time: 60s, 5m, 1h, or plain seconds.
fn budget(text: &str) -> Result<Duration, String> {
    let sensible = Duration::from_secs(1)..=LONGEST;
    let budget = parse_duration(text)
        .ok()
        .filter(|budget| sensible.contains(budget));
    budget.ok_or_else(|| "must be between one second and a week, e.g. 60s, 5m or 1h".to_string())
}

impl From<TradeError> for Failure {
    fn from(error: TradeError) -> Self {
        match error {
            TradeError::CheckError(check_error) => Failure::from(check_error),
            TradeError::NothingHappens => Failure::Refused(error.to_string()),
            TradeError::BudgetTooSmall { .. } => {
                Failure::run(error, "measure longer with --budget, or shorten `time.end`")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_a_number_with_a_unit() {
        for (text, seconds) in [
            ("60s", 60),
            ("5m", 300),
            ("1h", 3600),
            ("90", 90),
            ("1.5m", 90),
            ("2 days", 172_800),
        ] {
            assert_eq!(budget(text), Ok(Duration::from_secs(seconds)), "{text}");
        }
        for text in [
            "", "s", "0", "-3s", "0.5", "nan", "inf", "1e9h", "5 years", "s5",
        ] {
            assert!(budget(text).is_err(), "{text}");
        }
    }
}
