//! `mc calibrate`: estimates friction, stiffness and dilatation of a bearing from measured
//! temperatures and displacements.

use super::STUDY_BYTES;
use super::measurements::Source;
use crate::arguments::extension::writable_hdf5;
use crate::output::numbers::parse_duration;
use crate::report::text;
use crate::session::progress::during;
use crate::{Failure, note, print, warn, writable};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use stickslip::scenario::BridgeScene;
use stickslip_bearing::calibration::{
    CalibrationMethod, CalibrationQuestion, Lag, NotHeld, Quantity, calibrate,
};
use stickslip_bearing::dataset::StoredCalibration;
use stickslip_bearing::report;
use stickslip_data::remedy;
use stickslip_files::store;

/// Arguments of `mc calibrate`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/calibrate.txt"))]
pub struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Estimate from the slips, by the paper's least-squares criterion, or by both
    #[arg(long, value_name = "slips|criterion|both", default_value = "slips", value_parser = method)]
    method: CalibrationMethod,
    /// Keys of the parameters to fit; the others keep the values of the scenario [default: all]
    #[arg(long, value_name = "KEY,KEY", value_delimiter = ',', value_parser = parameter)]
    fit: Vec<Quantity>,
    /// Bounds of a parameter in the least-squares search, e.g. friction.static=4e5:6e5; repeatable
    /// [default: a box around the estimates from the slips]
    #[arg(long, value_name = "KEY=LOW:HIGH", value_parser = bounds, allow_hyphen_values = true)]
    bounds: Vec<(Quantity, [f64; 2])>,
    /// Number of starting points of the least-squares search
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
    starts: u32,
    /// Delay of the steel temperature behind the thermometer, e.g. 15m; `auto` estimates it
    #[arg(long, value_name = "auto|TIME", default_value = "auto", value_parser = lag)]
    lag: Lag,
    /// Write everything to FILE.h5: estimates, slips, starting points with their results, the
    /// measurements and the model; or the scenario with the estimates to FILE.toml; repeatable
    #[arg(short, long, value_name = "FILE.h5|FILE.toml")]
    output: Vec<PathBuf>,
    /// Overwrite an earlier file
    #[arg(long, requires = "output")]
    force: bool,
    /// Print only one JSON object to standard output
    #[arg(long)]
    json: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let scene = self.source.scene()?;
        for output in &self.output {
            match is_scenario(output) {
                true => writable(output, self.force, self.source.inputs()?)?,
                false => writable_hdf5(output, self.force, self.source.inputs()?)?,
            }
        }
        let record = self.source.record(&scene)?;
        let question = CalibrationQuestion {
            method: self.method,
            starts: self.starts,
            lag: self.lag,
            level: self.source.interval,
            bounds: self.bounds.clone(),
            ..CalibrationQuestion::of(&scene, &record)
        };
        let question = question.fitting(&self.fit, &scene)?;
        let threads = self.source.threads.ready("this calibration", STUDY_BYTES)?;
        // There is nothing to save, so a signal ends the process at once.
        let stop = AtomicBool::new(false);
        let calibration = during("calibrating the bearing", || {
            calibrate(&record, &question, threads, &stop)
        })
        .map_err(|error| {
            let remedy = remedy(record.mark.as_deref(), error.remedy());
            Failure::run_of(self.source.shown(), &error, remedy)
        })?;
        let stored = StoredCalibration::of(&scene.title, &scene.text, calibration);
        for output in &self.output {
            match is_scenario(output) {
                true => store::write_whole(output, fitted(&stored)?.as_bytes(), self.force)?,
                false => store::write_dataset(output, stored.dataset(), self.force)?,
            }
        }
        stored
            .warnings
            .iter()
            .for_each(|(_, warning)| warn(warning));
        print(&match self.json {
            true => super::calibration::object(&stored),
            false => text(&report::calibration(
                &stored.title,
                &stored.calibration,
                false,
            )),
        })?;
        for output in &self.output {
            match is_scenario(output) {
                true => note(&format!(
                    "{} contains the scenario with the estimates",
                    output.display()
                )),
                false => note(&format!(
                    "{} contains all results; `mc plot {0}` draws them",
                    output.display()
                )),
            }
        }
        Ok(())
    }
}

fn is_scenario(output: &Path) -> bool {
    output.extension().is_some_and(|ending| ending == "toml")
}

/// The text of the scenario with its values replaced by the estimates. The initial displacement is
/// kept, because it belongs to the record.
fn fitted(stored: &StoredCalibration) -> Result<String, Failure> {
    let known = Quantity::FITTED
        .into_iter()
        .filter(|quantity| *quantity != Quantity::Displacement);
    let mut lines: Vec<String> = stored.scenario_text.lines().map(String::from).collect();
    for quantity in known {
        let value = stored.calibration.estimate(quantity).estimate;
        let Some((table, key)) = quantity.key().split_once('.').filter(|_| value.is_finite())
        else {
            continue;
        };
        let line = format!("{key} = {value:.6e}");
        let is_header = |line: &String| line.trim_start().starts_with('[');
        let is_key = |line: &String| {
            line.split('=')
                .next()
                .is_some_and(|name| name.trim() == key)
        };
        match lines
            .iter()
            .position(|line| line.trim() == format!("[{table}]"))
        {
            Some(header) => {
                let end = lines[header + 1..]
                    .iter()
                    .position(is_header)
                    .map_or(lines.len(), |end| header + 1 + end);
                match lines[header + 1..end].iter().position(is_key) {
                    Some(at) => lines[header + 1 + at] = line,
                    None => lines.insert(header + 1, line),
                }
            }
            None => lines.extend([String::new(), format!("[{table}]"), line]),
        }
    }
    let text = lines.join("\n") + "\n";
    // Tables in other forms would now appear twice, which this refuses.
    BridgeScene::parse("the scenario with the estimates", &text, &[])?;
    Ok(text)
}

impl From<NotHeld> for Failure {
    fn from(error: NotHeld) -> Self {
        let remedy = match error {
            NotHeld::NoNumber(quantity) => {
                format!("add it to --fit, or give --set {}=...", quantity.key())
            }
            NotHeld::TakesShearStiffness(_) => {
                "give bearing.stiffness, in the scenario or with --set".to_string()
            }
            NotHeld::UnusedBounds => "add --method criterion or --method both".to_string(),
        };
        Failure::usage(error.to_string(), remedy)
    }
}

fn method(text: &str) -> Result<CalibrationMethod, String> {
    CalibrationMethod::from_name(text).ok_or_else(|| "write slips, criterion or both".to_string())
}

fn parameter(text: &str) -> Result<Quantity, String> {
    let found = Quantity::fitted(text.trim());
    found.ok_or_else(|| {
        format!(
            "use one or more of {}",
            Quantity::FITTED.map(Quantity::key).join(", ")
        )
    })
}

fn bounds(text: &str) -> Result<(Quantity, [f64; 2]), String> {
    let wrong = || "write KEY=LOW:HIGH, e.g. friction.static=4e5:6e5".to_string();
    let (key, range) = text.split_once('=').ok_or_else(wrong)?;
    let (low, high) = range.split_once(':').ok_or_else(wrong)?;
    let number = |text: &str| {
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|x| x.is_finite())
            .ok_or_else(wrong)
    };
    let (low, high) = (number(low)?, number(high)?);
    if low < high {
        Ok((parameter(key)?, [low, high]))
    } else {
        Err("the lower bound is not below the upper".into())
    }
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
