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
