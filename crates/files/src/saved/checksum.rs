//! The checksum of every file of this program: CRC-32, which detects any single flipped bit and any
//! burst of errors within 32 consecutive bits.

/// The checksum of these bytes, continued from `before`, the checksum of the bytes that precede
/// them (0 at the start).
pub(crate) fn checksum(before: u32, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(before);
    hasher.update(bytes);
    hasher.finalize()
}
