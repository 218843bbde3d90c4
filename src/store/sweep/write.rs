//! Writing the file of a sweep: a new file is written beside the earlier one and then replaces it.

use crate::dataset;
use crate::provenance::Provenance;
use crate::store::error::{cause, is_full, system_error};
use crate::store::variable::Place;
use crate::store::writer::create_file;
use crate::store::{StoreError, seal};
use crate::study::sweep::Sweep;
use std::fs;
use std::path::{Path, PathBuf};

/// Write a sweep to `path` in one step: at every moment there is either the earlier file or the new
/// one.
pub(super) fn replace(path: &Path, header: &Provenance, sweep: &Sweep) -> Result<(), StoreError> {
    let mut name = path.as_os_str().to_owned();
    name.push(".new");
    let beside = PathBuf::from(name);
    // A killed process may have left a file of this name. The lock excludes that another process is
    // writing it now.
    let _ = fs::remove_file(&beside);
    let file = create_file(&beside)
        .map_err(|error| StoreError::NotCreated { partial: beside.clone(), cause: cause(&error) })?;
    let mut place = Place::new(file, header.units.clone());
    let failed = |full: bool, cause: String| match full {
        true => StoreError::DiskFull { partial: beside.clone(), target: path.to_owned(), saved_paths: 0, cause },
        false => StoreError::Write { partial: beside.clone(), target: path.to_owned(), saved_paths: 0, cause },
    };
    if let Err(error) = dataset::sweep::write(&mut place, header, sweep).and_then(|()| place.file.flush()) {
        // The handles are leaked, because closing a file that could not be written may crash HDF5.
        std::mem::forget(place);
        return Err(failed(system_error(&error).is_some_and(|system| is_full(&system)), cause(&error)));
    }
    drop(place);
    seal::seal(&beside).map_err(|error| failed(is_full(&error), error.to_string()))?;
    rename(&beside, path)
}

/// Rename a complete file, and write the new name to the disk.
pub(super) fn rename(from: &Path, to: &Path) -> Result<(), StoreError> {
    let failed = |source| StoreError::Rename { partial: from.to_owned(), target: to.to_owned(), source };
    fs::rename(from, to).map_err(failed)?;
    let folder = to.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // Not every file system can sync folders; the contents of the file are on the disk already.
    let _ = fs::File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}
