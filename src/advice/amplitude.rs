//! How far a body may be expected to go, roughly and rather too far: its forced motion, and a free
//! oscillation on top.
//!
//! A term A e^{st} of beta T, a harmonic (s = i w) or v relaxing from v(0) (s = -theta), moves a
//! body without friction by H A e^{st}, where
//!
//! ```text
//! H = 1/(p^2 + 2 zeta p + 1),   p = s/w0,   zeta = alpha/(m w0)
//! ```
//!
//! The explicit step puts (e^{sh} - 1)/h in the place of s; so it takes a forcing that is faster
//! than itself for a slow one, to which the body yields. The free oscillation is what is left of x0
//! and x'(0) = 0; or of a later start at rest at |b| = f_s, where the forced motion passes.

use crate::model::{Complex, InitialNoise, Model, Noise, Oscillator};
use std::f64::consts::PI;

/// Standard deviations that a stationary noise exceeds in no run of practical length.
pub(super) const NEVER_SD: f64 = 10.0;

/// Standard deviations of the noise counted into an expected amplitude.
const TYPICAL_SD: f64 = 3.0;

/// A rough upper estimate of |x| up to `end`, as the explicit step makes it or, without one, the
/// model.
pub(super) fn expected_amplitude(model: &Model, end: f64, step: Option<f64>) -> f64 {
    let Model { oscillator, friction, temperature, initial_displacement: x0 } = model;
    let w0 = oscillator.natural_frequency();
    if model.force_bound(NEVER_SD) <= friction.static_force {
        return x0.abs();
    }
    // At resonance without damping the amplitude grows by w0/2 per unit of time, so the end of the
    // run bounds it.
    let most = 1.0 + w0 * end / 2.0;
    let harmonics = temperature.harmonics.iter().map(|harmonic| {
        (Complex::unit(harmonic.phase) * harmonic.amplitude, Complex::new(0.0, harmonic.angular_frequency))
    });
    let relaxing = temperature.noises().filter_map(|noise| match noise.initial {
        InitialNoise::At(v) => {
            Some((Complex::new(noise.intensity * v, 0.0), Complex::new(-noise.relaxation_rate, 0.0)))
        }
        InitialNoise::Stationary => None,
    });
    // x and x'/w0 of the forced motion: at t = 0, and at most.
    let (mut x, mut y, mut most_x, mut most_y) = (0.0, 0.0, 0.0, 0.0);
    for (amplitude, s) in harmonics.chain(relaxing) {
        let p = step.map_or(s, |h| (s * h).exp_m1() * (1.0 / h)) * (1.0 / w0);
        let moved = response(oscillator, p, most) * amplitude * oscillator.dilatation;
        let passing = moved * p;
        (x, y) = (x + moved.re, y + passing.re);
        (most_x, most_y) = (most_x + moved.abs(), most_y + passing.abs());
    }
    // Measured values move the rest position, and every bend of theirs sets the body swinging about
    // it.
    if let Some(series) = &temperature.series {
        let (low, high) = series.range();
        most_x += oscillator.dilatation.abs() * low.abs().max(high.abs());
        (x, y) = (x + oscillator.dilatation * series.at(0.0), y + oscillator.dilatation * series.steepest() / w0);
        most_y += oscillator.dilatation.abs() * series.steepest() / w0;
    }
    let stirred = temperature.noises().map(|noise| stirred(model, &noise, end, step)).sum::<f64>();
    most_x + (x0 - x).hypot(y).max((friction.static_force / oscillator.stiffness).hypot(most_y)) + stirred
}

/// H at p, kept to `most` where they resonate.
fn response(oscillator: &Oscillator, p: Complex, most: f64) -> Complex {
    let zeta = oscillator.damping / (oscillator.mass * oscillator.natural_frequency());
    let stiffness = p * (p + Complex::new(2.0 * zeta, 0.0)) + Complex::ONE;
    match stiffness.abs() {
        resonant if resonant * most < 1.0 => Complex::new(most, 0.0),
        size if size.is_finite() => Complex::ONE / stiffness,
        _ => Complex::ZERO,
    }
}

/// What the stationary noise does: the body follows it, and it stirs the free oscillation. The
/// squared amplitude A^2 grows by D = w0^2 S a unit of time, S the spectrum at w0 of beta rho v, as
/// the step samples it. Friction takes a = 2 f_d w0/(pi K) from A, damping A alpha/m; the step of A
/// near A_c gives part of it back, and A comes that far with odds of exp(-2 a A/D), here one to a
/// thousand.
fn stirred(model: &Model, noise: &Noise, end: f64, step: Option<f64>) -> f64 {
    let Model { oscillator, friction, .. } = model;
    let (w0, theta) = (oscillator.natural_frequency(), noise.relaxation_rate);
    let sd = oscillator.dilatation.abs() * noise.intensity * noise.stationary_sd();
    // w0 S/sd^2: 2 theta w0/(theta^2 + w0^2) without a step.
    let spectrum = match step {
        Some(h) => {
            let turn = Complex::new(-theta * h, w0 * h).exp_m1().abs();
            w0 * h * -libm::expm1(-2.0 * theta * h) / (turn * turn)
        }
        None => 2.0 / (theta / w0 + w0 / theta),
    };
    let time = end.min(0.5 * oscillator.mass / oscillator.damping);
    let unopposed = TYPICAL_SD * sd * (spectrum * w0 * time).sqrt();
    let rubbed = 0.5 * 1000f64.ln() * sd * sd * spectrum * (0.5 * PI * oscillator.stiffness / friction.dynamic_force);
    TYPICAL_SD * sd + unopposed.min(rubbed)
}
