//! What should have been removed after the work and is still there, for a warning. The work itself
//! is done then, so this is not an error.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

static REMAINS: Mutex<Vec<(PathBuf, String)>> = Mutex::new(Vec::new());

/// Note that this could not be removed.
pub(super) fn stays(path: &Path, error: &io::Error) {
    REMAINS
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .push((path.to_owned(), error.to_string()));
}

/// What this process has left behind so far, in sentences. Each is returned once.
pub fn take_leftovers() -> Vec<String> {
    let mut remains = std::mem::take(&mut *REMAINS.lock().unwrap_or_else(PoisonError::into_inner));
    // A second attempt may have removed it.
    remains.retain(|(path, _)| path.symlink_metadata().is_ok());
    let line = |(path, error): (PathBuf, String)| {
        format!(
            "cannot remove {}: {error}; remove it by hand",
            path.display()
        )
    };
    remains.into_iter().map(line).collect()
}
