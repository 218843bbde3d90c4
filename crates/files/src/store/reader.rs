//! Reading a finished file back.

use super::error::{cause, not_opened, system_error};
use super::folder::{STATE, file_of, partial_path};
use super::lock::Lock;
use super::{StoreError, state};
use crate::dataset::header::{FORMAT, Format};
use crate::dataset::{Source, StoredRun as Stored, read_attribute};
use crate::saved::seal::{self, superblock};
use hdf5::File;
use std::io;
use std::path::{Path, PathBuf};
use stickslip::engine::Status;

/// Files larger than this many bytes are opened without reading them through first, which would
/// take minutes.
const LARGEST: u64 = 1 << 30;

/// The target of an unfinished run, if there is one. `path` is either the target itself or the
/// folder in which the run is saved.
pub(super) fn unfinished(path: &Path) -> Option<PathBuf> {
    let target = if path.is_dir() {
        file_of(path)
    } else {
        path.to_owned()
    };
    let is_saved = (path.is_dir() || !path.exists()) && partial_path(&target).join(STATE).exists();
    is_saved.then_some(target)
}

/// Read the state of an unfinished run, given its target.
fn read_unfinished(target: &Path) -> Result<Stored, StoreError> {
    let state = state::read(&partial_path(target).join(STATE))?;
    let (header, completed_paths, part) =
        (state.header(), state.paths(), state.question.asked.part);
    let status = if Lock::is_taken(target) {
        Status::Running
    } else {
        Status::Interrupted
    };
    let summary = state.so_far.totals.totals().summary();
    let unfinished = Some(target.to_owned()).filter(|_| status != Status::Running);
    Ok(Stored {
        header,
        status,
        part,
        ended_by: None,
        unfinished,
        completed_paths,
        summary,
    })
}

/// Read the header and the statistics of a finished file, or of a run that is not finished.
pub fn read(path: &Path) -> Result<Stored, StoreError> {
    if let Some(target) = unfinished(path) {
        return read_unfinished(&target);
    }
    read_kind(path, FORMAT, Stored::read)
}

/// Check a file before the HDF5 library opens it, and return whether the file has a seal. The
/// library gives the same error for a missing, an unreadable and a foreign_file, and it follows
/// whatever address a flipped bit has made.
pub(super) fn check_file(path: &Path) -> Result<bool, StoreError> {
    check_is_hdf5(path)?;
    check_seal(path, LARGEST)
}

/// Compare a file with its seal, and return whether it has one. A wrong seal is an error. In larger
/// files than these the seal is found but the checksum is not computed.
pub(super) fn check_seal(path: &Path, largest: u64) -> Result<bool, StoreError> {
    let sealed = seal::is_right(path, largest);
    match sealed.map_err(not_opened(path))? {
        Some(false) => Err(damaged(path)(
            "its checksum does not match its contents".to_string(),
        )),
        sealed => Ok(sealed.is_some()),
    }
}

/// Check that a file begins as HDF5 files do.
pub(super) fn check_is_hdf5(path: &Path) -> Result<(), StoreError> {
    // Opening a pipe would wait for its other end.
    if std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir()) {
        return Err(StoreError::NotHdf5 {
            path: path.to_owned(),
        });
    }
    let mut file = std::fs::File::open(path).map_err(not_opened(path))?;
    match superblock(&mut file).map_err(not_opened(path))? {
        Some(_) => Ok(()),
        None => Err(StoreError::NotHdf5 {
            path: path.to_owned(),
        }),
    }
}

/// Whether a file has a checksum, right or wrong; its readers compare it. A file that another
/// program has changed has none. A file that is not an HDF5 file is an error.
pub fn is_sealed(path: &Path) -> Result<bool, StoreError> {
    check_is_hdf5(path)?;
    seal::is_there(path).map_err(not_opened(path))
}

/// Read a file of the kind and the format of this name and version. A file of another kind, of
/// another format, or a damaged one, is an error.
pub fn read_kind<T>(
    path: &Path,
    (name, (reads, _)): Format,
    read: impl FnOnce(&dyn Source) -> Result<T, String>,
) -> Result<T, StoreError> {
    check_file(path)?;
    let file = open(path)?;
    if read_attribute::<String>(&file, "format_name")
        .ok()
        .as_deref()
        != Some(name)
    {
        return Err(StoreError::Foreign {
            path: path.to_owned(),
        });
    }
    let version: String = read_attribute(&file, "format_version").map_err(damaged(path))?;
    let parts = version
        .split_once('.')
        .and_then(|(major, minor)| Some((major.parse().ok()?, minor.parse().ok()?)));
    let (major, minor) = parts.unwrap_or((u32::MAX, 0));
    if major != reads {
        return Err(StoreError::OtherFormat {
            path: path.to_owned(),
            major,
            minor,
            reads,
        });
    }
    read(&file).map_err(damaged(path))
}

/// The error of a file that could not be read.
pub(super) fn damaged(path: &Path) -> impl Fn(String) -> StoreError + Copy {
    move |cause| StoreError::Damaged {
        path: path.to_owned(),
        cause,
    }
}

pub(super) fn open(path: &Path) -> Result<File, StoreError> {
    File::open(path).map_err(|error| match system_error(&error) {
        Some(system) if system.kind() == io::ErrorKind::WouldBlock => StoreError::InUse {
            path: path.to_owned(),
        },
        Some(system) => not_opened(path)(system),
        None => damaged(path)(cause(&error)),
    })
}
