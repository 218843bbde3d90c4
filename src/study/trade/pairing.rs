//! What antithetic pairs are worth in a scene.
//!
//! Paths 2k and 2k + 1 see the noise and its mirror image. How much the variance of an estimate
//! falls, or grows, by it belongs to the scene and the statistic, so it is measured once, with the
//! scheme of the reference, and holds for all schemes.

use super::Rung;
use crate::stats::Statistic;

/// Whether paths are simulated in antithetic pairs, and what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub enum Pairing {
    /// The scenario asks for pairs, and everything was measured with them.
    Asked,
    /// Everything was measured with independent paths, and the pairs beside them; one for each of
    /// `Statistic::ALL`, the variance of an estimate from pairs over that from as many independent
    /// paths.
    Measured(Vec<f64>),
    /// Only independent paths were measured.
    Unknown,
}

/// Pairs are chosen where they take at most this share of the cost of independent paths: less is
/// within the error of what was measured.
pub(super) const WORTH: f64 = 0.8;

/// Paths in pairs that are simulated for so many independent ones.
pub(super) const SHARE: u64 = 4;

/// With fewer paths in pairs nothing is told: from so many, the variance is known to 9 %.
pub(super) const FEWEST: u64 = 512;

impl Pairing {
    /// From a rung of the same scheme with independent paths, and one with pairs.
    pub(super) fn of(independent: &Rung, paired: &Rung) -> Self {
        let ratio = |statistic| {
            let ratio = paired.variance(statistic) / independent.variance(statistic);
            if ratio.is_finite() { ratio } else { 1.0 }
        };
        Pairing::Measured(Statistic::ALL.map(ratio).to_vec())
    }

    /// The variance from pairs over that from as many independent paths.
    pub fn ratio(&self, statistic: Statistic) -> Option<f64> {
        match self {
            Pairing::Measured(ratios) => ratios.get(statistic.index()).copied(),
            Pairing::Asked | Pairing::Unknown => None,
        }
    }
}
