//! One exact step of (x, x', n) in a sub-phase, given n at its end, for one path or for several in
//! lanes.

use super::first_stop::{Interval, KnownStep, SlipVelocity};
use super::scene::Scene;
use super::slip_transition::{DrivenOscillator, HarmonicResponse, SlipTransition};
use crate::lanes::Lanes;
use crate::model::{Complex, Oscillator};

/// x, x' and n at one time.
#[derive(Clone, Copy, Debug)]
pub struct SlipPoint<L = f64> {
    pub x: L,
    pub v: L,
    pub n: L,
}

/// A slip step of one length, with its coefficients.
#[derive(Clone, Debug)]
pub struct SlipStep {
    pub transition: SlipTransition,
    /// The square root of its length.
    pub root_length: f64,
    /// The response to each harmonic.
    pub harmonics: Vec<HarmonicResponse>,
}

impl SlipStep {
    /// The step of a length, for an oscillator with this number of harmonics.
    #[inline(always)]
    pub fn new(oscillator: &DrivenOscillator, harmonics: usize, length: f64) -> Self {
        let mut harmonics = vec![HarmonicResponse::none(); harmonics];
        let transition = oscillator.transition(length, &mut harmonics);
        SlipStep {
            transition,
            root_length: length.sqrt(),
            harmonics,
        }
    }

    /// Turns this step into that of another length.
    #[inline(always)]
    pub fn set_length(&mut self, oscillator: &DrivenOscillator, length: f64) {
        self.transition = oscillator.transition(length, &mut self.harmonics);
        self.root_length = length.sqrt();
    }

    pub fn length(&self) -> f64 {
        self.transition.length
    }

    /// The step between two places, with the motion there.
    #[inline(always)]
    pub fn between(
        &self,
        eps: f64,
        (x0, start): (f64, SlipVelocity),
        (x1, end): (f64, SlipVelocity),
    ) -> KnownStep {
        let length = self.length();
        let travel = resolved_travel(eps * x0, eps * x1, start, end, length);
        KnownStep {
            start,
            end,
            travel,
            length,
            root_length: self.root_length,
        }
    }

    /// The mean state at the end of the step, from a known start. `terms`, the terms of B, are
    /// moved from the start of the step to its end.
    #[inline(always)]
    pub fn mean(&self, start: SlipPoint, terms: &mut [Complex], friction: f64) -> SlipPoint {
        let mut mean = self.transition.free(start, friction);
        for (term, response) in terms.iter_mut().zip(&self.harmonics) {
            let push = response.push(*term);
            mean.x += push.x;
            mean.v += push.v;
            *term = push.term;
        }
        mean
    }
}

/// A remainder of a macro step that is shorter than this fraction of it takes no exact step: the
/// difference of n at both its ends, which such a step needs, would have lost its digits.
pub const SHORTEST: f64 = 1e-8;

/// The contribution of a harmonic to x and x' over a step, and its term of B at the end of the
/// step.
#[derive(Clone, Copy, Debug)]
pub struct Push<L = f64> {
    pub x: L,
    pub v: L,
    pub term: Complex<L>,
}

impl<L: Lanes> HarmonicResponse<L> {
    /// The contribution of a harmonic, from its term of B at the start of the step.
    #[inline(always)]
    pub fn push(&self, p: Complex<L>) -> Push<L> {
        let (x, v, (cos, sin)) = (self.x, self.v, self.turn);
        Push {
            x: p.re * x.0 - p.im * x.1,
            v: p.re * v.0 - p.im * v.1,
            term: Complex {
                re: p.re * cos - p.im * sin,
                im: p.re * sin + p.im * cos,
            },
        }
    }
}

impl<L: Lanes> SlipTransition<L> {
    /// The mean state after the step without the forcing: from the state at its start and the
    /// dynamic friction alone, with the noise n relaxing from its start.
    #[inline(always)]
    pub fn free(&self, start: SlipPoint<L>, friction: L) -> SlipPoint<L> {
        let [x, v] = [&self.x, &self.v];
        SlipPoint {
            x: x[0].mul_add(
                start.x,
                x[1].mul_add(start.v, x[2].mul_add(start.n, -(x[3] * friction))),
            ),
            v: v[0].mul_add(
                start.x,
                v[1].mul_add(start.v, v[2].mul_add(start.n, -(v[3] * friction))),
            ),
            n: self.n * start.n,
        }
    }

    /// Draws the state after the step, given its mean and n at the end, with one normal for x' and
    /// one for x.
    #[inline(always)]
    pub fn drawn(&self, mean: SlipPoint<L>, n: L, [b, c]: [L; 2]) -> SlipPoint<L> {
        let [v_on_n, v_sd, x_on_n, x_on_v, x_sd] = self.given_noise;
        let a = n - mean.n;
        SlipPoint {
            x: x_on_n.mul_add(a, x_on_v.mul_add(b, x_sd.mul_add(c, mean.x))),
            v: v_on_n.mul_add(a, v_sd.mul_add(b, mean.v)),
            n,
        }
    }
}

/// b = K (beta T - x) - 2 alpha x', where `forcing` is the part B of K beta T without noise.
#[inline(always)]
pub fn force<L: Lanes>(body: &Oscillator, forcing: L, state: SlipPoint<L>) -> L {
    forcing + state.n - state.x * body.stiffness - state.v * (2.0 * body.damping)
}

/// eps x' and its derivative, from the force b and the friction force `friction` = eps f_d.
#[inline(always)]
pub fn motion<L: Lanes>(body: &Oscillator, eps: L, v: L, force: L, friction: L) -> SlipVelocity<L> {
    SlipVelocity {
        velocity: eps * v,
        acceleration: eps * (force - friction) * (1.0 / body.mass),
    }
}

/// The length of a step, in the forms that the search for its stop needs.
#[derive(Clone, Copy)]
pub struct Extent<L> {
    /// h.
    pub length: L,
    /// 1/h.
    pub inverse: L,
    /// c sqrt(h).
    pub noise: L,
}

impl<L: Lanes> Extent<L> {
    /// The extent of a step of this length, for noise of intensity c.
    #[inline(always)]
    pub fn new(length: L, c: f64) -> Self {
        Extent {
            length,
            inverse: L::splat(1.0) / length,
            noise: length.sqrt() * c,
        }
    }

    /// A step between two states, each with its b: the motion at its start, and the interval that
    /// is searched for a stop.
    #[inline(always)]
    pub fn between(
        self,
        scene: &Scene,
        eps: L,
        (start, start_force): (&SlipPoint<L>, L),
        (end, end_force): (&SlipPoint<L>, L),
    ) -> (SlipVelocity<L>, Interval<L>) {
        let Extent {
            length,
            inverse,
            noise,
        } = self;
        let (body, friction) = (&scene.oscillator, eps * scene.friction.dynamic_force);
        let first = motion(body, eps, start.v, start_force, friction);
        let last = motion(body, eps, end.v, end_force, friction);
        let travel = resolved_travel(eps * start.x, eps * end.x, first, last, length);
        (
            first,
            Interval {
                end: last,
                travel,
                length,
                inverse,
                noise,
            },
        )
    }
}

/// The distance x1 - x0. Where rounding of x0 and x1 hides the difference (far from x = 0, or in a
/// very short step), it is the distance that the cubic through the motion at both ends covers.
#[inline(always)]
pub fn resolved_travel<L: Lanes>(
    x0: L,
    x1: L,
    start: SlipVelocity<L>,
    end: SlipVelocity<L>,
    h: L,
) -> L {
    let travel = x1 - x0;
    let slopes = (start.velocity + end.velocity) * 0.5;
    let cubic = h * (slopes + h * (1.0 / 12.0) * (start.acceleration - end.acceleration));
    let rounding = (x0.abs() + x1.abs()) * f64::EPSILON;
    L::select((travel - cubic).abs().le(rounding), cubic, travel)
}
