//! Which warnings a calibration gets.

use super::lag::CONVINCING;
use super::quantity::Quantity;
use super::question::{Lag, Method};
use super::report::Calibration;
use super::slips::Evidence;
use super::spikes::Spikes;
use super::warning::Warning;

/// Relative difference of err above which the starts are said to disagree.
const AGREE: f64 = 1e-3;

/// f_s - f_d counts as not identified if its standard error is more than this share of it,
/// whatever the level of the intervals.
const IDENTIFIED: f64 = 0.25;

/// If slips explain less than this share of the motion, some were not seen or the body also slides
/// without them.
const EXPLAINED: f64 = 0.9;

/// Excess scatter of the sizes of slips above which friction seems to vary.
const SCATTER: f64 = 0.2;

/// The warnings of a calibration. `evidence` is given if slips were seen.
pub(super) fn warnings(calibration: &Calibration, evidence: Option<&Evidence>) -> Vec<Warning> {
    let mut found = Vec::new();
    let estimate = |quantity| calibration.estimate(quantity);
    if calibration.question.shear_stiffness.is_none() {
        found.push(Warning::NoShearStiffness);
    }
    if evidence.is_none() {
        found.push(Warning::NoSlips);
    }
    let is_identified = calibration.standard_error(Quantity::Jump) < IDENTIFIED * estimate(Quantity::Jump).estimate;
    let explained = evidence.map_or(1.0, |evidence| evidence.explained(&calibration.response));
    if !is_identified || explained < EXPLAINED {
        found.push(Warning::GapNotIdentified);
    }
    if let Some(scatter) = evidence.map(Evidence::excess_scatter).filter(|scatter| *scatter > SCATTER) {
        found.push(Warning::Scatter(scatter));
    }
    let profile = calibration.lag_profile.as_ref();
    match calibration.question.lag {
        Lag::Auto if calibration.lag.estimate > 0.0 => found.push(Warning::Lag(calibration.lag.estimate)),
        Lag::Known(given) => {
            let believed = profile.filter(|profile| profile.against(given) > CONVINCING);
            found.extend(believed.map(|profile| Warning::OtherLag(given, profile.likeliest)));
        }
        Lag::Auto => {}
    }
    let best = calibration.starts.iter().min_by(|a, b| a.err.total_cmp(&b.err));
    if let (Some(others), Method::Both, Some(_)) = (&calibration.least_squares, calibration.question.method, evidence) {
        let is_apart = |quantity: &Quantity| {
            let [a, b] = [estimate(*quantity), others[*quantity as usize]];
            a.high < b.low || b.high < a.low
        };
        let apart: Vec<Quantity> = Quantity::ALL[..Quantity::PARAMETERS].iter().copied().filter(is_apart).collect();
        if !apart.is_empty() {
            found.push(Warning::MethodsApart(apart));
        }
    }
    if let Some(best) = best {
        let worst = calibration.starts.iter().map(|start| start.err).fold(0.0, f64::max);
        if worst / best.err - 1.0 > AGREE {
            found.push(Warning::StartsDisagree(worst / best.err - 1.0));
        }
    }
    if calibration.spikes != Spikes::default() {
        found.push(Warning::Spikes(calibration.spikes));
    }
    if calibration.is_mirrored {
        found.push(Warning::Mirrored);
    }
    let kappa = estimate(Quantity::Shear).estimate;
    if !(-0.02..1.0).contains(&kappa) {
        found.push(Warning::Unphysical(Quantity::Shear));
    }
    if estimate(Quantity::DynamicWay).estimate < 0.0 {
        found.push(Warning::Unphysical(Quantity::DynamicWay));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bearing::calibration::{Estimate, Flaws, Motion, Question, Record, Response, Sensor, calibrate, twin};

    /// f_s - f_d with a standard error of 20 % of it is identified, and with one of 30 % it is not,
    /// whether the intervals have 50 %, 90 % or 99.9 %.
    #[test]
    fn the_gap_is_identified_at_every_level_of_the_intervals_or_at_none() {
        let motion = Motion { reach: 4.0, jump: 1.0, start: 15.0 };
        let response = Response { motion, sensor: Sensor { offset: 0.0, moving: 9e-4, still: 1e-4 } };
        let times: Vec<f64> = (0..3000).map(|i| 600.0 * f64::from(i)).collect();
        let temperatures: Vec<f64> = times.iter().map(|t| 15.0 + 12.0 * libm::sin(4e-5 * t)).collect();
        let twin = twin(&response, &times, &temperatures, &Flaws { white: 1e-5, ..Flaws::NONE }, 1);
        let record = Record { times, temperatures, readings: twin.readings };
        let question = Question {
            method: Method::Slips,
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
                calibration.estimates[Quantity::Jump as usize] = Estimate { estimate: 1.0, low, high };
                !warnings(&calibration, None).contains(&Warning::GapNotIdentified)
            };
            assert_eq!([0.2, 0.3].map(&mut is_identified), [true, false], "{level}");
        }
    }
}
