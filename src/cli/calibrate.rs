//! `mc calibrate`: from measured temperatures and displacements of a bearing to its friction, stiffness and dilatation.

use super::calibrate_report as report;
use super::failure::{Failure, note, print, writable};
use super::interrupt::stop_on_signals;
use super::measurements::Source;
use super::numbers::{parse_duration, wrapped};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use stick_slip::config::{BridgeScene, Override};
use stick_slip::data::DataError;
use stick_slip::store;
use stick_slip::study::calibration::{
    Calibration, CalibrationError, Held, Lag, Method, Motion, Quantity, Question, Record, calibrate,
};

const EXAMPLES: &str = "\
Examples:
  mc calibrate examples/bridge/bridge.toml examples/bridge/twin.csv -o fit.h5
  mc calibrate bridge.toml displacement.csv --temperature temperature.csv
  mc calibrate bridge.toml data.csv --displacement gauge_3 --unit mm --lag 15m
  mc calibrate bridge.toml data.csv --method slips --json | jq .parameters
  mc twin bridge.toml --seed 1 --sensor-noise 30e-6,150e-6 -o twin.csv && mc calibrate bridge.toml twin.csv

The last line is how to find out whether the method suits a bridge: make data of one like it, whose truth is in the scenario, and see
whether the intervals hold it. The scenario gives K_BP as bearing.stiffness, names the columns under [temperature.series], and needs no
[time]. Intervals hold the error that noise makes; they do not hold what the model leaves out.";

/// Arguments of `mc calibrate`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Calibrate {
    /// The scenario, a TOML file: K_BP, the columns, and where a search begins
    scenario: PathBuf,
    #[command(flatten)]
    source: Source,
    /// By slips, by the paper's least squares err, or by slips with err beside them
    #[arg(long, value_name = "slips|err|both", default_value = "both", value_parser = method)]
    method: Method,
    /// The parameters to fit, by their keys; the others are held at what the scenario says [default: all]
    #[arg(long, value_name = "KEY,KEY", value_delimiter = ',', value_parser = parameter)]
    fit: Vec<Quantity>,
    /// Between which values err looks for a parameter, e.g. friction.static=4e5:6e5; repeatable [default: a box around what slips say]
    #[arg(long, value_name = "KEY=LOW:HIGH", value_parser = bounds, allow_hyphen_values = true)]
    bounds: Vec<(Quantity, [f64; 2])>,
    /// How many starts err has
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
    starts: u32,
    /// How far steel is behind the thermometer, e.g. 15m; `auto` estimates it
    #[arg(long, value_name = "auto|TIME", default_value = "auto", value_parser = lag)]
    lag: Lag,
    /// With which probability an interval is to hold the truth
    #[arg(long, value_name = "P", default_value_t = 0.9, value_parser = level)]
    interval: f64,
    /// Any key of the scenario, e.g. bearing.stiffness=2e9; repeatable
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    /// Threads [default: one a core]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Write everything to FILE: estimates, slips, starts, the record and the model
    #[arg(short, long, value_name = "FILE.h5")]
    output: Option<PathBuf>,
    /// Overwrite an earlier file
    #[arg(long, requires = "output")]
    force: bool,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

impl Calibrate {
    pub fn call(&self) -> Result<(), Failure> {
        let set = self.set.iter().map(|text| Override::set(text)).collect::<Result<Vec<_>, _>>()?;
        let scene = BridgeScene::read(&self.scenario, &set)?;
        if let Some(output) = &self.output {
            writable(output, self.force, self.source.files().chain([self.scenario.as_path()]))?;
        }
        let record = self.source.record(&scene)?;
        let question = Question {
            method: self.method,
            shear_stiffness: scene.shear_stiffness,
            starts: self.starts,
            lag: self.lag,
            level: self.interval,
            held: self.held(&scene)?,
            bounds: self.bounds.clone(),
            guess: guess(&scene, &record),
        };
        let threads = self.threads.map_or_else(super::cores, usize::from);
        let stop = stop_on_signals();
        let calibration =
            calibrate(&record, &question, threads, &stop).map_err(|error| refused(&self.source.data, &error))?;
        let warnings: Vec<(String, String)> =
            calibration.warnings.iter().map(|warning| (warning.name().to_string(), warning.to_string())).collect();
        let title = &scene.title;
        show(title, &calibration, &warnings, self.json)?;
        if let Some(output) = &self.output {
            store::write_calibration(output, title, &scene.text, &calibration, self.force)?;
            note(&format!("{} has all of it; `mc plot {0}` draws it", output.display()));
        }
        if stop.load(Ordering::Relaxed) { Err(Failure::Interrupted) } else { Ok(()) }
    }
}

impl Calibrate {
    /// What is not fitted, and what the scenario says of it.
    fn held(&self, scene: &BridgeScene) -> Result<Vec<Held>, Failure> {
        let is_held = |quantity: &Quantity| !self.fit.is_empty() && !self.fit.contains(quantity);
        let asked = FITTED.into_iter().filter(is_held).map(|quantity| {
            let value = match quantity {
                Quantity::Stiffness => scene.stiffness,
                Quantity::Dilatation => scene.dilatation,
                Quantity::Static => scene.f_s,
                Quantity::Dynamic => scene.f_d,
                Quantity::Offset => scene.offset,
                _ => scene.displacement.ok_or_else(|| {
                    let problem = "--fit leaves out initial.displacement, which is not a number in the scenario";
                    Failure::usage(problem, "fit it as well, or give --set initial.displacement=...")
                })?,
            };
            Ok((quantity, value))
        });
        let held: Vec<Held> = asked.collect::<Result<_, Failure>>()?;
        let bounded = self.bounds.iter().map(|(quantity, _)| *quantity);
        let mut told = held.iter().map(|(quantity, _)| *quantity).chain(bounded);
        match told.find(|quantity| quantity.needs_shear_stiffness()) {
            Some(quantity) if scene.shear_stiffness.is_none() => {
                let problem = format!("{} cannot be held or bounded, because it takes K_BP to know it", quantity.key());
                Err(Failure::usage(problem, "give bearing.stiffness, in the scenario or with --set"))
            }
            _ => Ok(held),
        }
    }
}

/// Print a calibration, and on standard error what to beware of: name and sentence of each warning.
pub(super) fn show(
    title: &str,
    calibration: &Calibration,
    warnings: &[(String, String)],
    json: bool,
) -> Result<(), Failure> {
    for (_, warning) in warnings {
        note(wrapped(&format!("warning: {warning}"), "  ").trim_end());
    }
    print(&if json { report::json(calibration, warnings) } else { report::table(title, calibration) })
}

/// Where a search begins if slips do not say so.
pub(super) fn guess(scene: &BridgeScene, record: &Record) -> Motion {
    let slope = scene.stiffness * scene.dilatation;
    let first = record.temperatures.first().copied().unwrap_or(0.0);
    Motion {
        reach: scene.f_s / slope,
        jump: 2.0 * (scene.f_s - scene.f_d) / slope,
        start: scene.displacement.map_or(first, |x| x / scene.dilatation),
    }
}

pub(super) fn refused(path: &Path, error: &CalibrationError) -> Failure {
    let remedy = match error {
        CalibrationError::TooShort(_) => "measure for longer: weeks at least, with tens of slips",
        CalibrationError::Constant(_) => "see that it is the right column, and that its sensor works",
        CalibrationError::NoSlips => "take --method err, which needs none, and beware of its estimates",
    };
    Failure::Run(format!("{}: {error}\n  fix: {remedy}", path.display()))
}

fn method(text: &str) -> Result<Method, String> {
    Method::from_name(text).ok_or_else(|| "write slips, err or both".to_string())
}

/// What can be fitted or held; f_s - f_d follows.
const FITTED: [Quantity; 6] = [
    Quantity::Stiffness,
    Quantity::Dilatation,
    Quantity::Static,
    Quantity::Dynamic,
    Quantity::Offset,
    Quantity::Displacement,
];

fn parameter(text: &str) -> Result<Quantity, String> {
    let found = FITTED.into_iter().find(|quantity| quantity.key() == text.trim());
    found.ok_or_else(|| format!("write some of {}", FITTED.map(Quantity::key).join(", ")))
}

fn bounds(text: &str) -> Result<(Quantity, [f64; 2]), String> {
    let wrong = || "write KEY=LOW:HIGH, e.g. friction.static=4e5:6e5".to_string();
    let (key, range) = text.split_once('=').ok_or_else(wrong)?;
    let (low, high) = range.split_once(':').ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(wrong);
    let (low, high) = (number(low)?, number(high)?);
    if low < high { Ok((parameter(key)?, [low, high])) } else { Err("the lower bound is not below the upper".into()) }
}

fn lag(text: &str) -> Result<Lag, String> {
    match text {
        "auto" => Ok(Lag::Auto),
        "0" | "0s" | "0m" => Ok(Lag::Known(0.0)),
        _ => parse_duration(text)
            .map(|lag| Lag::Known(lag.as_secs_f64()))
            .map_err(|_| "write auto, or a time such as 0, 90s or 15m".to_string()),
    }
}

pub(super) fn level(text: &str) -> Result<f64, String> {
    let level = text.parse::<f64>().ok().filter(|level| (0.5..=0.999).contains(level));
    level.ok_or_else(|| "write a probability from 0.5 to 0.999".to_string())
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        Failure::Refused(error.to_string())
    }
}
