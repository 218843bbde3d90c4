//! The discrete Fourier transform of several columns at a time, one in each lane, so that its bits
//! are the same on every processor.
//!
//! ```text
//! Z_j = sum_n z_n e^{-2 pi i j n/N},   N a power of two
//! ```
//!
//! by decimation in time (J. W. Cooley and J. W. Tukey, *An algorithm for the machine calculation
//! of complex Fourier series*, Mathematics of Computation 19 (1965)).

use crate::lanes::{InstructionSet, LaneProgram, Lanes, ROW};

/// Columns that are transformed together.
pub(crate) const COLUMNS: usize = ROW;

/// One number of each column.
pub(crate) type Numbers = [f64; COLUMNS];

/// A transform of a given length.
#[derive(Clone, Debug)]
pub(crate) struct Fourier {
    /// cos and -sin of 2 pi k/N, k < N/2.
    turns: Vec<[f64; 2]>,
    instructions: InstructionSet,
}

impl Fourier {
    /// A transform of this length, which is a power of two, at least 2.
    pub fn new(length: usize) -> Self {
        assert!(
            length.is_power_of_two() && length > 1,
            "{length} is not a power of two"
        );
        let turn = |k: usize| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / length as f64);
            [cos, -sin]
        };
        Fourier {
            turns: (0..length / 2).map(turn).collect(),
            instructions: InstructionSet::detect(),
        }
    }

    /// Transforms columns of complex numbers, given by their real and imaginary parts, in place.
    pub fn transform(&self, real: &mut [Numbers], imaginary: &mut [Numbers]) {
        let length = 2 * self.turns.len();
        assert!(
            real.len() == length && imaginary.len() == length,
            "columns of another length"
        );
        let shift = usize::BITS - length.trailing_zeros();
        for i in 0..length {
            let j = i.reverse_bits() >> shift;
            if i < j {
                real.swap(i, j);
                imaginary.swap(i, j);
            }
        }
        self.instructions.run(&mut Butterflies {
            turns: &self.turns,
            real,
            imaginary,
        });
    }
}

struct Butterflies<'a> {
    turns: &'a [[f64; 2]],
    real: &'a mut [Numbers],
    imaginary: &'a mut [Numbers],
}

impl LaneProgram for Butterflies<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let length = self.real.len();
        let mut half = 1;
        while half < length {
            let stride = length / (2 * half);
            for start in (0..length).step_by(2 * half) {
                for k in 0..half {
                    let [cos, sin] = self.turns[k * stride];
                    let (a, b) = (start + k, start + k + half);
                    for lane in (0..COLUMNS).step_by(L::WIDTH) {
                        let at = |of: &[Numbers], i: usize| L::load(&of[i][lane..]);
                        let (re, im) = (at(self.real, b), at(self.imaginary, b));
                        let (cos, sin) = (L::splat(cos), L::splat(sin));
                        let turned = (re * cos - im * sin, re * sin + im * cos);
                        let (re, im) = (at(self.real, a), at(self.imaginary, a));
                        (re + turned.0).store(&mut self.real[a][lane..]);
                        (im + turned.1).store(&mut self.imaginary[a][lane..]);
                        (re - turned.0).store(&mut self.real[b][lane..]);
                        (im - turned.1).store(&mut self.imaginary[b][lane..]);
                    }
                }
            }
            half *= 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::SeedableRng;

    /// The sum is computed term by term for every column. Rounding leaves some 1e-15 of the root of
    /// the length.
    #[test]
    fn the_transform_is_the_sum_of_its_definition() {
        let mut rng = Pcg64Dxsm::seed_from_u64(1965);
        for length in [2, 8, 64] {
            let mut fourier = Fourier::new(length);
            let mut draw = || -> Vec<Numbers> {
                (0..length)
                    .map(|_| std::array::from_fn(|_| StandardNormal.sample(&mut rng)))
                    .collect()
            };
            let (re, im) = (draw(), draw());
            let transforms = InstructionSet::ALL
                .into_iter()
                .filter(|set| set.is_available())
                .map(|set| {
                    fourier.instructions = set;
                    let (mut real, mut imaginary) = (re.clone(), im.clone());
                    fourier.transform(&mut real, &mut imaginary);
                    (real, imaginary)
                });
            let transforms: Vec<_> = transforms.collect();
            assert!(transforms.windows(2).all(|pair| pair[0] == pair[1]));
            let (real, imaginary) = &transforms[0];
            for (j, column) in (0..length).flat_map(|j| (0..COLUMNS).map(move |column| (j, column)))
            {
                let (mut x, mut y) = (0.0, 0.0);
                for n in 0..length {
                    let angle = -std::f64::consts::TAU * (j * n % length) as f64 / length as f64;
                    let (sin, cos) = angle.sin_cos();
                    x += re[n][column] * cos - im[n][column] * sin;
                    y += re[n][column] * sin + im[n][column] * cos;
                }
                assert!(
                    (real[j][column] - x).abs() < 1e-13 && (imaginary[j][column] - y).abs() < 1e-13
                );
            }
        }
    }
}
