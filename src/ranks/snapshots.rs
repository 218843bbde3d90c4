//! The counts of a rank, and how much of its log counts, as they were at the end of each of its
//! leases.
//!
//! Counts hold quantile sketches, which take long to begin and are large: a rank therefore keeps
//! one set of them for the whole run, and gives it to rank 0 only where the run may be saved. It is
//! then asked for the counts of its blocks before a certain one, while it is already beyond that
//! block, and has the copy that it made there.

use super::message::{read_bytes, write_bytes};
use crate::stats::{Codec as _, Counts, Damaged, Reader};
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Shared by the thread that simulates leases and the one that hears messages.
#[derive(Debug, Default)]
pub(super) struct Snapshots(Mutex<VecDeque<Snapshot>>);

#[derive(Debug)]
struct Snapshot {
    /// The block after the last one that is counted.
    end: u64,
    counted: Counted,
}

/// What a rank has done of the blocks before a certain one.
#[derive(Clone, Debug)]
pub(super) struct Counted {
    pub counts: Counts,
    /// The receipt for the rows of these blocks, where they are in a log of the rank's own.
    pub receipt: Vec<u8>,
}

impl Snapshots {
    /// This is what the rank has done before block `end`. A rank is given leases in the order of
    /// their blocks.
    pub fn add(&self, end: u64, counted: Counted) {
        self.lock().push_back(Snapshot { end, counted });
    }

    /// What it has done before block `end`, where a lease ends; none if it has done none of these
    /// blocks. Nobody asks for an earlier end later.
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
    /// As bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_bytes(&self.receipt, &mut bytes);
        self.counts.write(&mut bytes);
        bytes
    }

    /// From bytes, given the empty counts of the run.
    pub fn of_bytes(bytes: &[u8], mut counts: Counts) -> Result<Counted, Damaged> {
        let mut from = Reader::new(bytes);
        let receipt = read_bytes(&mut from)?.to_vec();
        counts.read(&mut from)?;
        Ok(Counted { counts, receipt })
    }
}
