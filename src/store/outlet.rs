//! Logs of other processes beside that of the process that keeps a run.
//!
//! Several processes that share a disk write the rows of the paths that they simulate into logs of
//! their own, so that the rows do not go through messages. The process that keeps the run counts
//! the logs in its state, and reads all of them in the order of paths when it writes the file.

use super::StoreError;
use super::log::{Log, Position};
use super::state::{read_positions, write_positions};
use super::workshop::{TOKEN, rows_name};
use crate::stats::{BlockResult, Codec as _, Damaged, Reader};
use std::fs;
use std::hash::{BuildHasher as _, RandomState};
use std::io;
use std::path::{Path, PathBuf};

/// Where other processes may write their logs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outlet {
    /// The folder `NAME.partial`, with its full path.
    folder: PathBuf,
    /// What a file in it says, so that a folder of the same name on another disk is not taken for
    /// it.
    token: u64,
    /// The number of the log of rank 1. Every sitting of a run has logs of its own, so that a process
    /// that has outlived an earlier sitting writes to none of them.
    first: u64,
}

impl Outlet {
    /// In this folder, which is given a new token, and in which so many logs are.
    pub fn open(folder: &Path, logs: usize) -> io::Result<Outlet> {
        // The keys of the standard library's hash are random.
        let token = RandomState::new().hash_one(folder);
        fs::write(folder.join(TOKEN), token.to_string())?;
        Ok(Outlet { folder: fs::canonicalize(folder)?, token, first: logs as u64 })
    }

    /// As bytes, for another process. There are none where the path of the folder is not UTF-8.
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

/// The log of a process that simulates for another one.
#[derive(Debug)]
pub struct RankLog {
    log: Log,
    path: PathBuf,
    rank: usize,
    number: u64,
}

impl RankLog {
    /// The log of this rank, which is not 0, where the outlet says. There is none if that folder is
    /// not on a disk of this machine.
    pub fn create(outlet: &[u8], rank: usize) -> Result<Option<RankLog>, StoreError> {
        let Ok(Outlet { folder, token, first }) = Outlet::of_bytes(outlet) else { return Ok(None) };
        let is_shared = fs::read_to_string(folder.join(TOKEN)).is_ok_and(|there| there == token.to_string());
        if !is_shared {
            return Ok(None);
        }
        let number = first + rank as u64 - 1;
        let path = folder.join(rows_name(number));
        // A crash may have left a log of this number that does not count.
        let log = remove(&path).and_then(|()| Log::create(&path)).map_err(|error| failed(&path, rank, &error))?;
        Ok(Some(RankLog { log, path, rank, number }))
    }

    /// Append the rows of a block. Blocks come in their order.
    pub fn append(&mut self, block: &BlockResult) -> Result<(), StoreError> {
        self.log.append(&block.into()).map_err(|error| failed(&self.path, self.rank, &error))
    }

    /// Bring everything to the disk. Returns how much of the log counts now, for the process that
    /// keeps the run.
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

/// The number of a log and how much of it counts, from what [`RankLog::sync`] has returned.
pub(super) fn read_receipt(receipt: &[u8]) -> Result<(u64, Position), Damaged> {
    let mut from = Reader::new(receipt);
    let mut number = 0;
    number.read(&mut from)?;
    match read_positions(&mut from)?.as_slice() {
        [end] if from.left() == 0 => Ok((number, *end)),
        _ => Err(Damaged),
    }
}

fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}
