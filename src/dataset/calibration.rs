//! A calibration as a data set: the record, what was found in it, and what the model makes of it.

use super::header::CONVENTIONS;
use super::layout::{Unit, Variable, variable};
use super::{Destination, texts};
use crate::provenance::{GIT_HASH, PROGRAM_VERSION};
use crate::stats::{Dimension, Units};
use crate::study::calibration::{Calibration, Estimate, Lag, Quantity, SeenSlip};

/// What `format_name` says of a calibration.
pub(crate) const CALIBRATION_FORMAT_NAME: &str = "stick-slip calibration";

/// Major and minor version of that format.
pub(crate) const CALIBRATION_FORMAT_VERSION: (u32, u32) = (1, 0);

/// Labels of its units.
pub(crate) fn units() -> Units {
    let [time, length, force, temperature] = ["s", "m", "N", "K"].map(String::from);
    Units { time, length, force, temperature }
}

/// Write a calibration.
pub(crate) fn write<D: Destination>(
    to: &mut D,
    title: &str,
    scenario_text: &str,
    calibration: &Calibration,
) -> Result<(), D::Error> {
    attributes(to, title, scenario_text, calibration)?;
    variables(to, calibration)
}

fn attributes<D: Destination>(
    to: &mut D,
    title: &str,
    scenario_text: &str,
    calibration: &Calibration,
) -> Result<(), D::Error> {
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
        to.say(name, value)?;
    }
    if let Some(shear_stiffness) = question.shear_stiffness {
        to.say("shear_stiffness", shear_stiffness)?;
    }
    for (name, value) in [
        ("interval", question.level),
        ("lag", lag.estimate),
        ("lag_low", lag.low),
        ("lag_high", lag.high),
        ("residual_rms", calibration.residuals.rms),
    ] {
        to.say(name, value)?;
    }
    if let Some(profile) = &calibration.lag_profile {
        to.say("lag_likeliest", profile.likeliest)?;
        to.say("lag_gain", profile.gain)?;
    }
    for (name, value) in [
        ("spikes_displacement", spikes.readings as u64),
        ("spikes_temperature", spikes.temperatures as u64),
        ("mirrored", u64::from(calibration.is_mirrored)),
    ] {
        to.say(name, value)?;
    }
    let warnings: Vec<String> =
        calibration.warnings.iter().map(|warning| format!("{}: {warning}", warning.name())).collect();
    if warnings.is_empty() { Ok(()) } else { to.say("warnings", warnings.join("\n")) }
}

fn ends(estimates: &[Estimate]) -> [Vec<f64>; 3] {
    let of = |end: fn(&Estimate) -> f64| estimates.iter().map(end).collect();
    [of(|estimate| estimate.estimate), of(|estimate| estimate.low), of(|estimate| estimate.high)]
}

fn variables<D: Destination>(to: &mut D, calibration: &Calibration) -> Result<(), D::Error> {
    let keys = texts(Quantity::ALL.map(Quantity::key));
    to.put(&QUANTITY, &keys)?;
    to.put(&QUANTITY_SYMBOL, &texts(Quantity::ALL.map(Quantity::symbol)))?;
    to.put(&QUANTITY_UNIT, &texts(Quantity::ALL.map(Quantity::unit)))?;
    for (variable, values) in [&ESTIMATE, &LOW, &HIGH].into_iter().zip(ends(&calibration.estimates)) {
        to.put(variable, &values)?;
    }
    if let Some(others) = &calibration.least_squares {
        for (variable, values) in [&ERR_ESTIMATE, &ERR_LOW, &ERR_HIGH].into_iter().zip(ends(others)) {
            to.put(variable, &values)?;
        }
    }
    if !calibration.correlations.is_empty() {
        to.put(&OTHER, &keys)?;
        to.put(&CORRELATION, &calibration.correlations.concat())?;
    }
    let slips = &calibration.slips;
    let of = |value: fn(&SeenSlip) -> f64| slips.iter().map(value).collect::<Vec<f64>>();
    to.put(&SLIP, &numbers(slips.len()))?;
    to.put(&SLIP_TIME, &of(|slip| slip.time))?;
    to.put(&SLIP_TEMPERATURE, &of(|slip| slip.temperature))?;
    to.put(&SLIP_JUMP, &of(|slip| slip.jump))?;
    to.put(&SLIP_USUAL, &slips.iter().map(|slip| i8::from(slip.is_usual)).collect::<Vec<_>>())?;
    to.put(&START, &numbers(calibration.starts.len()))?;
    to.put(&START_ERR, &calibration.starts.iter().map(|start| start.err).collect::<Vec<_>>())?;
    to.put(&START_VALUE, &calibration.start_values().concat())?;
    if let Some(profile) = &calibration.lag_profile {
        to.put(&LAG, &profile.profile.iter().map(|(lag, _)| *lag).collect::<Vec<_>>())?;
        to.put(&LAG_DEVIANCE, &profile.profile.iter().map(|(_, deviance)| *deviance).collect::<Vec<_>>())?;
    }
    let correlation = &calibration.residuals.autocorrelation;
    to.put(&DELAY, &correlation.iter().map(|(delay, _)| *delay).collect::<Vec<_>>())?;
    to.put(&AUTOCORRELATION, &correlation.iter().map(|(_, correlation)| *correlation).collect::<Vec<_>>())?;
    to.put(&TIME, &calibration.record.times)?;
    to.put(&TEMPERATURE, &calibration.record.temperatures)?;
    to.put(&STEEL, &calibration.steel)?;
    to.put(&READING, &calibration.record.readings)?;
    to.put(&MODELLED, &calibration.modelled)
}

fn numbers(count: usize) -> Vec<u32> {
    (0..).take(count).collect()
}

const LENGTH: Unit = Unit::Of(Dimension::LENGTH);
const TEMPERATURES: Unit = Unit::Of(Dimension::TEMPERATURE);
const PER_QUANTITY: &[(&str, &str)] = &[("coordinates", "quantity_symbol quantity_unit")];

/// Declares the variables and the list of all of them together, so that neither can miss one.
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
