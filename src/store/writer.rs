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

/// Values in a chunk of per-path data: 128 kB of reals, so that a chunk of every variable fits into
/// HDF5's cache.
const CHUNK: usize = 16_384;

/// A file that is being written, in the folder `NAME.partial`.
///
/// Rows must arrive in the order of their paths. Dropping a writer without `finish` leaves nothing
/// behind.
///
/// # When the disk is full
///
/// The first error of a write or a flush is final: the HDF5 handles are leaked on purpose, and
/// every later call returns an error. Closing such a file crashes in some versions of the HDF5
/// library, and reports success in others.
#[derive(Debug)]
pub struct Writer {
    workshop: Workshop,
    /// Gone once a write has failed.
    open: Option<Open>,
    /// Why it is gone.
    failure: Option<Failure>,
    /// Paths appended.
    appended: u64,
}

/// The handles of an open file; on a write error they must not be dropped.
#[derive(Debug)]
struct Open {
    place: Place,
    tables: Vec<(Along, GrowingTable)>,
    bearing: Option<Bearing>,
}

/// What went wrong, for as often as somebody asks.
#[derive(Clone, Debug)]
struct Failure {
    cause: String,
    full: bool,
}

impl Writer {
    /// Start a file: root attributes, coordinates, and the empty variables of what is recorded.
    /// Nothing of the target is touched before `finish`. With `force`, a file of this name is
    /// replaced, and what an unfinished run to it left behind goes.
    pub fn create(target: &Path, header: &Provenance, record: &Record, force: bool) -> Result<Writer, StoreError> {
        Writer::within(Workshop::open(target, force)?, header, record)
    }

    /// The same in a folder that is there.
    pub(super) fn within(workshop: Workshop, header: &Provenance, record: &Record) -> Result<Writer, StoreError> {
        let path = workshop.path(RESULTS);
        // An earlier attempt to finish the run may have left it.
        let _ = fs::remove_file(&path);
        let file = create_file(&path)
            .map_err(|error| StoreError::NotCreated { partial: path.clone(), cause: cause(&error) })?;
        let place = Place { file, units: header.units.clone() };
        let open = Some(Open { place, tables: Vec::new(), bearing: header.bearing });
        let mut writer = Writer { workshop, open, failure: None, appended: 0 };
        writer.guarded(|open| open.define(header, record))?;
        Ok(writer)
    }

    /// Add the paths of the next block.
    pub fn append(&mut self, block: &BlockResult) -> Result<(), StoreError> {
        self.append_rows(Rows::from(block))
    }

    /// Add consecutive paths.
    pub fn append_rows(&mut self, rows: Rows) -> Result<(), StoreError> {
        self.guarded(|open| open.append(rows))?;
        self.appended += rows.paths;
        Ok(())
    }

    /// Say what ends the run before its last path.
    pub fn ended_by(&mut self, reason: &str) -> Result<(), StoreError> {
        self.guarded(|open| header::write_ended_by(&mut open.place, reason))
    }

    /// Say which part of a run it is, and keep its state, from which it can be joined to others.
    pub(super) fn part(&mut self, part: Part, state: &[u8]) -> Result<(), StoreError> {
        self.guarded(|open| {
            header::write_part(&mut open.place, part)?;
            open.place.put(&layout::PART_STATE, state)
        })
    }

    /// Write the statistics, and give the file its name: at every moment there is either no file of
    /// that name (or the earlier one), or a finished one.
    pub fn finish(mut self, summary: &Summary, status: Status) -> Result<(), StoreError> {
        let paths = summary.completed_paths;
        let appended = self.appended;
        self.guarded(|open| {
            if open.tables.iter().any(|(along, _)| *along == Along::Path) && appended != paths {
                return Err(format!("the statistics are of {paths} paths, but {appended} were appended").into());
            }
            open.finish(summary, status)
        })?;
        // Everything is written by now, so closing has nothing left to write.
        drop(self.open.take());
        // Some file systems notice only now that they are full.
        seal::seal(&self.workshop.path(RESULTS))
            .map_err(|error| self.latch(Failure { full: is_full(&error), cause: error.to_string() }))?;
        self.workshop.publish()
    }

    /// Do something with the open file, unless an earlier write has failed; latch the first
    /// failure.
    fn guarded(&mut self, work: impl FnOnce(&mut Open) -> hdf5::Result<()>) -> Result<(), StoreError> {
        let Some(open) = &mut self.open else {
            return Err(self.error());
        };
        work(open).map_err(|error| {
            let full = system_error(&error).is_some_and(|system| is_full(&system));
            self.latch(Failure { cause: cause(&error), full })
        })
    }

    /// Never touch the file again.
    fn latch(&mut self, failure: Failure) -> StoreError {
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
    /// What is not written yet is of no use, but to close the file writes it; an error then may
    /// crash the library.
    fn drop(&mut self) {
        if let Some(open) = self.open.take()
            && open.place.file.flush().is_err()
        {
            std::mem::forget(open);
        }
    }
}

/// An empty file of the kind that netCDF-4 readers expect.
pub(super) fn create_file(path: &Path) -> hdf5::Result<File> {
    File::with_options()
        // V18 keeps the file readable after the process is killed; V110 and later mark it as open
        // for writing. A strong close closes the file even if a handle to one of its objects is
        // still around.
        .with_fapl(|access| {
            access.libver_bounds(LibraryVersion::V18, LibraryVersion::V110).fclose_degree(FileCloseDegree::Strong)
        })
        // netCDF-4 appends only to files that know the order in which their variables were made,
        // and equal runs give equal files only without modification times.
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

/// How the variables along a dimension are laid out.
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
