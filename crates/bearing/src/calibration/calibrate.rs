//! The steps from a record to a calibration.

use super::by_slips::BySlips;
use super::detect::freely;
use super::objective::FitObjective;
use super::prepared::{check, upright};
use super::quantity::Quantity;
use super::question::{CalibrationError, CalibrationMethod, CalibrationQuestion};
use super::report::{Calibration, ParameterEstimate};
use super::samples::MeasuredRecord;
use super::starts::{Search, around, around_guess, starts};
use super::steel::Steel;
use super::uncertainty::Workers;
use super::warnings::warnings;
use super::zero::Zero;
use std::sync::atomic::AtomicBool;
use stickslip_data::resolution;

/// Find the parameters of a bearing from a record.
///
/// # Errors
///
/// If the record is too short, has an absurdly large number or a constant column. If no slips are
/// visible and only the method by slips is requested. If the estimates are unphysical.
pub fn calibrate(
    record: &MeasuredRecord,
    question: &CalibrationQuestion,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Calibration, CalibrationError> {
    check(record)?;
    let (record, is_mirrored) = upright(record.clone());
    let (record, repeats) = match record.without_repeated() {
        Some((record, every)) => (record, Some(every)),
        None => (record, None),
    };
    fit(record, (is_mirrored, repeats), question, threads, stop)
}

/// Repeat a calibration with its record. The result is identical, bit for bit.
///
/// # Errors
///
/// As for [`calibrate`]. Repeating a result of [`calibrate`] does not fail.
pub fn calibrate_again(
    calibration: &Calibration,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Calibration, CalibrationError> {
    let Calibration {
        question,
        record,
        is_mirrored,
        repeats,
        ..
    } = calibration;
    check(record)?;
    fit(
        record.clone(),
        (*is_mirrored, *repeats),
        question,
        threads,
        stop,
    )
}

/// Estimate from the slips and by least squares, as requested, from a record whose displacements
/// grow with temperature, given whether their sign was changed, and how often the thermometer measured
/// if it repeated its values.
fn fit(
    record: MeasuredRecord,
    (is_mirrored, repeats): (bool, Option<f64>),
    question: &CalibrationQuestion,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Calibration, CalibrationError> {
    let mut steel = Steel::new(&record, question.lag);
    if let Some(slips) = &steel.slips {
        slips.check_resolution(resolution(&record.samples().readings))?;
    }
    let by_slips = BySlips::new(&mut steel, question, Workers { threads, stop })?;
    let slips = by_slips.as_ref().map(|by_slips| &by_slips.slips);
    if slips.is_none() && question.method == CalibrationMethod::Slips {
        let follows = freely(&record.samples());
        return Err(follows.map_or(CalibrationError::NoSlips, CalibrationError::MovesFreely));
    }
    let zero = by_slips
        .as_ref()
        .map_or_else(Zero::default, |by_slips| by_slips.zero.clone());
    let objective = FitObjective::new(&steel.record.without(&zero), steel.overlooked());
    let starts = match question.method {
        CalibrationMethod::Slips => Vec::new(),
        CalibrationMethod::Err | CalibrationMethod::Both => starts(
            &objective,
            &search(by_slips.as_ref(), question),
            question,
            threads,
            stop,
        ),
    };
    let mut calibration = Calibration::new(
        question,
        record,
        &steel,
        by_slips.as_ref(),
        &objective,
        starts,
    );
    if let Some((quantity, value)) = calibration.response.impossible(question.shear_stiffness) {
        return Err(CalibrationError::NoBearing { quantity, value });
    }
    calibration.is_mirrored = is_mirrored;
    calibration.repeats = repeats;
    check_friction(&calibration)?;
    calibration.warnings = warnings(&calibration, by_slips.as_ref());
    Ok(calibration)
}

/// Check that the intervals of friction do not include zero, which no bearing has.
fn check_friction(calibration: &Calibration) -> Result<(), CalibrationError> {
    let quantity = match calibration.question.shear_stiffness {
        Some(_) => Quantity::Static,
        None => Quantity::StaticWay,
    };
    let ParameterEstimate { low, high, .. } = calibration.estimate(quantity);
    match low <= 0.0 {
        true => Err(CalibrationError::NoFriction {
            quantity,
            interval: [low, high],
        }),
        false => Ok(()),
    }
}

/// The box of the least-squares search: around the response by slips, or around a guess if there is
/// none.
fn search(by_slips: Option<&BySlips>, question: &CalibrationQuestion) -> Search {
    match by_slips {
        Some(BySlips {
            response,
            deviations: sd,
            ..
        }) => around(
            &response.motion,
            [sd[Quantity::Reach as usize], sd[Quantity::Jump as usize]],
        ),
        None => around_guess(&question.guess),
    }
}
