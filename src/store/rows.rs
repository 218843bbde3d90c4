//! Reading the rows of single paths back from a file.

use super::StoreError;
use super::reader::read_from;
use super::variable::readable;
use crate::dataset::layout;
use crate::dataset::{Column, ElementType};
use crate::saved::RowSource;
use crate::stats::PathColumns;
use crate::stats::column::Columns as _;
use hdf5::{Dataset, File, H5Type, Result};
use ndarray::{IxDyn, s};
use std::ops::Range;
use std::path::Path;

/// The scalars of one path from the file of a run; `None` if the file does not record paths, or not
/// this one.
pub fn read_path(path: &Path, number: u64) -> std::result::Result<Option<PathColumns>, StoreError> {
    read_from(path, |file| {
        if !file.link_exists(PathColumns::VARIABLES[0].0.name) {
            return Ok(None);
        }
        let first: Vec<u64> = column(file, &layout::PATH, &(0..1))?;
        let row = first.first().and_then(|first| number.checked_sub(*first)).and_then(|row| usize::try_from(row).ok());
        let rows = file.dataset(layout::PATH.name)?.size();
        let read = |row| PathColumns::read(|variable, kind| file.rows(variable, kind, &(row..row + 1)));
        row.filter(|row| *row < rows).map(read).transpose()
    })
}

/// Read some rows of a variable, row by row.
pub(super) fn column<T: H5Type + Clone>(
    file: &File,
    variable: &layout::Variable,
    rows: &Range<usize>,
) -> Result<Vec<T>> {
    slice(&dataset(file, variable, rows)?, rows)
}

/// The variable, which must have these rows.
fn dataset(file: &File, variable: &layout::Variable, rows: &Range<usize>) -> Result<Dataset> {
    let dataset = file.dataset(variable.name)?;
    match dataset.shape().first() {
        Some(&length) if length >= rows.end => Ok(dataset),
        _ => Err(format!("{} is too short", variable.name).into()),
    }
}

impl RowSource for File {
    type Error = hdf5::Error;

    fn rows(&self, variable: &layout::Variable, kind: ElementType, rows: &Range<usize>) -> Result<Column> {
        some_rows(&dataset(self, variable, rows)?, kind, rows)
    }
}

/// Read some rows of a variable as values of this type, row by row.
pub(super) fn some_rows(dataset: &Dataset, kind: ElementType, rows: &Range<usize>) -> Result<Column> {
    Ok(match kind {
        ElementType::F64 => Column::F64(slice(dataset, rows)?),
        ElementType::U64 => Column::U64(slice(dataset, rows)?),
        ElementType::U32 => Column::U32(slice(dataset, rows)?),
        ElementType::I8 => Column::I8(slice(dataset, rows)?),
        ElementType::U8 => Column::U8(slice(dataset, rows)?),
        ElementType::Text => Column::Text(
            slice::<hdf5::types::VarLenUnicode>(dataset, rows)?
                .iter()
                .map(|text| readable(text))
                .collect::<Result<_>>()?,
        ),
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
