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

/// Greatest absolute error of [`standard_normal`] as an inverse of the normal distribution function, anywhere from the median
/// to 9.1 sigma; attained next to the median, and measured by the tests.
pub const MAX_NORMAL_ERROR: f64 = 1.2e-9;

const SIGN: u64 = 1 << 63;
/// Bits of a double below the number of its cell: 52 of mantissa less seven.
const CELL_SHIFT: u32 = 45;
/// What the doubles of a cell have in common, and what makes the cell's centre of it.
const CELL_KEEP: u64 = !((1 << CELL_SHIFT) - 1);
const CELL_CENTRE: u64 = 1 << (CELL_SHIFT - 1);

/// The normal that a 64-bit draw stands for.
pub fn standard_normal(draw: u64) -> f64 {
    let signed = draw as i64 as f64;
    let y = signed.abs();
    let cell = (y.to_bits() >> CELL_SHIFT) as usize & (LEVELS.len() - 1);
    let t = y - f64::from_bits(y.to_bits() & CELL_KEEP | CELL_CENTRE);
    let (c0, c1) = (f64::from_bits(LEVELS[cell]), f64::from_bits(SLOPES[cell]));
    let c2 = f64::from_bits(SLOPES[cell] << (64 - C2_BITS));
    c2.mul_add(t, c1).mul_add(t, c0).copysign(signed)
}
