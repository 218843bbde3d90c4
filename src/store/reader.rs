//! Reading a finished file back.

use super::error::{cause, system_error};
use super::variable::{read_or_empty, read_text};
use super::{FORMAT_NAME, FORMAT_VERSION, SWEEP_FORMAT_NAME, StoreError, TRADE_FORMAT_NAME, header, layout, summary};
use crate::engine::Status;
use crate::provenance::Provenance;
use crate::stats::Summary;
use hdf5::File;
use std::io::{self, Read};
use std::path::Path;

/// What a finished file says.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored {
    /// Where its numbers come from.
    pub header: Provenance,
    /// How the run ended.
    pub status: Status,
    /// What ended it before its last path, if it was asked to end.
    pub ended_by: Option<String>,
    /// Paths in the file.
    pub completed_paths: u64,
    /// Its statistics.
    pub summary: Summary,
}

/// What a file of this program holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// An ensemble.
    Run,
    /// What accuracy costs.
    Trade,
    /// Statistics as functions of keys.
    Sweep,
}

/// What a file holds; none where it is no HDF5 file.
pub fn kind(path: &Path) -> Result<Option<FileKind>, StoreError> {
    match check_signature(path) {
        Err(StoreError::NotHdf5 { .. } | StoreError::NotOpened { .. }) => return Ok(None),
        other => other?,
    }
    let file = open(path)?;
    match read_text(&file, "format_name").unwrap_or_default().as_str() {
        FORMAT_NAME => Ok(Some(FileKind::Run)),
        TRADE_FORMAT_NAME => Ok(Some(FileKind::Trade)),
        SWEEP_FORMAT_NAME => Ok(Some(FileKind::Sweep)),
        _ => Err(StoreError::Foreign { path: path.to_owned() }),
    }
}

/// The first bytes of every HDF5 file.
const SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";

/// Read the header and the statistics of a finished file.
pub fn read(path: &Path) -> Result<Stored, StoreError> {
    check_signature(path)?;
    let file = open(path)?;
    match header::format_version(&file) {
        None => return Err(StoreError::Foreign { path: path.to_owned() }),
        Some((major, minor)) if major > FORMAT_VERSION.0 => {
            return Err(StoreError::Newer { path: path.to_owned(), major, minor });
        }
        Some(_) => {}
    }
    let damaged = |error: hdf5::Error| StoreError::Damaged { path: path.to_owned(), cause: cause(&error) };
    let (status, completed_paths) = header::progress(&file).map_err(damaged)?;
    let header = read_or_empty(&file, &layout::TIME).and_then(|time| header::read(&file, time)).map_err(damaged)?;
    if status == Status::Running {
        return Err(StoreError::Unfinished { path: path.to_owned(), completed_paths, paths: header.paths });
    }
    let summary = summary::read(&file, completed_paths, header.step).map_err(damaged)?;
    let ended_by = header::ended_by(&file).map_err(damaged)?;
    Ok(Stored { header, status, ended_by, completed_paths, summary })
}

/// HDF5 has one answer for a missing, an unreadable and a foreign file; so look first.
pub(super) fn check_signature(path: &Path) -> Result<(), StoreError> {
    let not_opened = |source| StoreError::NotOpened { path: path.to_owned(), source };
    let mut start = [0; SIGNATURE.len()];
    match std::fs::File::open(path).map_err(not_opened)?.read_exact(&mut start) {
        Ok(()) if start == SIGNATURE => Ok(()),
        Ok(()) => Err(StoreError::NotHdf5 { path: path.to_owned() }),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
            Err(StoreError::NotHdf5 { path: path.to_owned() })
        }
        Err(error) => Err(not_opened(error)),
    }
}

pub(super) fn open(path: &Path) -> Result<File, StoreError> {
    File::open(path).map_err(|error| match system_error(&error) {
        Some(system) if system.kind() == io::ErrorKind::WouldBlock => StoreError::InUse { path: path.to_owned() },
        Some(system) => StoreError::NotOpened { path: path.to_owned(), source: system },
        None => StoreError::Damaged { path: path.to_owned(), cause: cause(&error) },
    })
}
