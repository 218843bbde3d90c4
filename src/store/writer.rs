//! Writing a run as it goes.

use super::error::{cause, is_full, system_error};
use super::growing::{Table, Values};
use super::variable::{Growth, Place};
use super::{StoreError, header, layout, summary};
use crate::engine::Status;
use crate::provenance::Provenance;
use crate::stats::{BlockResult, EventColumns, PathColumns, Record, Summary, TrajectoryRows};
use hdf5::File;
use hdf5::file::{FileCloseDegree, LibraryVersion};
use hdf5::plist::file_create::{AttrCreationOrder, LinkCreationOrder};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Values in a chunk of per-path data: 128 kB of reals, so that a chunk of every variable fits into HDF5's cache.
const CHUNK: usize = 16_384;

/// Shortest time between two moments at which the file on disk is brought up to date.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(1);

/// A checkpoint may take at most this share of the time: a slow disk is brought up to date less often.
const CHECKPOINT_SHARE: u32 = 50;

/// The name under which a file is written until it is finished: `NAME.partial`.
pub fn partial_path(target: &Path) -> PathBuf {
    let mut name = target.as_os_str().to_owned();
    name.push(".partial");
    PathBuf::from(name)
}

/// Remove what an earlier run to the same target left behind, unless that run is still going. Returns whether there
/// was anything.
pub fn discard_partial(target: &Path) -> Result<bool, StoreError> {
    let partial = partial_path(target);
    if !partial.exists() {
        return Ok(false);
    }
    if in_use(&partial) {
        return Err(StoreError::InUse { path: partial });
    }
    fs::remove_file(&partial).map_err(|source| StoreError::Remove { partial, source })?;
    Ok(true)
}

/// HDF5 locks a file that it writes with the same advisory lock.
fn in_use(path: &Path) -> bool {
    fs::File::open(path).is_ok_and(|file| matches!(file.try_lock(), Err(fs::TryLockError::WouldBlock)))
}

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

/// A file that is being written.
///
/// Blocks must arrive in the order of their paths. Dropping a writer without `finish` leaves `NAME.partial` behind, with
/// status `running` and the paths that are in it.
///
/// # When the disk is full
///
/// The first error of a write or a flush is final: the HDF5 handles are leaked on purpose, and every later call returns
/// an error. Closing such a file crashes in some versions of the HDF5 library, and reports success in others.
#[derive(Debug)]
pub struct Writer {
    target: PathBuf,
    partial: PathBuf,
    /// Gone once a write has failed.
    open: Option<Open>,
    /// Why it is gone.
    failure: Option<Failure>,
    /// Paths appended.
    appended: u64,
    /// Paths that the file on disk claims.
    claimed: u64,
    last_checkpoint: Instant,
    checkpoint_interval: Duration,
}

/// The handles of an open file; on a write error they must not be dropped.
#[derive(Debug)]
struct Open {
    place: Place,
    paths: Option<Table>,
    events: Option<Table>,
    trajectories: Option<Table>,
}

/// What went wrong, for as often as somebody asks.
#[derive(Clone, Debug)]
struct Failure {
    cause: String,
    full: bool,
}

impl Writer {
    /// Start a file: root attributes, coordinates, and the empty variables of what is recorded. Nothing of the target is
    /// touched before `finish`. A leftover of an earlier run is an error; see `discard_partial`.
    pub fn create(target: &Path, header: &Provenance, record: &Record) -> Result<Writer, StoreError> {
        let partial = partial_path(target);
        let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(StoreError::NoFolder { target: target.to_owned(), folder: folder.to_owned() });
        }
        if partial.exists() {
            return Err(if in_use(&partial) {
                StoreError::InUse { path: partial }
            } else {
                StoreError::LeftOver { partial }
            });
        }
        let file = create_file(&partial)
            .map_err(|error| StoreError::NotCreated { partial: partial.clone(), cause: cause(&error) })?;
        let place = Place { file, units: header.units.clone() };
        let mut writer = Writer {
            target: target.to_owned(),
            partial,
            open: Some(Open { place, paths: None, events: None, trajectories: None }),
            failure: None,
            appended: 0,
            claimed: 0,
            last_checkpoint: Instant::now(),
            checkpoint_interval: CHECKPOINT_INTERVAL,
        };
        writer.guarded(|open| open.define(header, record))?;
        Ok(writer)
    }

    /// Add the paths of the next block. They are on disk after the next checkpoint, about once a second.
    pub fn append(&mut self, block: &BlockResult) -> Result<(), StoreError> {
        self.append_rows(Rows::from(block))
    }

    /// Add consecutive paths.
    pub fn append_rows(&mut self, rows: Rows) -> Result<(), StoreError> {
        self.guarded(|open| open.append(rows))?;
        self.appended += rows.paths;
        if self.last_checkpoint.elapsed() >= self.checkpoint_interval { self.checkpoint() } else { Ok(()) }
    }

    /// Bring the file on disk up to date.
    pub fn checkpoint(&mut self) -> Result<(), StoreError> {
        let start = Instant::now();
        let paths = self.appended;
        self.guarded(|open| {
            open.write_rows()?;
            open.claim(paths)
        })?;
        self.claimed = paths;
        self.last_checkpoint = Instant::now();
        self.checkpoint_interval = CHECKPOINT_INTERVAL.max(start.elapsed() * CHECKPOINT_SHARE);
        Ok(())
    }

    /// Say what ends the run before its last path.
    pub fn ended_by(&mut self, reason: &str) -> Result<(), StoreError> {
        self.guarded(|open| header::set_ended_by(&open.place.file, reason))
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
        self.claimed = paths;
        // Everything is on disk by now, so closing has nothing left to write.
        drop(self.open.take());
        let partial = self.partial.clone();
        let target = std::mem::take(&mut self.target);
        // Some file systems notice only now that they are full.
        fs::File::open(&partial)
            .and_then(|file| file.sync_all())
            .map_err(|error| self.latch(Failure { full: is_full(&error), cause: error.to_string() }))?;
        fs::rename(&partial, &target).map_err(|source| StoreError::Rename { partial, target, source })
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
        let (partial, completed_paths) = (self.partial.clone(), self.claimed);
        match self.failure.clone() {
            Some(Failure { cause, full: true }) => StoreError::DiskFull { partial, completed_paths, cause },
            Some(Failure { cause, full: false }) => StoreError::Write { partial, completed_paths, cause },
            None => StoreError::Write { partial, completed_paths, cause: "the file is closed".to_owned() },
        }
    }
}

impl Drop for Writer {
    /// Write what is there before the handles close, because closing does not report that the disk is full.
    fn drop(&mut self) {
        if self.open.is_some() {
            // There is nobody left to tell; an error leaks the handles, which is all that matters here.
            let _ = self.checkpoint();
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
            self.trajectories = Some(Table::define(&self.place, &trajectory_variables(&none), growth)?);
        }
        self.place.file.flush()
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
            table.push(trajectories.path.len(), &trajectory_variables(trajectories))?;
        }
        Ok(())
    }

    fn write_rows(&mut self) -> hdf5::Result<()> {
        for table in [&mut self.paths, &mut self.events, &mut self.trajectories].into_iter().flatten() {
            table.write_all()?;
        }
        Ok(())
    }

    /// The rows reach the disk before the number that speaks of them.
    fn claim(&self, paths: u64) -> hdf5::Result<()> {
        self.place.file.flush()?;
        header::set_completed_paths(&self.place.file, paths)?;
        self.place.file.flush()
    }

    fn finish(&mut self, summary: &Summary, status: Status) -> hdf5::Result<()> {
        self.write_rows()?;
        summary::write(&self.place, summary)?;
        header::set_diverged_paths(&self.place.file, summary.diverged.len() as u64)?;
        self.claim(summary.completed_paths)?;
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

/// The variables along `trajectory` with their values.
fn trajectory_variables(rows: &TrajectoryRows) -> [(&'static layout::Variable, Values<'_>); 7] {
    [
        (&layout::TRAJECTORY, Values::U64(&rows.path)),
        (&layout::TRAJECTORY_DISPLACEMENT, Values::F64(&rows.displacement)),
        (&layout::TRAJECTORY_VELOCITY, Values::F64(&rows.velocity)),
        (&layout::TRAJECTORY_TEMPERATURE, Values::F64(&rows.temperature)),
        (&layout::TRAJECTORY_FORCE, Values::F64(&rows.force)),
        (&layout::TRAJECTORY_FRICTION, Values::F64(&rows.friction)),
        (&layout::TRAJECTORY_STATIC, Values::I8(&rows.is_static)),
    ]
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
