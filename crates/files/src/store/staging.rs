//! The folder `NAME.partial`, in which a file is written before it gets its name, together with the
//! lock for writing it.
//!
//! ```text
//! NAME.partial/state        how far a run has come
//! NAME.partial/rows         rows of its single paths
//! NAME.partial/points.h5    the points of a sweep that are done, as a whole file
//! NAME.partial/results.h5   a file while it is written
//! NAME.partial/made-by-mc   the mark of the folder: files with these names belong to this program
//! ```
//!
//! A folder without the mark is not touched, unless it is empty. Saved files are replaced at
//! intervals, atomically.
//!
//! The file gets its final name by a hard link, because a link cannot replace another file. If the
//! process is interrupted after that, the two names of one file show that only the folder remains
//! to be removed.

use super::StoreError;
use super::errors::{is_full, stays};
use super::lock::Lock;
use super::system::{self, give_name, has_name, identity, parent, sync_folder};
use std::fs::{self, DirBuilder, File};
use std::io::{self, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Time between two saves of a run or of a sweep: the most that a kill can lose.
const INTERVAL: Duration = Duration::from_secs(2);

/// Saving takes at most this fraction (one in ...) of the time; after a slow save, the next one is
/// delayed.
const ONE_PART_IN: u32 = 20;

/// When the next save is due, after one that began at `start` and has just ended.
pub(super) fn next_save(start: Instant) -> Instant {
    Instant::now() + INTERVAL.max(start.elapsed() * ONE_PART_IN)
}

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
    /// Create an empty folder. If the folder exists and contains a saved run or sweep, this is an
    /// error, unless `force` lets it be removed.
    pub fn open(target: &Path, force: bool) -> Result<Staging, StoreError> {
        let lock = lock(target)?;
        make_room(target, force)?;
        Staging::create(target, force, lock)
    }

    /// The same, if the name is free.
    pub fn create(target: &Path, force: bool, lock: Lock) -> Result<Staging, StoreError> {
        let folder = partial_path(target);
        let made = DirBuilder::new().mode(mode(target, force)).create(&folder);
        let mark =
            || system::create(&folder.join(MARK)).inspect_err(|_| drop(fs::remove_dir(&folder)));
        let made = made.and_then(|()| mark().map(drop));
        made.map_err(|error| StoreError::NotCreated {
            partial: folder.clone(),
            cause: error.to_string(),
        })?;
        Staging::enter(target, force, lock)
    }

    /// Take over the folder of an unfinished run, which must exist and belong to this program.
    pub fn enter(target: &Path, force: bool, lock: Lock) -> Result<Staging, StoreError> {
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
        let write = || {
            let mut file = system::create(&self.path(NEW_STATE))?;
            file.write_all(state)?;
            file.sync_all()
        };
        write().map_err(|error| self.failed(&error))?;
        self.replace(NEW_STATE, STATE)?;
        self.saved_paths = paths;
        Ok(())
    }

    /// Replace a file of the folder by another one that is on the disk.
    pub fn replace(&self, new: &str, old: &str) -> Result<(), StoreError> {
        fs::rename(self.path(new), self.path(old))
            .and_then(|()| sync_folder(&self.folder))
            .map_err(|error| self.failed(&error))
    }

    /// Turn an error of the system into an error that names the remedy.
    pub fn failed(&self, error: &io::Error) -> StoreError {
        self.failure(error.to_string(), is_full(error))
    }

    /// The same error, from the cause as text and whether the disk is full.
    pub fn failure(&self, cause: String, is_full: bool) -> StoreError {
        // The saved data are gone with the folder.
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

    /// Give a file of the folder, which must be complete and on the disk, its final name, and remove
    /// the folder. Nothing is replaced except a regular file, and that only with `force`.
    pub fn publish(&self, name: &str) -> Result<(), StoreError> {
        self.check(None)?;
        let (results, link) = (self.path(name), self.path(LINK));
        let named = give_name(&results, &link, &self.target, &self.folder, self.force);
        named.map_err(|error| match error {
            // Without a saved state, the folder is removed with its results.
            StoreError::Appeared { target, .. } if !self.is_saved() => {
                StoreError::Overtaken { target }
            }
            StoreError::Rename { source, .. } if !self.is_saved() => self.failed(&source),
            error => error,
        })?;
        self.discard();
        Ok(())
    }

    /// Whether anything is saved in the folder, which then stays after a failure.
    fn is_saved(&self) -> bool {
        is_there(&self.folder, STATE) || is_there(&self.folder, POINTS)
    }

    /// Remove the folder. If it contains other files, they are kept, and so is the folder.
    pub fn discard(&self) {
        // A folder without a state does not block later runs, so this is only reported.
        if let Err(error) = remove_files(&self.folder) {
            stays(&self.folder, &error);
        }
    }
}

impl Drop for Staging {
    /// Remove the folder if nothing was saved in it.
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

/// The same for several files. None gets its name before all are on the disk. If one cannot get its
/// name, those already named are removed, unless they have replaced others.
pub fn write_together<P: AsRef<Path>, B: AsRef<[u8]>>(
    files: &[(P, B)],
    force: bool,
) -> Result<(), StoreError> {
    let write = |(target, bytes): &(P, B)| {
        let staging = Staging::open(target.as_ref(), force)?;
        let write = || {
            let mut file = system::create(&staging.path(RESULTS))?;
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
        if let Err(error) = staging.publish(RESULTS) {
            let ours = written[..done]
                .iter()
                .filter(|(named, made)| !force && identity(&named.target) == Some(*made));
            ours.for_each(|(named, _)| drop(fs::remove_file(&named.target)));
            return Err(error);
        }
    }
    Ok(())
}

/// The permissions of the folder: a new file that replaces a private one is private while it is
/// written.
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

/// The state of a run.
pub(super) const STATE: &str = "state";
/// The rows of its single paths.
pub(super) const ROWS: &str = "rows";
/// The points of a sweep that are done.
pub(super) const POINTS: &str = "points.h5";
/// A file while it is written.
pub(super) const RESULTS: &str = "results.h5";
/// A new state, before it replaces the old one.
const NEW_STATE: &str = "state.new";
/// A second name of the results, from which they are renamed to replace an earlier file.
const LINK: &str = "results.link";

/// The mark of the folder. It is the first file in it, and it is removed last.
const MARK: &str = "made-by-mc";

/// The files of the folder in the order of their removal. If the process is interrupted in between,
/// the files that remain still show what the folder was.
const NAMES: [&str; 7] = [ROWS, NEW_STATE, LINK, STATE, RESULTS, POINTS, MARK];

/// The name of the folder in which a file is written: `NAME.partial`.
pub fn partial_path(target: &Path) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(".partial");
    PathBuf::from(name)
}

/// The target that a path denotes: `NAME` if the path is `NAME.partial`, and the path itself
/// otherwise.
pub fn file_of(path: &Path) -> PathBuf {
    if path
        .extension()
        .is_some_and(|extension| extension == "partial")
    {
        path.with_extension("")
    } else {
        path.to_owned()
    }
}

/// Whether this program has made a folder.
fn is_ours(folder: &Path) -> bool {
    is_file(folder, MARK) || fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none())
}

/// The name of a foreign file in a folder of this program, if there is any.
fn foreign_file(folder: &Path) -> Option<String> {
    fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.file_name().display().to_string()))
        .find(|name| !NAMES.contains(&name.as_str()) || !is_file(folder, name))
}

fn is_file(folder: &Path, name: &str) -> bool {
    fs::symlink_metadata(folder.join(name)).is_ok_and(|there| there.is_file())
}

/// Remove the files of this program, and then the folder. If it contains anything else, the folder
/// is kept and an error returned.
fn remove_files(folder: &Path) -> io::Result<()> {
    NAMES
        .iter()
        .try_for_each(|name| system::remove(&folder.join(name)))?;
    fs::remove_dir(folder)
}

fn is_there(folder: &Path, name: &str) -> bool {
    fs::exists(folder.join(name)).unwrap_or(true)
}

/// The contents of `NAME.partial`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Partial {
    /// Nothing.
    Nothing,
    /// A folder in which nothing is saved.
    Empty,
    /// The folder of a run.
    Run,
    /// The folder of a sweep.
    Sweep,
    /// The folder of a file that already has its name; only the folder remains to be removed.
    Named,
    /// Something not made by this program.
    Foreign,
}

/// Determine the contents of `NAME.partial`.
pub(super) fn unfinished(target: &Path) -> Partial {
    let partial = partial_path(target);
    let is_named = |name| has_name(&partial.join(name), target);
    match fs::symlink_metadata(&partial) {
        Err(_) => Partial::Nothing,
        Ok(there) if !there.is_dir() || !is_ours(&partial) => Partial::Foreign,
        Ok(_) if is_named(RESULTS) || is_named(POINTS) => Partial::Named,
        Ok(_) if is_there(&partial, STATE) => Partial::Run,
        Ok(_) if is_there(&partial, POINTS) => Partial::Sweep,
        Ok(_) => Partial::Empty,
    }
}

/// Whether `NAME.partial` holds a sweep that is not finished.
pub fn is_unfinished_sweep(target: &Path) -> bool {
    unfinished(target) == Partial::Sweep
}

/// Remove `NAME.partial`, to start something new there. Without `force`, a saved run or sweep is an
/// error. Foreign files are never removed.
pub(super) fn make_room(target: &Path, force: bool) -> Result<(), StoreError> {
    let partial = partial_path(target);
    match unfinished(target) {
        Partial::Nothing => Ok(()),
        Partial::Foreign => Err(StoreError::InTheWay { path: partial }),
        Partial::Run | Partial::Sweep if !force => Err(StoreError::LeftOver {
            partial,
            target: target.to_owned(),
        }),
        Partial::Empty | Partial::Run | Partial::Sweep | Partial::Named => clear(target),
    }
}

/// Remove `NAME.partial`, which must belong to this program.
pub(super) fn clear(target: &Path) -> Result<(), StoreError> {
    let partial = partial_path(target);
    if let Some(name) = foreign_file(&partial) {
        return Err(StoreError::InTheWay {
            path: partial.join(name),
        });
    }
    remove_files(&partial).map_err(|source| StoreError::Remove { partial, source })
}
