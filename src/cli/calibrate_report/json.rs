//! A calibration for programs: one JSON object.

use crate::cli::document::{JsonWarning, document};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use stick_slip::bearing::calibration::{Calibration, Lag, ParameterEstimate, Quantity};

/// The object as text with a line break at its end. Each warning is a name and a sentence. Numbers
/// that are not known are null.
pub fn json(calibration: &Calibration, warnings: &[(String, String)]) -> String {
    let of = |quantities: &[Quantity]| -> BTreeMap<&str, Value> {
        quantities.iter().map(|quantity| (quantity.key(), estimate(calibration.estimate(*quantity)))).collect()
    };
    let (parameters, derived) = Quantity::ALL.split_at(Quantity::PARAMETERS);
    let (lag, profile) = (&calibration.lag, calibration.lag_profile.as_ref());
    let starts = calibration.starts.iter().zip(calibration.start_values()).map(|(start, values)| {
        let of_start = parameters.iter().map(|quantity| (quantity.key(), values[*quantity as usize]));
        json!({ "err": start.err, "parameters": of_start.collect::<BTreeMap<_, _>>() })
    });
    let slips = calibration.slips.iter().map(
        |slip| json!({ "time": slip.time, "temperature": slip.temperature, "jump": slip.jump, "usual": slip.is_usual }),
    );
    let warnings = warnings.iter().map(|(name, text)| JsonWarning { name: name.clone(), text: text.clone() });
    let object = json!({
        "parameters": of(parameters),
        "derived": of(derived),
        "interval": calibration.question.level,
        "slips": slips.collect::<Vec<_>>(),
        "lag": {
            "estimate": lag.estimate,
            "low": lag.low,
            "high": lag.high,
            "estimated": calibration.question.lag == Lag::Auto,
            "likeliest": profile.map(|profile| profile.likeliest),
            "gain": profile.map(|profile| profile.gain),
            "clock": profile.and_then(|profile| profile.clock),
            "profile": profile.map_or(&[][..], |profile| &profile.profile[..]),
        },
        "roughness": calibration.roughness,
        "zero": { "drift_per_year": calibration.zero.drift_per_year(), "steps": calibration.zero.steps },
        "starts": starts.collect::<Vec<_>>(),
        "residuals": {
            "rms": calibration.residuals.rms,
            "autocorrelation": calibration.residuals.autocorrelation,
        },
        "warnings": warnings.collect::<Vec<_>>(),
    });
    document("calibration", object)
}

fn estimate(ParameterEstimate { estimate, low, high }: ParameterEstimate) -> Value {
    json!({ "estimate": estimate, "low": low, "high": high })
}
