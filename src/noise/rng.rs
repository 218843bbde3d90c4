//! Normals and uniform numbers from the words of a path, and these words as generators of
//! `rand_core`, for drawing from any distribution of `rand_distr`.
//!
//! A generator gives the bare words: a mirror image has the same ones. Only the normals of this
//! library have the opposite sign there.

use super::{AddressedDraws, Stream, standard_normal};
use rand_core::TryRng;
use std::convert::Infallible;

/// The numbers that are made from the words of this type's `next_u64`, and a generator of these
/// words.
macro_rules! generator {
    ($name:ty) => {
        impl $name {
            /// The next standard normal.
            #[inline(always)]
            pub fn normal(&mut self) -> f64 {
                standard_normal(self.next_u64() ^ self.flip)
            }

            /// The next two standard normals, made from one draw: the first from the draw, the
            /// second from the draw with its two halves exchanged. The upper halves, which
            /// determine a normal to one part in 2^32, have no bit in common. The lower halves
            /// matter alone only beyond 6.2 sigma.
            #[inline(always)]
            pub fn normal_pair(&mut self) -> [f64; 2] {
                let draw = self.next_u64() ^ self.flip;
                // This does not use `map`, which is not compiled for the instruction set of the
                // caller.
                [standard_normal(draw), standard_normal(draw.rotate_left(32))]
            }

            /// A uniform number in (0, 1): the midpoint of one of 2^53 cells.
            #[inline(always)]
            pub fn uniform(&mut self) -> f64 {
                ((self.next_u64() >> 11) as f64 + 0.5) * (1.0 / 9_007_199_254_740_992.0)
            }
        }

        impl TryRng for $name {
            type Error = Infallible;

            /// The upper half of a word, which is the better half of a word of xoshiro256+.
            fn try_next_u32(&mut self) -> Result<u32, Infallible> {
                Ok((self.next_u64() >> 32) as u32)
            }

            fn try_next_u64(&mut self) -> Result<u64, Infallible> {
                Ok(self.next_u64())
            }

            fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
                rand_core::utils::fill_bytes_via_next_word(bytes, || self.try_next_u64())
            }
        }
    };
}

generator!(Stream);
generator!(AddressedDraws);

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution as _, StandardNormal};

    /// The mean of exp(-|z|) over normals z of `rand_distr` is exp(1/2) erfc(1/sqrt 2) = 0.523157;
    /// that of its square is exp(2) erfc(sqrt 2). Null: the words are uniform. n = 40 000, bound of
    /// 4 standard errors: false alarm 6e-5 for each generator.
    #[test]
    fn laws_of_rand_distr_are_drawn_from_the_words_of_a_path() {
        fn mean(rng: &mut impl rand_core::Rng) -> f64 {
            let mut one = || -> f64 { StandardNormal.sample(rng) };
            (0..40_000).map(|_| (-one().abs()).exp()).sum::<f64>() / 40_000.0
        }
        let bound =
            4.0 * ((2f64.exp() * libm::erfc(2f64.sqrt()) - 0.523_157f64.powi(2)) / 40_000.0).sqrt();
        for found in [
            mean(&mut Stream::new(5, 3)),
            mean(&mut AddressedDraws::auxiliary(5, 3)),
        ] {
            assert!((found - 0.523_157).abs() < bound, "{found} +- {bound}");
        }
    }

    #[test]
    fn bytes_are_those_of_the_words() {
        let [mut one, mut other, mut mirrored] =
            [7, 7, 7 | crate::noise::MIRROR].map(|path| AddressedDraws::new(1, path));
        let mut bytes = [0; 12];
        rand_core::Rng::fill_bytes(&mut one, &mut bytes);
        assert_eq!(bytes[..8], other.next_u64().to_le_bytes());
        assert_eq!(bytes[8..], other.next_u64().to_le_bytes()[..4]);
        assert_eq!(mirrored.next_u64().to_le_bytes(), bytes[..8]);
    }
}
