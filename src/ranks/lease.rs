//! A lease, simulated, and the parcel that goes back with it.

use crate::engine::Portion;
use crate::ensemble::{Delivered, Plan, Stops};
use crate::stats::{Codec as _, Damaged, Reader, RunTotals, Totals};
use crate::store::{self, Question, StoreError};
use std::convert::Infallible;
use std::ops::{ControlFlow, Range};
use std::path::Path;
use std::time::Instant;

/// What becomes of a lease: whose it is, how much of it is done, and what that came to.
#[derive(Debug)]
pub(super) struct Parcel {
    /// The lease.
    pub lease: Range<u64>,
    /// Its first so many blocks are done.
    pub done: u64,
    /// Seconds that they took.
    pub seconds: f64,
    /// Bytes of rows among them.
    pub rows: usize,
    /// Rows and sums of neighbouring blocks.
    stretches: Vec<u8>,
}

/// How a lease is simulated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Manner {
    pub threads: usize,
    /// Blocks whose sums are kept apart: one where the run may end after any of them, all of the
    /// lease otherwise.
    pub grain: u64,
}

/// What a worker is told before its first lease.
pub(super) struct Errand {
    pub question: Question,
    pub manner: Manner,
}

impl Errand {
    /// As bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        (self.manner.threads as u64).write(&mut bytes);
        self.manner.grain.write(&mut bytes);
        bytes.extend(self.question.to_bytes());
        bytes
    }

    /// From bytes. The question of another program is an error.
    pub fn of_bytes(bytes: &[u8]) -> Result<Self, StoreError> {
        let damaged = |_| StoreError::DamagedState { path: "the message of rank 0".into() };
        let mut from = Reader::new(bytes);
        let (threads, grain) = (number(&mut from).map_err(damaged)?, number(&mut from).map_err(damaged)?);
        let rest = from.take(from.left()).map_err(damaged)?;
        let manner = Manner { threads: threads as usize, grain };
        Ok(Errand { question: Question::of_bytes(rest, Path::new("the message of rank 0"))?, manner })
    }
}

/// A lease as bytes.
pub(super) fn to_bytes(lease: &Range<u64>) -> Vec<u8> {
    let mut bytes = Vec::new();
    lease.start.write(&mut bytes);
    lease.end.write(&mut bytes);
    bytes
}

/// A lease from bytes; an empty one where they are none, which comes back empty.
pub(super) fn of_bytes(bytes: &[u8]) -> Range<u64> {
    let mut from = Reader::new(bytes);
    number(&mut from).and_then(|start| Ok(start..number(&mut from)?)).unwrap_or(0..0)
}

/// Simulate a lease, or its first blocks where a stop is raised.
pub(super) fn simulate(plan: &Plan, lease: Range<u64>, manner: Manner, stops: Stops<'_>) -> Parcel {
    let start = Instant::now();
    let empty = RunTotals::empty(plan.model(), plan.timeline());
    let (mut stretches, mut rows) = (Vec::new(), Vec::new());
    let (mut totals, mut first, mut kept) = (empty.clone(), lease.start, 0);
    let mut close = |totals: &mut RunTotals, blocks: Range<u64>, rows: &mut Vec<u8>| {
        kept += rows.len();
        blocks.start.write(&mut stretches);
        blocks.end.write(&mut stretches);
        write_bytes(rows, &mut stretches);
        write_bytes(&totals.to_bytes(), &mut stretches);
        *totals = empty.clone();
        rows.clear();
    };
    let deliver = |Delivered { index, result, .. }: Delivered<()>| -> Result<ControlFlow<()>, Infallible> {
        store::write_block(&result, &mut rows);
        // Every block of a lease comes once.
        let pushed = totals.push(index, result.totals);
        debug_assert!(pushed.is_ok());
        if index + 1 - first == manner.grain {
            close(&mut totals, first..index + 1, &mut rows);
            first = index + 1;
        }
        Ok(ControlFlow::Continue(()))
    };
    let Ok(done) = plan.run_beside(&(), lease.clone(), manner.threads, stops, deliver);
    if first < lease.start + done {
        close(&mut totals, first..lease.start + done, &mut rows);
    }
    Parcel { lease, done, seconds: start.elapsed().as_secs_f64(), rows: kept, stretches }
}

impl Parcel {
    /// As bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Parcel { lease, done, seconds, rows, stretches } = self;
        let mut bytes = Vec::with_capacity(stretches.len() + 64);
        [lease.start, lease.end, *done, *rows as u64].iter().for_each(|number| number.write(&mut bytes));
        seconds.write(&mut bytes);
        write_bytes(stretches, &mut bytes);
        bytes
    }

    /// From bytes.
    pub fn of_bytes(bytes: &[u8]) -> Result<Self, Damaged> {
        let mut from = Reader::new(bytes);
        let (lease, done) = (number(&mut from)?..number(&mut from)?, number(&mut from)?);
        let rows = number(&mut from)? as usize;
        let mut seconds = 0.0;
        seconds.read(&mut from)?;
        Ok(Parcel { lease, done, seconds, rows, stretches: read_bytes(&mut from)?.to_vec() })
    }

    /// What the run is handed, given its empty totals.
    pub fn portions(&self, plan: &Plan) -> Result<Vec<Portion>, Damaged> {
        let empty = RunTotals::empty(plan.model(), plan.timeline());
        // The smallest there are: nobody looks at them.
        let none = Totals::empty(plan.model(), &plan.timeline().without_rows());
        let mut from = Reader::new(&self.stretches);
        let mut portions = Vec::new();
        while from.left() > 0 {
            let blocks = number(&mut from)?..number(&mut from)?;
            let mut rows = Reader::new(read_bytes(&mut from)?);
            let results = blocks.clone().map(|_| store::read_block(&mut rows, &none)).collect::<Result<_, _>>()?;
            let totals = Box::new(empty.clone().read(read_bytes(&mut from)?)?);
            portions.push(Portion::Stretch { blocks, results, totals });
        }
        Ok(portions)
    }
}

fn number(from: &mut Reader<'_>) -> Result<u64, Damaged> {
    let mut number = 0;
    number.read(from).map(|()| number)
}

fn write_bytes(bytes: &[u8], out: &mut Vec<u8>) {
    (bytes.len() as u64).write(out);
    out.extend(bytes);
}

fn read_bytes<'a>(from: &mut Reader<'a>) -> Result<&'a [u8], Damaged> {
    let length = from.length()?;
    from.take(length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;
    use std::sync::atomic::AtomicBool;

    /// Leases of a run that went through bytes, in stretches of any size, have the sums of the run
    /// and its rows.
    #[test]
    fn what_comes_back_has_the_bits_of_the_run() {
        let mut scenario = Scenario::shipped("rho025").expect("shipped");
        scenario.ensemble.paths = 1_500;
        let plan = scenario.plan();
        let never = AtomicBool::new(false);
        let whole = |leases: &[Range<u64>], grain: u64| {
            let mut totals = RunTotals::empty(plan.model(), plan.timeline());
            let mut rows = Vec::new();
            for lease in leases {
                let manner = Manner { threads: 2, grain };
                let parcel = simulate(&plan, lease.clone(), manner, Stops { stop: &never, halt: &never });
                let parcel = Parcel::of_bytes(&parcel.to_bytes()).expect("as written");
                assert_eq!((parcel.lease.clone(), parcel.done), (lease.clone(), lease.end - lease.start));
                for portion in parcel.portions(&plan).expect("as written") {
                    let Portion::Stretch { results, totals: more, .. } = portion else { unreachable!("not sent") };
                    results.iter().for_each(|block| store::write_block(block, &mut rows));
                    totals.merge(*more).expect("each block once");
                }
            }
            (totals.to_bytes(), rows)
        };
        let mut totals = RunTotals::empty(plan.model(), plan.timeline());
        let mut rows = Vec::new();
        for index in 0..plan.blocks() {
            let block = plan.block(index);
            store::write_block(&block, &mut rows);
            totals.push(index, block.totals).expect("each block once");
        }
        let expected = (totals.to_bytes(), rows);
        assert!(whole(&[0..2, 2..6], 6) == expected && whole(&[0..1, 1..4, 4..6], 2) == expected);
        assert!(whole(&[0..4, 4..6], 1) == expected);
        let bytes = simulate(&plan, 0..1, Manner { threads: 1, grain: 1 }, Stops { stop: &never, halt: &never });
        let bytes = bytes.to_bytes();
        assert!((0..bytes.len()).all(|length| Parcel::of_bytes(&bytes[..length]).is_err()));
    }
}
