//! Intervals of numbers that have a range. An interval stays within the range, and where all paths
//! agree by chance it is not a single point.
//!
//! The interval of a share p holds every share s that the data do not refute. These are the s from
//! which p is no more than t standard errors away, where the standard error is the one that p would
//! have if s were true:
//!
//! ```text
//! (p - s)^2 <= t^2 s (1 - s)/n
//! ```
//!
//! (E. B. Wilson, *Probable inference, the law of succession, and statistical inference*, Journal
//! of the American Statistical Association 22 (1927).) If each path counts as 0 or 1, n is the
//! number of paths. If the share has another standard error e, n is the number of such paths that
//! would give this error, p (1 - p)/e^2 (E. L. Korn and B. I. Graubard, *Confidence intervals for
//! proportions with small expected number of positive counts estimated from survey data*, Survey
//! Methodology 24 (1998)).

/// The 97.5 % quantile of the normal law.
pub(crate) const NORMAL: f64 = 1.959_963_984_540_054;

/// The smallest and the largest value that a number can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    pub low: f64,
    pub high: f64,
}

impl Range {
    /// Any number.
    pub const ANY: Range = Range {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };
    /// A duration, a count, a standard deviation, or work.
    pub const NOT_NEGATIVE: Range = Range {
        low: 0.0,
        high: f64::INFINITY,
    };
    /// A number of things of which there is at least one.
    pub const FROM_ONE: Range = Range {
        low: 1.0,
        high: f64::INFINITY,
    };
    /// A correlation.
    pub const CORRELATION: Range = Range {
        low: -1.0,
        high: 1.0,
    };
    /// A share.
    pub const SHARE: Range = Range {
        low: 0.0,
        high: 1.0,
    };

    /// Whether the range has two ends and the number lies between them, so that it is a share of
    /// the way from one end to the other.
    pub fn has_inside(self, number: f64) -> bool {
        self.low.is_finite() && self.high.is_finite() && self.low < number && number < self.high
    }

    /// The part of an interval that lies within the range. An end that is NaN stays NaN.
    pub fn clip(self, [low, high]: [f64; 2]) -> [f64; 2] {
        let inside = |x: f64| {
            if x.is_nan() {
                x
            } else {
                x.max(self.low).min(self.high)
            }
        };
        [inside(low), inside(high)]
    }

    /// The interval of a number on which all of `paths` paths agree. Their agreement shows no
    /// spread, but differing paths must be rare: their share is below the upper end of Wilson's
    /// interval for none of `paths`. They may differ by as much as the range allows, so an end that
    /// the range does not bound is infinite.
    pub fn interval_where_all_agree(self, number: f64, paths: u64) -> [f64; 2] {
        let [_, share_bound] = wilson(0.0, paths as f64, NORMAL);
        let towards = |end: f64| {
            if end.is_finite() {
                number + share_bound * (end - number)
            } else {
                end
            }
        };
        [towards(self.low), towards(self.high)]
    }
}

/// The interval of a share p of n paths, with t in place of the normal quantile.
pub(crate) fn wilson(p: f64, n: f64, t: f64) -> [f64; 2] {
    let square = t * t / n;
    let half_width = t * (p * (1.0 - p) / n + square / (4.0 * n)).sqrt();
    let end = |offset: f64| ((p + square / 2.0 + offset) / (1.0 + square)).clamp(0.0, 1.0);
    // At 0 and 1 the nearer end is the share itself, except for rounding.
    let low = if p <= 0.0 {
        0.0
    } else {
        end(-half_width).min(p)
    };
    let high = if p >= 1.0 {
        1.0
    } else {
        end(half_width).max(p)
    };
    [low, high]
}

/// The size of an ensemble: the numbers of its paths and of its independent units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    pub paths: u64,
    pub units: u64,
    /// Whether the paths differ by chance.
    pub is_random: bool,
}

impl Sample {
    /// The interval of the share of paths with some property, if `count` paths have it. It is the
    /// share itself where nothing is random, and NaN for fewer than two units.
    pub fn share(self, count: u64) -> [f64; 2] {
        let share = count as f64 / self.paths as f64;
        match (self.units, self.is_random) {
            (0..=1, _) => [f64::NAN; 2],
            (_, false) => [share; 2],
            (units, true) => wilson(share, units as f64, NORMAL),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Paths each of which is an independent unit.
    fn independent(paths: u64, is_random: bool) -> Sample {
        Sample {
            paths,
            units: paths,
            is_random,
        }
    }

    proptest! {
        #[test]
        fn wilsons_ends_are_t_standard_errors_away(
            p in 0.0..1.0f64, n in 1.0..1e6f64, t in 1.0..13.0f64,
        ) {
            let [low, high] = wilson(p, n, t);
            prop_assert!(0.0 <= low && low <= p && p <= high && high <= 1.0);
            for s in [low, high] {
                let (off, own) = ((p - s) * (p - s), t * t * s * (1.0 - s) / n);
                prop_assert!((off - own).abs() <= 1e-9 * (off + own) + 1e-15, "{p} {n} {t}: {s}");
            }
        }
    }

    #[test]
    fn a_number_all_paths_agree_on_has_the_bounds_of_its_range() {
        // The upper end is t^2/(n + t^2), about 4/n. The rule of three gives 3/n, because it leaves
        // all of the 5 % at one end.
        assert_eq!(wilson(0.0, 12.0, 2.0), [0.0, 0.25]);
        assert_eq!(wilson(1.0, 12.0, 2.0), [0.75, 1.0]);
        let share_bound = independent(4, true).share(0)[1];
        assert_eq!(
            Range::SHARE.interval_where_all_agree(0.0, 4),
            [0.0, share_bound]
        );
        assert_eq!(
            Range::NOT_NEGATIVE.interval_where_all_agree(5.0, 4),
            [5.0 - share_bound * 5.0, f64::INFINITY]
        );
        assert_eq!(
            Range::ANY.interval_where_all_agree(5.0, 4),
            [f64::NEG_INFINITY, f64::INFINITY]
        );
        assert_eq!(independent(4, false).share(0), [0.0, 0.0]);
        assert!(independent(1, true).share(1)[0].is_nan());
    }

    /// Null: of 250 paths, each is static with probability 0.3, 0.5, 0.9 or 0.02. The number of
    /// static paths is binomial, so that the coverage is a finite sum and not subject to chance. It
    /// is 95 % to within 1 %, to within 1.5 % for 0.9, and to within 2 % for the rare 0.02, where
    /// the number is about five.
    #[test]
    fn wilsons_interval_of_binomial_paths_covers_95_percent() {
        let n = 250_u64;
        for (p, within) in [(0.3, 0.01), (0.5, 0.01), (0.9, 0.015), (0.02, 0.02)] {
            let mut probability = (n as f64 * (1.0_f64 - p).ln()).exp();
            let mut covered = 0.0;
            for k in 0..=n {
                let [low, high] = independent(n, true).share(k);
                covered += if low <= p && p <= high {
                    probability
                } else {
                    0.0
                };
                probability *= (n - k) as f64 / (k + 1) as f64 * (p / (1.0 - p));
            }
            assert!((covered - 0.95).abs() < within, "{p}: {covered}");
        }
    }
}
