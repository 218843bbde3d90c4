//! The folder `NAME.partial`, in which a file is made before it gets its name, and the right to
//! make it.
//!
//! ```text
//! NAME.partial/state        how far a run has come
//! NAME.partial/rows         rows of its single paths
//! NAME.partial/results.h5   the file itself, while it is written
//! ```
//!
//! `results.h5` gets its name as a second name of the same file: a link replaces nothing, and
//! whoever is interrupted after it sees by the two names that only the folder is left to be
//! removed.

use super::StoreError;
use super::error::is_full;
use super::lock::Lock;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

/// How far a run has come.
pub(super) const STATE: &str = "state";
/// Rows of its single paths.
pub(super) const ROWS: &str = "rows";
/// The file that is made.
pub(super) const RESULTS: &str = "results.h5";
/// What is written beside the state, to take its place.
const NEW_STATE: &str = "state.new";
/// A second name of the results on their way to replace an earlier file.
const LINK: &str = "results.link";

/// In the order in which they go: whoever is interrupted in between can still tell what was left.
const NAMES: [&str; 5] = [ROWS, NEW_STATE, LINK, STATE, RESULTS];

/// The name of the folder in which a file is made: `NAME.partial`.
pub fn partial_path(target: &Path) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(".partial");
    PathBuf::from(name)
}

/// The file that is meant: `NAME` where this is `NAME.partial`, and this itself otherwise.
pub fn file_of(path: &Path) -> PathBuf {
    if path.extension().is_some_and(|extension| extension == "partial") {
        path.with_extension("")
    } else {
        path.to_owned()
    }
}

/// The folder, and the right to make a file in it.
#[derive(Debug)]
pub(super) struct Workshop {
    target: PathBuf,
    folder: PathBuf,
    identity: (u64, u64),
    /// Whether a regular file of the target's name is replaced.
    force: bool,
    /// Paths that are safe in it.
    pub saved_paths: u64,
    _lock: Lock,
}

impl Workshop {
    /// An empty one. What a run has left in it is an error unless it may go (`force`), and so is a
    /// file of the target's name.
    pub fn open(target: &Path, force: bool) -> Result<Workshop, StoreError> {
        let lock = lock(target)?;
        let folder = partial_path(target);
        match fs::symlink_metadata(&folder) {
            Err(_) => {}
            Ok(there) if there.is_dir() => {
                if fs::exists(folder.join(STATE)).unwrap_or(true) && !force {
                    return Err(StoreError::LeftOver { partial: folder, target: target.to_owned() });
                }
                clear(&folder).map_err(|source| StoreError::Remove { partial: folder.clone(), source })?;
            }
            Ok(there) if there.is_file() && force => {
                let removed = fs::remove_file(&folder);
                removed.map_err(|source| StoreError::Remove { partial: folder.clone(), source })?;
            }
            Ok(_) => return Err(StoreError::InTheWay { path: folder }),
        }
        let made = fs::create_dir(&folder);
        made.map_err(|error| StoreError::NotCreated { partial: folder.clone(), cause: error.to_string() })?;
        Workshop::of(target, folder, force, lock)
    }

    /// The one that an unfinished run has left.
    pub fn enter(target: &Path, force: bool, lock: Lock) -> Result<Workshop, StoreError> {
        Workshop::of(target, partial_path(target), force, lock)
    }

    fn of(target: &Path, folder: PathBuf, force: bool, lock: Lock) -> Result<Workshop, StoreError> {
        let there = fs::symlink_metadata(&folder);
        let there = there.map_err(|source| StoreError::NotOpened { path: folder.clone(), source })?;
        let identity = (there.dev(), there.ino());
        Ok(Workshop { target: target.to_owned(), folder, identity, force, saved_paths: 0, _lock: lock })
    }

    /// A file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Whether the folder of this name is still ours, and the file of this name in it the one that
    /// is open.
    pub fn check(&self, open: Option<(&str, &File)>) -> Result<(), StoreError> {
        let is = |path: &Path, identity: (u64, u64)| {
            fs::symlink_metadata(path).is_ok_and(|there| (there.dev(), there.ino()) == identity)
        };
        let is_ours = is(&self.folder, self.identity)
            && open.is_none_or(|(name, file)| {
                file.metadata().is_ok_and(|here| is(&self.path(name), (here.dev(), here.ino())))
            });
        let (partial, target) = (self.folder.clone(), self.target.clone());
        if is_ours { Ok(()) } else { Err(StoreError::TakenAway { partial, target }) }
    }

    /// Put a new state in the place of the old one, in one step that a loss of power does not undo.
    pub fn save(&mut self, state: &[u8], paths: u64) -> Result<(), StoreError> {
        let new = self.path(NEW_STATE);
        let write = || {
            let mut file = File::create(&new)?;
            file.write_all(state)?;
            file.sync_all()?;
            fs::rename(&new, self.path(STATE))?;
            sync_folder(&self.folder)
        };
        write().map_err(|error| self.failed(&error))?;
        self.saved_paths = paths;
        Ok(())
    }

    /// An error of the system as one that says what to do.
    pub fn failed(&self, error: &io::Error) -> StoreError {
        self.failure(error.to_string(), is_full(error))
    }

    /// The same.
    pub fn failure(&self, cause: String, is_full: bool) -> StoreError {
        let (partial, target, saved_paths) = (self.folder.clone(), self.target.clone(), self.saved_paths);
        match is_full {
            true => StoreError::DiskFull { partial, target, saved_paths, cause },
            false => StoreError::Write { partial, target, saved_paths, cause },
        }
    }

    /// Give the results, which are whole and on the disk, their name, and remove the folder.
    /// Nothing is replaced but a regular file, where it may be.
    pub fn publish(&self) -> Result<(), StoreError> {
        let force = self.force;
        let (results, target) = (self.path(RESULTS), self.target.clone());
        let failed = |source: io::Error| match source.kind() {
            io::ErrorKind::AlreadyExists => {
                StoreError::Appeared { partial: self.folder.clone(), target: target.clone() }
            }
            _ => StoreError::Rename { partial: results.clone(), target: target.clone(), source },
        };
        self.check(None)?;
        if force && fs::symlink_metadata(&target).is_ok_and(|there| !there.is_file()) {
            return Err(StoreError::InTheWay { path: target });
        }
        let named = if force {
            let link = self.path(LINK);
            let _ = fs::remove_file(&link);
            fs::hard_link(&results, &link).and_then(|()| fs::rename(&link, &target))
        } else {
            fs::hard_link(&results, &target)
        };
        match named {
            // Not every file system has links.
            Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
                if !force && fs::symlink_metadata(&target).is_ok() {
                    return Err(failed(io::ErrorKind::AlreadyExists.into()));
                }
                fs::rename(&results, &target).map_err(failed)?;
            }
            named => named.map_err(failed)?,
        }
        // Some file systems do not sync folders; the file itself is on the disk.
        let _ = sync_folder(&parent(&self.target));
        self.discard();
        Ok(())
    }

    /// Remove the folder.
    pub fn discard(&self) {
        // What is left is in nobody's way: without a state there is nothing to go on from.
        let _ = clear(&self.folder);
    }
}

impl Drop for Workshop {
    /// Nothing is left where nothing is saved.
    fn drop(&mut self) {
        if self.check(None).is_ok() && !fs::exists(self.path(STATE)).unwrap_or(true) {
            let _ = clear(&self.folder);
        }
    }
}

/// Write a file in one step: what has its name is whole. With `force`, a regular file of this name
/// is replaced.
pub fn write_whole(target: &Path, bytes: &[u8], force: bool) -> Result<(), StoreError> {
    let workshop = Workshop::open(target, force)?;
    let write = || {
        let mut file = File::create_new(workshop.path(RESULTS))?;
        file.write_all(bytes)?;
        file.sync_all()
    };
    write().map_err(|error| workshop.failed(&error))?;
    workshop.publish()
}

/// Whether this folder is what is left of making the file that has the target's name now.
pub(super) fn is_published(target: &Path) -> bool {
    let of = |path: &Path| fs::symlink_metadata(path).map(|there| (there.dev(), there.ino()));
    match (of(target), of(&partial_path(target).join(RESULTS))) {
        (Ok(there), Ok(here)) => there == here,
        _ => false,
    }
}

/// Remove what is ours, and the folder unless it holds anything else.
fn clear(folder: &Path) -> io::Result<()> {
    for name in NAMES {
        match fs::remove_file(folder.join(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    fs::remove_dir(folder)
}

/// The folder of a file.
pub(super) fn parent(target: &Path) -> PathBuf {
    target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned()
}

fn lock(target: &Path) -> Result<Lock, StoreError> {
    let folder = parent(target);
    if !folder.is_dir() {
        return Err(StoreError::NoFolder { target: target.to_owned(), folder });
    }
    Lock::take(target)
}

/// Bring the names in a folder to the disk.
fn sync_folder(folder: &Path) -> io::Result<()> {
    match File::open(folder)?.sync_all() {
        // A file system that cannot sync folders has nothing to bring.
        Err(error) if matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
        synced => synced,
    }
}
