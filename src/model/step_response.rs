//! The swing of an oscillator at rest under a constant force that sets in, until it comes to rest
//! again.
//!
//! Let Y be the distance to the equilibrium under that force, gamma = alpha/m, zeta = gamma/w0, w_d
//! = w0 sqrt(1 - zeta^2). The distance y travelled after a time r satisfies
//!
//! ```text
//! y'' + 2 gamma y' + w0^2 y = w0^2 Y,   y(0) = y'(0) = 0
//! y  = Y (1 - e^{-gamma r} (cos w_d r + (gamma/w_d) sin w_d r))
//! y' = Y (w0^2/w_d) e^{-gamma r} sin w_d r
//! ```
//!
//! **Below critical damping** (zeta < 1) y' first returns to zero after half a cycle of the damped
//! oscillator, when the body is beyond the equilibrium by the overshoot q:
//!
//! ```text
//! r = pi/w_d,   y = Y (1 + q),   q = e^{-pi zeta/sqrt(1 - zeta^2)}
//! ```
//!
//! If the same force goes on, the body swings back from there. Its largest speed is Y w0 e^{-gamma
//! r*}, where y'' = 0 for the second time: w_d r* = pi + arccos zeta.
//!
//! **At critical damping and above** (zeta >= 1) the body approaches the equilibrium without ever
//! coming to rest: q = 0. The swing is defined to end after the settling time, when the fraction
//! [`SETTLED`] of the distance is left.

use super::complex::Complex;
use super::{ImpulseResponse, Oscillator};
use std::f64::consts::PI;

/// The fraction of the distance to the equilibrium that is left at the defined end of a swing
/// without overshoot. It equals the default error of statistics in the schemes without a step. A
/// smaller fraction would make the swing longer, by ln 10 of the slow time scale for each digit,
/// without changing the motion noticeably.
pub const SETTLED: f64 = 1e-3;

/// The response of an oscillator at rest to a constant force that sets in.
#[derive(Clone, Copy, Debug)]
pub struct StepResponse {
    natural_frequency: f64,
    /// None if there is no damping.
    damped: Option<ImpulseResponse>,
    /// The duration of the swing: pi/w_d, or the settling time if zeta >= 1.
    pub duration: f64,
    /// q, the distance beyond the equilibrium as a fraction of the distance to it: from 1 without
    /// damping to 0 for zeta >= 1.
    pub overshoot: f64,
    /// The largest speed of the swing back, in units of Y w0: from 1 without damping to 0 at and
    /// above critical damping.
    pub return_speed: f64,
}

impl StepResponse {
    /// The response of this oscillator.
    pub fn new(oscillator: &Oscillator) -> Self {
        let w0 = oscillator.natural_frequency();
        let gamma = oscillator.damping / oscillator.mass;
        let damped = (gamma > 0.0).then(|| ImpulseResponse::new(gamma, w0));
        let (duration, overshoot, return_speed) = match (damped, gamma / w0) {
            (Some(response), zeta) if zeta >= 1.0 => {
                (settling_time(&response, gamma, w0), 0.0, 0.0)
            }
            (_, zeta) => {
                // w_d/w0
                let root = ((1.0 - zeta) * (1.0 + zeta)).sqrt();
                let decayed = |angle: f64| libm::exp(-zeta * angle / root);
                (
                    PI / (w0 * root),
                    decayed(PI),
                    decayed(PI + libm::acos(zeta)),
                )
            }
        };
        StepResponse {
            natural_frequency: w0,
            damped,
            duration,
            overshoot,
            return_speed,
        }
    }

    /// y, y' and y'' a time `r` after the force sets in, where `equilibrium` is Y.
    pub fn at(&self, equilibrium: f64, r: f64) -> [f64; 3] {
        let w0 = self.natural_frequency;
        let acceleration = equilibrium * w0 * w0;
        match &self.damped {
            None => {
                let (sin, cos) = libm::sincos(w0 * r);
                [
                    equilibrium * (1.0 - cos),
                    equilibrium * w0 * sin,
                    acceleration * cos,
                ]
            }
            Some(response) => [
                response.exponential(Complex::ZERO, r).re,
                response.impulse(r),
                response.impulse_slope(r),
            ]
            .map(|response| acceleration * response),
        }
    }
}

/// The time at which the fraction of the distance that is left, R = 1 - y/Y = S' + 2 gamma S, has
/// fallen to [`SETTLED`].
///
/// With the slow root l1, R >= e^{l1 r}, so this time is not before ln(1/SETTLED)/|l1|. ln R is
/// concave with the slope -w0^2 S/R. So Newton's first step from there goes too far, and the next
/// ones come back without passing the root.
fn settling_time(response: &ImpulseResponse, gamma: f64, w0: f64) -> f64 {
    let fast = gamma + ((gamma - w0) * (gamma + w0)).sqrt();
    let mut r = -libm::log(SETTLED) * (fast / w0 / w0);
    for _ in 0..NEWTON_STEPS {
        let impulse = response.impulse(r);
        let left = response.impulse_slope(r) + 2.0 * gamma * impulse;
        r += libm::log(left / SETTLED) * (left / impulse / w0 / w0);
    }
    // The time is too long for a double.
    if r.is_nan() { f64::INFINITY } else { r }
}

/// Newton steps from a start that is wrong by at most a third of the time. They are enough to reach
/// rounding.
const NEWTON_STEPS: usize = 8;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Drive;

    fn response(zeta: f64) -> StepResponse {
        // w0 = 2, gamma = 2 zeta.
        StepResponse::new(&Oscillator {
            mass: 0.5,
            stiffness: 2.0,
            damping: zeta,
            drive: Drive::Dilatation(0.0),
        })
    }

    /// The formulas at the head of this file in plain arithmetic, and for zeta > 1 the two
    /// exponentials.
    fn formula(zeta: f64, r: f64) -> (f64, f64) {
        let (w0, gamma) = (2.0, 2.0 * zeta);
        if zeta < 1.0 {
            let w_d = w0 * (1.0 - zeta * zeta).sqrt();
            let (sin, cos) = (w_d * r).sin_cos();
            let decay = (-gamma * r).exp();
            (
                1.0 - decay * (cos + gamma / w_d * sin),
                w0 * w0 / w_d * decay * sin,
            )
        } else if zeta == 1.0 {
            (
                1.0 - (1.0 + w0 * r) * (-w0 * r).exp(),
                w0 * w0 * r * (-w0 * r).exp(),
            )
        } else {
            let root = w0 * (zeta * zeta - 1.0).sqrt();
            let (slow, fast) = (root - gamma, -root - gamma);
            let (a, b) = ((slow * r).exp(), (fast * r).exp());
            (
                1.0 - (fast * a - slow * b) / (fast - slow),
                slow * fast * (b - a) / (fast - slow),
            )
        }
    }

    #[test]
    fn the_swing_is_that_of_the_closed_form_at_any_damping() {
        for zeta in [0.0, 1e-12, 0.05, 0.3, 0.9, 0.999, 1.0, 1.5, 40.0] {
            for r in [1e-3, 0.1, 0.7, 1.5, 4.0, 30.0] {
                let ([y, v, a], (way, speed)) = (response(zeta).at(1.0, r), formula(zeta, r));
                // w0 = 2, gamma = 2 zeta.
                let push = 4.0 * (1.0 - way) - 4.0 * zeta * speed;
                assert!(
                    (y - way).abs() < 1e-13
                        && (v - speed).abs() < 2e-13
                        && (a - push).abs() < 1e-11,
                    "{zeta} {r}: {y} {way}, {v} {speed}, {a} {push}"
                );
            }
        }
    }

    #[test]
    fn below_critical_damping_it_rests_beyond_equilibrium() {
        for zeta in [0.0, 0.05, 0.3, 0.9, 0.99] {
            let swing = response(zeta);
            let [y, v, _] = swing.at(1.0, swing.duration);
            assert!(
                (y - (1.0 + swing.overshoot)).abs() < 1e-14 && v.abs() < 1e-14,
                "{zeta}: {y} {v}"
            );
            // The body is not at rest before the end.
            assert!(
                (1..100).all(|i| swing.at(1.0, swing.duration * f64::from(i) / 100.0)[1] > 0.0),
                "{zeta}"
            );
            // No speed of the swing back exceeds `return_speed`, and one equals it.
            let back = |i: i32| -swing.at(1.0, swing.duration * (1.0 + f64::from(i) / 1e4))[1];
            let fastest = (0..10_000).map(back).fold(0.0, f64::max) / 2.0;
            assert!(
                (fastest / swing.return_speed - 1.0).abs() < 1e-6,
                "{zeta}: {fastest}"
            );
        }
        assert_eq!(
            (response(0.0).overshoot, response(0.0).return_speed),
            (1.0, 1.0)
        );
        assert_eq!(response(0.0).duration, PI / 2.0);
        // e^{-0.3 pi/sqrt(0.91)}, from 30-digit arithmetic.
        assert!(
            (response(0.3).overshoot - 0.372_326_104_926_586_5).abs() < 1e-15,
            "{}",
            response(0.3).overshoot
        );
    }

    #[test]
    fn a_response_without_overshoot_ends_when_a_thousandth_is_left() {
        for zeta in [1.0, 1.0 + 1e-9, 1.1, 1.5, 10.0, 1e6] {
            let swing = response(zeta);
            // The distance that is left, from the two exponentials or their limit.
            let left = 1.0 - formula(zeta, swing.duration).0;
            assert!(
                (left / SETTLED - 1.0).abs() < if zeta > 1e3 { 1e-3 } else { 1e-6 },
                "{zeta}: {left}"
            );
            assert_eq!((swing.overshoot, swing.return_speed), (0.0, 0.0));
        }
        // (1 + u) e^{-u} = 1e-3 at u = 9.2334134764...; here w0 = 2.
        assert!(
            (2.0 * response(1.0).duration - 9.233_413_476_4).abs() < 1e-9,
            "{}",
            response(1.0).duration
        );
    }
}
