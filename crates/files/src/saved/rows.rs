//! The rows of single paths as bytes: those of a block, and the checksum over many of them.

use super::checksum::checksum;
use stickslip::dataset::ElementType;
use stickslip::stats::BlockRows;
use stickslip::stats::column::Columns;
use stickslip::sums::{Codec, Damaged, Reader};

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
    pub fn after(self, rows: &BlockRows, out: &mut Vec<u8>) -> Position {
        let start = out.len();
        out.extend([0; 8]);
        write_rows(rows, out);
        let length = (out.len() - start) as u64;
        out[start..start + 8].copy_from_slice(&(length - 8).to_le_bytes());
        Position {
            length: self.length + length,
            checksum: checksum(self.checksum, &out[start..]),
        }
    }
}

/// Write a table, if it is there: for each column its length, then its values.
fn write_table<T: Columns>(table: &Option<T>, out: &mut Vec<u8>) {
    u64::from(table.is_some()).write(out);
    for (_, values) in table.iter().flat_map(|table| table.columns()) {
        (values.len() as u64).write(out);
        values.write(out);
    }
}

fn read_table<T: Columns>(from: &mut Reader<'_>) -> Result<Option<T>, Damaged> {
    let is_there: u64 = from.value()?;
    let column = |_: &_, kind: ElementType| {
        from.length()
            .and_then(|length| kind.read(length, from))
            .map_err(|e| e.to_string())
    };
    if is_there == 0 {
        Ok(None)
    } else {
        T::read(column).map(Some).map_err(|_| Damaged)
    }
}

/// Append rows to `out`.
pub(crate) fn write_rows(rows: &BlockRows, out: &mut Vec<u8>) {
    rows.first_path.write(out);
    rows.paths.write(out);
    write_table(&rows.path_columns, out);
    write_table(&rows.events, out);
    write_table(&rows.trajectories, out);
}

/// Read rows that [`write_rows`] wrote.
pub(crate) fn read_rows(from: &mut Reader<'_>) -> Result<BlockRows, Damaged> {
    Ok(BlockRows {
        first_path: from.value()?,
        paths: from.value()?,
        path_columns: read_table(from)?,
        events: read_table(from)?,
        trajectories: read_table(from)?,
    })
}
