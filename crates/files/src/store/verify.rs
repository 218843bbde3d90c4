//! Checking a finished file: against its checksum, and against what is computed again.
//!
//! ```text
//! run     simulated again
//! sweep   points that are simulated again
//! trade   what follows from its measurements; times cannot be measured twice
//! ```

use super::StoreError;
use super::error::not_opened;
use super::reader::{check_file, check_seal, damaged, open};
use crate::dataset::Dataset;
use crate::saved::{Verified, compare};
use std::path::Path;

/// Compare a file with a data set that was computed again.
pub fn verify(path: &Path, again: &Dataset) -> Result<Verified, StoreError> {
    compare(&open(path)?, again).map_err(damaged(path))
}

/// The result of checking a file against its checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sealed {
    /// Size of the file in bytes.
    pub bytes: u64,
    /// Whether the file has a checksum, which is then right. It has none if another program has
    /// changed the file.
    pub has_checksum: bool,
}

/// Check all bytes of a file against its checksum, however large the file is. A wrong checksum is
/// an error.
pub fn check_bytes(path: &Path) -> Result<Sealed, StoreError> {
    check_file(path)?;
    let has_checksum = check_seal(path, u64::MAX)?;
    let there = std::fs::metadata(path).map_err(not_opened(path))?;
    Ok(Sealed {
        bytes: there.len(),
        has_checksum,
    })
}
