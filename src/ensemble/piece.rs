//! Consecutive paths of an ensemble, of which those that diverge are left out.

use crate::stats::{AuxiliaryObserver, BlockObserver, BlockResult};
use crate::sums::Replicate;

/// Consecutive paths that are summed together.
pub(super) struct PathRange {
    first: u64,
    paths: u64,
    pub unit: Replicate,
    /// The paths that are simulated, in ascending order.
    pub kept: Vec<u64>,
    /// The paths that are left out, in ascending order.
    diverged: Vec<u64>,
}

impl PathRange {
    pub fn new(first: u64, paths: u64, antithetic: bool) -> Self {
        // If a piece contains only one path of some pair, for example because it is a single path,
        // its independent units are paths.
        let holds_pairs = antithetic && first.is_multiple_of(2) && paths.is_multiple_of(2);
        let unit = if holds_pairs {
            Replicate::Pair
        } else {
            Replicate::Path
        };
        PathRange {
            first,
            paths,
            unit,
            kept: (first..first + paths).collect(),
            diverged: Vec::new(),
        }
    }

    /// Leave out the paths in these lanes. With a path of an antithetic pair, the other path is
    /// left out too.
    pub fn leave_out(&mut self, lanes: &[usize]) {
        let lost: Vec<u64> = lanes
            .iter()
            .map(|&lane| self.unit.of(self.kept[lane]))
            .collect();
        let (out, rest): (Vec<u64>, _) = std::mem::take(&mut self.kept)
            .into_iter()
            .partition(|&path| lost.contains(&self.unit.of(path)));
        self.kept = rest;
        self.diverged.extend(out);
        self.diverged.sort_unstable();
    }

    /// The result of the piece: that of the program and the sums of the auxiliary.
    pub fn finish<C: AuxiliaryObserver>(
        self,
        (own, theirs): (BlockObserver, C::Observer),
        auxiliary: &C,
    ) -> (BlockResult, C::Sums) {
        (
            own.finish(self.first, self.paths, self.diverged),
            auxiliary.finish(theirs, self.unit),
        )
    }
}
