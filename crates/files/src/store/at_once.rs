//! Writing a data set to a file in one go.

use super::StoreError;
use super::folder::RESULTS;
use super::staged_file::StagedFile;
use super::staging::Staging;
use crate::dataset::Dataset;
use std::path::Path;

/// Write a data set to `target`. Like every file it is made in the folder `NAME.partial`. With
/// `force`, an existing file of this name is replaced.
pub fn write_dataset(target: &Path, dataset: Dataset, force: bool) -> Result<(), StoreError> {
    let staging = Staging::open(target, force)?;
    let mut draft = StagedFile::create(&staging.path(RESULTS))?;
    let written = draft
        .write(|place| place.write(dataset))
        .and_then(|()| draft.finish());
    written.map_err(|failure| staging.failure(failure.cause, failure.full))?;
    staging.publish()
}
