//! What "relative" means for a statistic, and which statistics no run can answer.

use super::{Number, Trade};
use crate::stats::Statistic;
use std::fmt;

/// What can be asked of a statistic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Standing {
    /// Its errors are given relative to its value.
    Value(f64),
    /// Its value is zero as far as the reference can tell: its errors are given relative to its
    /// standard deviation per path.
    Deviation(f64),
    /// It is exactly zero.
    Zero,
    /// f_s and f_d meet under noise: it is a property of the step or the resolution.
    NoLimit,
    /// The reference has no such number.
    Absent,
}

impl Standing {
    /// What errors are relative to.
    pub fn scale(self) -> Option<f64> {
        match self {
            Standing::Value(scale) | Standing::Deviation(scale) => Some(scale),
            Standing::Zero | Standing::NoLimit | Standing::Absent => None,
        }
    }
}

/// What a table says in place of numbers, or besides them.
impl fmt::Display for Standing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Standing::Value(_) => "relative to its value",
            Standing::Deviation(_) => "zero within its error: relative to its sd per path",
            Standing::Zero => "exactly zero: nothing to choose",
            Standing::NoLimit => {
                "no limit: f_s and f_d meet under noise, and it is a property of the step or the resolution"
            }
            Standing::Absent => "does not exist in this scene",
        })
    }
}

/// Standard errors within which a value counts as zero.
const ZERO_WITHIN: f64 = 3.0;

impl Trade {
    /// What can be asked of a statistic in this scene.
    pub fn standing(&self, statistic: Statistic) -> Standing {
        let reference = self.reference();
        let Number { value, error } = reference.estimate(statistic);
        if !value.is_finite() || !error.is_finite() {
            Standing::Absent
        } else if self.has_limitless_phases && counts_phases(statistic) {
            Standing::NoLimit
        } else if value == 0.0 && error == 0.0 {
            Standing::Zero
        } else if value.abs() <= ZERO_WITHIN * error {
            Standing::Deviation(reference.variance(statistic).sqrt())
        } else {
            Standing::Value(value.abs())
        }
    }

    /// The statistics that a run can answer.
    pub fn answerable(&self) -> Vec<Statistic> {
        Statistic::ALL.into_iter().filter(|statistic| self.standing(*statistic).scale().is_some()).collect()
    }
}

/// Numbers of phases, and means over phases: infinitely many of them where slips of all sizes
/// occur. Times in total, the first stick and positions are not among them.
fn counts_phases(statistic: Statistic) -> bool {
    match statistic {
        Statistic::StickDurationMean
        | Statistic::StickDurationSd
        | Statistic::StickDurationMedian
        | Statistic::SticksPerPath
        | Statistic::SlipsPerPath
        | Statistic::SubPhasesMean
        | Statistic::SubPhasesMultipleShare
        | Statistic::JumpMean
        | Statistic::JumpAbsMean => true,
        Statistic::FirstStickDurationMean
        | Statistic::StickingFraction
        | Statistic::DisplacementEndMean
        | Statistic::DisplacementEndSd
        | Statistic::DriftVelocity
        | Statistic::DiffusionCoefficient
        | Statistic::PeriodDisplacementMean
        | Statistic::PeriodDisplacementSd
        | Statistic::PeriodDisplacementCorrelation
        | Statistic::PhaseDisplacementSd
        | Statistic::FrictionWorkMean
        | Statistic::SlidingPathRate => false,
    }
}
