//! The rows of single paths as bytes: those of a block, and the checksum over many of them.

use super::checksum::checksum;
use crate::dataset::Rows;
use crate::stats::{BlockResult, EventColumns, PathColumns, Totals, TrajectoryRows};
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

/// A number whose bytes have a fixed length.
trait Fixed<const N: usize>: Copy {
    fn bytes(self) -> [u8; N];
    fn of(bytes: [u8; N]) -> Result<Self, Damaged>;
}

macro_rules! fixed {
    ($($type:ty, $size:literal;)*) => {$(
        impl Fixed<$size> for $type {
            fn bytes(self) -> [u8; $size] {
                self.to_le_bytes()
            }

            fn of(bytes: [u8; $size]) -> Result<Self, Damaged> {
                Ok(<$type>::from_le_bytes(bytes))
            }
        }
    )*};
}

fixed! { f64, 8; u64, 8; u32, 4; i8, 1; }

impl Fixed<1> for bool {
    fn bytes(self) -> [u8; 1] {
        [self.into()]
    }

    fn of([byte]: [u8; 1]) -> Result<Self, Damaged> {
        if byte > 1 { Err(Damaged) } else { Ok(byte == 1) }
    }
}

/// Write a list: its length, then its numbers.
fn write_list<T: Fixed<N>, const N: usize>(list: &[T], out: &mut Vec<u8>) {
    (list.len() as u64).write(out);
    list.iter().for_each(|number| out.extend(number.bytes()));
}

fn read_list<T: Fixed<N>, const N: usize>(from: &mut Reader<'_>) -> Result<Vec<T>, Damaged> {
    let length = from.length()?.checked_mul(N).ok_or(Damaged)?;
    let numbers = from.take(length)?.as_chunks::<N>().0;
    numbers.iter().map(|bytes| T::of(*bytes)).collect()
}

/// Define the functions that write and read all lists of a struct.
macro_rules! lists {
    ($write:ident, $read:ident, $type:ident { $($field:ident),* $(,)? }) => {
        fn $write(columns: Option<&$type>, out: &mut Vec<u8>) {
            u64::from(columns.is_some()).write(out);
            if let Some($type { $($field),* }) = columns {
                $(write_list($field, out);)*
            }
        }

        fn $read(from: &mut Reader<'_>) -> Result<Option<$type>, Damaged> {
            let mut is_there = 0_u64;
            is_there.read(from)?;
            if is_there == 0 { Ok(None) } else { Ok(Some($type { $($field: read_list(from)?),* })) }
        }
    };
}

lists!(
    write_paths,
    read_paths,
    PathColumns {
        displacement_end,
        max_displacement,
        first_stick_duration,
        stick_time,
        friction_work,
        sticks,
        slips,
        sub_phases,
        diverged,
    }
);
lists!(write_events, read_events, EventColumns { count, time, displacement, force, sign, kind });
lists!(
    write_trajectories,
    read_trajectories,
    TrajectoryRows { path, displacement, velocity, temperature, force, friction, is_static }
);

/// Append the rows of a block and the numbers of its diverged paths to `out`. Its sums are not
/// written.
pub fn write_block(block: &BlockResult, out: &mut Vec<u8>) {
    (block.diverged.len() as u64).write(out);
    block.diverged.iter().for_each(|path| path.write(out));
    write_rows(&block.into(), out);
}

/// Read a block that [`write_block`] wrote. Its sums are not among the bytes, so a copy of `totals`
/// takes their place.
pub fn read_block(from: &mut Reader<'_>, totals: &Totals) -> Result<BlockResult, Damaged> {
    let mut diverged = vec![0; from.length()?];
    diverged.iter_mut().try_for_each(|path| path.read(from))?;
    let OwnedRows { first_path, paths, path_columns, events, trajectories } = read_rows(from)?;
    Ok(BlockResult { first_path, paths, diverged, totals: totals.clone(), path_columns, events, trajectories })
}

/// Append rows to `out`.
pub(crate) fn write_rows(rows: &Rows, out: &mut Vec<u8>) {
    rows.first_path.write(out);
    rows.paths.write(out);
    write_paths(rows.path_columns, out);
    write_events(rows.events, out);
    write_trajectories(rows.trajectories, out);
}

/// Read rows that [`write_rows`] wrote.
pub(crate) fn read_rows(from: &mut Reader<'_>) -> Result<OwnedRows, Damaged> {
    let (mut first_path, mut paths) = (0, 0);
    first_path.read(from)?;
    paths.read(from)?;
    Ok(OwnedRows {
        first_path,
        paths,
        path_columns: read_paths(from)?,
        events: read_events(from)?,
        trajectories: read_trajectories(from)?,
    })
}
