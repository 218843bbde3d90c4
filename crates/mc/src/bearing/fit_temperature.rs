//! `mc fit-temperature`: fits harmonics and noise of a scenario to a measured temperature.

use super::measurements::MeasuredFlags;
use crate::output::document::document;
use crate::report::text;
use crate::session::progress::during;
use crate::{Failure, note, print, warn, writable};
use serde_json::json;
use std::path::{Path, PathBuf};
use stickslip::config;
use stickslip_bearing::report;
use stickslip_bearing::weather::{WeatherFit, fit, usual};
use stickslip_data::{ColumnQuantity, Origin, Wording, remedy};
use stickslip_files::store;

/// Arguments of `mc fit-temperature`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/fit-temperature.txt"))]
pub struct Arguments {
    /// Measurement, a CSV file with times and temperatures
    #[arg(value_name = "DATA.csv")]
    data: PathBuf,
    /// Largest number of Ornstein-Uhlenbeck processes in the noise: one, or a fast and a slow one
    #[arg(long, value_name = "1|2", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=2))]
    processes: u8,
    /// Periods of the harmonics, e.g. 365.25d,1d; `none` for no harmonics [default: a year and a
    /// day, as far as the samples resolve them]
    #[arg(long, value_name = "TIME,TIME", value_delimiter = ',', value_parser = period)]
    periods: Vec<f64>,
    #[command(flatten)]
    flags: MeasuredFlags,
    /// Write the temperature section of a scenario to FILE
    #[arg(short, long, value_name = "FILE.toml")]
    output: Option<PathBuf>,
    /// Overwrite an earlier file
    #[arg(long, requires = "output")]
    force: bool,
    /// Print only one JSON object to standard output
    #[arg(long)]
    json: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        if let Some(output) = &self.output {
            writable(output, self.force, [self.data.as_path()])?;
        }
        let periods: Vec<f64> = self
            .periods
            .iter()
            .copied()
            .filter(|period| period.is_finite())
            .collect();
        if (1..periods.len()).any(|i| periods[..i].contains(&periods[i])) {
            return Err(Failure::usage(
                "--periods lists a period twice",
                "list each period once, e.g. 365.25d,1d",
            ));
        }
        let mut source = config::temperature_source(&self.flags.overrides(&["temperature"]))?;
        source.layout.wording = Wording::Flag;
        let (column, start, repairs) =
            source.read(Origin::File(&self.data), ColumnQuantity::Temperature)?;
        repairs.iter().for_each(|repair| note(repair));
        let (usual, remarks) = usual(&column.times);
        let periods = if self.periods.is_empty() {
            remarks.iter().for_each(|remark| note(remark));
            usual
        } else {
            periods
        };
        let found = during("fitting the temperature model", || {
            fit(
                &column.times,
                &column.values,
                &periods,
                usize::from(self.processes),
                column.averaged,
            )
        })
        .map_err(|error| {
            let remedy = remedy(column.mark.as_deref(), error.remedy());
            Failure::run_of(&self.data, error, remedy)
        })?;
        found.warnings().iter().for_each(warn);
        if let Some(output) = &self.output {
            let start = start.and_then(|start| start.after(-0.5 * column.averaged));
            let start =
                start.map_or_else(|| "the first sample".to_string(), |start| start.to_string());
            let part = part(&found, &self.data, &start, &repairs);
            store::write_whole(output, part.as_bytes(), self.force)?;
        }
        print(&if self.json {
            json(&found, &repairs)
        } else {
            text(&report::weather(&found))
        })?;
        if let Some(output) = &self.output {
            note(&format!(
                "{} contains the temperature; add it to a scenario without one",
                output.display()
            ));
        }
        Ok(())
    }
}

/// The temperature section of a scenario.
fn part(found: &WeatherFit, data: &Path, start: &str, repairs: &[String]) -> String {
    let mut part = format!(
        "# Temperature fitted to {}, {} samples; t = 0 is {start}.\n# In the tables: noise of \
         intensity rho in kelvin, whose v has the standard deviation 1.\n",
        data.file_name().unwrap_or_default().to_string_lossy(),
        found.samples
    );
    for line in text(&report::weather(found)).lines() {
        part += &(format!("# {line}").trim_end().to_string() + "\n");
    }
    for repair in repairs {
        part += &format!("# {repair}\n");
    }
    part + &config::temperature_part(&found.temperature())
}

/// The fit as JSON for programs, in seconds and kelvin.
fn json(found: &WeatherFit, repairs: &[String]) -> String {
    let cycles = found.cycles().into_iter().map(|cycle| {
        json!({
            "period": cycle.period,
            "amplitude": cycle.amplitude,
            "phase": cycle.phase,
            "standard_error": cycle.error,
        })
    });
    let processes = found.processes().into_iter().map(|process| {
        json!({
            "sd": process.sd,
            "sd_relative_error": process.sd_error,
            "relaxation_rate": process.relaxation_rate,
            "relaxation_rate_relative_error": process.rate_error,
        })
    });
    let fit = json!({
        "samples": found.samples,
        "duration": found.duration,
        "mean": found.mean(),
        "harmonics": cycles.collect::<Vec<_>>(),
        "processes": processes.collect::<Vec<_>>(),
        "smoothing": found.smoothing().map(|(tau, _)| tau),
        "sensor_sd": found.white,
        "warnings": found.warnings(),
        "repairs": repairs,
        "log_likelihood": found.log_likelihood,
    });
    document("weather", fit)
}

/// The period of a harmonic in seconds; infinite for the word `none`.
fn period(text: &str) -> Result<f64, String> {
    if text == "none" {
        return Ok(f64::INFINITY);
    }
    let seconds = stickslip_data::seconds(text).or_else(|| text.strip_suffix('d').and_then(days));
    seconds.ok_or_else(|| "write times such as 365.25d, 1d or 12h, or none".into())
}

fn days(text: &str) -> Option<f64> {
    text.parse::<f64>()
        .ok()
        .map(|days| 86_400.0 * days)
        .filter(|seconds| *seconds > 0.0 && seconds.is_finite())
}
