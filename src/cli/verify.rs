//! `mc verify`: checks that a file holds what its scenario and its seed give.

use super::document::document;
use super::failure::{Failure, note, print, print_data};
use super::files;
use super::numbers::grouped;
use super::results;
use super::threads::Threads;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::hash::{BuildHasher as _, RandomState};
use std::ops::{ControlFlow, Range};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use stick_slip::engine::Asked;
use stick_slip::ensemble::{BLOCK_SIZE, Plan, in_order};
use stick_slip::provenance::Provenance;
use stick_slip::scenario::Scenario;
use stick_slip::stats::{BlockResult, Record, RunTotals, Summary};
use stick_slip::store::{self, Difference, FileKind, Sealed, Stored, Verification};

const EXAMPLES: &str = "\
Examples:
  mc verify rho025.h5
  mc verify rho025.h5 --blocks 100          a larger sample
  mc verify rho025.h5 --blocks all          everything, the statistics included; takes as long as the run

A block is 256 paths. Those of the sample are drawn at random, anew each time. Exit code 1 where the file is damaged, or
holds another number than its scenario comes to.";

/// Arguments of `mc verify`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Verify {
    /// A file that mc run or mc merge wrote, or a part of a run
    file: PathBuf,
    /// Number of blocks to simulate again, or `all`
    #[arg(long, value_name = "N|all", default_value = "8", value_parser = sample)]
    blocks: Sample,
    #[command(flatten)]
    threads: Threads,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

/// How many blocks are to be simulated again.
#[derive(Clone, Copy, Debug)]
enum Sample {
    Some(u64),
    All,
}

fn sample(text: &str) -> Result<Sample, String> {
    match text {
        "all" => Ok(Sample::All),
        number => number.parse().map(Sample::Some).map_err(|_| "write a number of blocks, or `all`".into()),
    }
}

/// What was compared, and the first difference if there is one.
struct Checked {
    sealed: Sealed,
    /// The blocks of the file.
    blocks: Range<u64>,
    paths: u64,
    /// The blocks that were simulated again, and the number of paths in them.
    again: BTreeSet<u64>,
    again_paths: u64,
    /// What the file records of single paths.
    record: Record,
    /// Whether the statistics were computed again and compared.
    has_statistics: bool,
    values: u64,
    /// The program that wrote the file, if it was not this one.
    other_program: Option<String>,
    difference: Option<Difference>,
}

impl Verify {
    pub fn call(&self) -> Result<(), Failure> {
        let kind = files::kind(&self.file)?;
        if let Some(FileKind::Trade | FileKind::Sweep | FileKind::Calibration) = kind {
            return self.bytes_only(store::check_bytes(&self.file)?);
        }
        let stored = files::run(&self.file)?;
        if stored.unfinished.is_some() || self.file.is_dir() || !self.file.exists() {
            let problem = format!("{}: the run is not finished", self.file.display());
            return Err(Failure::usage(problem, "finish it with `mc resume`, which checks what was saved"));
        }
        let sealed = store::check_bytes(&self.file)?;
        let checked = self.check(&stored, sealed)?;
        if self.json {
            print_data(&self.object(&checked))?;
        } else {
            print(&self.report(&checked))?;
        }
        match &checked.difference {
            Some(difference) => Err(Failure::Run(self.refusal(difference, &checked))),
            None => Ok(()),
        }
    }

    /// Reports the checksum only. A file of many runs holds no paths that a second simulation could
    /// be compared with.
    fn bytes_only(&self, sealed: Sealed) -> Result<(), Failure> {
        if self.json {
            let object = json!({
                "file": self.file.display().to_string(),
                "matches": true,
                "bytes": sealed.bytes,
                "has_checksum": sealed.has_checksum,
                "blocks_checked": [],
            });
            return print_data(&document("verification", &object));
        }
        print(&format!("{}\n{}", self.file.display(), checksum(sealed)))?;
        print(
            "simulated    nothing: a trade, a sweep or a calibration is many runs, of which the file keeps no paths\n",
        )
    }

    fn check(&self, stored: &Stored, sealed: Sealed) -> Result<Checked, Failure> {
        let header = &stored.header;
        let scenario = results::scenario(&self.file.display().to_string(), stored, &[])?;
        let other_program = results::other_program(header, &Provenance::of(&scenario));
        if let Some(other) = &other_program {
            note(&format!("warning: {} was {other}", self.file.display()));
        }
        let own = Asked { paths: header.paths, part: stored.part, goals: Vec::new(), max_time: None, with_bias: false };
        let first = own.blocks().start;
        let origin = first * BLOCK_SIZE;
        let blocks = first..first + stored.completed_paths.div_ceil(BLOCK_SIZE);
        let record = scenario.record;
        let has_rows = record.paths || record.events || record.trajectories > origin;
        let count = blocks.end - blocks.start;
        let again: BTreeSet<u64> = match self.blocks {
            Sample::Some(wanted) if wanted < count && !has_rows => BTreeSet::new(),
            Sample::Some(wanted) if wanted < count => drawn(&blocks, wanted),
            _ => blocks.clone().collect(),
        };
        let again_header = Provenance { paths: header.paths, ..Provenance::of(&scenario) };
        let mut file = Verification::open(&self.file, origin, &again_header)?;
        let is_whole = again.len() as u64 == count;
        let totals = self.simulate(&scenario, header.paths, &again, &mut file)?;
        let paths = |block: &u64| ((block + 1) * BLOCK_SIZE).min(origin + stored.completed_paths) - block * BLOCK_SIZE;
        if file.difference().is_none() {
            let summary = if is_whole { self.summary(&scenario, stored, &totals) } else { None };
            file.rest(&again_header, summary.as_ref())?;
        }
        let difference = file.difference().cloned();
        let again_paths = again.iter().map(paths).sum();
        let paths = stored.completed_paths;
        let (values, has_statistics) = (file.values(), is_whole && difference.is_none());
        let checked = Checked {
            sealed,
            blocks,
            paths,
            again,
            again_paths,
            record,
            has_statistics,
            values,
            other_program,
            difference,
        };
        Ok(checked)
    }

    /// Simulates these blocks again and compares each with the file.
    fn simulate(
        &self,
        scenario: &Scenario,
        paths: u64,
        blocks: &BTreeSet<u64>,
        file: &mut Verification,
    ) -> Result<RunTotals, Failure> {
        let plan = Plan { paths, ..scenario.plan() };
        let numbers: Vec<u64> = blocks.iter().copied().collect();
        let mut totals = RunTotals::empty(plan.model(), plan.timeline());
        let used = scenario.run_bytes(paths, self.threads.number());
        let threads = self.threads.ready("this verification", used)?;
        let make = |index: u64| plan.block(numbers[index as usize]);
        let deliver = |block: BlockResult| -> Result<ControlFlow<()>, Failure> {
            file.block(&block)?;
            let index = block.first_path / BLOCK_SIZE;
            totals.push(index, block.totals).map_err(|flaw| Failure::Run(flaw.to_string()))?;
            Ok(if file.difference().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        };
        in_order(numbers.len() as u64, threads, &AtomicBool::new(false), make, deliver)?;
        Ok(totals)
    }

    /// Computes all statistics of the file again, with the bias of the step if the file has it.
    fn summary(&self, scenario: &Scenario, stored: &Stored, totals: &RunTotals) -> Option<Summary> {
        let mut summary = totals.totals().summary();
        if stored.summary.has_bias() {
            let plan = scenario.bias_plan(stored.completed_paths).ok()?;
            let biases = plan.estimate(&summary, self.threads.number(), &AtomicBool::new(false)).ok()?;
            summary.set_biases(&biases);
        }
        Some(summary)
    }

    fn refusal(&self, difference: &Difference, checked: &Checked) -> String {
        let remedy = match &checked.other_program {
            Some(_) => "verify it with the program that wrote it: another version need not come to the same numbers",
            None => "take the file as it was written; its scenario, its seed or its numbers were changed since",
        };
        format!("{}: {difference}\n  fix: {remedy}", self.file.display())
    }

    /// The result for people.
    fn report(&self, checked: &Checked) -> String {
        let Checked { sealed, blocks, paths, again, again_paths, record, has_statistics, values, .. } = checked;
        let mut text = format!("{}\n{}", self.file.display(), checksum(*sealed));
        let count = grouped(blocks.end - blocks.start);
        if again.is_empty() {
            text += &format!(
                "simulated    nothing: the file keeps no rows of single paths, and statistics can be compared only after all {count} \
                 blocks (--blocks all)\n"
            );
        } else {
            text += &format!(
                "simulated    {} of {count} blocks, {} of {} paths: {}\n",
                grouped(again.len() as u64),
                grouped(*again_paths),
                grouped(*paths),
                listed(again, blocks)
            );
        }
        let kinds = [("paths", record.paths), ("events", record.events), ("trajectories", record.trajectories > 0)];
        let kept: Vec<&str> = kinds.into_iter().filter(|(_, is_kept)| *is_kept).map(|(kind, _)| kind).collect();
        let rows = match (again.is_empty(), kept.is_empty()) {
            (true, _) => "",
            (_, true) => "",
            _ => &format!("the rows of {}, ", kept.join(", ")),
        };
        let statistics = if *has_statistics { "every statistic, " } else { "" };
        text += &format!("compared     {rows}{statistics}seed, scheme and coordinates: {} values\n", grouped(*values));
        if !has_statistics && checked.difference.is_none() {
            text +=
                "not compared statistics and intervals: --blocks all simulates every block, and computes them again\n";
        }
        if checked.difference.is_none() {
            text += "all of that is the same, bit for bit\n";
        }
        text
    }

    fn object(&self, checked: &Checked) -> String {
        let Checked { sealed, blocks, paths, again, again_paths, has_statistics, values, .. } = checked;
        let difference = checked.difference.as_ref().map(|difference| {
            json!({
                "variable": difference.variable,
                "path": difference.path,
                "index": difference.index,
                "stored": difference.stored,
                "computed": difference.computed,
            })
        });
        let object: Value = json!({
            "file": self.file.display().to_string(),
            "matches": difference.is_none(),
            "bytes": sealed.bytes,
            "has_checksum": sealed.has_checksum,
            "same_program": checked.other_program.is_none(),
            "blocks": blocks.end - blocks.start,
            "blocks_checked": again,
            "paths": paths,
            "paths_checked": again_paths,
            "statistics_checked": has_statistics,
            "values_checked": values,
            "difference": difference,
        });
        document("verification", &object)
    }
}

fn checksum(Sealed { bytes, has_checksum }: Sealed) -> String {
    let bytes = grouped(bytes);
    match has_checksum {
        true => format!("checksum     that of its {bytes} bytes is right\n"),
        false => "checksum     none: another program changed the file, or an earlier version of mc wrote it\n".into(),
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

/// `wanted` different blocks, drawn at random.
fn drawn(blocks: &Range<u64>, wanted: u64) -> BTreeSet<u64> {
    let (random, count) = (RandomState::new(), blocks.end - blocks.start);
    let mut drawn = BTreeSet::new();
    // Floyd's algorithm for a sample: every subset of this size is equally likely.
    for last in count - wanted..count {
        let block = blocks.start + random.hash_one(last) % (last + 1);
        if !drawn.insert(block) {
            drawn.insert(blocks.start + last);
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
        // The test fails by chance with probability below 1e-48: a sample of 5 out of 20 blocks
        // misses a given block with probability 3/4, so 400 samples all miss it with probability
        // 1e-50, and there are 20 blocks. The samples are not seeded.
        for _ in 0..400 {
            let sample = drawn(&(100..120), 5);
            assert_eq!(sample.len(), 5);
            seen.extend(sample);
        }
        assert_eq!(seen, (100..120).collect());
        assert_eq!(drawn(&(3..7), 4), (3..7).collect());
    }
}
