//! The constants of a noisy scene, with the noise measured as a force.
//!
//! n = K beta rho v is an Ornstein-Uhlenbeck process dn = -theta n dt + s dW with s = |K beta rho|
//! sigma. (The sign of beta only turns W.) In a static phase b = B(t) - K x + n with B = K beta
//! T_det, so the corridor of v becomes
//! |b| <= f_s; in a slip, m x'' = B(t) - K x - 2 alpha x' - eps f_d + n.

use crate::model::{Complex, Friction, InitialNoise, Model, Oscillator};
use crate::noise::AddressedDraws;

/// One harmonic of B(t): Re[force e^{i w t}].
#[derive(Clone, Copy, Debug)]
pub struct ForceHarmonic {
    /// K beta a e^{i phi}.
    pub force: Complex,
    /// w.
    pub angular_frequency: f64,
}

/// A scene with noise.
#[derive(Clone, Debug)]
pub struct Scene {
    /// m, K, alpha, beta.
    pub oscillator: Oscillator,
    /// f_s and f_d, as simulated.
    pub friction: Friction,
    /// x(0).
    pub initial_displacement: f64,
    /// B(t).
    pub harmonics: Vec<ForceHarmonic>,
    /// theta.
    pub relaxation_rate: f64,
    /// s: the diffusion of n.
    pub diffusion: f64,
    /// The law of n(0): its mean and standard deviation.
    pub initial_noise: (f64, f64),
    /// K beta: force per temperature.
    pub force_per_temperature: f64,
}

impl Scene {
    /// Of a model whose temperature has noise; without, n = 0 throughout.
    pub fn new(model: &Model) -> Self {
        let oscillator = model.oscillator;
        let gain = oscillator.force_per_temperature();
        let harmonics: Vec<_> = model
            .temperature
            .harmonics
            .iter()
            .map(|h| ForceHarmonic {
                force: Complex::unit(h.phase) * (gain * h.amplitude),
                angular_frequency: h.angular_frequency,
            })
            .collect();
        let (relaxation_rate, diffusion, initial_noise) = match model.temperature.effective_noise() {
            None => (1.0, 0.0, (0.0, 0.0)),
            Some(noise) => {
                let force = gain * noise.intensity;
                let initial = match noise.initial {
                    InitialNoise::At(v) => (force * v, 0.0),
                    InitialNoise::Stationary => (0.0, force.abs() * noise.stationary_sd()),
                };
                (noise.relaxation_rate, force.abs() * noise.diffusion, initial)
            }
        };
        Scene {
            oscillator,
            friction: model.friction,
            initial_displacement: model.initial_displacement,
            harmonics,
            relaxation_rate,
            diffusion,
            initial_noise,
            force_per_temperature: gain,
        }
    }

    /// n(0) of a path.
    pub fn draw_initial_noise(&self, path: AddressedDraws) -> f64 {
        let (mean, sd) = self.initial_noise;
        if sd > 0.0 { mean + sd * path.for_start().normal() } else { mean }
    }

    /// What the noise moves b by until `end`, if that can change a force at all: not if it stays
    /// below the rounding of the others.
    pub fn felt_noise(&self, end: f64) -> Option<f64> {
        let forcing: f64 = self.harmonics.iter().map(|h| h.force.abs()).sum();
        let forces = self.friction.static_force + forcing + self.oscillator.stiffness * self.initial_displacement.abs();
        let wander = self.diffusion * end.min(0.5 / self.relaxation_rate).sqrt() + self.initial_noise.1;
        (wander > BELOW_ROUNDING * forces).then_some(wander)
    }

    /// B', from the terms of B.
    #[inline]
    pub fn forcing_slope(&self, terms: &[Complex]) -> f64 {
        -terms.iter().zip(&self.harmonics).map(|(p, h)| p.im * h.angular_frequency).sum::<f64>()
    }

    /// The terms K beta a e^{i (w t + phi)} of B at a time, from its definition.
    pub fn set_terms(&self, t: f64, terms: &mut [Complex]) {
        for (term, h) in terms.iter_mut().zip(&self.harmonics) {
            *term = h.force * Complex::unit(h.angular_frequency * t);
        }
    }
}

/// A relative size that is lost in a sum of doubles, with room for 7 standard deviations and for
/// thousands of steps.
const BELOW_ROUNDING: f64 = 1e-20;

/// B: the real part of its terms.
#[inline]
pub fn forcing(terms: &[Complex]) -> f64 {
    terms.iter().map(|p| p.re).sum()
}
