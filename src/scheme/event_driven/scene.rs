//! The constants of a noisy scene, with the noise measured as a force.
//!
//! n = K beta rho v is an Ornstein-Uhlenbeck process dn = -theta n dt + s dW with s = |K beta rho|
//! sigma. (The sign of beta only turns W.) In a static phase b = B(t) - K x + n with B = K beta
//! T_det, so the corridor of v becomes
//! |b| <= f_s; in a slip, m x'' = B(t) - K x - 2 alpha x' - eps f_d + n.

use super::ladder::{Ladder, Rung};
use super::two_noises::{Part, TwoNoises};
use crate::model::{Complex, Friction, InitialNoise, Model, Noise, Oscillator, Series};
use crate::noise::{AddressedDraws, Transition, bridge_at};
use std::sync::Arc;

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
    /// B(t); where the temperature was measured, the last one is the straight line of a cell (see
    /// [`Scene::set_line`]).
    pub harmonics: Vec<ForceHarmonic>,
    /// What was measured.
    pub series: Option<Arc<Series>>,
    /// Whether n is zero at every sample.
    pub is_pinned: bool,
    /// theta.
    pub relaxation_rate: f64,
    /// s: the diffusion of n.
    pub diffusion: f64,
    /// The law of n(0): its mean and standard deviation.
    pub initial_noise: (f64, f64),
    /// What n is the sum of, where there are two noises; theta and s are those of the sum inside a
    /// cell then.
    pub two_noises: Option<TwoNoises>,
    /// K beta: force per temperature.
    pub force_per_temperature: f64,
}

impl Scene {
    /// Of a model whose temperature has noise; without, n = 0 throughout.
    pub fn new(model: &Model) -> Self {
        let oscillator = model.oscillator;
        let gain = oscillator.force_per_temperature();
        let mut harmonics: Vec<_> = model
            .temperature
            .harmonics
            .iter()
            .map(|h| ForceHarmonic {
                force: Complex::unit(h.phase) * (gain * h.amplitude),
                angular_frequency: h.angular_frequency,
            })
            .collect();
        let series = model.temperature.series.clone();
        if let Some(series) = &series {
            let angular_frequency = LINE_ANGLE / series.longest_spacing();
            harmonics.push(ForceHarmonic { force: Complex::ZERO, angular_frequency });
        }
        let mut noises = model.temperature.noises();
        let (noise, two_noises) = match (noises.next(), noises.next()) {
            (Some(first), Some(second)) => {
                let both = TwoNoises::new([first, second], gain);
                (both.inside(), Some(both))
            }
            (Some(noise), None) => (part(&noise, gain), None),
            (None, _) => (Part { relaxation_rate: 1.0, diffusion: 0.0, initial: (0.0, 0.0) }, None),
        };
        Scene {
            oscillator,
            friction: model.friction,
            initial_displacement: model.initial_displacement,
            harmonics,
            series,
            is_pinned: model.temperature.is_pinned,
            relaxation_rate: noise.relaxation_rate,
            diffusion: noise.diffusion,
            initial_noise: noise.initial,
            two_noises,
            force_per_temperature: gain,
        }
    }

    /// n(0) of a path, and what of it is n2.
    pub fn draw_initial_noise(&self, path: AddressedDraws) -> (f64, f64) {
        if let Some(both) = &self.two_noises {
            let [first, second] = both.draw(path);
            return (first + second, second);
        }
        let (mean, sd) = self.initial_noise;
        (if sd > 0.0 { mean + sd * path.for_start().normal() } else { mean }, 0.0)
    }

    /// The rate of the noise that cells are to resolve.
    pub fn noise_rate(&self) -> f64 {
        self.two_noises.map_or(self.relaxation_rate, |both| both.rate())
    }

    /// What the noise moves b by until `end`, if that can change a force at all: not if it stays
    /// below the rounding of the others.
    pub fn felt_noise(&self, end: f64) -> Option<f64> {
        let harmonics: f64 = self.harmonics.iter().map(|h| h.force.abs()).sum();
        let measured = self.series.as_ref().map_or(0.0, |series| self.force_per_temperature.abs() * series.bound());
        let forcing = harmonics + measured;
        let forces = self.friction.static_force + forcing + self.oscillator.stiffness * self.initial_displacement.abs();
        let wander = self.diffusion * end.min(0.5 / self.relaxation_rate).sqrt() + self.initial_noise.1;
        (wander > BELOW_ROUNDING * forces).then_some(wander)
    }

    /// B', from the terms of B.
    #[inline]
    pub fn forcing_slope(&self, terms: &[Complex]) -> f64 {
        -terms.iter().zip(&self.harmonics).map(|(p, h)| p.im * h.angular_frequency).sum::<f64>()
    }

    /// B at t = 0.
    pub fn initial_forcing(&self) -> f64 {
        let harmonics: f64 = self.harmonics.iter().map(|h| h.force.re).sum();
        self.series.as_ref().map_or(harmonics, |series| harmonics + self.force_per_temperature * series.values()[0])
    }

    /// The cells for this scene, of at most this length: even ones, but where a sample cuts one.
    pub fn ladder(&self, longest: f64) -> Ladder {
        self.series.as_ref().map_or(Ladder::even(longest), |series| Ladder::cut(series, longest))
    }

    /// How n gets across a cell: freely, or, where it is pinned, on its way to zero at the sample
    /// ahead.
    pub fn transition(&self, rung: &Rung) -> Transition {
        let (theta, s) = (self.relaxation_rate, self.diffusion);
        match &self.series {
            Some(series) if self.is_pinned => {
                let ahead = (series.times()[rung.piece + 1] - rung.end).max(0.0);
                // The mean is that share of n, and zero from zero.
                let (decay, increment_sd) = bridge_at(theta, s, rung.length, ahead, (1.0, 0.0));
                Transition { decay, increment_sd }
            }
            _ => Transition::new(theta, s, rung.length),
        }
    }

    /// The term of the straight line that B is between two samples, at a time on it.
    ///
    /// A harmonic that turns by an angle y of at most 1e-8 goes straight: Re[(re + i im) e^{iy}] =
    /// re - im y, because cos y rounds to 1 and sin y to y. So a line needs no formulas of its own,
    /// and what is left of the harmonic's bend, y^2/2, is below rounding.
    pub fn set_line(&self, piece: usize, t: f64, terms: &mut [Complex]) {
        let (Some(series), Some(h), Some(term)) = (&self.series, self.harmonics.last(), terms.last_mut()) else {
            return;
        };
        let gain = self.force_per_temperature;
        *term = Complex::new(gain * series.on(piece, t), -(gain * series.slope(piece)) / h.angular_frequency);
    }

    /// The terms K beta a e^{i (w t + phi)} of B at a time, from its definition; not of the line.
    pub fn set_terms(&self, t: f64, terms: &mut [Complex]) {
        for (term, h) in terms.iter_mut().zip(&self.harmonics) {
            *term = h.force * Complex::unit(h.angular_frequency * t);
        }
    }
}

/// A noise, measured as a force.
pub fn part(noise: &Noise, gain: f64) -> Part {
    let force = gain * noise.intensity;
    let initial = match noise.initial {
        InitialNoise::At(v) => (force * v, 0.0),
        InitialNoise::Stationary => (0.0, force.abs() * noise.stationary_sd()),
    };
    Part { relaxation_rate: noise.relaxation_rate, diffusion: force.abs() * noise.diffusion, initial }
}

/// By how much the harmonic that stands for a line turns from sample to sample, at most.
const LINE_ANGLE: f64 = 1e-8;

/// A relative size that is lost in a sum of doubles, with room for 7 standard deviations and for
/// thousands of steps.
const BELOW_ROUNDING: f64 = 1e-20;

/// B: the real part of its terms.
#[inline]
pub fn forcing(terms: &[Complex]) -> f64 {
    terms.iter().map(|p| p.re).sum()
}
