//! Means of positive numbers that may rest on few events.
//!
//! Where events are rare and come in clusters, a few paths hold most of them. The estimate of a
//! mean and that of its error then rise and fall together. If the large paths are missing, both are
//! too small, and an interval with equal arms ends below the truth in 10 to 15 % of all runs. On a
//! logarithmic scale of d, the excess of the mean over the least value that it can have, the error
//! depends less on the estimate:
//!
//! ```text
//! interval   least + d e^{-+ t s/d}     with the standard error s
//! ```
//!
//! The error itself is known only as well as the tails of the influences of paths allow
//! ([`super::spread`]), with f degrees of freedom. Where only m of n paths have any events, f is
//! too large, because the paths that would show how long the tails are may be missing as well. So t
//! is that of Student's t with f^2/(f + 2 (1 - m/n)) degrees of freedom. Where all paths contribute
//! alike, none of this changes the interval much: the ends move by half of s/d of its width.
//!
//! docs/validation.md says how often these intervals hold the truth.

use super::codec::sums;

/// The numbers with these least contributing units have an interval, if more than half of all units
/// do not contribute. Where most units contribute, nothing is rare.
pub(crate) const FEWEST: u64 = 5;

/// The same for a standard deviation, which rests on the largest of the events.
pub(crate) const FEWEST_FOR_SPREAD: u64 = 32;

/// Whether the events of a number are so rare that these few units say nothing about the others.
/// Where no unit has any, the number is zero or does not exist.
pub(crate) fn are_too_few(contributing: u64, units: u64, fewest: u64) -> bool {
    (1..fewest).contains(&contributing) && 2 * contributing < units
}

/// The degrees of freedom of an error, as far as they can be known where this many of all units
/// contribute.
pub(crate) fn cautious(freedom: f64, contributing: u64, units: u64) -> f64 {
    let silent = 1.0 - contributing as f64 / units as f64;
    freedom * freedom / (freedom + 2.0 * silent)
}

sums! {
    /// Sums over units of a^4, a^3 b, a^2 b^2, a b^3 and b^4, of two numbers a and b of each unit.
    /// They give the fourth powers of the influences a - r b for any ratio r.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub(crate) struct Fourths {
        sums: [f64; 5],
    }
}

/// Below this share of its terms, a sum of fourth powers is lost in rounding. The influences are
/// then below a thousandth of the numbers, and no path stands out.
const ROUNDING: f64 = 1e-12;

impl Fourths {
    /// The sums over pairs of numbers.
    pub fn of(top: &[f64], bottom: &[f64]) -> Self {
        let mut sums = [0.0; 5];
        for (a, b) in top.iter().zip(bottom) {
            let [aa, ab, bb] = [a * a, a * b, b * b];
            let terms = [aa * aa, aa * ab, aa * bb, ab * bb, bb * bb];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
        Fourths { sums }
    }

    /// The sums for a mean over units.
    pub fn of_mean(values: &[f64]) -> Self {
        Fourths::of(values, &vec![1.0; values.len()])
    }

    /// Degrees of freedom of the error of the ratio of sums over this many units. `squares` is the
    /// sum of the squares of their influences.
    pub fn freedom(&self, ratio: f64, squares: f64, units: u64) -> f64 {
        let r = -ratio;
        let [aaaa, aaab, aabb, abbb, bbbb] = self.sums;
        let terms = [aaaa, 4.0 * r * aaab, 6.0 * r * r * aabb, 4.0 * r * r * r * abbb, r * r * r * r * bbbb];
        let (fourths, size): (f64, f64) = (terms.iter().sum(), terms.iter().map(|term| term.abs()).sum());
        let most = units as f64 - 1.0;
        let scatter = (fourths / squares / squares - 1.0 / units as f64) / 2.0;
        let is_known = fourths > ROUNDING * size && scatter.is_finite() && scatter * most > 1.0;
        if is_known { 1.0 / scatter } else { most }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::Merge as _;

    /// y = 2, 5, 5 over x = 1, 2, 3 has the ratio 2 and the influences 0, 1 and -1: the sum of
    /// their squares is 2, that of their fourth powers too, and 2/f = 2/4 - 1/3. So f is 12, but no
    /// more than 2. Ten numbers of which one is 10 and the others are 0 have the influences 9 and
    /// -1, the squares 90 and the fourth powers 6570, and f is 2/(6570/8100 - 1/10) = 2.8.
    #[test]
    fn the_freedom_of_a_ratio_is_that_of_the_fourth_powers_of_its_influences() {
        let few = Fourths::of(&[2.0, 5.0, 5.0], &[1.0, 2.0, 3.0]);
        assert_eq!(few.freedom(2.0, 2.0, 3), 2.0);
        let mut more = Fourths::of_mean(&[0.0, 10.0, 0.0]);
        more.merge(&Fourths::of_mean(&[0.0; 7]));
        let freedom = 2.0 / (6570.0 / 8100.0 - 0.1);
        assert!((more.freedom(1.0, 90.0, 10) / freedom - 1.0).abs() < 1e-9);
    }

    #[test]
    fn rounding_takes_no_freedom_from_equal_units() {
        let equal = Fourths::of(&[0.1; 50], &[0.3; 50]);
        assert_eq!(equal.freedom(0.1 / 0.3, 1e-33, 50), 49.0);
        assert_eq!(equal.freedom(0.1 / 0.3, 0.0, 50), 49.0);
    }

    #[test]
    fn freedom_is_less_certain_the_more_units_are_silent() {
        assert_eq!([0, 50, 100].map(|m| cautious(6.0, m, 100)), [36.0 / 8.0, 36.0 / 7.0, 6.0]);
    }

    #[test]
    fn few_units_of_many_are_too_few_and_few_of_few_are_what_there_is() {
        assert!(are_too_few(4, 100, 5) && are_too_few(1, 3, 5));
        assert!(!are_too_few(5, 100, 5) && !are_too_few(0, 100, 5) && !are_too_few(3, 5, 5));
    }
}
