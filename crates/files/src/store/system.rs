//! The file system: internal files of this program, renaming of finished files, and free disk
//! space.
//!
//! The names of internal files are predictable, so anything may have them: a link to somebody
//! else's file, or a pipe, which would block whoever opens it. Only regular files are opened and
//! removed, and a new file is always created from scratch.

use super::StoreError;
use rustix::fs::OFlags;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::os::unix::fs::{MetadataExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};

/// Open a regular file that exists. Links are not followed, and a pipe does not block.
pub(super) fn open(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits() as i32;
    let file = match options.custom_flags(flags).open(path) {
        // The system's message about a link or a pipe is misleading.
        Err(_) if fs::symlink_metadata(path).is_ok_and(|there| !there.is_file()) => {
            return Err(no_file(path));
        }
        opened => opened?,
    };
    if file.metadata()?.is_file() {
        Ok(file)
    } else {
        Err(no_file(path))
    }
}

/// Create a file. A leftover regular file of this name is removed first.
pub(super) fn create(path: &Path) -> io::Result<File> {
    remove(path)?;
    File::options().create_new(true).write(true).open(path)
}

/// Remove a regular file, if there is one. Anything else of this name is an error.
pub(super) fn remove(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(there) if !there.is_file() => Err(no_file(path)),
        Ok(_) => fs::remove_file(path),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    }
}

/// The identity of a file on this machine; none if there is no such file.
pub(super) fn identity(path: &Path) -> Option<(u64, u64)> {
    fs::symlink_metadata(path)
        .ok()
        .map(|there| (there.dev(), there.ino()))
}

fn no_file(path: &Path) -> io::Error {
    let name = path.file_name().unwrap_or_default().display();
    io::Error::other(format!(
        "{name} is not a regular file and was not created by mc; move it"
    ))
}

/// Give a file, which must be complete and on the disk, the name `target`, through a hard link if
/// possible. Nothing is replaced except a regular file, and that only with `force`; the new file
/// then gets the permissions of the old one. `link` is a temporary name that keeps the first name
/// valid even if a file is replaced. `partial` is named in messages.
pub(super) fn give_name(
    results: &Path,
    link: &Path,
    target: &Path,
    partial: &Path,
    force: bool,
) -> Result<(), StoreError> {
    let failed = |source: io::Error| match source.kind() {
        io::ErrorKind::AlreadyExists => StoreError::Appeared {
            partial: partial.to_owned(),
            target: target.to_owned(),
        },
        _ => StoreError::Rename {
            partial: results.to_owned(),
            target: target.to_owned(),
            source,
        },
    };
    let there = fs::symlink_metadata(target).ok();
    match &there {
        Some(there) if force && !there.is_file() => {
            return Err(StoreError::InTheWay {
                path: target.to_owned(),
            });
        }
        Some(there)
            if force
                && there.permissions() != fs::metadata(results).map_err(failed)?.permissions() =>
        {
            fs::set_permissions(results, there.permissions()).map_err(failed)?;
        }
        _ => {}
    }
    let named = match force {
        false => fs::hard_link(results, target),
        true => remove(link)
            .and_then(|()| fs::hard_link(results, link))
            .and_then(|()| fs::rename(link, target)),
    };
    match named {
        // Not every file system has hard links.
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
            if !force && fs::symlink_metadata(target).is_ok() {
                return Err(failed(io::ErrorKind::AlreadyExists.into()));
            }
            fs::rename(results, target).map_err(failed)?;
        }
        named => named.map_err(failed)?,
    }
    // Not every file system can sync folders; the contents of the file are on the disk already.
    let _ = sync_folder(&parent(target));
    Ok(())
}

/// Whether `target` is a second name of `results`: then the file already has its name, and only its
/// first name remains to be removed.
pub(super) fn has_name(results: &Path, target: &Path) -> bool {
    identity(target).is_some_and(|there| identity(results) == Some(there))
}

/// The folder that contains a file; `.` for a bare file name.
pub(super) fn parent(target: &Path) -> PathBuf {
    target
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
        .to_owned()
}

/// Write the names in a folder to the disk.
pub(super) fn sync_folder(folder: &Path) -> io::Result<()> {
    match File::open(folder)?.sync_all() {
        // On a file system that cannot sync folders this step is left out.
        Err(error)
            if matches!(
                error.kind(),
                io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported
            ) =>
        {
            Ok(())
        }
        synced => synced,
    }
}

/// Check that the disk of a folder has room for this number of bytes. This is checked before a long
/// run, so that it does not fail at its end.
pub fn check_space(folder: &Path, needed: u64) -> Result<(), StoreError> {
    // The folder of a bare file name is the empty path.
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let disk = rustix::fs::statvfs(folder).map_err(|error| StoreError::Space {
        folder: folder.to_owned(),
        source: error.into(),
    })?;
    let free = disk.f_bavail.saturating_mul(disk.f_frsize);
    // Some file systems do not know their size and report zero blocks in total.
    if disk.f_blocks > 0 && free < needed {
        return Err(StoreError::TooLittleSpace {
            folder: folder.to_owned(),
            needed,
            free,
        });
    }
    Ok(())
}
