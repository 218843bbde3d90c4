//! How many sub-phases the dynamic phases have.

use super::SubPhaseCounts;
use crate::sums::Merge;
use crate::sums::batches::{BATCHES, Share, batch_of};
use crate::sums::codec::{Codec, Damaged, Reader};

/// Dynamic phases with this many sub-phases or more are counted together.
pub const SUB_PHASE_CAP: usize = 64;

/// Counts of k(j).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SubPhaseTotals {
    /// For each k from 1 on, the counts of the paths of each batch. Most phases have few
    /// sub-phases, so that the entries in use lie close together.
    counts: Vec<[u64; BATCHES]>,
    censored: u64,
}

impl Default for SubPhaseTotals {
    fn default() -> Self {
        SubPhaseTotals { counts: vec![[0; BATCHES]; SUB_PHASE_CAP], censored: 0 }
    }
}

impl Merge for SubPhaseTotals {
    fn merge(&mut self, other: &SubPhaseTotals) {
        for (mine, more) in self.counts.iter_mut().flatten().zip(other.counts.iter().flatten()) {
            *mine += more;
        }
        self.censored += other.censored;
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

    /// The counts of each batch, for each k.
    fn batches(&self) -> Vec<[u64; SUB_PHASE_CAP]> {
        (0..BATCHES).map(|batch| std::array::from_fn(|k| self.counts[k][batch])).collect()
    }

    /// The distribution of k(j). `chance` is the number of units that completed a dynamic phase, if
    /// these are random.
    pub fn summary(&self, chance: Option<u64>) -> SubPhaseCounts {
        let counts: Vec<u64> = self.counts.iter().map(|batches| batches.iter().sum()).collect();
        let all: u64 = counts.iter().sum();
        let batches = self.batches();
        let sizes: Vec<f64> = batches.iter().map(|batch| batch.iter().sum::<u64>() as f64).collect();
        let share = |k: usize| {
            Share::of(batches.iter().zip(&sizes).map(|(batch, &size)| (batch[k] as f64, size))).interval(chance)
        };
        SubPhaseCounts {
            shares: counts.iter().map(|&count| count as f64 / all as f64).collect(),
            share_ends: (0..SUB_PHASE_CAP).map(share).collect(),
            counts,
            censored: self.censored,
        }
    }
}

/// Bytes hold the counts of one batch after the other.
impl Codec for SubPhaseTotals {
    fn write(&self, out: &mut Vec<u8>) {
        self.batches().write(out);
        self.censored.write(out);
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        let mut batches = self.batches();
        batches.read(from)?;
        self.counts = (0..SUB_PHASE_CAP).map(|k| std::array::from_fn(|batch| batches[batch][k])).collect();
        self.censored.read(from)
    }
}
