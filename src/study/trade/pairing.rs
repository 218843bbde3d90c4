//! The effect of antithetic pairs on the variance in a scenario.
//!
//! Paths 2k and 2k + 1 have the noise and its mirror image. The factor by which this reduces or
//! increases the variance of an estimate depends on the scenario and the statistic, but hardly on
//! the scheme. It is therefore measured once, with the scheme of the reference, and used for all
//! schemes.

use super::TradeSetting;
use crate::stats::Statistic;

/// Whether paths are simulated in antithetic pairs, or the measured effect of pairs.
#[derive(Clone, Debug, PartialEq)]
pub enum Pairing {
    /// The scenario has pairs, and everything was measured with them.
    Asked,
    /// Everything was measured with independent paths, and pairs were measured in addition. For
    /// each of `Statistic::ALL`, this is the variance of an estimate from pairs divided by that
    /// from the same number of independent paths.
    Measured(Vec<f64>),
    /// Only independent paths were measured.
    Unknown,
}

/// Pairs are chosen if they cost at most this share of independent paths. A smaller gain is within
/// the error of the measurement.
pub(super) const WORTH: f64 = 0.8;

/// One path in pairs is simulated for this many independent ones.
pub(super) const SHARE: u64 = 4;

/// Fewest paths in pairs that are measured; from this number the variance is known to 9 %.
pub(super) const FEWEST: u64 = 512;

impl Pairing {
    /// Compare a setting with independent paths and one with pairs, both of the same scheme.
    pub(super) fn of(independent: &TradeSetting, paired: &TradeSetting) -> Self {
        let ratio = |statistic| {
            let ratio = paired.variance(statistic) / independent.variance(statistic);
            if ratio.is_finite() { ratio } else { 1.0 }
        };
        Pairing::Measured(Statistic::ALL.map(ratio).to_vec())
    }

    /// The variance from pairs divided by that from the same number of independent paths, if it was
    /// measured.
    pub fn ratio(&self, statistic: Statistic) -> Option<f64> {
        match self {
            Pairing::Measured(ratios) => ratios.get(statistic.index()).copied(),
            Pairing::Asked | Pairing::Unknown => None,
        }
    }
}
