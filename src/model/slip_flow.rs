//! One sub-phase in closed form: displacement, velocity and force while the sign of x' is known and
//! the forcing is a sum of exponentials.
//!
//! On a sub-phase of sign eps, with F_j e^{z_j t} the terms of K beta T(t)/m (z_j = i w_j for a
//! harmonic),
//!
//! ```text
//! x'' + 2 gamma x' + w0^2 x = sum_j Re[F_j e^{z_j t}] - eps f_d / m,      x'(t0) = 0.
//! ```
//!
//! Let r = t - t0, P_j = F_j e^{z_j t0}, a0 = (b(t0) - eps f_d)/m. The displacement since t0 is y =
//! x - x(t0), which starts at y = y' = 0. It satisfies the same equation with the right-hand side
//! a0 + sum_j Re[P_j (e^{z_j r} - 1)]. So with S and G_z of [`ImpulseResponse`]
//!
//! ```text
//! y   = a0 G_0 + sum_j Re[P_j (G_{z_j} - G_0)]
//! y'  = a0 S   + sum_j Re[P_j z_j G_{z_j}]
//! y'' = a0 S'  + sum_j Re[P_j z_j G_{z_j}']
//! b   = m y'' + eps f_d
//! ```
//!
//! A trend, or a measured temperature, adds a straight line of slope c to K beta T/m, and a
//! sub-phase that continues after a sample begins there with a velocity v0. Both add
//!
//! ```text
//! y += v0 (S + 2 gamma G_0) + c R,   R = int_0^r G_0,   R' = G_0,   R'' = S
//! ```
//!
//! Only increments are computed, so slow forcing and small slips lose no digits, and x'' at the
//! start is exactly a0. The force is computed from x'', not from K (beta T - x), so it keeps its
//! digits where the motion has decayed below the rounding of x.

use super::complex::Complex;
use super::impulse_response::ImpulseResponse;
use super::{Oscillator, Problem, Sign};

/// One term Re[F e^{z t}] of the forcing K beta T / m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForcingTerm {
    /// F, at t = 0.
    pub amplitude: Complex,
    /// z: i w for a harmonic, -theta for the mean of a noise that relaxes.
    pub rate: Complex,
}

/// The oscillator, with its forcing as a sum of exponentials.
#[derive(Clone, Debug)]
pub struct ForcedOscillator {
    free: ImpulseResponse,
    oscillator: Oscillator,
    /// F_j and z_j of each term.
    pub terms: Vec<ForcingTerm>,
    /// sum_j |F_j| |z_j|^2 >= |(K beta T / m)''| at every time.
    pub forcing_curvature: f64,
}

/// The motion of one sub-phase, from its start.
#[derive(Clone, Debug)]
pub struct SlipFlow<'a> {
    body: &'a ForcedOscillator,
    /// x''(t0).
    pub start_acceleration: f64,
    start_velocity: f64,
    /// P_j.
    terms: &'a [Complex],
    /// c.
    line: f64,
}

/// The state of a sub-phase at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipState {
    /// x - x(t0).
    pub displacement: f64,
    /// x'.
    pub velocity: f64,
    /// x''.
    pub acceleration: f64,
    /// x'''.
    pub jerk: f64,
}

impl ForcedOscillator {
    /// The model without its diffusion: the harmonics, and v relaxing from `noise_start` if that is
    /// not zero.
    pub fn new(model: &Problem, noise_start: f64) -> Self {
        let oscillator = model.oscillator;
        let w0 = oscillator.natural_frequency();
        let gain = oscillator.force_per_temperature() / oscillator.mass;
        let mut terms: Vec<_> = model
            .temperature
            .harmonics
            .iter()
            .map(|h| ForcingTerm {
                amplitude: Complex::unit(h.phase) * (gain * h.amplitude),
                rate: Complex::new(0.0, h.angular_frequency),
            })
            .collect();
        if let Some(noise) = model
            .temperature
            .effective_noise()
            .filter(|n| n.intensity * noise_start != 0.0)
        {
            terms.push(ForcingTerm {
                amplitude: Complex::new(gain * noise.intensity * noise_start, 0.0),
                rate: Complex::new(-noise.relaxation_rate, 0.0),
            });
        }
        // The sum starts from +0, because the sum of no terms would be -0, and a distance divided
        // by -0 is -infinity.
        let forcing_curvature = terms.iter().fold(0.0, |sum, t| {
            sum + t.amplitude.abs() * t.rate.abs() * t.rate.abs()
        });
        let free = ImpulseResponse::new(oscillator.damping_rate(), w0);
        ForcedOscillator {
            free,
            oscillator,
            terms,
            forcing_curvature,
        }
    }

    /// The time for which a bound of [`SlipFlow::jerk_bound`] holds: infinite unless gamma < 0.
    pub fn bounded_for(&self) -> f64 {
        let rate = self.oscillator.damping_rate();
        if rate < 0.0 {
            -0.5 / rate
        } else {
            f64::INFINITY
        }
    }

    /// An upper bound of |K beta T / m| at every time.
    pub fn forcing_size(&self) -> f64 {
        self.terms.iter().map(|t| t.amplitude.abs()).sum()
    }

    /// The sub-phase of sign `direction` that starts with x' = `velocity` and b = `force`, where
    /// the forcing is given by `terms`, the P_j, and by a line of slope `line`.
    pub fn slip<'a>(
        &'a self,
        (terms, line): (&'a [Complex], f64),
        velocity: f64,
        force: f64,
        direction: Sign,
        dynamic_force: f64,
    ) -> SlipFlow<'a> {
        let friction = direction.value() * dynamic_force;
        let start_acceleration = (force - friction) / self.oscillator.mass;
        SlipFlow {
            body: self,
            start_acceleration,
            start_velocity: velocity,
            terms,
            line,
        }
    }

    /// The increment, first and second derivative of K beta T / m over a time r, from a time at
    /// which the terms are `terms`, on a line of slope `line`.
    pub fn forcing_increment(&self, (terms, line): (&[Complex], f64), r: f64) -> [f64; 3] {
        let mut sum = [line * r, line, 0.0];
        for (term, p) in self.terms.iter().zip(terms) {
            let growth = (term.rate * r).exp_m1();
            let slope = *p * term.rate * (Complex::ONE + growth);
            sum[0] += (*p * growth).re;
            sum[1] += slope.re;
            sum[2] += (slope * term.rate).re;
        }
        sum
    }
}

impl SlipFlow<'_> {
    /// The state a time r after the start.
    pub fn at(&self, r: f64) -> SlipState {
        let ForcedOscillator {
            free,
            oscillator,
            terms,
            ..
        } = self.body;
        let w0_squared = oscillator.stiffness / oscillator.mass;
        let two_gamma = 2.0 * oscillator.damping / oscillator.mass;
        let (settled, impulse) = (free.exponential(Complex::ZERO, r).re, free.impulse(r));
        let mut displacement = self.start_acceleration * settled;
        let mut velocity = self.start_acceleration * impulse;
        let mut acceleration = self.start_acceleration * free.impulse_slope(r);
        if self.line != 0.0 {
            displacement += self.line * free.ramp(r);
            velocity += self.line * settled;
            acceleration += self.line * impulse;
        }
        if self.start_velocity != 0.0 {
            let v0 = self.start_velocity;
            displacement += v0 * (impulse + two_gamma * settled);
            velocity += v0 * (free.impulse_slope(r) + two_gamma * impulse);
            acceleration -= v0 * w0_squared * impulse;
        }
        for (term, p) in terms.iter().zip(self.terms) {
            displacement += (*p * free.exponential_from_zero(term.rate, r)).re;
            let (push, response) = (*p * term.rate, free.exponential(term.rate, r));
            velocity += (push * response).re;
            acceleration += (push * free.exponential_slope(term.rate, r, response, impulse)).re;
        }
        let [_, forcing_slope, _] = self.body.forcing_increment((self.terms, self.line), r);
        let jerk = forcing_slope - w0_squared * velocity - two_gamma * acceleration;
        SlipState {
            displacement,
            velocity,
            acceleration,
            jerk,
        }
    }

    /// Bounds of |x'''| after a state: at a time u later |x'''| is at most `bound.0 + bound.1 u`.
    ///
    /// q = x'' satisfies q'' + 2 gamma q' + w0^2 q = (K beta T / m)''. Its energy norm sqrt(q'^2 +
    /// w0^2 q^2) >= |x'''| grows at most at the rate of the right-hand side, because damping only
    /// reduces it. This holds for any damping and across resonance, where bounds from the
    /// amplitudes of the modes would be useless.
    ///
    /// Negative damping, gamma < 0, lets the norm grow by the factor e^{2 |gamma| u}. The bounds
    /// then hold for [`ForcedOscillator::bounded_for`], in which this factor is e.
    pub fn jerk_bound(&self, state: &SlipState) -> (f64, f64) {
        let w0 = self.body.oscillator.natural_frequency();
        let growth = if self.body.oscillator.damping < 0.0 {
            std::f64::consts::E
        } else {
            1.0
        };
        (
            growth * libm::hypot(state.jerk, w0 * state.acceleration),
            growth * self.body.forcing_curvature,
        )
    }

    /// A bound of |x''''|, where `bend` bounds the energy norm of [`SlipFlow::jerk_bound`]. It
    /// follows from the equation of q, solved for q''.
    pub fn snap_bound(&self, bend: f64) -> f64 {
        let Oscillator { mass, damping, .. } = self.body.oscillator;
        let rate = 2.0 * damping.abs() / mass + self.body.oscillator.natural_frequency();
        self.body.forcing_curvature + rate * bend
    }
}
