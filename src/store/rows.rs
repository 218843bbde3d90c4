//! Reading the rows of single paths back from a file.

use super::StoreError;
use super::error::cause;
use super::reader::{check_file, open};
use super::variable::readable;
use crate::dataset::layout;
use crate::dataset::{Column, Kind};
use crate::stats::{EventColumns, PathColumns, TrajectoryRows};
use hdf5::{Dataset, File, H5Type, Result};
use ndarray::{IxDyn, s};
use std::ops::Range;
use std::path::Path;

/// The scalars of one path from the file of a run; `None` if the file does not record paths, or not
/// this one.
pub fn read_path(path: &Path, number: u64) -> std::result::Result<Option<PathColumns>, StoreError> {
    check_file(path)?;
    let file = open(path)?;
    let read = || -> Result<Option<PathColumns>> {
        if !file.link_exists(layout::PATH_DISPLACEMENT_END.name) {
            return Ok(None);
        }
        let first: Vec<u64> = column(&file, &layout::PATH, &(0..1))?;
        let row = first.first().and_then(|first| number.checked_sub(*first)).and_then(|row| usize::try_from(row).ok());
        let rows = file.dataset(layout::PATH.name)?.size();
        row.filter(|row| *row < rows).map(|row| paths(&file, &(row..row + 1))).transpose()
    };
    read().map_err(|error| StoreError::Damaged { path: path.to_owned(), cause: cause(&error) })
}

/// Read some rows of a variable, row by row.
pub(super) fn column<T: H5Type + Clone>(
    file: &File,
    variable: &layout::Variable,
    rows: &Range<usize>,
) -> Result<Vec<T>> {
    let dataset = file.dataset(variable.name)?;
    if dataset.shape().first().is_none_or(|&length| length < rows.end) {
        return Err(format!("{} is too short", variable.name).into());
    }
    slice(&dataset, rows)
}

/// Read some rows of a variable as values of this type, row by row.
pub(super) fn some_rows(dataset: &Dataset, kind: Kind, rows: &Range<usize>) -> Result<Column> {
    Ok(match kind {
        Kind::F64 => Column::F64(slice(dataset, rows)?),
        Kind::U64 => Column::U64(slice(dataset, rows)?),
        Kind::U32 => Column::U32(slice(dataset, rows)?),
        Kind::I8 => Column::I8(slice(dataset, rows)?),
        Kind::U8 => Column::U8(slice(dataset, rows)?),
        Kind::Text => Column::Text(slice(dataset, rows)?.iter().map(readable).collect::<Result<_>>()?),
    })
}

fn slice<T: H5Type + Clone>(dataset: &Dataset, rows: &Range<usize>) -> Result<Vec<T>> {
    let some = rows.clone();
    match dataset.shape()[..] {
        // A variable that is read as a whole needs no selection, which is much faster.
        [] => dataset.read_raw(),
        [length, ..] if *rows == (0..length) => dataset.read_raw(),
        [_] => Ok(dataset.read_slice_1d::<T, _>(s![some])?.to_vec()),
        [_, _] => Ok(dataset.read_slice_2d::<T, _>(s![some, ..])?.into_iter().collect()),
        _ => Ok(dataset.read_slice::<T, _, IxDyn>(s![some, .., ..])?.into_iter().collect()),
    }
}

/// Read the scalars of some paths.
pub(super) fn paths(file: &File, rows: &Range<usize>) -> Result<PathColumns> {
    let diverged: Vec<i8> = column(file, &layout::PATH_DIVERGED, rows)?;
    Ok(PathColumns {
        displacement_end: column(file, &layout::PATH_DISPLACEMENT_END, rows)?,
        max_displacement: column(file, &layout::PATH_MAX_DISPLACEMENT, rows)?,
        first_stick_duration: column(file, &layout::PATH_FIRST_STICK_DURATION, rows)?,
        stick_time: column(file, &layout::PATH_STICK_TIME, rows)?,
        friction_work: column(file, &layout::PATH_FRICTION_WORK, rows)?,
        sticks: column(file, &layout::PATH_STICKS, rows)?,
        slips: column(file, &layout::PATH_SLIPS, rows)?,
        sub_phases: column(file, &layout::PATH_SUB_PHASES, rows)?,
        diverged: diverged.iter().map(|&flag| flag != 0).collect(),
    })
}

/// Read the events of some paths. `first` is the row of their first event; the row after their last
/// event is returned with them.
pub(super) fn events(file: &File, rows: &Range<usize>, first: usize) -> Result<(EventColumns, usize)> {
    let count: Vec<u32> = column(file, &layout::EVENT_COUNT, rows)?;
    let next = first + count.iter().map(|&count| count as usize).sum::<usize>();
    if next == first {
        return Ok((EventColumns { count, ..EventColumns::default() }, next));
    }
    let rows = &(first..next);
    let events = EventColumns {
        count,
        time: column(file, &layout::EVENT_TIME, rows)?,
        displacement: column(file, &layout::EVENT_DISPLACEMENT, rows)?,
        force: column(file, &layout::EVENT_FORCE, rows)?,
        sign: column(file, &layout::EVENT_SIGN, rows)?,
        kind: column(file, &layout::EVENT_KIND, rows)?,
    };
    Ok((events, next))
}

/// Read some of the paths that were kept on the output grid.
pub(super) fn trajectories(file: &File, rows: &Range<usize>) -> Result<TrajectoryRows> {
    Ok(TrajectoryRows {
        path: column(file, &layout::TRAJECTORY, rows)?,
        displacement: column(file, &layout::TRAJECTORY_DISPLACEMENT, rows)?,
        velocity: column(file, &layout::TRAJECTORY_VELOCITY, rows)?,
        temperature: column(file, &layout::TRAJECTORY_TEMPERATURE, rows)?,
        force: column(file, &layout::TRAJECTORY_FORCE, rows)?,
        friction: column(file, &layout::TRAJECTORY_FRICTION, rows)?,
        is_static: column(file, &layout::TRAJECTORY_STATIC, rows)?,
    })
}
