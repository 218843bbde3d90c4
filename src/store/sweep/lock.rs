//! One process at a time writes a sweep: an advisory lock on `NAME.lock`, which the system drops when the process ends, however it ends.

use super::StoreError;
use std::fs::{File, TryLockError};
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

/// The right to write a file. The lock file goes with it.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// Take it, unless another process has it.
    pub fn take(target: &Path) -> Result<Lock, StoreError> {
        let mut name = target.as_os_str().to_owned();
        name.push(".lock");
        let path = PathBuf::from(name);
        loop {
            let file = File::options().create(true).truncate(false).write(true).open(&path);
            let not_created =
                |error: std::io::Error| StoreError::NotCreated { partial: path.clone(), cause: error.to_string() };
            let file = file.map_err(not_created)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(StoreError::Busy { path: target.to_owned() }),
                Err(TryLockError::Error(error)) => return Err(not_created(error)),
            }
            // Whoever had it may have removed it between our opening and our locking it: then a lock on it says nothing.
            let here = file.metadata().map_err(not_created)?;
            if std::fs::metadata(&path).is_ok_and(|there| (there.dev(), there.ino()) == (here.dev(), here.ino())) {
                return Ok(Lock { path, _file: file });
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // An empty file that is left takes nobody's right.
        let _ = std::fs::remove_file(&self.path);
    }
}
