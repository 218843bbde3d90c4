//! The folder `NAME.partial`, in which a file is written before it gets its name, together with the
//! lock for writing it.
//!
//! ```text
//! NAME.partial/state        how far a run has come
//! NAME.partial/rows         rows of its single paths
//! NAME.partial/rows.1 ...   rows of paths that other processes have simulated for it
//! NAME.partial/ranks        a token by which those processes recognise the folder
//! NAME.partial/results.h5   the file itself, while it is written
//! ```
//!
//! `results.h5` gets its final name by a hard link, because a link cannot replace another file. If
//! the process is interrupted after that, the two names of one file show that only the folder is
//! left to be removed.

use super::StoreError;
use super::error::is_full;
use super::lock::Lock;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

/// The state of a run.
pub(super) const STATE: &str = "state";
/// The rows of its single paths.
pub(super) const ROWS: &str = "rows";
/// A token by which the other processes of a run recognise the folder.
pub(super) const TOKEN: &str = "ranks";
/// The file itself, while it is written.
pub(super) const RESULTS: &str = "results.h5";
/// A new state, before it replaces the old one.
const NEW_STATE: &str = "state.new";
/// A second name of the results, from which they are renamed to replace an earlier file.
const LINK: &str = "results.link";

/// The files of the folder in the order of their removal. If the process is interrupted in between,
/// the files that remain still show what the folder was.
const NAMES: [&str; 6] = [ROWS, TOKEN, NEW_STATE, LINK, STATE, RESULTS];

/// The name of the log with this number: `rows`, `rows.1`, `rows.2` and so on.
pub(super) fn rows_name(log: u64) -> String {
    if log == 0 { ROWS.to_string() } else { format!("{ROWS}.{log}") }
}

/// The name of the folder in which a file is written: `NAME.partial`.
pub fn partial_path(target: &Path) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(".partial");
    PathBuf::from(name)
}

/// The target that a path stands for: `NAME` if the path is `NAME.partial`, and the path itself
/// otherwise.
pub fn file_of(path: &Path) -> PathBuf {
    if path.extension().is_some_and(|extension| extension == "partial") {
        path.with_extension("")
    } else {
        path.to_owned()
    }
}

/// The folder for writing one file, with the lock.
#[derive(Debug)]
pub(super) struct Workshop {
    target: PathBuf,
    folder: PathBuf,
    identity: (u64, u64),
    /// Whether a regular file of the target's name is replaced.
    force: bool,
    /// Number of paths that are saved in the folder.
    pub saved_paths: u64,
    _lock: Lock,
}

impl Workshop {
    /// Create an empty folder. If the folder exists and contains a saved run, this is an error,
    /// unless `force` lets it be removed.
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

    /// Take over the folder that an unfinished run has left, which must exist.
    pub fn enter(target: &Path, force: bool, lock: Lock) -> Result<Workshop, StoreError> {
        Workshop::of(target, partial_path(target), force, lock)
    }

    fn of(target: &Path, folder: PathBuf, force: bool, lock: Lock) -> Result<Workshop, StoreError> {
        let there = fs::symlink_metadata(&folder);
        let there = there.map_err(|source| StoreError::NotOpened { path: folder.clone(), source })?;
        let identity = (there.dev(), there.ino());
        Ok(Workshop { target: target.to_owned(), folder, identity, force, saved_paths: 0, _lock: lock })
    }

    /// The path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Check that the folder still is the one that was opened, and that the name of an open file in
    /// it still belongs to that file.
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

    /// Replace the saved state by a new one in a single step that survives a power failure.
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

    /// Turn an error of the system into an error that names the remedy.
    pub fn failed(&self, error: &io::Error) -> StoreError {
        self.failure(error.to_string(), is_full(error))
    }

    /// The same error, from the cause as text and whether the disk is full.
    pub fn failure(&self, cause: String, is_full: bool) -> StoreError {
        let (partial, target, saved_paths) = (self.folder.clone(), self.target.clone(), self.saved_paths);
        match is_full {
            true => StoreError::DiskFull { partial, target, saved_paths, cause },
            false => StoreError::Write { partial, target, saved_paths, cause },
        }
    }

    /// Give the results, which must be complete and on the disk, their final name, and remove the
    /// folder. Nothing is replaced except a regular file, and that only with `force`.
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
            // Not every file system has hard links.
            Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
                if !force && fs::symlink_metadata(&target).is_ok() {
                    return Err(failed(io::ErrorKind::AlreadyExists.into()));
                }
                fs::rename(&results, &target).map_err(failed)?;
            }
            named => named.map_err(failed)?,
        }
        // Not every file system can sync folders; the contents of the file are on the disk already.
        let _ = sync_folder(&parent(&self.target));
        self.discard();
        Ok(())
    }

    /// Remove the folder. If it contains files that are not of this program, they stay, and the
    /// folder stays too.
    pub fn discard(&self) {
        // An error is ignored: a folder without a state hinders no later run.
        let _ = clear(&self.folder);
    }
}

impl Drop for Workshop {
    /// Remove the folder if no state was saved in it.
    fn drop(&mut self) {
        if self.check(None).is_ok() && !fs::exists(self.path(STATE)).unwrap_or(true) {
            let _ = clear(&self.folder);
        }
    }
}

/// Write a file in one step, so that a file of this name is always complete. With `force`, an
/// existing regular file of this name is replaced.
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

/// Whether the target and the results in its folder are the same file: then only the folder is left
/// to be removed.
pub(super) fn is_published(target: &Path) -> bool {
    let of = |path: &Path| fs::symlink_metadata(path).map(|there| (there.dev(), there.ino()));
    match (of(target), of(&partial_path(target).join(RESULTS))) {
        (Ok(there), Ok(here)) => there == here,
        _ => false,
    }
}

/// Remove the files of this program, and then the folder. The folder stays, with an error, if it
/// holds anything else.
fn clear(folder: &Path) -> io::Result<()> {
    let is_log = |name: &str| name.strip_prefix("rows.").is_some_and(|number| number.parse::<u64>().is_ok());
    let all = fs::read_dir(folder)?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let logs: Vec<String> = all.filter(|name| is_log(name)).collect();
    for name in logs.iter().map(String::as_str).chain(NAMES) {
        match fs::remove_file(folder.join(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    fs::remove_dir(folder)
}

/// The folder that contains a file; `.` for a bare file name.
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

/// Write the names in a folder to the disk.
fn sync_folder(folder: &Path) -> io::Result<()> {
    match File::open(folder)?.sync_all() {
        // On a file system that cannot sync folders this step is left out.
        Err(error) if matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
        synced => synced,
    }
}
