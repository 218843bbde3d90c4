//! Writing the file of a run, once its statistics are known.

use super::draft::Draft;
use super::failure::WriteFailure;
use super::folder::RESULTS;
use super::growing::GrowingTable;
use super::variable::{Growth, OpenFile};
use super::workshop::Workshop;
use super::{StoreError, own};
use crate::dataset::rows::{self, RowAxis};
use crate::dataset::{Destination as _, Rows, header, layout, run};
use crate::engine::{Part, Provenance, Status};
use crate::scenario::SensorBearing;
use crate::stats::{BlockResult, Record, Summary};
use std::path::Path;

/// Number of values in a chunk of per-path data. As reals they take 128 kB, so that one chunk of
/// every variable fits into HDF5's cache.
const CHUNK: usize = 16_384;

/// A file that is being written, in the folder `NAME.partial`.
///
/// Rows must arrive in the order of their paths. Dropping a writer without `finish` leaves no file
/// behind. The first error of a write is final, and every later call returns it again.
#[derive(Debug)]
pub struct Writer {
    workshop: Workshop,
    draft: Draft,
    tables: Vec<(RowAxis, GrowingTable)>,
    bearing: Option<SensorBearing>,
    /// Why nothing can be written any more.
    failure: Option<WriteFailure>,
    /// Number of paths appended.
    appended: u64,
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
        own::remove(&path).map_err(|error| workshop.failed(&error))?;
        let draft = Draft::create(&path, header.units.clone())?;
        let bearing = header.bearing;
        let mut writer = Writer { workshop, draft, tables: Vec::new(), bearing, failure: None, appended: 0 };
        writer.guarded(|place, tables| {
            run::write_start(place, header)?;
            rows::empty_tables(record, header, |table| {
                let growth = growth(table.along, header, record);
                tables.push((table.along, GrowingTable::define(place, &table, growth)?));
                Ok(())
            })
        })?;
        Ok(writer)
    }

    /// Append the rows of the next block.
    pub fn append(&mut self, block: &BlockResult) -> Result<(), StoreError> {
        self.append_rows(Rows::from(block))
    }

    /// Append the rows of consecutive paths.
    pub fn append_rows(&mut self, rows: Rows) -> Result<(), StoreError> {
        let bearing = self.bearing;
        self.guarded(|_, tables| {
            rows::tables(&rows, bearing, |rows| match tables.iter_mut().find(|(along, _)| *along == rows.along) {
                Some((_, table)) => table.push(&rows),
                None => Ok(()),
            })
        })?;
        self.appended += rows.paths;
        Ok(())
    }

    /// Write what ended the run before its last path.
    pub fn ended_by(&mut self, reason: &str) -> Result<(), StoreError> {
        self.guarded(|place, _| header::write_ended_by(place, reason))
    }

    /// Write which part of a run this is, and keep the state of the part, from which it can be
    /// joined to the others.
    pub(super) fn part(&mut self, part: Part, state: &[u8]) -> Result<(), StoreError> {
        self.guarded(|place, _| {
            header::write_part(place, part)?;
            place.write_variable(&layout::PART_STATE, state)
        })
    }

    /// Write the statistics, and give the file its name. At every moment the name belongs to no
    /// file (or to the earlier one), or to the finished file.
    pub fn finish(mut self, summary: &Summary, status: Status) -> Result<(), StoreError> {
        let paths = summary.completed_paths;
        let appended = self.appended;
        self.guarded(|place, tables| {
            if tables.iter().any(|(along, _)| *along == RowAxis::Path) && appended != paths {
                return Err(format!("the statistics are of {paths} paths, but {appended} were appended").into());
            }
            tables.iter_mut().try_for_each(|(_, table)| table.write_all(&mut place.ledger))?;
            run::write_end(place, summary, status)?;
            place.file.flush()
        })?;
        // Everything is written by now, so closing the variables writes nothing more.
        let Writer { workshop, draft, tables, .. } = self;
        drop(tables);
        draft.finish().map_err(|failure| workshop.failure(failure.cause, failure.full))?;
        workshop.publish()
    }

    /// Do something with the open file. After the first failure, every call returns that failure.
    fn guarded(
        &mut self,
        work: impl FnOnce(&mut OpenFile, &mut Vec<(RowAxis, GrowingTable)>) -> hdf5::Result<()>,
    ) -> Result<(), StoreError> {
        let Writer { draft, tables, failure, .. } = self;
        if failure.is_none()
            && let Err(new) = draft.write(|place| work(place, tables))
        {
            // The variables are leaked like the file, because closing them would write to it.
            std::mem::forget(std::mem::take(tables));
            *failure = Some(new);
        }
        match &self.failure {
            Some(WriteFailure { cause, full }) => Err(self.workshop.failure(cause.clone(), *full)),
            None => Ok(()),
        }
    }
}

/// The chunks of the variables along a dimension.
fn growth(along: RowAxis, header: &Provenance, record: &Record) -> Growth {
    match along {
        RowAxis::Path => Growth { rows: (header.paths as usize).clamp(1, CHUNK), columns: 1 },
        RowAxis::Event => Growth { rows: CHUNK, columns: 1 },
        RowAxis::Trajectory => {
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
