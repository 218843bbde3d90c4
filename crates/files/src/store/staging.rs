//! The folder `NAME.partial`, in which a file is written before it gets its name, together with the
//! lock for writing it.
//!
//! ```text
//! NAME.partial/state        how far a run has come
//! NAME.partial/rows         rows of its single paths
//! NAME.partial/results.h5   the file itself, while it is written
//! NAME.partial/made-by-mc   the mark of the folder: what has these names in it is ours
//! ```
//!
//! A folder without the mark is not touched, unless it is empty or has a saved state, which begins
//! with a mark of its own.
//!
//! `results.h5` gets its final name by a hard link, because a link cannot replace another file. If
//! the process is interrupted after that, the two names of one file show that only the folder is
//! left to be removed.

use super::error::is_full;
use super::folder::{self, LINK, MARK, NEW_STATE, RESULTS, STATE, partial_path};
use super::lock::Lock;
use super::naming::{give_name, parent, sync_folder};
use super::own::{self, identity};
use super::{StoreError, found, leftovers};
use std::fs::{self, DirBuilder, File};
use std::io::{self, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};

/// The folder for writing one file, with the lock.
#[derive(Debug)]
pub(super) struct Staging {
    target: PathBuf,
    folder: PathBuf,
    identity: (u64, u64),
    /// Whether a regular file of the target's name is replaced.
    force: bool,
    /// Number of paths that are saved in the folder.
    pub saved_paths: u64,
    _lock: Lock,
}

impl Staging {
    /// Create an empty folder. If the folder exists and contains a saved run, this is an error,
    /// unless `force` lets it be removed.
    pub fn open(target: &Path, force: bool) -> Result<Staging, StoreError> {
        let lock = lock(target)?;
        found::make_room(target, force)?;
        let folder = partial_path(target);
        let made = DirBuilder::new().mode(mode(target, force)).create(&folder);
        let mark =
            || own::create(&folder.join(MARK)).inspect_err(|_| drop(fs::remove_dir(&folder)));
        let made = made.and_then(|()| mark().map(drop));
        made.map_err(|error| StoreError::NotCreated {
            partial: folder.clone(),
            cause: error.to_string(),
        })?;
        Staging::of(target, force, lock)
    }

    /// Take over the folder that an unfinished run has left, which must exist and be ours.
    pub fn enter(target: &Path, force: bool, lock: Lock) -> Result<Staging, StoreError> {
        let staging = Staging::of(target, force, lock)?;
        // Where the state alone shows whose the folder is, it is not the first file to be removed.
        own::create(&staging.path(MARK)).map_err(|error| staging.failed(&error))?;
        Ok(staging)
    }

    fn of(target: &Path, force: bool, lock: Lock) -> Result<Staging, StoreError> {
        let folder = partial_path(target);
        let gone = || StoreError::TakenAway {
            partial: folder.clone(),
            target: target.to_owned(),
        };
        let identity = identity(&folder).ok_or_else(gone)?;
        Ok(Staging {
            target: target.to_owned(),
            folder,
            identity,
            force,
            saved_paths: 0,
            _lock: lock,
        })
    }

    /// The path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Check that the folder still is the one that was opened, and that the name of an open file in
    /// it still belongs to that file.
    pub fn check(&self, open: Option<(&str, &File)>) -> Result<(), StoreError> {
        let is_ours = identity(&self.folder) == Some(self.identity)
            && open.is_none_or(|(name, file)| {
                file.metadata()
                    .is_ok_and(|here| identity(&self.path(name)) == Some((here.dev(), here.ino())))
            });
        let (partial, target) = (self.folder.clone(), self.target.clone());
        if is_ours {
            Ok(())
        } else {
            Err(StoreError::TakenAway { partial, target })
        }
    }

    /// Replace the saved state by a new one in a single step that survives a power failure.
    pub fn save(&mut self, state: &[u8], paths: u64) -> Result<(), StoreError> {
        let new = self.path(NEW_STATE);
        let write = || {
            let mut file = own::create(&new)?;
            file.write_all(state)?;
            file.sync_all()?;
            fs::rename(&new, self.path(STATE))?;
            sync_folder(&self.folder)
        };
        write().map_err(|error| self.failed(&error))?;
        self.saved_paths = paths;
        Ok(())
    }

    /// Turn an error of the system into an error that names the remedy.
    pub fn failed(&self, error: &io::Error) -> StoreError {
        self.failure(error.to_string(), is_full(error))
    }

    /// The same error, from the cause as text and whether the disk is full.
    pub fn failure(&self, cause: String, is_full: bool) -> StoreError {
        // What was saved is gone with the folder.
        if let Err(taken_away) = self.check(None) {
            return taken_away;
        }
        let (partial, target) = (self.folder.clone(), self.target.clone());
        let saved_paths = if self.is_saved() { self.saved_paths } else { 0 };
        match is_full {
            true => StoreError::DiskFull {
                partial,
                target,
                saved_paths,
                cause,
            },
            false => StoreError::Write {
                partial,
                target,
                saved_paths,
                cause,
            },
        }
    }

    /// Give the results, which must be complete and on the disk, their final name, and remove the
    /// folder. Nothing is replaced except a regular file, and that only with `force`.
    pub fn publish(&self) -> Result<(), StoreError> {
        self.check(None)?;
        let (results, link) = (self.path(RESULTS), self.path(LINK));
        let named = give_name(
            &results,
            Some(&link),
            &self.target,
            &self.folder,
            self.force,
        );
        named.map_err(|error| match error {
            // Without a saved state, the folder and the results in it go.
            StoreError::Appeared { target, .. } if !self.is_saved() => {
                StoreError::Overtaken { target }
            }
            StoreError::Rename { source, .. } if !self.is_saved() => self.failed(&source),
            error => error,
        })?;
        self.discard();
        Ok(())
    }

    /// Whether a state is saved in the folder, which then stays after a failure.
    fn is_saved(&self) -> bool {
        fs::exists(self.path(STATE)).unwrap_or(true)
    }

    /// Remove the folder. If it contains files that are not of this program, they stay, and the
    /// folder stays too.
    pub fn discard(&self) {
        // A folder without a state hinders no later run, so this is no more than said.
        if let Err(error) = folder::clear(&self.folder) {
            leftovers::stays(&self.folder, &error);
        }
    }
}

impl Drop for Staging {
    /// Remove the folder if no state was saved in it.
    fn drop(&mut self) {
        if self.check(None).is_ok() && !self.is_saved() {
            self.discard();
        }
    }
}

/// Write a file in one step, so that a file of this name is always complete. With `force`, an
/// existing regular file of this name is replaced.
pub fn write_whole(target: &Path, bytes: &[u8], force: bool) -> Result<(), StoreError> {
    write_together(&[(target, bytes)], force)
}

/// The same for several files, of which none gets its name before all are on the disk. If one
/// cannot get its name, those that have one already lose it again, unless they have replaced others.
pub fn write_together<P: AsRef<Path>, B: AsRef<[u8]>>(
    files: &[(P, B)],
    force: bool,
) -> Result<(), StoreError> {
    let write = |(target, bytes): &(P, B)| {
        let staging = Staging::open(target.as_ref(), force)?;
        let write = || {
            let mut file = own::create(&staging.path(RESULTS))?;
            file.write_all(bytes.as_ref())?;
            file.sync_all()?;
            let made = file.metadata()?;
            Ok((made.dev(), made.ino()))
        };
        let made = write().map_err(|error| staging.failed(&error))?;
        Ok((staging, made))
    };
    let written = files
        .iter()
        .map(write)
        .collect::<Result<Vec<_>, StoreError>>()?;
    for (done, (staging, _)) in written.iter().enumerate() {
        if let Err(error) = staging.publish() {
            let ours = written[..done]
                .iter()
                .filter(|(named, made)| !force && identity(&named.target) == Some(*made));
            ours.for_each(|(named, _)| drop(fs::remove_file(&named.target)));
            return Err(error);
        }
    }
    Ok(())
}

/// The permissions of the folder: where a file is replaced that others may not read, they may not
/// read the new one either, while it is made.
fn mode(target: &Path, force: bool) -> u32 {
    let there = fs::symlink_metadata(target)
        .ok()
        .filter(|there| force && there.is_file());
    there.map_or(0o777, |there| {
        let readers = there.permissions().mode() & 0o044;
        0o700 | readers | readers >> 2
    })
}

/// Take the lock of a target, whose folder must exist.
pub(super) fn lock(target: &Path) -> Result<Lock, StoreError> {
    let folder = parent(target);
    if !folder.is_dir() {
        return Err(StoreError::NoFolder {
            target: target.to_owned(),
            folder,
        });
    }
    Lock::take(target)
}
