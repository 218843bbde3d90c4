//! The state of a run after some of its blocks. It suffices to continue the run, to join it with
//! other parts, and to compute its statistics.

use super::totals::PhaseSums;
use super::{Counts, Estimate, Record, Statistic, Sums, Totals};
use crate::model::Problem;
use crate::scheme::Timeline;
use crate::sums::{Codec, Damaged, Reader};
use crate::sums::{Merge, Overlap, Tree};
use std::ops::Range;

/// The first bytes of a state: a name, and the version of what follows.
const MAGIC: &[u8; 8] = b"sticksum";
const VERSION: u64 = 5;

/// The totals of some blocks of a run: the nodes of the tree of sums, and the counts, which need no
/// tree.
///
/// Any two of these that hold different blocks of one run can be joined. The result has the same
/// bits, however the blocks were divided. Memory grows with log2 of the number of blocks (a node
/// takes about 7 kB for 121 rows of the output grid, and 0.5 MB for 10 000), not with the number of
/// paths.
///
/// `X` are user-defined sums ([`super::Tally`]), which are folded along the same tree.
///
/// ```
/// use stickslip::scenario::Scenario;
/// use stickslip::stats::{RunTotals, Statistic};
///
/// let mut scenario = Scenario::shipped("rho025")?;
/// scenario.ensemble.paths = 4 * 256;
/// let plan = scenario.plan();
/// let part = |blocks: std::ops::Range<u64>| {
///     let mut part = RunTotals::empty(plan.model(), plan.timeline(), &plan.record);
///     blocks.into_iter().try_for_each(|k| part.push(k, plan.block(k).totals)).map(|()| part)
/// };
/// let (early, mut late) = (part(0..1)?.to_bytes(), part(1..4)?);
/// late.merge(RunTotals::empty(plan.model(), plan.timeline(), &plan.record).read(&early)?)?;
/// let mean = Statistic::StickDurationMean;
/// assert_eq!(late.totals().summary().estimate(mean), plan.run(2).estimate(mean));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RunTotals<X = ()> {
    timeline: Timeline,
    empty: (Sums, X),
    tree: Tree<(Sums, X)>,
    counts: Counts,
}

impl Merge for () {
    fn merge(&mut self, (): &()) {}
}

impl<X: Merge> Merge for (Sums, X) {
    fn merge(&mut self, other: &Self) {
        self.0.merge(&other.0);
        self.1.merge(&other.1);
    }
}

impl RunTotals {
    /// The totals of no blocks.
    pub fn empty(model: &Problem, timeline: &Timeline, record: &Record) -> Self {
        RunTotals::with((), model, timeline, record)
    }

    /// Add block number `block`. Each block of a run can be added once; a block that is already
    /// there is an [`Overlap`].
    pub fn push(&mut self, block: u64, totals: Totals) -> Result<(), Overlap> {
        self.push_with(block, totals, ())
    }
}

impl<X: Merge + Clone> RunTotals<X> {
    /// The totals of no blocks, with empty user-defined sums.
    pub fn with(own: X, model: &Problem, timeline: &Timeline, record: &Record) -> Self {
        RunTotals {
            timeline: *timeline,
            empty: (Sums::empty(model, timeline, record), own),
            tree: Tree::default(),
            counts: Counts::empty(model, timeline, record),
        }
    }

    /// Add block number `block` with the user-defined sums of this block. A block that is already
    /// there is an [`Overlap`].
    pub fn push_with(&mut self, block: u64, totals: Totals, own: X) -> Result<(), Overlap> {
        let Totals { sums, counts, .. } = totals;
        self.tree.push(block, (sums, own))?;
        self.counts.merge(&counts);
        Ok(())
    }

    /// Counts the waiting values. This does not change results. It is done once at the end of a
    /// run, because otherwise the state and each estimate would do it again.
    pub fn settle(&mut self) {
        self.counts.settle();
    }

    /// Add the blocks of another part of the same run. A block that both parts have is an
    /// [`Overlap`].
    pub fn merge(&mut self, other: RunTotals<X>) -> Result<(), Overlap> {
        debug_assert_eq!(self.timeline, other.timeline, "parts of different runs");
        self.tree.merge(other.tree)?;
        self.counts.merge(&other.counts);
        Ok(())
    }

    /// The blocks that have been added, as ranges without gaps, in ascending order.
    pub fn blocks(&self) -> Vec<Range<u64>> {
        self.tree.ranges()
    }

    /// The estimate of one statistic, from all paths that have been added.
    pub fn estimate(&self, statistic: Statistic) -> Estimate {
        let phases: PhaseSums = self
            .tree
            .total(|(sums, _)| &sums.phases)
            .unwrap_or_else(|| self.empty.0.phases.clone());
        Estimate::new(
            statistic,
            phases.measured(statistic, &self.timeline, &self.counts),
        )
    }

    /// The totals of all paths that have been added.
    pub fn totals(&self) -> Totals {
        let sums = self
            .tree
            .total(|(sums, _)| sums)
            .unwrap_or_else(|| self.empty.0.clone());
        Totals {
            timeline: self.timeline,
            sums,
            counts: self.counts.clone(),
        }
    }

    /// The user-defined sums over all paths that have been added.
    pub fn own(&self) -> X {
        self.tree
            .total(|(_, own)| own)
            .unwrap_or_else(|| self.empty.1.clone())
    }

    /// The state as bytes, from which [`RunTotals::read`] restores the same bits. They do not
    /// contain the user-defined sums.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        VERSION.write(&mut bytes);
        self.tree.write(&mut bytes, |(sums, _)| sums);
        self.counts.write(&mut bytes);
        bytes
    }
}

impl RunTotals {
    /// The state from bytes; `self` must be the empty totals of the same run. The bytes are checked
    /// against these: another number of rows or periods, overlapping blocks, and missing or
    /// additional bytes are [`Damaged`].
    pub fn read(self, bytes: &[u8]) -> Result<Self, Damaged> {
        let mut from = Reader::new(bytes);
        if from.take(MAGIC.len())? != MAGIC || from.value::<u64>()? != VERSION {
            return Err(Damaged);
        }
        let RunTotals {
            timeline,
            empty,
            mut counts,
            ..
        } = self;
        let tree = Tree::read(&mut from, &empty, |(sums, ())| sums)?;
        counts.read(&mut from)?;
        if from.left() > 0 {
            Err(Damaged)
        } else {
            Ok(RunTotals {
                timeline,
                empty,
                tree,
                counts,
            })
        }
    }
}
