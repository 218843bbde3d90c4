//! Writing the file of a run, once its statistics are known.

use super::error::{cause, is_full, system_error};
use super::growing::{Table, Values};
use super::variable::{Growth, Place};
use super::workshop::{RESULTS, Workshop};
use super::{StoreError, header, layout, seal, series, summary};
use crate::engine::{Part, Status};
use crate::provenance::Provenance;
use crate::scenario::Bearing;
use crate::stats::{BlockResult, EventColumns, PathColumns, Record, Summary, TrajectoryRows};
use hdf5::File;
use hdf5::file::{FileCloseDegree, LibraryVersion};
use hdf5::plist::file_create::{AttrCreationOrder, LinkCreationOrder};
use std::fs;
use std::path::Path;

/// Values in a chunk of per-path data: 128 kB of reals, so that a chunk of every variable fits into HDF5's cache.
const CHUNK: usize = 16_384;

/// What a run keeps of consecutive paths.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// Number of the first path.
    pub first_path: u64,
    /// Number of paths, diverged ones included.
    pub paths: u64,
    /// If asked for.
    pub path_columns: Option<&'a PathColumns>,
    /// If asked for.
    pub events: Option<&'a EventColumns>,
    /// If asked for and if any of these paths is kept.
    pub trajectories: Option<&'a TrajectoryRows>,
}

impl<'a> From<&'a BlockResult> for Rows<'a> {
    fn from(block: &'a BlockResult) -> Rows<'a> {
        Rows {
            first_path: block.first_path,
            paths: block.paths,
            path_columns: block.path_columns.as_ref(),
            events: block.events.as_ref(),
            trajectories: block.trajectories.as_ref(),
        }
    }
}

/// A file that is being written, in the folder `NAME.partial`.
///
/// Rows must arrive in the order of their paths. Dropping a writer without `finish` leaves nothing behind.
///
/// # When the disk is full
///
/// The first error of a write or a flush is final: the HDF5 handles are leaked on purpose, and every later call returns
/// an error. Closing such a file crashes in some versions of the HDF5 library, and reports success in others.
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
    paths: Option<Table>,
    events: Option<Table>,
    trajectories: Option<Table>,
    bearing: Option<Bearing>,
}

/// What went wrong, for as often as somebody asks.
#[derive(Clone, Debug)]
struct Failure {
    cause: String,
    full: bool,
}

impl Writer {
    /// Start a file: root attributes, coordinates, and the empty variables of what is recorded. Nothing of the target is
    /// touched before `finish`. With `force`, a file of this name is replaced, and what an unfinished run to it left behind goes.
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
        let open = Some(Open { place, paths: None, events: None, trajectories: None, bearing: header.bearing });
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
        self.guarded(|open| header::set_ended_by(&open.place.file, reason))
    }

    /// Say which part of a run it is, and keep its state, from which it can be joined to others.
    pub(super) fn part(&mut self, part: Part, state: &[u8]) -> Result<(), StoreError> {
        self.guarded(|open| {
            header::set_part(&open.place.file, part)?;
            open.place.put(&layout::PART_STATE, state)
        })
    }

    /// Write the statistics, and give the file its name: at every moment there is either no file of that name (or the
    /// earlier one), or a finished one.
    pub fn finish(mut self, summary: &Summary, status: Status) -> Result<(), StoreError> {
        let paths = summary.completed_paths;
        let appended = self.appended;
        self.guarded(|open| {
            if open.paths.is_some() && appended != paths {
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

    /// Do something with the open file, unless an earlier write has failed; latch the first failure.
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
    /// What is not written yet is of no use, but to close the file writes it; an error then may crash the library.
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
        // V18 keeps the file readable after the process is killed; V110 and later mark it as open for writing.
        // A strong close closes the file even if a handle to one of its objects is still around.
        .with_fapl(|access| {
            access.libver_bounds(LibraryVersion::V18, LibraryVersion::V110).fclose_degree(FileCloseDegree::Strong)
        })
        // netCDF-4 appends only to files that know the order in which their variables were made, and equal runs give
        // equal files only without modification times.
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
        header::write(&self.place.file, header)?;
        summary::write_coordinates(&self.place, &header.time)?;
        if let Some(samples) = &header.series {
            series::write(&self.place, samples, header.series_start.as_deref())?;
        }
        let rows = (header.paths as usize).clamp(1, CHUNK);
        if record.paths || record.events {
            let (columns, events) = (PathColumns::default(), EventColumns::default());
            let columns = record.paths.then_some(&columns);
            let events = record.events.then_some(&events);
            let variables = path_variables(&[], columns, &[], events);
            self.paths = Some(Table::define(&self.place, &variables, Growth { rows, columns: 1 })?);
        }
        if record.events {
            let events = EventColumns::default();
            let growth = Growth { rows: CHUNK, columns: 1 };
            let table = Table::define_along(&self.place, &layout::EVENT, &event_variables(&events), growth)?;
            self.events = Some(table);
        }
        if record.trajectories > 0 && !header.time.is_empty() {
            let columns = header.time.len().min(CHUNK);
            let rows = (CHUNK / columns).clamp(1, record.trajectories.min(header.paths).max(1) as usize);
            let none = TrajectoryRows::default();
            let growth = Growth { rows, columns };
            let shown = self.bearing.map(|_| Vec::new());
            let variables = trajectory_variables(&none, shown.as_deref());
            self.trajectories = Some(Table::define(&self.place, &variables, growth)?);
        }
        Ok(())
    }

    fn append(&mut self, block: Rows) -> hdf5::Result<()> {
        if let Some(table) = &mut self.paths {
            let numbers: Vec<u64> = (block.first_path..).take(block.paths as usize).collect();
            let diverged: Vec<i8> = block
                .path_columns
                .iter()
                .flat_map(|columns| &columns.diverged)
                .map(|&diverged| diverged.into())
                .collect();
            let variables = path_variables(&numbers, block.path_columns, &diverged, block.events);
            table.push(numbers.len(), &variables)?;
        }
        if let (Some(table), Some(events)) = (&mut self.events, block.events) {
            let total = events.count.iter().map(|&count| count as usize).sum();
            table.push(total, &event_variables(events))?;
        }
        if let (Some(table), Some(trajectories)) = (&mut self.trajectories, block.trajectories) {
            let shown = self.bearing.map(|bearing| -> Vec<f64> {
                let places = trajectories.displacement.iter().zip(&trajectories.friction);
                places.map(|(&x, &friction)| bearing.displacement(x, friction)).collect()
            });
            table.push(trajectories.path.len(), &trajectory_variables(trajectories, shown.as_deref()))?;
        }
        Ok(())
    }

    fn write_rows(&mut self) -> hdf5::Result<()> {
        for table in [&mut self.paths, &mut self.events, &mut self.trajectories].into_iter().flatten() {
            table.write_all()?;
        }
        Ok(())
    }

    fn finish(&mut self, summary: &Summary, status: Status) -> hdf5::Result<()> {
        self.write_rows()?;
        summary::write(&self.place, summary)?;
        header::set_diverged_paths(&self.place.file, summary.diverged.len() as u64)?;
        header::set_completed_paths(&self.place.file, summary.completed_paths)?;
        header::set_status(&self.place.file, status)?;
        self.place.file.flush()
    }
}

/// The variables along `path` with their values. What is not recorded is left out.
fn path_variables<'a>(
    numbers: &'a [u64],
    columns: Option<&'a PathColumns>,
    diverged: &'a [i8],
    events: Option<&'a EventColumns>,
) -> Vec<(&'static layout::Variable, Values<'a>)> {
    let mut variables: Vec<(&layout::Variable, Values)> = vec![(&layout::PATH, Values::U64(numbers))];
    if let Some(columns) = columns {
        variables.extend([
            (&layout::PATH_DISPLACEMENT_END, Values::F64(&columns.displacement_end)),
            (&layout::PATH_MAX_DISPLACEMENT, Values::F64(&columns.max_displacement)),
            (&layout::PATH_FIRST_STICK_DURATION, Values::F64(&columns.first_stick_duration)),
            (&layout::PATH_STICK_TIME, Values::F64(&columns.stick_time)),
            (&layout::PATH_FRICTION_WORK, Values::F64(&columns.friction_work)),
            (&layout::PATH_STICKS, Values::U32(&columns.sticks)),
            (&layout::PATH_SLIPS, Values::U32(&columns.slips)),
            (&layout::PATH_SUB_PHASES, Values::U32(&columns.sub_phases)),
            (&layout::PATH_DIVERGED, Values::I8(diverged)),
        ]);
    }
    if let Some(events) = events {
        variables.push((&layout::EVENT_COUNT, Values::U32(&events.count)));
    }
    variables
}

/// The variables along `event` with their values.
fn event_variables(events: &EventColumns) -> [(&'static layout::Variable, Values<'_>); 5] {
    [
        (&layout::EVENT_TIME, Values::F64(&events.time)),
        (&layout::EVENT_DISPLACEMENT, Values::F64(&events.displacement)),
        (&layout::EVENT_FORCE, Values::F64(&events.force)),
        (&layout::EVENT_SIGN, Values::I8(&events.sign)),
        (&layout::EVENT_KIND, Values::I8(&events.kind)),
    ]
}

/// The variables along `trajectory` with their values; what a sensor shows only where there is one.
fn trajectory_variables<'a>(
    rows: &'a TrajectoryRows,
    shown: Option<&'a [f64]>,
) -> Vec<(&'static layout::Variable, Values<'a>)> {
    let mut variables: Vec<(&layout::Variable, Values)> = vec![
        (&layout::TRAJECTORY, Values::U64(&rows.path)),
        (&layout::TRAJECTORY_DISPLACEMENT, Values::F64(&rows.displacement)),
        (&layout::TRAJECTORY_VELOCITY, Values::F64(&rows.velocity)),
        (&layout::TRAJECTORY_TEMPERATURE, Values::F64(&rows.temperature)),
        (&layout::TRAJECTORY_FORCE, Values::F64(&rows.force)),
        (&layout::TRAJECTORY_FRICTION, Values::F64(&rows.friction)),
        (&layout::TRAJECTORY_STATIC, Values::I8(&rows.is_static)),
    ];
    variables.extend(shown.map(|shown| (&layout::TRAJECTORY_BEARING, Values::F64(shown))));
    variables
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
