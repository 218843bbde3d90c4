//! Simulates a lease, and packs the result into a parcel, which is sent to rank 0.

use super::message::{read_bytes, write_bytes};
use super::snapshots::{Counted, Snapshots};
use std::ops::{ControlFlow, Range};
use std::path::Path;
use std::time::Instant;
use stick_slip::ensemble::{Delivered, Plan, Stops};
use stick_slip::saved::SavedError;
use stick_slip::stats::{BlockResult, Counts, RunTotals, Totals};
use stick_slip::store::{self, RankLog, RunQuestion, StoreError};
use stick_slip::sums::{Codec as _, Damaged, Reader};

/// The result of a lease: which lease it is, how many of its blocks are done, and their rows and
/// sums.
#[derive(Debug)]
pub(super) struct Parcel {
    /// The lease.
    pub lease: Range<u64>,
    /// Number of blocks that are done. They are the first ones of the lease.
    pub done: u64,
    /// Wall-clock seconds that these blocks took.
    pub seconds: f64,
    /// Number of bytes of rows in `stretches`.
    pub rows: usize,
    /// Rows and sums of neighbouring blocks, as bytes.
    stretches: Vec<u8>,
}

/// How leases are simulated.
#[derive(Clone, Copy, Debug)]
pub(super) struct RankOptions {
    /// Number of threads of each rank.
    pub threads: usize,
    /// Whether the run has goals. A run with goals may end after any block, so every block is sent
    /// with its own sums and counts. Without goals, the sums of a lease are merged, and counts are
    /// sent only when rank 0 asks for them.
    pub has_goals: bool,
}

/// What a worker receives before its first lease.
pub(super) struct Instructions {
    pub question: RunQuestion,
    pub options: RankOptions,
    /// The outlet, where the worker may write the rows of its paths. It is empty if the rows are to
    /// be sent with the leases.
    pub outlet: Vec<u8>,
}

impl Instructions {
    /// The bytes of the message.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        (self.options.threads as u64).write(&mut bytes);
        u64::from(self.options.has_goals).write(&mut bytes);
        write_bytes(&self.outlet, &mut bytes);
        bytes.extend(self.question.to_bytes());
        bytes
    }

    /// Read the bytes of the message. It is an error if another version of the program has written
    /// the question.
    pub fn of_bytes(bytes: &[u8]) -> Result<Self, StoreError> {
        let damaged = |_| SavedError::Damaged { path: "the message of rank 0".into() };
        let mut from = Reader::new(bytes);
        let (threads, has_goals) = (number(&mut from).map_err(damaged)?, number(&mut from).map_err(damaged)?);
        let outlet = read_bytes(&mut from).map_err(damaged)?.to_vec();
        let rest = from.take(from.left()).map_err(damaged)?;
        let options = RankOptions { threads: threads as usize, has_goals: has_goals > 0 };
        Ok(Instructions { question: RunQuestion::of_bytes(rest, Path::new("the message of rank 0"))?, options, outlet })
    }
}

/// The bytes of a lease.
pub(super) fn to_bytes(lease: &Range<u64>) -> Vec<u8> {
    let mut bytes = Vec::new();
    lease.start.write(&mut bytes);
    lease.end.write(&mut bytes);
    bytes
}

/// Read a lease. If the bytes cannot be read, the lease is empty, and so is its parcel.
pub(super) fn of_bytes(bytes: &[u8]) -> Range<u64> {
    let mut from = Reader::new(bytes);
    number(&mut from).and_then(|start| Ok(start..number(&mut from)?)).unwrap_or(0..0)
}

/// Simulates the leases of one rank, one after the other.
pub(super) struct Simulator<'a> {
    pub plan: &'a Plan,
    pub options: RankOptions,
    pub stops: Stops<'a>,
    /// The counts of all leases that the rank has simulated.
    pub counts: Counts,
    /// Keeps copies of the counts until rank 0 asks for them.
    pub snapshots: &'a Snapshots,
    /// The log for the rows. If there is none, the rows are sent with the leases.
    pub log: Option<RankLog>,
}

impl<'a> Simulator<'a> {
    /// The simulator of a rank that has not simulated any lease yet. It has no log.
    pub fn new(plan: &'a Plan, options: RankOptions, stops: Stops<'a>, snapshots: &'a Snapshots) -> Self {
        let counts = Counts::empty(plan.model(), plan.timeline());
        Simulator { plan, options, stops, counts, snapshots, log: None }
    }

    /// Simulate a lease, or only its first blocks if one of the flags in `stops` is set. It is an
    /// error if rows cannot be written to the log.
    pub fn simulate(&mut self, lease: Range<u64>) -> Result<Parcel, StoreError> {
        let Simulator { plan, options, stops, counts, snapshots, log } = self;
        let start = Instant::now();
        let empty = RunTotals::empty(plan.model(), plan.timeline());
        let (mut stretches, mut rows) = (Vec::new(), Vec::new());
        let (mut totals, mut kept) = (empty.clone(), 0);
        let mut close = |totals: &mut RunTotals, blocks: Range<u64>, rows: &mut Vec<u8>| {
            kept += rows.len();
            blocks.start.write(&mut stretches);
            blocks.end.write(&mut stretches);
            write_bytes(rows, &mut stretches);
            write_bytes(&totals.to_bytes(), &mut stretches);
            *totals = empty.clone();
            rows.clear();
        };
        let deliver = |Delivered { index, result, .. }: Delivered<()>| -> Result<ControlFlow<()>, StoreError> {
            match log {
                Some(log) => log.append(&result)?,
                None => store::write_block(&result, &mut rows),
            }
            let pushed = match options.has_goals {
                true => totals.push(index, result.totals),
                false => totals.push_sums(index, result.totals, (), counts),
            };
            // Every block of a lease is delivered once, so nothing overlaps.
            debug_assert!(pushed.is_ok());
            if options.has_goals {
                close(&mut totals, index..index + 1, &mut rows);
            }
            Ok(ControlFlow::Continue(()))
        };
        let done = plan.run_beside(&(), lease.clone(), options.threads, *stops, deliver)?;
        let end = lease.start + done;
        if !options.has_goals && done > 0 {
            close(&mut totals, lease.start..end, &mut rows);
            let receipt = log.as_mut().map_or(Ok(Vec::new()), RankLog::sync)?;
            snapshots.add(end, Counted { counts: counts.clone(), receipt });
        }
        Ok(Parcel { lease, done, seconds: start.elapsed().as_secs_f64(), rows: kept, stretches })
    }
}

/// Neighbouring blocks that a rank has simulated.
pub(super) struct Stretch {
    pub blocks: Range<u64>,
    /// What is recorded of the single paths, block by block, unless it is in a log. The totals of
    /// these blocks are empty.
    pub results: Vec<BlockResult>,
    /// The sums of the blocks. Their counts are included only if the run has goals.
    pub totals: RunTotals,
}

impl Parcel {
    /// The bytes of the message.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Parcel { lease, done, seconds, rows, stretches } = self;
        let mut bytes = Vec::with_capacity(stretches.len() + 64);
        [lease.start, lease.end, *done, *rows as u64].iter().for_each(|number| number.write(&mut bytes));
        seconds.write(&mut bytes);
        write_bytes(stretches, &mut bytes);
        bytes
    }

    /// Read the bytes of the message.
    pub fn of_bytes(bytes: &[u8]) -> Result<Self, Damaged> {
        let mut from = Reader::new(bytes);
        let (lease, done) = (number(&mut from)?..number(&mut from)?, number(&mut from)?);
        let rows = number(&mut from)? as usize;
        let mut seconds = 0.0;
        seconds.read(&mut from)?;
        Ok(Parcel { lease, done, seconds, rows, stretches: read_bytes(&mut from)?.to_vec() })
    }

    /// The rows and sums in the parcel, as stretches of neighbouring blocks.
    pub fn stretches(&self, plan: &Plan) -> Result<Vec<Stretch>, Damaged> {
        let empty = RunTotals::empty(plan.model(), plan.timeline());
        // These totals are not used, so they are as small as possible.
        let none = Totals::empty(plan.model(), &plan.timeline().without_rows());
        let mut from = Reader::new(&self.stretches);
        let mut stretches = Vec::new();
        while from.left() > 0 {
            let blocks = number(&mut from)?..number(&mut from)?;
            let mut rows = Reader::new(read_bytes(&mut from)?);
            let mut results = Vec::new();
            while rows.left() > 0 {
                results.push(store::read_block(&mut rows, &none)?);
            }
            let totals = empty.clone().read(read_bytes(&mut from)?)?;
            stretches.push(Stretch { blocks, results, totals });
        }
        Ok(stretches)
    }
}

fn number(from: &mut Reader<'_>) -> Result<u64, Damaged> {
    let mut number = 0;
    number.read(from).map(|()| number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicBool;
    use stick_slip::scenario::Scenario;

    /// Sums and rows that were written to bytes and read again are those of the run, whether blocks
    /// are sent one by one or together. The counts that are asked for before the end of a lease are
    /// then those of all blocks before this end, however the leases are distributed, and although
    /// both ranks have already simulated blocks beyond it.
    #[test]
    fn what_comes_back_has_the_bits_of_the_run() {
        let mut scenario = Scenario::shipped("rho025").expect("shipped");
        scenario.ensemble.paths = 1_500;
        let plan = scenario.plan();
        let never = AtomicBool::new(false);
        let stops = Stops { stop: &never, halt: &never };
        let of_run = |end: u64| {
            let (mut totals, mut rows) = (RunTotals::empty(plan.model(), plan.timeline()), Vec::new());
            for index in 0..end {
                let block = plan.block(index);
                store::write_block(&block, &mut rows);
                totals.push(index, block.totals).expect("each block once");
            }
            (totals.to_bytes(), rows)
        };
        let of_leases = |leases: &[Range<u64>], has_goals: bool| {
            let snapshots = [Snapshots::default(), Snapshots::default()];
            let options = RankOptions { threads: 2, has_goals };
            let mut ranks = snapshots.each_ref().map(|snapshots| Simulator::new(&plan, options, stops, snapshots));
            let parcels: Vec<Parcel> = leases
                .iter()
                .enumerate()
                .map(|(k, lease)| {
                    let parcel = ranks[k % 2].simulate(lease.clone()).expect("there is no log");
                    let parcel = Parcel::of_bytes(&parcel.to_bytes()).expect("as written");
                    assert_eq!((parcel.lease.clone(), parcel.done), (lease.clone(), lease.end - lease.start));
                    parcel
                })
                .collect();
            let (mut totals, mut rows) = (RunTotals::empty(plan.model(), plan.timeline()), Vec::new());
            for parcel in parcels {
                for stretch in parcel.stretches(&plan).expect("as written") {
                    stretch.results.iter().for_each(|block| store::write_block(block, &mut rows));
                    totals.merge(stretch.totals).expect("each block once");
                }
                if !has_goals {
                    let mut counts = Counts::empty(plan.model(), plan.timeline());
                    let before = snapshots.iter().filter_map(|snapshots| snapshots.before(parcel.lease.end));
                    before.for_each(|some| counts.merge(&some.counts));
                    totals.set_counts(counts);
                }
                assert!((totals.to_bytes(), rows.clone()) == of_run(parcel.lease.end), "{:?}", parcel.lease);
            }
        };
        of_leases(&[0..2, 2..6], true);
        of_leases(&[0..2, 2..6], false);
        of_leases(&[0..1, 1..2, 2..4, 4..5, 5..6], false);
        let snapshots = Snapshots::default();
        let bytes =
            Simulator::new(&plan, RankOptions { threads: 1, has_goals: true }, stops, &snapshots).simulate(0..1);
        let bytes = bytes.expect("there is no log").to_bytes();
        assert!((0..bytes.len()).all(|length| Parcel::of_bytes(&bytes[..length]).is_err()));
    }
}
