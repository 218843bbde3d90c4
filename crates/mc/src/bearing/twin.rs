//! `mc twin`: makes synthetic measurements of a bearing with known parameters.

use crate::arguments::overrides::Settings;
use crate::output::numbers::{grouped, parse_duration, parse_number_in, parse_share_in};
use crate::report::text;
use crate::session::progress::during;
use crate::{Failure, note, print, writable};
use std::path::{Path, PathBuf};
use stickslip::config::{Override, input_files, shipped_at};
use stickslip::scenario::{BridgeScene, Scenario};
use stickslip_bearing::calibration::{Air, Imperfections, Response, Twin, twin, values};
use stickslip_bearing::report;
use stickslip_data::{ColumnQuantity, Origin, Start};
use stickslip_files::store;

/// Arguments of `mc twin`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/twin.txt"))]
pub struct Arguments {
    /// The scenario with the true parameters, a TOML file
    scenario: PathBuf,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Noise of the displacement sensor: the standard deviations of white and of red noise in
    /// metres, and the correlation time of the red noise
    #[arg(long, value_name = "WHITE[,RED[,TIME]]", default_value = "30e-6,150e-6,1d", value_parser = sensor_noise)]
    sensor_noise: Imperfections,
    /// Relative standard deviation of f_s from slip to slip; f_d does not vary
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = share)]
    scatter: f64,
    /// Delay of the steel temperature behind the thermometer, e.g. 15m
    #[arg(long, value_name = "TIME", value_parser = parse_seconds)]
    lag: Option<f64>,
    /// Resolution of the thermometer in kelvin: readings are multiples of it
    #[arg(long, value_name = "K", default_value_t = 0.0, value_parser = not_negative)]
    resolution: f64,
    /// Fraction of displacements that are outliers, off by up to 20 times the sensor noise
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = share)]
    spikes: f64,
    /// Number of gaps in the record, of one to five days each
    #[arg(long, value_name = "N", default_value_t = 0)]
    gaps: u32,
    /// Drift of the displacement sensor in metres a year, e.g. 0.5e-3
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_hyphen_values = true, value_parser = number)]
    drift: f64,
    /// Shift all displacement readings after TIME by M metres, as if the sensor had been reset,
    /// e.g. 150d:1e-3
    #[arg(long, value_name = "TIME:M", value_parser = zero_set)]
    zero_set: Option<(f64, f64)>,
    /// Keep only every Nth temperature; all displacements are kept
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    thermometer_every: u32,
    /// Date of the first sample, e.g. 2024-06-01, which is t = 0 of the harmonics; only if the
    /// scenario has no measured temperature
    #[arg(long, value_name = "DATE", value_parser = start)]
    start: Option<Start>,
    /// Length of the record; only if the scenario has no measured temperature [default: 300d]
    #[arg(long, value_name = "TIME", value_parser = parse_seconds)]
    duration: Option<f64>,
    /// Time between samples; only if the scenario has no measured temperature [default: 10m]
    #[arg(long, value_name = "TIME", value_parser = parse_seconds)]
    every: Option<f64>,
    #[command(flatten)]
    set: Settings,
    /// Output file
    #[arg(short, long, value_name = "FILE.csv")]
    output: PathBuf,
    /// Overwrite an earlier file
    #[arg(long)]
    force: bool,
}

/// The time of the first sample, if no measurement provides one.
const EPOCH: &str = "2015-01-01T00:00:00Z";

/// The maximum number of samples. A larger number is probably a typing error.
const MOST: f64 = 1e7;

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let set = self.set.list()?;
        let scene = BridgeScene::read(&self.scenario, &set)?;
        writable(&self.output, self.force, input_files(&self.scenario, &set))?;
        let of_drawn = [
            ("--start", self.start.is_some()),
            ("--duration", self.duration.is_some()),
            ("--every", self.every.is_some()),
        ];
        let (start, air) = match (
            &scene.temperature_source.file,
            of_drawn.iter().find(|(_, is_given)| *is_given),
        ) {
            (Some(_), Some((flag, _))) => {
                let problem = format!(
                    "{flag} conflicts with the measured temperature of the scenario, which has its own times"
                );
                let remedy =
                    format!("remove {flag}, or remove [temperature.series] from the scenario");
                return Err(Failure::usage(problem, remedy));
            }
            (Some(file), None) => measured(&self.scenario, file, &scene)?,
            (None, _) => (self.start, self.drawn(&set)?),
        };
        let response = Response::of(&scene, air.temperatures[0]);
        let imperfections = Imperfections {
            scatter: self.scatter,
            lag: self.lag.unwrap_or(0.0),
            resolution: self.resolution,
            spikes: self.spikes,
            gaps: self.gaps,
            drift: self.drift,
            zero_set: self.zero_set,
            thermometer_every: self.thermometer_every as usize,
            ..self.sensor_noise
        };
        let made = during("making the record", || {
            let made = twin(&response, &air, &imperfections, self.seed);
            let text = csv(&made, start, &scene)?;
            store::write_whole(&self.output, text.as_bytes(), self.force)?;
            Ok::<_, Failure>(made)
        })?;
        let truth = values(&response, scene.shear_stiffness);
        print(&text(&report::truth(&truth)))?;
        let samples = grouped(made.times.len() as u64);
        note(&format!(
            "{}: {samples} samples, {} slips",
            self.output.display(),
            made.slips
        ));
        Ok(())
    }

    /// A simulated temperature, for a scenario without a measured one.
    fn drawn(&self, set: &[Override]) -> Result<Air, Failure> {
        let scenario = Scenario::read(&self.scenario, set)?;
        let every = self.every.unwrap_or(600.0);
        let count = self.duration.unwrap_or(300.0 * 86_400.0) / every;
        if !(2.0..=MOST).contains(&count) {
            let problem =
                format!("the number of samples must be between 2 and 1e7, got {count:.0}");
            return Err(Failure::usage(
                problem,
                "choose other --duration and --every",
            ));
        }
        let temperature = &scenario.model.temperature;
        Ok(during("simulating the temperature", || {
            Air::drawn(temperature, count as usize, every, self.seed)
        }))
    }
}

/// The measured temperature that a scenario names, and the time of its first sample, if known.
fn measured(
    scenario: &Path,
    file: &str,
    scene: &BridgeScene,
) -> Result<(Option<Start>, Air), Failure> {
    let origin = match shipped_at(scenario).and_then(|shipped| shipped.file(file)) {
        Some(text) => Origin::Text(file, text),
        None => Origin::File(Path::new(file)),
    };
    let (column, start, repairs) = scene
        .temperature_source
        .read(origin, ColumnQuantity::Temperature)?;
    repairs.iter().for_each(|repair| note(repair));
    Ok((start, Air::measured(column.times, column.values)))
}

/// The measurements as CSV: times, temperatures in degrees Celsius and displacements in
/// millimetres.
fn csv(made: &Twin, start: Option<Start>, scene: &BridgeScene) -> Result<String, Failure> {
    let out_of_calendar = || Failure::Run("the dates of the record are out of range".to_string());
    let start = start
        .or_else(|| Start::parse(EPOCH))
        .ok_or_else(out_of_calendar)?;
    // Measured temperatures are written in degrees Celsius, whatever their unit was.
    let column = scene
        .temperature_source
        .column
        .as_deref()
        .filter(|_| scene.temperature_source.unit.is_none());
    let time = scene
        .temperature_source
        .layout
        .time
        .as_deref()
        .filter(|name| !name.contains(','))
        .unwrap_or("time");
    let mut text = format!(
        "{time},{},displacement_mm\n",
        column.unwrap_or("temperature_degC")
    );
    for i in 0..made.times.len() {
        let stamp = start.after(made.times[i]).ok_or_else(out_of_calendar)?;
        let shown = made.temperatures[i];
        let shown = if shown.is_nan() {
            String::new()
        } else {
            format!("{shown:.3}")
        };
        text += &format!("{stamp},{shown},{:.5}\n", 1e3 * made.readings[i]);
    }
    Ok(text)
}

/// Reads the noise of the sensor, as the only imperfection.
fn sensor_noise(text: &str) -> Result<Imperfections, String> {
    let mut parts = text.split(',');
    let mut number = |default: f64| parts.next().map_or(Ok(default), not_negative);
    let (white, red) = (number(0.0)?, number(0.0)?);
    let memory = parts.next().map_or(Ok(86_400.0), parse_seconds)?;
    match parts.next() {
        None => Ok(Imperfections {
            white,
            red,
            memory,
            ..Imperfections::NONE
        }),
        Some(_) => Err("write at most three, e.g. 30e-6,150e-6,1d".to_string()),
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    parse_number_in(text, &(0.0..), "write a number, 0 or above")
}

fn share(text: &str) -> Result<f64, String> {
    parse_share_in(
        text,
        &(0.0..0.5),
        "write a number of at least 0 and below 0.5",
    )
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    parse_duration(text).map(|duration| duration.as_secs_f64())
}

fn number(text: &str) -> Result<f64, String> {
    parse_number_in(text, &(..), "write a number")
}

fn zero_set(text: &str) -> Result<(f64, f64), String> {
    let parts = text
        .split_once(':')
        .and_then(|(when, by)| Some((parse_seconds(when).ok()?, number(by).ok()?)));
    parts.ok_or_else(|| "write the time and the shift in metres, e.g. 150d:1e-3".to_string())
}

fn start(text: &str) -> Result<Start, String> {
    Start::of_calendar(text)
        .ok_or_else(|| "write a date such as 2024-06-01, also with a time and a zone".to_string())
}
