//! A run as it is saved: its state, and the log with the rows of its single paths, to which blocks
//! are only ever appended.
//!
//! A block is stored as its length in bytes, its bytes, and a checksum of everything in the log up
//! to there. Therefore the state of a run needs to contain only the length of the log that is valid
//! and the checksum at its end ([`Position`]). Anything that an interrupted write has left beyond
//! this length is cut off.

use super::errors::not_opened;
use super::{StoreError, system};
use crate::saved::{MAGIC, Position, SavedError, State, checksum, of_bytes, read_rows};
use std::fs::File;
use std::io::{self, BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;
use stickslip::stats::BlockRows;
use stickslip::sums::Reader;

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
        let file = system::create(path)?;
        Ok(Log {
            file,
            waiting: Vec::new(),
            end: Position::default(),
        })
    }

    /// Open a log to continue it; everything beyond `end` is cut off.
    pub fn go_on(path: &Path, end: Position) -> io::Result<Log> {
        let mut file = system::open(path, File::options().write(true))?;
        file.set_len(end.length)?;
        file.seek(SeekFrom::End(0))?;
        Ok(Log {
            file,
            waiting: Vec::new(),
            end,
        })
    }

    /// The open file, so that the caller can check that it still is the one of this name.
    pub fn file(&self) -> &File {
        &self.file
    }

    /// Append the rows of the next block.
    pub fn append(&mut self, rows: &BlockRows) -> io::Result<()> {
        self.end = self.end.after(rows, &mut self.waiting);
        if self.waiting.len() >= BUFFER {
            self.write()
        } else {
            Ok(())
        }
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
struct LogReading<'a> {
    path: &'a Path,
    file: BufReader<File>,
    /// The position after what was read.
    at: Position,
    /// The end of the valid part.
    end: Position,
    bytes: Vec<u8>,
}

impl<'a> LogReading<'a> {
    fn open(path: &'a Path, end: Position) -> Result<Self, StoreError> {
        let file = system::open(path, File::options().read(true)).map_err(not_opened(path))?;
        // The claimed length is compared with that of the file before any memory is allocated.
        if file.metadata().map_err(not_opened(path))?.len() < end.length {
            return Err(SavedError::Damaged {
                path: path.to_owned(),
            }
            .into());
        }
        let file = BufReader::with_capacity(BUFFER, file);
        Ok(LogReading {
            path,
            file,
            at: Position::default(),
            end,
            bytes: Vec::new(),
        })
    }

    /// Return the next block. Damage is an error.
    fn block(&mut self) -> Result<BlockRows, StoreError> {
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
        self.at = Position {
            length: self.at.length + length + 12,
            checksum: sum,
        };
        let mut from = Reader::new(&bytes);
        let rows = read_rows(&mut from)
            .ok()
            .filter(|_| from.left() == 0)
            .ok_or_else(|| self.damaged())?;
        self.bytes = bytes;
        Ok(rows)
    }

    fn exactly(&mut self, bytes: &mut [u8]) -> Result<(), StoreError> {
        self.file
            .read_exact(bytes)
            .map_err(|source| match source.kind() {
                io::ErrorKind::UnexpectedEof => self.damaged(),
                _ => not_opened(self.path)(source),
            })
    }

    fn damaged(&self) -> StoreError {
        SavedError::Damaged {
            path: self.path.to_owned(),
        }
        .into()
    }
}

/// Read the log up to this end, and pass every block to `visit`.
pub(super) fn read(
    path: &Path,
    end: Position,
    mut visit: impl FnMut(BlockRows) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let mut log = LogReading::open(path, end)?;
    while log.at.length < end.length {
        visit(log.block()?)?;
    }
    if log.at == end {
        Ok(())
    } else {
        Err(log.damaged())
    }
}

/// Size limit in bytes; a larger file is reported as damaged without being read. The largest state,
/// with 100 000 rows of the output grid, is smaller.
const LARGEST: u64 = 1 << 31;

/// Whether a file begins as only states of this program do, damaged or not.
pub(super) fn has_mark(path: &Path) -> bool {
    let mut bytes = [0; MAGIC.len()];
    let read = system::open(path, File::options().read(true))
        .and_then(|mut file| file.read_exact(&mut bytes));
    read.is_ok() && bytes == *MAGIC
}

/// Read the state of a run from a file.
pub(super) fn read_state(path: &Path) -> Result<State, StoreError> {
    let mut file = system::open(path, File::options().read(true)).map_err(not_opened(path))?;
    let mut bytes = Vec::new();
    if file.metadata().map_err(not_opened(path))?.len() <= LARGEST {
        (&mut file)
            .take(MAGIC.len() as u64)
            .read_to_end(&mut bytes)
            .map_err(not_opened(path))?;
        // A file with other first bytes is not a state, so the rest of it is not read.
        if bytes == MAGIC {
            file.take(LARGEST)
                .read_to_end(&mut bytes)
                .map_err(not_opened(path))?;
        }
    }
    Ok(of_bytes(&bytes, path)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::saved::write_rows;
    use stickslip::stats::{EventColumns, PathColumns};

    fn block(first_path: u64) -> BlockRows {
        let n = (first_path % 5) as usize;
        let real = |k: usize| (0..n).map(|i| (i * k) as f64 - 0.1).collect::<Vec<f64>>();
        BlockRows {
            first_path,
            paths: n as u64,
            path_columns: Some(PathColumns {
                displacement_end: real(1),
                first_stick_duration: vec![f64::NAN; n],
                sticks: vec![u32::MAX; n],
                diverged: (0..n).map(|i| (i % 2 == 0).into()).collect(),
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

    fn read_all(path: &Path, end: Position) -> Result<Vec<BlockRows>, StoreError> {
        let mut all = Vec::new();
        read(path, end, |rows| {
            all.push(rows);
            Ok(())
        })?;
        Ok(all)
    }

    fn is_damaged(path: &Path, end: Position) -> bool {
        matches!(
            read_all(path, end),
            Err(StoreError::Saved(SavedError::Damaged { .. }))
        )
    }

    fn bits(rows: &[BlockRows]) -> Vec<Vec<u8>> {
        let bytes = |rows: &BlockRows| {
            let mut out = Vec::new();
            write_rows(rows, &mut out);
            out
        };
        rows.iter().map(bytes).collect()
    }

    #[test]
    fn counted_rows_are_read_back_and_torn_rows_are_cut_off() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("rows");
        let blocks: Vec<BlockRows> = (0..20).map(block).collect();
        let mut log = Log::create(&path).expect("a new log");
        let mut ends = vec![Position::default()];
        for block in &blocks {
            log.append(block).expect("room");
            ends.push(log.sync().expect("room"));
        }
        let whole = std::fs::read(&path).expect("there");
        for (n, &end) in ends.iter().enumerate() {
            assert_eq!(
                bits(&read_all(&path, end).expect("whole")),
                bits(&blocks[..n])
            );
        }
        // Another checksum, or an end within a block, is reported as damage.
        let last = ends[20];
        assert!(is_damaged(
            &path,
            Position {
                checksum: 1,
                ..last
            }
        ));
        assert!(is_damaged(
            &path,
            Position {
                length: last.length - 1,
                ..last
            }
        ));
        // A length beyond that of the file is an error before memory is allocated.
        assert!(is_damaged(
            &path,
            Position {
                length: 1 << 60,
                ..last
            }
        ));
        // The log is cut at every byte, and one bit of every byte is flipped.
        for at in 0..whole.len() {
            std::fs::write(&path, &whole[..at]).expect("room");
            assert!(is_damaged(&path, last), "cut at {at}");
            let mut flipped = whole.clone();
            flipped[at] ^= 1 << (at % 8);
            std::fs::write(&path, &flipped).expect("room");
            assert!(is_damaged(&path, last), "flipped at {at}");
        }
        // The log is continued after the seventh block, behind which a power failure has left other
        // bytes.
        std::fs::write(
            &path,
            [&whole[..ends[7].length as usize], &[0xff; 99]].concat(),
        )
        .expect("room");
        let mut log = Log::go_on(&path, ends[7]).expect("there");
        blocks[7..]
            .iter()
            .for_each(|block| log.append(block).expect("room"));
        assert_eq!(log.sync().expect("room"), last);
        assert_eq!(std::fs::read(&path).expect("there"), whole);
    }
}
