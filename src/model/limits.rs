//! The largest numbers that a model may contain or lead to.

use super::{Friction, Problem};
use crate::lanes::InstructionSet;
use std::f64::consts::PI;

/// The largest number that can be computed with: squares and products of two such numbers, summed
/// over any run, fit in a double.
pub const LARGEST: f64 = 1e100;

/// Whether all of these are at most [`LARGEST`]. A NaN is not.
pub fn can_be_computed_with(sizes: &[f64]) -> bool {
    sizes.iter().all(|size| *size <= LARGEST)
}

/// The number of standard deviations that v is assumed never to exceed: beyond 40, exp(-40^2/2) is
/// below the smallest double.
const FARTHEST_SD: f64 = 40.0;

impl Problem {
    /// The largest |g(x0, 0, t)| up to `end` with its time: that at many times and at all kinks,
    /// where g depends on time; 0 where there is no g or where it is not a number.
    pub fn largest_at_start(&self, end: f64) -> (f64, f64) {
        const TIMES: u32 = 1000;
        let Some(own) = &self.force else {
            return (0.0, 0.0);
        };
        let times = if own.depends_on_time() { TIMES } else { 0 };
        let times = (0..=times).map(|i| end * f64::from(i) / f64::from(TIMES));
        let at = |time| {
            (
                own.at(
                    InstructionSet::detect(),
                    self.initial_displacement,
                    0.0,
                    time,
                )
                .abs(),
                time,
            )
        };
        let kinks = own
            .kinks(end, end / f64::from(TIMES))
            .into_iter()
            .filter(|time| *time <= end);
        times.chain(kinks).map(at).fold(
            (0.0, 0.0),
            |largest, now| if now.0 > largest.0 { now } else { largest },
        )
    }

    /// The amplitude A beyond which a body with negative damping runs away, where `added` is
    /// subtracted from alpha; none without a spring, or without growth.
    ///
    /// In a half-cycle of the unforced body the amplitude grows by q = e^{-pi z/sqrt(1 - z^2)}, z =
    /// alpha/(m w0) < 0, while friction takes (1 + q) f_d/K of it, so the two balance at
    ///
    /// ```text
    /// A = (f_d/K) (q + 1)/(q - 1)
    /// ```
    ///
    /// With z <= -1 it does not swing back, and A is f_d/K, the limit of q without bound: every
    /// slip runs away.
    pub fn runaway_amplitude(&self, added: f64) -> Option<f64> {
        let Problem {
            oscillator,
            friction: Friction { dynamic_force, .. },
            ..
        } = self;
        let z = (oscillator.damping - added) / (oscillator.mass * oscillator.natural_frequency());
        // Infinite for z <= -1.
        let exponent = -PI * z / ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        (z < 0.0 && oscillator.stiffness > 0.0)
            .then(|| dynamic_force / oscillator.stiffness / libm::tanh(0.5 * exponent))
    }

    /// A bound of |b| = |K (beta T - x)| while x = x0, up to `end`, for practically every
    /// realisation of the noise.
    pub fn largest_force(&self, end: f64) -> f64 {
        self.force_bound(FARTHEST_SD, end)
    }

    /// The size of a displacement up to `end`, to an order of magnitude: that of a spring that the
    /// static friction holds, or of a body that it accelerates.
    pub fn length_scale(&self, end: f64) -> f64 {
        let Problem {
            oscillator,
            friction,
            ..
        } = self;
        let force = if friction.static_force > 0.0 {
            friction.static_force
        } else {
            1.0
        };
        if oscillator.stiffness > 0.0 {
            force / oscillator.stiffness
        } else {
            force / oscillator.mass * end * end
        }
    }

    /// The drift velocity in the long run, where it follows from the spring: the body stays within
    /// some distance of beta T, whose mean has a constant slope. None without a spring, without
    /// dissipation, with a user-defined force, or with a measured T.
    pub fn long_run_drift(&self) -> Option<f64> {
        let Problem {
            oscillator,
            friction,
            temperature,
            force,
            ..
        } = self;
        let is_bound = oscillator.stiffness > 0.0 && force.is_none() && oscillator.damping >= 0.0;
        let is_braked = oscillator.damping > 0.0 || friction.dynamic_force > 0.0;
        (is_bound && is_braked && temperature.series.is_none())
            .then(|| oscillator.force_per_temperature() * temperature.trend / oscillator.stiffness)
    }

    /// A bound of |b| while x = x0, up to `end`, where each noise is bounded by `sds` stationary
    /// standard deviations.
    pub fn force_bound(&self, sds: f64, end: f64) -> f64 {
        let linear = self.oscillator.force_bound(
            self.temperature.bound(sds, end),
            self.initial_displacement.abs(),
        );
        linear + self.largest_at_start(end).0
    }
}
