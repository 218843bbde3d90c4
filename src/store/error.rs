//! What can go wrong between a run and its file, and what to do about it.

use crate::numbers::bytes;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file could not be written or read. Each message names the file and says what to do.
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
        /// What the system says.
        cause: String,
    },
    /// An earlier run to the same target was killed.
    #[error("{}: left behind by a run that did not finish; move it away to keep it, or overwrite it (--force)", partial.display())]
    LeftOver {
        /// The unfinished file.
        partial: PathBuf,
    },
    /// Another process has the file open.
    #[error("{}: in use by another process (a run that writes it, or a reader that holds it open); wait or close that one", path.display())]
    InUse {
        /// The file.
        path: PathBuf,
    },
    /// Another process simulates a sweep to the same file.
    #[error("{}: another process is writing this sweep; wait for it, or choose another output file with -o", path.display())]
    Busy {
        /// The file.
        path: PathBuf,
    },
    /// The sweep in the file is another one.
    #[error(
        "{}: this is another sweep: {what}\n  fix: give the options of that sweep to continue it, choose another output file with -o, \
         or overwrite it with --force", path.display()
    )]
    OtherSweep {
        /// The file.
        path: PathBuf,
        /// Where they differ.
        what: String,
    },
    /// The file is not that of a sweep.
    #[error("{}: this is no file of a sweep; choose another output file with -o, or overwrite it with --force", path.display())]
    NoSweep {
        /// The file.
        path: PathBuf,
    },
    /// There is not enough room for a run, found out before it starts.
    #[error("{}: about {} are needed and {} are free; free some space, choose another disk, or record less", folder.display(), bytes(*needed as f64), bytes(*free as f64))]
    TooLittleSpace {
        /// The folder of the output file.
        folder: PathBuf,
        /// Bytes needed, at most.
        needed: u64,
        /// Bytes free.
        free: u64,
    },
    /// The disk became full during a run.
    #[error(
        "{}: the disk is full ({cause}); nothing was written to the final file. \
         Free some space or choose another disk, delete this file, and run again", partial.display()
    )]
    DiskFull {
        /// The unfinished file.
        partial: PathBuf,
        /// Paths that were in the file when it was last known to be whole.
        completed_paths: u64,
        /// What the system says.
        cause: String,
    },
    /// Writing failed for another reason.
    #[error("{}: writing failed: {cause}; nothing was written to the final file", partial.display())]
    Write {
        /// The unfinished file.
        partial: PathBuf,
        /// Paths that were in the file when it was last known to be whole.
        completed_paths: u64,
        /// What HDF5 or the system says.
        cause: String,
    },
    /// The finished file could not be given its name.
    #[error("{}: complete, but cannot be renamed to {}: {source}; rename it by hand", partial.display(), target.display())]
    Rename {
        /// The finished file.
        partial: PathBuf,
        /// The name it should have.
        target: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// A leftover file could not be removed.
    #[error("{}: cannot be removed: {source}", partial.display())]
    Remove {
        /// The unfinished file.
        partial: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The free space of a disk could not be asked for.
    #[error("{}: cannot ask for the free space: {source}", folder.display())]
    Space {
        /// The folder of the output file.
        folder: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// There is no such file, or it may not be read.
    #[error("{}: {source}; give a file written by `mc run`{}", path.display(), unfinished_hint(path))]
    NotOpened {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// The file is of another kind.
    #[error("{}: not an HDF5 file; give a file written by `mc run`", path.display())]
    NotHdf5 {
        /// The file.
        path: PathBuf,
    },
    /// HDF5, but of another program.
    #[error("{}: an HDF5 file, but not one of this program (no format_name = \"{}\"); give a file written by `mc run`", path.display(), super::FORMAT_NAME)]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The format is newer than this program.
    #[error(
        "{}: written in format {major}.{minor}, and this program reads up to {}.x; use a newer version of mc",
        path.display(), super::FORMAT_VERSION.0
    )]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its major format version.
        major: u32,
        /// Its minor format version.
        minor: u32,
    },
    /// The run that writes the file has not ended, or was killed.
    #[error(
        "{}: the run that writes this file has not ended, or was killed after {completed_paths} of {paths} paths; \
         it holds no statistics. Wait for it, or run again", path.display()
    )]
    Unfinished {
        /// The file.
        path: PathBuf,
        /// Paths in the file.
        completed_paths: u64,
        /// Paths asked for.
        paths: u64,
    },
    /// The file is one of ours and cannot be read.
    #[error("{}: damaged or cut short ({cause}); copy it again from its origin, or run again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What HDF5 says.
        cause: String,
    },
}

/// What the operating system said, if HDF5 passed it on. HDF5 keeps it only as text inside its error stack.
pub(super) fn system_error(error: &hdf5::Error) -> Option<io::Error> {
    let frames = error.stack()?;
    frames.iter().find_map(|frame| {
        let text = frame.description();
        let number = text.split_once("errno = ")?.1;
        let digits = number.split(|c: char| !c.is_ascii_digit()).next()?;
        digits.parse().ok().filter(|&code| code != 0).map(io::Error::from_raw_os_error)
    })
}

/// Whether there is no room left: the disk, a quota, or a limit on the size of a file.
pub(super) fn is_full(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge)
}

/// One line on what went wrong.
pub(super) fn cause(error: &hdf5::Error) -> String {
    system_error(error).map_or_else(|| error.to_string(), |system| system.to_string())
}

/// Whoever asks for a file that is still being written should be told so.
fn unfinished_hint(path: &Path) -> String {
    let partial = super::partial_path(path);
    if !path.exists() && partial.exists() {
        format!("; {} exists: its run has not ended, or was killed", partial.display())
    } else {
        String::new()
    }
}
