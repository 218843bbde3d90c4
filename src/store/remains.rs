//! What should have been removed after the work and is still there, for a warning. The work itself
//! is done then, so it is no error.

use std::io;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

static REMAINS: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Note that this could not be removed.
pub(super) fn stays(path: &Path, error: &io::Error) {
    let line = format!("{} stays, because it cannot be removed: {error}; remove it yourself", path.display());
    REMAINS.lock().unwrap_or_else(PoisonError::into_inner).push(line);
}

/// What this process has left behind so far, in sentences. Each is returned once.
pub fn take_remains() -> Vec<String> {
    std::mem::take(&mut *REMAINS.lock().unwrap_or_else(PoisonError::into_inner))
}
