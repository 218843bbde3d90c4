//! How a finished file gets its name: in one step, and such that nothing is replaced unasked.

use super::{StoreError, own};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Give a file, which must be complete and on the disk, the name `target`, by a second name of the
/// same file where that is possible. Nothing is replaced except a regular file, and that only with
/// `force`; the new file then gets the permissions of the old one. `link` is a name for a moment,
/// with which the first name stays even where a file is replaced. `partial` is named in messages.
pub(super) fn give_name(
    results: &Path,
    link: Option<&Path>,
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
    let named = match link {
        _ if !force => fs::hard_link(results, target),
        Some(link) => own::remove(link)
            .and_then(|()| fs::hard_link(results, link))
            .and_then(|()| fs::rename(link, target)),
        None => fs::rename(results, target),
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

/// Whether `target` is a second name of `results`: then the file has its name already, and only its
/// first name is left to be removed.
pub(super) fn has_name(results: &Path, target: &Path) -> bool {
    own::identity(target).is_some_and(|there| own::identity(results) == Some(there))
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
