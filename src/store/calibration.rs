//! The file of a calibration: the record, what was found in it, and what the model makes of it.

use super::StoreError;
use super::at_once::write_at_once;
use super::error::cause;
use super::reader::{check_file, open};
use super::variable::{read_or_empty, read_text};
use crate::dataset;
use crate::dataset::calibration::*;
use crate::dataset::layout::Variable;
use crate::study::calibration::{
    Calibration, Estimate, Lag, LagProfile, Method, Quantity, Question, Record, Residuals, SeenSlip, Spikes, Start,
    Values, response_of,
};
use hdf5::File;
use std::path::Path;

/// What a file of a calibration says.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredCalibration {
    /// What it is about, in a line.
    pub title: String,
    /// The scenario, as it was written.
    pub scenario_text: String,
    /// The result; its warnings are in `warnings`.
    pub calibration: Calibration,
    /// Name and sentence of each warning.
    pub warnings: Vec<(String, String)>,
}

/// Write a calibration, in the folder `NAME.partial` like every file. With `force`, a file of this name is replaced.
pub fn write_calibration(
    target: &Path,
    title: &str,
    scenario_text: &str,
    calibration: &Calibration,
    force: bool,
) -> Result<(), StoreError> {
    write_at_once(target, units(), force, |place| dataset::calibration::write(place, title, scenario_text, calibration))
}

/// Read the file of a calibration.
pub fn read_calibration(path: &Path) -> Result<StoredCalibration, StoreError> {
    check_file(path)?;
    let file = open(path)?;
    let damaged = |error: hdf5::Error| StoreError::Damaged { path: path.to_owned(), cause: cause(&error) };
    if read_text(&file, "format_name").ok().as_deref() != Some(CALIBRATION_FORMAT_NAME) {
        return Err(StoreError::Foreign { path: path.to_owned() });
    }
    let version = read_text(&file, "format_version").map_err(damaged)?;
    let version = version.split_once('.').and_then(|(a, b)| Some((a.parse::<u32>().ok()?, b.parse::<u32>().ok()?)));
    if let Some((major, minor)) = version.filter(|version| version.0 > CALIBRATION_FORMAT_VERSION.0) {
        return Err(StoreError::Newer { path: path.to_owned(), major, minor });
    }
    stored(&file).map_err(damaged)
}

fn stored(file: &File) -> hdf5::Result<StoredCalibration> {
    let number = |name: &str| file.attr(name)?.read_scalar::<f64>();
    let whole = |name: &str| file.attr(name)?.read_scalar::<u64>();
    let column = |variable: &Variable| read_or_empty::<f64>(file, variable);
    // Every column has the length of its coordinate.
    let along = |variable: &Variable, length: usize| match column(variable)? {
        values if values.len() == length => Ok(values),
        values => Err(hdf5::Error::from(format!("{} has {} values, not {length}", variable.name, values.len()))),
    };
    let all = Quantity::ALL.len();
    let estimates = |variables: [&Variable; 3]| -> hdf5::Result<[Estimate; Quantity::ALL.len()]> {
        let [estimate, low, high] = variables.map(|variable| along(variable, all));
        let (estimate, low, high) = (estimate?, low?, high?);
        Ok(std::array::from_fn(|i| Estimate { estimate: estimate[i], low: low[i], high: high[i] }))
    };
    let rows = |values: &[f64]| -> Vec<Values> {
        values.chunks_exact(all).map(|row| std::array::from_fn(|i| row[i])).collect()
    };
    let times = column(&TIME)?;
    let n = times.len();
    let record = Record { temperatures: along(&TEMPERATURE, n)?, readings: along(&READING, n)?, times };
    let found = estimates([&ESTIMATE, &LOW, &HIGH])?;
    let slip_times = column(&SLIP_TIME)?;
    let slips = slip_times.len();
    let (temperatures, jumps) = (along(&SLIP_TEMPERATURE, slips)?, along(&SLIP_JUMP, slips)?);
    let usual = read_or_empty::<i8>(file, &SLIP_USUAL)?;
    let errs = column(&START_ERR)?;
    let starts = rows(&along(&START_VALUE, errs.len() * all)?);
    let lags = column(&LAG)?;
    let deviances = along(&LAG_DEVIANCE, lags.len())?;
    let delays = column(&DELAY)?;
    let correlations = along(&AUTOCORRELATION, delays.len())?;
    let method = Method::from_name(&read_text(file, "method")?).ok_or("an unknown method")?;
    let lag = Estimate { estimate: number("lag")?, low: number("lag_low")?, high: number("lag_high")? };
    let response = response_of(&found.map(|estimate| estimate.estimate));
    let question = Question {
        method,
        shear_stiffness: file.attr("shear_stiffness").is_ok().then(|| number("shear_stiffness")).transpose()?,
        starts: errs.len() as u32,
        lag: if read_text(file, "lag_choice")? == "auto" { Lag::Auto } else { Lag::Known(lag.estimate) },
        level: number("interval")?,
        held: Vec::new(),
        bounds: Vec::new(),
        guess: response.motion,
    };
    let profile = (!lags.is_empty()).then(|| {
        let profile = lags.into_iter().zip(deviances).collect();
        Ok::<_, hdf5::Error>(LagProfile { likeliest: number("lag_likeliest")?, gain: number("lag_gain")?, profile })
    });
    let calibration = Calibration {
        question,
        steel: along(&STEEL, n)?,
        modelled: along(&MODELLED, n)?,
        record,
        spikes: Spikes {
            readings: whole("spikes_displacement")? as usize,
            temperatures: whole("spikes_temperature")? as usize,
        },
        is_mirrored: whole("mirrored")? != 0,
        response,
        estimates: found,
        least_squares: file
            .link_exists(ERR_ESTIMATE.name)
            .then(|| estimates([&ERR_ESTIMATE, &ERR_LOW, &ERR_HIGH]))
            .transpose()?,
        correlations: rows(&column(&CORRELATION)?),
        slips: (0..slips)
            .map(|i| SeenSlip {
                time: slip_times[i],
                temperature: temperatures[i],
                jump: jumps[i],
                is_usual: usual.get(i) == Some(&1),
            })
            .collect(),
        lag,
        lag_profile: profile.transpose()?,
        starts: errs
            .into_iter()
            .zip(&starts)
            .map(|(err, values)| Start { err, response: response_of(values) })
            .collect(),
        residuals: Residuals {
            rms: number("residual_rms")?,
            autocorrelation: delays.into_iter().zip(correlations).collect(),
        },
        warnings: Vec::new(),
    };
    let warnings = if file.attr("warnings").is_ok() { read_text(file, "warnings")? } else { String::new() };
    let split = |line: &str| line.split_once(": ").map(|(name, text)| (name.to_string(), text.to_string()));
    Ok(StoredCalibration {
        title: read_text(file, "title")?,
        scenario_text: read_text(file, "scenario")?,
        calibration,
        warnings: warnings.lines().filter_map(split).collect(),
    })
}
