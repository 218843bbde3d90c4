//! Why a file could not be written.

use super::error::{cause, is_full, system_error};
use std::io;

/// Why a file could not be written.
#[derive(Clone, Debug)]
pub(super) struct WriteFailure {
    /// What the system or HDF5 says.
    pub cause: String,
    /// Whether there was no room left.
    pub full: bool,
}

impl From<hdf5::Error> for WriteFailure {
    fn from(error: hdf5::Error) -> Self {
        WriteFailure {
            cause: cause(&error),
            full: system_error(&error).is_some_and(|system| is_full(&system)),
        }
    }
}

impl From<io::Error> for WriteFailure {
    fn from(error: io::Error) -> Self {
        WriteFailure {
            full: is_full(&error),
            cause: error.to_string(),
        }
    }
}
