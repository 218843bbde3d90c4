//! One process at a time makes a file: an advisory lock on `NAME.lock`, which the system drops when
//! the process ends, however it ends.
//!
//! HDF5 has a lock of its own, which is commonly switched off where the file system is shared by
//! many machines.

use super::StoreError;
use std::fs::{File, TryLockError};
use std::io;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

/// Somebody who only asks whether the lock is taken has it for an instant: so often it is tried
/// again.
const TRIES: u32 = 5;
const PAUSE: Duration = Duration::from_millis(20);

/// The right to make a file. The lock file goes with it.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
}

/// `NAME.lock`.
fn lock_path(target: &Path) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(".lock");
    PathBuf::from(name)
}

impl Lock {
    /// Take it, unless another process has it.
    pub fn take(target: &Path) -> Result<Lock, StoreError> {
        let path = lock_path(target);
        let not_created = |error: io::Error| StoreError::NotCreated { partial: path.clone(), cause: error.to_string() };
        let mut tries = 0;
        loop {
            let (file, is_new) = open(&path).map_err(not_created)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) if tries < TRIES => {
                    tries += 1;
                    sleep(PAUSE);
                    continue;
                }
                Err(TryLockError::WouldBlock) => return Err(StoreError::Busy { path: target.to_owned() }),
                // A file system without locks still makes a file only once.
                Err(TryLockError::Error(_)) if is_new => {}
                Err(TryLockError::Error(_)) => return Err(StoreError::NoLocks { path, target: target.to_owned() }),
            }
            // Whoever had it may have removed it between our opening and our locking it: then a
            // lock on it says nothing.
            let here = file.metadata().map_err(not_created)?;
            if std::fs::metadata(&path).is_ok_and(|there| (there.dev(), there.ino()) == (here.dev(), here.ino())) {
                return Ok(Lock { path, _file: file });
            }
        }
    }

    /// Whether a process has it.
    pub fn is_taken(target: &Path) -> bool {
        let file = File::open(lock_path(target));
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}

/// The lock file, and whether it was made just now. Nothing but a regular file is opened: a pipe
/// would wait for its other end.
fn open(path: &Path) -> io::Result<(File, bool)> {
    match File::options().create_new(true).write(true).open(path) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
        made => return made.map(|file| (file, true)),
    }
    match std::fs::symlink_metadata(path) {
        Ok(there) if !there.is_file() => {
            Err(io::Error::new(io::ErrorKind::AlreadyExists, "there is something else of this name"))
        }
        _ => Ok((File::options().create(true).truncate(false).write(true).open(path)?, false)),
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // An empty file that is left takes nobody's right.
        let _ = std::fs::remove_file(&self.path);
    }
}
