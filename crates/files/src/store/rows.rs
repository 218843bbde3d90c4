//! Reading the row of a single path back from a file.

use super::StoreError;
use super::reader::read_kind;
use crate::dataset::header::FORMAT;
use crate::dataset::{Column, ElementType, layout};
use std::path::Path;
use stickslip::stats::PathColumns;
use stickslip::stats::column::Columns as _;

/// The scalars of one path from the file of a run; `None` if the file does not record paths, or not
/// this one.
pub fn read_path(path: &Path, number: u64) -> std::result::Result<Option<PathColumns>, StoreError> {
    read_kind(path, FORMAT, |file| {
        if !file.has(PathColumns::VARIABLES[0].0.name) {
            return Ok(None);
        }
        let paths = file.length(layout::PATH.name)?.unwrap_or(0);
        let Column::U64(first) = file.rows(layout::PATH.name, ElementType::U64, &(0..1))? else {
            return Ok(None);
        };
        let row = number
            .checked_sub(first[0])
            .and_then(|row| usize::try_from(row).ok())
            .filter(|row| *row < paths);
        let read = |row| {
            PathColumns::read(|variable, kind| file.rows(variable.name, kind, &(row..row + 1)))
        };
        row.map(read).transpose()
    })
}
