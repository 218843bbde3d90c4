//! What there is under the names of a file: the one place that decides what a run, a sweep or
//! `mc resume` meets, and whether it is ours.
//!
//! ```text
//! NAME           a finished file, which content.rs checks
//! NAME.partial   what is unfinished: the folder of a run, or the points of a sweep in a file
//! ```

use super::folder::{self, RESULTS, STATE, partial_path};
use super::naming::has_name;
use super::{StoreError, own, reader};
use crate::saved::seal;
use std::fs::{self, File};
use std::path::Path;

/// What lies under `NAME.partial`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Partial {
    /// Nothing.
    Nothing,
    /// The folder in which a file was being made.
    Folder {
        /// Whether a run is saved in it.
        is_saved: bool,
    },
    /// The points of a sweep, or another file that this program has sealed.
    File,
    /// An HDF5 file without a seal: another program has changed or written it. It is not opened.
    Unsealed,
    /// The file that is finished already; only this name of it is left to be removed.
    Named,
    /// Something that this program has not made.
    Foreign,
}

/// Look at what lies under `NAME.partial`.
pub(super) fn unfinished(target: &Path) -> Partial {
    let partial = partial_path(target);
    let Ok(there) = fs::symlink_metadata(&partial) else {
        return Partial::Nothing;
    };
    match () {
        () if there.is_dir() && folder::is_ours(&partial) => {
            match has_name(&partial.join(RESULTS), target) {
                true => Partial::Named,
                false => Partial::Folder {
                    is_saved: fs::exists(partial.join(STATE)).unwrap_or(true),
                },
            }
        }
        () if there.is_file() && has_name(&partial, target) => Partial::Named,
        () if there.is_file() && has_mark(&partial) => Partial::File,
        () if there.is_file() && reader::check_file(&partial).is_ok() => Partial::Unsealed,
        () => Partial::Foreign,
    }
}

fn has_mark(path: &Path) -> bool {
    let opened = own::open(path, File::options().read(true));
    opened
        .and_then(|mut file| seal::has_mark(&mut file))
        .unwrap_or(false)
}

/// Whether `NAME.partial` holds a sweep that is not finished.
pub fn is_unfinished_sweep(target: &Path) -> bool {
    unfinished(target) == Partial::File
}

/// Remove what lies under `NAME.partial`, so that something new is begun there. Without `force`, a
/// saved run or sweep is an error. What this program has not made is never removed.
pub(super) fn make_room(target: &Path, force: bool) -> Result<(), StoreError> {
    let partial = partial_path(target);
    let left_over = || StoreError::LeftOver {
        partial: partial.clone(),
        target: target.to_owned(),
    };
    match unfinished(target) {
        Partial::Folder { is_saved: true } | Partial::File if !force => Err(left_over()),
        Partial::Unsealed => Err(StoreError::NotSealed { path: partial }),
        Partial::Foreign => Err(StoreError::InTheWay { path: partial }),
        Partial::Nothing => Ok(()),
        Partial::Folder { .. } | Partial::File | Partial::Named => clear(target),
    }
}

/// Remove what lies under `NAME.partial`, which must be ours.
pub(super) fn clear(target: &Path) -> Result<(), StoreError> {
    let partial = partial_path(target);
    if !partial.is_dir() {
        return fs::remove_file(&partial).map_err(|source| StoreError::Remove { partial, source });
    }
    if let Some(name) = folder::foreign_file(&partial) {
        return Err(StoreError::InTheWay {
            path: partial.join(name),
        });
    }
    folder::clear(&partial).map_err(|source| StoreError::Remove { partial, source })
}
