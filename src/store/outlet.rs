//! Logs of other processes, beside the log of the process that keeps a run.
//!
//! If several processes share a disk, each of them writes the rows of the paths that it simulates
//! to a log of its own, so that the rows are not sent as messages. The process that keeps the run
//! saves in its state how much of each log counts, and reads all logs in the order of paths when it
//! writes the file.

use super::folder::{TOKEN, rows_name};
use super::log::Log;
use super::{StoreError, own};
use crate::saved::{Position, read_positions, write_positions};
use crate::stats::BlockResult;
use crate::sums::{Codec as _, Damaged, Reader};
use std::fs::{self, File};
use std::hash::{BuildHasher as _, RandomState};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Where other processes may write their logs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outlet {
    /// The folder `NAME.partial`, with its full path.
    folder: PathBuf,
    /// A random number, which a file in the folder contains too. It distinguishes the folder from
    /// one with the same path on a disk of another machine.
    token: u64,
    /// The number of the log of rank 1. Each time a run is continued it gets new logs, so a process
    /// that is left over from before the interruption writes to none of them.
    first: u64,
}

impl Outlet {
    /// The outlet in this folder. A new token is written to the folder, and new logs are numbered
    /// from `logs`, the number of logs that it has.
    pub fn open(folder: &Path, logs: usize) -> io::Result<Outlet> {
        // The keys of the standard library's hash are random.
        let token = RandomState::new().hash_one(folder);
        own::create(&folder.join(TOKEN))?.write_all(token.to_string().as_bytes())?;
        Ok(Outlet { folder: fs::canonicalize(folder)?, token, first: logs as u64 })
    }

    /// The bytes of the outlet, for another process; `None` if the path of the folder is not UTF-8.
    pub fn to_bytes(&self) -> Option<Vec<u8>> {
        let Outlet { folder, token, first } = self;
        let mut out = Vec::new();
        token.write(&mut out);
        first.write(&mut out);
        out.extend(folder.to_str()?.as_bytes());
        Some(out)
    }

    fn of_bytes(bytes: &[u8]) -> Result<Outlet, Damaged> {
        let mut from = Reader::new(bytes);
        let (mut token, mut first) = (0, 0);
        token.read(&mut from)?;
        first.read(&mut from)?;
        let folder = str::from_utf8(from.take(from.left())?).map_err(|_| Damaged)?;
        Ok(Outlet { folder: folder.into(), token, first })
    }
}

/// The log of a process that simulates for the process that keeps the run.
#[derive(Debug)]
pub struct RankLog {
    log: Log,
    path: PathBuf,
    rank: usize,
    number: u64,
}

impl RankLog {
    /// Create the log of this rank, which is not 0, in the outlet. Returns `None` if the folder of
    /// the outlet is not on a disk that this machine shares.
    pub fn create(outlet: &[u8], rank: usize) -> Result<Option<RankLog>, StoreError> {
        let Ok(Outlet { folder, token, first }) = Outlet::of_bytes(outlet) else { return Ok(None) };
        let there = own::open(&folder.join(TOKEN), File::options().read(true)).and_then(io::read_to_string);
        let is_shared = there.is_ok_and(|there| there == token.to_string());
        if !is_shared {
            return Ok(None);
        }
        let number = first + rank as u64 - 1;
        let path = folder.join(rows_name(number));
        // A crash may have left a log of this number that no saved state contains. It is removed.
        let log = Log::create(&path).map_err(|error| failed(&path, rank, &error))?;
        Ok(Some(RankLog { log, path, rank, number }))
    }

    /// Append the rows of a block. Blocks must be appended in their order.
    pub fn append(&mut self, block: &BlockResult) -> Result<(), StoreError> {
        self.log.append(&block.into()).map_err(|error| failed(&self.path, self.rank, &error))
    }

    /// Write everything to the disk, and return the receipt for the process that keeps the run: the
    /// number of the log, and how much of it counts now.
    pub fn sync(&mut self) -> Result<Vec<u8>, StoreError> {
        let end = self.log.sync().map_err(|error| failed(&self.path, self.rank, &error))?;
        let mut receipt = Vec::new();
        self.number.write(&mut receipt);
        write_positions(&[end], &mut receipt);
        Ok(receipt)
    }
}

fn failed(path: &Path, rank: usize, error: &io::Error) -> StoreError {
    StoreError::RankLog { path: path.to_owned(), rank, cause: error.to_string() }
}

/// The number of a log and how much of it counts, read from a receipt of [`RankLog::sync`].
pub(super) fn read_receipt(receipt: &[u8]) -> Result<(u64, Position), Damaged> {
    let mut from = Reader::new(receipt);
    let mut number = 0;
    number.read(&mut from)?;
    match read_positions(&mut from)?.as_slice() {
        [end] if from.left() == 0 => Ok((number, *end)),
        _ => Err(Damaged),
    }
}
