//! Shares among pooled phases, and their uncertainty. Phases of one path may depend on each other
//! in any way, but those of different batches of whole paths are independent.

use super::interval::student;
use super::range::{NORMAL, wilson};

/// Number of batches. Phases are counted separately for the units of each residue modulo this
/// number, so that the spread between the batches shows how uncertain a pooled share is. With 31
/// degrees of freedom the interval is 4 % wider than by the normal law.
pub(crate) const BATCHES: usize = 32;

/// The batch of a unit, which is a path or a pair of paths.
pub(crate) fn batch_of(unit: u64) -> usize {
    (unit % BATCHES as u64) as usize
}

/// A standard error of a share below this is rounding: every batch has the same share.
const ROUNDING: f64 = 1e-12;

/// The share of some phases among all phases of all batches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Share {
    /// The estimate; NaN if there are no phases.
    pub estimate: f64,
    /// The standard error of a ratio of sums over batches; NaN if fewer than two batches have any
    /// phases.
    pub error: f64,
    /// The number of batches that have any phases, minus one.
    pub freedom: u64,
    /// The number of all phases.
    pub all: f64,
}

impl Share {
    /// The share from two numbers per batch: the phases in question, and all phases.
    pub fn of(batches: impl Iterator<Item = (f64, f64)>) -> Self {
        let batches: Vec<(f64, f64)> = batches.filter(|batch| batch.1 > 0.0).collect();
        let (some, all) = batches
            .iter()
            .fold((0.0, 0.0), |sum, batch| (sum.0 + batch.0, sum.1 + batch.1));
        let estimate = some / all;
        let (n, freedom) = (batches.len() as f64, batches.len().saturating_sub(1));
        let spread: f64 = batches
            .iter()
            .map(|batch| (batch.0 - estimate * batch.1).powi(2))
            .sum();
        let error = if freedom == 0 {
            f64::NAN
        } else {
            (n / freedom as f64 * spread).sqrt() / all
        };
        Share {
            estimate,
            error: if error < ROUNDING { 0.0 } else { error },
            freedom: freedom as u64,
            all,
        }
    }

    /// Half the width of the 95 % interval by Student's t.
    pub fn half_width(&self) -> f64 {
        student(self.freedom) * self.error
    }

    /// The 95 % interval, within [0, 1]. `random_units` is the number of paths that have phases,
    /// where their agreement is a matter of chance. If all batches agree, because none or all of
    /// the phases are in question, the interval is Wilson's for this number of phases, and without
    /// `random_units` it is a single point.
    pub fn interval(&self, random_units: Option<u64>) -> [f64; 2] {
        let Share {
            estimate,
            error,
            freedom,
            all,
        } = *self;
        match random_units {
            _ if error.is_nan() => [f64::NAN; 2],
            Some(paths) if error == 0.0 => wilson(estimate, all.max(paths as f64), NORMAL),
            _ if error == 0.0 => [estimate; 2],
            _ => wilson(
                estimate,
                estimate * (1.0 - estimate) / (error * error),
                student(freedom),
            ),
        }
    }
}
