//! Writing the file of a run, once its statistics are known.

use super::error::{cause, is_full, system_error};
use super::growing::GrowingTable;
use super::variable::{Growth, Place};
use super::workshop::{RESULTS, Workshop};
use super::{StoreError, seal};
use crate::dataset::rows::{self, Along};
use crate::dataset::{Destination as _, Rows, header, layout, run};
use crate::engine::{Part, Status};
use crate::provenance::Provenance;
use crate::scenario::Bearing;
use crate::stats::{BlockResult, Record, Summary};
use hdf5::File;
use hdf5::file::{FileCloseDegree, LibraryVersion};
use hdf5::plist::file_create::{AttrCreationOrder, LinkCreationOrder};
use std::fs;
use std::path::Path;

/// Number of values in a chunk of per-path data. As reals they take 128 kB, so that one chunk of
/// every variable fits into HDF5's cache.
const CHUNK: usize = 16_384;

/// A file that is being written, in the folder `NAME.partial`.
///
/// Rows must arrive in the order of their paths. Dropping a writer without `finish` leaves no file
/// behind.
///
/// # When the disk is full
///
/// The first error of a write or a flush is final: the HDF5 handles are leaked on purpose, and
/// every later call returns an error. Closing such a file crashes some versions of the HDF5
/// library, and others report success.
#[derive(Debug)]
pub struct Writer {
    workshop: Workshop,
    /// The open file; `None` after a write has failed.
    open: Option<Open>,
    /// Why the file is no longer open.
    failure: Option<Failure>,
    /// Number of paths appended.
    appended: u64,
}

/// The handles of an open file. They must not be dropped after a write error.
#[derive(Debug)]
struct Open {
    place: Place,
    tables: Vec<(Along, GrowingTable)>,
    bearing: Option<Bearing>,
}

/// The first failure, kept so that every later call can report it again.
#[derive(Clone, Debug)]
struct Failure {
    cause: String,
    full: bool,
}

impl Writer {
    /// Start a file: root attributes, coordinates, and the empty variables of what is recorded. The
    /// target itself is not touched before `finish`. With `force`, an existing file of this name is
    /// replaced, and what an unfinished run to it left behind is removed.
    pub fn create(target: &Path, header: &Provenance, record: &Record, force: bool) -> Result<Writer, StoreError> {
        Writer::within(Workshop::open(target, force)?, header, record)
    }

    /// The same in a folder that exists already.
    pub(super) fn within(workshop: Workshop, header: &Provenance, record: &Record) -> Result<Writer, StoreError> {
        let path = workshop.path(RESULTS);
        // An earlier attempt to finish the run may have left a file of this name.
        let _ = fs::remove_file(&path);
        let file = create_file(&path)
            .map_err(|error| StoreError::NotCreated { partial: path.clone(), cause: cause(&error) })?;
        let place = Place::new(file, header.units.clone());
        let open = Some(Open { place, tables: Vec::new(), bearing: header.bearing });
        let mut writer = Writer { workshop, open, failure: None, appended: 0 };
        writer.guarded(|open| open.define(header, record))?;
        Ok(writer)
    }

    /// Append the rows of the next block.
    pub fn append(&mut self, block: &BlockResult) -> Result<(), StoreError> {
        self.append_rows(Rows::from(block))
    }

    /// Append the rows of consecutive paths.
    pub fn append_rows(&mut self, rows: Rows) -> Result<(), StoreError> {
        self.guarded(|open| open.append(rows))?;
        self.appended += rows.paths;
        Ok(())
    }

    /// Write what ended the run before its last path.
    pub fn ended_by(&mut self, reason: &str) -> Result<(), StoreError> {
        self.guarded(|open| header::write_ended_by(&mut open.place, reason))
    }

    /// Write which part of a run this is, and keep the state of the part, from which it can be
    /// joined to the others.
    pub(super) fn part(&mut self, part: Part, state: &[u8]) -> Result<(), StoreError> {
        self.guarded(|open| {
            header::write_part(&mut open.place, part)?;
            open.place.write_variable(&layout::PART_STATE, state)
        })
    }

    /// Write the statistics, and give the file its name. At every moment the name belongs to no
    /// file (or to the earlier one), or to the finished file.
    pub fn finish(mut self, summary: &Summary, status: Status) -> Result<(), StoreError> {
        let paths = summary.completed_paths;
        let appended = self.appended;
        self.guarded(|open| {
            if open.tables.iter().any(|(along, _)| *along == Along::Path) && appended != paths {
                return Err(format!("the statistics are of {paths} paths, but {appended} were appended").into());
            }
            open.finish(summary, status)
        })?;
        // Everything is written by now, so closing the file writes nothing more.
        drop(self.open.take());
        // Some file systems report only at this point that they are full.
        seal::seal(&self.workshop.path(RESULTS))
            .map_err(|error| self.fail(Failure { full: is_full(&error), cause: error.to_string() }))?;
        self.workshop.publish()
    }

    /// Do something with the open file. After the first failure, every call returns that failure.
    fn guarded(&mut self, work: impl FnOnce(&mut Open) -> hdf5::Result<()>) -> Result<(), StoreError> {
        let Some(open) = &mut self.open else {
            return Err(self.error());
        };
        work(open).map_err(|error| {
            let full = system_error(&error).is_some_and(|system| is_full(&system));
            self.fail(Failure { cause: cause(&error), full })
        })
    }

    /// Record the failure and leak the handles, so that the file is never touched again.
    fn fail(&mut self, failure: Failure) -> StoreError {
        std::mem::forget(self.open.take());
        self.failure = Some(failure);
        self.error()
    }

    fn error(&self) -> StoreError {
        let failure = self.failure.clone();
        let Failure { cause, full } = failure.unwrap_or(Failure { cause: "the file is closed".into(), full: false });
        self.workshop.failure(cause, full)
    }
}

impl Drop for Writer {
    /// Closing the file writes what is still in memory, and an error then may crash the library. So
    /// the file is flushed first, and leaked if that fails.
    fn drop(&mut self) {
        if let Some(open) = self.open.take()
            && open.place.file.flush().is_err()
        {
            std::mem::forget(open);
        }
    }
}

/// Create an empty file of the kind that netCDF-4 readers expect.
pub(super) fn create_file(path: &Path) -> hdf5::Result<File> {
    File::with_options()
        // With V18 the file stays readable after the process is killed; V110 and later mark it as
        // open for writing. A strong close closes the file even if a handle to one of its objects
        // still exists.
        .with_fapl(|access| {
            access.libver_bounds(LibraryVersion::V18, LibraryVersion::V110).fclose_degree(FileCloseDegree::Strong)
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

impl Open {
    fn define(&mut self, header: &Provenance, record: &Record) -> hdf5::Result<()> {
        let Open { place, tables, .. } = self;
        run::write_start(place, header)?;
        rows::empty_tables(record, header, |table| {
            let growth = growth(table.along, header, record);
            tables.push((table.along, GrowingTable::define(place, &table, growth)?));
            Ok(())
        })
    }

    fn append(&mut self, block: Rows) -> hdf5::Result<()> {
        rows::tables(&block, self.bearing, |rows| {
            match self.tables.iter_mut().find(|(along, _)| *along == rows.along) {
                Some((_, table)) => table.push(&rows),
                None => Ok(()),
            }
        })
    }

    fn finish(&mut self, summary: &Summary, status: Status) -> hdf5::Result<()> {
        self.tables.iter_mut().try_for_each(|(_, table)| table.write_all())?;
        run::write_end(&mut self.place, summary, status)?;
        self.place.file.flush()
    }
}

/// The chunks of the variables along a dimension.
fn growth(along: Along, header: &Provenance, record: &Record) -> Growth {
    match along {
        Along::Path => Growth { rows: (header.paths as usize).clamp(1, CHUNK), columns: 1 },
        Along::Event => Growth { rows: CHUNK, columns: 1 },
        Along::Trajectory => {
            let columns = header.time.len().min(CHUNK);
            let rows = (CHUNK / columns).clamp(1, record.trajectories.min(header.paths).max(1) as usize);
            Growth { rows, columns }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_writer_may_live_on_a_thread_of_its_own() {
        fn check<T: Send>() {}
        check::<Writer>();
    }
}
