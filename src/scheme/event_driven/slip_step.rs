//! One exact step of (x, x', n) in a sub-phase, given n at its end, for one path or for several in
//! lanes.

use super::first_stop::Motion;
use super::slip_transition::{HarmonicResponse, SlipTransition};
use crate::lanes::Lanes;
use crate::model::{Complex, Oscillator};

/// x, x' and n at one time.
#[derive(Clone, Copy, Debug)]
pub struct SlipState<L = f64> {
    pub x: L,
    pub v: L,
    pub n: L,
}

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
            term: Complex { re: p.re * cos - p.im * sin, im: p.re * sin + p.im * cos },
        }
    }
}

impl<L: Lanes> SlipTransition<L> {
    /// The mean state after the step without the forcing: from the state at its start and the
    /// dynamic friction alone, with the noise n relaxing from its start.
    #[inline(always)]
    pub fn free(&self, start: SlipState<L>, friction: L) -> SlipState<L> {
        let [x, v] = [&self.x, &self.v];
        SlipState {
            x: x[0].mul_add(start.x, x[1].mul_add(start.v, x[2].mul_add(start.n, -(x[3] * friction)))),
            v: v[0].mul_add(start.x, v[1].mul_add(start.v, v[2].mul_add(start.n, -(v[3] * friction)))),
            n: self.n * start.n,
        }
    }

    /// Draws the state after the step, given its mean and n at the end, with one normal for x' and
    /// one for x.
    #[inline(always)]
    pub fn drawn(&self, mean: SlipState<L>, n: L, [b, c]: [L; 2]) -> SlipState<L> {
        let [v_on_n, v_sd, x_on_n, x_on_v, x_sd] = self.given_noise;
        let a = n - mean.n;
        SlipState {
            x: x_on_n.mul_add(a, x_on_v.mul_add(b, x_sd.mul_add(c, mean.x))),
            v: v_on_n.mul_add(a, v_sd.mul_add(b, mean.v)),
            n,
        }
    }
}

/// b = K (beta T - x) - 2 alpha x', where `forcing` is the part B of K beta T without noise.
#[inline(always)]
pub fn force<L: Lanes>(body: &Oscillator, forcing: L, state: SlipState<L>) -> L {
    forcing + state.n - state.x * body.stiffness - state.v * (2.0 * body.damping)
}

/// eps x' and its derivative, from the force b and the friction force `friction` = eps f_d.
#[inline(always)]
pub fn motion<L: Lanes>(body: &Oscillator, eps: L, v: L, force: L, friction: L) -> Motion<L> {
    Motion { velocity: eps * v, acceleration: eps * (force - friction) * (1.0 / body.mass) }
}

/// The distance x1 - x0. Where rounding of x0 and x1 hides the difference (far from x = 0, or in a
/// very short step), it is the distance that the cubic through the motion at both ends covers.
#[inline(always)]
pub fn resolved_travel<L: Lanes>(x0: L, x1: L, start: Motion<L>, end: Motion<L>, h: L) -> L {
    let travel = x1 - x0;
    let slopes = (start.velocity + end.velocity) * 0.5;
    let cubic = h * (slopes + h * (1.0 / 12.0) * (start.acceleration - end.acceleration));
    let rounding = (x0.abs() + x1.abs()) * f64::EPSILON;
    L::select((travel - cubic).abs().le(rounding), cubic, travel)
}
