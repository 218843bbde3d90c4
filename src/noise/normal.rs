//! Normals by inversion: each normal is computed from 64 uniform bits.
//!
//! A draw is a uniform signed integer y, -2^63 <= y < 2^63. It represents sign(y) Z(|y|) with Z(y)
//! = erfc^{-1}(y 2^-63), which is a standard normal divided by sqrt(2). Each octave of |y| is
//! divided into 128 cells. Because Z'' = 2 Z Z'^2, the level A = Z and the slope b at the centre of
//! a cell give the parabola of Z about that centre,
//!
//! ```text
//! Z = A + s + A s^2,   s = b t,   t the distance from the centre down to |y|, in cells
//! ```
//!
//! A and b are packed into one 64-bit word (`tools/normal_table.py`). The number of the cell
//! consists of the sign, the exponent and the upper mantissa bits of y as a double, and t follows
//! from the lower bits. So there is no search, no special case for the tail, and no branch. The
//! normals reach from the median to 9.1 sigma, where |y| = 1. A cell of negative y has -A and -b.

use crate::lanes::{InstructionSet, KEY_SHIFT, Lanes, LookupTable};
use std::f64::consts::SQRT_2;
use std::sync::LazyLock;

/// The largest absolute error of [`standard_normal`] as an inverse of the normal distribution
/// function, anywhere from the median to 9.1 sigma. At the ends and extrema of all cells the error
/// is 4.9e-9 at most (`tools/normal_table.py` prints it). The parabola next to the median
/// contributes 2.4e-9, the last bit of the slope 1.3e-9, and in the tails the bits of the level
/// that hold the slope 2.7e-9. The normals of y and -y add up to at most 1e-9 instead of 0.
pub const MAX_NORMAL_ERROR: f64 = 5e-9;

/// Bits of a cell that hold its slope: 2^21 plus the slope in units of 2^-28.
const SLOPE_BITS: u32 = 22;

/// The cells of y = 1 to 2^63, as `tools/normal_table.py` writes them: each one's level, a double,
/// whose lowest bits hold the slope.
static CELLS: [u64; 8192] = words(include_bytes!("normal_table.bin"));

/// Little-endian words.
const fn words<const N: usize>(bytes: &[u8]) -> [u64; N] {
    assert!(bytes.len() == 8 * N);
    let mut words = [0; N];
    let mut i = 0;
    while i < 8 * N {
        words[i / 8] |= (bytes[i] as u64) << (8 * (i % 8));
        i += 1;
    }
    words
}

const SIGN: u64 = 1 << 63;
/// The mantissa bits of a double below those in the number of its cell (52 less seven bits); they
/// give the place in the cell.
const PLACE: u64 = (1 << KEY_SHIFT) - 1;
/// A double with these upper bits instead of its own is 128 plus its place in the cell, which runs
/// from 0 to 1.
const BEFORE_PLACE: f64 = 128.0;
const CENTRE: f64 = BEFORE_PLACE + 0.5;
const SLOPE: u64 = (1 << SLOPE_BITS) - 1;
/// Set before the bits of a slope, these bits make a double whose value is BEFORE_SLOPE plus 2^-7
/// plus the slope, where the bits of the slope count units of 2^-28.
const BEFORE_SLOPE: f64 = 16_777_216.0;
const NO_SLOPE: f64 = BEFORE_SLOPE + 0.007_812_5;

/// The cell of the double y.
fn cell(y: u64) -> u64 {
    let first = 1.0f64.to_bits() >> KEY_SHIFT;
    // y = 0, which occurs once in 2^64 draws, counts as 1.
    let cell = CELLS[((y & !SIGN) >> KEY_SHIFT).saturating_sub(first) as usize];
    if y & SIGN == 0 {
        cell
    } else {
        SIGN | cell & !SLOPE | (SLOPE + 1 - (cell & SLOPE))
    }
}

/// The cells of both signs, at the places where [`Lanes::lookup`] finds them. Only the 132 KiB
/// around them, of 4 MiB, are ever touched.
pub fn cells() -> &'static LookupTable {
    static TABLE: LazyLock<Box<LookupTable>> = LazyLock::new(|| {
        let mut table = vec![0; size_of::<LookupTable>() / size_of::<u64>()];
        for y in (0..64).flat_map(|octave| {
            (0..128).map(move |i| (1.0 + f64::from(i) / 128.0) * 2f64.powi(octave))
        }) {
            for y in [y.to_bits(), (-y).to_bits()] {
                table[(y >> KEY_SHIFT) as usize] = cell(y);
            }
        }
        table[0] = cell(0);
        let table: Box<LookupTable> = table
            .into_boxed_slice()
            .try_into()
            .expect("as long as a table");
        InstructionSet::choose_lookup(&table);
        table
    });
    &TABLE
}

/// The standard normal that a 64-bit draw represents.
#[inline(always)]
pub fn standard_normal(draw: u64) -> f64 {
    let y = (draw as i64 as f64).to_bits();
    let cell = cell(y);
    let (level, slope) = (
        f64::from_bits(cell),
        f64::from_bits(cell & SLOPE | BEFORE_SLOPE.to_bits()) - NO_SLOPE,
    );
    let s = slope * (CENTRE - f64::from_bits(y & PLACE | BEFORE_PLACE.to_bits()));
    SQRT_2 * level.mul_add(s.mul_add(s, 1.0), s)
}

/// The normals of variance 1/2 that draws represent, lane by lane: the same as [`standard_normal`]
/// before its factor sqrt(2), with the same bits. `cells` is the table of [`cells`].
#[inline(always)]
pub(super) fn half_normals<L: Lanes>(cells: &LookupTable, draws: L::Bits) -> L {
    let y = L::from_integers(draws).to_bits();
    let cell = L::lookup(cells, y);
    let slope =
        L::from_bits(L::keep_and_set(cell, SLOPE, BEFORE_SLOPE.to_bits())).sub(L::splat(NO_SLOPE));
    let place = L::from_bits(L::keep_and_set(y, PLACE, BEFORE_PLACE.to_bits()));
    let s = slope.mul(L::splat(CENTRE).sub(place));
    L::from_bits(cell).mul_add(s.mul_add(s, L::splat(1.0)), s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_2_SQRT_PI;

    /// Integers y and their normals z, as `tools/normal_table.py` prints them from arithmetic with
    /// 40 digits.
    const REFERENCE: [(u64, f64); 20] = [
        (1, 9.080155124873613),
        (2, 9.004403971492415),
        (3, 8.959802436136014),
        (5, 8.903300606801247),
        (101, 8.563486791507703),
        (525, 8.371435315949821),
        (11223, 8.002740692293417),
        (179569, 7.654087887351245),
        (2873098, 7.2893292658711895),
        (45969572, 6.906030434943307),
        (735513149, 6.501081719022373),
        (11768210391, 6.070401074967691),
        (188291366257, 5.608450635130753),
        (3012661860106, 5.107393285708956),
        (48202589761700, 4.55549904720653),
        (771241436187198, 3.93378620947677),
        (12339862978995160, 3.2077256427098657),
        (197437807663922560, 2.300741444339711),
        (3159004922622760960, 0.9492371715748953),
        (9223372036854773760, 2.782916424671767e-16),
    ];

    /// What to add to z for the normal of y: one step of Newton's method for erfc(z/sqrt(2)) =
    /// y 2^-63, which squares the error. Libm's erfc is right to the last bit or two.
    fn correction(y: u64, z: f64) -> f64 {
        let x = z / SQRT_2;
        let slope = -FRAC_2_SQRT_PI * (-x * x).exp();
        SQRT_2 * (y as f64 * 2f64.powi(-63) - libm::erfc(x)) / slope
    }

    #[test]
    fn newtons_method_finds_the_reference() {
        for (y, z) in REFERENCE {
            for off in [-1e-9, 0.0, 1e-9] {
                let found = z + off + correction(y, z + off);
                assert!((found - z).abs() < 2e-15, "{y}: {found}, not {z}");
            }
        }
    }

    /// `tools/normal_table.py` prints this checksum (FNV-1a) of the table that it writes. Any other
    /// table would change every path of every run.
    #[test]
    fn the_table_is_the_one_that_the_script_writes() {
        let step = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        let sum = include_bytes!("normal_table.bin")
            .iter()
            .fold(0xcbf2_9ce4_8422_2325, step);
        assert_eq!(sum, 0x17e1_6d59_852c_8d35, "{sum:#x}");
    }

    /// At all y up to 1024, and beyond at eight places in each cell.
    #[test]
    fn the_inverse_is_within_its_stated_error_everywhere() {
        let mut worst = [0.0f64; 64];
        let beyond = (10..63).flat_map(|octave| {
            (0..1024u64).map(move |eighth| (1 << octave) + (eighth << (octave - 10)) + 1)
        });
        for y in (1..=1024).chain(beyond) {
            let z = standard_normal(y);
            let octave = y.ilog2() as usize;
            worst[octave] = worst[octave].max(correction(y, z).abs());
            let asymmetry = (standard_normal(y.wrapping_neg()) + z).abs();
            assert!(asymmetry < 1e-9, "{y}: {asymmetry:e}");
        }
        for (octave, error) in worst.iter().enumerate() {
            assert!(*error <= MAX_NORMAL_ERROR, "octave {octave}: {error:e}");
        }
        let greatest = worst.iter().fold(0.0f64, |a, &b| a.max(b));
        assert!(
            greatest > MAX_NORMAL_ERROR / 2.0,
            "the stated error {MAX_NORMAL_ERROR:e} is idle: {greatest:e}"
        );
    }

    #[test]
    fn the_ends_are_nine_sigma_and_the_median() {
        for (y, z) in REFERENCE {
            assert!((standard_normal(y) - z).abs() < MAX_NORMAL_ERROR, "{y}");
        }
        assert!((standard_normal(u64::MAX) + 9.080_155_124_873_613).abs() < MAX_NORMAL_ERROR);
        // The largest |y| is rounded to 2^63, which is the median itself.
        assert!(standard_normal(i64::MAX as u64).abs() < f64::MIN_POSITIVE);
        assert!(standard_normal(i64::MAX as u64 - 2048).abs() < MAX_NORMAL_ERROR);
    }

    #[test]
    fn cells_join() {
        for border in (9..63).flat_map(|o| (0..128).map(move |i| (1u64 << o) + (i << (o - 7)))) {
            let (below, above) = (
                standard_normal((border - 2) | 1),
                standard_normal(border | 1),
            );
            // Two steps of y move z by at most 4 / (y z'), z' > 0.6 sqrt(z).
            let slope = 8.0 / border as f64;
            assert!(
                (below - above).abs() < 2.0 * MAX_NORMAL_ERROR + slope,
                "{border}: {below} {above}"
            );
        }
    }
}
