//! Whether a file that has its name is whole.

use super::{FileKind, StoreError, kind, read_calibration, read_sweep, read_trade, reader, seal};
use std::path::Path;

/// Check that there is a finished file of this name: every byte is that of its seal, and it can be
/// read. Whether a file without a seal was changed cannot be known.
pub(super) fn check_finished(target: &Path) -> Result<(), StoreError> {
    reader::check_file(target)?;
    seal::check_all(target)?;
    match kind(target)? {
        Some(FileKind::Run) => reader::read(target).map(drop),
        Some(FileKind::Sweep) => read_sweep(target).map(drop),
        Some(FileKind::Calibration) => read_calibration(target).map(drop),
        Some(FileKind::Trade) => read_trade(target).map(drop),
        None => Err(StoreError::NotHdf5 { path: target.to_owned() }),
    }
}
