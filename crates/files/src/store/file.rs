//! An HDF5 file being written. Nothing counts as written before it has been read back.
//!
//! HDF5 delays writing, in part until a variable or the file is closed, and may then fail silently.
//! A file is therefore written in a way that detects every failure:
//!
//! ```text
//! write     values go to the system at once, because there is no sieve buffer
//! flush     writes what the library still holds, and its result is checked
//! close     has nothing left to write
//! compare   the file is opened again, and all of it is compared with what was written
//! checksum  of the whole file, appended and synced to the disk with it
//! ```
//!
//! After a failed write or flush the handles are leaked on purpose, and the file is never touched
//! again. Closing such a file crashes some versions of the library, and others report success.

use super::errors::{WriteFailure, cause};
use super::staging::{RESULTS, Staging};
use super::variables::{Contents, OpenFile};
use super::written::Written;
use super::{StoreError, system};
use crate::saved::checksum::{self, superblock};
use hdf5::File;
use hdf5::file::{FileCloseDegree, LibraryVersion};
use hdf5::plist::file_create::{AttrCreationOrder, LinkCreationOrder};
use std::fs;
use std::path::{Path, PathBuf};

/// A file that is being written.
#[derive(Debug)]
pub(super) struct StagedFile {
    path: PathBuf,
    /// The open file, or why nothing more can be written.
    place: Result<OpenFile, WriteFailure>,
}

impl StagedFile {
    /// Create the results in a staging directory; those of an earlier attempt are removed.
    pub fn create(staging: &Staging) -> Result<StagedFile, StoreError> {
        staging.check(None)?;
        let path = staging.path(RESULTS);
        system::remove(&path).map_err(|error| staging.failed(&error))?;
        StagedFile::at(path)
    }

    fn at(path: PathBuf) -> Result<StagedFile, StoreError> {
        let file = create(&path).map_err(|error| StoreError::NotCreated {
            partial: path.clone(),
            cause: cause(&error),
        })?;
        let place = Ok(OpenFile::new(file));
        Ok(StagedFile { path, place })
    }

    /// Do something with the file. After the first failure, every call returns that failure.
    pub fn write(
        &mut self,
        work: impl FnOnce(&mut OpenFile) -> hdf5::Result<()>,
    ) -> Result<(), WriteFailure> {
        let place = self.place.as_mut().map_err(|failure| failure.clone())?;
        work(place).map_err(|error| {
            let failure = WriteFailure::from(error);
            std::mem::forget(std::mem::replace(&mut self.place, Err(failure.clone())));
            failure
        })
    }

    /// Close the file, whose variables must all be flushed, compare it with the intended contents,
    /// and append its checksum.
    pub fn finish(mut self) -> Result<(), WriteFailure> {
        let mut written = Written::default();
        self.write(|place| {
            place.file.flush()?;
            written = std::mem::take(&mut place.written);
            Ok(())
        })?;
        let not_closed = WriteFailure {
            cause: "HDF5 could not close the file".into(),
            full: false,
        };
        self.place = Err(not_closed.clone());
        if superblock(&mut fs::File::open(&self.path)?)?.is_none_or(|superblock| superblock.is_open)
        {
            return Err(not_closed);
        }
        let failed = |cause| WriteFailure { cause, full: false };
        let file = Contents(File::open(&self.path)?);
        written.compare(&file).map_err(failed)?;
        drop(file);
        // Some file systems report only here that they are full.
        Ok(checksum::append(&self.path)?)
    }
}

impl Drop for StagedFile {
    /// An abandoned file is closed if nothing remains to be written, and leaked otherwise.
    fn drop(&mut self) {
        let _ = self.write(|place| place.file.flush());
    }
}

/// Create an empty file of the kind that netCDF-4 readers expect.
fn create(path: &Path) -> hdf5::Result<File> {
    File::with_options()
        // With V18 the file stays readable after the process is killed; V110 and later mark it as
        // open for writing. A strong close closes the file even if a handle to one of its objects
        // still exists. Without a sieve buffer no values wait for the close of their variable.
        .with_fapl(|access| {
            access
                .libver_bounds(LibraryVersion::V18, LibraryVersion::V110)
                .fclose_degree(FileCloseDegree::Strong)
                .sieve_buf_size(0)
        })
        // netCDF-4 appends only to files that record the order in which their variables were
        // created. Equal runs give equal files only if no modification times are stored.
        .with_fcpl(|creation| {
            creation
                .link_creation_order(LinkCreationOrder::Indexed)
                .attr_creation_order(AttrCreationOrder::Indexed)
                .obj_track_times(false)
        })
        .create_excl(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::written::Sum;
    use stickslip::dataset::{Column, ColumnView, Dataset, ElementType, Entry, layout};
    use stickslip::stats::Units;

    /// A file that was to hold something else than was written cannot be finished.
    #[test]
    fn what_is_not_in_the_file_as_it_was_to_be_written_is_found() {
        let changes: [fn(&mut Written); 6] = [
            |_| (),
            |written| written.dataset.entries[0].column = Column::F64(vec![0.5, 0.25]),
            |written| {
                let (axes, attributes) = (vec!["lost".into()], Vec::new());
                let entry = Entry {
                    name: "lost".into(),
                    axes,
                    attributes,
                    column: Column::F64(Vec::new()),
                };
                let mut sum = Sum::of(ElementType::F64);
                sum.add(ColumnView::F64(&[1.0]));
                written.rows.push((entry, sum));
            },
            |written| written.dataset.set_attribute("title", "another"),
            |written| written.dataset.entries[0].attributes[0].1 = "another".into(),
            |written| drop(written.dataset.entries.pop()),
        ];
        for (i, change) in changes.into_iter().enumerate() {
            let here = tempfile::tempdir().expect("a folder");
            let path = here.path().join("a.h5");
            let mut draft = StagedFile::at(path).expect("made");
            let mut dataset = Dataset::new(&Units::default());
            dataset.set_attribute("title", "a title");
            dataset.set_attribute("program_version", "1");
            dataset.set_attribute("git_hash", "1");
            dataset.write(&layout::QUANTILE, &[0.25, 0.5]);
            let written = draft.write(|place| {
                place.write(dataset)?;
                change(&mut place.written);
                Ok(())
            });
            written.expect("written");
            assert_eq!(draft.finish().is_ok(), i == 0, "change {i}");
        }
    }
}
