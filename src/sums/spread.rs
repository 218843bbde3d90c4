//! Standard deviations, and the precision of their own errors.
//!
//! The error of a standard deviation comes from the variance of the influences e_i of single paths
//! on it ([`super::interval`]). That variance is itself known only to a relative sqrt((k - 1)/m),
//! where k = m sum e^4/(sum e^2)^2 is the kurtosis of the influences of m paths. For a law with
//! long tails k may be in the hundreds. The error has as many degrees of freedom as a chi square
//! with the same relative scatter,
//!
//! ```text
//! 2/freedom = sum e^4/(sum e^2)^2 - 1/m
//! ```
//!
//! (F. E. Satterthwaite, *An approximate distribution of estimates of variance components*,
//! Biometrics Bulletin 2 (1946)), but no more than m - 1. This is a correction of second order, so
//! that influences may be taken about the mean of each block.

use super::codec::sums;
use super::interval::{ErrorLaw, Measured};
use super::moments::FourMoments;
use super::replicate::Replicate;

sums! {
    /// Sums over paths of the powers of their influences on a standard deviation.
    /// The unit of the influences does not matter, as long as it is the same for all.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub(crate) struct Tails {
        squares: f64,
        cubes: f64,
        fourths: f64,
    }
}

impl Tails {
    /// The sums over the influences of the paths of a block.
    pub fn of(influences: impl Iterator<Item = f64>) -> Self {
        let mut tails = Tails::default();
        influences.for_each(|e| tails.add(e, 1.0));
        tails
    }

    /// Add `paths` paths with the same influence.
    pub fn add(&mut self, influence: f64, paths: f64) {
        let square = influence * influence;
        self.squares += paths * square;
        self.cubes += paths * square * influence;
        self.fourths += paths * square * square;
    }

    /// The sum of the squares of all influences.
    pub fn squares(&self) -> f64 {
        self.squares
    }

    /// The law of the error that comes from this many paths.
    pub fn error_law(&self, paths: u64) -> ErrorLaw {
        ErrorLaw::of([self.squares, self.cubes, self.fourths], paths)
    }
}

sums! {
    /// Moments of one quantity over paths, for its mean and its standard deviation.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub(crate) struct SpreadMoments {
        pub four: FourMoments,
        /// Moments of the means of units.
        pub units: FourMoments,
        /// Powers of the influences of units on the variance.
        tails: Tails,
    }
}

impl SpreadMoments {
    /// The moments of the values of a block.
    pub fn of(values: &[f64], unit: Replicate) -> Self {
        let four = FourMoments::of(values);
        let (mean, square) = (four.two.mean, four.two.m2 / values.len() as f64);
        let units = if unit == Replicate::Path {
            four
        } else {
            FourMoments::of(&unit.means(values))
        };
        let influences: Vec<f64> = values
            .iter()
            .map(|v| (v - mean) * (v - mean) - square)
            .collect();
        SpreadMoments {
            four,
            units,
            tails: Tails::of(unit.means(&influences).iter().copied()),
        }
    }

    /// The standard deviation over paths, with e_i = ((x_i - mean)^2 - M_2/n) n/(n - 1) / (2 sd). The
    /// influences of pairs are taken about the means of their blocks.
    pub fn standard_deviation(&self) -> Measured {
        let n = self.units.two.count;
        let sd = self.four.two.variance().sqrt();
        let is_of_paths = n == self.four.two.count;
        let spread = if is_of_paths {
            self.four.spread_of_squares()
        } else {
            self.tails.squares()
        };
        let freedom = n.saturating_sub(1);
        // This case is explicit because the bits of 0/0 differ between processors.
        let error = match freedom {
            0 => f64::NAN,
            _ if sd == 0.0 => 0.0,
            _ => {
                (spread / (n as f64 * freedom as f64)).sqrt() * n as f64
                    / (freedom as f64 * 2.0 * sd)
            }
        };
        Measured::spread(sd, error, self.tails.error_law(n), n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::Merge as _;
    use crate::sums::coverage::Coverage;
    use rand_distr::{Distribution, Exp1, Normal, StandardNormal};
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::SeedableRng;

    #[test]
    fn the_error_of_a_standard_deviation_is_that_of_the_normal_law() {
        // For n normal numbers the error is sd/sqrt(2n) (1 + O(1/n)). It is computed from the
        // fourth moment. The relative error of m_4 - m_2^2 is sqrt(96/n)/2, hence that of the
        // result is 0.8 % at n = 100 000, and four times that is allowed.
        let mut rng = Pcg64Dxsm::seed_from_u64(4);
        let normal = Normal::new(-7.0, 3.0).unwrap();
        let mut moments = SpreadMoments::default();
        for _ in 0..100 {
            let block: Vec<f64> = (0..1000).map(|_| normal.sample(&mut rng)).collect();
            moments.merge(&SpreadMoments::of(&block, Replicate::Path));
        }
        let sd = moments.standard_deviation().measurement();
        let expected = 3.0 / 200_000f64.sqrt();
        assert!((sd.estimate - 3.0).abs() < 4.0 * expected);
        assert!(
            (sd.standard_error / expected - 1.0).abs() < 0.032,
            "{sd:?} {expected}"
        );
        // (x^2 - 1) has the kurtosis 15 for a normal x, which gives 2 n/14 degrees of freedom. By
        // the eighth moment they are known to 4 %.
        let freedom = moments.tails.error_law(100_000).freedom;
        assert!(
            (freedom / (100_000.0 / 7.0) - 1.0).abs() < 0.16,
            "{freedom}"
        );
    }

    /// The error of a variance s^2 by leaving out one number after the other, divided by twice the
    /// standard deviation.
    #[test]
    fn the_error_of_a_standard_deviation_is_that_of_the_jackknife() {
        let x = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0];
        let variance = |x: &[f64]| {
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (x.len() as f64 - 1.0)
        };
        let without: Vec<f64> = (0..x.len())
            .map(|i| variance(&[&x[..i], &x[i + 1..]].concat()))
            .collect();
        let expected =
            crate::sums::jackknife::standard_error(&without) / (2.0 * variance(&x).sqrt());
        let sd = SpreadMoments::of(&x, Replicate::Path)
            .standard_deviation()
            .measurement();
        assert!(
            (sd.standard_error / expected - 1.0).abs() < 1e-12,
            "{sd:?} {expected}"
        );
    }

    #[test]
    fn one_value_has_no_spread_and_equal_ones_have_none() {
        // The file must hold the same bytes on every processor, whichever sign 0/0 has there.
        let one = SpreadMoments::of(&[3.0], Replicate::Path)
            .standard_deviation()
            .measurement();
        let numbers = [one.estimate, one.standard_error, one.low, one.high];
        assert!(
            numbers.iter().all(|x| x.to_bits() == f64::NAN.to_bits()),
            "{one:?}"
        );
        assert_eq!(
            SpreadMoments::of(&[2.0; 7], Replicate::Path)
                .tails
                .error_law(7),
            ErrorLaw::of_freedom(6.0)
        );
    }

    /// Null: the interval of a standard deviation covers the truth in 95 % of all ensembles, both
    /// for 50 normal numbers and for 200 exponential ones. For the latter, the standard error alone
    /// would give 90 %. [`Coverage::assert_95_percent`] states the false-alarm rate.
    #[test]
    fn intervals_of_standard_deviations_cover_where_tails_are_long() {
        let mut rng = Pcg64Dxsm::seed_from_u64(1908);
        let (mut normal, mut exponential, mut straight) = (
            Coverage::default(),
            Coverage::default(),
            Coverage::default(),
        );
        for _ in 0..4000 {
            let x: Vec<f64> = (0..50).map(|_| StandardNormal.sample(&mut rng)).collect();
            let sd = SpreadMoments::of(&x, Replicate::Path)
                .standard_deviation()
                .measurement();
            normal.count(sd.low <= 1.0 && 1.0 <= sd.high);
            let x: Vec<f64> = (0..200).map(|_| Exp1.sample(&mut rng)).collect();
            let sd = SpreadMoments::of(&x, Replicate::Path)
                .standard_deviation()
                .measurement();
            exponential.count(sd.low <= 1.0 && 1.0 <= sd.high);
            straight.count((sd.estimate - 1.0).abs() <= 1.96 * sd.standard_error);
        }
        normal.assert_95_percent("50 normal numbers");
        exponential.assert_95_percent("200 exponential numbers");
        assert!(straight.share() < 0.92, "{}", straight.share());
    }
}
