//! Standard normals by inversion: one 64-bit draw, one normal.
//!
//! A draw is a signed integer y, uniform, -2^63 <= y < 2^63; it stands for z = sign(y) z(|y|), z(y) = -Phi^{-1}(y 2^-64). Each
//! octave of |y| is cut into 128 cells, and on each cell z(y) is a parabola, whose three coefficients are packed into two 64-bit
//! words (`tools/normal_table.py`). The number of the cell is the exponent and the upper mantissa bits of |y| as a double, so
//! there is nothing to search, no tail to treat apart, and no branch: the normals reach from the median to 9.1 sigma, where
//! |y| = 1. (y = 0, once in 2^64 draws, falls into the cell of |y| = 2.)
//!
//! One draw a normal makes the position in a path's stream equal to the number of the step.

use super::normal_table::{C2_BITS, LEVELS, SLOPES};
use crate::lanes::Lanes;

/// Greatest absolute error of [`standard_normal`] as an inverse of the normal distribution function, anywhere from the median
/// to 9.1 sigma; attained next to the median, and measured by the tests.
pub const MAX_NORMAL_ERROR: f64 = 2.4e-9;

const SIGN: u64 = 1 << 63;
/// Bits of a double below the number of its cell: 52 of mantissa less seven.
const CELL_SHIFT: u32 = 45;
/// What the doubles of a cell have in common, and what makes the cell's centre of it.
const CELL_KEEP: u64 = !((1 << CELL_SHIFT) - 1);
const CELL_CENTRE: u64 = 1 << (CELL_SHIFT - 1);

/// The normal that a 64-bit draw stands for.
#[inline(always)]
pub fn standard_normal(draw: u64) -> f64 {
    let signed = draw as i64 as f64;
    let y = signed.abs();
    let cell = (y.to_bits() >> CELL_SHIFT) as usize & (LEVELS.len() - 1);
    let t = y - f64::from_bits(y.to_bits() & CELL_KEEP | CELL_CENTRE);
    let (c0, c1) = (f64::from_bits(LEVELS[cell]), f64::from_bits(SLOPES[cell]));
    let c2 = f64::from_bits(SLOPES[cell] << (64 - C2_BITS));
    c2.mul_add(t, c1).mul_add(t, c0).copysign(signed)
}

/// The normals that draws stand for, lane by lane: the same bits as [`standard_normal`]'s.
#[inline(always)]
pub(super) fn standard_normals<L: Lanes>(draws: L::Bits) -> L {
    let signed = L::from_integers(draws).to_bits();
    let y = L::keep_and_set(signed, !SIGN, 0);
    let cell = L::shr::<CELL_SHIFT>(y);
    let t = L::from_bits(y).sub(L::from_bits(L::keep_and_set(y, CELL_KEEP, CELL_CENTRE)));
    let (c0, slope) = (L::from_bits(L::gather(&LEVELS, cell)), L::gather(&SLOPES, cell));
    let (c1, c2) = (L::from_bits(slope), L::from_bits(L::shl::<{ 64 - C2_BITS }>(slope)));
    let z = c2.mul_add(t, c1).mul_add(t, c0);
    L::from_bits(L::xor_masked(z.to_bits(), signed, SIGN))
}

#[cfg(test)]
mod tests {
    use super::super::normal_table::REFERENCE;
    use super::*;

    /// Reference: 40-digit arithmetic at 1736 integers y, in every octave.
    #[test]
    fn the_inverse_is_within_its_stated_error_on_every_octave() {
        let mut worst = [0.0f64; 64];
        for &(y, z) in &REFERENCE {
            // a double holds 53 bits: y moves by half an ulp, z by less than 2^-53 / z'
            let error = (standard_normal(y) - z).abs();
            let octave = y.ilog2() as usize;
            worst[octave] = worst[octave].max(error);
            assert_eq!(standard_normal(y.wrapping_neg()), -standard_normal(y), "the law is symmetric");
        }
        for (octave, error) in worst.iter().enumerate() {
            assert!(*error <= MAX_NORMAL_ERROR, "octave {octave}: {error:e}");
        }
        let greatest = worst.iter().fold(0.0f64, |a, &b| a.max(b));
        assert!(greatest > MAX_NORMAL_ERROR / 2.0, "the stated error {MAX_NORMAL_ERROR:e} is idle: {greatest:e}");
    }

    #[test]
    fn the_ends_are_nine_sigma_and_the_median() {
        assert!((standard_normal(1) - 9.080_155_124_873_613).abs() < MAX_NORMAL_ERROR);
        assert!((standard_normal(u64::MAX) + 9.080_155_124_873_613).abs() < MAX_NORMAL_ERROR);
        // the largest |y| rounds to 2^63, the median itself
        assert_eq!(standard_normal(i64::MAX as u64), 0.0);
        assert!(standard_normal(i64::MAX as u64 - 2048).abs() < MAX_NORMAL_ERROR);
    }

    #[test]
    fn cells_join() {
        for border in (9..63).flat_map(|o| (0..128).map(move |i| (1u64 << o) + (i << (o - 7)))) {
            let (below, above) = (standard_normal((border - 2) | 1), standard_normal(border | 1));
            // two steps of y move z by at most 4 / (y z'), z' > 0.6 sqrt(z)
            let slope = 8.0 / border as f64;
            assert!((below - above).abs() < 2.0 * MAX_NORMAL_ERROR + slope, "{border}: {below} {above}");
        }
    }
}
