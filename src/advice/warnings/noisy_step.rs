//! A step under noise.

use crate::advice::derived::Derived;
use crate::model::{Friction, Problem};
use crate::scheme::monitoring_shift;

/// A mean overshoot above this share of f_s makes a stick exit meaningless.
const LARGE_OVERSHOOT: f64 = 1.0 / 3.0;

/// A step under noise, with the numbers that determine its effect on sticks.
pub(super) struct NoisyStep {
    pub h: f64,
    pub friction: Friction,
    /// 0.5826 K beta rho sigma sqrt(h): the mean overshoot of the force over f_s when a step
    /// detects it.
    pub shift: f64,
    /// Time in which the noise crosses the stick band of a stick, (f_s / (K beta rho sigma))^2.
    pub crossing_time: f64,
    /// Time in which a slip may reverse, ((f_s - f_d) / (K beta rho sigma))^2.
    pub return_time: f64,
}

impl NoisyStep {
    /// None without noise, and none without friction, where there are no sticks.
    pub fn of(model: &Problem, derived: &Derived, h: f64) -> Option<Self> {
        let crossing_time = derived.stick_band_time.filter(|time| *time > 0.0)?;
        let friction_ratio = derived.friction_ratio?;
        Some(NoisyStep {
            h,
            friction: model.friction,
            shift: monitoring_shift(model, h),
            crossing_time,
            return_time: crossing_time * (1.0 - friction_ratio).powi(2),
        })
    }

    /// The gap f_s - f_d between the two thresholds.
    pub fn gap(&self) -> f64 {
        self.friction.static_force - self.friction.dynamic_force
    }

    /// f_s = f_d under noise: the numbers and durations of sticks depend on the step, not only on
    /// the model.
    pub fn has_equal_friction(&self) -> bool {
        self.gap() == 0.0
    }

    /// The noise crosses a large part of the stick band within one step.
    pub fn crosses_stick_band(&self) -> bool {
        self.shift > LARGE_OVERSHOOT * self.friction.static_force
    }

    /// The corrected scheme lowers f_s no further than to f_d, but its shift is larger than that.
    pub fn exceeds_gap(&self) -> bool {
        self.shift > self.gap()
    }
}
