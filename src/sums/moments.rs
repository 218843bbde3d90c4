//! Moments that can be merged: of one number, of several numbers jointly, and up to the fourth
//! order.
//!
//! A block of paths is folded in two passes (first the mean, then the deviations from it). Blocks
//! are merged by the pairwise formula of Chan, Golub and LeVeque, *Algorithms for computing the
//! sample variance: analysis and recommendations*, The American Statistician 37 (1983). With delta
//! = mean_b - mean_a and n = n_a + n_b,
//!
//! ```text
//! mean = mean_a + delta n_b / n
//! M_2  = M_2a + M_2b + delta^2 n_a n_b / n
//! ```
//!
//! Neither step subtracts large squares, so that a spread far smaller than the mean is preserved.
//! The spread of equal numbers is exactly zero.

use super::codec::codec_of_fields;
use super::interval::ErrorLaw;
use super::merge::Merge;
use crate::lanes::{InstructionSet, LaneProgram, Lanes};

/// Terms are added in this many interleaved partial sums, in a fixed order that compilers can
/// vectorise.
const LANES: usize = 8;

/// Where terms cancel, a rest below this share of their sizes is rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Sum of `term` over the entries of `values`, in an order that depends only on their number.
#[inline(always)]
fn sum(values: &[f64], term: impl Fn(f64) -> f64) -> f64 {
    let mut partial = [0.0; LANES];
    let (chunks, rest) = values.as_chunks::<LANES>();
    for chunk in chunks {
        for (p, &v) in partial.iter_mut().zip(chunk) {
            *p += term(v);
        }
    }
    for (p, &v) in partial.iter_mut().zip(rest) {
        *p += term(v);
    }
    partial.iter().sum()
}

/// The sum of (a - mean of a)(b - mean of b), in the same order.
fn sum_of_products(a: &[f64], mean_a: f64, b: &[f64], mean_b: f64) -> f64 {
    let products: Vec<f64> = a
        .iter()
        .zip(b)
        .map(|(a, b)| (a - mean_a) * (b - mean_b))
        .collect();
    sum(&products, |product| product)
}

/// The mean, computed relative to the first entry, so that it is exact if all entries are equal.
#[inline(always)]
fn mean(values: &[f64]) -> f64 {
    match values.first() {
        Some(&first) => first + sum(values, |v| v - first) / values.len() as f64,
        None => 0.0,
    }
}

/// Number, mean and spread of the values of one quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Number of values.
    pub count: u64,
    /// Their mean; 0 if there are none.
    pub mean: f64,
    /// M_2: sum of squared deviations from the mean.
    pub m2: f64,
}

codec_of_fields!(Moments { count, mean, m2 });

impl Merge for Moments {
    fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *other;
            return;
        }
        let (n_a, n_b) = (self.count as f64, other.count as f64);
        let (n, delta) = (n_a + n_b, other.mean - self.mean);
        self.mean += delta * (n_b / n);
        self.m2 += other.m2 + delta * delta * (n_a * n_b / n);
        self.count += other.count;
    }
}

impl Moments {
    /// The moments of these values.
    pub fn of(values: &[f64]) -> Self {
        let mut fold = MomentsOf(values, Moments::default());
        InstructionSet::detect().run(&mut fold);
        fold.1
    }

    /// The mean; NaN if there are no values.
    pub fn mean(&self) -> f64 {
        if self.count == 0 { f64::NAN } else { self.mean }
    }

    /// Unbiased variance; NaN for fewer than two values.
    pub fn variance(&self) -> f64 {
        if self.count < 2 {
            f64::NAN
        } else {
            self.m2 / (self.count - 1) as f64
        }
    }
}

/// The lane program of [`Moments::of`].
struct MomentsOf<'a>(&'a [f64], Moments);

impl LaneProgram for MomentsOf<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let (values, mean) = (self.0, mean(self.0));
        self.1 = Moments {
            count: values.len() as u64,
            mean,
            m2: sum(values, |v| (v - mean) * (v - mean)),
        };
    }
}

/// Means and co-moments of N numbers that belong to the same path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointMoments<const N: usize> {
    /// Number of paths.
    pub count: u64,
    /// Mean of each number.
    pub mean: [f64; N],
    /// Sum over paths of (z_i - mean_i)(z_j - mean_j), for i <= j.
    comoment: [[f64; N]; N],
}

impl<const N: usize> Default for JointMoments<N> {
    fn default() -> Self {
        JointMoments {
            count: 0,
            mean: [0.0; N],
            comoment: [[0.0; N]; N],
        }
    }
}

codec_of_fields!(JointMoments<N> { count, mean, comoment }, N);

impl<const N: usize> Merge for JointMoments<N> {
    fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *other;
            return;
        }
        let (n_a, n_b) = (self.count as f64, other.count as f64);
        let n = n_a + n_b;
        let delta: [f64; N] = std::array::from_fn(|i| other.mean[i] - self.mean[i]);
        for i in 0..N {
            for j in i..N {
                self.comoment[i][j] += other.comoment[i][j] + delta[i] * delta[j] * (n_a * n_b / n);
            }
            self.mean[i] += delta[i] * (n_b / n);
        }
        self.count += other.count;
    }
}

impl<const N: usize> JointMoments<N> {
    /// The moments of N columns with one entry per path.
    pub fn of(columns: [&[f64]; N]) -> Self {
        let mean = columns.map(mean);
        let mut comoment = [[0.0; N]; N];
        for i in 0..N {
            for j in i..N {
                comoment[i][j] = sum_of_products(columns[i], mean[i], columns[j], mean[j]);
            }
        }
        JointMoments {
            count: columns.first().map_or(0, |c| c.len() as u64),
            mean,
            comoment,
        }
    }

    /// Sum over paths of (g . (z - mean))^2: the spread of the linear combination of the N numbers
    /// with coefficients g.
    pub fn spread_along(&self, gradient: [f64; N]) -> f64 {
        let (mut total, mut size) = (0.0, 0.0);
        let mut add = |term: f64| {
            total += term;
            size += term.abs();
        };
        // Terms with a coefficient of zero are left out, so that an unused moment may overflow.
        for i in (0..N).filter(|&i| gradient[i] != 0.0) {
            add(gradient[i] * gradient[i] * self.comoment[i][i]);
            for j in (i + 1..N).filter(|&j| gradient[j] != 0.0) {
                add(2.0 * gradient[i] * gradient[j] * self.comoment[i][j]);
            }
        }
        // For a perfectly correlated combination only rounding remains. NaN stays NaN.
        if total < ROUNDING * size { 0.0 } else { total }
    }
}

/// Moments of one quantity up to the fourth order.
///
/// The merge formulas of M_3 and M_4 are those of P. Pebay, *Formulas for robust, one-pass parallel
/// computation of covariances and arbitrary-order statistical moments*, Sandia report SAND2008-6212
/// (2008).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FourMoments {
    /// Number, mean and M_2.
    pub two: Moments,
    m3: f64,
    m4: f64,
}

codec_of_fields!(FourMoments { two, m3, m4 });

impl Merge for FourMoments {
    fn merge(&mut self, other: &Self) {
        if other.two.count == 0 {
            return;
        }
        if self.two.count == 0 {
            *self = *other;
            return;
        }
        let (n_a, n_b) = (self.two.count as f64, other.two.count as f64);
        let (n, delta) = (n_a + n_b, other.two.mean - self.two.mean);
        let (a, b) = (n_a / n, n_b / n);
        let (m2_a, m2_b, m3_a, m3_b) = (self.two.m2, other.two.m2, self.m3, other.m3);
        self.m4 += other.m4
            + delta.powi(4) * n_a * b * (a * a - a * b + b * b)
            + 6.0 * delta * delta * (a * a * m2_b + b * b * m2_a)
            + 4.0 * delta * (a * m3_b - b * m3_a);
        self.m3 += m3_b + delta.powi(3) * n_a * b * (a - b) + 3.0 * delta * (a * m2_b - b * m2_a);
        self.two.merge(&other.two);
    }
}

impl FourMoments {
    /// The moments of these values.
    pub fn of(values: &[f64]) -> Self {
        let two = Moments::of(values);
        let (m3, m4) = (
            sum(values, |v| (v - two.mean) * (v - two.mean) * (v - two.mean)),
            sum(values, |v| {
                ((v - two.mean) * (v - two.mean)) * ((v - two.mean) * (v - two.mean))
            }),
        );
        FourMoments { two, m3, m4 }
    }

    /// The law of the error of the mean.
    pub fn error_law(&self) -> ErrorLaw {
        ErrorLaw::of([self.two.m2, self.m3, self.m4], self.two.count)
    }

    /// Sum over values of ((v - mean)^2 - M_2/n)^2: the spread of the squared deviations.
    pub fn spread_of_squares(&self) -> f64 {
        let spread = self.m4 - self.two.m2 * (self.two.m2 / self.two.count as f64);
        if spread < 0.0 { 0.0 } else { spread }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The central moment by its definition.
    fn central(values: &[f64], power: i32) -> f64 {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|v| (v - mean).powi(power)).sum()
    }

    /// Rounding: each of about 100 terms is known to 1e-16 of the largest, so 1e-12 leaves a factor
    /// of 100.
    fn close(a: f64, b: f64, scale: f64) -> bool {
        (a - b).abs() <= 1e-12 * scale
    }

    proptest! {
        #[test]
        fn merging_two_parts_gives_the_moments_of_the_whole(
            values in prop::collection::vec(-5.0..20.0f64, 2..100),
            cut in 0.0..1.0f64,
        ) {
            let cut = (cut * values.len() as f64) as usize;
            let mut merged = FourMoments::of(&values[..cut]);
            merged.merge(&FourMoments::of(&values[cut..]));
            let n = values.len() as f64;
            prop_assert_eq!(merged.two.count, values.len() as u64);
            prop_assert!(close(merged.two.mean, values.iter().sum::<f64>() / n, 20.0));
            prop_assert!(close(merged.two.m2, central(&values, 2), n * 25f64.powi(2)));
            prop_assert!(close(merged.m3, central(&values, 3), n * 25f64.powi(3)));
            prop_assert!(close(merged.m4, central(&values, 4), n * 25f64.powi(4)));
        }

        #[test]
        fn spread_along_a_direction_is_that_of_the_combination(
            rows in prop::collection::vec(prop::array::uniform3(-1.0..3.0f64), 2..80),
            cut in 0.0..1.0f64,
            g in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let column = |i: usize| rows.iter().map(|r| r[i]).collect::<Vec<_>>();
            let (a, b, c) = (column(0), column(1), column(2));
            let cut = (cut * rows.len() as f64) as usize;
            let mut merged = JointMoments::of([&a[..cut], &b[..cut], &c[..cut]]);
            merged.merge(&JointMoments::of([&a[cut..], &b[cut..], &c[cut..]]));
            let combined: Vec<f64> = rows.iter().map(|r| g[0] * r[0] + g[1] * r[1] + g[2] * r[2]).collect();
            prop_assert!(close(merged.spread_along(g), central(&combined, 2), 12.0 * 12.0 * rows.len() as f64));
        }
    }

    /// Each path has a number of things, and each thing has the size 0.4, so that only the number
    /// varies.
    #[test]
    fn a_ratio_that_all_paths_share_has_no_spread() {
        let mut merged = JointMoments::<2>::default();
        for block in 0..30 {
            let number: Vec<f64> = (0..256)
                .map(|i| f64::from((i * 37 + block * 11) % 23 + 1))
                .collect();
            let size: Vec<f64> = number.iter().map(|n| 0.4 * n).collect();
            merged.merge(&JointMoments::of([&size, &number]));
            assert_eq!(
                merged.spread_along([1.0, -merged.mean[0] / merged.mean[1]]),
                0.0,
                "{block}"
            );
        }
    }

    #[test]
    fn merging_with_nothing_changes_nothing() {
        let some = FourMoments::of(&[1.0, 4.0, -2.0]);
        let (mut left, mut right) = (FourMoments::default(), some);
        left.merge(&some);
        right.merge(&FourMoments::default());
        assert_eq!(left, some);
        assert_eq!(right, some);
    }

    #[test]
    fn a_spread_of_one_on_a_mean_of_1e12_is_kept() {
        // There are 600 values 1e12 +- 1 in blocks of 100. The variance is 600/599; sums of squares
        // would be off by 1e8.
        let values: Vec<f64> = (0..600)
            .map(|i| 1e12 + if i % 2 == 0 { 1.0 } else { -1.0 })
            .collect();
        let mut merged = Moments::default();
        values
            .chunks(100)
            .for_each(|block| merged.merge(&Moments::of(block)));
        assert_eq!(merged.mean, 1e12);
        assert_eq!(merged.variance(), 600.0 / 599.0);
    }

    #[test]
    fn equal_values_have_no_spread_at_all() {
        // 0.1 has no finite binary expansion, so that a plain sum of 256 such numbers would be
        // wrong in the last digits.
        let mut merged = FourMoments::default();
        for n in [256, 3, 77] {
            merged.merge(&FourMoments::of(&vec![0.1; n]));
        }
        assert_eq!(
            (merged.two.mean, merged.two.m2, merged.spread_of_squares()),
            (0.1, 0.0, 0.0)
        );
    }
}
