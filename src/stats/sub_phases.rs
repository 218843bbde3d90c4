//! The distribution of the number of sub-phases of dynamic phases.

use super::SubPhaseCounts;
use crate::sums::batches::{BATCHES, Share, batch_of};
use crate::sums::codec::sums;

/// Dynamic phases with this many sub-phases or more are counted together.
pub const SUB_PHASE_CAP: usize = 64;

sums! {
    /// Counts of k(j).
    #[derive(Clone, Debug, PartialEq)]
    pub(super) struct SubPhaseTotals {
        /// For each k from 1 on, the counts of the paths of each batch. Most phases have few
        /// sub-phases, so that the entries in use lie close together.
        counts: Vec<[u64; BATCHES]>,
        censored: u64,
    }
}

impl Default for SubPhaseTotals {
    fn default() -> Self {
        SubPhaseTotals {
            counts: vec![[0; BATCHES]; SUB_PHASE_CAP],
            censored: 0,
        }
    }
}

impl SubPhaseTotals {
    /// A dynamic phase with k >= 1 sub-phases, of a path of this unit, is complete.
    #[inline]
    pub fn completed(&mut self, unit: u64, k: u32) {
        self.counts[(k.max(1) as usize).min(SUB_PHASE_CAP) - 1][batch_of(unit)] += 1;
    }

    /// A dynamic phase runs at t_end.
    pub fn censored(&mut self) {
        self.censored += 1;
    }

    /// The distribution of k(j). `random_units` is the number of units that completed a dynamic
    /// phase, if these are random.
    pub fn summary(&self, random_units: Option<u64>) -> SubPhaseCounts {
        let counts: Vec<u64> = self
            .counts
            .iter()
            .map(|batches| batches.iter().sum())
            .collect();
        let all: u64 = counts.iter().sum();
        let sizes: [f64; BATCHES] =
            std::array::from_fn(|batch| self.counts.iter().map(|of| of[batch]).sum::<u64>() as f64);
        let share = |of: &[u64; BATCHES]| {
            Share::of(
                of.iter()
                    .zip(sizes)
                    .map(|(count, size)| (*count as f64, size)),
            )
            .interval(random_units)
        };
        SubPhaseCounts {
            shares: counts
                .iter()
                .map(|&count| count as f64 / all as f64)
                .collect(),
            share_ends: self.counts.iter().map(share).collect(),
            counts,
            censored: self.censored,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slips of one and of two sub-phases: 2 and 1 in a path, 1 and 0 in another, 0 and 2 in a third.
    /// From the share 1/2 of their number the paths are off by 1/2, 1/2 and -1, so its error is
    /// sqrt(3/2 * 3/2)/6 = 1/4, and the ends s of its interval, with t = 4.30265 of two degrees of
    /// freedom, solve (1/2 - s)^2 = t^2 s (1 - s)/4. No slip has three sub-phases, and the upper end
    /// of that share is Wilson's for none of 6.
    #[test]
    fn the_interval_of_a_share_of_slips_is_wilsons() {
        let mut totals = SubPhaseTotals::default();
        for (unit, k) in [(0, 1), (0, 1), (0, 2), (1, 1), (2, 2), (34, 2)] {
            totals.completed(unit, k);
        }
        let found = totals.summary(Some(3));
        assert_eq!(found.shares[..3], [0.5, 0.5, 0.0]);
        let t: f64 = 4.302_652_73;
        let half = 0.5 * t / (4.0 + t * t).sqrt();
        let [low, high] = found.share_ends.at(0);
        assert!((low - (0.5 - half)).abs() < 1e-8 && (high - (0.5 + half)).abs() < 1e-8);
        let square = 3.841_458_821_f64;
        let [low, high] = found.share_ends.at(2);
        assert!(low == 0.0 && (high - square / (6.0 + square)).abs() < 1e-8);
        assert_eq!(totals.summary(None).share_ends.at(2), [0.0; 2]);
    }
}
