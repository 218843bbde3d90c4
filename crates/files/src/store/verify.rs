//! Comparing a finished file with what is computed again ([`crate::saved::Again`]). What it is
//! compared with depends on what can be repeated:
//!
//! ```text
//! run           rows of blocks that are simulated again; after all of them, every statistic
//! sweep         points that are simulated again
//! calibration   the fit to the record that is in the file
//! trade         what follows from its measurements; times cannot be measured twice
//! ```

use super::StoreError;
use super::error::not_opened;
use super::reader::{check_file, check_seal, damaged, open};
use crate::dataset::{Dataset, StoredRun};
use crate::saved::{Again, Against, BlocksAgain, Difference, again};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use stickslip::scenario::Scenario;

/// Compare the file of a run with what this scenario gives.
pub fn verify_run(
    path: &Path,
    stored: &StoredRun,
    scenario: &Scenario,
    sample: BlocksAgain,
    threads: usize,
) -> Result<Again, StoreError> {
    again(
        &open(path)?,
        stored,
        scenario,
        sample,
        threads,
        &AtomicBool::new(false),
    )
    .map_err(damaged(path))
}

/// What the comparison of a whole data set came to.
#[derive(Clone, Debug)]
pub struct Verified {
    /// Number of values and texts that were compared.
    pub values: u64,
    /// The first difference, if there is one.
    pub difference: Option<Difference>,
}

/// Compare the file of a sweep, a trade or a calibration with this data set.
pub fn verify_whole(path: &Path, again: &Dataset) -> Result<Verified, StoreError> {
    let file = open(path)?;
    let mut against = Against::of(&file);
    against
        .variables(again)
        .and_then(|()| against.finish(again))
        .map_err(damaged(path))?;
    Ok(Verified {
        values: against.values,
        difference: against.difference,
    })
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
