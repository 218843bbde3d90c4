//! Whether a file that has its name is whole.

use super::{StoreError, kind, reader, seal};
use std::path::Path;

/// Check that there is a finished file of this name: every byte is that of its seal, and it can be
/// read. Whether a file without a seal was changed cannot be known.
pub(super) fn check_finished(target: &Path) -> Result<(), StoreError> {
    reader::check_file(target)?;
    seal::check_all(target)?;
    let kind = kind(target)?.ok_or_else(|| StoreError::NotHdf5 { path: target.to_owned() })?;
    kind.read(target).map(drop)
}
