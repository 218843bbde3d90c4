//! The constants of a scene with noise, where the noise is measured as a force.
//!
//! n = K beta rho v is an Ornstein-Uhlenbeck process dn = -theta n dt + s dW with s = |K beta rho|
//! sigma. (The sign of beta only changes the sign of W.) In a static phase b = B(t) - K x + n with
//! B = K beta T_det, and the phase lasts while |b| <= f_s. In a slip, m x'' = B(t) - K x - 2 alpha
//! x' - eps f_d + n.
//!
//! A user-defined force, g(x, x', t), is added to b in both. Where friction has a load, or the
//! force a direction, other forces take its place in slips, and each threshold of a stick has its
//! own limit ([`Force::hold`]).

use super::super::user_force::UserForce;
use super::step_grid::{MacroStepPlace, StepGrid};
use super::stick_band::{Limit, Limits};
use super::two_noises::{OneNoise, TwoNoises};
use crate::lanes::Lanes;
use crate::model::{
    Complex, Friction, InitialNoise, OrnsteinUhlenbeck, Oscillator, Problem, Series, Sign,
    Temperature,
};
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
    /// f_s and f_d as they are simulated; the scheme may raise f_s (see
    /// [`super::step_rules::StepRules::added_gap`]).
    pub friction: Friction,
    /// x(0).
    pub initial_displacement: f64,
    pub initial_velocity: f64,
    /// The harmonics of B(t). Where the temperature has a constant or a trend, or was measured, the
    /// last one represents the straight line of the current macro step (see [`Scene::set_line`]).
    pub harmonics: Vec<ForceHarmonic>,
    /// The constant and the slope of B(t) that do not change from macro step to macro step.
    line: Option<[f64; 2]>,
    /// The measured temperature, if there is one.
    pub series: Option<Arc<Series>>,
    /// Whether n is set to zero at every sample of the measured temperature.
    pub is_pinned: bool,
    /// theta, the relaxation rate of n.
    pub relaxation_rate: f64,
    /// s, the diffusion of n.
    pub diffusion: f64,
    /// The law of n(0): its mean and standard deviation.
    pub initial_noise: (f64, f64),
    /// The two noises whose sum is n, if there are two. Then `relaxation_rate` and `diffusion` are
    /// those of the single process that stands for the sum inside a macro step.
    pub two_noises: Option<TwoNoises>,
    /// K beta: force per unit of temperature.
    pub force_per_temperature: f64,
    /// g.
    pub own: UserForce,
}

/// The maximum length of a macro step, in sticks with their slips.
const MOST_CASCADES: f64 = 64.0;

impl Scene {
    /// T where the forcing and n have these values.
    #[inline(always)]
    pub fn temperature<L: Lanes>(&self, forcing: f64, noise: L) -> L {
        (noise + forcing) / L::splat(self.force_per_temperature)
    }

    /// The constants of a model. Without noise in its temperature, n = 0 throughout.
    pub fn new(model: &Problem) -> Self {
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
        let Temperature { offset, trend, .. } = model.temperature;
        let series = model.temperature.series.clone();
        let line = model
            .temperature
            .has_line()
            .then_some([gain * offset, gain * trend]);
        let mut noises = model.temperature.effective_noises();
        let (noise, two_noises) = match (noises.next(), noises.next()) {
            (Some(first), Some(second)) => {
                let both = TwoNoises::new([first, second], gain);
                (both.inside(), Some(both))
            }
            (Some(noise), None) => (one_noise(&noise, gain), None),
            (None, _) => (
                OneNoise {
                    relaxation_rate: 1.0,
                    diffusion: 0.0,
                    initial: (0.0, 0.0),
                },
                None,
            ),
        };
        // A macro step lasts at most from sample to sample, and at most the correlation time of the
        // noise.
        let longest = series.as_ref().map(|series| series.longest_spacing());
        if let Some(longest) = longest.or(line.map(|_| 1.0 / noise.relaxation_rate)) {
            harmonics.push(ForceHarmonic {
                force: Complex::ZERO,
                angular_frequency: LINE_ANGLE / longest,
            });
        }
        Scene {
            oscillator,
            friction: model.friction,
            initial_displacement: model.initial_displacement,
            initial_velocity: model.initial_velocity,
            harmonics,
            line,
            series,
            is_pinned: model.temperature.is_pinned,
            relaxation_rate: noise.relaxation_rate,
            diffusion: noise.diffusion,
            initial_noise: noise.initial,
            two_noises,
            force_per_temperature: gain,
            own: UserForce::of(model),
        }
    }

    /// The limits of b and of -b in a stick.
    #[inline(always)]
    pub fn limits(&self, x: f64, time: f64) -> [f64; 2] {
        let f_s = self.friction.static_force;
        if self.own.has_load() {
            self.own.hold(x, time).excess.map(|excess| f_s + excess)
        } else {
            [f_s; 2]
        }
    }

    /// The limits where they are f_s at both ends of a piece.
    #[inline(always)]
    pub fn constant_limits<L: Lanes>(&self) -> [Limits<L>; 2] {
        [[Limit {
            value: L::splat(self.friction.static_force),
            curvature: L::splat(0.0),
        }; 2]; 2]
    }

    /// b at rest in a slip in this direction, from b in a stick there.
    #[inline(always)]
    pub fn slipping(&self, direction: Sign, held: f64, x: f64, time: f64) -> f64 {
        if self.own.has_load() {
            held + self.own.at(Some(direction), x, 0.0, time) - self.own.hold(x, time).pull
        } else {
            held
        }
    }

    /// b in a stick, from b at rest in a slip in this direction there.
    #[inline(always)]
    pub fn held(&self, direction: Sign, slipping: f64, x: f64, time: f64) -> f64 {
        if self.own.has_load() {
            slipping - self.own.at(Some(direction), x, 0.0, time) + self.own.hold(x, time).pull
        } else {
            slipping
        }
    }

    /// K x - g(x, 0, t): the force that holds against B and n in a stick.
    #[inline(always)]
    pub fn spring(&self, x: f64, time: f64) -> f64 {
        self.oscillator.stiffness * x - self.own.hold(x, time).pull
    }

    /// The same in lanes, where friction has no load and the force no direction.
    #[inline(always)]
    pub fn spring_at<L: Lanes>(&self, x: L, time: L) -> L {
        let spring = x * self.oscillator.stiffness;
        if !self.own.is_some() {
            return spring;
        }
        let mut pull = [spring];
        let at = [&[x][..], &[L::splat(0.0)], &[time]];
        self.own.at_points(Sign::Positive, at, &mut pull);
        spring - pull[0]
    }

    /// Draws n(0) of a path. Returns n(0) and the part of it that belongs to the second noise (0 if
    /// there is only one).
    pub fn draw_initial_noise(&self, path: AddressedDraws) -> (f64, f64) {
        if let Some(both) = &self.two_noises {
            let [first, second] = both.draw(path);
            return (first + second, second);
        }
        let (mean, sd) = self.initial_noise;
        (
            if sd > 0.0 {
                mean + sd * path.for_start().normal()
            } else {
                mean
            },
            0.0,
        )
    }

    /// The relaxation rate that the length of a macro step must resolve. With two noises it is
    /// larger than either theta (see [`TwoNoises::rate`]).
    pub fn noise_rate(&self) -> f64 {
        self.two_noises
            .map_or(self.relaxation_rate, |both| both.rate())
    }

    /// The longest macro step with a bounded amount of work, however slowly the noise relaxes.
    ///
    /// A path crosses the last macro step to its end, also beyond the end of the run, because no
    /// event depends on the end. In a macro step as long as 1/theta, a noise that hardly relaxes
    /// crosses the stick band any number of times. It takes (f_s/s)^2 to cross it, and a slip takes
    /// 1/w0.
    pub fn longest_macro_step(&self) -> f64 {
        let (f_s, w0) = (
            self.friction.static_force,
            self.oscillator.natural_frequency(),
        );
        let crossing = f_s / self.diffusion;
        let cascade = crossing * crossing + if w0 > 0.0 { 1.0 / w0 } else { f64::INFINITY };
        if cascade > 0.0 {
            MOST_CASCADES * cascade
        } else {
            f64::INFINITY
        }
    }

    /// The size of the changes of b due to the noise until `end`; none if they vanish in the
    /// rounding of the other forces.
    pub fn felt_noise(&self, end: f64) -> Option<f64> {
        let harmonics: f64 = self.harmonics.iter().map(|h| h.force.abs()).sum();
        let measured = self.series.as_ref().map_or(0.0, |series| {
            self.force_per_temperature.abs() * series.bound()
        });
        let line = self
            .line
            .map_or(0.0, |[offset, trend]| offset.abs() + trend.abs() * end);
        let forcing = harmonics + measured + line;
        let forces = self.friction.static_force
            + forcing
            + self.oscillator.stiffness * self.initial_displacement.abs();
        let wander =
            self.diffusion * end.min(0.5 / self.relaxation_rate).sqrt() + self.initial_noise.1;
        (wander > BELOW_ROUNDING * forces).then_some(wander)
    }

    /// B', computed from the terms of B.
    #[inline]
    pub fn forcing_slope(&self, terms: &[Complex]) -> f64 {
        -terms
            .iter()
            .zip(&self.harmonics)
            .map(|(p, h)| p.im * h.angular_frequency)
            .sum::<f64>()
    }

    /// B at t = 0.
    pub fn initial_forcing(&self) -> f64 {
        let harmonics: f64 = self.harmonics.iter().map(|h| h.force.re).sum();
        let line = self
            .line
            .map_or(harmonics, |[offset, _]| harmonics + offset);
        self.series.as_ref().map_or(line, |series| {
            line + self.force_per_temperature * series.values()[0]
        })
    }

    /// The macro steps for this scene, each of at most this length. All have the same length,
    /// except that a macro step also ends at every sample of a measured temperature and at every
    /// kink of g.
    pub fn grid(&self, longest: f64, end: f64) -> StepGrid {
        let samples = self
            .series
            .as_ref()
            .map_or(&[][..], |series| series.times());
        let kinks = self.own.kinks(end, longest);
        let mut cuts = [&[0.0], samples, &kinks].concat();
        cuts.retain(|time| *time >= 0.0 && time.is_finite());
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        if cuts.len() < 2 {
            StepGrid::even(longest)
        } else {
            StepGrid::cut(cuts, longest)
        }
    }

    /// The transition of n over a macro step: that of a free Ornstein-Uhlenbeck process, or, where
    /// the noise is pinned, that of a bridge to zero at the next sample.
    pub fn transition(&self, place: &MacroStepPlace) -> Transition {
        let (theta, s) = (self.relaxation_rate, self.diffusion);
        match &self.series {
            Some(series) if self.is_pinned => {
                let ahead = (series.times()[series.piece(place.sample) + 1] - place.end).max(0.0);
                // The mean of the bridge is `decay` times n, because its other end is zero.
                let (decay, increment_sd) = bridge_at(theta, s, place.length, ahead, (1.0, 0.0));
                Transition {
                    decay,
                    increment_sd,
                }
            }
            _ => Transition::new(theta, s, place.length),
        }
    }

    /// Sets the last term to that of the straight line in B, at a time on this line: the constant
    /// and the trend, and the measured temperature after this sample.
    ///
    /// The line is represented as a harmonic that turns by a very small angle y, of at most 1e-8.
    /// Such a harmonic is a straight line to rounding: Re[(re + i im) e^{iy}] = re - im y, because
    /// cos y rounds to 1 and sin y to y. So a line needs no separate formulas; the remaining
    /// curvature, y^2/2, is below rounding.
    pub fn set_line(&self, sample: f64, t: f64, terms: &mut [Complex]) {
        if self.series.is_none() && self.line.is_none() {
            return;
        }
        let (Some(h), Some(term)) = (self.harmonics.last(), terms.last_mut()) else {
            return;
        };
        let gain = self.force_per_temperature;
        let measured = |series: &Arc<Series>| {
            let piece = series.piece(sample);
            (gain * series.on(piece, t), gain * series.slope(piece))
        };
        let (mut value, mut slope) = self.series.as_ref().map_or((0.0, 0.0), measured);
        if let Some([offset, trend]) = self.line {
            (value, slope) = (value + (offset + trend * t), slope + trend);
        }
        *term = Complex::new(value, -slope / h.angular_frequency);
    }

    /// Sets the terms K beta a e^{i (w t + phi)} of B at a time, each from its definition. The term
    /// of a straight line is set by [`Scene::set_line`].
    pub fn set_terms(&self, t: f64, terms: &mut [Complex]) {
        for (term, h) in terms.iter_mut().zip(&self.harmonics) {
            *term = h.force * Complex::unit(h.angular_frequency * t);
        }
    }
}

/// One noise, measured as a force. `gain` is K beta.
pub fn one_noise(noise: &OrnsteinUhlenbeck, gain: f64) -> OneNoise {
    let force = gain * noise.intensity;
    let initial = match noise.initial {
        InitialNoise::At(v) => (force * v, 0.0),
        InitialNoise::Stationary => (0.0, force.abs() * noise.stationary_sd()),
    };
    OneNoise {
        relaxation_rate: noise.relaxation_rate,
        diffusion: force.abs() * noise.diffusion,
        initial,
    }
}

/// The largest angle by which the harmonic that represents a straight line turns from sample to
/// sample.
const LINE_ANGLE: f64 = 1e-8;

/// A relative size that is lost in a sum of doubles, with room for fluctuations of 7 standard
/// deviations and for thousands of steps.
const BELOW_ROUNDING: f64 = 1e-20;

/// B, the sum of the real parts of its terms.
#[inline]
pub fn forcing(terms: &[Complex]) -> f64 {
    terms.iter().map(|p| p.re).sum()
}
