//! The file with the saved state of a run.

use super::error::not_opened;
use super::{StoreError, own};
use crate::saved::{MAGIC, State, of_bytes};
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

/// Size limit in bytes; a larger file is reported as damaged without being read. The largest state,
/// with 100 000 rows of the output grid, is smaller.
const LARGEST: u64 = 1 << 31;

/// Whether a file begins as only states of this program do, damaged or not.
pub(super) fn has_mark(path: &Path) -> bool {
    let mut bytes = [0; MAGIC.len()];
    let read = own::open(path, File::options().read(true))
        .and_then(|mut file| file.read_exact(&mut bytes));
    read.is_ok() && bytes == *MAGIC
}

/// Read the state of a run from a file.
pub(super) fn read(path: &Path) -> Result<State, StoreError> {
    let mut file = own::open(path, File::options().read(true)).map_err(not_opened(path))?;
    let mut bytes = Vec::new();
    if file.metadata().map_err(not_opened(path))?.len() <= LARGEST {
        file.by_ref()
            .take(MAGIC.len() as u64)
            .read_to_end(&mut bytes)
            .map_err(not_opened(path))?;
        // A file with other first bytes is not a state, so the rest of it is not read.
        if bytes == MAGIC {
            file.take(LARGEST)
                .read_to_end(&mut bytes)
                .map_err(not_opened(path))?;
        }
    }
    Ok(of_bytes(&bytes, path)?)
}
