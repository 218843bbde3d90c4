//! A run, or a part of one: which of its blocks are simulated again, and what comes of it.

use super::Difference;
use super::rows::{Expected, Verification};
use crate::dataset::{Source, StoredRun};
use std::collections::BTreeSet;
use std::hash::{BuildHasher as _, RandomState};
use std::ops::{ControlFlow, Range};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use stickslip::engine::{Asked, Provenance};
use stickslip::ensemble::{BLOCK_SIZE, in_order};
use stickslip::scenario::Scenario;
use stickslip::stats::{BlockResult, LimitCycle, Record, RunTotals, Summary};

/// Blocks that are simulated where nothing was asked for and all of them take long.
const FEW: u64 = 8;

/// The time to estimate the bias of the step, in units of the time of the run. A generous bound.
const BIAS: f64 = 4.0;

/// How many blocks are to be simulated again.
#[derive(Clone, Copy, Debug)]
pub enum BlocksAgain {
    /// So many, drawn at random.
    Some(u64),
    /// All of them.
    All,
    /// All if that takes no longer, and else a few.
    Within(Duration),
}

/// What was compared, and the first difference if there is one.
#[derive(Clone, Debug)]
pub struct Again {
    /// The blocks of the run.
    pub blocks: Range<u64>,
    /// Those that were simulated again.
    pub simulated: BTreeSet<u64>,
    /// Number of paths that were simulated again.
    pub paths: u64,
    /// Whether all statistics were computed again.
    pub has_statistics: bool,
    /// Number of values and texts that were compared.
    pub values: u64,
    /// The first difference, if there is one.
    pub difference: Option<Difference>,
}

/// A data set, and what it must hold.
struct Claim<'a> {
    held: &'a dyn Source,
    stored: &'a StoredRun,
    scenario: &'a Scenario,
    expected: Expected,
    blocks: Range<u64>,
    threads: usize,
    stop: &'a AtomicBool,
}

/// Compare the data set of a run with what this scenario gives.
///
/// # Errors
///
/// Something in the data set cannot be read.
pub(crate) fn again(
    held: &dyn Source,
    stored: &StoredRun,
    scenario: &Scenario,
    sample: BlocksAgain,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Again, String> {
    let expected = Expected::of(stored, Provenance::of(scenario), scenario.record);
    let asked = Asked {
        part: stored.part,
        ..Asked::paths(expected.header.paths)
    };
    let first = asked.blocks().start;
    let blocks = first..first + stored.completed_paths.div_ceil(BLOCK_SIZE);
    Claim {
        held,
        stored,
        scenario,
        expected,
        blocks,
        threads,
        stop,
    }
    .check(sample)
}

/// The blocks that were simulated again, and what came of it.
struct MadeAgain<'a> {
    blocks: BTreeSet<u64>,
    compared: Verification<'a>,
    totals: RunTotals,
}

impl Claim<'_> {
    fn check(&self, sample: BlocksAgain) -> Result<Again, String> {
        let count = self.blocks.end - self.blocks.start;
        let all = || self.blocks.clone().collect();
        let mut again = match sample {
            BlocksAgain::All => self.simulate(all())?,
            BlocksAgain::Some(wanted) if wanted >= count => self.simulate(all())?,
            BlocksAgain::Some(_) if !self.has_rows() => self.simulate(BTreeSet::new())?,
            BlocksAgain::Some(wanted) => self.simulate(drawn(&self.blocks, wanted))?,
            BlocksAgain::Within(limit) => self.simulate_within(limit)?,
        };
        let is_whole = again.blocks.len() as u64 == count;
        if again.compared.against.difference.is_none() {
            let mut summary = if is_whole {
                self.again(&again.totals)
            } else {
                self.stored_summary()
            };
            // A run that was interrupted has none.
            if self.stored.summary.cycle.is_some() {
                summary.cycle = LimitCycle::of(self.scenario);
            }
            again.compared.rest(&self.expected, &summary)?;
        }
        let end = self.origin() + self.stored.completed_paths;
        let paths = |block: &u64| ((block + 1) * BLOCK_SIZE).min(end) - block * BLOCK_SIZE;
        let difference = again.compared.against.difference;
        Ok(Again {
            blocks: self.blocks.clone(),
            paths: again.blocks.iter().map(paths).sum(),
            has_statistics: is_whole && difference.is_none(),
            values: again.compared.against.values,
            simulated: again.blocks,
            difference,
        })
    }

    /// All blocks if that takes no longer than this, and else a few blocks.
    fn simulate_within(&self, limit: Duration) -> Result<MadeAgain<'_>, String> {
        let count = self.blocks.end - self.blocks.start;
        let start = Instant::now();
        let few = self.simulate(drawn(&self.blocks, FEW))?;
        if few.blocks.len() as u64 == count || few.compared.against.difference.is_some() {
            return Ok(few);
        }
        let passes = count as f64 / FEW as f64
            * if self.stored.summary.has_bias() {
                1.0 + BIAS
            } else {
                1.0
            };
        match start.elapsed().mul_f64(passes) <= limit {
            true => self.simulate(self.blocks.clone().collect()),
            false if self.has_rows() => Ok(few),
            // They were compared with nothing.
            false => self.simulate(BTreeSet::new()),
        }
    }

    /// The number of the first path.
    fn origin(&self) -> u64 {
        self.blocks.start * BLOCK_SIZE
    }

    /// Whether there are rows of single paths.
    fn has_rows(&self) -> bool {
        let Record {
            paths,
            events,
            trajectories,
            ..
        } = self.scenario.record;
        paths || events || trajectories > self.origin()
    }

    /// Simulate these blocks again and compare each with what is stored.
    fn simulate(&self, blocks: BTreeSet<u64>) -> Result<MadeAgain<'_>, String> {
        let mut compared = Verification::of(self.held, self.origin(), &self.expected.header);
        let plan = Asked::paths(self.expected.header.paths).plan(self.scenario);
        let numbers: Vec<u64> = blocks.iter().copied().collect();
        let mut totals = RunTotals::empty(plan.model(), plan.timeline(), &plan.record);
        let make = |index: u64| plan.block(numbers[index as usize]);
        let deliver = |block: BlockResult| -> Result<ControlFlow<()>, String> {
            compared.block(&block.rows)?;
            let pushed = totals.push(block.rows.first_path / BLOCK_SIZE, block.totals);
            pushed.map_err(|flaw| flaw.to_string())?;
            Ok(if compared.against.difference.is_some() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            })
        };
        in_order(numbers.len() as u64, self.threads, self.stop, make, deliver)?;
        Ok(MadeAgain {
            blocks,
            compared,
            totals,
        })
    }

    /// Compute all statistics again, with the bias of the step if the data set has it.
    fn again(&self, totals: &RunTotals) -> Summary {
        let mut summary = totals.totals().summary();
        if self.stored.summary.has_bias()
            && let Ok(plan) = self.scenario.bias_plan(self.expected.completed_paths)
            && let Ok(biases) = plan.estimate(&summary, self.threads, self.stop)
        {
            summary.set_biases(&biases);
        }
        summary
    }

    /// The statistics that are stored, without a bias if the scheme has none.
    fn stored_summary(&self) -> Summary {
        let mut summary = self.stored.summary.clone();
        if self
            .scenario
            .bias_plan(self.expected.completed_paths)
            .is_err()
        {
            summary.set_biases(&[]);
        }
        summary
    }
}

/// `wanted` different numbers of this range, drawn at random.
pub fn drawn(all: &Range<u64>, wanted: u64) -> BTreeSet<u64> {
    let (random, count) = (RandomState::new(), all.end - all.start);
    let mut drawn = BTreeSet::new();
    // Floyd's algorithm for a sample: every subset of this size is equally likely.
    for last in count - wanted.min(count)..count {
        let number = all.start + random.hash_one(last) % (last + 1);
        if !drawn.insert(number) {
            drawn.insert(all.start + last);
        }
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_has_its_size_and_every_block_its_chance() {
        let mut seen = BTreeSet::new();
        // A sample of 5 out of 20 blocks misses a given block with probability 3/4, and 400 samples
        // all miss it with probability 1e-50. With 20 blocks, the test fails by chance with
        // probability below 1e-48. The samples are not seeded.
        for _ in 0..400 {
            let sample = drawn(&(100..120), 5);
            assert_eq!(sample.len(), 5);
            seen.extend(sample);
        }
        assert_eq!(seen, (100..120).collect());
        assert_eq!(drawn(&(3..7), 4), (3..7).collect());
    }
}
