//! Whether somebody vouches for a file.

use super::reader::check_is_hdf5;
use super::{StoreError, seal};
use std::path::Path;

/// Whether a file has a checksum, right or wrong; its readers compare it. A file that another
/// program has changed has none. A file that is not an HDF5 file is an error.
pub fn is_sealed(path: &Path) -> Result<bool, StoreError> {
    check_is_hdf5(path)?;
    seal::is_there(path).map_err(|source| StoreError::NotOpened { path: path.to_owned(), source })
}
