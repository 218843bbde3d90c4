//! The file of a run, or of a part of one: blocks are simulated again.

use super::{Checked, Sample, UNASKED, Verify, drawn};
use crate::cli::failure::Failure;
use crate::cli::numbers::grouped;
use crate::cli::results;
use serde_json::json;
use std::collections::BTreeSet;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use stick_slip::engine::{Asked, Provenance, other_program};
use stick_slip::ensemble::{BLOCK_SIZE, in_order};
use stick_slip::scenario::Scenario;
use stick_slip::stats::{BlockResult, Record, RunTotals, Summary};
use stick_slip::store::{Expected, Stored, Verification};

/// Blocks that are simulated where nothing was asked for and all of them take long.
const FEW: u64 = 8;

/// The time to estimate the bias of the step, in units of the time of the run. A generous bound.
const BIAS: f64 = 4.0;

/// A file, and what it must hold.
struct Claim<'a> {
    verify: &'a Verify,
    stored: &'a Stored,
    scenario: Scenario,
    expected: Expected,
    /// The blocks of the file.
    blocks: Range<u64>,
}

/// The blocks that were simulated again, and what came of it.
struct Simulated {
    blocks: BTreeSet<u64>,
    file: Verification,
    totals: RunTotals,
}

impl Verify {
    /// Check a run.
    pub(super) fn run(&self, stored: &Stored) -> Result<Checked, Failure> {
        let scenario = results::scenario(&self.file.display().to_string(), stored, &[])?;
        let own = Provenance::of(&scenario);
        let expected = Expected::of(stored, own, scenario.record);
        let asked = Asked { part: stored.part, ..Asked::paths(expected.header.paths) };
        let first = asked.blocks().start;
        let blocks = first..first + stored.completed_paths.div_ceil(BLOCK_SIZE);
        Claim { verify: self, stored, scenario, expected, blocks }.check()
    }
}

impl Claim<'_> {
    fn check(&self) -> Result<Checked, Failure> {
        let count = self.blocks.end - self.blocks.start;
        let all = || self.blocks.clone().collect();
        let mut again = match self.verify.blocks {
            Some(Sample::All) => self.simulate(all())?,
            Some(Sample::Some(wanted)) if wanted >= count => self.simulate(all())?,
            Some(Sample::Some(_)) if !self.has_rows() => self.simulate(BTreeSet::new())?,
            Some(Sample::Some(wanted)) => self.simulate(drawn(&self.blocks, wanted))?,
            None => self.simulate_unasked()?,
        };
        let is_whole = again.blocks.len() as u64 == count;
        if again.file.difference().is_none() {
            let summary = if is_whole { self.again(&again.totals) } else { self.stored_summary() };
            again.file.rest(&self.expected, &summary)?;
        }
        Ok(self.checked(&again, is_whole))
    }

    /// All blocks if that takes a few seconds, and else a few blocks.
    fn simulate_unasked(&self) -> Result<Simulated, Failure> {
        let count = self.blocks.end - self.blocks.start;
        let start = Instant::now();
        let few = self.simulate(drawn(&self.blocks, FEW))?;
        if few.blocks.len() as u64 == count || few.file.difference().is_some() {
            return Ok(few);
        }
        let passes = count as f64 / FEW as f64 * if self.stored.summary.has_bias() { 1.0 + BIAS } else { 1.0 };
        match start.elapsed().mul_f64(passes) <= UNASKED {
            true => self.simulate(self.blocks.clone().collect()),
            false if self.has_rows() => Ok(few),
            // They were compared with nothing.
            false => self.simulate(BTreeSet::new()),
        }
    }

    /// The number of the first path in the file.
    fn origin(&self) -> u64 {
        self.blocks.start * BLOCK_SIZE
    }

    /// Whether the file has rows of single paths.
    fn has_rows(&self) -> bool {
        let Record { paths, events, trajectories, .. } = self.scenario.record;
        paths || events || trajectories > self.origin()
    }

    /// Simulates these blocks again and compares each with the file.
    fn simulate(&self, blocks: BTreeSet<u64>) -> Result<Simulated, Failure> {
        let mut file = Verification::open(&self.verify.file, self.origin(), &self.expected.header)?;
        let plan = Asked::paths(self.expected.header.paths).plan(&self.scenario);
        let numbers: Vec<u64> = blocks.iter().copied().collect();
        let mut totals = RunTotals::empty(plan.model(), plan.timeline());
        let used = self.scenario.run_bytes(plan.paths, self.verify.threads.number());
        let threads = self.verify.threads.ready("this verification", used)?;
        let make = |index: u64| plan.block(numbers[index as usize]);
        let deliver = |block: BlockResult| -> Result<ControlFlow<()>, Failure> {
            file.block(&block)?;
            let index = block.first_path / BLOCK_SIZE;
            totals.push(index, block.totals).map_err(|flaw| Failure::Run(flaw.to_string()))?;
            Ok(if file.difference().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        };
        in_order(numbers.len() as u64, threads, &AtomicBool::new(false), make, deliver)?;
        Ok(Simulated { blocks, file, totals })
    }

    /// Computes all statistics of the file again, with the bias of the step if the file has it.
    fn again(&self, totals: &RunTotals) -> Summary {
        let mut summary = totals.totals().summary();
        if self.stored.summary.has_bias()
            && let Ok(plan) = self.scenario.bias_plan(self.expected.completed_paths)
            && let Ok(biases) = plan.estimate(&summary, self.verify.threads.number(), &AtomicBool::new(false))
        {
            summary.set_biases(&biases);
        }
        summary
    }

    /// The statistics of the file, without a bias if the scheme has none.
    fn stored_summary(&self) -> Summary {
        let mut summary = self.stored.summary.clone();
        if self.scenario.bias_plan(self.expected.completed_paths).is_err() {
            summary.set_biases(&[]);
        }
        summary
    }

    fn checked(&self, again: &Simulated, is_whole: bool) -> Checked {
        let difference = again.file.difference().cloned();
        let count = self.blocks.end - self.blocks.start;
        let end = self.origin() + self.stored.completed_paths;
        let paths = |block: &u64| ((block + 1) * BLOCK_SIZE).min(end) - block * BLOCK_SIZE;
        let again_paths: u64 = again.blocks.iter().map(paths).sum();
        let simulated = match again.blocks.is_empty() {
            true => "nothing: the file keeps no rows of single paths".into(),
            false => format!(
                "{} of {} blocks, {} of {} paths: {}",
                grouped(again.blocks.len() as u64),
                grouped(count),
                grouped(again_paths),
                grouped(self.stored.completed_paths),
                listed(&again.blocks, &self.blocks)
            ),
        };
        let Record { paths, events, trajectories, .. } = self.scenario.record;
        let kinds = [("paths", paths), ("events", events), ("trajectories", trajectories > 0)];
        let kept: Vec<&str> = kinds.into_iter().filter(|(_, is_kept)| *is_kept).map(|(kind, _)| kind).collect();
        let rows = match again.blocks.is_empty() || kept.is_empty() {
            true => String::new(),
            false => format!("the rows of {}, ", kept.join(", ")),
        };
        let has_statistics = is_whole && difference.is_none();
        let statistics = if has_statistics { "every statistic, " } else { "" };
        let theirs = &self.stored.header;
        Checked {
            simulated,
            compared: format!("{rows}{statistics}attributes, coordinates and units"),
            not_compared: (!has_statistics).then(|| {
                format!(
                    "statistics and intervals with a simulation: --blocks all simulates all {} blocks, and computes them \
                     again",
                    grouped(count)
                )
            }),
            fields: json!({
                "blocks": count,
                "blocks_checked": again.blocks,
                "paths": self.stored.completed_paths,
                "paths_checked": again_paths,
                "statistics_checked": has_statistics,
            }),
            values: again.file.values(),
            other_program: other_program(&theirs.program_version, &theirs.git_hash),
            difference,
        }
    }
}

/// The numbers of the blocks; only the first ones if there are many.
fn listed(again: &BTreeSet<u64>, all: &Range<u64>) -> String {
    if again.len() as u64 == all.end - all.start {
        return "all".into();
    }
    let first: Vec<String> = again.iter().take(12).map(|&block| grouped(block)).collect();
    let more = if again.len() > 12 { ", ..." } else { "" };
    format!("blocks {}{more}", first.join(", "))
}
