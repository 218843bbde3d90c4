//! Warnings about a step that is too long for the oscillator, the forcing or the noise.

use super::case::Case;
use super::force;
use super::steepness::Stiffened;
use crate::model::Problem;
use crate::scheme::{Discretisation, Stability};
use std::f64::consts::PI;
use stickslip_text::numbers::short;

/// The step is beyond its stability limit, by itself or where a user-defined force is
/// steepest.
pub(super) fn unstable(case: &Case) -> Option<String> {
    let h = case.step?;
    let by_itself = case.derived.stability.and_then(Stability::largest_step);
    if let Some(limit) = by_itself.filter(|limit| h >= *limit) {
        return Some(format!(
            "the step {} exceeds the stability limit {}: slips grow until they overflow. Choose time.step \
             below the limit",
            short(h),
            short(limit)
        ));
    }
    let stiffened = case.stiffened.as_ref()?;
    let limit = stiffened.largest_step();
    if h >= limit {
        return Some(format!(
            "{}, so the step {} exceeds the stability limit {} there: the scheme cannot follow the force, and \
             the velocity may oscillate or grow until it overflows. Choose time.step well below the limit, \
             or `scheme.kind = \"event-driven\"`",
            stiffened.reason(),
            short(h),
            short(limit)
        ));
    }
    adds_energy(case, stiffened).then(|| {
        format!(
            "{}, where the explicit step {} adds {} % to the body's energy in every half-cycle: means may be far off, \
             and paths may grow without bound. A step below {} adds less than {} %; `scheme.kind = \"corrected-vi\"` adds \
             none, and `scheme.kind = \"event-driven\"` has no step",
            stiffened.stiffest_place(),
            short(h),
            short(100.0 * libm::expm1(PI * stiffened.stiffest.natural_frequency() * h)),
            short(libm::log1p(MUCH) / (PI * stiffened.stiffest.natural_frequency())),
            short(100.0 * MUCH)
        )
    })
}

/// If a step adds more than this fraction of the energy in a half-cycle, means are off by a few per
/// cent or more: 33 % for a fraction of 15 %, at a stop with the stiffness K = 20 and h = 0.01.
const MUCH: f64 = 0.125;

/// Whether the plain explicit step adds much energy where a user-defined force is stiffest, a
/// fraction e^{pi w0 h} - 1 in a half-cycle, and damping removes less than the step adds.
fn adds_energy(case: &Case, stiffened: &Stiffened) -> bool {
    let (Discretisation::Step { h }, body) =
        (case.scenario.scheme.discretisation(), &stiffened.body)
    else {
        return false;
    };
    let added = libm::expm1(PI * stiffened.stiffest.natural_frequency() * h);
    added > MUCH && 0.5 * body.stiffness * h > body.damping
}

/// The relative growth of the amplitude over the whole run below which not to warn.
const GROWTH: f64 = 0.01;

/// Without damping, the expected amplitude is above the critical one, A_c.
pub(super) fn amplitude_above_critical(case: &Case) -> Option<String> {
    let (h, derived) = (case.step?, &case.derived);
    let Some(Stability::Undamped { critical_amplitude }) = derived.stability else {
        return None;
    };
    // Relative growth of the amplitude that the explicit step causes over the whole run.
    let growth = derived.natural_frequency.powi(2) * h * case.scenario.time.end / 2.0;
    // The amplitude under a user-defined force is unknown.
    let is_known = case.scenario.model.force.is_none();
    (is_known && derived.expected_amplitude > critical_amplitude && growth > GROWTH).then(|| {
        format!(
            "without damping, the explicit step adds more energy than friction dissipates once the amplitude \
             exceeds A_c = 4 f_d/(pi w0 h K) = {}, and about {} is expected: paths may grow without bound. \
             A_c doubles when time.step is halved",
            short(critical_amplitude),
            short(derived.expected_amplitude)
        )
    })
}

/// With negative damping, the expected amplitude is above the one beyond which the body runs away,
/// or a user-defined force drives it outward or adds energy at any distance.
pub(super) fn runs_away(case: &Case) -> Option<String> {
    let (derived, model) = (&case.derived, &case.scenario.model);
    let lost = if case.step.is_some() {
        "counted as diverged"
    } else {
        "given up"
    };
    let lost = format!("and are {lost} once they overflow");
    if model.force.is_some() {
        return force::beyond_hold_of(case).map(|driven| {
            format!("{driven}, and at all larger distances: paths may grow without bound, {lost}")
        });
    }
    let growing = match derived.stability {
        Some(Stability::Growing { critical_amplitude }) => Some(critical_amplitude),
        _ => model.runaway_amplitude(0.0),
    };
    let critical = growing.filter(|_| model.oscillator.damping < 0.0)?;
    (derived.expected_amplitude > critical).then(|| {
        format!(
            "negative damping adds more energy than friction dissipates once the amplitude exceeds {}, and \
             about {} is expected before that: paths beyond it grow without bound, {lost}",
            short(critical),
            short(derived.expected_amplitude)
        )
    })
}

/// The number of steps per half-cycle of the oscillator below which to warn.
const FEW_STEPS: f64 = 16.0;

pub(super) fn against_oscillator(case: &Case) -> Option<String> {
    let h = case.step?;
    let steps_of = |w0: f64| PI / (w0 * h);
    let steps = steps_of(case.derived.natural_frequency);
    if steps < FEW_STEPS {
        return Some(format!(
            "the step gives only {} steps per half-cycle pi/w0 of the oscillator: slips are poorly resolved",
            short(steps)
        ));
    }
    let stiffened = case.stiffened.as_ref()?;
    let steps = steps_of(stiffened.stiffest.natural_frequency());
    (steps < FEW_STEPS && h < stiffened.largest_step() && !adds_energy(case, stiffened)).then(|| {
        format!(
            "{}, so the step gives only {} steps per half-cycle there: slips are poorly resolved",
            stiffened.stiffest_place(),
            short(steps)
        )
    })
}

/// One warning for each harmonic, and for a user-defined force, with few steps in its period.
pub(super) fn against_forcing(case: &Case) -> Vec<String> {
    let Some(h) = case.step else {
        return Vec::new();
    };
    let Problem {
        temperature, force, ..
    } = &case.scenario.model;
    let harmonics = temperature
        .harmonics
        .iter()
        .filter(|harmonic| harmonic.amplitude != 0.0);
    let harmonics = harmonics.map(|harmonic| ("harmonic", harmonic.angular_frequency));
    let own = force
        .iter()
        .map(|force| ("force or load", force.fastest_rate(case.scenario.time.end)));
    let steps = harmonics
        .chain(own)
        .map(|(what, w)| (what, w, 2.0 * PI / (w * h)));
    let few = steps.filter(|(_, _, steps)| *steps < 2.0 * FEW_STEPS);
    few.map(|(what, frequency, steps)| {
        format!(
            "the step gives only {} steps per period of the {what} with angular frequency {}: the forcing is \
             poorly resolved",
            short(steps),
            short(frequency)
        )
    })
    .collect()
}

/// theta h > 1: the noise decorrelates within one step.
pub(super) fn against_noise(case: &Case) -> Option<String> {
    let (h, noise) = (
        case.step?,
        case.scenario.model.temperature.effective_noise()?,
    );
    let relaxations = noise.relaxation_rate * h;
    (relaxations > 1.0).then(|| {
        format!(
            "theta h = {}: the noise decorrelates within one step, so the scheme misses its fluctuations \
             between steps",
            short(relaxations)
        )
    })
}
