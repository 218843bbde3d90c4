//! From three steps to none.
//!
//! Y(h) is the value of a statistic at step h, D1 = Y(2h) - Y(h), D2 = Y(4h) - Y(2h), and b = Y(h)
//! - Y(0) its bias. With q = 2^p:
//!
//! ```text
//! one term    Y(h) = Y(0) + C h^p               b = D1/(q - 1)
//! two terms   Y(h) = Y(0) + C h^p + E h^2p      b = D1/(q - 1) + c,   c = (q D1 - D2)/((q - 1)(q^2 - 1))
//! observed order                                log2(D2/D1)
//! ```
//!
//! Where sticks end at random, p = 1/2: the barrier is looked at only every h, and the walk
//! overshoots it by a multiple of the sd of its step (Broadie, Glasserman, Kou, Math. Finance 7
//! (1997)). Statistics of the displacement go with h^1 as far as is measured, and are taken so
//! where the observed order is nearer to 1 than to 1/2.
//!
//! The two terms disagree with the truth on the other side than one does, where steps are too long
//! for both: the estimate is D1/(q - 1) + c/2, with less of c where c is mere scatter ([`weight`]).
//! It is wrong by c/2, and by what no expansion of two terms knows: slips that turn back within a
//! step appear one after the other as it falls. That is measured ([`unseen`]).

use crate::stats::Statistic;

/// The value of one statistic at the steps h, 2h and 4h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Levels(pub [f64; 3]);

/// What extrapolation misses of a statistic, as a share of the bias from one term, where
/// `noise_to_gap` is what the noise moves the force by in a step, as a share of f_s - f_d. Measured
/// (docs/bias.md). A long step sees next to nothing of the shortest slips, and with that share
/// grows what it misses: most of the numbers of sticks and slips, which are but half of what they
/// are without a step at a share of 4, and of the spread of durations.
pub(super) fn unseen(statistic: Statistic, noise_to_gap: f64) -> f64 {
    let is_missed_most =
        matches!(statistic, Statistic::SticksPerPath | Statistic::SlipsPerPath | Statistic::StickDurationSd);
    let slope = if is_missed_most { 0.5 } else { 0.2 };
    (slope * noise_to_gap).max(0.4)
}

impl Levels {
    /// Whether the statistic exists at every step.
    pub fn is_known(self) -> bool {
        self.0.iter().all(|y| y.is_finite())
    }

    /// D1 and D2.
    fn differences(self) -> (f64, f64) {
        let Levels([fine, middle, coarse]) = self;
        (middle - fine, coarse - middle)
    }

    /// log2(D2/D1); NaN or infinite where the two do not tell.
    pub fn observed_order(self) -> f64 {
        let (d1, d2) = self.differences();
        (d2 / d1).log2()
    }

    /// D1/(q - 1).
    fn one_term(self, p: f64) -> f64 {
        self.differences().0 / (p.exp2() - 1.0)
    }

    /// c: the bias from two terms less that from one.
    pub fn second_term(self, p: f64) -> f64 {
        let (d1, d2) = self.differences();
        let q = p.exp2();
        (q * d1 - d2) / ((q - 1.0) * (q * q - 1.0))
    }

    /// The bias, with `weight` times the second term.
    pub fn bias(self, p: f64, weight: f64) -> f64 {
        self.one_term(p) + weight * self.second_term(p)
    }

    /// How far off extrapolation may be: by this share of one term, and by half of c, which is
    /// itself known to so much only. Where c is scatter its weight is small by chance, not because
    /// there is no second term.
    pub fn model_error(self, p: f64, unseen: f64, second_term_error: f64) -> f64 {
        (unseen * self.one_term(p)).hypot(0.5 * self.second_term(p).hypot(second_term_error))
    }

    /// The bias where nothing is random, and its uncertainty. The order is 1, but with the step
    /// every event time jumps from one multiple of it to another, so the size of the bias is known,
    /// and no more.
    pub fn without_noise(self) -> (f64, f64) {
        let (d1, d2) = self.differences();
        (d1, d1.abs() + d2.abs())
    }
}

/// Whether a statistic goes with the step as smoothly as the law of the paths. A median does not:
/// it jumps from one hump of a law of two to the other.
pub(super) fn is_smooth(statistic: Statistic) -> bool {
    statistic != Statistic::StickDurationMedian
}

/// p.
pub(super) fn leading_order(statistic: Statistic, levels: Levels) -> f64 {
    let is_of_displacement = matches!(
        statistic,
        Statistic::DisplacementEndMean
            | Statistic::DisplacementEndSd
            | Statistic::DriftVelocity
            | Statistic::DiffusionCoefficient
            | Statistic::PeriodDisplacementMean
            | Statistic::PeriodDisplacementSd
            | Statistic::PeriodDisplacementCorrelation
            | Statistic::PhaseDisplacementSd
            | Statistic::FrictionWorkMean
            | Statistic::SlidingPathRate
    );
    if is_of_displacement && levels.observed_order() > 0.75 { 1.0 } else { 0.5 }
}

/// The share of a second term c with this standard error that goes into the estimate: 1/2 where it
/// is certain, none where it is scatter, (1 - error^2/c^2)/2 in between (W. James and C. Stein's
/// shrinkage, its positive part).
pub(super) fn weight(second_term: f64, error: f64) -> f64 {
    let (square, scatter) = (second_term * second_term, error * error);
    if square > scatter { 0.5 * (1.0 - scatter / square) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Y(h) = 3 + C h^p + E h^2p at h = 0.02, 0.04, 0.08.
    fn levels(c: f64, e: f64, p: f64) -> Levels {
        Levels([1.0, 2.0, 4.0].map(|k: f64| 3.0 + c * (0.02 * k).powf(p) + e * (0.02 * k).powf(2.0 * p)))
    }

    #[test]
    fn one_and_two_terms_are_found_exactly() {
        for p in [0.5, 1.0] {
            let one = levels(-0.7, 0.0, p);
            assert!((one.bias(p, 0.0) + 0.7 * 0.02f64.powf(p)).abs() < 1e-12);
            assert!(one.second_term(p).abs() < 1e-12 && (one.observed_order() - p).abs() < 1e-12);
            let (two, bias) = (levels(-0.7, 2.0, p), -0.7 * 0.02f64.powf(p) + 2.0 * 0.02f64.powf(2.0 * p));
            assert!((two.bias(p, 1.0) - bias).abs() < 1e-12, "{two:?}");
            // Half the second term: the truth is within the stated error.
            assert!((two.bias(p, 0.5) - bias).abs() <= two.model_error(p, 0.0, 0.0) + 1e-12);
        }
    }

    #[test]
    fn a_second_term_that_is_scatter_is_left_out() {
        assert_eq!((weight(0.0, 0.0), weight(2.0, 0.0)), (0.0, 0.5));
        assert_eq!((weight(2.0, 1.0), weight(1.0, 1.0), weight(1.0, 100.0)), (0.375, 0.0, 0.0));
    }
}
