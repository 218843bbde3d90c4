//! The random numbers of a step, from normals as accurate as those of the crate to sums of four
//! bytes.

use crate::prototype::{LANES, RUN, Real, Row};
use std::array::from_fn;
use std::sync::LazyLock;
use stick_slip::lanes::InstructionSet;
use stick_slip::noise::{LaneStreams, Stream, standard_normal};

/// A source of numbers xi of mean 0 and variance 1, for `RUN` steps at a time.
pub trait Kicks<F> {
    fn new(seed: u64, paths: &[u64]) -> Self;
    fn fill(&mut self, tile: &mut [Row<F>; RUN]);
}

/// The normals of the crate, with an error of at most [`stick_slip::noise::MAX_NORMAL_ERROR`].
pub struct Own(LaneStreams);

impl<F: Real> Kicks<F> for Own {
    fn new(seed: u64, paths: &[u64]) -> Self {
        Own(LaneStreams::new(seed, paths, LANES))
    }
    #[inline(always)]
    fn fill(&mut self, tile: &mut [Row<F>; RUN]) {
        let normals = self.0.normals(RUN, InstructionSet::detect());
        for (row, normals) in tile.iter_mut().zip(normals.chunks_exact(LANES)) {
            for (xi, normal) in row.0.iter_mut().zip(normals) {
                *xi = F::of(*normal);
            }
        }
    }
}

/// One xoshiro128+ generator for each lane.
#[repr(align(64))]
struct Words([[u32; LANES]; 4]);

impl Words {
    fn new(seed: u64, paths: &[u64]) -> Self {
        let states: [_; LANES] = from_fn(|i| Stream::new(seed, paths[i]).state());
        Words(from_fn(|word| from_fn(|i| (states[i][word] >> 32) as u32)))
    }
    #[inline(always)]
    fn next(&mut self) -> [u32; LANES] {
        let mut drawn = [0; LANES];
        let [a, b, c, d] = &mut self.0;
        for i in 0..LANES {
            drawn[i] = a[i].wrapping_add(d[i]);
            let t = b[i] << 9;
            let d_b = d[i] ^ b[i];
            let c_a = c[i] ^ a[i];
            b[i] ^= c_a;
            a[i] ^= d_b;
            c[i] = c_a ^ t;
            d[i] = d_b.rotate_left(11);
        }
        drawn
    }
}

/// Normals by inversion in single precision: [`standard_normal`] is approximated by straight lines
/// in 64 cells of each octave. It takes 32 bits and reaches 6.2 sigma.
pub struct Inverse(Words);

/// Middle and slope of each cell. The index of a cell consists of the exponent and the upper
/// mantissa bits of y as an `f32`, 1 <= y <= 2^31.
static LINES: LazyLock<[[f32; 2048]; 2]> = LazyLock::new(|| {
    let mut lines = [[0.0; 2048]; 2];
    for upper in 127u32 << 6..158 << 6 {
        let y = |upper: u32| f64::from(f32::from_bits(upper << 17));
        let z = |y: f64| standard_normal(((y * 4_294_967_296.0) as u64).min(i64::MAX as u64));
        let (near, far) = (z(y(upper + 1)), z(y(upper)));
        let middle = z(0.5 * (y(upper) + y(upper + 1)));
        lines[0][upper as usize % 2048] = (0.5 * middle + 0.25 * (near + far)) as f32;
        lines[1][upper as usize % 2048] = (near - far) as f32;
    }
    lines
});

impl Kicks<f32> for Inverse {
    fn new(seed: u64, paths: &[u64]) -> Self {
        Inverse(Words::new(seed, paths))
    }
    #[inline(always)]
    fn fill(&mut self, tile: &mut [Row<f32>; RUN]) {
        let [level, slope] = &*LINES;
        for row in tile {
            for (xi, drawn) in row.0.iter_mut().zip(self.0.next()) {
                let y = (drawn as i32 as f32).to_bits();
                let cell = (y >> 17) as usize % 2048;
                let place = f32::from_bits(y & 0x1_ffff | 64f32.to_bits()) - 64.5;
                let z = slope[cell].mul_add(place, level[cell]);
                *xi = f32::from_bits(z.to_bits() ^ y & 1 << 31);
            }
        }
    }
}

/// Sums of four bytes. They have three moments of a normal, an excess kurtosis of -0.3, and no
/// values beyond 3.5 sigma.
pub struct Bytes(Words);

impl<F: Real> Kicks<F> for Bytes {
    fn new(seed: u64, paths: &[u64]) -> Self {
        Bytes(Words::new(seed, paths))
    }
    #[inline(always)]
    fn fill(&mut self, tile: &mut [Row<F>; RUN]) {
        let per_sd = F::of(1.0 / (4.0 * 65535.0 / 12.0f64).sqrt());
        for row in tile {
            for (xi, drawn) in row.0.iter_mut().zip(self.0.next()) {
                let pairs = (drawn & 0x00ff_00ff) + (drawn >> 8 & 0x00ff_00ff);
                *xi = F::from(((pairs & 0xffff) + (pairs >> 16)) as i16 - 510) * per_sd;
            }
        }
    }
}
