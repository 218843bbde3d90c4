//! `mc forecast`: simulates future years of a measured bearing.

use super::STUDY_BYTES;
use super::measurements::Source;
use super::years::Years;
use crate::kinds::AnyResult as _;
use crate::output::numbers::parse_share_in;
use crate::report::text;
use crate::session::progress::waiting;
use crate::{Failure, note, print, print_data, warn, writable};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use stickslip_bearing::forecast::{BearingForecast, Forecast, ForecastQuestion};
use stickslip_bearing::report;
use stickslip_data::remedy;
use stickslip_files::store;

/// Arguments of `mc forecast`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/forecast.txt"))]
pub struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Number of draws of the uncertain parameters of bearing and weather
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    draws: u32,
    /// Number of years to simulate for each draw
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    years: u32,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Report the fraction of time with |F| above this fraction of f_s
    #[arg(long, value_name = "Q", default_value_t = 0.9, value_parser = share)]
    share: f64,
    /// Largest number of Ornstein-Uhlenbeck processes in the weather: one, or a fast and a slow one
    #[arg(long, value_name = "1|2", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=2))]
    processes: u8,
    /// Write every year to FILE.csv, or a page for a browser to FILE.html; repeatable
    #[arg(short, long, value_name = "FILE.csv|FILE.html")]
    output: Vec<PathBuf>,
    /// Heading of the table and of the page [default: the title of the scenario]
    #[arg(long, value_name = "WORDS")]
    title: Option<String>,
    /// Overwrite an earlier file
    #[arg(long, requires = "output")]
    force: bool,
    /// Print only one JSON object to standard output
    #[arg(long)]
    json: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let mut scene = self.source.scene()?;
        scene.title = self.title.clone().unwrap_or(scene.title);
        for (i, output) in self.output.iter().enumerate() {
            let is_same = |other: &PathBuf| {
                std::path::absolute(other).ok() == std::path::absolute(output).ok()
            };
            if self.output[..i].iter().any(is_same) {
                return Err(Failure::usage(
                    format!("-o {} is given twice", output.display()),
                    "give it once",
                ));
            }
            if !is_page(output) && output.extension().is_none_or(|ending| ending != "csv") {
                let problem = format!("-o {}: unknown file extension", output.display());
                return Err(Failure::usage(problem, "use .csv or .html"));
            }
            writable(output, self.force, self.source.inputs()?)?;
        }
        let threads = self.source.threads.ready("this forecast", STUDY_BYTES)?;
        // Little work would be lost, so a signal ends the process at once.
        let stop = AtomicBool::new(false);
        let question = ForecastQuestion {
            draws: u64::from(self.draws),
            years: u64::from(self.years),
            seed: self.seed,
            level: self.source.interval,
            share: self.share,
        };
        let record = self.source.record(&scene)?;
        let outcome = waiting(|begins| {
            let processes = usize::from(self.processes);
            BearingForecast::of(
                &scene, &record, &question, processes, threads, &stop, begins,
            )
        })
        .map_err(|error| {
            let remedy = remedy(record.mark.as_deref(), error.remedy());
            Failure::run_of(self.source.shown(), &error, remedy)
        })?
        .ok_or(Failure::Interrupted)?;
        let warnings = outcome.warnings();
        warnings.iter().for_each(|(_, text)| warn(text));
        let years = Years {
            scene: &scene,
            found: &outcome,
        };
        let content = |output: &PathBuf| match is_page(output) {
            true => years.page(output),
            false => Ok(csv(&outcome.forecast)),
        };
        let contents = self.output.iter().map(content);
        let contents = contents.collect::<Result<Vec<String>, Failure>>()?;
        let files: Vec<(&Path, String)> = self
            .output
            .iter()
            .map(PathBuf::as_path)
            .zip(contents)
            .collect();
        store::write_together(&files, self.force)?;
        match self.json {
            true => print_data(&years.json(Path::new(""))?)?,
            false => print(&text(&report::forecast(
                &scene.title,
                &outcome.forecast,
                false,
            )))?,
        }
        for output in &self.output {
            let has = if is_page(output) {
                "is the page"
            } else {
                "has all years"
            };
            note(&format!("{} {has}", output.display()));
        }
        Ok(())
    }
}

fn is_page(output: &Path) -> bool {
    output.extension().is_some_and(|ending| ending == "html")
}

/// All simulated years as CSV, one row for each.
fn csv(found: &Forecast) -> String {
    let headings =
        found.levels.iter().map(
            |level| match (level.quantity.name(), level.quantity.unit()) {
                (name, "1") => format!(",{name}"),
                (name, unit) => format!(",{name}_{unit}"),
            },
        );
    let mut text = format!("draw,year{}\n", headings.collect::<String>());
    for (draw, years) in found.years.iter().enumerate() {
        for (number, year) in years.iter().enumerate() {
            let cells = found
                .levels
                .iter()
                .map(|level| format!(",{}", year[level.quantity as usize]));
            text += &format!("{draw},{number}{}\n", cells.collect::<String>());
        }
    }
    text
}

fn share(text: &str) -> Result<f64, String> {
    parse_share_in(
        text,
        &(0.0..1.0),
        "write a fraction of f_s, at least 0 and below 1",
    )
}
