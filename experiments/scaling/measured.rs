//! Measures what a block, its rows, its sums and its counts cost on this machine.

use std::time::Instant;
use stick_slip::engine::{Provenance, Status};
use stick_slip::ensemble::Plan;
use stick_slip::scenario::Scenario;
use stick_slip::stats::{BlockResult, Counts, RunTotals};
use stick_slip::store::{self, Writer};
use stick_slip::sums::{Codec as _, Reader};

/// The number of blocks of the lease that is measured; its sketches are full.
const LEASE: u64 = 128;

type Done<T> = Result<T, Box<dyn std::error::Error>>;

/// What a message costs.
#[derive(Clone, Copy)]
pub struct Message {
    /// Its length in bytes.
    pub bytes: f64,
    /// Seconds that the sender needs to write it.
    pub written: f64,
    /// Seconds that rank 0 needs to read it and to add it to what it has.
    pub joined: f64,
}

/// What the rows of a block cost.
#[derive(Clone, Copy)]
pub struct Rows {
    /// Their length in the log, in bytes.
    pub bytes: f64,
    /// Seconds that a rank needs to write them to its log.
    pub logged: f64,
    /// Seconds that rank 0 needs for them in the end, when it writes the file.
    pub filed: f64,
}

/// Costs in seconds and bytes.
pub struct Costs {
    /// Seconds to simulate and sum a block.
    pub block: f64,
    /// The rows of a block, where they are kept.
    pub rows: Option<Rows>,
    /// The sums of a lease.
    pub sums: Message,
    /// The counts of a rank.
    pub counts: Message,
}

/// Seconds that some work takes: the least of several measurements, because other programs may be
/// running.
fn fastest<T>(mut work: impl FnMut() -> Done<T>) -> Done<f64> {
    let mut least = f64::INFINITY;
    for _ in 0..7 {
        let start = Instant::now();
        work()?;
        least = start.elapsed().as_secs_f64().min(least);
    }
    Ok(least)
}

impl Costs {
    pub fn of(scenario: &Scenario) -> Done<Costs> {
        let plan = Plan { paths: 256 * LEASE, ..scenario.plan() };
        let empty = RunTotals::empty(plan.model(), plan.timeline());
        let none = Counts::empty(plan.model(), plan.timeline());
        let (mut sums, mut counts) = (empty.clone(), none.clone());
        let (mut block, mut blocks) = (f64::INFINITY, Vec::new());
        for index in 0..LEASE {
            let start = Instant::now();
            let result = plan.block(index);
            sums.push_sums(index, result.totals.clone(), (), &mut counts)?;
            block = start.elapsed().as_secs_f64().min(block);
            blocks.push(result);
        }
        let rows = if scenario.record.paths { Some(rows(scenario, &plan, &blocks)?) } else { None };
        // The sums are written, read, and joined to those of no block, which takes as long.
        let sent = sums.to_bytes();
        let sums = Message {
            bytes: sent.len() as f64,
            written: fastest(|| Ok(sums.to_bytes()))?,
            joined: fastest(|| Ok(empty.clone().merge(empty.clone().read(&sent)?)?))?,
        };
        let bytes_of = |counts: &Counts| {
            let mut bytes = Vec::new();
            counts.write(&mut bytes);
            bytes
        };
        let sent = bytes_of(&counts);
        let counts = Message {
            bytes: sent.len() as f64,
            written: fastest(|| Ok(bytes_of(&counts)))?,
            joined: fastest(|| {
                let mut read = none.clone();
                read.read(&mut Reader::new(&sent))?;
                let mut all = counts.clone();
                all.merge(&read);
                Ok(all)
            })?,
        };
        Ok(Costs { block, rows, sums, counts })
    }

    pub fn print(&self) {
        let Costs { block, rows, sums, counts } = self;
        let ms = |seconds: f64| 1e3 * seconds;
        println!("{} rows of single paths", if rows.is_some() { "With" } else { "Without" });
        println!("- a block of 256 paths: {:.2} ms to simulate", ms(*block));
        if let Some(Rows { bytes, logged, filed }) = rows {
            let (kb, per_path) = (bytes / 1e3, bytes / 256.0);
            println!("- its rows: {kb:.1} kB, {per_path:.0} B a path; {:.3} ms for the log of the rank", ms(*logged));
            println!("- its rows in the file: {:.3} ms, at the end", ms(*filed));
        }
        for (what, Message { bytes, written, joined }) in [("sums of a lease", sums), ("counts of a rank", counts)] {
            let [kb, written, joined] = [bytes / 1e3, ms(*written), ms(*joined)];
            println!("- the {what}: {kb:.0} kB, {written:.2} ms to write; rank 0 takes {joined:.2} ms for them");
        }
    }
}

fn rows(scenario: &Scenario, plan: &Plan, blocks: &[BlockResult]) -> Done<Rows> {
    let folder = tempfile::tempdir()?;
    let mut log = Vec::new();
    let logged = fastest(|| {
        log.clear();
        blocks.iter().for_each(|block| store::write_block(block, &mut log));
        Ok(std::fs::write(folder.path().join("rows"), &log)?)
    })?;
    let (mut scenario, summary) = (scenario.clone(), plan.run(1));
    scenario.ensemble.paths = plan.paths;
    let filed = fastest(|| {
        let target = folder.path().join("file.h5");
        let mut writer = Writer::create(&target, &Provenance::of(&scenario), &scenario.record, true)?;
        blocks.iter().try_for_each(|block| writer.append(block))?;
        Ok(writer.finish(&summary, Status::Complete)?)
    })?;
    let per_block = |seconds: f64| seconds / blocks.len() as f64;
    Ok(Rows { bytes: per_block(log.len() as f64), logged: per_block(logged), filed: per_block(filed) })
}
