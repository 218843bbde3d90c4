//! The checksum of everything that is written beside the results: CRC-32, which tells any flipped
//! bit, and any 32 in a row.

/// Of these bytes, going on from the checksum of what comes before them.
pub(super) fn checksum(before: u32, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(before);
    hasher.update(bytes);
    hasher.finalize()
}
