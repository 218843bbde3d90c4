//! Whether a disk has room for a run.

use super::StoreError;
use std::path::Path;

/// Check that the disk of a folder has room for this number of bytes. This is done before a long run, so
/// that it does not fail at its end.
pub fn check_space(folder: &Path, needed: u64) -> Result<(), StoreError> {
    // The folder of a bare file name is the empty path.
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let disk = rustix::fs::statvfs(folder).map_err(|error| StoreError::Space {
        folder: folder.to_owned(),
        source: error.into(),
    })?;
    let free = disk.f_bavail.saturating_mul(disk.f_frsize);
    // Some file systems do not know their size and report zero blocks in total.
    if disk.f_blocks > 0 && free < needed {
        return Err(StoreError::TooLittleSpace {
            folder: folder.to_owned(),
            needed,
            free,
        });
    }
    Ok(())
}
