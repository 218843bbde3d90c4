//! Shares among pooled phases, and how sure they are: phases of one path may depend on each other
//! as they like, those of different batches of whole paths do not.

use super::interval::student;
use super::range::{NORMAL, wilson};

/// Phases are counted apart for the units of each residue modulo this, so that the spread between
/// these batches shows how uncertain a pooled share is. 31 degrees of freedom widen the interval by
/// 4 %.
pub(super) const BATCHES: usize = 32;

/// The batch that a unit is in, a path or a pair of them.
pub(super) fn batch_of(unit: u64) -> usize {
    (unit % BATCHES as u64) as usize
}

/// A spread of shares below this is rounding: every batch holds the same distribution.
const ROUNDING: f64 = 1e-12;

/// A share of all phases of all batches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Share {
    /// NaN if there are no phases.
    pub estimate: f64,
    /// The standard error of a ratio of sums over batches; NaN if fewer than two of them have any
    /// phases.
    pub error: f64,
    /// Batches that have any, less one.
    pub freedom: u64,
}

impl Share {
    /// Of the phases in question of each batch, and all of its phases.
    pub fn of(batches: impl Iterator<Item = (f64, f64)>) -> Self {
        let batches: Vec<(f64, f64)> = batches.filter(|batch| batch.1 > 0.0).collect();
        let (some, all) = batches.iter().fold((0.0, 0.0), |sum, batch| (sum.0 + batch.0, sum.1 + batch.1));
        let estimate = some / all;
        let (n, freedom) = (batches.len() as f64, batches.len().saturating_sub(1));
        let spread: f64 = batches.iter().map(|batch| (batch.0 - estimate * batch.1).powi(2)).sum();
        let error = if freedom == 0 { f64::NAN } else { (n / freedom as f64 * spread).sqrt() / all };
        Share { estimate, error: if error < ROUNDING { 0.0 } else { error }, freedom: freedom as u64 }
    }

    /// Half the width of its 95 % interval.
    pub fn half_width(&self) -> f64 {
        student(self.freedom) * self.error
    }

    /// Its 95 % interval within [0, 1]. Where the batches agree, and `chance` is the number of
    /// paths that have phases and agree by chance, a share of 0 or 1 is known as well as so many
    /// paths tell it.
    pub fn interval(&self, chance: Option<u64>) -> [f64; 2] {
        let Share { estimate, error, freedom } = *self;
        match chance {
            _ if error.is_nan() => [f64::NAN; 2],
            Some(paths) if error == 0.0 => wilson(estimate, paths as f64, NORMAL),
            _ if error == 0.0 => [estimate; 2],
            _ => wilson(estimate, estimate * (1.0 - estimate) / (error * error), student(freedom)),
        }
    }
}
