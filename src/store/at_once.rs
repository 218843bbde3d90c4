//! Writing a file in one go, when everything that it holds is known.

use super::error::{cause, is_full, system_error};
use super::variable::Place;
use super::workshop::{RESULTS, Workshop};
use super::writer::create_file;
use super::{StoreError, seal};
use crate::stats::Units;
use std::path::Path;

/// Create the folder `NAME.partial`, let `fill` write the file in it, seal the file and give it its
/// final name. With `force`, an existing file of this name is replaced.
pub(super) fn write_at_once(
    target: &Path,
    units: Units,
    force: bool,
    fill: impl FnOnce(&mut Place) -> hdf5::Result<()>,
) -> Result<(), StoreError> {
    let workshop = Workshop::open(target, force)?;
    let path = workshop.path(RESULTS);
    let file =
        create_file(&path).map_err(|error| StoreError::NotCreated { partial: path.clone(), cause: cause(&error) })?;
    let mut place = Place::new(file, units);
    let written = fill(&mut place).and_then(|()| place.file.flush());
    if let Err(error) = written {
        // The handles are leaked, because closing a file that could not be written may crash HDF5.
        std::mem::forget(place);
        let full = system_error(&error).is_some_and(|system| is_full(&system));
        return Err(workshop.failure(cause(&error), full));
    }
    drop(place);
    seal::seal(&path).map_err(|error| workshop.failed(&error))?;
    workshop.publish()
}
