//! The reference value of relative errors of a statistic, and the statistics without one.

use super::{Number, Trade};
use crate::stats::Statistic;
use std::fmt;

/// The reference value of relative errors of a statistic, or why there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Standing {
    /// Errors are relative to this, the absolute value of the statistic.
    Value(f64),
    /// The value is zero within its error, so errors are relative to this, the standard deviation
    /// per path.
    Deviation(f64),
    /// The value is exactly zero.
    Zero,
    /// f_s and f_d are (nearly) equal under noise, so the value depends on the step or the
    /// resolution.
    NoLimit,
    /// The reference has no value.
    Absent,
}

impl Standing {
    /// The reference value, if there is one.
    pub fn scale(self) -> Option<f64> {
        match self {
            Standing::Value(scale) | Standing::Deviation(scale) => Some(scale),
            Standing::Zero | Standing::NoLimit | Standing::Absent => None,
        }
    }
}

/// The text in a table instead of numbers, or next to them.
impl fmt::Display for Standing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Standing::Value(_) => "relative to its value",
            Standing::Deviation(_) => "zero within its error: relative to its sd per path",
            Standing::Zero => "exactly zero: nothing to choose",
            Standing::NoLimit => {
                "no limit: f_s = f_d under noise, so it depends on the step or the resolution"
            }
            Standing::Absent => "does not exist in this scenario",
        })
    }
}

/// A value within this many standard errors of zero counts as zero.
const ZERO_WITHIN: f64 = 3.0;

impl Trade {
    /// The reference value of relative errors of a statistic in this scenario.
    pub fn standing(&self, statistic: Statistic) -> Standing {
        let reference = self.reference();
        let Number { value, error } = reference.estimate(statistic);
        if !value.is_finite() || !error.is_finite() {
            Standing::Absent
        } else if self.has_limitless_phases && statistic.row().over.counts_phases() {
            Standing::NoLimit
        } else if value == 0.0 && error == 0.0 {
            Standing::Zero
        } else if value.abs() <= ZERO_WITHIN * error {
            Standing::Deviation(reference.variance(statistic).sqrt())
        } else {
            Standing::Value(value.abs())
        }
    }

    /// The statistics that have a relative error in this scenario.
    pub fn answerable(&self) -> Vec<Statistic> {
        Statistic::ALL
            .into_iter()
            .filter(|statistic| self.standing(*statistic).scale().is_some())
            .collect()
    }
}
