//! An advisory lock on `NAME.lock`, so that only one process at a time makes a file. The system
//! releases the lock when the process ends, for whatever reason.
//!
//! HDF5 has its own lock, but it is commonly switched off on shared file systems.
//!
//! The file contains a mark, because other programs use such names too, for example `Cargo.lock`. A
//! file with other contents is not touched.

use super::system::identity;
use super::{StoreError, errors, system};
use std::fs::{File, TryLockError};
use std::io::{self, Read as _, Seek as _, Write as _};
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

/// How often to retry while the lock is taken. A process that only tests the lock
/// ([`Lock::is_taken`]) holds it for an instant.
const TRIES: u32 = 5;
const PAUSE: Duration = Duration::from_millis(20);

/// The contents of a lock file. A killed process may have left part of it, or nothing.
const MARK: &[u8] = b"made by mc, which removes it\n";

/// The right to make a file. Dropping it removes the lock file.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    file: File,
}

/// The path of the lock file, `NAME.lock`.
pub fn lock_path(target: &Path) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(".lock");
    PathBuf::from(name)
}

impl Lock {
    /// Take the lock of a target; an error if another process holds it.
    pub fn take(target: &Path) -> Result<Lock, StoreError> {
        let path = lock_path(target);
        let not_created = |error: io::Error| StoreError::NotCreated {
            partial: path.clone(),
            cause: error.to_string(),
        };
        let mut tries = 0;
        loop {
            let Some((mut file, is_new)) = open(&path).map_err(not_created)? else {
                return Err(StoreError::InTheWay { path });
            };
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) if tries < TRIES => {
                    tries += 1;
                    sleep(PAUSE);
                    continue;
                }
                Err(TryLockError::WouldBlock) => {
                    return Err(StoreError::Busy {
                        path: target.to_owned(),
                    });
                }
                // On a file system without locks, creating the lock file still succeeds for one
                // process only.
                Err(TryLockError::Error(_)) if is_new => {}
                Err(TryLockError::Error(_)) => {
                    return Err(StoreError::NoLocks {
                        path,
                        target: target.to_owned(),
                    });
                }
            }
            // The previous holder may have removed the file after it was opened here and before it
            // was locked. The lock is then on a file without a name, which excludes nobody, so it
            // is tried again.
            if is_at(&file, &path) {
                // A full disk is reported by whatever needs the space.
                let _ = file.write_all(MARK);
                return Ok(Lock { path, file });
            }
        }
    }

    /// Whether a process holds the lock of a target.
    pub fn is_taken(target: &Path) -> bool {
        let file = system::open(&lock_path(target), File::options().read(true));
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}

/// Open the lock file; the flag is true if it was just created. None if a file of this name is not
/// a lock of this program.
fn open(path: &Path) -> io::Result<Option<(File, bool)>> {
    match File::options().create_new(true).write(true).open(path) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
        made => return made.map(|file| Some((file, true))),
    }
    let mut file = match system::open(path, File::options().read(true).write(true)) {
        // The previous holder has removed it in the meantime.
        Err(error) if error.kind() == io::ErrorKind::NotFound => return open(path),
        opened => opened?,
    };
    let mut found = Vec::new();
    (&file)
        .take(MARK.len() as u64 + 1)
        .read_to_end(&mut found)?;
    file.rewind()?;
    Ok(MARK.starts_with(&found).then_some((file, false)))
}

/// Whether this open file has this name.
fn is_at(file: &File, path: &Path) -> bool {
    file.metadata()
        .is_ok_and(|here| identity(path) == Some((here.dev(), here.ino())))
}

impl Drop for Lock {
    /// Remove the lock file, unless it was replaced. A remaining file blocks nobody, since it is
    /// not locked.
    fn drop(&mut self) {
        if is_at(&self.file, &self.path)
            && let Err(error) = std::fs::remove_file(&self.path)
        {
            errors::stays(&self.path, &error);
        }
    }
}
