//! Extrapolation from three steps to zero step.
//!
//! Y(h) is the value of a statistic at step h. D1 is Y(2h) - Y(h), D2 is Y(4h) - Y(2h), and the
//! bias is b = Y(h) - Y(0). With q = 2^p:
//!
//! ```text
//! one term    Y(h) = Y(0) + C h^p            b = D1/(q - 1)
//! two terms   Y(h) = Y(0) + C h^p + E h^2p   b = D1/(q - 1) + c
//!             with                           c = (q D1 - D2)/((q - 1)(q^2 - 1))
//! observed order                             log2(D2/D1)
//! ```
//!
//! If noise ends the sticks, p = 1/2, because the threshold is checked only once per step, and the
//! force overshoots it by a multiple of the standard deviation of its increment (Broadie,
//! Glasserman, Kou, Math. Finance 7 (1997)). The errors of statistics of the displacement were
//! measured to be of order 1, and p is 1 for them if the observed order is closer to 1 than to 1/2.
//!
//! If the steps are too long for either expansion, the values from one term and from two are on
//! opposite sides of the true value. So the estimate is D1/(q - 1) + c/2, with less of c where c is
//! mostly scatter ([`weight`]). It may be wrong by c/2, and by effects that no expansion of two
//! terms describes: slips that reverse within a step are missed, and appear one after another as
//! the step decreases. That part is measured ([`model_error_share`]).

use crate::stats::{Statistic, StepError};

/// The value of one statistic at the steps h, 2h and 4h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Levels(pub [f64; 3]);

/// The error of extrapolation of a statistic, relative to the bias from one term. `noise_to_gap` is
/// the change of the force by the noise in a step, relative to f_s - f_d. The numbers were measured;
/// `tests/library/bias_coverage.rs` tests them. A long step misses almost all of the shortest slips, and the error grows with
/// `noise_to_gap`. It is largest for the numbers of sticks and slips, which at a `noise_to_gap` of
/// 4 are only half of those without a step, and for the standard deviation of durations.
pub(super) fn model_error_share(statistic: Statistic, noise_to_gap: f64) -> f64 {
    let slope = if statistic.row().step_error == StepError::RootOfRare {
        0.5
    } else {
        0.2
    };
    (slope * noise_to_gap).max(0.4)
}

impl Levels {
    /// Whether the statistic exists at every step.
    pub fn are_finite(self) -> bool {
        self.0.iter().all(|y| y.is_finite())
    }

    /// Whether the value at a longer step is more than this many times that at h.
    pub fn grow_by(self, factor: f64) -> bool {
        let Levels([fine, middle, coarse]) = self;
        middle.max(coarse) > factor * fine
    }

    /// The differences D1 and D2.
    fn differences(self) -> (f64, f64) {
        let Levels([fine, middle, coarse]) = self;
        (middle - fine, coarse - middle)
    }

    /// log2(D2/D1); NaN or infinite if the two differences do not determine an order.
    pub fn observed_order(self) -> f64 {
        let (d1, d2) = self.differences();
        (d2 / d1).log2()
    }

    /// D1/(q - 1), the bias from one term.
    fn one_term(self, p: f64) -> f64 {
        self.differences().0 / (p.exp2() - 1.0)
    }

    /// c: the bias from two terms minus that from one.
    pub fn second_term(self, p: f64) -> f64 {
        let (d1, d2) = self.differences();
        let q = p.exp2();
        (q * d1 - d2) / ((q - 1.0) * (q * q - 1.0))
    }

    /// The bias, with `weight` times the second term.
    pub fn bias(self, p: f64, weight: f64) -> f64 {
        self.one_term(p) + weight * self.second_term(p)
    }

    /// The possible error of the extrapolation: the fraction `share` of the bias from one term, and
    /// half of c, which itself is known only to `second_term_error`. This error is included
    /// because, if c is mostly scatter, its weight is small by chance and not because there is no
    /// second term.
    pub fn model_error(self, p: f64, share: f64, second_term_error: f64) -> f64 {
        (share * self.one_term(p)).hypot(0.5 * self.second_term(p).hypot(second_term_error))
    }

    /// The bias without randomness, and its uncertainty. The order is 1, but as the step changes,
    /// every event time jumps from one multiple of it to another, so only the size of the bias is
    /// known.
    pub fn without_noise(self) -> (f64, f64) {
        let (d1, d2) = self.differences();
        (d1, d1.abs() + d2.abs())
    }
}

/// Whether a statistic depends on the step as smoothly as the law of the paths. A median does not:
/// if the law has two humps, it jumps from one to the other.
pub(super) fn is_smooth(statistic: Statistic) -> bool {
    statistic.row().step_error != StepError::Jumps
}

/// The order p of the leading term.
pub(super) fn leading_order(statistic: Statistic, levels: Levels) -> f64 {
    let may_be_first = statistic.row().step_error == StepError::FirstOrRoot;
    if may_be_first && levels.observed_order() > 0.75 {
        1.0
    } else {
        0.5
    }
}

/// The weight in the estimate of a second term c with this standard error. It is 1/2 if c is
/// certain, 0 if c is scatter, and (1 - error^2/c^2)/2 in between (W. James and C. Stein's
/// shrinkage, its positive part).
pub(super) fn weight(second_term: f64, error: f64) -> f64 {
    let (square, scatter) = (second_term * second_term, error * error);
    if square > scatter {
        0.5 * (1.0 - scatter / square)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Y(h) = 3 + C h^p + E h^2p at h = 0.02, 0.04, 0.08.
    fn levels(c: f64, e: f64, p: f64) -> Levels {
        Levels(
            [1.0, 2.0, 4.0]
                .map(|k: f64| 3.0 + c * (0.02 * k).powf(p) + e * (0.02 * k).powf(2.0 * p)),
        )
    }

    #[test]
    fn one_and_two_terms_are_found_exactly() {
        for p in [0.5, 1.0] {
            let one = levels(-0.7, 0.0, p);
            assert!((one.bias(p, 0.0) + 0.7 * 0.02f64.powf(p)).abs() < 1e-12);
            assert!(one.second_term(p).abs() < 1e-12 && (one.observed_order() - p).abs() < 1e-12);
            let (two, bias) = (
                levels(-0.7, 2.0, p),
                -0.7 * 0.02f64.powf(p) + 2.0 * 0.02f64.powf(2.0 * p),
            );
            assert!((two.bias(p, 1.0) - bias).abs() < 1e-12, "{two:?}");
            // With half the second term, the truth is within the stated error.
            assert!((two.bias(p, 0.5) - bias).abs() <= two.model_error(p, 0.0, 0.0) + 1e-12);
        }
    }

    #[test]
    fn a_second_term_that_is_scatter_is_left_out() {
        assert_eq!((weight(0.0, 0.0), weight(2.0, 0.0)), (0.0, 0.5));
        assert_eq!(
            (weight(2.0, 1.0), weight(1.0, 1.0), weight(1.0, 100.0)),
            (0.375, 0.0, 0.0)
        );
    }
}
