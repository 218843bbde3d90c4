//! Copies of the counts of a rank, and of the receipts for its log, as they were at the end of each
//! lease.
//!
//! Counts contain quantile sketches, which are large and take long to create. A rank therefore
//! keeps one set of counts for the whole run, and sends it to rank 0 only when the run may be
//! saved. Rank 0 asks for the counts of the blocks before a certain block when the rank has already
//! simulated later blocks, so the rank needs the copy that it made at that block.

use super::message::{read_bytes, write_bytes};
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};
use stick_slip::stats::Counts;
use stick_slip::sums::{Codec as _, Damaged, Reader};

/// The copies. They are shared by the thread that simulates leases and the thread that receives
/// messages.
#[derive(Debug, Default)]
pub(super) struct Snapshots(Mutex<VecDeque<Snapshot>>);

#[derive(Debug)]
struct Snapshot {
    /// The number of the block after the last one that is counted.
    end: u64,
    counted: Counted,
}

/// What a rank has done of the blocks before a certain block.
#[derive(Clone, Debug)]
pub(super) struct Counted {
    pub counts: Counts,
    /// The receipt for the rows of these blocks if they are in a log of this rank, and otherwise
    /// empty.
    pub receipt: Vec<u8>,
}

impl Snapshots {
    /// Keep what the rank has done before block `end`. A rank receives leases in the order of their
    /// blocks, so `end` grows from call to call.
    pub fn add(&self, end: u64, counted: Counted) {
        self.lock().push_back(Snapshot { end, counted });
    }

    /// What the rank has done before block `end`, which is the end of a lease. Returns `None` if it
    /// has done none of these blocks. Older copies are dropped, so a later call must not ask for a
    /// smaller `end`.
    pub fn before(&self, end: u64) -> Option<Counted> {
        let mut snapshots = self.lock();
        let later = snapshots.partition_point(|snapshot| snapshot.end <= end);
        snapshots.drain(..later.saturating_sub(1));
        snapshots.front().filter(|snapshot| snapshot.end <= end).map(|snapshot| snapshot.counted.clone())
    }

    fn lock(&self) -> MutexGuard<'_, VecDeque<Snapshot>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Counted {
    /// The bytes of the message.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_bytes(&self.receipt, &mut bytes);
        self.counts.write(&mut bytes);
        bytes
    }

    /// Read the bytes of the message into `counts`, which are the empty counts of the run.
    pub fn of_bytes(bytes: &[u8], mut counts: Counts) -> Result<Counted, Damaged> {
        let mut from = Reader::new(bytes);
        let receipt = read_bytes(&mut from)?.to_vec();
        counts.read(&mut from)?;
        Ok(Counted { counts, receipt })
    }
}
