//! The expected amplitude of the body: a rough estimate, rather too large, of the forced motion
//! plus a free oscillation.
//!
//! A term A e^{st} of beta T is a harmonic (s = i w), or v that relaxes from v(0) (s = -theta).
//! Without friction it moves the body by H A e^{st}, where
//!
//! ```text
//! H = 1/(p^2 + 2 zeta p + 1),   p = s/w0,   zeta = alpha/(m w0)
//! ```
//!
//! The explicit step has (e^{sh} - 1)/h in place of s. So the scheme may alias a forcing that it
//! does not resolve to a slow one, which the body follows. The free oscillation starts from the
//! difference between the initial state x0, x'(0) and the forced motion, or from a later start at
//! rest with |b| = f_s while the forced motion passes.

use crate::model::{Complex, InitialNoise, OrnsteinUhlenbeck, Oscillator, Problem};
use std::f64::consts::PI;

/// Number of standard deviations that stationary noise does not exceed in any run of practical
/// length.
pub(super) const NEVER_SD: f64 = 10.0;

/// Number of standard deviations of the noise in an expected amplitude.
const TYPICAL_SD: f64 = 3.0;

/// A rough upper estimate of |x| up to `end`. With a step h it is that of the explicit scheme, and
/// without one that of the model.
pub(super) fn expected_amplitude(model: &Problem, end: f64, step: Option<f64>) -> f64 {
    let Problem {
        oscillator,
        friction,
        temperature,
        initial_displacement: x0,
        ..
    } = model;
    if !model.random.is_empty() {
        return f64::NAN;
    }
    let w0 = oscillator.natural_frequency();
    let force = model.force_bound(NEVER_SD, end);
    let v0 = model.initial_velocity;
    if force <= friction.static_force && v0 == 0.0 {
        return x0.abs();
    }
    if oscillator.stiffness == 0.0 {
        // Without a spring, the net force accelerates the body throughout.
        let driven = (force - friction.dynamic_force).max(0.0) / oscillator.mass * end * end / 2.0;
        return x0.abs() + driven + v0.abs() * end;
    }
    // The displacement per unit of temperature at equilibrium of the spring.
    let dilatation = oscillator.rest_position(1.0);
    // At resonance without damping the amplitude grows by w0/2 per unit of time, so the duration of
    // the run bounds it.
    let most = 1.0 + w0 * end / 2.0;
    let harmonics = temperature.harmonics.iter().map(|harmonic| {
        (
            Complex::unit(harmonic.phase) * harmonic.amplitude,
            Complex::new(0.0, harmonic.angular_frequency),
        )
    });
    let relaxing = temperature
        .effective_noises()
        .filter_map(|noise| match noise.initial {
            InitialNoise::At(v) => Some((
                Complex::new(noise.intensity * v, 0.0),
                Complex::new(-noise.relaxation_rate, 0.0),
            )),
            InitialNoise::Stationary => None,
        });
    // x and x'/w0 of the forced motion: at t = 0, and their largest sizes.
    let (mut x, mut y, mut most_x, mut most_y) = (0.0, 0.0, 0.0, 0.0);
    for (amplitude, s) in harmonics.chain(relaxing) {
        let p = step.map_or(s, |h| (s * h).exp_m1() * (1.0 / h)) * (1.0 / w0);
        let moved = response(oscillator, p, most) * amplitude * dilatation;
        let passing = moved * p;
        (x, y) = (x + moved.re, y + passing.re);
        (most_x, most_y) = (most_x + moved.abs(), most_y + passing.abs());
    }
    // Measured values move the rest position, and every change of slope excites an oscillation
    // about it.
    if let Some(series) = &temperature.series {
        let (low, high) = series.range();
        most_x += dilatation.abs() * low.abs().max(high.abs());
        (x, y) = (
            x + dilatation * series.at(0.0),
            y + dilatation * series.steepest() / w0,
        );
        most_y += dilatation.abs() * series.steepest() / w0;
    }
    if temperature.has_line() {
        most_x += dilatation.abs() * (temperature.offset.abs() + temperature.trend.abs() * end);
        (x, y) = (
            x + dilatation * temperature.offset,
            y + dilatation * temperature.trend / w0,
        );
        most_y += dilatation.abs() * temperature.trend.abs() / w0;
    }
    let noise = temperature
        .effective_noises()
        .map(|noise| noise_amplitude(model, &noise, end, step))
        .sum::<f64>();
    most_x
        + (x0 - x)
            .hypot(v0 / w0 - y)
            .max((friction.static_force / oscillator.stiffness).hypot(most_y))
        + noise
}

/// H at p, limited to `most` at resonance.
fn response(oscillator: &Oscillator, p: Complex, most: f64) -> Complex {
    let zeta = oscillator.damping / (oscillator.mass * oscillator.natural_frequency());
    let stiffness = p * (p + Complex::new(2.0 * zeta, 0.0)) + Complex::ONE;
    match stiffness.abs() {
        resonant if resonant * most < 1.0 => Complex::new(most, 0.0),
        size if size.is_finite() => Complex::ONE / stiffness,
        _ => Complex::ZERO,
    }
}

/// The amplitude that stationary noise adds: the body follows the noise, and the noise excites the
/// free oscillation. Per unit of time the squared amplitude A^2 grows by D = w0^2 S, where S is the
/// spectrum of beta rho v at w0, as the step samples it. Friction reduces A by a = 2 f_d w0/(pi K)
/// per unit of time, and damping by A alpha/m. Near A_c the explicit step returns part of the
/// energy lost to friction. A then becomes this large with a probability of about exp(-2 a A/D),
/// which is set to one in a thousand here.
fn noise_amplitude(model: &Problem, noise: &OrnsteinUhlenbeck, end: f64, step: Option<f64>) -> f64 {
    let Problem {
        oscillator,
        friction,
        ..
    } = model;
    let (w0, theta) = (oscillator.natural_frequency(), noise.relaxation_rate);
    let sd = oscillator.rest_position(1.0).abs() * noise.intensity * noise.stationary_sd();
    // w0 S/sd^2, which is 2 theta w0/(theta^2 + w0^2) without a step.
    let spectrum = match step {
        Some(h) => {
            let turn = Complex::new(-theta * h, w0 * h).exp_m1().abs();
            w0 * h * -libm::expm1(-2.0 * theta * h) / (turn * turn)
        }
        None => 2.0 / (theta / w0 + w0 / theta),
    };
    let time = end.min(0.5 * oscillator.mass / oscillator.damping.max(0.0));
    let without_loss = TYPICAL_SD * sd * (spectrum * w0 * time).sqrt();
    let with_friction = 0.5
        * 1000f64.ln()
        * sd
        * sd
        * spectrum
        * (0.5 * PI * oscillator.stiffness / friction.dynamic_force);
    TYPICAL_SD * sd + without_loss.min(with_friction)
}
