//! A calibration for programs: one JSON object.

use crate::cli::document::{JsonWarning, document};
use serde::Serialize;
use std::collections::BTreeMap;
use stick_slip::bearing::calibration::{Calibration, Estimate, Lag, Quantity};

#[derive(Serialize)]
struct JsonCalibration<'a> {
    parameters: BTreeMap<&'static str, JsonEstimate>,
    derived: BTreeMap<&'static str, JsonEstimate>,
    interval: f64,
    slips: Vec<JsonSlip>,
    lag: JsonLag,
    starts: Vec<JsonStart>,
    residuals: JsonResiduals<'a>,
    warnings: Vec<JsonWarning>,
}

/// Numbers that are not known are null.
#[derive(Serialize)]
struct JsonEstimate {
    estimate: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
}

#[derive(Serialize)]
struct JsonSlip {
    time: f64,
    temperature: f64,
    jump: f64,
    usual: bool,
}

#[derive(Serialize)]
struct JsonLag {
    estimate: f64,
    low: Option<f64>,
    high: Option<f64>,
    estimated: bool,
    likeliest: Option<f64>,
    gain: Option<f64>,
    profile: Vec<[f64; 2]>,
}

#[derive(Serialize)]
struct JsonStart {
    err: f64,
    parameters: BTreeMap<&'static str, Option<f64>>,
}

#[derive(Serialize)]
struct JsonResiduals<'a> {
    rms: f64,
    autocorrelation: &'a [(f64, f64)],
}

fn known(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

fn estimate(estimate: Estimate) -> JsonEstimate {
    let Estimate { estimate, low, high } = estimate;
    JsonEstimate { estimate: known(estimate), low: known(low), high: known(high) }
}

/// The object as text with a line break at its end. Each warning is a name and a sentence.
pub fn json(calibration: &Calibration, warnings: &[(String, String)]) -> String {
    let of = |quantities: &[Quantity]| {
        quantities.iter().map(|quantity| (quantity.key(), estimate(calibration.estimate(*quantity)))).collect()
    };
    let (parameters, derived) = Quantity::ALL.split_at(Quantity::PARAMETERS);
    let profile = calibration.lag_profile.as_ref();
    let starts = calibration.starts.iter().zip(calibration.start_values()).map(|(start, values)| JsonStart {
        err: start.err,
        parameters: parameters.iter().map(|quantity| (quantity.key(), known(values[*quantity as usize]))).collect(),
    });
    let object = JsonCalibration {
        parameters: of(parameters),
        derived: of(derived),
        interval: calibration.question.level,
        slips: (calibration.slips.iter())
            .map(|slip| JsonSlip {
                time: slip.time,
                temperature: slip.temperature,
                jump: slip.jump,
                usual: slip.is_usual,
            })
            .collect(),
        lag: JsonLag {
            estimate: calibration.lag.estimate,
            low: known(calibration.lag.low),
            high: known(calibration.lag.high),
            estimated: calibration.question.lag == Lag::Auto,
            likeliest: profile.map(|profile| profile.likeliest),
            gain: profile.map(|profile| profile.gain),
            profile: profile.map_or_else(Vec::new, |profile| profile.profile.iter().map(|(a, b)| [*a, *b]).collect()),
        },
        starts: starts.collect(),
        residuals: JsonResiduals {
            rms: calibration.residuals.rms,
            autocorrelation: &calibration.residuals.autocorrelation,
        },
        warnings: warnings.iter().map(|(name, text)| JsonWarning { name: name.clone(), text: text.clone() }).collect(),
    };
    document("calibration", &object)
}
