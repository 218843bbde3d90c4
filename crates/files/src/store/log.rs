//! A saved run: its state, and an append-only log of the rows of single paths.
//!
//! A block is stored as its length in bytes and its bytes. The state of a run contains the length
//! of the log that is valid, and its checksum ([`Position`]). Anything beyond this length, left by
//! an interrupted write, is cut off.

use super::errors::not_opened;
use super::{StoreError, system};
use crate::saved::checksum::checksum;
use crate::saved::{MAGIC, Position, SavedError, State, of_bytes, read_rows};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;
use stickslip::stats::BlockRows;
use stickslip::sums::Reader;

/// Number of bytes collected in memory before they are written.
const BUFFER: usize = 1 << 20;

/// A log that is open for writing.
#[derive(Debug)]
pub(super) struct Log {
    file: BufWriter<File>,
    /// The end of the log, including bytes still in memory.
    end: Position,
}

impl Log {
    /// Create a new log. A leftover log of a killed process is removed.
    pub fn create(path: &Path) -> io::Result<Log> {
        Ok(Log::of(system::create(path)?, Position::default()))
    }

    /// Open a log to continue it; everything beyond `end` is cut off.
    pub fn go_on(path: &Path, end: Position) -> io::Result<Log> {
        let mut file = system::open(path, File::options().write(true))?;
        file.set_len(end.length)?;
        file.seek(SeekFrom::End(0))?;
        Ok(Log::of(file, end))
    }

    fn of(file: File, end: Position) -> Log {
        let file = BufWriter::with_capacity(BUFFER, file);
        Log { file, end }
    }

    /// The open file, so that the caller can check that it still has this name.
    pub fn file(&self) -> &File {
        self.file.get_ref()
    }

    /// Append the rows of the next block.
    pub fn append(&mut self, rows: &BlockRows) -> io::Result<()> {
        let mut bytes = Vec::new();
        self.end = self.end.after(rows, &mut bytes);
        self.file.write_all(&bytes)
    }

    /// Write everything to the disk and return the position that is valid now.
    pub fn sync(&mut self) -> io::Result<Position> {
        self.file.flush()?;
        self.file().sync_data()?;
        Ok(self.end)
    }
}

/// Read the log up to this end, and pass every block to `visit`. Damage is an error, found at the
/// end at the latest.
pub(super) fn read(
    path: &Path,
    end: Position,
    mut visit: impl FnMut(BlockRows) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let damaged = || SavedError::Damaged {
        path: path.to_owned(),
    };
    let file = system::open(path, File::options().read(true)).map_err(not_opened(path))?;
    let mut log = BufReader::with_capacity(BUFFER, file).take(end.length);
    let mut sum = 0;
    while log.limit() > 0 {
        // A claimed length may be wrong, so no memory is allocated before the bytes are there.
        let mut next = |length: u64| {
            let mut bytes = Vec::new();
            let read = (&mut log).take(length).read_to_end(&mut bytes);
            read.map_err(not_opened(path))?;
            sum = checksum(sum, &bytes);
            match bytes.len() as u64 == length {
                true => Ok::<_, StoreError>(bytes),
                false => Err(damaged().into()),
            }
        };
        let mut length = [0; 8];
        length.copy_from_slice(&next(8)?);
        let bytes = next(u64::from_le_bytes(length))?;
        let mut from = Reader::new(&bytes);
        let rows = read_rows(&mut from).ok().filter(|_| from.left() == 0);
        visit(rows.ok_or_else(damaged)?)?;
    }
    match sum == end.checksum {
        true => Ok(()),
        false => Err(damaged().into()),
    }
}

/// Size limit in bytes; a larger file is reported as damaged without being read. The largest state,
/// with 100 000 rows of the output grid, is smaller.
const LARGEST: u64 = 1 << 31;

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
