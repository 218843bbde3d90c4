//! The rows of single paths as bytes: those of a block, and the checksum over many of them.

use super::checksum::checksum;
use crate::dataset::{ElementType, Rows};
use crate::stats::column::Columns;
use crate::stats::{EventColumns, PathColumns, TrajectoryRows};
use crate::sums::{Codec, Damaged, Reader};

/// How much of a log is valid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Position {
    /// Length in bytes.
    pub length: u64,
    /// Checksum of these bytes.
    pub checksum: u32,
}

impl Position {
    /// The position after one more block, whose bytes are appended to `out`.
    pub fn after(self, rows: &Rows, out: &mut Vec<u8>) -> Position {
        let start = out.len();
        out.extend([0; 8]);
        write_rows(rows, out);
        let length = (out.len() - start - 8) as u64;
        out[start..start + 8].copy_from_slice(&length.to_le_bytes());
        let checksum = checksum(self.checksum, &out[start..]);
        out.extend(checksum.to_le_bytes());
        Position { length: self.length + (out.len() - start) as u64, checksum }
    }
}

/// The rows of one block, read back from a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct OwnedRows {
    pub first_path: u64,
    pub paths: u64,
    pub path_columns: Option<PathColumns>,
    pub events: Option<EventColumns>,
    pub trajectories: Option<TrajectoryRows>,
}

impl OwnedRows {
    /// The same rows, borrowed, in the form that the writer takes.
    pub fn rows(&self) -> Rows<'_> {
        Rows {
            first_path: self.first_path,
            paths: self.paths,
            path_columns: self.path_columns.as_ref(),
            events: self.events.as_ref(),
            trajectories: self.trajectories.as_ref(),
        }
    }
}

/// Write a table, if it is there: for each column its length, then its values.
fn write_table<T: Columns>(table: Option<&T>, out: &mut Vec<u8>) {
    u64::from(table.is_some()).write(out);
    for (_, values) in table.iter().flat_map(|table| table.columns()) {
        (values.len() as u64).write(out);
        values.write(out);
    }
}

fn read_table<T: Columns>(from: &mut Reader<'_>) -> Result<Option<T>, Damaged> {
    let is_there: u64 = from.value()?;
    let column =
        |_: &_, kind: ElementType| from.length().and_then(|length| kind.read(length, from)).map_err(|e| e.to_string());
    if is_there == 0 { Ok(None) } else { T::read(column).map(Some).map_err(|_| Damaged) }
}

/// Append rows to `out`.
pub(crate) fn write_rows(rows: &Rows, out: &mut Vec<u8>) {
    rows.first_path.write(out);
    rows.paths.write(out);
    write_table(rows.path_columns, out);
    write_table(rows.events, out);
    write_table(rows.trajectories, out);
}

/// Read rows that [`write_rows`] wrote.
pub(crate) fn read_rows(from: &mut Reader<'_>) -> Result<OwnedRows, Damaged> {
    let (mut first_path, mut paths) = (0, 0);
    first_path.read(from)?;
    paths.read(from)?;
    Ok(OwnedRows {
        first_path,
        paths,
        path_columns: read_table(from)?,
        events: read_table(from)?,
        trajectories: read_table(from)?,
    })
}
