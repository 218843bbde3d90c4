//! Writing the file of a run, once its statistics are known.

use super::failure::WriteFailure;
use super::folder::RESULTS;
use super::growing::GrowingTable;
use super::staged_file::StagedFile;
use super::staging::Staging;
use super::variable::{Growth, OpenFile};
use super::{StoreError, own};
use crate::dataset::rows::RowAxis;
use crate::dataset::{Dataset, header, layout, run};
use std::path::Path;
use stickslip::engine::{Part, Provenance, Status};
use stickslip::stats::{BlockRows, Record, Summary};

/// Number of values in a chunk of per-path data. As reals they take 128 kB, so that one chunk of
/// every variable fits into HDF5's cache.
const CHUNK: usize = 16_384;

/// A file that is being written, in the folder `NAME.partial`.
///
/// Rows must arrive in the order of their paths. Dropping a writer without `finish` leaves no file
/// behind. The first error of a write is final, and every later call returns it again.
#[derive(Debug)]
pub struct Writer {
    staging: Staging,
    draft: StagedFile,
    tables: Vec<GrowingTable>,
    header: Provenance,
    /// Why nothing can be written any more.
    failure: Option<WriteFailure>,
    /// Number of paths appended.
    appended: u64,
}

impl Writer {
    /// Start a file: root attributes, coordinates, and the empty variables of what is recorded. The
    /// target itself is not touched before `finish`. With `force`, an existing file of this name is
    /// replaced, and what an unfinished run to it left behind is removed.
    pub fn create(
        target: &Path,
        header: &Provenance,
        record: &Record,
        force: bool,
    ) -> Result<Writer, StoreError> {
        Writer::within(Staging::open(target, force)?, header, record)
    }

    /// The same in a folder that exists already.
    pub(super) fn within(
        staging: Staging,
        header: &Provenance,
        record: &Record,
    ) -> Result<Writer, StoreError> {
        let path = staging.path(RESULTS);
        // An earlier attempt to finish the run may have left a file of this name.
        own::remove(&path).map_err(|error| staging.failed(&error))?;
        let (draft, header) = (StagedFile::create(&path)?, header.clone());
        let mut writer = Writer {
            staging,
            draft,
            tables: Vec::new(),
            header,
            failure: None,
            appended: 0,
        };
        let start = run::start(&writer.header, record);
        writer.guarded(|place, tables, header| {
            place.write(start.clone())?;
            for along in RowAxis::ALL {
                tables.extend(GrowingTable::define(
                    place,
                    along,
                    &start,
                    growth(along, header, record),
                )?);
            }
            Ok(())
        })?;
        Ok(writer)
    }

    /// Append the rows of the next paths.
    pub fn append(&mut self, rows: &BlockRows) -> Result<(), StoreError> {
        self.guarded(|_, tables, header| {
            let rows = Dataset::of_rows(rows, &header.units, header.bearing);
            tables.iter_mut().try_for_each(|table| table.push(&rows))
        })?;
        self.appended += rows.paths;
        Ok(())
    }

    /// Write what ended the run before its last path, and which part of a run this is, with the
    /// state of the part, from which it can be joined to the others.
    pub(super) fn about(
        &mut self,
        ended_by: Option<String>,
        part: Option<(Part, Vec<u8>)>,
    ) -> Result<(), StoreError> {
        self.guarded(|place, _, header| {
            let mut about = Dataset::new(&header.units);
            header::write_ended_by(&mut about, ended_by);
            header::write_part(&mut about, part.as_ref().map(|(part, _)| *part));
            part.iter()
                .for_each(|(_, state)| about.write(&layout::PART_STATE, state));
            place.write(about)
        })
    }

    /// Write the statistics, and give the file its name. At every moment the name belongs to no
    /// file (or to the earlier one), or to the finished file.
    pub fn finish(mut self, summary: &Summary, status: Status) -> Result<(), StoreError> {
        let paths = summary.completed_paths;
        let appended = self.appended;
        self.guarded(|place, tables, header| {
            if tables.iter().any(|table| table.along == RowAxis::Path) && appended != paths {
                return Err(format!(
                    "the statistics cover {paths} paths, but {appended} were appended"
                )
                .into());
            }
            for table in tables {
                place.written.rows.extend(table.write_all()?);
            }
            let mut end = Dataset::new(&header.units);
            run::write_end(&mut end, summary, status);
            place.write(end)?;
            place.file.flush()
        })?;
        // Everything is written by now, so closing the variables writes nothing more.
        let Writer {
            staging,
            draft,
            tables,
            ..
        } = self;
        drop(tables);
        draft
            .finish()
            .map_err(|failure| staging.failure(failure.cause, failure.full))?;
        staging.publish()
    }

    /// Do something with the open file. After the first failure, every call returns that failure.
    fn guarded(
        &mut self,
        work: impl FnOnce(&mut OpenFile, &mut Vec<GrowingTable>, &Provenance) -> hdf5::Result<()>,
    ) -> Result<(), StoreError> {
        let Writer {
            draft,
            tables,
            header,
            failure,
            ..
        } = self;
        if failure.is_none()
            && let Err(new) = draft.write(|place| work(place, tables, header))
        {
            // The variables are leaked like the file, because closing them would write to it.
            std::mem::forget(std::mem::take(tables));
            *failure = Some(new);
        }
        match &self.failure {
            Some(WriteFailure { cause, full }) => Err(self.staging.failure(cause.clone(), *full)),
            None => Ok(()),
        }
    }
}

/// The chunks of the variables along a dimension.
fn growth(along: RowAxis, header: &Provenance, record: &Record) -> Growth {
    match along {
        RowAxis::Path => Growth {
            rows: (header.paths as usize).clamp(1, CHUNK),
            columns: 1,
        },
        RowAxis::Event => Growth {
            rows: CHUNK,
            columns: 1,
        },
        RowAxis::Trajectory => {
            let columns = header.time.len().min(CHUNK);
            let rows =
                (CHUNK / columns).clamp(1, record.trajectories.min(header.paths).max(1) as usize);
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
