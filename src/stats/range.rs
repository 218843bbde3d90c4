//! Intervals of numbers that have a range: they stay in it, and where all paths agree they are no
//! single point.
//!
//! The interval of a share p holds every share s that the data do not refute: those for which p is
//! within t standard errors of s, where the standard error is the one that p would have if s were
//! true,
//!
//! ```text
//! (p - s)^2 <= t^2 s (1 - s)/n
//! ```
//!
//! (E. B. Wilson, *Probable inference, the law of succession, and statistical inference*, Journal
//! of the American Statistical Association 22 (1927).) Of paths that count as 0 or 1, n is their
//! number. Of a share with another standard error e, n is the number of them that would have it, p
//! (1 - p)/e^2 (E. L. Korn and B. I. Graubard, *Confidence intervals for proportions with small
//! expected number of positive counts estimated from survey data*, Survey Methodology 24 (1998)).

/// 97.5 % quantile of the normal law.
pub(super) const NORMAL: f64 = 1.959_963_984_540_054;

/// What a number can be at least and at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub low: f64,
    pub high: f64,
}

impl Range {
    /// Any number.
    pub const ANY: Range = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
    /// A duration, a count, a spread, a work.
    pub const NOT_NEGATIVE: Range = Range { low: 0.0, high: f64::INFINITY };
    /// A number of things of which there is one at least.
    pub const FROM_ONE: Range = Range { low: 1.0, high: f64::INFINITY };
    /// A correlation.
    pub const CORRELATION: Range = Range { low: -1.0, high: 1.0 };
    /// A share.
    pub const SHARE: Range = Range { low: 0.0, high: 1.0 };

    /// Whether it has two ends, and the number lies between them: a share of the way from one to
    /// the other.
    pub fn has_inside(self, number: f64) -> bool {
        self.low.is_finite() && self.high.is_finite() && self.low < number && number < self.high
    }

    /// An interval without what lies outside.
    pub fn clip(self, [low, high]: [f64; 2]) -> [f64; 2] {
        // What is missing stays missing.
        let inside = |x: f64| if x.is_nan() { x } else { x.max(self.low).min(self.high) };
        [inside(low), inside(high)]
    }

    /// Where a number is at which so many paths agree, one and all. That tells of no spread, but
    /// paths that differ are few: the share of them is below that of Wilson for none of `paths`.
    /// They may differ by as much as the range allows, so an end that the range does not bound is
    /// infinite.
    pub fn agreed(self, number: f64, paths: u64) -> [f64; 2] {
        let [_, few] = wilson(0.0, paths as f64, NORMAL);
        let towards = |end: f64| if end.is_finite() { number + few * (end - number) } else { end };
        [towards(self.low), towards(self.high)]
    }
}

/// The interval of a share p that n paths would tell, with t in place of the normal quantile.
pub(super) fn wilson(p: f64, n: f64, t: f64) -> [f64; 2] {
    let square = t * t / n;
    let half_width = t * (p * (1.0 - p) / n + square / (4.0 * n)).sqrt();
    let end = |offset: f64| ((p + square / 2.0 + offset) / (1.0 + square)).clamp(0.0, 1.0);
    // At 0 and 1 the nearer end is the share itself, but for rounding.
    let low = if p <= 0.0 { 0.0 } else { end(-half_width).min(p) };
    let high = if p >= 1.0 { 1.0 } else { end(half_width).max(p) };
    [low, high]
}

/// So many paths, in so many independent units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub paths: u64,
    pub units: u64,
    /// Whether they differ by chance.
    pub is_random: bool,
}

impl Sample {
    /// The interval of the share of paths that are so many of them, each of which is or is not; in
    /// an ensemble that is not random it is the share itself, and for fewer than two units there is
    /// none.
    pub fn share(self, count: u64) -> [f64; 2] {
        let share = count as f64 / self.paths as f64;
        match (self.units, self.is_random) {
            (0..=1, _) => [f64::NAN; 2],
            (_, false) => [share; 2],
            (units, true) => wilson(share, units as f64, NORMAL),
        }
    }

    /// The interval of their number, likewise.
    pub fn number(self, count: u64) -> [f64; 2] {
        self.share(count).map(|end| end * self.paths as f64)
    }
}

/// Paths each of which is a unit.
#[cfg(test)]
pub(super) fn independent(paths: u64, is_random: bool) -> Sample {
    Sample { paths, units: paths, is_random }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn wilsons_ends_are_refuted_by_just_t_standard_errors_of_their_own(
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
    fn what_was_never_seen_is_bounded_by_the_number_of_paths_and_what_has_no_range_by_nothing() {
        // t^2/(n + t^2): about four in n, one more than the rule of three, which leaves all of the
        // 5 % at one end.
        assert_eq!(wilson(0.0, 12.0, 2.0), [0.0, 0.25]);
        assert_eq!(wilson(1.0, 12.0, 2.0), [0.75, 1.0]);
        let few = independent(4, true).share(0)[1];
        assert_eq!(Range::SHARE.agreed(0.0, 4), [0.0, few]);
        assert_eq!(Range::NOT_NEGATIVE.agreed(5.0, 4), [5.0 - few * 5.0, f64::INFINITY]);
        assert_eq!(Range::ANY.agreed(5.0, 4), [f64::NEG_INFINITY, f64::INFINITY]);
        assert_eq!(independent(4, false).share(0), [0.0, 0.0]);
        assert!(independent(1, true).share(1)[0].is_nan());
    }

    /// Null: of 250 paths the share that is static is 0.3, or 0.02. The number of them is binomial,
    /// so the coverage is a finite sum without chance: it is 95 % to within 1 %, and for the rare 2
    /// %, where the number is about five, within 2 %.
    #[test]
    fn wilsons_interval_of_binomial_paths_covers_95_percent() {
        let n = 250_u64;
        for (p, within) in [(0.3, 0.01), (0.5, 0.01), (0.9, 0.015), (0.02, 0.02)] {
            let mut probability = (n as f64 * (1.0_f64 - p).ln()).exp();
            let mut covered = 0.0;
            for k in 0..=n {
                let [low, high] = independent(n, true).share(k);
                covered += if low <= p && p <= high { probability } else { 0.0 };
                probability *= (n - k) as f64 / (k + 1) as f64 * (p / (1.0 - p));
            }
            assert!((covered - 0.95).abs() < within, "{p}: {covered}");
        }
    }
}
