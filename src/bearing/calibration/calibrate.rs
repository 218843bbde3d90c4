//! The steps from a record to a calibration.

use super::hold::conditioned;
use super::lag;
use super::misfit::Misfit;
use super::quantity::{Quantity, response_of, values};
use super::question::{CalibrationError, LEAST, Lag, Method, Question};
use super::report::{Calibration, Parts};
use super::samples::Record;
use super::slips::Evidence;
use super::spikes::{self, Spikes};
use super::starts::{Search, starts};
use super::uncertainty::{AroundLag, Replicates};
use super::warnings::warnings;
use crate::data::{absurd, is_constant};
use std::sync::atomic::AtomicBool;

/// The fewest usual slips that determine anything.
const FEWEST_SLIPS: usize = 6;

/// Find the parameters of a bearing from a record.
///
/// # Errors
///
/// If the record is too short, if a number in it is absurdly large, if a column is constant, or if only the method by slips is asked for
/// and no slips are visible.
pub fn calibrate(
    record: &Record,
    question: &Question,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Calibration, CalibrationError> {
    check(record)?;
    let (clean, spikes) = spikes::without_spikes(record);
    let (clean, is_mirrored) = upright(clean);
    let prepared = Prepared { record: clean, resolution: record.resolution(), spikes, is_mirrored };
    fit(prepared, question, threads, stop)
}

/// Repeat a calibration with the record that it was made from. The result is the same, bit for bit.
///
/// # Errors
///
/// As for [`calibrate`]. A calibration that [`calibrate`] has made gives none.
pub fn calibrate_again(
    calibration: &Calibration,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Calibration, CalibrationError> {
    let Calibration { question, record, resolution, spikes, is_mirrored, .. } = calibration;
    check(record)?;
    let prepared =
        Prepared { record: record.clone(), resolution: *resolution, spikes: *spikes, is_mirrored: *is_mirrored };
    fit(prepared, question, threads, stop)
}

/// A record as it is fitted: without spikes, and with the sign with which displacements grow with
/// temperature.
struct Prepared {
    record: Record,
    /// The resolution of the thermometer before spikes were taken out.
    resolution: f64,
    spikes: Spikes,
    is_mirrored: bool,
}

fn fit(
    Prepared { record: clean, resolution, spikes, is_mirrored }: Prepared,
    question: &Question,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Calibration, CalibrationError> {
    let given = match question.lag {
        Lag::Known(lag) => lag,
        Lag::Auto => 0.0,
    };
    let evidence_at = |lag: f64| Evidence::find(&clean.lagged(lag).samples(), resolution).filter(is_visible);
    let mut evidence = evidence_at(given);
    let mut profile = evidence.as_ref().map(|evidence| lag::lag_profile(&clean, evidence));
    let mut used = given;
    if let (Lag::Auto, Some(first)) = (question.lag, &profile)
        && first.gain > lag::CONVINCING
        && let Some(second) = evidence_at(first.likeliest)
    {
        let again = lag::lag_profile(&clean, &second);
        used = again.likeliest;
        evidence = evidence_at(used);
        profile = Some(again);
    }
    let steel = clean.lagged(used);
    let around = evidence.map(|evidence| match question.lag {
        Lag::Auto if used > 0.0 => AroundLag::lag(evidence, &clean, used),
        _ => AroundLag { here: evidence, beside: None },
    });
    let by_slips = around.as_ref().and_then(|around| around.here.fit(&around.here.unweighted()));
    if by_slips.is_none() && question.method == Method::Slips {
        return Err(CalibrationError::NoSlips);
    }
    let shear = question.shear_stiffness.unwrap_or(1.0);
    let mut replicates = around.as_ref().map(|around| Replicates::new(around, shear));
    let by_slips = by_slips.zip(replicates.as_mut()).map(|(fit, replicates)| {
        response_of(&conditioned(values(&fit, Some(shear)), replicates, &question.held, shear))
    });
    let deviations = replicates.as_ref().map(Replicates::deviations);
    let misfit = Misfit::new(&steel);
    let found = if question.method == Method::Slips {
        Vec::new()
    } else {
        let search = match (&by_slips, &deviations) {
            (Some(fit), Some(sd)) => {
                Search::around(&fit.motion, [sd[Quantity::Reach as usize], sd[Quantity::Jump as usize]])
            }
            _ => Search::guessed(&question.guess),
        };
        starts(&misfit, &search, question, threads, stop)
    };
    let evidence = around.as_ref().map(|around| &around.here).filter(|_| by_slips.is_some());
    let mut calibration = Calibration::new(Parts {
        question,
        record: &clean,
        steel: &steel,
        resolution,
        spikes,
        is_mirrored,
        used,
        profile,
        evidence,
        by_slips,
        replicates,
        deviations,
        misfit: &misfit,
        starts: found,
    });
    calibration.warnings = warnings(&calibration, evidence);
    Ok(calibration)
}

fn check(record: &Record) -> Result<(), CalibrationError> {
    let seen = record.samples();
    if seen.times.len() < LEAST {
        return Err(CalibrationError::TooShort(seen.times.len()));
    }
    let columns = [("temperature", &record.times, &record.temperatures), ("displacement", &seen.times, &seen.readings)];
    for (name, times, values) in columns {
        if let Some((time, value)) = absurd(times, values) {
            return Err(CalibrationError::Absurd { name, time, value });
        }
    }
    for (name, values) in [("temperature", &seen.temperatures), ("displacement", &seen.readings)] {
        if is_constant(values) {
            return Err(CalibrationError::Constant(name));
        }
    }
    Ok(())
}

/// Whether enough slips are seen to determine the parameters.
fn is_visible(evidence: &Evidence) -> bool {
    let usual = evidence.slips.iter().filter(|slip| slip.is_usual).count();
    usual >= FEWEST_SLIPS && evidence.reversals.len() >= 2
}

/// Change the sign of the displacements if they fall as the temperature rises, because a sensor may
/// count in the other direction. The flag is true if the sign was changed.
fn upright(record: Record) -> (Record, bool) {
    let seen = record.samples();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (t, z) = (mean(&seen.temperatures), mean(&seen.readings));
    let together: f64 = seen.temperatures.iter().zip(&seen.readings).map(|(a, b)| (a - t) * (b - z)).sum();
    if together >= 0.0 {
        return (record, false);
    }
    let readings = record.readings.iter().map(|reading| -reading).collect();
    (Record { readings, ..record }, true)
}
