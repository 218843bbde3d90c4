//! A calibration as a data set: the measured record, what was found in it, and what the model
//! gives.

use super::header::CONVENTIONS;
use super::layout::{Unit, Variable, variable};
use super::{
    Destination, Source, read_count, read_or_empty, read_other_program, read_real, read_real_if_present, read_text,
    read_text_if_present, texts,
};
use crate::bearing::calibration::{
    Calibration, Estimate, Lag, LagProfile, Method, Motion, Quantity, Question, Record, Residuals, SeenSlip, Spikes,
    Start, Values, response_of,
};
use crate::engine::{GIT_HASH, PROGRAM_VERSION};
use crate::stats::{Dimension, Units};

/// The attribute `format_name` of a calibration.
pub(crate) const CALIBRATION_FORMAT_NAME: &str = "stick-slip calibration";

/// Major and minor version of the format.
pub(crate) const CALIBRATION_FORMAT_VERSION: (u32, u32) = (1, 1);

/// A calibration as it is read back from a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredCalibration {
    /// The title of the calibration, one line.
    pub title: String,
    /// The scenario, as it was written.
    pub scenario_text: String,
    /// The result. Where it was read back, its list of warnings is empty; they are in `warnings`.
    pub calibration: Calibration,
    /// Name and sentence of each warning.
    pub warnings: Vec<(String, String)>,
    /// The program that wrote the calibration, if it was another one.
    pub other_program: Option<String>,
    /// Whether everything is known that is needed to repeat the fit. Files of format 1.0 lack some
    /// of it.
    pub is_repeatable: bool,
}

impl StoredCalibration {
    /// A calibration as it is to be stored. `title` is one line, and `scenario_text` is the
    /// scenario as it was written.
    pub fn of(title: &str, scenario_text: &str, calibration: Calibration) -> Self {
        let warnings = calibration.warnings.iter();
        let warnings = warnings.map(|warning| (warning.name().to_string(), warning.to_string())).collect();
        let (title, scenario_text) = (title.to_string(), scenario_text.to_string());
        StoredCalibration { title, scenario_text, calibration, warnings, other_program: None, is_repeatable: true }
    }
}

/// Labels of the units of a calibration.
pub(crate) fn units() -> Units {
    let [time, length, force, temperature] = ["s", "m", "N", "K"].map(String::from);
    Units { time, length, force, temperature }
}

/// Write a calibration.
pub(crate) fn write<D: Destination>(to: &mut D, stored: &StoredCalibration) -> Result<(), D::Error> {
    attributes(to, stored)?;
    write_question(to, &stored.calibration.question)?;
    variables(to, &stored.calibration)
}

fn attributes<D: Destination>(to: &mut D, stored: &StoredCalibration) -> Result<(), D::Error> {
    let StoredCalibration { title, scenario_text, calibration, warnings, .. } = stored;
    let Calibration { question, lag, spikes, .. } = calibration;
    let (major, minor) = CALIBRATION_FORMAT_VERSION;
    for (name, value) in [
        ("Conventions", CONVENTIONS),
        ("title", title),
        ("format_name", CALIBRATION_FORMAT_NAME),
        ("format_version", &format!("{major}.{minor}")),
        ("program_version", PROGRAM_VERSION),
        ("git_hash", GIT_HASH),
        ("scenario", scenario_text),
        ("method", question.method.name()),
        ("lag_choice", if question.lag == Lag::Auto { "auto" } else { "given" }),
    ] {
        to.set_attribute(name, value)?;
    }
    if let Some(shear_stiffness) = question.shear_stiffness {
        to.set_attribute("shear_stiffness", shear_stiffness)?;
    }
    for (name, value) in [
        ("interval", question.level),
        ("lag", lag.estimate),
        ("lag_low", lag.low),
        ("lag_high", lag.high),
        ("residual_rms", calibration.residuals.rms),
        ("temperature_resolution", calibration.resolution),
    ] {
        to.set_attribute(name, value)?;
    }
    if let Some(profile) = &calibration.lag_profile {
        to.set_attribute("lag_likeliest", profile.likeliest)?;
        to.set_attribute("lag_gain", profile.gain)?;
    }
    for (name, value) in [
        ("spikes_displacement", spikes.readings as u64),
        ("spikes_temperature", spikes.temperatures as u64),
        ("mirrored", u64::from(calibration.is_mirrored)),
    ] {
        to.set_attribute(name, value)?;
    }
    let lines: Vec<String> = warnings.iter().map(|(name, sentence)| format!("{name}: {sentence}")).collect();
    if lines.is_empty() { Ok(()) } else { to.set_attribute("warnings", lines.join("\n")) }
}

/// Write what was asked and does not follow from the answer.
fn write_question<D: Destination>(to: &mut D, question: &Question) -> Result<(), D::Error> {
    let Motion { reach, jump, start } = question.guess;
    to.set_attribute("guess_reach", reach)?;
    to.set_attribute("guess_jump", jump)?;
    to.set_attribute("guess_start", start)?;
    let held = |quantity| question.held.iter().find(|held| held.0 == quantity).map_or(f64::NAN, |held| held.1);
    let bound = |quantity, end: usize| {
        question.bounds.iter().find(|bound| bound.0 == quantity).map_or(f64::NAN, |bound| bound.1[end])
    };
    to.write_variable(&QUANTITY, &texts(Quantity::ALL.map(Quantity::key)))?;
    to.write_variable(&HELD, &Quantity::ALL.map(held))?;
    to.write_variable(&BOUND_LOW, &Quantity::ALL.map(|quantity| bound(quantity, 0)))?;
    to.write_variable(&BOUND_HIGH, &Quantity::ALL.map(|quantity| bound(quantity, 1)))
}

/// Read what `write_question` has written into a question.
fn read_question<S: Source>(from: &S, question: &mut Question) -> Result<(), S::Error> {
    let [held, low, high]: [Result<Vec<f64>, _>; 3] =
        [&HELD, &BOUND_LOW, &BOUND_HIGH].map(|variable| read_or_empty(from, variable));
    let (held, low, high) = (held?, low?, high?);
    if [&held, &low, &high].iter().any(|values| values.len() != Quantity::ALL.len()) {
        return Err(format!("{} has another size", HELD.name).into());
    }
    let is_held = |quantity: &Quantity| !held[*quantity as usize].is_nan();
    question.held =
        Quantity::FITTED.into_iter().filter(is_held).map(|quantity| (quantity, held[quantity as usize])).collect();
    let is_bound = |quantity: &Quantity| !low[*quantity as usize].is_nan();
    let bound = |quantity: Quantity| (quantity, [low[quantity as usize], high[quantity as usize]]);
    question.bounds = Quantity::ALL.into_iter().filter(is_bound).map(bound).collect();
    let [reach, jump, start] = ["guess_reach", "guess_jump", "guess_start"].map(|name| read_real(from, name));
    question.guess = Motion { reach: reach?, jump: jump?, start: start? };
    Ok(())
}

fn ends(estimates: &[Estimate]) -> [Vec<f64>; 3] {
    let of = |end: fn(&Estimate) -> f64| estimates.iter().map(end).collect();
    [of(|estimate| estimate.estimate), of(|estimate| estimate.low), of(|estimate| estimate.high)]
}

fn variables<D: Destination>(to: &mut D, calibration: &Calibration) -> Result<(), D::Error> {
    to.write_variable(&QUANTITY_SYMBOL, &texts(Quantity::ALL.map(Quantity::symbol)))?;
    to.write_variable(&QUANTITY_UNIT, &texts(Quantity::ALL.map(Quantity::unit)))?;
    for (variable, values) in [&ESTIMATE, &LOW, &HIGH].into_iter().zip(ends(&calibration.estimates)) {
        to.write_variable(variable, &values)?;
    }
    if let Some(others) = &calibration.least_squares {
        for (variable, values) in [&ERR_ESTIMATE, &ERR_LOW, &ERR_HIGH].into_iter().zip(ends(others)) {
            to.write_variable(variable, &values)?;
        }
    }
    if !calibration.correlations.is_empty() {
        to.write_variable(&OTHER, &texts(Quantity::ALL.map(Quantity::key)))?;
        to.write_variable(&CORRELATION, &calibration.correlations.concat())?;
    }
    let slips = &calibration.slips;
    let of = |value: fn(&SeenSlip) -> f64| slips.iter().map(value).collect::<Vec<f64>>();
    to.write_variable(&SLIP, &numbers(slips.len()))?;
    to.write_variable(&SLIP_TIME, &of(|slip| slip.time))?;
    to.write_variable(&SLIP_TEMPERATURE, &of(|slip| slip.temperature))?;
    to.write_variable(&SLIP_JUMP, &of(|slip| slip.jump))?;
    to.write_variable(&SLIP_USUAL, &slips.iter().map(|slip| i8::from(slip.is_usual)).collect::<Vec<_>>())?;
    to.write_variable(&START, &numbers(calibration.starts.len()))?;
    to.write_variable(&START_ERR, &calibration.starts.iter().map(|start| start.err).collect::<Vec<_>>())?;
    to.write_variable(&START_VALUE, &calibration.start_values().concat())?;
    if let Some(profile) = &calibration.lag_profile {
        to.write_variable(&LAG, &profile.profile.iter().map(|(lag, _)| *lag).collect::<Vec<_>>())?;
        to.write_variable(&LAG_DEVIANCE, &profile.profile.iter().map(|(_, deviance)| *deviance).collect::<Vec<_>>())?;
    }
    let correlation = &calibration.residuals.autocorrelation;
    to.write_variable(&DELAY, &correlation.iter().map(|(delay, _)| *delay).collect::<Vec<_>>())?;
    to.write_variable(&AUTOCORRELATION, &correlation.iter().map(|(_, correlation)| *correlation).collect::<Vec<_>>())?;
    to.write_variable(&TIME, &calibration.record.times)?;
    to.write_variable(&TEMPERATURE, &calibration.record.temperatures)?;
    to.write_variable(&STEEL, &calibration.steel)?;
    to.write_variable(&READING, &calibration.record.readings)?;
    to.write_variable(&MODELLED, &calibration.modelled)
}

fn numbers(count: usize) -> Vec<u32> {
    (0..).take(count).collect()
}

/// Read a calibration.
pub(crate) fn read<S: Source>(from: &S) -> Result<StoredCalibration, S::Error> {
    let number = |name: &str| read_real(from, name);
    let whole = |name: &str| read_count(from, name);
    let column = |variable: &Variable| read_or_empty::<S, f64>(from, variable);
    // Every column has the length of its coordinate.
    let along = |variable: &Variable, length: usize| match column(variable)? {
        values if values.len() == length => Ok(values),
        values => Err(S::Error::from(format!("{} has {} values, not {length}", variable.name, values.len()))),
    };
    let all = Quantity::ALL.len();
    let estimates = |variables: [&Variable; 3]| -> Result<[Estimate; Quantity::ALL.len()], S::Error> {
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
    let usual = read_or_empty::<S, i8>(from, &SLIP_USUAL)?;
    let errs = column(&START_ERR)?;
    let starts = rows(&along(&START_VALUE, errs.len() * all)?);
    let lags = column(&LAG)?;
    let deviances = along(&LAG_DEVIANCE, lags.len())?;
    let delays = column(&DELAY)?;
    let correlations = along(&AUTOCORRELATION, delays.len())?;
    let method = Method::from_name(&read_text(from, "method")?).ok_or_else(|| "an unknown method".to_string())?;
    let lag = Estimate { estimate: number("lag")?, low: number("lag_low")?, high: number("lag_high")? };
    let response = response_of(&found.map(|estimate| estimate.estimate));
    let mut question = Question {
        method,
        shear_stiffness: read_real_if_present(from, "shear_stiffness")?,
        starts: errs.len() as u32,
        lag: if read_text(from, "lag_choice")? == "auto" { Lag::Auto } else { Lag::Known(lag.estimate) },
        level: number("interval")?,
        held: Vec::new(),
        bounds: Vec::new(),
        guess: response.motion,
    };
    let is_repeatable = from.has(HELD.name);
    if is_repeatable {
        read_question(from, &mut question)?;
    }
    let profile = (!lags.is_empty()).then(|| {
        let profile = lags.into_iter().zip(deviances).collect();
        Ok::<_, S::Error>(LagProfile { likeliest: number("lag_likeliest")?, gain: number("lag_gain")?, profile })
    });
    let calibration = Calibration {
        question,
        steel: along(&STEEL, n)?,
        modelled: along(&MODELLED, n)?,
        record,
        resolution: if is_repeatable { number("temperature_resolution")? } else { f64::NAN },
        spikes: Spikes {
            readings: whole("spikes_displacement")? as usize,
            temperatures: whole("spikes_temperature")? as usize,
        },
        is_mirrored: whole("mirrored")? != 0,
        response,
        estimates: found,
        least_squares: match from.has(ERR_ESTIMATE.name) {
            false => None,
            true => Some(estimates([&ERR_ESTIMATE, &ERR_LOW, &ERR_HIGH])?),
        },
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
    let warnings = read_text_if_present(from, "warnings")?.unwrap_or_default();
    let split = |line: &str| line.split_once(": ").map(|(name, text)| (name.to_string(), text.to_string()));
    Ok(StoredCalibration {
        title: read_text(from, "title")?,
        scenario_text: read_text(from, "scenario")?,
        calibration,
        warnings: warnings.lines().filter_map(split).collect(),
        other_program: read_other_program(from)?,
        is_repeatable,
    })
}

const LENGTH: Unit = Unit::Of(Dimension::LENGTH);
const TEMPERATURES: Unit = Unit::Of(Dimension::TEMPERATURE);
const PER_QUANTITY: &[(&str, &str)] = &[("coordinates", "quantity_symbol quantity_unit")];

/// Declares the variables together with the list of all of them, so that the list is complete.
macro_rules! table {
    ($($constant:ident = $value:expr;)*) => {
        $(pub(crate) const $constant: Variable = $value;)*
        #[cfg(test)]
        const ALL: &[&Variable] = &[$(&$constant),*];
    };
}

table! {
    QUANTITY = variable("quantity", &["quantity"], Unit::None, "key of the quantity");
    QUANTITY_SYMBOL = variable("quantity_symbol", &["quantity"], Unit::None, "symbol of the quantity");
    QUANTITY_UNIT = variable("quantity_unit", &["quantity"], Unit::None, "unit of the quantity");
    ESTIMATE = variable("estimate", &["quantity"], Unit::None, "estimate").with(PER_QUANTITY);
    LOW = variable("interval_low", &["quantity"], Unit::None, "lower end of the interval").with(PER_QUANTITY);
    HIGH = variable("interval_high", &["quantity"], Unit::None, "upper end of the interval").with(PER_QUANTITY);
    ERR_ESTIMATE = variable("least_squares", &["quantity"], Unit::None,
        "estimate by the least squares, from the best of its starts").with(PER_QUANTITY);
    ERR_LOW = variable("least_squares_low", &["quantity"], Unit::None,
        "lower end of the interval of the least squares").with(PER_QUANTITY);
    ERR_HIGH = variable("least_squares_high", &["quantity"], Unit::None,
        "upper end of the interval of the least squares").with(PER_QUANTITY);
    HELD = variable("held", &["quantity"], Unit::None, "value at which the quantity was held, missing where fitted")
        .with(PER_QUANTITY);
    BOUND_LOW = variable("bound_low", &["quantity"], Unit::None,
        "lower bound of the search, missing where there was none").with(PER_QUANTITY);
    BOUND_HIGH = variable("bound_high", &["quantity"], Unit::None,
        "upper bound of the search, missing where there was none").with(PER_QUANTITY);
    OTHER = variable("other", &["other"], Unit::None, "key of the other quantity");
    CORRELATION = variable("correlation", &["quantity", "other"], Unit::ONE,
        "correlation of the errors of two quantities");
    SLIP = variable("slip", &["slip"], Unit::ONE, "number of the slip");
    SLIP_TIME = variable("slip_time", &["slip"], Unit::Seconds, "time of the slip, in the middle between two samples");
    SLIP_TEMPERATURE = variable("slip_temperature", &["slip"], TEMPERATURES, "temperature of steel at the slip");
    SLIP_JUMP = variable("slip_jump", &["slip"], LENGTH, "jump of the displacement less kappa beta T");
    SLIP_USUAL = variable("slip_usual", &["slip"], Unit::None, "whether the slip is alone and of the usual size")
        .flags(&[0, 1], &[("flag_meanings", "left_out fitted")]);
    START = variable("start", &["start"], Unit::ONE, "number of the start of the least squares");
    START_ERR = variable("start_err", &["start"], Unit::Of(Dimension::AREA),
        "mean square of model less measurement");
    START_VALUE = variable("start_value", &["start", "quantity"], Unit::None, "what the start found");
    LAG = variable("lag", &["lag"], Unit::Seconds, "lag of steel behind the thermometer");
    LAG_DEVIANCE = variable("lag_deviance", &["lag"], Unit::ONE,
        "twice the logarithm of the largest likelihood over that of this lag");
    DELAY = variable("delay", &["delay"], Unit::None, "delay in hours").with(&[("units", "h")]);
    AUTOCORRELATION = variable("residual_autocorrelation", &["delay"], Unit::ONE,
        "correlation of residuals that are so far apart");
    TIME = variable("time", &["time"], Unit::Seconds, "time since the first sample").with(&[("axis", "T")]);
    TEMPERATURE = variable("temperature", &["time"], TEMPERATURES, "temperature as measured, without spikes");
    STEEL = variable("steel_temperature", &["time"], TEMPERATURES, "temperature of steel, behind the measured one");
    READING = variable("displacement", &["time"], LENGTH, "displacement as measured, without spikes");
    MODELLED = variable("displacement_modelled", &["time"], LENGTH, "displacement of the model");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documentation_names_every_variable() {
        let text = include_str!("../../docs/output-format.md");
        for variable in ALL {
            assert!(text.contains(&format!("`{}`", variable.name)), "{}", variable.name);
        }
    }
}
