//! Files of each kind, and the format that tells kinds apart.

use super::StoreError;
use super::reader::{check_file, check_seal, open, read, read_kind, unfinished};
use crate::dataset::header::FORMAT;
use crate::dataset::sweep::{self, SWEEP_FORMAT};
use crate::dataset::trade::{self, TRADE_FORMAT};
use crate::dataset::{StoredSweep, StoredTrade, read_attribute};
use std::path::Path;

/// What the names of all formats of this program begin with.
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

/// Check that there is a finished file of this name: every byte is that of its seal, and it can be
/// read. Whether a file without a seal was changed cannot be known.
pub(super) fn check_finished(target: &Path) -> Result<(), StoreError> {
    check_file(target)?;
    check_seal(target, u64::MAX)?;
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
    if unfinished(path).is_some() {
        return Ok(Some(FORMAT.0.to_owned()));
    }
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
