//! Antithetic pairs: paths 2k and 2k + 1 have the same noise and its mirror image (Hammersley and
//! Morton, *A new Monte Carlo technique: antithetic variates*, Mathematical Proceedings of the
//! Cambridge Philosophical Society 52 (1956)).
//!
//! For the random numbers of a path, its mirror image is a path number with one more bit. The
//! mirror image has the uniform numbers of the path without the bit, and its normals with the
//! opposite sign. This does not change the law of a path, because the law of a normal is symmetric.

/// A path number with this bit is the mirror image of the path without it.
pub const MIRROR: u64 = 1 << 63;

/// The path number from which path `path` of antithetic pairs takes its random numbers: the even
/// path of a pair from its own, the odd one from the mirror image of the even one.
pub const fn antithetic(path: u64) -> u64 {
    if path.is_multiple_of(2) {
        path
    } else {
        (path - 1) | MIRROR
    }
}

/// The path number without [`MIRROR`], and the bits that a draw is combined with (exclusive or)
/// before it becomes a normal: all ones for a mirror image, which turns a draw y
/// ([`super::standard_normal`]) into -y - 1.
pub(super) const fn parts(path: u64) -> (u64, u64) {
    (
        path & !MIRROR,
        if path & MIRROR == 0 { 0 } else { u64::MAX },
    )
}
