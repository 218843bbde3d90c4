//! The log of a run: the rows of its single paths, block after block. Blocks are only ever
//! appended.
//!
//! A block is stored as its length in bytes, its bytes, and a checksum of everything in the log up
//! to there. Therefore the state of a run needs to contain only the length of the log that is valid
//! and the checksum at its end ([`Position`]). Anything that an interrupted write has left beyond
//! this length is cut off.

use super::checksum::checksum;
use super::{StoreError, own};
use crate::dataset::Rows;
use crate::stats::{BlockResult, Codec, Damaged, EventColumns, PathColumns, Reader, Totals, TrajectoryRows};
use std::fs::File;
use std::io::{self, BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

/// How much of a log is valid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Position {
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

/// Number of bytes that are gathered in memory before they are written.
const BUFFER: usize = 1 << 20;

/// A log that is open for writing.
#[derive(Debug)]
pub(super) struct Log {
    file: File,
    waiting: Vec<u8>,
    /// The end of the log, including the bytes that still wait in memory.
    end: Position,
}

impl Log {
    /// Create a new log. One that a killed process has left is removed.
    pub fn create(path: &Path) -> io::Result<Log> {
        let file = own::create(path)?;
        Ok(Log { file, waiting: Vec::new(), end: Position::default() })
    }

    /// Open a log to continue it; everything beyond `end` is cut off.
    pub fn go_on(path: &Path, end: Position) -> io::Result<Log> {
        let mut file = own::open(path, File::options().write(true))?;
        file.set_len(end.length)?;
        file.seek(SeekFrom::End(0))?;
        Ok(Log { file, waiting: Vec::new(), end })
    }

    /// The open file, so that the caller can check that it still is the one of this name.
    pub fn file(&self) -> &File {
        &self.file
    }

    /// Append the rows of the next block.
    pub fn append(&mut self, rows: &Rows) -> io::Result<()> {
        self.end = self.end.after(rows, &mut self.waiting);
        if self.waiting.len() >= BUFFER { self.write() } else { Ok(()) }
    }

    /// Write everything to the disk and return the position that is valid now.
    pub fn sync(&mut self) -> io::Result<Position> {
        self.write()?;
        self.file.sync_data()?;
        Ok(self.end)
    }

    fn write(&mut self) -> io::Result<()> {
        self.file.write_all(&self.waiting)?;
        self.waiting.clear();
        Ok(())
    }
}

/// A log that is read block by block.
struct Reading {
    path: PathBuf,
    file: BufReader<File>,
    /// The position after what was read.
    at: Position,
    /// The end of the valid part.
    end: Position,
    bytes: Vec<u8>,
    /// The next block.
    next: Option<OwnedRows>,
}

impl Reading {
    fn open(path: PathBuf, end: Position) -> Result<Reading, StoreError> {
        let failed = |source| StoreError::NotOpened { path: path.clone(), source };
        let file = own::open(&path, File::options().read(true)).map_err(failed)?;
        // The claimed length is compared with that of the file before any memory is allocated.
        if file.metadata().map_err(failed)?.len() < end.length {
            return Err(StoreError::DamagedState { path });
        }
        let file = BufReader::with_capacity(BUFFER, file);
        let mut reading = Reading { path, file, at: Position::default(), end, bytes: Vec::new(), next: None };
        reading.advance()?;
        Ok(reading)
    }

    /// Return the next block, and read the one after it. Damage is an error.
    fn advance(&mut self) -> Result<Option<OwnedRows>, StoreError> {
        let next = if self.at.length < self.end.length { Some(self.block()?) } else { None };
        if next.is_none() && self.at != self.end {
            return Err(self.damaged());
        }
        Ok(std::mem::replace(&mut self.next, next))
    }

    fn block(&mut self) -> Result<OwnedRows, StoreError> {
        let mut head = [0; 8];
        self.exactly(&mut head)?;
        let length = u64::from_le_bytes(head);
        let left = self.end.length - self.at.length;
        // The claimed length of the block is compared with what is left before memory is allocated.
        if left < 12 || length > left - 12 {
            return Err(self.damaged());
        }
        let (mut bytes, mut tail) = (std::mem::take(&mut self.bytes), [0; 4]);
        bytes.resize(length as usize, 0);
        self.exactly(&mut bytes)?;
        self.exactly(&mut tail)?;
        let sum = checksum(checksum(self.at.checksum, &head), &bytes);
        if u32::from_le_bytes(tail) != sum {
            return Err(self.damaged());
        }
        self.at = Position { length: self.at.length + length + 12, checksum: sum };
        let mut from = Reader::new(&bytes);
        let rows = read_rows(&mut from).ok().filter(|_| from.left() == 0).ok_or_else(|| self.damaged())?;
        self.bytes = bytes;
        Ok(rows)
    }

    fn exactly(&mut self, bytes: &mut [u8]) -> Result<(), StoreError> {
        self.file.read_exact(bytes).map_err(|source| match source.kind() {
            io::ErrorKind::UnexpectedEof => self.damaged(),
            _ => StoreError::NotOpened { path: self.path.clone(), source },
        })
    }

    fn damaged(&self) -> StoreError {
        StoreError::DamagedState { path: self.path.clone() }
    }
}

/// Read each of these logs up to its end, and pass every block to `visit`, in the order of paths.
/// The blocks of each log must be in this order.
pub(super) fn read(
    logs: impl IntoIterator<Item = (PathBuf, Position)>,
    mut visit: impl FnMut(OwnedRows) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let open = |(path, end)| Reading::open(path, end);
    let mut logs = logs.into_iter().map(open).collect::<Result<Vec<Reading>, _>>()?;
    let first_path = |log: &&mut Reading| log.next.as_ref().map(|rows| rows.first_path);
    while let Some(log) = logs.iter_mut().filter(|log| log.next.is_some()).min_by_key(first_path) {
        if let Some(rows) = log.advance()? {
            visit(rows)?;
        }
    }
    Ok(())
}

/// The rows of one block, read back from a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct OwnedRows {
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

fn write_rows(rows: &Rows, out: &mut Vec<u8>) {
    rows.first_path.write(out);
    rows.paths.write(out);
    write_paths(rows.path_columns, out);
    write_events(rows.events, out);
    write_trajectories(rows.trajectories, out);
}

fn read_rows(from: &mut Reader<'_>) -> Result<OwnedRows, Damaged> {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn block(first_path: u64) -> OwnedRows {
        let n = (first_path % 5) as usize;
        let real = |k: usize| (0..n).map(|i| (i * k) as f64 - 0.1).collect::<Vec<f64>>();
        OwnedRows {
            first_path,
            paths: n as u64,
            path_columns: Some(PathColumns {
                displacement_end: real(1),
                first_stick_duration: vec![f64::NAN; n],
                sticks: vec![u32::MAX; n],
                diverged: (0..n).map(|i| i % 2 == 0).collect(),
                ..PathColumns::default()
            }),
            events: Some(EventColumns {
                count: vec![3; n],
                sign: vec![-1; n],
                time: real(7),
                ..EventColumns::default()
            }),
            trajectories: None,
        }
    }

    fn read_all(path: &Path, end: Position) -> Result<Vec<OwnedRows>, StoreError> {
        let mut all = Vec::new();
        read([(path.to_owned(), end)], |rows| {
            all.push(rows);
            Ok(())
        })?;
        Ok(all)
    }

    fn bits(rows: &[OwnedRows]) -> Vec<Vec<u8>> {
        let bytes = |rows: &OwnedRows| {
            let mut out = Vec::new();
            write_rows(&rows.rows(), &mut out);
            out
        };
        rows.iter().map(bytes).collect()
    }

    #[test]
    fn counted_rows_are_read_back_and_torn_rows_are_cut_off() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("rows");
        let blocks: Vec<OwnedRows> = (0..20).map(block).collect();
        let mut log = Log::create(&path).expect("a new log");
        let mut ends = vec![Position::default()];
        for block in &blocks {
            log.append(&block.rows()).expect("room");
            ends.push(log.sync().expect("room"));
        }
        let whole = std::fs::read(&path).expect("there");
        for (n, &end) in ends.iter().enumerate() {
            assert_eq!(bits(&read_all(&path, end).expect("whole")), bits(&blocks[..n]));
        }
        // Another checksum, or an end within a block, is reported as damage.
        let last = ends[20];
        assert!(matches!(read_all(&path, Position { checksum: 1, ..last }), Err(StoreError::DamagedState { .. })));
        assert!(matches!(
            read_all(&path, Position { length: last.length - 1, ..last }),
            Err(StoreError::DamagedState { .. })
        ));
        // A length beyond that of the file is an error before memory is allocated.
        assert!(matches!(read_all(&path, Position { length: 1 << 60, ..last }), Err(StoreError::DamagedState { .. })));
        // The log is cut at every byte, and one bit of every byte is flipped.
        for at in 0..whole.len() {
            std::fs::write(&path, &whole[..at]).expect("room");
            assert!(matches!(read_all(&path, last), Err(StoreError::DamagedState { .. })), "cut at {at}");
            let mut flipped = whole.clone();
            flipped[at] ^= 1 << (at % 8);
            std::fs::write(&path, &flipped).expect("room");
            assert!(matches!(read_all(&path, last), Err(StoreError::DamagedState { .. })), "flipped at {at}");
        }
        // The log is continued after the seventh block, behind which a power failure has left other
        // bytes.
        std::fs::write(&path, [&whole[..ends[7].length as usize], &[0xff; 99]].concat()).expect("room");
        let mut log = Log::go_on(&path, ends[7]).expect("there");
        blocks[7..].iter().for_each(|block| log.append(&block.rows()).expect("room"));
        assert_eq!(log.sync().expect("room"), last);
        assert_eq!(std::fs::read(&path).expect("there"), whole);
    }

    /// Blocks that are spread over three logs are read in the order of their paths.
    #[test]
    fn several_logs_are_read_in_the_order_of_paths() {
        let folder = tempfile::tempdir().expect("a folder");
        let blocks: Vec<OwnedRows> = (0..20).map(block).collect();
        let logs: Vec<(PathBuf, Position)> = (0..3)
            .map(|k| {
                let path = folder.path().join(k.to_string());
                let mut log = Log::create(&path).expect("a new log");
                let own = blocks.iter().filter(|block| block.first_path * block.first_path % 3 == k);
                own.for_each(|block| log.append(&block.rows()).expect("room"));
                let end = log.sync().expect("room");
                (path, end)
            })
            .collect();
        let mut all = Vec::new();
        read(logs, |rows| {
            all.push(rows);
            Ok(())
        })
        .expect("whole");
        let paths: Vec<u64> = all.iter().map(|rows| rows.first_path).collect();
        assert!(bits(&all) == bits(&blocks), "{paths:?}");
    }
}
