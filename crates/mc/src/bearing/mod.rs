//! Bearings of bridges: all commands about them, and the kinds of their results. The list of kinds and
//! the list of verbs ([`crate::KINDS`]) mention this module, and nothing else does.

mod calibrate;
mod calibration;
mod fit_temperature;
mod forecast;
mod measurements;
mod twin;
mod years;

pub use Verb as Arguments;
pub use calibration::CALIBRATION;

use crate::Failure;

verbs! {
    /// Estimate friction, stiffness and dilatation of a bearing from measured temperatures and
    /// displacements
    Calibrate(calibrate),
    /// Make a synthetic record of a bearing with known parameters, to test calibration
    Twin(twin),
    /// Fit harmonics and noise of a scenario to a measured temperature
    FitTemperature(fit_temperature),
    /// Simulate future years of a measured bearing: sliding path, slips, displacements, forces
    Forecast(forecast),
}

/// Bytes that a calibration or a forecast needs in addition to its record, which is read before.
const STUDY_BYTES: f64 = 30e6;

/// Effects that neither fit nor forecast includes.
const LEFT_OUT: &str = "Traffic, wind and braking, which move a bearing faster than the weather; wear, which \
                        changes friction; and a climate different from that of the record. Movements that \
                        they cause add to the sliding path.";
