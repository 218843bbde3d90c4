//! Comparing a finished file with what its scenario gives when it is computed again.
//!
//! A data set is written by the same functions as always, but to a destination that compares
//! instead. Every variable and attribute that would be written must be in the file, bit for bit,
//! and nothing else may be there. What a file is compared with depends on what can be repeated:
//!
//! ```text
//! run           rows of blocks that are simulated again; after all of them, every statistic
//! sweep         points that are simulated again
//! calibration   the fit to the record that is in the file
//! trade         what follows from its measurements; times cannot be measured twice
//! ```
//!
//! Everything that is not simulated again is compared with what is derived from the rest of the
//! file, so that a number that was changed does not go with the others.

mod against;
mod run;
mod studies;

pub use run::{Expected, Verification};
pub use studies::{Verified, verify_calibration, verify_sweep, verify_trade};

use super::reader::check_file;
use super::{StoreError, seal};
use std::fmt;
use std::path::Path;

/// The first value in a file that differs from what its scenario gives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The variable or attribute of the file.
    pub variable: String,
    /// The number of the path, if the variable holds rows of single paths.
    pub path: Option<u64>,
    /// The index of the value, from 0, among the values of the path or else of the variable; none
    /// for an attribute, and for a variable as a whole.
    pub index: Option<usize>,
    /// The value in the file.
    pub stored: String,
    /// The value that the scenario gives.
    pub computed: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Difference { variable, path, index, stored, computed } = self;
        match (path, index) {
            (Some(path), Some(index)) if *index > 0 => {
                write!(f, "path {path}: {variable}, value {index} of the path,")?
            }
            (Some(path), _) => write!(f, "path {path}: {variable}")?,
            (None, Some(index)) => write!(f, "{variable}, value {index},")?,
            (None, None) => f.write_str(variable)?,
        }
        write!(f, " is {stored} in the file, and {computed} when it is computed again")
    }
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
    let has_checksum = seal::check_all(path)?;
    let there = std::fs::metadata(path).map_err(|source| StoreError::NotOpened { path: path.to_owned(), source })?;
    Ok(Sealed { bytes: there.len(), has_checksum })
}
