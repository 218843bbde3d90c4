//! Writes the file of a run once its statistics are known, or a data set at once.

use super::StoreError;
use super::errors::WriteFailure;
use super::file::StagedFile;
use super::staging::{RESULTS, Staging};
use super::variables::{Growth, OpenFile, write_values};
use super::written::Sum;
use crate::saved::RunQuestion;
use std::ops::Range;
use std::path::Path;
use stickslip::dataset::rows::RowAxis;
use stickslip::dataset::{Column, Dataset, Entry, header, layout, run};
use stickslip::engine::{Outcome, Provenance, Status};
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
    /// Number of paths appended.
    appended: u64,
}

impl Writer {
    /// Start a file: root attributes, coordinates, and the empty variables of what is recorded. The
    /// target itself is not touched before `finish`. With `force`, an existing file of this name is
    /// replaced, and leftovers of an unfinished run to it are removed.
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
        let (draft, header) = (StagedFile::create(&staging)?, header.clone());
        let mut writer = Writer {
            staging,
            draft,
            tables: Vec::new(),
            header,
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

    /// Write the file of a run, of which `copy` appends the rows. The file of a part also holds its
    /// state, from which it can be joined to the others.
    pub(super) fn assemble(
        staging: Staging,
        RunQuestion {
            scenario, asked, ..
        }: &RunQuestion,
        outcome: &Outcome,
        state: Option<Vec<u8>>,
        copy: impl FnOnce(&mut Writer) -> Result<(), StoreError>,
    ) -> Result<(), StoreError> {
        let mut writer = Writer::within(staging, &asked.provenance(scenario), &scenario.record)?;
        copy(&mut writer)?;
        writer.guarded(|place, _, header| {
            let mut about = Dataset::new(&header.units);
            header::write_ended_by(
                &mut about,
                outcome.ended_by.as_ref().map(ToString::to_string),
            );
            header::write_part(&mut about, asked.part);
            state
                .iter()
                .for_each(|state| about.write(&layout::PART_STATE, state));
            place.write(about)
        })?;
        writer.finish(&outcome.summary, outcome.status)
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

    /// Write the statistics, and give the file its name. At every moment the name denotes no file
    /// (or the earlier one), or the finished file.
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
                place.written.rows.extend(table.written());
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
        staging.publish(RESULTS)
    }

    /// Do something with the open file. After the first failure, every call returns it.
    fn guarded(
        &mut self,
        work: impl FnOnce(&mut OpenFile, &mut Vec<GrowingTable>, &Provenance) -> hdf5::Result<()>,
    ) -> Result<(), StoreError> {
        let Writer {
            staging,
            draft,
            tables,
            header,
            ..
        } = self;
        draft
            .write(|place| work(place, tables, header))
            .map_err(|WriteFailure { cause, full }| {
                // The variables are leaked like the file, because closing them would write to it.
                std::mem::forget(std::mem::take(tables));
                staging.failure(cause, full)
            })
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

/// One growing variable.
#[derive(Debug)]
struct GrowingVariable {
    /// The variable, without values.
    entry: Entry,
    dataset: hdf5::Dataset,
    /// Number of values in a row.
    width: usize,
    /// All values.
    sum: Sum,
}

/// A growing dimension with all its variables.
#[derive(Debug)]
struct GrowingTable {
    along: RowAxis,
    /// The dataset of the dimension itself, if it has no coordinate variable.
    bare_dimension: Option<hdf5::Dataset>,
    columns: Vec<GrowingVariable>,
    /// Number of rows so far.
    rows: usize,
}

/// The variables of a data set along this dimension.
fn of_table(along: RowAxis, dataset: &Dataset) -> impl Iterator<Item = &Entry> {
    dataset
        .entries
        .iter()
        .filter(move |entry| RowAxis::of(entry) == Some(along))
}

impl GrowingTable {
    /// Create the variables of an empty data set that grow along a dimension; none if there are
    /// none. The first variable is the coordinate of the dimension; only the dimension of events
    /// has no coordinate and gets a bare dimension instead.
    fn define(
        place: &mut OpenFile,
        along: RowAxis,
        empty: &Dataset,
        growth: Growth,
    ) -> hdf5::Result<Option<GrowingTable>> {
        if of_table(along, empty).next().is_none() {
            return Ok(None);
        }
        let bare_dimension = (along == RowAxis::Event)
            .then(|| place.define_bare(layout::EVENT.name, growth))
            .transpose()?;
        let define = |entry: &Entry| -> hdf5::Result<GrowingVariable> {
            let dataset = place.define_growing(entry, growth)?;
            let width = dataset.shape().iter().skip(1).product();
            Ok(GrowingVariable {
                entry: entry.clone(),
                dataset,
                width,
                sum: Sum::of(entry.column.values().kind()),
            })
        };
        let columns = of_table(along, empty)
            .map(define)
            .collect::<hdf5::Result<_>>()?;
        Ok(Some(GrowingTable {
            along,
            bare_dimension,
            columns,
            rows: 0,
        }))
    }

    /// Add rows, with the variables in the order given to `define`.
    fn push(&mut self, rows: &Dataset) -> hdf5::Result<()> {
        let new: Vec<&Entry> = of_table(self.along, rows).collect();
        let Some(first) = new.first().filter(|entry| !entry.column.is_empty()) else {
            return Ok(());
        };
        let names = self.columns.iter().map(|column| &column.entry.name);
        if !names.eq(new.iter().map(|entry| &entry.name)) {
            return Err("a block has different variables from the file".into());
        }
        let rows = self.rows..self.rows + first.column.len() / self.columns[0].width;
        if let Some(dimension) = &self.bare_dimension {
            dimension.resize(rows.end)?;
        }
        for (column, entry) in self.columns.iter_mut().zip(new) {
            column.write(&entry.column, &rows)?;
        }
        self.rows = rows.end;
        Ok(())
    }

    /// The variables, without values, and the sums of all their values.
    fn written(&self) -> impl Iterator<Item = (Entry, Sum)> {
        let columns = self.columns.iter();
        columns.map(|column| (column.entry.clone(), column.sum))
    }
}

impl GrowingVariable {
    /// Write the values of these rows, the next ones.
    fn write(&mut self, values: &Column, rows: &Range<usize>) -> hdf5::Result<()> {
        let (name, expected) = (&self.entry.name, rows.len() * self.width);
        if values.len() != expected {
            return Err(format!("{name} has {} values, not {expected}", values.len()).into());
        }
        self.sum.add(values.values());
        write_values(&self.dataset, values.values(), Some(rows))
    }
}

/// Write a data set to `target`. With `force`, an existing file of this name is replaced.
pub fn write_dataset(target: &Path, dataset: Dataset, force: bool) -> Result<(), StoreError> {
    let staging = Staging::open(target, force)?;
    write_results(&staging, dataset)?;
    staging.publish(RESULTS)
}

/// Write a data set to the staged file.
pub(super) fn write_results(staging: &Staging, dataset: Dataset) -> Result<(), StoreError> {
    let mut draft = StagedFile::create(staging)?;
    let written = draft
        .write(|place| place.write(dataset))
        .and_then(|()| draft.finish());
    written.map_err(|failure| staging.failure(failure.cause, failure.full))
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
