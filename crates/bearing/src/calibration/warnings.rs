//! Which warnings a calibration gets.
//!
//! A warning is one row of the list below: its name, and the function that returns it if it
//! applies.

use super::by_slips::BySlips;
use super::course::CourseShape;
use super::lag::{CONVINCING, is_small};
use super::quantity::Quantity;
use super::question::Lag;
use super::report::{Calibration, ParameterEstimate, SCATTER};
use super::samples::{HOUR, interval};
use crate::warning::CalibrationWarning;
use stickslip_text::numbers::Digits;

/// A calibration, and the slips from which it was computed, if any were detected.
struct Case<'a> {
    calibration: &'a Calibration,
    by_slips: Option<&'a BySlips>,
}

/// Returns a warning in a sentence or two, if it applies.
type Says = fn(&Case) -> Option<String>;

/// All warnings, in the order in which they are given.
const ALL: &[(&str, Says)] = &[
    ("no_shear_stiffness", no_shear_stiffness),
    ("no_slips", no_slips),
    ("poor_fit", poor_fit),
    ("large_dilatation", large_dilatation),
    ("gap_not_identified", gap_not_identified),
    ("few_slips", few_slips),
    ("sparse_samples", sparse_samples),
    ("scatter", scatter),
    ("friction_changes", friction_changes),
    ("temperature_elsewhere", temperature_elsewhere),
    ("repeated_values", repeated_values),
    ("saturated", saturated),
    ("lag", lag),
    ("lag_beyond", lag_beyond),
    ("other_lag", other_lag),
    ("clocks", clocks),
    ("zero_set", zero_set),
    ("zero_drift", zero_drift),
    ("mirrored", mirrored),
];

/// The warnings of a calibration. `by_slips` is given if slips were detected.
pub(super) fn warnings(
    calibration: &Calibration,
    by_slips: Option<&BySlips>,
) -> Vec<CalibrationWarning> {
    let case = Case {
        calibration,
        by_slips,
    };
    ALL.iter()
        .filter_map(|(name, says)| {
            Some(CalibrationWarning {
                name,
                text: says(&case)?,
            })
        })
        .collect()
}

impl Case<'_> {
    fn estimate(&self, quantity: Quantity) -> ParameterEstimate {
        self.calibration.estimate(quantity)
    }

    /// The change of temperature from one sample to the next, in kelvin.
    fn moved(&self) -> f64 {
        let [times, _] = self.calibration.record.thermometer();
        (self.calibration.roughness * interval(&times)).sqrt()
    }
}

/// K_BP is not known.
fn no_shear_stiffness(case: &Case) -> Option<String> {
    let text = "bearing.stiffness is not given, so only beta, f_s/K and f_d/K are estimated; give \
                it to estimate K, f_s and f_d";
    case.calibration
        .question
        .shear_stiffness
        .is_none()
        .then(|| text.into())
}

/// No slips can be distinguished from noise.
fn no_slips(case: &Case) -> Option<String> {
    let text = "no slips are visible: the estimates are from least squares, started from the \
                scenario's values, and have no intervals; measure for longer";
    case.by_slips.is_none().then(|| text.into())
}

/// The residual relative to the jump of z in a slip above which the model is often a slip away from
/// the measurement. It was 0.4 to 0.7 in sound records, at most 1.02 with red noise as large as the
/// slips, and 1.3 to 1.6 for two bearings as one.
const A_SLIP_AWAY: f64 = 1.15;

/// The model does not follow the measurement.
fn poor_fit(case: &Case) -> Option<String> {
    let Calibration {
        residuals,
        response,
        ..
    } = case.calibration;
    let jump = (response.sensor.moving * response.motion.jump).abs();
    case.by_slips
        .filter(|_| residuals.rms > A_SLIP_AWAY * jump)?;
    Some(format!(
        "the model does not fit: it differs from the measurement by {:.2} mm (root mean square), \
         but a slip is only {:.2} mm; check whether the sensor measures several bearings or the \
         thermometer is elsewhere; do not use the intervals",
        1e3 * residuals.rms,
        1e3 * jump
    ))
}

/// The free movement of two kilometres of steel, in metres per kelvin. No bridge without a joint is
/// this long.
const LONGEST: f64 = 0.024;

/// No bridge expands this far.
fn large_dilatation(case: &Case) -> Option<String> {
    let beta = case.estimate(Quantity::Dilatation).estimate;
    (beta.abs() > LONGEST).then(|| {
        format!(
            "beta = {beta:.3} m/K corresponds to {:.0} km of steel; check the unit of the \
             displacements, and name the column e.g. displacement_mm",
            beta.abs() / 1.2e-5 / 1e3
        )
    })
}

/// f_s - f_d counts as not identified if its relative standard error exceeds this, whatever the
/// level of the intervals.
const IDENTIFIED: f64 = 0.25;

/// If slips explain less than this share of the motion, some were missed or the body also slides
/// without them.
const EXPLAINED: f64 = 0.9;

/// f_s - f_d is hardly distinguishable from zero, or slips do not explain all of the motion.
fn gap_not_identified(case: &Case) -> Option<String> {
    let jump = case.estimate(Quantity::Jump).estimate;
    let is_identified = case.calibration.standard_error(Quantity::Jump) < IDENTIFIED * jump;
    let explained = case.by_slips.map_or(1.0, |by_slips| {
        by_slips.slips.explained(&case.calibration.response)
    });
    let text = "f_s - f_d cannot be estimated well: slips are few, hardly larger than the noise, \
                or do not explain all of the motion; measure for longer, and check whether the \
                sensor measures several bearings";
    (!is_identified || explained < EXPLAINED).then(|| text.into())
}

/// With fewer slips, the coverage of intervals was below their level
/// (`tests/calibration/accuracy.rs`, `few_slips`).
const FEW: usize = 18;

/// There are too few slips for reliable intervals.
fn few_slips(case: &Case) -> Option<String> {
    let slips = case
        .by_slips
        .map(|_| case.calibration.slips.len())
        .filter(|slips| *slips < FEW)?;
    Some(format!(
        "only {slips} slips: intervals from so few may contain the truth less often than stated; measure for longer"
    ))
}

/// Limit of the change of temperature between two samples, relative to the jump G. Beyond it,
/// estimates were off by one per cent.
const SPARSE: f64 = 0.75;

/// The temperature changes too much between two samples.
fn sparse_samples(case: &Case) -> Option<String> {
    let jump = case
        .by_slips
        .map(|_| case.estimate(Quantity::Jump).estimate)?;
    let moved = case.moved();
    (moved > SPARSE * jump).then(|| {
        format!(
            "the temperature changes by {moved:.2} K from one sample to the next, but a slip \
             releases only {jump:.2} K: the interval of f_s is too narrow, and held in 14 of 20 \
             synthetic records; sample more often"
        )
    })
}

/// The sizes of slips differ more than noise explains.
fn scatter(case: &Case) -> Option<String> {
    let share = case
        .by_slips
        .map(|by_slips| by_slips.slips.excess_scatter())
        .filter(|scatter| *scatter > SCATTER)?;
    Some(format!(
        "slips differ in size by {:.0} % more than noise explains: f_s varies from slip to slip, \
         or the body slides without slips; the estimates are for the mean f_s, and the interval \
         of f_s - f_d is too narrow",
        100.0 * share
    ))
}

/// A changes over the record.
fn friction_changes(case: &Case) -> Option<String> {
    let range = case.calibration.friction_range?;
    let (quantity, factor, unit) = match case.calibration.question.shear_stiffness {
        Some(_) => (Quantity::Static, 1e-3, "kN"),
        None => (Quantity::StaticWay, 1e3, "mm"),
    };
    let [low, high] = range.map(|end| {
        let mean = factor * case.estimate(quantity).estimate;
        let [at, from, to] = [end.estimate, end.low, end.high].map(|share| mean * share);
        let digits = Digits::of(at, to - at);
        let [at, from, to] = [at, from, to].map(|value| digits.show(value));
        format!("{at} {unit} ({from} to {to} {unit})")
    });
    let course = case.by_slips.map(|by_slips| by_slips.course)?;
    let forecast = match course.shape {
        CourseShape::Trend(_) => "a forecast assumes that friction stays as it was at the end",
        _ => "a forecast varies friction with the season in the same way",
    };
    let of = match course.shape {
        CourseShape::Trend(_) => "over the record",
        _ => "over the year",
    };
    Some(format!(
        "{} varies {of}, from {low} to {high}, according to the temperatures and sizes of slips: the \
         estimates and intervals are for its mean {of}, and {forecast}",
        quantity.symbol()
    ))
}

/// The scatter of the temperatures of slips, as a multiple of that explained by sampling, above
/// which they are not those of the steel.
const ELSEWHERE: f64 = 1.8;

/// The same in standard deviations among synthetic records.
const UNUSUAL: f64 = 5.0;

/// The fewest reversals that show it.
const FEWEST: usize = 10;

/// The thermometer is slower than the steel, or the temperatures at which slips begin scatter too much.
fn temperature_elsewhere(case: &Case) -> Option<String> {
    let by_slips = case.by_slips?;
    if let Some(share) = by_slips.slow_share {
        let percent = 100.0 * (1.0 - share).max(0.0);
        return Some(format!(
            "the thermometer is slower than the steel: f_s and f_d are about {percent:.0} % too small, \
             beyond their intervals; put the thermometer on the steel"
        ));
    }
    let scatter = by_slips.statistics.scatter;
    if case.calibration.friction_range.is_some() {
        return None;
    }
    let expected = by_slips.replicates.mean_of(|shown| shown.scatter);
    let deviation = by_slips.replicates.deviation_of(|shown| shown.scatter);
    let least = (ELSEWHERE * expected).max(expected + UNUSUAL * deviation);
    (scatter > least && by_slips.slips.reversals.len() >= FEWEST).then(|| {
        format!(
            "the temperatures of slips scatter by {scatter:.2} K, but noise explains only \
             {expected:.2} K: the thermometer may be elsewhere, or slower than the steel; f_s and \
             f_d may be 5 to 25 % too small, beyond their intervals; put the thermometer on the \
             steel"
        )
    })
}

/// The thermometer repeats its values.
fn repeated_values(case: &Case) -> Option<String> {
    let minutes = case.calibration.repeats? / 60.0;
    Some(format!(
        "the thermometer repeats each value until it measures again, about every {minutes:.0} min; only \
         the first of equal values is used; store the temperature as often as the displacement"
    ))
}

/// A sensor at the end of its range stays there for at least this many samples.
const STAYS: usize = 12;

/// Readings stay at the largest or the smallest value.
fn saturated(case: &Case) -> Option<String> {
    let samples = case.calibration.record.samples();
    let end = |sign: f64| {
        let of = |reading: &f64| sign * reading;
        let end = samples
            .readings
            .iter()
            .map(of)
            .fold(f64::NEG_INFINITY, f64::max);
        let count = |from: f64, to: f64| {
            samples
                .readings
                .iter()
                .map(of)
                .filter(|z| (from..=to).contains(z))
                .count()
        };
        let at_end = count(end, end);
        // With a coarse resolution, a similar number of readings is one step further in.
        let next = samples
            .readings
            .iter()
            .map(of)
            .filter(|z| *z < end)
            .fold(f64::NEG_INFINITY, f64::max);
        (at_end >= STAYS && at_end > 4 * count(next, next)).then_some((at_end, sign * end))
    };
    let (count, reading) = [1.0, -1.0].into_iter().find_map(end)?;
    Some(format!(
        "{count} readings are {:.3} mm, and none is beyond: the sensor may be at the end of its \
         range, where slips are missed; remove these readings, and move the sensor",
        1e3 * reading
    ))
}

/// The steel may lag behind the thermometer by more than is considered.
fn lag_beyond(case: &Case) -> Option<String> {
    let profile = case
        .calibration
        .lag_profile
        .as_ref()
        .filter(|profile| profile.is_beyond())?;
    let longest = profile.profile.last()?.0 / HOUR;
    (case.calibration.question.lag == Lag::Auto).then(|| {
        format!(
            "a lag of {longest:.0} h or more fits best, which is too long for steel and is not \
             used; f_s, f_d and K may be far off; measure the temperature of the steel"
        )
    })
}

/// The steel lags behind the thermometer.
fn lag(case: &Case) -> Option<String> {
    let lag = case.calibration.lag.estimate;
    (case.calibration.question.lag == Lag::Auto && lag > 0.0).then(|| {
        format!(
            "the steel lags {:.1} minutes behind the thermometer; this is included in the estimates; give the lag if it is known",
            lag / 60.0
        )
    })
}

/// A lag was given, but the data indicate another.
fn other_lag(case: &Case) -> Option<String> {
    let Lag::Known(given) = case.calibration.question.lag else {
        return None;
    };
    let profile = case
        .calibration
        .lag_profile
        .as_ref()
        .filter(|profile| profile.against(given) > CONVINCING)?;
    let [likeliest, given] = [profile.likeliest, given].map(|seconds| seconds / 60.0);
    Some(format!(
        "a lag of {likeliest:.1} minutes fits better than {given:.1} minutes; leave it out to estimate it"
    ))
}

/// The clocks of thermometer and sensor seem to differ.
fn clocks(case: &Case) -> Option<String> {
    let seconds = case.calibration.lag_profile.as_ref()?.clock?;
    let (side, clock) = match seconds > 0.0 {
        true => ("earlier", "ahead of"),
        false => ("later", "behind"),
    };
    let minutes = seconds.abs() / 60.0;
    let by = if minutes < 60.0 {
        format!("{minutes:.0} min")
    } else {
        format!("{:.0} h", minutes / 60.0)
    };
    let taken = match is_small(seconds) {
        true => "this is corrected to five minutes; set the clock that is wrong",
        false => {
            "check whether one of the clocks uses summer time or another time zone, and correct it; until then, do not use the intervals"
        }
    };
    Some(format!(
        "the temperature {by} {side} explains the displacement far better than the simultaneous one, with or without a lag, \
         as if the clock of the displacement were {by} {clock} that of the temperature: {taken}"
    ))
}

/// The zero of the sensor was set.
fn zero_set(case: &Case) -> Option<String> {
    let of = |(when, size): &(f64, f64)| {
        format!("{:+.2} mm after {:.2} d", 1e3 * size, when / (24.0 * HOUR))
    };
    let steps: Vec<String> = case.calibration.zero.steps.iter().map(of).collect();
    (!steps.is_empty()).then(|| {
        format!(
            "the sensor reading jumps without a slip: {}; this is fitted and removed; check whether its zero was reset",
            steps.join(", ")
        )
    })
}

/// The zero of the sensor drifts.
fn zero_drift(case: &Case) -> Option<String> {
    let drift = case.calibration.zero.drift_per_year();
    (drift != 0.0).then(|| {
        format!(
            "the sensor drifts by {:+.2} mm a year; this is fitted and removed, from the first sample on; check the sensor",
            1e3 * drift
        )
    })
}

/// The displacement falls as the temperature rises, so its sign was changed.
fn mirrored(case: &Case) -> Option<String> {
    let text = "the displacement falls as the temperature rises, so its sign was changed; z0 is given with the changed sign";
    case.calibration.is_mirrored.then(|| text.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::{
        Air, CalibrationMethod, CalibrationQuestion, Imperfections, MeasuredRecord, Motion,
        ParameterEstimate, Response, Sensor, calibrate, twin,
    };

    /// f_s - f_d with a standard error of 20 % of it is identified, and with one of 30 % it is not,
    /// whether the intervals have 50 %, 90 % or 99.9 %.
    #[test]
    fn identification_of_the_gap_is_independent_of_the_level() {
        let motion = Motion {
            reach: 4.0,
            jump: 1.0,
            start: 15.0,
        };
        let response = Response {
            motion,
            sensor: Sensor {
                offset: 0.0,
                moving: 9e-4,
                still: 1e-4,
            },
        };
        let times: Vec<f64> = (0..3000).map(|i| 600.0 * f64::from(i)).collect();
        let temperatures: Vec<f64> = times
            .iter()
            .map(|t| 15.0 + 12.0 * libm::sin(4e-5 * t))
            .collect();
        let imperfections = Imperfections {
            white: 1e-5,
            ..Imperfections::NONE
        };
        let twin = twin(
            &response,
            &Air::straight(times, temperatures),
            &imperfections,
            1,
        );
        let record = MeasuredRecord {
            times: twin.times,
            temperatures: twin.temperatures,
            readings: twin.readings,
            ..MeasuredRecord::default()
        };
        let question = CalibrationQuestion {
            method: CalibrationMethod::Slips,
            shear_stiffness: Some(2e9),
            starts: 1,
            lag: Lag::Known(0.0),
            level: 0.9,
            held: Vec::new(),
            bounds: Vec::new(),
            guess: motion,
        };
        let mut calibration = calibrate(&record, &question, 1, &Default::default()).expect("slips");
        for (level, quantile) in [(0.5, 0.674_49), (0.9, 1.644_85), (0.999, 3.290_53)] {
            calibration.question.level = level;
            let mut is_identified = |error: f64| {
                let [low, high] = [1.0 - quantile * error, 1.0 + quantile * error];
                calibration.estimates[Quantity::Jump as usize] = ParameterEstimate {
                    estimate: 1.0,
                    low,
                    high,
                };
                warnings(&calibration, None)
                    .iter()
                    .all(|warning| warning.name() != "gap_not_identified")
            };
            assert_eq!([0.2, 0.3].map(&mut is_identified), [true, false], "{level}");
        }
    }
}
