//! Reading rows of variables back from a file.

use super::StoreError;
use super::reader::read_from;
use super::variable::read_texts;
use crate::dataset::{Column, ElementType, Source as _, layout};
use crate::stats::PathColumns;
use crate::stats::column::Columns as _;
use hdf5::{Dataset, H5Type, Result};
use ndarray::{IxDyn, s};
use std::ops::Range;
use std::path::Path;

/// The scalars of one path from the file of a run; `None` if the file does not record paths, or not
/// this one.
pub fn read_path(path: &Path, number: u64) -> std::result::Result<Option<PathColumns>, StoreError> {
    read_from(path, |file| {
        if !file.has(PathColumns::VARIABLES[0].0.name) {
            return Ok(None);
        }
        let paths = file.length(layout::PATH.name)?.unwrap_or(0);
        let Column::U64(first) = file.rows(layout::PATH.name, ElementType::U64, &(0..1))? else { return Ok(None) };
        let row = number.checked_sub(first[0]).and_then(|row| usize::try_from(row).ok()).filter(|row| *row < paths);
        let read = |row| PathColumns::read(|variable, kind| file.rows(variable.name, kind, &(row..row + 1)));
        row.map(read).transpose()
    })
}

/// Read some rows of a variable as values of this type, row by row.
pub(super) fn some_rows(name: &str, dataset: &Dataset, kind: ElementType, rows: &Range<usize>) -> Result<Column> {
    Ok(match kind {
        ElementType::F64 => Column::F64(slice(name, dataset, rows)?),
        ElementType::U64 => Column::U64(slice(name, dataset, rows)?),
        ElementType::U32 => Column::U32(slice(name, dataset, rows)?),
        ElementType::I8 => Column::I8(slice(name, dataset, rows)?),
        ElementType::U8 => Column::U8(slice(name, dataset, rows)?),
        ElementType::Text => Column::Text(read_texts(dataset)?),
    })
}

fn slice<T: H5Type + Clone>(name: &str, dataset: &Dataset, rows: &Range<usize>) -> Result<Vec<T>> {
    if !dataset.dtype()?.is::<T>() {
        return Err(format!("{name} has another type than it was written with").into());
    }
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
