//! Writing a file in one go, when everything that it holds is known.

use super::StoreError;
use super::draft::Draft;
use super::folder::RESULTS;
use super::variable::OpenFile;
use super::workshop::Workshop;
use crate::stats::Units;
use std::path::Path;

/// Create the folder `NAME.partial`, let `fill` write the file in it, and give the file its final
/// name. With `force`, an existing file of this name is replaced.
pub(super) fn write_at_once(
    target: &Path,
    units: Units,
    force: bool,
    fill: impl FnOnce(&mut OpenFile) -> hdf5::Result<()>,
) -> Result<(), StoreError> {
    let workshop = Workshop::open(target, force)?;
    let mut draft = Draft::create(&workshop.path(RESULTS), units)?;
    let written = draft.write(fill).and_then(|()| draft.finish());
    written.map_err(|failure| workshop.failure(failure.cause, failure.full))?;
    workshop.publish()
}
