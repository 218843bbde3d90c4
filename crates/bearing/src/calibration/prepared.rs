//! Prepares a record for fitting.

use super::question::{CalibrationError, LEAST};
use super::samples::MeasuredRecord;
use crate::Unsound;
use crate::moments::mean;

/// Check that the record is long enough, and that its numbers are valid and not all equal.
pub fn check(record: &MeasuredRecord) -> Result<(), CalibrationError> {
    let seen = record.samples();
    if seen.times.len() < LEAST {
        return Err(CalibrationError::TooShort(seen.times.len()));
    }
    Unsound::absurd("temperature", &record.times, &record.temperatures)?;
    Unsound::absurd("displacement", &seen.times, &seen.readings)?;
    Unsound::constant("temperature", &seen.temperatures)?;
    Ok(Unsound::constant("displacement", &seen.readings)?)
}

/// Change the sign of the displacements if they fall as the temperature rises, because a sensor may
/// count in the other direction. The flag is true if the sign was changed.
pub fn upright(record: MeasuredRecord) -> (MeasuredRecord, bool) {
    let seen = record.samples();
    let (t, z) = (mean(&seen.temperatures), mean(&seen.readings));
    let together: f64 = seen
        .temperatures
        .iter()
        .zip(&seen.readings)
        .map(|(a, b)| (a - t) * (b - z))
        .sum();
    if together >= 0.0 {
        return (record, false);
    }
    let readings = record.readings.iter().map(|reading| -reading).collect();
    (MeasuredRecord { readings, ..record }, true)
}
