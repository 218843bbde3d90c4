//! Warnings about the question itself, whatever scheme answers it.

use crate::advice::amplitude::NEVER_SD;
use crate::advice::derived::Derived;
use crate::model::{Model, Temperature};
use crate::numbers::short;
use crate::scenario::MAX_PERIODS;
use crate::scheme::Timeline;
use std::fmt;

/// The force |b| cannot reach the static friction f_s.
#[derive(Clone, Debug, PartialEq)]
pub struct NeverSlips {
    /// An upper bound of |b|.
    pub largest_force: f64,
}

impl NeverSlips {
    pub(super) fn due(model: &Model) -> Option<Self> {
        let largest_force = model.force_bound(NEVER_SD);
        (largest_force <= model.friction.static_force).then_some(NeverSlips { largest_force })
    }
}

impl fmt::Display for NeverSlips {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let largest = short(self.largest_force);
        write!(f, "nothing will slip: |b| does not exceed {largest}, and f_s is no less. Every stick is censored")
    }
}

/// Nothing is random: all paths are the same.
#[derive(Clone, Debug, PartialEq)]
pub struct IdenticalPaths {
    /// Number of paths.
    pub paths: u64,
}

impl IdenticalPaths {
    pub(super) fn due(model: &Model, paths: u64) -> Option<Self> {
        (!model.temperature.is_random() && paths > 1).then_some(IdenticalPaths { paths })
    }
}

impl fmt::Display for IdenticalPaths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let paths = self.paths;
        write!(f, "nothing is random here: all {paths} paths are the same, and ensemble.paths = 1 is enough")
    }
}

/// beta = 0: the temperature does not move the body.
#[derive(Clone, Debug, PartialEq)]
pub struct NoDilatation;

impl NoDilatation {
    pub(super) fn due(model: &Model) -> Option<Self> {
        let Model { oscillator, temperature, .. } = model;
        let is_known = !temperature.harmonics.is_empty() || temperature.series.is_some();
        let has_temperature = temperature.effective_noise().is_some() || is_known;
        (oscillator.dilatation == 0.0 && has_temperature).then_some(NoDilatation)
    }
}

impl fmt::Display for NoDilatation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("dilatation = 0: the temperature has no effect on the motion")
    }
}

/// There are too few forcing periods to distinguish a drift from a transient.
#[derive(Clone, Debug, PartialEq)]
pub struct FewPeriods {
    /// Whole forcing periods that are counted.
    pub periods: usize,
    /// The `time.end` with which enough of them are counted.
    pub enough: f64,
}

impl FewPeriods {
    pub(super) fn due(timeline: &Timeline) -> Option<Self> {
        let periods = timeline.counted_periods();
        let period = timeline.period.filter(|_| timeline.end > 0.0 && periods < Timeline::FEWEST_PERIODS)?;
        Some(FewPeriods { periods, enough: (timeline.first_period() + Timeline::FEWEST_PERIODS) as f64 * period })
    }
}

impl fmt::Display for FewPeriods {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.periods {
            0 => "no whole forcing period is counted, and drift_velocity, diffusion_coefficient and the \
                  statistics from period to period will be absent"
                .to_string(),
            n => format!(
                "drift_velocity and diffusion_coefficient rest on {n} whole forcing period{}, the first of the run \
                 left out, and with fewer than {} a drift cannot be told from a transient",
                if n == 1 { "" } else { "s" },
                Timeline::FEWEST_PERIODS
            ),
        };
        write!(f, "{what}. Choose `time.end` = {} or more", short(self.enough))
    }
}

/// There are too many forcing periods to keep x at each of them.
#[derive(Clone, Debug, PartialEq)]
pub struct ManyPeriods {
    /// Whole forcing periods up to the end of the run.
    pub periods: f64,
}

impl ManyPeriods {
    pub(super) fn due(derived: &Derived, end: f64) -> Option<Self> {
        let is_due = derived.forcing_period.is_some_and(|period| end / period > MAX_PERIODS as f64);
        is_due.then_some(ManyPeriods { periods: derived.whole_periods })
    }
}

impl fmt::Display for ManyPeriods {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the run holds {:e} forcing periods, and x is kept at no more than {MAX_PERIODS}: \
             drift_velocity and diffusion_coefficient will be absent",
            self.periods
        )
    }
}

/// The harmonics share no period.
#[derive(Clone, Debug, PartialEq)]
pub struct NoCommonPeriod;

impl NoCommonPeriod {
    pub(super) fn due(temperature: &Temperature) -> Option<Self> {
        // A measured series obviously has no period, so that no warning is needed.
        if temperature.series.is_some() {
            return None;
        }
        let is_moving = temperature.harmonics.iter().any(|h| h.angular_frequency > 0.0 && h.amplitude != 0.0);
        (is_moving && temperature.period().is_none()).then_some(NoCommonPeriod)
    }
}

impl fmt::Display for NoCommonPeriod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "the harmonics share no period, so there are no equal phases at which x could be compared: \
             drift_velocity and diffusion_coefficient will be absent",
        )
    }
}
