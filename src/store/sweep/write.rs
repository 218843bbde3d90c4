//! Writing the file of a sweep: a new file is written beside the earlier one and then replaces it.

use crate::dataset;
use crate::provenance::Provenance;
use crate::store::StoreError;
use crate::store::draft::{Draft, Failure};
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
    let mut draft = Draft::create(&beside, header.units.clone())?;
    let written = draft.write(|place| dataset::sweep::write(place, header, sweep)).and_then(|()| draft.finish());
    written.map_err(|Failure { cause, full }| match full {
        true => StoreError::DiskFull { partial: beside.clone(), target: path.to_owned(), saved_paths: 0, cause },
        false => StoreError::Write { partial: beside.clone(), target: path.to_owned(), saved_paths: 0, cause },
    })?;
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
