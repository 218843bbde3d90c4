//! From three steps to none.
//!
//! With Y(h) the value of a statistic at step h, D1 = Y(2h) - Y(h) and D2 = Y(4h) - Y(2h), and its bias b = Y(h) - Y(0):
//!
//! ```text
//! observed order   log2(D2/D1)
//! one term         Y(h) = Y(0) + C h^p               b = D1/(q - 1),                             q = 2^p
//! two terms        Y(h) = Y(0) + C h^p + E h^2p      b = (q^2 + q - 1) D1/(q - 1)/(q^2 - 1) ...
//! ```
//!
//! Filled in below.

use crate::stats::Statistic;

/// The value of one statistic at the steps h, 2h and 4h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Levels(pub [f64; 3]);

impl Levels {
    pub fn is_known(self) -> bool {
        self.0.iter().all(|y| y.is_finite())
    }

    /// D1 and D2.
    fn differences(self) -> (f64, f64) {
        let Levels([fine, middle, coarse]) = self;
        (middle - fine, coarse - middle)
    }

    /// log2(D2/D1).
    pub fn observed_order(self) -> f64 {
        let (d1, d2) = self.differences();
        (d2 / d1).log2()
    }

    /// The bias from one term, h^p.
    fn one_term(self, p: f64) -> f64 {
        self.differences().0 / (2f64.powf(p) - 1.0)
    }

    /// The bias from two terms less that from one.
    pub fn curvature(self, p: f64) -> f64 {
        let (d1, d2) = self.differences();
        let q = 2f64.powf(p);
        (q * d1 - d2) / ((q - 1.0) * (q * q - 1.0))
    }

    pub fn bias(self, p: f64, weight: f64) -> f64 {
        self.one_term(p) + weight * self.curvature(p)
    }

    pub fn model_error(self, p: f64) -> f64 {
        (DRIFT * self.one_term(p)).hypot(self.curvature(p) / 2.0)
    }

    pub fn without_noise(self) -> (f64, f64) {
        let (d1, d2) = self.differences();
        (d1, d1.abs() + d2.abs())
    }
}

const DRIFT: f64 = 0.3;

pub(super) fn leading_order(statistic: Statistic, levels: Levels) -> f64 {
    let is_of_displacement = matches!(
        statistic,
        Statistic::DisplacementEndMean
            | Statistic::DisplacementEndSd
            | Statistic::DriftVelocity
            | Statistic::DiffusionCoefficient
            | Statistic::FrictionWorkMean
    );
    if is_of_displacement && levels.observed_order() > 0.75 { 1.0 } else { 0.5 }
}

pub(super) fn weight(curvature: f64, error: f64) -> f64 {
    let (signal, noise) = (curvature * curvature, error * error);
    if signal == 0.0 { 0.0 } else { 0.5 * signal / (signal + noise) }
}

pub(super) fn observed_order(levels: Levels, error: f64) -> Option<f64> {
    Some(levels.observed_order()).filter(|order| order.is_finite() && error < 0.5)
}
