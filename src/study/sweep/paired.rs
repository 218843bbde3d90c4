//! Numbers that compare two or three points: differences of neighbours and elasticities. Their
//! errors follow from comparing the points path by path.
//!
//! With common seeds, path n of one point and path n of the next have the same noise. Much of their
//! scatter is then common and cancels in a difference. The remaining error is found by leaving out
//! a group of paths at all points together ([`crate::stats::Groups`]). The variance that
//! independent seeds would give, divided by the variance found in this way, is the gain.

use super::Point;
use crate::stats::Statistic;
use crate::sums::interval::student;
use crate::sums::{Measurement, jackknife};

/// A number that compares several points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paired {
    /// The number with its standard error and its 95 % interval. The limits are NaN if all groups
    /// of random paths agree, since then the error is unknown.
    pub measurement: Measurement,
    /// The variance with independent seeds divided by that with common seeds; NaN if there is no
    /// variance.
    pub gain: f64,
}

impl Paired {
    /// A number that does not exist: all fields are NaN.
    pub const NOTHING: Paired = Paired {
        measurement: Measurement {
            estimate: f64::NAN,
            standard_error: f64::NAN,
            low: f64::NAN,
            high: f64::NAN,
        },
        gain: f64::NAN,
    };
}

/// An error below this, relative to the largest value that enters, is rounding.
const ROUNDING: f64 = 1e-12;

/// An elasticity is not given for a statistic within this many standard errors of zero.
const ZERO: f64 = 2.0;

/// The difference S(`to`) - S(`from`).
pub(super) fn difference(
    from: &Point,
    to: &Point,
    statistic: Statistic,
    is_random: bool,
) -> Paired {
    together(&[from, to], &[-1.0, 1.0], statistic, is_random, |[a, b]| {
        b - a
    })
}

/// The elasticity: the relative change of S divided by the relative change of the key, by a central
/// difference:
///
/// ```text
/// E = (S(above) - S(below)) / (2 step S(centre))
/// ```
///
/// [`Paired::NOTHING`] if S may be zero.
pub(super) fn elasticity(
    [centre, below, above]: [&Point; 3],
    relative_step: f64,
    statistic: Statistic,
    is_random: bool,
) -> Paired {
    let i = statistic.index();
    let error = jackknife::standard_error(&column(centre, i));
    if centre.estimates[i].estimate.abs() <= ZERO * error {
        return Paired::NOTHING;
    }
    let weight = 1.0 / (2.0 * relative_step * centre.estimates[i].estimate);
    let of = |[centre, below, above]: [f64; 3]| (above - below) / (2.0 * relative_step * centre);
    together(
        &[centre, below, above],
        &[0.0, -weight, weight],
        statistic,
        is_random,
        of,
    )
}

/// One statistic of a point without each group of paths in turn.
fn column(point: &Point, statistic: usize) -> Vec<f64> {
    point
        .without
        .iter()
        .map(|values| values[statistic])
        .collect()
}

/// A function of one statistic at several points. `weights` are its derivatives with respect to the
/// points; they give the variance that it would have if the points were independent.
fn together<const N: usize>(
    points: &[&Point; N],
    weights: &[f64; N],
    statistic: Statistic,
    is_random: bool,
    of: impl Fn([f64; N]) -> f64,
) -> Paired {
    let i = statistic.index();
    let estimate = of(points.map(|point| point.estimates[i].estimate));
    let groups = points[0].without.len();
    if groups < 2 || points.iter().any(|point| point.without.len() != groups) {
        return Paired {
            measurement: Measurement {
                estimate,
                ..Paired::NOTHING.measurement
            },
            gain: f64::NAN,
        };
    }
    let columns = points.map(|point| column(point, i));
    let without: Vec<f64> = (0..groups)
        .map(|g| of(columns.each_ref().map(|column| column[g])))
        .collect();
    let error = jackknife::standard_error(&without);
    let independent: f64 = columns
        .iter()
        .zip(weights)
        .map(|(column, w)| (w * jackknife::standard_error(column)).powi(2))
        .sum();
    let size = without
        .iter()
        .chain([&estimate])
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    let scale = points
        .iter()
        .zip(weights)
        .map(|(point, w)| (w * point.estimates[i].estimate).abs());
    let has_agreed = error <= ROUNDING * scale.fold(size, f64::max);
    let (error, reach) = match (has_agreed, is_random) {
        (true, true) => (0.0, f64::NAN),
        (true, false) => (0.0, 0.0),
        (false, _) => (error, student(groups as u64 - 1) * error),
    };
    let measurement = Measurement {
        estimate,
        standard_error: error,
        low: estimate - reach,
        high: estimate + reach,
    };
    Paired {
        measurement,
        gain: if has_agreed {
            f64::NAN
        } else {
            independent / (error * error)
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::Estimate;

    /// A point at which every statistic has this value, and these values without either of two
    /// groups.
    fn point(estimate: f64, without: [f64; 2]) -> Point {
        let of = |statistic| Estimate {
            statistic,
            estimate,
            standard_error: f64::NAN,
            low: f64::NAN,
            high: f64::NAN,
            bias: None,
        };
        Point {
            estimates: Statistic::ALL.map(of),
            completed_paths: 512,
            diverged_paths: 0,
            seconds: 1.0,
            cycle: None,
            without: without.map(|value| Statistic::ALL.map(|_| value)).into(),
        }
    }

    /// With S = 8, 7 and 10 at the centre, below and above and a step of 1/20, the elasticity is
    /// (10 - 7)/(2 * 8/20) = 3.75. Without either group it is (10.2 - 7)/0.82 and (9.8 - 7)/0.78,
    /// whose half distance is the standard error of two values; t = 12.7062 of one degree of freedom.
    #[test]
    fn an_elasticity_is_relative_to_the_centre() {
        let points = [
            point(8.0, [8.2, 7.8]),
            point(7.0, [7.0, 7.0]),
            point(10.0, [10.2, 9.8]),
        ];
        let [centre, below, above] = &points;
        let found = elasticity([centre, below, above], 0.05, Statistic::SlipsPerPath, true);
        let m = found.measurement;
        assert!((m.estimate - 3.75).abs() < 1e-12, "{m:?}");
        let error = 0.5 * (3.2_f64 / 0.82 - 2.8 / 0.78);
        assert!((m.standard_error - error).abs() < 1e-12, "{m:?} {error}");
        let half = 12.706_204_7 * error;
        assert!((m.high - 3.75 - half).abs() < 1e-6 && (3.75 - half - m.low).abs() < 1e-6);
        // Only the point above scatters, by 0.2: with independent seeds the error is 0.2/0.8.
        assert!(
            (found.gain - (0.25 / error).powi(2)).abs() < 1e-9,
            "{found:?}"
        );
    }
}
