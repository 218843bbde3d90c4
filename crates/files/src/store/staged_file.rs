//! An HDF5 file while it is being written: nothing counts as written before it was read back.
//!
//! HDF5 writes late, some of it only when a variable or the file is closed, and then it may fail
//! without a word. So a file is written such that every failure is seen:
//!
//! ```text
//! write     values go to the system at once, because there is no sieve buffer
//! flush     writes what the library still holds, and its result is looked at
//! close     has nothing left to write
//! compare   the file is opened anew, and everything in it is compared with what was written
//! seal      a checksum of the whole file, synced to the disk with it
//! ```
//!
//! After a failed write or flush the handles are leaked on purpose, and the file is never touched
//! again. Closing such a file crashes some versions of the library, and others report success.

use super::StoreError;
use super::error::cause;
use super::failure::WriteFailure;
use super::read_back::Written;
use super::variable::OpenFile;
use crate::saved::seal::{self, superblock};
use hdf5::File;
use hdf5::file::{FileCloseDegree, LibraryVersion};
use hdf5::plist::file_create::{AttrCreationOrder, LinkCreationOrder};
use std::fs;
use std::path::{Path, PathBuf};

/// A file that is being written.
#[derive(Debug)]
pub(super) struct StagedFile {
    path: PathBuf,
    /// The open file; `None` after a failure.
    place: Option<OpenFile>,
}

impl StagedFile {
    /// Create a file, which must not exist.
    pub fn create(path: &Path) -> Result<StagedFile, StoreError> {
        let file = create(path).map_err(|error| StoreError::NotCreated {
            partial: path.to_owned(),
            cause: cause(&error),
        })?;
        Ok(StagedFile {
            path: path.to_owned(),
            place: Some(OpenFile::new(file)),
        })
    }

    /// Do something with the file. After the first failure nothing is done any more.
    pub fn write(
        &mut self,
        work: impl FnOnce(&mut OpenFile) -> hdf5::Result<()>,
    ) -> Result<(), WriteFailure> {
        let closed = || WriteFailure {
            cause: "the file is closed".into(),
            full: false,
        };
        let done = work(self.place.as_mut().ok_or_else(closed)?);
        done.map_err(|error| {
            std::mem::forget(self.place.take());
            error.into()
        })
    }

    /// Close the file, of which every variable must be flushed, compare it with what was to be
    /// written, and seal it.
    pub fn finish(mut self) -> Result<(), WriteFailure> {
        let mut written = Written::default();
        self.write(|place| {
            place.file.flush()?;
            written = std::mem::take(&mut place.written);
            Ok(())
        })?;
        drop(self.place.take());
        if superblock(&mut fs::File::open(&self.path)?)?.is_none_or(|superblock| superblock.is_open)
        {
            return Err(WriteFailure {
                cause: "HDF5 could not close the file".into(),
                full: false,
            });
        }
        written.compare(&self.path)?;
        // Some file systems report only at this point that they are full.
        Ok(seal::seal(&self.path)?)
    }
}

impl Drop for StagedFile {
    /// A file that is given up is closed if nothing is left to be written, and leaked otherwise.
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
    use crate::dataset::{Column, ColumnView, Dataset, ElementType, Entry, layout};
    use crate::store::read_back::Sum;
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
            let mut draft = StagedFile::create(&path).expect("made");
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
