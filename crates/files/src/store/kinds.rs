//! Reads files of results: the format, which identifies the kind, and the contents.

use super::StoreError;
use super::errors::{cause, not_opened, system_error};
use super::lock::Lock;
use super::log::read_state;
use super::staging::{POINTS, STATE, file_of, partial_path};
use super::variables::Contents;
use crate::saved::checksum::{self, superblock};
use crate::saved::{Verified, compare};
use hdf5::File;
use std::io;
use std::path::{Path, PathBuf};
use stickslip::dataset::header::{FORMAT, Format};
use stickslip::dataset::sweep::{self, SWEEP_FORMAT};
use stickslip::dataset::trade::{self, TRADE_FORMAT};
use stickslip::dataset::{
    Column, Dataset, ElementType, Source, StoredRun as Stored, StoredSweep, StoredTrade, layout,
    read_attribute,
};
use stickslip::engine::Status;
use stickslip::stats::PathColumns;
use stickslip::stats::column::Columns as _;

/// Files larger than this, in bytes, are opened without checking the checksum first, which would
/// take minutes.
const LARGEST: u64 = 1 << 30;

/// The target of an unfinished run, if there is one. `path` is either the target itself or the
/// folder in which the run is saved.
pub(super) fn unfinished_run(path: &Path) -> Option<PathBuf> {
    let target = if path.is_dir() {
        file_of(path)
    } else {
        path.to_owned()
    };
    let is_saved = (path.is_dir() || !path.exists()) && partial_path(&target).join(STATE).exists();
    is_saved.then_some(target)
}

/// Read the state of an unfinished run, given its target.
fn read_unfinished(target: &Path) -> Result<Stored, StoreError> {
    let state = read_state(&partial_path(target).join(STATE))?;
    let (header, completed_paths, part) =
        (state.header(), state.paths(), state.question.asked.part);
    let status = if Lock::is_taken(target) {
        Status::Running
    } else {
        Status::Interrupted
    };
    let summary = state.so_far.totals.totals().summary();
    let unfinished = Some(target.to_owned()).filter(|_| status != Status::Running);
    Ok(Stored {
        header,
        status,
        part,
        ended_by: None,
        unfinished,
        completed_paths,
        summary,
    })
}

/// Read the header and the statistics of a finished file, or of a run that is not finished.
pub fn read(path: &Path) -> Result<Stored, StoreError> {
    if let Some(target) = unfinished_run(path) {
        return read_unfinished(&target);
    }
    read_kind(path, FORMAT, Stored::read)
}

/// The file to read: the points of a sweep, given the folder that holds them.
fn located(path: &Path) -> PathBuf {
    let points = path.join(POINTS);
    if points.is_file() {
        points
    } else {
        path.to_owned()
    }
}

/// Check a file before the HDF5 library opens it, and return whether it has a checksum. The library
/// gives the same error for a missing, an unreadable and a foreign file, and it follows corrupted
/// addresses.
pub(super) fn check_file(path: &Path) -> Result<bool, StoreError> {
    check_is_hdf5(path)?;
    check_checksum(path, LARGEST)
}

/// Compare a file with its checksum, and return whether it has one. A wrong one is an error. In
/// larger files it is found but not computed.
pub(super) fn check_checksum(path: &Path, largest: u64) -> Result<bool, StoreError> {
    let found = checksum::is_right(path, largest);
    match found.map_err(not_opened(path))? {
        Some(false) => Err(damaged(path)(
            "its checksum does not match its contents".to_string(),
        )),
        found => Ok(found.is_some()),
    }
}

/// Check that a file begins as HDF5 files do.
pub(super) fn check_is_hdf5(path: &Path) -> Result<(), StoreError> {
    // Opening a pipe would wait for its other end.
    if std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir()) {
        return Err(StoreError::NotHdf5 {
            path: path.to_owned(),
        });
    }
    let mut file = std::fs::File::open(path).map_err(not_opened(path))?;
    match superblock(&mut file).map_err(not_opened(path))? {
        Some(_) => Ok(()),
        None => Err(StoreError::NotHdf5 {
            path: path.to_owned(),
        }),
    }
}

/// Whether a file has a checksum, right or wrong; its readers compare it. A file that another
/// program has changed has none. A file that is not an HDF5 file is an error.
pub fn has_checksum(path: &Path) -> Result<bool, StoreError> {
    let path = &located(path);
    check_is_hdf5(path)?;
    checksum::is_there(path).map_err(not_opened(path))
}

/// Read a file of the kind and the format of this name and version. A file of another kind, of
/// another format, or a damaged one, is an error.
pub fn read_kind<T>(
    path: &Path,
    (name, (reads, _)): Format,
    read: impl FnOnce(&dyn Source) -> Result<T, String>,
) -> Result<T, StoreError> {
    let path = &located(path);
    check_file(path)?;
    let file = open(path)?;
    if read_attribute::<String>(&file, "format_name")
        .ok()
        .as_deref()
        != Some(name)
    {
        return Err(StoreError::Foreign {
            path: path.to_owned(),
        });
    }
    let version: String = read_attribute(&file, "format_version").map_err(damaged(path))?;
    let parts = version
        .split_once('.')
        .and_then(|(major, minor)| Some((major.parse().ok()?, minor.parse().ok()?)));
    let (major, minor) = parts.unwrap_or((u32::MAX, 0));
    if major != reads {
        return Err(StoreError::OtherFormat {
            path: path.to_owned(),
            major,
            minor,
            reads,
        });
    }
    read(&file).map_err(damaged(path))
}

/// The error of a file that could not be read.
pub(super) fn damaged(path: &Path) -> impl Fn(String) -> StoreError + Copy {
    move |cause| StoreError::Damaged {
        path: path.to_owned(),
        cause,
    }
}

pub(super) fn open(path: &Path) -> Result<Contents, StoreError> {
    File::open(path)
        .map(Contents)
        .map_err(|error| match system_error(&error) {
            Some(system) if system.kind() == io::ErrorKind::WouldBlock => StoreError::InUse {
                path: path.to_owned(),
            },
            Some(system) => not_opened(path)(system),
            None => damaged(path)(cause(&error)),
        })
}

/// Prefix of the names of all formats of this program.
const PROGRAM: &str = "stick-slip ";

/// Read the file of a trade. A file of another kind, of another format, or a damaged one, is an
/// error.
pub fn read_trade(path: &Path) -> Result<StoredTrade, StoreError> {
    read_kind(path, TRADE_FORMAT, trade::read)
}

/// Read the file of a sweep. A file of another kind, of another format, or a damaged one, is an
/// error.
pub fn read_sweep(path: &Path) -> Result<StoredSweep, StoreError> {
    read_kind(path, SWEEP_FORMAT, sweep::read)
}

/// Check that there is a finished file of this name: every byte is what was written, and it can be
/// read. A changed file without a checksum is not detected.
pub(super) fn check_finished(target: &Path) -> Result<(), StoreError> {
    check_file(target)?;
    check_checksum(target, u64::MAX)?;
    match format(target)?.as_deref() {
        None => Err(StoreError::NotHdf5 {
            path: target.to_owned(),
        }),
        Some(name) if name == TRADE_FORMAT.0 => read_trade(target).map(drop),
        Some(name) if name == SWEEP_FORMAT.0 => read_sweep(target).map(drop),
        Some(name) if name == FORMAT.0 => read(target).map(drop),
        Some(_) => Ok(()),
    }
}

/// The name of the format of a file, which says what kind of result it holds; that of a run if one
/// is not finished. `None` if the file cannot be opened or is not an HDF5 file. An HDF5 file of
/// another program is an error, and so is a damaged one.
pub fn format(path: &Path) -> Result<Option<String>, StoreError> {
    if unfinished_run(path).is_some() {
        return Ok(Some(FORMAT.0.to_owned()));
    }
    let path = &located(path);
    match check_file(path) {
        Err(StoreError::NotHdf5 { .. } | StoreError::NotOpened { .. }) => return Ok(None),
        other => other?,
    };
    let name: String = read_attribute(&open(path)?, "format_name").unwrap_or_default();
    match name.starts_with(PROGRAM) {
        true => Ok(Some(name)),
        false => Err(StoreError::Foreign {
            path: path.to_owned(),
        }),
    }
}

/// The scalars of one path from the file of a run; `None` if the file does not record paths, or not
/// this one.
pub fn read_path(path: &Path, number: u64) -> std::result::Result<Option<PathColumns>, StoreError> {
    read_kind(path, FORMAT, |file| {
        if !file.has(PathColumns::VARIABLES[0].0.name) {
            return Ok(None);
        }
        let paths = file.length(layout::PATH.name)?.unwrap_or(0);
        let Column::U64(first) = file.rows(layout::PATH.name, ElementType::U64, &(0..1))? else {
            return Ok(None);
        };
        let row = number
            .checked_sub(first[0])
            .and_then(|row| usize::try_from(row).ok())
            .filter(|row| *row < paths);
        let read = |row| {
            PathColumns::read(|variable, kind| file.rows(variable.name, kind, &(row..row + 1)))
        };
        row.map(read).transpose()
    })
}

/// Compare a file with a data set that was computed again.
pub fn verify(path: &Path, again: &Dataset) -> Result<Verified, StoreError> {
    compare(&open(path)?, again).map_err(damaged(path))
}

/// The result of checking a file against its checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CheckedBytes {
    /// Size of the file in bytes.
    pub bytes: u64,
    /// Whether the file has a checksum, which is then right. It has none if another program has
    /// changed the file.
    pub has_checksum: bool,
}

/// Check all bytes of a file against its checksum, however large the file is. A wrong checksum is
/// an error.
pub fn check_bytes(path: &Path) -> Result<CheckedBytes, StoreError> {
    let path = &located(path);
    check_file(path)?;
    let has_checksum = check_checksum(path, u64::MAX)?;
    let there = std::fs::metadata(path).map_err(not_opened(path))?;
    Ok(CheckedBytes {
        bytes: there.len(),
        has_checksum,
    })
}
