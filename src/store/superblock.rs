//! The first bytes of an HDF5 file: where it ends, and whether it was closed.
//!
//! They are read without the library, which must not see a damaged file. (HDF5 File Format
//! Specification, version 3.0, section II.A.)

use std::fs::File;
use std::io::{self, Read as _, Seek as _};

/// The first bytes of every HDF5 file.
const SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";

/// What the superblock of a file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Superblock {
    /// The length of the file in bytes, as HDF5 knows it; none in a version of the format that this
    /// program neither writes nor changes.
    pub end: Option<u64>,
    /// Whether the file is marked as open for writing.
    pub is_open: bool,
}

/// Read the superblock at the beginning of a file; none if this is not an HDF5 file.
pub(super) fn superblock(file: &mut File) -> io::Result<Option<Superblock>> {
    file.rewind()?;
    let mut bytes = Vec::new();
    file.take(64).read_to_end(&mut bytes)?;
    if !bytes.starts_with(&SIGNATURE) {
        return Ok(None);
    }
    let at = |place: usize| bytes.get(place..place + 8).and_then(|bytes| bytes.try_into().ok()).map(u64::from_le_bytes);
    let byte = |place: usize| bytes.get(place).copied().unwrap_or_default();
    Ok(Some(match byte(8) {
        // Versions 2 and 3, with addresses of eight bytes.
        2 | 3 if byte(9) == 8 => Superblock { end: at(28), is_open: byte(11) & 1 == 1 },
        _ => Superblock { end: None, is_open: false },
    }))
}
