//! An advisory lock on `NAME.lock`, so that only one process at a time makes a file. The system
//! drops the lock when the process ends, however it ends.
//!
//! HDF5 has a lock of its own, but it is commonly switched off on file systems that many machines
//! share.

use super::StoreError;
use std::fs::{File, TryLockError};
use std::io;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

/// How often taking the lock is repeated while it is taken. A process that only asks whether the
/// lock is taken ([`Lock::is_taken`]) holds it for an instant.
const TRIES: u32 = 5;
const PAUSE: Duration = Duration::from_millis(20);

/// The right to make a file. Dropping it removes the lock file.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
}

/// The path of the lock file, `NAME.lock`.
fn lock_path(target: &Path) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(".lock");
    PathBuf::from(name)
}

impl Lock {
    /// Take the lock of a target; an error if another process holds it.
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
                // On a file system without locks, creating the lock file still succeeds for one
                // process only.
                Err(TryLockError::Error(_)) if is_new => {}
                Err(TryLockError::Error(_)) => return Err(StoreError::NoLocks { path, target: target.to_owned() }),
            }
            // The previous holder may have removed the file after it was opened here and before it
            // was locked. The lock is then on a file without a name, which excludes nobody, so it
            // is tried again.
            let here = file.metadata().map_err(not_created)?;
            if std::fs::metadata(&path).is_ok_and(|there| (there.dev(), there.ino()) == (here.dev(), here.ino())) {
                return Ok(Lock { path, _file: file });
            }
        }
    }

    /// Whether a process holds the lock of a target.
    pub fn is_taken(target: &Path) -> bool {
        let file = File::open(lock_path(target));
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}

/// Open the lock file; the flag is true if it was created just now. Only a regular file is opened:
/// opening a pipe would wait for its other end.
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
        // If removal fails, the empty file that remains blocks nobody, since nobody has it locked.
        let _ = std::fs::remove_file(&self.path);
    }
}
