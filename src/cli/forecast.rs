//! `mc forecast`: simulates future years of a bearing that was measured.

use super::cost::STUDY_BYTES;
use super::document::{JsonWarning, document};
use super::fit_temperature::without_weather;
use super::html::{self, page::Section};
use super::measurements::Source;
use super::numbers::{Digits, grouped, parse_share_in, percent, wrapped};
use super::overrides::settings;
use super::{Failure, TableRow, Threads, aligned, calibrate, note, print, warn, writable};
use serde_json::json;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use stick_slip::bearing::calibration::{self, Calibration, CalibrationMethod};
use stick_slip::bearing::forecast::{Forecast, ForecastQuantity, ForecastQuestion, forecast};
use stick_slip::bearing::weather::{PERIODS, WeatherFit, fit};
use stick_slip::scenario::BridgeScene;
use stick_slip::store::{self, StoredCalibration};

/// Arguments of `mc forecast`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/forecast.txt"))]
pub struct Arguments {
    /// The scenario, a TOML file: the stiffness K_BP and the names of the columns
    scenario: PathBuf,
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
    /// Confidence level of the intervals
    #[arg(long, value_name = "P", default_value_t = 0.9, value_parser = calibrate::level)]
    interval: f64,
    /// Time counts as loaded where |F| is above this share of f_s
    #[arg(long, value_name = "Q", default_value_t = 0.9, value_parser = share)]
    share: f64,
    /// Largest number of Ornstein-Uhlenbeck processes in the weather: one, or a fast and a slow one
    #[arg(long, value_name = "1|2", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=2))]
    processes: u8,
    /// Any key of the scenario, e.g. bearing.stiffness=2e9; repeatable
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true, value_parser = super::completed::SETTING,
          hide_possible_values = true)]
    set: Vec<String>,
    #[command(flatten)]
    threads: Threads,
    /// Write every year to FILE.csv, or a page for a browser to FILE.html; repeatable
    #[arg(short, long, value_name = "FILE.csv|FILE.html")]
    output: Vec<PathBuf>,
    /// Overwrite an earlier file
    #[arg(long, requires = "output")]
    force: bool,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let set = settings(&self.set)?;
        let scene = BridgeScene::read(&self.scenario, &set)?;
        for output in &self.output {
            if !is_page(output) && output.extension().is_none_or(|ending| ending != "csv") {
                let problem = format!("-o {}: the ending does not tell what to write", output.display());
                return Err(Failure::usage(problem, "write a name that ends in .csv or .html"));
            }
            writable(output, self.force, self.source.inputs(&self.scenario, &set))?;
        }
        let threads = self.threads.ready("this forecast", STUDY_BYTES)?;
        // Nothing that took long would be lost, so a signal ends the process at once.
        let stop = AtomicBool::new(false);
        let calibration = self.calibration(&scene, threads, &stop)?;
        calibration.warnings.iter().for_each(warn);
        let too_short = "measure for at least half a year: a forecast needs to know the seasons";
        let [times, temperatures] = calibration.record.thermometer();
        let weather = fit(&times, &temperatures, &PERIODS, usize::from(self.processes), calibration.record.averaged[0])
            .map_err(|error| without_weather(self.source.shown(), &error, too_short))?;
        weather.warnings().iter().for_each(warn);
        let question = ForecastQuestion {
            draws: u64::from(self.draws),
            years: u64::from(self.years),
            seed: self.seed,
            level: self.interval,
            share: self.share,
        };
        let found = forecast(&calibration, &weather, &question, threads, &stop)
            .map_err(|error| Failure::run_of(self.source.shown(), &error, error.remedy()))?
            .ok_or(Failure::Interrupted)?;
        found.warnings().into_iter().for_each(warn);
        let text = |output: &Path| match is_page(output) {
            true => page(&scene, &calibration, &weather, &found),
            false => csv(&found),
        };
        let files: Vec<(&Path, String)> = self.output.iter().map(|output| (output.as_path(), text(output))).collect();
        store::write_together(&files, self.force)?;
        print(&if self.json { json(&found) } else { report(&scene.title, &found) })?;
        for output in &self.output {
            let has = if is_page(output) { "is the page" } else { "has all years" };
            note(&format!("{} {has}", output.display()));
        }
        Ok(())
    }

    /// Calibrates from the slips, because only that method gives errors of the parameters to draw
    /// from.
    fn calibration(&self, scene: &BridgeScene, threads: usize, stop: &AtomicBool) -> Result<Calibration, Failure> {
        let record = self.source.record(&self.scenario, scene)?;
        let question = calibration::CalibrationQuestion {
            method: CalibrationMethod::Slips,
            level: self.interval,
            ..calibration::CalibrationQuestion::of(scene, &record)
        };
        calibration::calibrate(&record, &question, threads, stop)
            .map_err(|error| calibrate::refused(self.source.shown(), &error, error.remedy()))
    }
}

/// The name of a quantity in the table for people.
fn words(quantity: ForecastQuantity, share: f64) -> String {
    match quantity {
        ForecastQuantity::SlidingPath => "sliding path".to_string(),
        ForecastQuantity::Slips => "slips".to_string(),
        ForecastQuantity::Range => "range of z".to_string(),
        ForecastQuantity::Greatest => "largest |z|".to_string(),
        ForecastQuantity::Loaded => format!("share of time with |F| above {} f_s", share),
        ForecastQuantity::Force => "largest force |F| on the pier".to_string(),
    }
}

/// The table for people.
fn report(title: &str, found: &Forecast) -> String {
    let mut text = format!("{title}\n\n{}", aligned(&rows(found), "  "));
    let years: usize = found.years.iter().map(Vec::len).sum();
    let draws = found.years.len();
    let _ = writeln!(text, "\nyears   {} with {draws} draws of the parameters", grouped(years as u64));
    text + &wrapped(&meaning(found), "")
}

fn rows(found: &Forecast) -> Vec<TableRow> {
    let mut rows = vec![TableRow::labelled("in a year", ["expected", "from", "to", "year from", "year to"])];
    let cells = |value: f64, ranges: &[[f64; 2]]| -> Vec<String> {
        let digits = Digits::of(value, (ranges[0][1] - ranges[0][0]) / 4.0);
        std::iter::once(value).chain(ranges.iter().flatten().copied()).map(|x| digits.show(x)).collect()
    };
    for found_level in &found.levels {
        let ranges = [found_level.expected_interval, found_level.year_interval];
        let label = words(found_level.quantity, found.question.share);
        let unit = found_level.quantity.unit().replace('1', "");
        rows.push(TableRow::labelled(label, cells(found_level.expected, &ranges)).noted(unit));
    }
    for level in &found.return_levels {
        let label = format!("|z| exceeded in one of {} years", level.years);
        rows.push(TableRow::labelled(label, cells(level.expected, &[level.interval])).noted("m"));
    }
    rows
}

/// What the intervals are.
fn meaning(found: &Forecast) -> String {
    let level = percent(found.question.level);
    format!(
        "The expected value of a year lies between `from` and `to` with {level}, for what is not known of bearing and weather; a single \
         year lies between `year from` and `year to` with {level}."
    )
}

fn is_page(output: &Path) -> bool {
    output.extension().is_some_and(|ending| ending == "html")
}

/// The page for a browser: what a year brings, and the calibration.
fn page(scene: &BridgeScene, calibration: &Calibration, weather: &WeatherFit, found: &Forecast) -> String {
    let mut table = rows(found);
    let length = table.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    table.iter_mut().for_each(|row| row.cells.resize(length, String::new()));
    let warnings = weather.warnings().into_iter().chain(found.warnings());
    let warnings = warnings.map(|text| JsonWarning { name: "forecast".into(), text }).collect();
    let stored = StoredCalibration::of(&scene.title, &scene.text, calibration.clone());
    html::bearing::page(
        &stored,
        vec![Section::Table("What a year brings", table, meaning(found).replace('`', ""))],
        warnings,
    )
}

/// All simulated years as CSV, one row for each.
fn csv(found: &Forecast) -> String {
    let mut text = String::from("draw,year");
    for level in &found.levels {
        let _ = write!(text, ",{}", level.quantity.name());
        if level.quantity.unit() != "1" {
            let _ = write!(text, "_{}", level.quantity.unit());
        }
    }
    text.push('\n');
    for (draw, years) in found.years.iter().enumerate() {
        for (number, year) in years.iter().enumerate() {
            let _ = write!(text, "{draw},{number}");
            for level in &found.levels {
                let _ = write!(text, ",{}", year[level.quantity as usize]);
            }
            text.push('\n');
        }
    }
    text
}

/// The forecast as JSON for programs.
fn json(found: &Forecast) -> String {
    let levels = found.levels.iter().map(|level| {
        let known = json!({
            "unit": level.quantity.unit(),
            "expected": level.expected,
            "expected_interval": level.expected_interval,
            "year_interval": level.year_interval,
        });
        (level.quantity.name(), known)
    });
    let returns = found
        .return_levels
        .iter()
        .map(|level| json!({ "years": level.years, "expected": level.expected, "interval": level.interval }));
    let all = json!({
        "draws": found.years.len(),
        "draws_redrawn": found.redrawn,
        "record": {
            "slips": found.showed.slips,
            "sliding_path": found.showed.path,
            "duration": found.showed.duration,
            "usual_slips": found.usual,
        },
        "years": found.years.iter().map(Vec::len).sum::<usize>(),
        "interval": found.question.level,
        "share": found.question.share,
        "levels": levels.collect::<BTreeMap<_, _>>(),
        "return_levels": returns.collect::<Vec<_>>(),
    });
    document("forecast", all)
}

fn share(text: &str) -> Result<f64, String> {
    parse_share_in(text, &(0.0..1.0), "write a share of f_s from 0 to below 1")
}
