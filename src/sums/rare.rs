//! Means that may rest on few events.
//!
//! If events are rare and clustered, a few paths have most of them. If the large paths are missing,
//! the mean and its error are both too small. So the interval follows the skewness and the tails of
//! the influences of paths ([`super::interval`]), with f degrees of freedom. Where only m of n
//! paths have any events, f is too large, because the paths in the tails may be missing as well. So
//! t is that of Student's t with f^2/(f + 2 (1 - m/n)) degrees of freedom.
//!
//! The tests in `tests/library/rare_events.rs` measure the coverage of these intervals.

use super::codec::sums;
use super::interval::ErrorLaw;

/// If more than half of all units do not contribute, a number has an interval only with at least
/// this many that do. If most units contribute, nothing is rare.
pub(crate) const FEWEST: u64 = 5;

/// The same for a standard deviation and for the mean of squares, which rest on the largest events.
pub(crate) const FEWEST_FOR_SPREAD: u64 = 32;

/// The standard deviation of the phases of fewer units has no interval, however many phases each of
/// them has. A kind of phase that one unit in twenty has may decide the standard deviation. From so
/// many units it is missing in less than 4 % of all runs.
pub(crate) const FEWEST_FOR_PHASES: u64 = 64;

/// Whether the events of a number are so rare that these few units are not representative. If no
/// unit has any, the number is zero or does not exist.
pub(crate) fn are_too_few(contributing: u64, units: u64, fewest: u64) -> bool {
    (1..fewest).contains(&contributing) && 2 * contributing < units
}

/// The law of an error with the degrees of freedom that can be known where this many of all units
/// contribute.
pub(crate) fn cautious(law: ErrorLaw, contributing: u64, units: u64) -> ErrorLaw {
    let silent = 1.0 - contributing as f64 / units as f64;
    law.with_freedom(law.freedom * law.freedom / (law.freedom + 2.0 * silent))
}

sums! {
    /// Sums over units of a^3, a^2 b, a b^2 and b^3, and of a^4, a^3 b, a^2 b^2, a b^3 and b^4, of two
    /// numbers a and b of each unit. They give the third and fourth powers of the influences a - r b
    /// for any ratio r.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub(crate) struct Powers {
        thirds: [f64; 4],
        fourths: [f64; 5],
    }
}

/// Below this share of its terms, a sum of fourth powers is lost in rounding. The influences are
/// then below a thousandth of the numbers, and no path stands out. A sum of third powers that is that
/// small is lost, too, or zero.
const ROUNDING: f64 = 1e-12;

impl Powers {
    /// The sums over pairs of numbers.
    pub fn of(top: &[f64], bottom: &[f64]) -> Self {
        let mut powers = Powers::default();
        for (a, b) in top.iter().zip(bottom) {
            let [aa, ab, bb] = [a * a, a * b, b * b];
            let thirds = [aa * a, aa * b, a * bb, bb * b];
            powers
                .thirds
                .iter_mut()
                .zip(thirds)
                .for_each(|(sum, term)| *sum += term);
            let fourths = [aa * aa, aa * ab, aa * bb, ab * bb, bb * bb];
            powers
                .fourths
                .iter_mut()
                .zip(fourths)
                .for_each(|(sum, term)| *sum += term);
        }
        powers
    }

    /// The sums for a mean over units.
    pub fn of_mean(values: &[f64]) -> Self {
        Powers::of(values, &vec![1.0; values.len()])
    }

    /// The law of the error of the ratio of sums over this many units. `squares` is the sum of the
    /// squares of their influences.
    pub fn error_law(&self, ratio: f64, squares: f64, units: u64) -> ErrorLaw {
        let r = -ratio;
        let [aaa, aab, abb, bbb] = self.thirds;
        let [aaaa, aaab, aabb, abbb, bbbb] = self.fourths;
        let thirds = [aaa, 3.0 * r * aab, 3.0 * r * r * abb, r * r * r * bbb];
        let fourths = [
            aaaa,
            4.0 * r * aaab,
            6.0 * r * r * aabb,
            4.0 * r * r * r * abbb,
            r * r * r * r * bbbb,
        ];
        ErrorLaw::of([squares, unrounded(&thirds), unrounded(&fourths)], units)
    }
}

/// The sum of these terms; zero where it is lost in rounding.
fn unrounded(terms: &[f64]) -> f64 {
    let (sum, size): (f64, f64) = (
        terms.iter().sum(),
        terms.iter().map(|term| term.abs()).sum(),
    );
    if sum.abs() > ROUNDING * size {
        sum
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::Merge as _;

    /// y = 2, 5, 5 over x = 1, 2, 3 has the ratio 2 and the influences 0, 1 and -1: the sum of
    /// their squares is 2, that of their fourth powers too, and 2/f = 2/4 - 1/3. So f is 12, but no
    /// more than 2. Ten numbers of which one is 10 and the others are 0 have the influences 9 and
    /// -1, the squares 90, the cubes 729 - 9 and the fourth powers 6570, and f is
    /// 2/(6570/8100 - 1/10) = 2.8.
    #[test]
    fn the_law_of_a_ratio_is_that_of_the_powers_of_its_influences() {
        let few = Powers::of(&[2.0, 5.0, 5.0], &[1.0, 2.0, 3.0]).error_law(2.0, 2.0, 3);
        assert_eq!((few.freedom, few.skewness), (2.0, 0.0));
        let mut more = Powers::of_mean(&[0.0, 10.0, 0.0]);
        more.merge(&Powers::of_mean(&[0.0; 7]));
        let law = more.error_law(1.0, 90.0, 10);
        assert!(
            (law.freedom * (6570.0 / 8100.0 - 0.1) / 2.0 - 1.0).abs() < 1e-9,
            "{law:?}"
        );
        // 720/90^(3/2) times sqrt(90)/8, which is the most that one of ten units can show.
        assert!((law.skewness - 1.0).abs() < 1e-9, "{law:?}");
    }

    #[test]
    fn rounding_takes_no_freedom_from_equal_units() {
        let equal = Powers::of(&[0.1; 50], &[0.3; 50]);
        for squares in [1e-33, 0.0] {
            assert_eq!(
                equal.error_law(0.1 / 0.3, squares, 50),
                ErrorLaw::of_freedom(49.0)
            );
        }
    }

    #[test]
    fn freedom_is_less_certain_the_more_units_are_silent() {
        let freedom = |m| cautious(ErrorLaw::of_freedom(6.0), m, 100).freedom;
        assert_eq!([0, 50, 100].map(freedom), [36.0 / 8.0, 36.0 / 7.0, 6.0]);
    }

    #[test]
    fn few_units_of_many_are_too_few() {
        assert!(are_too_few(4, 100, 5) && are_too_few(1, 3, 5));
        assert!(!are_too_few(5, 100, 5) && !are_too_few(0, 100, 5) && !are_too_few(3, 5, 5));
    }
}
