//! The checksum of everything that this program saves: CRC-32, which detects any single flipped bit
//! and any burst of errors within 32 consecutive bits. In a finished file it follows the end that
//! HDF5 sees.
//!
//! HDF5 follows any address, even if a flipped bit has changed it, which may give wrong numbers, a
//! crash or an endless loop. A file is therefore compared with its checksum before the library
//! opens it. A program that changes the file drops the bytes after the end, including the checksum.
//! If there are bytes after the end, they must be a checksum, so that a damaged checksum is not
//! mistaken for a missing one.
//!
//! The end is in the superblock, the first bytes of an HDF5 file, which are read without the
//! library, because it must not see a damaged file (HDF5 File Format Specification, version 3.0,
//! section II.A).

use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::Path;

/// The checksum of these bytes, continued from `before`, the checksum of the bytes that precede
/// them (0 at the start).
pub(crate) fn checksum(before: u32, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(before);
    hasher.update(bytes);
    hasher.finalize()
}

/// The first bytes of the checksum of a file.
const MAGIC: &[u8; 8] = b"mc-seal\n";
/// Length in bytes of the checksum of a file: the magic, the length and the checksum of the file before it, and a
/// checksum of these three.
const LENGTH: usize = 8 + 8 + 4 + 4;

/// Append the checksum to a file that HDF5 has closed.
pub fn append(path: &Path) -> io::Result<()> {
    let mut file = File::options().read(true).append(true).open(path)?;
    let length = file.metadata()?.len();
    let sum = sum(&mut file, length)?;
    file.write_all(&bytes(length, sum))?;
    file.sync_all()
}

/// Whether the checksum of a file is right; none if it has none. In files larger than `largest`
/// bytes it is found but not computed.
pub fn is_right(path: &Path, largest: u64) -> io::Result<Option<bool>> {
    let mut file = File::open(path)?;
    let Some((length, found)) = find(&mut file)? else {
        return Ok(None);
    };
    if length > largest {
        return Ok(Some(found.starts_with(MAGIC)));
    }
    file.rewind()?;
    let sum = sum(&mut file, length)?;
    Ok(Some(found == bytes(length, sum)))
}

/// Whether a file has a checksum, right or wrong. Only its two ends are read.
pub fn is_there(path: &Path) -> io::Result<bool> {
    find(&mut File::open(path)?).map(|found| found.is_some())
}

/// The length of the file before its checksum, and the checksum itself, or the bytes in its place.
/// None if the file has none.
fn find(file: &mut File) -> io::Result<Option<(u64, [u8; LENGTH])>> {
    let all = file.metadata()?.len();
    let end = superblock(file)?.and_then(|superblock| superblock.end);
    let is_absent = end.is_none_or(|end| end == all);
    let Some(length) = all.checked_sub(LENGTH as u64) else {
        return Ok(None);
    };
    let mut found = [0; LENGTH];
    file.seek(SeekFrom::Start(length))?;
    file.read_exact(&mut found)?;
    Ok(if found.starts_with(MAGIC) || !is_absent {
        Some((length, found))
    } else {
        None
    })
}

fn bytes(length: u64, sum: u32) -> [u8; LENGTH] {
    let mut bytes = [0; LENGTH];
    bytes[..8].copy_from_slice(MAGIC);
    bytes[8..16].copy_from_slice(&length.to_le_bytes());
    bytes[16..20].copy_from_slice(&sum.to_le_bytes());
    let own = checksum(0, &bytes[..20]);
    bytes[20..].copy_from_slice(&own.to_le_bytes());
    bytes
}

/// The checksum of the first `length` bytes.
fn sum(file: &mut File, length: u64) -> io::Result<u32> {
    let mut left = length;
    let mut buffer = vec![0; 1 << 20];
    let mut sum = 0;
    while left > 0 {
        let some = left.min(buffer.len() as u64) as usize;
        file.read_exact(&mut buffer[..some])?;
        sum = checksum(sum, &buffer[..some]);
        left -= some as u64;
    }
    Ok(sum)
}

/// The first bytes of every HDF5 file.
const SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";

/// The superblock of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Superblock {
    /// The length of the file in bytes, as HDF5 knows it; none in a version of the format that this
    /// program neither writes nor changes.
    pub end: Option<u64>,
    /// Whether the file is marked as open for writing.
    pub is_open: bool,
}

/// Read the superblock at the beginning of a file; none if this is not an HDF5 file.
pub fn superblock(file: &mut File) -> io::Result<Option<Superblock>> {
    file.rewind()?;
    let mut bytes = Vec::new();
    file.take(64).read_to_end(&mut bytes)?;
    if !bytes.starts_with(&SIGNATURE) {
        return Ok(None);
    }
    let at = |place: usize| {
        bytes
            .get(place..place + 8)
            .and_then(|bytes| bytes.try_into().ok())
            .map(u64::from_le_bytes)
    };
    let byte = |place: usize| bytes.get(place).copied().unwrap_or_default();
    Ok(Some(match byte(8) {
        // Versions 2 and 3, with addresses of eight bytes.
        2 | 3 if byte(9) == 8 => Superblock {
            end: at(28),
            is_open: byte(11) & 1 == 1,
        },
        _ => Superblock {
            end: None,
            is_open: false,
        },
    }))
}
