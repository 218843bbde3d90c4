//! Warnings about a step that is too long for the oscillator, the forcing or the noise.

use crate::advice::derived::Derived;
use crate::model::{Harmonic, Noise};
use crate::numbers::short;
use crate::scheme::Stability;
use std::f64::consts::PI;
use std::fmt;

/// The step is beyond its stability limit.
#[derive(Clone, Debug, PartialEq)]
pub struct StepUnstable {
    /// Step h.
    pub step: f64,
    /// The stability limit: the step must be shorter than this.
    pub limit: f64,
}

impl StepUnstable {
    pub(super) fn due(derived: &Derived, step: f64) -> Option<Self> {
        match derived.stability? {
            Stability::Undamped { .. } => None,
            Stability::Underdamped { largest_step: limit }
            | Stability::Overdamped { largest_step: limit }
            | Stability::NewVelocity { largest_step: limit } => (step >= limit).then_some(StepUnstable { step, limit }),
        }
    }
}

impl fmt::Display for StepUnstable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the step {} is beyond the stability limit {}: slips will grow until they overflow. \
             Choose time.step below the limit",
            short(self.step),
            short(self.limit)
        )
    }
}

/// Without damping, the expected amplitude is above the critical one.
#[derive(Clone, Debug, PartialEq)]
pub struct AmplitudeAboveCritical {
    /// Expected largest |x|.
    pub expected: f64,
    /// Critical amplitude A_c.
    pub critical: f64,
}

/// If the relative growth of the amplitude over the whole run is below this, it is not worth a
/// warning.
const GROWTH: f64 = 0.01;

impl AmplitudeAboveCritical {
    pub(super) fn due(derived: &Derived, step: f64, end: f64) -> Option<Self> {
        let Some(Stability::Undamped { critical_amplitude: critical }) = derived.stability else { return None };
        // Relative growth of the amplitude that the explicit step causes over the whole run.
        let growth = derived.natural_frequency.powi(2) * step * end / 2.0;
        let expected = derived.expected_amplitude;
        (expected > critical && growth > GROWTH).then_some(AmplitudeAboveCritical { expected, critical })
    }
}

impl fmt::Display for AmplitudeAboveCritical {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "without damping, the explicit step adds more energy than friction takes once the amplitude exceeds \
             A_c = 4 f_d/(pi w0 h K) = {}, and about {} is to be expected: paths may grow without bound. A_c \
             doubles when time.step is halved",
            short(self.critical),
            short(self.expected)
        )
    }
}

/// There are few steps per half-cycle of the oscillator.
#[derive(Clone, Debug, PartialEq)]
pub struct StepAgainstOscillator {
    /// Steps per half-cycle of the oscillator, pi / (w0 h).
    pub steps_per_half_cycle: f64,
}

/// With fewer steps per half-cycle of the oscillator, its discretisation is worth a warning.
const FEW_STEPS: f64 = 16.0;

impl StepAgainstOscillator {
    pub(super) fn due(derived: &Derived, h: f64) -> Option<Self> {
        let steps_per_half_cycle = PI / (derived.natural_frequency * h);
        (steps_per_half_cycle < FEW_STEPS).then_some(StepAgainstOscillator { steps_per_half_cycle })
    }
}

impl fmt::Display for StepAgainstOscillator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the step leaves only {} steps per half-cycle pi/w0 of the oscillator: slips are poorly resolved",
            short(self.steps_per_half_cycle)
        )
    }
}

/// There are few steps per period of a harmonic.
#[derive(Clone, Debug, PartialEq)]
pub struct StepAgainstForcing {
    /// Angular frequency w of the harmonic.
    pub angular_frequency: f64,
    /// Steps per period of the harmonic, 2 pi / (w h).
    pub steps_per_period: f64,
}

impl StepAgainstForcing {
    pub(super) fn due(harmonic: &Harmonic, h: f64) -> Option<Self> {
        let angular_frequency = harmonic.angular_frequency;
        let steps_per_period = 2.0 * PI / (angular_frequency * h);
        let is_due = steps_per_period < 2.0 * FEW_STEPS && harmonic.amplitude != 0.0;
        is_due.then_some(StepAgainstForcing { angular_frequency, steps_per_period })
    }
}

impl fmt::Display for StepAgainstForcing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the step leaves only {} steps per period of the harmonic with angular frequency {}: the forcing is \
             poorly resolved",
            short(self.steps_per_period),
            short(self.angular_frequency)
        )
    }
}

/// theta h > 1: the noise decorrelates within one step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepAgainstNoise {
    /// Relaxation times of the noise per step, theta h.
    pub relaxations_per_step: f64,
}

impl StepAgainstNoise {
    pub(super) fn due(noise: &Noise, h: f64) -> Option<Self> {
        let relaxations_per_step = noise.relaxation_rate * h;
        (relaxations_per_step > 1.0).then_some(StepAgainstNoise { relaxations_per_step })
    }
}

impl fmt::Display for StepAgainstNoise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "theta h = {}: the noise decorrelates within one step, and the scheme does not see what it does \
             in between",
            short(self.relaxations_per_step)
        )
    }
}
