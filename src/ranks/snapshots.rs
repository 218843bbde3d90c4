//! The counts of a rank as they were at the end of each of its leases.
//!
//! Counts hold quantile sketches, which take long to begin and are large: a rank therefore keeps
//! one set of them for the whole run, and gives it to rank 0 only where the run may be saved. It is
//! then asked for the counts of its blocks before a certain one, while it is already beyond that
//! block, and has the copy that it made there.

use crate::stats::Counts;
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Shared by the thread that simulates leases and the one that hears messages.
#[derive(Debug, Default)]
pub(super) struct Snapshots(Mutex<VecDeque<Snapshot>>);

#[derive(Debug)]
struct Snapshot {
    /// The block after the last one that is counted.
    end: u64,
    counts: Counts,
}

impl Snapshots {
    /// These are the counts of all blocks of this rank before `end`. A rank is given leases in the
    /// order of their blocks.
    pub fn add(&self, end: u64, counts: &Counts) {
        self.lock().push_back(Snapshot { end, counts: counts.clone() });
    }

    /// The counts of the blocks of this rank before `end`, where a lease ends; none if it has done
    /// none of them. Nobody asks for an earlier end later.
    pub fn before(&self, end: u64) -> Option<Counts> {
        let mut snapshots = self.lock();
        let later = snapshots.partition_point(|snapshot| snapshot.end <= end);
        snapshots.drain(..later.saturating_sub(1));
        snapshots.front().filter(|snapshot| snapshot.end <= end).map(|snapshot| snapshot.counts.clone())
    }

    fn lock(&self) -> MutexGuard<'_, VecDeque<Snapshot>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
