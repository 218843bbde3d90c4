//! What can go wrong between a run and its file, and the remedy.

use crate::saved::SavedError;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use stickslip_text::numbers::{bytes, grouped};

/// Why a file could not be written or read. Each message names the file and the remedy.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The folder of the target is missing.
    #[error("{}: the folder {} does not exist; create it or choose another output file", target.display(), folder.display())]
    NoFolder {
        /// The file to be written.
        target: PathBuf,
        /// Its folder.
        folder: PathBuf,
    },
    /// The file could not be made.
    #[error("{}: cannot be created: {cause}; check that its folder is writable or choose another output file", partial.display())]
    NotCreated {
        /// The file to be made.
        partial: PathBuf,
        /// The message of the system.
        cause: String,
    },
    /// `NAME.partial`, the folder in which the file would be made, already contains unfinished
    /// work.
    #[error(
        "{}: left behind by an unfinished command; move it to keep it, continue it with `mc resume {}`, or \
         discard it with --force", partial.display(), target.display()
    )]
    LeftOver {
        /// The folder with the unfinished work.
        partial: PathBuf,
        /// The file that was to be made.
        target: PathBuf,
    },
    /// An earlier run to the same target was not finished and can be continued.
    #[error(
        "{}: {what} is unfinished, with {} of {} paths done\n  fix: continue it with `mc resume {}`, discard \
         it with --force, or choose another output file with -o", partial.display(), grouped(*saved_paths), grouped(*paths), target.display()
    )]
    Resumable {
        /// The folder in which it is saved.
        partial: PathBuf,
        /// The file that was to be made.
        target: PathBuf,
        /// Whether it is the run requested now, or how it differs from that run.
        what: String,
        /// Number of paths that are saved.
        saved_paths: u64,
        /// Number of paths that the run asks for.
        paths: u64,
    },
    /// The name is taken by something that this program may not replace.
    #[error("{}: the name is taken by something else; move it, or choose another output file with -o", path.display())]
    InTheWay {
        /// The name in question.
        path: PathBuf,
    },
    /// There is neither a file of this name nor an unfinished run.
    #[error("{}: no such file, and no unfinished run of that name ({})\n  fix: give the file of an interrupted run", target.display(), partial.display())]
    NothingToResume {
        /// The file that was to be continued.
        target: PathBuf,
        /// The folder in which an unfinished run would have been saved.
        partial: PathBuf,
    },
    /// The folder in which a file is made was removed or replaced in the meantime.
    #[error("{}: moved, deleted or replaced while {} was being written in it; run again, and do not touch it", partial.display(), target.display())]
    TakenAway {
        /// The folder.
        partial: PathBuf,
        /// The file that was to be made.
        target: PathBuf,
    },
    /// What was saved of the run cannot be used.
    #[error(transparent)]
    Saved(#[from] SavedError),
    /// A file with the target's name appeared during the computation.
    #[error(
        "{}: appeared during the run and was not replaced; the results are in {}\n  fix: move the file, or \
         replace it with --force, then run `mc resume {}`", target.display(), partial.display(), target.display()
    )]
    Appeared {
        /// The folder with the results.
        partial: PathBuf,
        /// The file that appeared.
        target: PathBuf,
    },
    /// The same for a file whose results are not kept.
    #[error(
        "{}: appeared during the run and was not replaced; nothing was written\n  fix: choose another output \
         file with -o, or replace it with --force", target.display()
    )]
    Overtaken {
        /// The file that appeared.
        target: PathBuf,
    },
    /// Another process has the file open and HDF5 has locked it.
    #[error("{}: in use by another process; wait, or close that process", path.display())]
    InUse {
        /// The file.
        path: PathBuf,
    },
    /// The file system has no locks, and a lock file exists, so another process may be making the
    /// file.
    #[error("{}: another process may be writing {} (this file system does not support locks); remove this \
        file if there is none", path.display(), target.display())]
    NoLocks {
        /// The lock file.
        path: PathBuf,
        /// The file that is being made.
        target: PathBuf,
    },
    /// Another process is making the same file.
    #[error("{}: another process is writing this file; wait for it, or choose another output file with -o", path.display())]
    Busy {
        /// The file.
        path: PathBuf,
    },
    /// The file holds the results of another sweep.
    #[error(
        "{}: this is a different sweep: {what}\n  fix: use the options of that sweep to continue it, choose \
         another output file with -o, or overwrite it with --force", path.display()
    )]
    OtherSweep {
        /// The file.
        path: PathBuf,
        /// Where the two sweeps differ.
        what: String,
    },
    /// The file is not the file of a sweep.
    #[error("{}: not the file of a sweep; choose another output file with -o, or overwrite it with --force", path.display())]
    NotASweep {
        /// The file.
        path: PathBuf,
    },
    /// The points of a sweep are in a file that another program has changed or written.
    #[error(
        "{}: it has no checksum, because another program wrote or changed it; its points are not used\n  fix: \
         use the file as mc wrote it, or move it", path.display()
    )]
    NoChecksum {
        /// The file.
        path: PathBuf,
    },
    /// The disk has too little space for the run; this is checked before the run starts.
    #[error("{}: needs about {}, but only {} are free; free some space, choose another disk, or record less", folder.display(), bytes(*needed as f64), bytes(*free as f64))]
    TooLittleSpace {
        /// The folder of the output file.
        folder: PathBuf,
        /// Bytes needed, an upper estimate.
        needed: u64,
        /// Bytes free on the disk.
        free: u64,
    },
    /// The disk became full.
    #[error("{}: the disk is full ({cause}); {}", partial.display(), after_failure(*saved_paths, target, "free some space or choose another disk"))]
    DiskFull {
        /// The folder in which the file was made.
        partial: PathBuf,
        /// The file that was to be made.
        target: PathBuf,
        /// Number of paths that are saved in the folder.
        saved_paths: u64,
        /// The message of the system.
        cause: String,
    },
    /// Writing failed for another reason.
    #[error("{}: writing failed: {cause}; {}", partial.display(), after_failure(*saved_paths, target, "fix this"))]
    Write {
        /// The folder in which the file was made.
        partial: PathBuf,
        /// The file that was to be made.
        target: PathBuf,
        /// Number of paths that are saved in the folder.
        saved_paths: u64,
        /// What HDF5 or the system says.
        cause: String,
    },
    /// The finished file could not be given its name.
    #[error("{}: complete, but cannot be renamed to {}: {source}; fix this, then run `mc resume {}`", partial.display(), target.display(), target.display())]
    Rename {
        /// The finished file.
        partial: PathBuf,
        /// The name it should have.
        target: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// A leftover file could not be removed.
    #[error("{}: cannot be removed: {source}", partial.display())]
    Remove {
        /// The unfinished file.
        partial: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// The system could not say how much space is free.
    #[error("{}: cannot determine the free space: {source}", folder.display())]
    Space {
        /// The folder of the output file.
        folder: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// The file does not exist, or it may not be read.
    #[error("{}: {source}\n  fix: give a file that mc run wrote", path.display())]
    NotOpened {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// The file is not an HDF5 file.
    #[error("{}: not an HDF5 file\n  fix: give a file that mc run wrote", path.display())]
    NotHdf5 {
        /// The file.
        path: PathBuf,
    },
    /// The file is an HDF5 file, but not one of this program.
    #[error("{}: an HDF5 file, but not written by this program (no format_name = \"{}\")\n  fix: give a file \
        that mc run wrote", path.display(), stickslip::dataset::header::FORMAT.0)]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The file has another format than this program reads.
    #[error(
        "{}: written in format {major}.{minor}, but this program reads {reads}.x\n  fix: use the version of \
            mc that wrote the file, or run its scenario again",
        path.display()
    )]
    OtherFormat {
        /// The file.
        path: PathBuf,
        /// Its major format version.
        major: u32,
        /// Its minor format version.
        minor: u32,
        /// The major format version of this program.
        reads: u32,
    },
    /// The file is one of this program, but its contents cannot be read.
    #[error("{}: damaged or truncated ({cause}); copy it again from its source, or run again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What HDF5 says.
        cause: String,
    },
}

/// The error of a file that the system does not open or read.
pub(super) fn not_opened(path: &Path) -> impl Fn(io::Error) -> StoreError + Copy {
    move |source| StoreError::NotOpened {
        path: path.to_owned(),
        source,
    }
}

/// The error of the operating system behind an HDF5 error, if there is one. HDF5 keeps it only as
/// text within its error stack.
pub(super) fn system_error(error: &hdf5::Error) -> Option<io::Error> {
    let frames = error.stack()?;
    frames.iter().find_map(|frame| {
        let text = frame.description();
        let number = text.split_once("errno = ")?.1;
        let digits = number.split(|c: char| !c.is_ascii_digit()).next()?;
        digits
            .parse()
            .ok()
            .filter(|&code| code != 0)
            .map(io::Error::from_raw_os_error)
    })
}

/// Whether an error means that there is no room left: a full disk, a quota, or a limit on the size
/// of a file.
pub(super) fn is_full(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge
    )
}

/// The cause of an HDF5 error in one line: the error of the system where there is one, else HDF5's
/// own message.
pub(super) fn cause(error: &hdf5::Error) -> String {
    system_error(error).map_or_else(|| error.to_string(), |system| system.to_string())
}

/// The end of a message about a failed write: how many paths are saved, and what to do next.
fn after_failure(saved_paths: u64, target: &Path, remedy: &str) -> String {
    match saved_paths {
        0 => format!("nothing more was written: {remedy}, then run again"),
        paths => format!(
            "{} paths are saved: {remedy}, then run `mc resume {}`",
            grouped(paths),
            target.display()
        ),
    }
}

/// Why a file could not be written.
#[derive(Clone, Debug)]
pub(super) struct WriteFailure {
    /// What the system or HDF5 says.
    pub cause: String,
    /// Whether there was no room left.
    pub full: bool,
}

impl From<hdf5::Error> for WriteFailure {
    fn from(error: hdf5::Error) -> Self {
        WriteFailure {
            cause: cause(&error),
            full: system_error(&error).is_some_and(|system| is_full(&system)),
        }
    }
}

impl From<io::Error> for WriteFailure {
    fn from(error: io::Error) -> Self {
        WriteFailure {
            full: is_full(&error),
            cause: error.to_string(),
        }
    }
}

static REMAINS: Mutex<Vec<(PathBuf, String)>> = Mutex::new(Vec::new());

/// Note that a file could not be removed.
pub(super) fn stays(path: &Path, error: &io::Error) {
    REMAINS
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .push((path.to_owned(), error.to_string()));
}

/// The leftover files of this process so far, in sentences. Each is returned once.
pub fn take_leftovers() -> Vec<String> {
    let mut remains = std::mem::take(&mut *REMAINS.lock().unwrap_or_else(PoisonError::into_inner));
    // A second attempt may have removed it.
    remains.retain(|(path, _)| path.symlink_metadata().is_ok());
    let line = |(path, error): (PathBuf, String)| {
        format!(
            "cannot remove {}: {error}; remove it by hand",
            path.display()
        )
    };
    remains.into_iter().map(line).collect()
}
