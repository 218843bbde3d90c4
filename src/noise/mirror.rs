//! Antithetic pairs: paths 2k and 2k + 1 see the same noise and its mirror image (Hammersley and
//! Morton, *A new Monte Carlo technique: antithetic variates*, Mathematical Proceedings of the
//! Cambridge Philosophical Society 52 (1956)).
//!
//! Where the random numbers of a path are made, a mirror image is a path number with one more bit:
//! it has the uniform numbers of the path without the bit, and its normals with the other sign. The
//! law of a path does not change by that, for a normal has no sign of its own.

/// A path number with this bit is the mirror image of the path without it.
pub const MIRROR: u64 = 1 << 63;

/// What path `path` of antithetic pairs draws from: the even one of a pair from its own numbers,
/// the odd one from their mirror image.
pub const fn antithetic(path: u64) -> u64 {
    if path.is_multiple_of(2) { path } else { (path - 1) | MIRROR }
}

/// The path that a number draws from, and what its draws are exchanged with, bit by bit, where they
/// become normals: all ones turn a draw y of a normal ([`super::standard_normal`]) into -y - 1.
pub(super) const fn parts(path: u64) -> (u64, u64) {
    (path & !MIRROR, if path & MIRROR == 0 { 0 } else { u64::MAX })
}
