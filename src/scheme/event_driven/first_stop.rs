//! The first zero of the velocity inside a slip step whose two ends are known.
//!
//! Let V = eps x' and a = V' on a step [0, h]. To leading order in h (fastest rate), V given its ends (V0, a0), (V1, a1) is an
//! integrated Brownian motion of acceleration noise c = s/m, conditioned at both ends:
//!
//! ```text
//! E V(u) = the cubic Hermite interpolant,      with r = h - u:
//! Var V(u) = c^2 u^3 r^3/(3 h^3),   Var(a(u) | V(u)) = c^2 u r/(4 h),   E(da | dV) = 3 (r - u)/(2 u r) dV
//! ```
//!
//! (the inverse of the sum of the two one-sided precisions [12/u^3, 6/u^2; 6/u^2, 4/u]). At the midpoint dV and da are
//! independent with sd c h^{3/2}/sqrt 192 and c h^{1/2}/4. So a path on [0, h] can be refined where it matters, by drawing
//! midpoints, and left alone where it does not (recursive conditional bisection). Scanning from the left, an interval is
//!
//! - *clear* if the interpolant stays `caution` standard deviations above zero: its Bezier control points V0, V0 + h a0/3,
//!   V1 - h a1/3, V1 bound it, and sd V <= 0.0722 c h^{3/2}. Where the slip starts, V0 = 0: there V/u is bounded by a0,
//!   3 V1/(2h) - a1/2, V1/h, and sd V/u <= 0.1875 c h^{1/2};
//! - a *stop* if V1 <= 0 and the slope is `caution` standard deviations below zero all along: control points a0,
//!   3 (V1 - V0)/h - a0 - a1, a1, and sd a <= 0.289 c h^{1/2}. Then there is one zero, near that of the interpolant;
//! - otherwise bisected.
//!
//! A slip starts with V = 0 and a = (f_s - f_d)/m; noise turns it back within h* = (a/c)^2. Bisection goes there by itself,
//! so that micro-slips are resolved in law. The recursion ends because at small enough h any V0 > 0 or a0 > 0 is clear; a
//! tangency is cut off at 2^-DEPTH h.

use super::draws::Draws;

/// The velocity eps x' and its derivative at one time.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// V.
    pub velocity: f64,
    /// a.
    pub acceleration: f64,
}

/// A stop: the first zero of V.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    /// u: time since the start of the step.
    pub after: f64,
    /// a there.
    pub acceleration: f64,
    /// int_0^u V: the way made since the start of the step, drawn from its law.
    pub way: f64,
}

/// c, and how cautious to be.
#[derive(Clone, Copy, Debug)]
pub struct StopSearch {
    /// c = s/m.
    pub noise: f64,
    /// How many standard deviations count as never.
    pub caution: f64,
}

/// Halvings of a step; 2^-40 of it is far below the time scale of any micro-slip.
const DEPTH: usize = 40;

/// max sqrt(u^3 r^3/3) for h = 1: sqrt(1/192).
const VELOCITY_SPREAD: f64 = 0.072_168_783_648_703_22;

/// max sqrt(u (1-u)^3/3) for h = 1, at u = 1/4: 3/16.
const START_SPREAD: f64 = 0.1875;

/// max sd a(u) for h = 1: 1/sqrt 12, at u = (1 -+ 1/sqrt 3)/2.
const SLOPE_SPREAD: f64 = 0.288_675_134_594_812_9;

/// 2^{-1/2}.
const ROOT_HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

impl StopSearch {
    /// The first zero of V in a step of length h, or none. V0 >= 0; V0 = 0 only where a sub-phase starts.
    #[inline]
    pub fn first(&self, start: Motion, end: Motion, h: f64, root_h: f64, draws: &mut Draws) -> Option<Stop> {
        let noise = self.noise * root_h;
        if self.is_clear(start, end, h, noise) {
            return None;
        }
        self.bisect(start, end, h, noise, draws)
    }

    /// The scan. `noise` is c sqrt(h).
    fn bisect(&self, start: Motion, end: Motion, h: f64, noise: f64, draws: &mut Draws) -> Option<Stop> {
        // Right ends still to be reached, the nearest on top, each with its number of halvings.
        let mut pending = [(end, 0usize); DEPTH + 1];
        let mut top = 0;
        let (mut left, mut u) = (start, 0.0);
        // The way so far, and the variance of what the interpolants leave out of it.
        let (mut way, mut spread): (f64, f64) = (0.0, 0.0);
        let (mut lengths, mut noises) = ([h; DEPTH + 1], [noise; DEPTH + 1]);
        for k in 1..=DEPTH {
            lengths[k] = 0.5 * lengths[k - 1];
            noises[k] = ROOT_HALF * noises[k - 1];
        }
        loop {
            let (right, depth) = pending[top];
            let (length, noise) = (lengths[depth], noises[depth]);
            let clear = self.is_clear(left, right, length, noise);
            if !clear && self.is_stop(left, right, length, noise) {
                let stop = zero(left, right, length, noise, draws);
                let way = way + stop.way + spread.sqrt() * draws.normal();
                return Some(Stop { after: u + stop.after, way, ..stop });
            }
            if clear || depth == DEPTH {
                if !clear && right.velocity <= 0.0 {
                    // A tangency below the resolution: a straight line.
                    let part = left.velocity / (left.velocity - right.velocity);
                    let part = if part.is_finite() { part } else { 0.0 };
                    return Some(Stop {
                        after: u + part * length,
                        acceleration: left.acceleration + part * (right.acceleration - left.acceleration),
                        way,
                    });
                }
                way += interpolant_way(left, right, length);
                spread += left_out(length, self.noise);
                u += length;
                left = right;
                if top == 0 {
                    return None;
                }
                top -= 1;
                continue;
            }
            let (dv, da) = (draws.normal(), draws.normal());
            let middle = Motion {
                velocity: 0.5 * (left.velocity + right.velocity)
                    + 0.125 * length * (left.acceleration - right.acceleration)
                    + VELOCITY_SPREAD * noise * length * dv,
                acceleration: 1.5 * (right.velocity - left.velocity) / length
                    - 0.25 * (left.acceleration + right.acceleration)
                    + 0.25 * noise * da,
            };
            pending[top] = (right, depth + 1);
            top += 1;
            pending[top] = (middle, depth + 1);
        }
    }

    #[inline]
    fn is_clear(&self, left: Motion, right: Motion, h: f64, noise: f64) -> bool {
        let (v0, a0, v1, a1) = (left.velocity, left.acceleration, right.velocity, right.acceleration);
        if v0 == 0.0 {
            let lowest = a0.min(1.5 * v1 / h - 0.5 * a1).min(v1 / h);
            lowest > self.caution * START_SPREAD * noise
        } else {
            let third = h * (1.0 / 3.0);
            let lowest = v0.min(v1).min(v0 + third * a0).min(v1 - third * a1);
            lowest > self.caution * VELOCITY_SPREAD * noise * h
        }
    }

    fn is_stop(&self, left: Motion, right: Motion, h: f64, noise: f64) -> bool {
        let (a0, a1) = (left.acceleration, right.acceleration);
        let highest = a0.max(3.0 * (right.velocity - left.velocity) / h - a0 - a1).max(a1);
        right.velocity <= 0.0 && left.velocity > 0.0 && highest < -self.caution * SLOPE_SPREAD * noise
    }
}

/// int V over a whole interval of the interpolant.
fn interpolant_way(left: Motion, right: Motion, h: f64) -> f64 {
    h * (0.5 * (left.velocity + right.velocity) + h * (left.acceleration - right.acceleration) / 12.0)
}

/// Variance that the interpolant over a time u leaves out of the way: c^2 u^5/720.
fn left_out(u: f64, noise: f64) -> f64 {
    noise * noise * u.powi(5) / 720.0
}

/// The zero of V on an interval where it falls throughout.
///
/// V and a are drawn at the zero u of the interpolant; the true zero is then about -V/a away, much nearer than either end
/// was. With the drawn point as the new end, repeat: the remaining distance falls like its own power 3/2, until the
/// acceleration noise within it is below `STOP_PRECISION` of the slope.
fn zero(mut left: Motion, mut right: Motion, mut h: f64, root_noise: f64, draws: &mut Draws) -> Stop {
    // c, from c sqrt(h).
    let noise = root_noise / h.sqrt();
    let (mut before, mut way, mut spread): (f64, f64, f64) = (0.0, 0.0, 0.0);
    for _ in 0..STOP_REFINEMENTS {
        let fall = Fall::new(left, right, h);
        let p = fall.zero();
        let (u, r) = (p * h, (1.0 - p) * h);
        let balance = u * r / h;
        let dv = noise * balance * (balance * (1.0 / 3.0)).sqrt() * draws.normal();
        let da = 0.5 * noise * balance.sqrt() * draws.normal()
            + if balance > 0.0 { 1.5 * (r - u) / (u * r) * dv } else { 0.0 };
        let mean = fall.slope(p) / h;
        // In law below zero by `caution` standard deviations.
        let acceleration = if mean + da < 0.0 { mean + da } else { mean };
        let drawn = Motion { velocity: dv, acceleration };
        let shift = (-dv / acceleration).clamp(-u, r);
        let precise = noise * noise * shift.abs() <= (STOP_PRECISION * acceleration) * (STOP_PRECISION * acceleration);
        if precise || dv > 0.0 {
            way += interpolant_way(left, drawn, u);
            spread += left_out(u, noise);
            before += u;
        }
        if precise {
            // Beyond u the way is of second order.
            way += 0.5 * dv * shift;
            return Stop { after: before + shift, acceleration, way: way + spread.sqrt() * draws.normal() };
        }
        (left, right, h) = if dv > 0.0 { (drawn, right, r) } else { (left, drawn, u) };
    }
    let p = left.velocity / (left.velocity - right.velocity);
    Stop { after: before + p * h, acceleration: left.acceleration.min(right.acceleration), way }
}

/// The acceleration at a stop is known to this fraction of itself.
const STOP_PRECISION: f64 = 1e-2;

/// Each refinement takes the remaining distance to about its power 3/2; eight are never needed.
const STOP_REFINEMENTS: usize = 8;

/// The cubic Hermite interpolant of V on an interval, as a polynomial in the fraction p of it.
struct Fall {
    v0: f64,
    d0: f64,
    c2: f64,
    c3: f64,
    v1: f64,
}

impl Fall {
    fn new(left: Motion, right: Motion, h: f64) -> Self {
        let (v0, d0, d1) = (left.velocity, h * left.acceleration, h * right.acceleration);
        let rise = right.velocity - v0;
        Fall { v0, d0, c2: 3.0 * rise - 2.0 * d0 - d1, c3: d0 + d1 - 2.0 * rise, v1: right.velocity }
    }

    fn value(&self, p: f64) -> f64 {
        self.v0 + p * (self.d0 + p * (self.c2 + p * self.c3))
    }

    fn slope(&self, p: f64) -> f64 {
        self.d0 + p * (2.0 * self.c2 + p * 3.0 * self.c3)
    }

    /// Newton inside a bracket; V falls, so its sign says which end to move.
    fn zero(&self) -> f64 {
        let (mut low, mut high, mut p) = (0.0, 1.0, self.v0 / (self.v0 - self.v1));
        for _ in 0..60 {
            let v = self.value(p);
            if v > 0.0 {
                low = p
            } else {
                high = p
            }
            let newton = p - v / self.slope(p);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let moved = (next - p).abs();
            p = next;
            // The noise drawn at p is larger than what this leaves.
            if moved < 1e-7 {
                break;
            }
        }
        p
    }
}
