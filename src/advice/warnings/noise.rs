//! Warnings about stick exits under noise, which a scheme checks only once a step, or corrects for
//! this, or resolves only down to a limit.

use crate::advice::derived::Derived;
use crate::model::{Friction, Model};
use crate::numbers::short;
use crate::scheme::{Resolution, monitoring_shift};
use std::fmt;

/// A step under noise, with the numbers that decide what it does to sticks.
pub(super) struct NoisyStep {
    h: f64,
    friction: Friction,
    /// Friction ratio f_d/f_s.
    friction_ratio: f64,
    /// 0.5826 K beta rho sigma sqrt(h): how far the force has passed f_s on average when a step
    /// detects it.
    shift: f64,
    /// Time in which the noise crosses the corridor of a stick, (f_s / (K beta rho sigma))^2.
    crossing_time: f64,
    /// Time in which a slip may turn back, ((f_s - f_d) / (K beta rho sigma))^2.
    return_time: f64,
}

impl NoisyStep {
    /// None without noise, and none without friction, where there are no sticks.
    pub(super) fn of(model: &Model, derived: &Derived, h: f64) -> Option<Self> {
        let crossing_time = derived.corridor_time.filter(|time| *time > 0.0)?;
        let friction_ratio = derived.friction_ratio?;
        Some(NoisyStep {
            h,
            friction: model.friction,
            friction_ratio,
            shift: monitoring_shift(model, h),
            crossing_time,
            return_time: crossing_time * (1.0 - friction_ratio).powi(2),
        })
    }

    /// The gap f_s - f_d between the two thresholds.
    fn gap(&self) -> f64 {
        self.friction.static_force - self.friction.dynamic_force
    }
}

/// The noise crosses a large part of the corridor of a stick within one step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepAgainstCorridor {
    /// Step h.
    pub step: f64,
    /// Time in which the noise crosses the corridor of a stick, (f_s / (K beta rho sigma))^2.
    pub crossing_time: f64,
}

/// A mean overshoot above this share of f_s makes a stick exit meaningless.
const LARGE_OVERSHOOT: f64 = 1.0 / 3.0;

impl StepAgainstCorridor {
    pub(super) fn due(step: &NoisyStep) -> Option<Self> {
        let overshoots = step.shift > LARGE_OVERSHOOT * step.friction.static_force;
        overshoots.then_some(StepAgainstCorridor { step: step.h, crossing_time: step.crossing_time })
    }
}

impl fmt::Display for StepAgainstCorridor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the step {} is large against the time {} that the noise takes to cross the corridor of a stick, \
             (f_s/(K beta rho sigma))^2: stick counts and durations will be far off",
            short(self.step),
            short(self.crossing_time)
        )
    }
}

/// f_s = f_d under noise: the numbers and durations of sticks are properties of the step, not of
/// the model.
#[derive(Clone, Debug, PartialEq)]
pub struct EqualFriction;

impl EqualFriction {
    pub(super) fn due(step: &NoisyStep) -> Option<Self> {
        (step.friction_ratio == 1.0).then_some(EqualFriction)
    }
}

impl fmt::Display for EqualFriction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "f_s = f_d under noise: there are slips of all sizes down to zero, so the number of sticks grows \
             without bound as the step falls. Stick counts and durations here are properties of the step, \
             whatever their error bars; sticking fraction and positions do have limits",
        )
    }
}

/// The scheme checks only once a step whether a stick has ended, which makes an error of order
/// sqrt(h).
#[derive(Clone, Debug, PartialEq)]
pub struct StickExitBias {
    /// Rough relative error of the mean stick duration.
    pub relative: f64,
}

/// Relative error of the mean stick duration, divided by sqrt(h / crossing time). It was measured
/// between h = 0.001 and 0.02 in the scene with rho = 0.25 and forcing 1/4 (1.7 to 1.9). For other
/// scenes it is only a guide.
const STICK_BIAS: f64 = 1.8;
/// A smaller relative bias than this is not worth a warning.
const SMALL_BIAS: f64 = 0.01;

impl StickExitBias {
    /// This warning is not due where stick durations mean nothing at this step.
    pub(super) fn due(step: &NoisyStep) -> Option<Self> {
        let means_something = EqualFriction::due(step).is_none() && StepAgainstCorridor::due(step).is_none();
        let relative = STICK_BIAS * (step.h / step.crossing_time).sqrt();
        (means_something && relative > SMALL_BIAS).then_some(StickExitBias { relative })
    }
}

impl fmt::Display for StickExitBias {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the scheme checks only once a step whether a stick has ended, so sticks come out too long: \
             roughly {} % in the \
             mean, as a guide. The error falls like sqrt(h), and no confidence interval shows it. \
             `--scheme corrected-vi` has a smaller one, of order h, and `--scheme event-driven` has none",
            short((self.relative * 100.0).round().max(1.0))
        )
    }
}

/// The step is longer than the time in which a slip that has just begun may turn back.
#[derive(Clone, Debug, PartialEq)]
pub struct MicroSlips {
    /// Step h.
    pub step: f64,
    /// Time in which a slip may turn back, ((f_s - f_d) / (K beta rho sigma))^2.
    pub return_time: f64,
}

impl MicroSlips {
    /// Where f_s = f_d, every step is longer than the return time, and another warning says so.
    pub(super) fn due(step: &NoisyStep) -> Option<Self> {
        let is_due = EqualFriction::due(step).is_none() && step.h > step.return_time;
        is_due.then_some(MicroSlips { step: step.h, return_time: step.return_time })
    }
}

impl fmt::Display for MicroSlips {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "slips shorter than the step are missed: under this noise one can turn back within \
             ((f_s - f_d)/(K beta rho sigma))^2 = {}, and the step is {}",
            short(self.return_time),
            short(self.step)
        )
    }
}

/// The correction of the stick exit is not small relative to f_s.
#[derive(Clone, Debug, PartialEq)]
pub struct LargeShift {
    /// Shift of the threshold, 0.5826 K beta rho sigma sqrt(h).
    pub shift: f64,
    /// Static friction f_s.
    pub static_force: f64,
}

/// With a shift above this share of f_s, errors of second order of the corrected scheme become
/// visible.
const LARGE_SHIFT: f64 = 0.2;

impl LargeShift {
    pub(super) fn due(step: &NoisyStep) -> Option<Self> {
        let (shift, static_force) = (step.shift, step.friction.static_force);
        (shift > LARGE_SHIFT * static_force).then_some(LargeShift { shift, static_force })
    }
}

impl fmt::Display for LargeShift {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the corrected stick exit lowers f_s = {} by {}: the correction is good while that is small, and here \
             stick durations may be off by several percent. It falls like sqrt(h); `--scheme event-driven` needs \
             none",
            short(self.static_force),
            short(self.shift)
        )
    }
}

/// The corrected scheme lowers f_s no further than to f_d, but its shift is larger than that.
#[derive(Clone, Debug, PartialEq)]
pub struct IncompleteCorrection {
    /// Shift of the threshold, 0.5826 K beta rho sigma sqrt(h).
    pub shift: f64,
    /// Gap f_s - f_d between the two thresholds.
    pub gap: f64,
    /// The step at which the shift equals the gap.
    pub largest_step: f64,
}

impl IncompleteCorrection {
    pub(super) fn due(step: &NoisyStep) -> Option<Self> {
        let (shift, gap) = (step.shift, step.gap());
        let largest_step = step.h * (gap / shift).powi(2);
        (shift > gap).then_some(IncompleteCorrection { shift, gap, largest_step })
    }
}

impl fmt::Display for IncompleteCorrection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let remedy = if self.gap > 0.0 {
            format!("Choose time.step below {}, or `--scheme event-driven`", short(self.largest_step))
        } else {
            "No step is short enough; `--scheme event-driven` needs no correction".to_string()
        };
        write!(
            f,
            "the corrected stick exit would lower f_s by {}, but no further than to f_d, and f_s - f_d is \
             only {}: a body released below f_d would be pushed back. The rest is not corrected, so sticks \
             come out too long. {remedy}",
            short(self.shift),
            short(self.gap)
        )
    }
}

/// The error of the corrected scheme itself, which is of order h.
#[derive(Clone, Debug, PartialEq)]
pub struct CorrectedBias {
    /// Rough relative error of the mean stick duration.
    pub relative: f64,
}

/// Relative error of the mean stick duration of the corrected scheme, divided by h / return time,
/// and the value of h / return time above which it no longer grows. They were measured between h =
/// 0.000625 and 0.02 in the same scene (0.15 to 0.18 below 0.3; 8 % at 0.01 and at 0.02).
const CORRECTED_BIAS: f64 = 0.17;
const CORRECTED_BIAS_GROWS_TO: f64 = 0.5;

impl CorrectedBias {
    /// This warning is not due where stick durations mean nothing, or where the error that remains
    /// because the correction is incomplete is larger.
    pub(super) fn due(step: &NoisyStep) -> Option<Self> {
        let is_corrected = EqualFriction::due(step).is_none() && IncompleteCorrection::due(step).is_none();
        let relative = CORRECTED_BIAS * (step.h / step.return_time).min(CORRECTED_BIAS_GROWS_TO);
        (is_corrected && relative > SMALL_BIAS).then_some(CorrectedBias { relative })
    }
}

impl fmt::Display for CorrectedBias {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the corrected step leaves sticks too short: roughly {} % in the mean, as a guide. The error falls like h, \
             and no confidence interval shows it. `--scheme event-driven` has none",
            short((self.relative * 100.0).round().max(1.0))
        )
    }
}

/// f_s = f_d, or nearly so, under noise: the numbers and durations of sticks are properties of the
/// resolution of a scheme without a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Unresolved {
    /// The resolution of the scheme.
    pub resolution: Resolution,
}

impl Unresolved {
    pub(super) fn due(derived: &Derived) -> Option<Self> {
        derived.resolution.map(|resolution| Unresolved { resolution })
    }
}

impl fmt::Display for Unresolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Resolution { static_force, shortest_slip } = self.resolution;
        write!(
            f,
            "f_s and f_d meet, or nearly, under noise: there are slips of all sizes down to zero. Slips shorter \
             than about {} are not resolved; what is simulated is f_s = {static_force:?}. Stick counts and durations \
             here are properties of that resolution, which follows scheme.tolerance, whatever their error bars; \
             sticking fraction and positions do have limits",
            short(shortest_slip)
        )
    }
}
