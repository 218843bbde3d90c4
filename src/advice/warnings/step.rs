//! Warnings about a step that is too long for the oscillator, the forcing or the noise.

use super::case::{Case, when};
use crate::numbers::short;
use crate::scheme::Stability;
use std::f64::consts::PI;

/// The step is beyond its stability limit.
pub(super) fn unstable(case: &Case) -> Vec<String> {
    let (Some(h), Some(stability)) = (case.step, case.derived.stability) else { return Vec::new() };
    match stability {
        Stability::Undamped { .. } | Stability::Growing { .. } => Vec::new(),
        Stability::Underdamped { largest_step: limit }
        | Stability::Overdamped { largest_step: limit }
        | Stability::NewVelocity { largest_step: limit } => when(h >= limit, || {
            format!(
                "the step {} is beyond the stability limit {}: slips will grow until they overflow. \
                 Choose time.step below the limit",
                short(h),
                short(limit)
            )
        }),
    }
}

/// If the relative growth of the amplitude over the whole run is below this, it is not worth a
/// warning.
const GROWTH: f64 = 0.01;

/// Without damping, the expected amplitude is above the critical one, A_c.
pub(super) fn amplitude_above_critical(case: &Case) -> Vec<String> {
    let (Some(h), derived) = (case.step, &case.derived) else { return Vec::new() };
    let Some(Stability::Undamped { critical_amplitude }) = derived.stability else { return Vec::new() };
    // Relative growth of the amplitude that the explicit step causes over the whole run.
    let growth = derived.natural_frequency.powi(2) * h * case.scenario.time.end / 2.0;
    // How far a force of the user's own moves the body is not known.
    let is_known = case.scenario.model.force.is_none();
    when(is_known && derived.expected_amplitude > critical_amplitude && growth > GROWTH, || {
        format!(
            "without damping, the explicit step adds more energy than friction takes once the amplitude exceeds \
             A_c = 4 f_d/(pi w0 h K) = {}, and about {} is to be expected: paths may grow without bound. A_c \
             doubles when time.step is halved",
            short(critical_amplitude),
            short(derived.expected_amplitude)
        )
    })
}

/// With negative damping, the expected amplitude is above the one beyond which the body runs away.
pub(super) fn runs_away(case: &Case) -> Vec<String> {
    let (derived, model) = (&case.derived, &case.scenario.model);
    let growing = match derived.stability {
        Some(Stability::Growing { critical_amplitude }) => Some(critical_amplitude),
        _ => model.runaway_amplitude(0.0),
    };
    let Some(critical) = growing.filter(|_| model.oscillator.damping < 0.0) else { return Vec::new() };
    when(model.force.is_none() && derived.expected_amplitude > critical, || {
        format!(
            "negative damping adds more energy than friction takes once the amplitude exceeds {}, and about {} is to \
             be expected: paths beyond it grow without bound, and are counted as diverged once their numbers do not \
             fit a double",
            short(critical),
            short(derived.expected_amplitude)
        )
    })
}

/// With fewer steps per half-cycle of the oscillator, its discretisation is worth a warning.
const FEW_STEPS: f64 = 16.0;

pub(super) fn against_oscillator(case: &Case) -> Vec<String> {
    let Some(h) = case.step else { return Vec::new() };
    let steps = PI / (case.derived.natural_frequency * h);
    when(steps < FEW_STEPS, || {
        format!(
            "the step leaves only {} steps per half-cycle pi/w0 of the oscillator: slips are poorly resolved",
            short(steps)
        )
    })
}

/// One warning for each harmonic with few steps in its period.
pub(super) fn against_forcing(case: &Case) -> Vec<String> {
    let Some(h) = case.step else { return Vec::new() };
    let harmonics = case.scenario.model.temperature.harmonics.iter().filter(|harmonic| harmonic.amplitude != 0.0);
    let steps = harmonics.map(|harmonic| (harmonic.angular_frequency, 2.0 * PI / (harmonic.angular_frequency * h)));
    let few = steps.filter(|(_, steps)| *steps < 2.0 * FEW_STEPS);
    few.map(|(frequency, steps)| {
        format!(
            "the step leaves only {} steps per period of the harmonic with angular frequency {}: the forcing is \
             poorly resolved",
            short(steps),
            short(frequency)
        )
    })
    .collect()
}

/// theta h > 1: the noise decorrelates within one step.
pub(super) fn against_noise(case: &Case) -> Vec<String> {
    let (Some(h), Some(noise)) = (case.step, case.scenario.model.temperature.effective_noise()) else {
        return Vec::new();
    };
    let relaxations = noise.relaxation_rate * h;
    when(relaxations > 1.0, || {
        format!(
            "theta h = {}: the noise decorrelates within one step, and the scheme does not see what it does \
             in between",
            short(relaxations)
        )
    })
}
