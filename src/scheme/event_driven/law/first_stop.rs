//! The first zero of the velocity inside a slip step whose two ends are known.
//!
//! Let V = eps x' and a = V' on a step [0, h], and let s = eps (x1 - x0) be the distance travelled.
//! To leading order in h (fastest rate), x is a twice integrated Brownian motion of intensity c =
//! (noise diffusion)/m, conditioned at both ends on distance, velocity and acceleration. The first
//! neglected terms are of relative order (h rate)^2/100. Given the two ends,
//!
//! - the mean is the quintic Hermite interpolant of x;
//! - the precision of (x, V, a) at u, with r = h - u, is the sum of the one-sided precisions, c^-2
//!   times
//!
//! ```text
//! | 720 (1/u^5 + 1/r^5)   360 (1/r^4 - 1/u^4)    60 (1/u^3 + 1/r^3) |
//! |          .            192 (1/u^3 + 1/r^3)    36 (1/r^2 - 1/u^2) |
//! |          .                     .              9 (1/u + 1/r)     |
//! ```
//!
//! So at the midpoint sd V = c h^{3/2}/sqrt 3072, independent of (x, a), sd a = c h^{1/2}/4, E(dx |
//! da) = -h^2 da/48, sd(x | a) = c h^{5/2}/sqrt 46080.
//!
//! Therefore a path on [0, h] can be refined where it matters, by drawing midpoints, and left
//! unchanged elsewhere (recursive conditional bisection). The intervals are treated from left to
//! right. An interval is
//!
//! - *clear* if V stays positive, except with a probability that is neglected
//!   ([`VelocityBounds::is_positive`]);
//! - a *stop* if V has one zero, where it falls ([`VelocityBounds::has_one_zero`]). This zero is
//!   near that of the mean;
//! - otherwise bisected.
//!
//! A slip starts with V = 0 and a = (f_s - f_d)/m, and noise may turn it back within h* = (a/c)^2.
//! Bisection reaches this time scale by itself, so that very short slips are resolved in law. If a
//! step from rest is not clear, this is mostly because of its beginning, so it is first divided at
//! `EARLY`. The recursion ends because at small enough h any V0 > 0 or a0 > 0 is clear; a tangency
//! is cut off at 2^-40 h.

use super::velocity_bounds::VelocityBounds;
use crate::lanes::Lanes;
use crate::model::LARGEST;

/// The velocity eps x' and its derivative at one time.
#[derive(Clone, Copy, Debug)]
pub struct SlipVelocity<L = f64> {
    /// V.
    pub velocity: L,
    /// a.
    pub acceleration: L,
}

impl<L: Lanes> SlipVelocity<L> {
    /// Whether both are numbers that can be computed with.
    #[inline(always)]
    pub fn is_finite(&self) -> L::Mask {
        let most = L::splat(LARGEST);
        L::and(
            self.velocity.abs().lt(most),
            self.acceleration.abs().lt(most),
        )
    }

    /// The difference of two motions.
    #[inline(always)]
    pub fn less(self, other: Self) -> Self {
        SlipVelocity {
            velocity: self.velocity - other.velocity,
            acceleration: self.acceleration - other.acceleration,
        }
    }

    /// `a` where `mask` holds, `b` elsewhere.
    #[inline(always)]
    pub fn select(mask: L::Mask, a: Self, b: Self) -> Self {
        SlipVelocity {
            velocity: L::select(mask, a.velocity, b.velocity),
            acceleration: L::select(mask, a.acceleration, b.acceleration),
        }
    }
}

/// A slip step: the motion at its ends, the distance between them, its length and the square root
/// of its length.
#[derive(Clone, Copy, Debug)]
pub struct KnownStep {
    /// At u = 0; V0 >= 0, and V0 = 0 only where a sub-phase starts.
    pub start: SlipVelocity,
    /// At u = h.
    pub end: SlipVelocity,
    /// s.
    pub travel: f64,
    /// h.
    pub length: f64,
    /// sqrt(h).
    pub root_length: f64,
}

impl KnownStep {
    /// The mean of the distance and of the motion at a time u.
    pub fn mean(&self, u: f64) -> (f64, SlipVelocity) {
        let inverse = 1.0 / self.length;
        let whole = Interval {
            end: self.end,
            travel: self.travel,
            length: self.length,
            inverse,
            noise: 0.0,
        };
        let (quintic, p) = (Quintic::new(self.start, &whole), u * inverse);
        let velocity = quintic.velocity(p) * inverse;
        (
            quintic.travel(p),
            SlipVelocity {
                velocity,
                acceleration: quintic.acceleration(p) * inverse * inverse,
            },
        )
    }
}

/// A stop of the slip: the first zero of V.
#[derive(Clone, Copy, Debug)]
pub struct SlipStop {
    /// u, the time since the start of the step.
    pub after: f64,
    /// a at the stop.
    pub acceleration: f64,
    /// The distance travelled since the start of the step. It is not negative, because V > 0 before
    /// the stop.
    pub travel: f64,
}

/// The search for the first zero of V.
#[derive(Clone, Copy, Debug)]
pub struct StopSearch {
    /// c, the intensity of the noise of a.
    pub noise: f64,
    /// Standard deviations beyond which a zero of V is considered impossible.
    pub caution: f64,
}

/// Halvings of a step; 2^-40 of it is far below the time scale of any slip.
pub const HALVINGS: usize = 40;

/// 2^-HALVINGS, the shortest interval as a fraction of a step.
pub const FINEST: f64 = 1.0 / (1u64 << HALVINGS) as f64;

/// The fraction of a step from rest at which it is first divided, about where it takes the fewest
/// divisions.
const EARLY: f64 = 0.125;

/// sd of V at the midpoint: 1/sqrt 3072.
const MIDDLE_VELOCITY: f64 = 0.018_042_195_912_175_804;

/// sd of x at the midpoint given a: 1/sqrt 46080.
const MIDDLE_WAY: f64 = 0.004_658_474_953_124_562;

/// 2^{-1/2}.
const ROOT_HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// An interval that starts where the part that has been searched ends. Its start is known from
/// there; it holds the motion at its end, and the distance travelled in it.
#[derive(Clone, Copy, Debug)]
pub struct Interval<L = f64> {
    pub end: SlipVelocity<L>,
    pub travel: L,
    pub length: L,
    /// 1 / length.
    pub inverse: L,
    /// c sqrt(length).
    pub noise: L,
}

impl StopSearch {
    /// A whole step as an interval.
    #[inline(always)]
    pub fn whole(&self, step: &KnownStep) -> Interval {
        Interval {
            end: step.end,
            travel: step.travel,
            length: step.length,
            inverse: 1.0 / step.length,
            noise: self.noise * step.root_length,
        }
    }

    /// Whether V stays above zero on an interval, except with a probability that is neglected.
    #[inline(always)]
    pub fn is_clear<L: Lanes>(&self, left: SlipVelocity<L>, next: &Interval<L>) -> L::Mask {
        VelocityBounds::new(left, next, self.caution).is_positive()
    }

    /// Whether V has one zero in an interval, where it falls.
    #[inline(always)]
    pub fn is_stop<L: Lanes>(&self, left: SlipVelocity<L>, next: &Interval<L>) -> L::Mask {
        VelocityBounds::new(left, next, self.caution).has_one_zero()
    }

    /// Draws a state near the zero of V, with three normals.
    #[inline(always)]
    pub fn near_stop<L: Lanes>(
        &self,
        left: SlipVelocity<L>,
        next: &Interval<L>,
        normals: [L; 3],
    ) -> NearStop<L> {
        let mean = Quintic::new(left, next);
        let p = mean.near_zero();
        let h = next.length;
        let (travel, motion) = mean.drawn(next, p, normals);
        let SlipVelocity {
            velocity,
            acceleration,
        } = motion;
        // `after` and `behind` may both equal the whole interval, where a step is so short that its
        // moments underflow.
        let (after, behind) = (p * h, (L::splat(1.0) - p) * h);
        let late = (-velocity / acceleration)
            .or_at_least(-after)
            .or_at_most(behind);
        let tolerated = acceleration * STOP_PRECISION;
        // At the stop V falls, by `caution` standard deviations.
        let falls = acceleration.lt(L::splat(0.0));
        let is_at_it = L::and(
            falls,
            (late.abs() * (self.noise * self.noise)).le(tolerated * tolerated),
        );
        NearStop {
            after,
            behind,
            travel,
            motion,
            late,
            is_at_it,
        }
    }
}

/// A drawn state near a stop.
#[derive(Clone, Copy, Debug)]
pub struct NearStop<L: Lanes = f64> {
    /// Its time since the start of the interval, and until the end of the interval.
    pub after: L,
    pub behind: L,
    /// The distance travelled since the start of the interval.
    pub travel: L,
    pub motion: SlipVelocity<L>,
    /// The time from this state to the zero of the velocity, at uniform acceleration.
    pub late: L,
    /// Whether the noise until then can be neglected.
    pub is_at_it: L::Mask,
}

impl<L: Lanes> NearStop<L> {
    /// Time and distance from the start of the interval to the zero of V.
    #[inline(always)]
    pub fn zero(&self) -> (L, L) {
        let SlipVelocity {
            velocity,
            acceleration,
        } = self.motion;
        let t = self.late;
        (
            self.after + t,
            self.travel + t * (velocity + t * 0.5 * acceleration),
        )
    }

    /// The parts of the interval before and after this state.
    #[inline(always)]
    pub fn parted(&self, whole: &Interval<L>, noise: f64) -> [Interval<L>; 2] {
        [
            Interval::new(self.motion, self.travel, self.after, noise),
            Interval::new(whole.end, whole.travel - self.travel, self.behind, noise),
        ]
    }
}

/// A distance travelled while V > 0, made non-negative. The distance of an interval is a difference
/// whose error is a rounding of the distance of the whole step, so that of a very short slip may
/// come out negative.
#[inline(always)]
pub fn forwards<L: Lanes>(travel: L) -> L {
    L::select(travel.lt(L::splat(0.0)), L::splat(0.0), travel)
}

/// Draws the state at a fraction `p` of an interval with three normals, given both ends. Returns
/// the distance from the start of the interval and the motion.
#[inline(always)]
pub fn state_inside<L: Lanes>(
    left: SlipVelocity<L>,
    next: &Interval<L>,
    p: L,
    normals: [L; 3],
) -> (L, SlipVelocity<L>) {
    Quintic::new(left, next).drawn(next, p, normals)
}

impl<L: Lanes> Interval<L> {
    /// An interval of a length, for noise of intensity `noise`.
    #[inline(always)]
    pub fn new(end: SlipVelocity<L>, travel: L, length: L, noise: f64) -> Self {
        Interval {
            end,
            travel,
            length,
            inverse: L::splat(1.0) / length,
            noise: length.sqrt() * noise,
        }
    }

    /// The same interval with other values at its end.
    #[inline(always)]
    pub fn with_end(self, travel: L, end: SlipVelocity<L>) -> Self {
        Interval {
            end,
            travel,
            ..self
        }
    }

    /// The two parts of the interval, divided at a fraction `p` of it, where the distance and the
    /// motion are these.
    #[inline(always)]
    pub fn parted(self, p: L, travel: L, motion: SlipVelocity<L>) -> [Self; 2] {
        let behind = L::splat(1.0) - p;
        [
            self.part(p).with_end(travel, motion),
            self.part(behind).with_end(self.travel - travel, self.end),
        ]
    }

    /// The same interval with a fraction `p` of its length.
    #[inline(always)]
    fn part(self, p: L) -> Self {
        Interval {
            length: p * self.length,
            inverse: self.inverse / p,
            noise: self.noise * p.sqrt(),
            ..self
        }
    }

    /// `a` where `mask` holds, `b` elsewhere.
    #[inline(always)]
    pub fn select(mask: L::Mask, a: &Self, b: &Self) -> Self {
        Interval {
            end: SlipVelocity::select(mask, a.end, b.end),
            travel: L::select(mask, a.travel, b.travel),
            length: L::select(mask, a.length, b.length),
            inverse: L::select(mask, a.inverse, b.inverse),
            noise: L::select(mask, a.noise, b.noise),
        }
    }
}

/// x and x' in the middle of the quintic between two ends a time h apart, from x, x' and x'' there.
#[inline(always)]
pub fn middle<L: Lanes>(h: L, [x0, x1]: [L; 2], [v0, v1]: [L; 2], [a0, a1]: [L; 2]) -> (L, L) {
    let x = (x0 + x1) * 0.5 + h * ((v0 - v1) * 0.15625 + h * 0.015625 * (a0 + a1));
    (
        x,
        (x1 - x0) / h * 1.875 - (v0 + v1) * 0.4375 + h * 0.03125 * (a1 - a0),
    )
}

/// Draws the state in the middle of an interval with three normals, and divides the interval there.
#[inline(always)]
pub fn halves<L: Lanes>(
    left: SlipVelocity<L>,
    next: &Interval<L>,
    [one, two, three]: [L; 3],
) -> (Interval<L>, Interval<L>) {
    let (v0, v1, a0, a1) = (
        left.velocity,
        next.end.velocity,
        left.acceleration,
        next.end.acceleration,
    );
    let (h, noise) = (next.length, next.noise);
    let da = noise * 0.25 * one;
    let middle = SlipVelocity {
        velocity: next.inverse * 1.875 * next.travel - (v0 + v1) * 0.4375
            + h * ((a1 - a0) * 0.03125 + noise * MIDDLE_VELOCITY * two),
        acceleration: next.inverse * 1.5 * (v1 - v0) - (a0 + a1) * 0.25 + da,
    };
    let bend = (a0 + a1) * 0.015625 - da * (1.0 / 48.0) + noise * MIDDLE_WAY * three;
    let travel = next.travel * 0.5 + h * ((v0 - v1) * 0.15625 + h * bend);
    let (length, inverse, noise) = (h * 0.5, next.inverse * 2.0, noise * ROOT_HALF);
    let near = Interval {
        end: middle,
        travel,
        length,
        inverse,
        noise,
    };
    (
        near,
        Interval {
            end: next.end,
            travel: next.travel - travel,
            length,
            inverse,
            noise,
        },
    )
}

/// The same at the fraction `EARLY` of the interval.
#[inline(always)]
pub fn early_parts<L: Lanes>(
    left: SlipVelocity<L>,
    next: &Interval<L>,
    normals: [L; 3],
) -> (Interval<L>, Interval<L>) {
    let early = L::splat(EARLY);
    let (travel, motion) = state_inside(left, next, early, normals);
    let [near, far] = next.parted(early, travel, motion);
    (near, far)
}

/// A draw from the conditional law of (x, V, a) at a fraction p of an interval with h = c = 1, from
/// three normals.
///
/// With q = p (1-p) and s = 1 - 2p, the precision above is, for (x q^{-5/2}, V q^{-3/2}, a
/// q^{-1/2}),
///
/// ```text
/// | 720 D   -360 s (1-2q)    60 (1-3q) |
/// |   .      192 (1-3q)        -36 s   |         D = 1 - 5q + 5q^2,   E = 1 - 8q + 20q^2
/// |   .          .               9     |
/// ```
///
/// Eliminating x leaves (12 E, -6 s (1-5q); ., 4 - 15q)/D, and eliminating V leaves 1/E. So the
/// three factors of the draw are closed forms.
#[inline(always)]
pub fn conditional_factor<L: Lanes>(p: L, [one, two, three]: [L; 3]) -> [L; 3] {
    let unit = L::splat(1.0);
    let (q, s) = (p * (unit - p), unit - p * 2.0);
    let (root_q, root_e) = (q.sqrt(), (unit - q * (L::splat(8.0) - q * 20.0)).sqrt());
    let root_12d = ((unit - q * 5.0 * (unit - q)) * 12.0).sqrt();
    let (inverse_e, inverse_d) = (unit / root_e, unit / root_12d);
    let v = s * 0.5 * (unit - q * 5.0) * one + root_12d * (1.0 / 12.0) * two;
    let x = (unit - q * 6.0) * (1.0 / 6.0) * one + s * 0.5 * (unit - q * 2.0) * inverse_d * two;
    let (scale_v, scale_x) = (root_q * q, root_q * q * q);
    [
        scale_x * (x * inverse_e + inverse_d * ROOT_60TH * three),
        scale_v * v * inverse_e,
        root_q * root_e * one,
    ]
}

/// 60^{-1/2}.
const ROOT_60TH: f64 = 0.129_099_444_873_580_57;

/// The acceleration at a stop is known to within this fraction of itself.
const STOP_PRECISION: f64 = 1e-2;

/// Newton steps from the zero of a chord of V. Where V falls throughout, this is within a few
/// hundredths of the interval; three steps square the error three times.
const NEWTON_STEPS: usize = 3;

/// The noise is weak if c sqrt(h)/|a| is below this. There the error of the quintic in a, (rate
/// h)^4/1920 of a, is no longer below the first neglected terms of the conditional law, (rate
/// h)^2/100 of its standard deviation c sqrt(h)/4. The value is for the default step, rate h = 1/2.
pub const FEEBLE: f64 = 0.05;

/// The most refinements of a stop. Each takes the remaining distance to about its power 3/2, so
/// eight are never needed.
pub const STOP_REFINEMENTS: usize = 8;

/// The mean distance on an interval, as a polynomial in the fraction p of the interval. V times h
/// and a times h^2 are its derivatives in p.
struct Quintic<L> {
    d0: L,
    e0: L,
    c3: L,
    c4: L,
    c5: L,
    /// V h at p = 1.
    d1: L,
}

impl<L: Lanes> Quintic<L> {
    #[inline(always)]
    fn new(left: SlipVelocity<L>, next: &Interval<L>) -> Self {
        let (h, s, half) = (next.length, next.travel, next.length * next.length * 0.5);
        let (d0, d1) = (h * left.velocity, h * next.end.velocity);
        let (e0, e1) = (half * left.acceleration, half * next.end.acceleration);
        Quintic {
            d0,
            e0,
            c3: s * 10.0 - d0 * 6.0 - d1 * 4.0 - e0 * 3.0 + e1,
            c4: s * -15.0 + d0 * 8.0 + d1 * 7.0 + e0 * 3.0 - e1 * 2.0,
            c5: s * 6.0 - (d0 + d1) * 3.0 - e0 + e1,
            d1,
        }
    }

    /// Draws the distance from the start of the interval and the motion at a fraction `p` of it, of
    /// which this is the mean, with three normals.
    #[inline(always)]
    fn drawn(&self, next: &Interval<L>, p: L, normals: [L; 3]) -> (L, SlipVelocity<L>) {
        let [dx, dv, da] = conditional_factor(p, normals);
        let (h, inverse, noise) = (next.length, next.inverse, next.noise);
        let velocity = self.velocity(p) * inverse + noise * h * dv;
        let acceleration = self.acceleration(p) * inverse * inverse + noise * da;
        (
            self.travel(p) + noise * h * h * dx,
            SlipVelocity {
                velocity,
                acceleration,
            },
        )
    }

    #[inline(always)]
    fn travel(&self, p: L) -> L {
        let bend = p.mul_add(p.mul_add(self.c5, self.c4), self.c3);
        p * p.mul_add(p.mul_add(bend, self.e0), self.d0)
    }

    #[inline(always)]
    fn velocity(&self, p: L) -> L {
        let bend = p.mul_add(p.mul_add(self.c5 * 5.0, self.c4 * 4.0), self.c3 * 3.0);
        p.mul_add(p.mul_add(bend, self.e0 * 2.0), self.d0)
    }

    #[inline(always)]
    fn acceleration(&self, p: L) -> L {
        let bend = p.mul_add(p.mul_add(self.c5 * 20.0, self.c4 * 12.0), self.c3 * 6.0);
        p.mul_add(bend, self.e0 * 2.0)
    }

    /// A fraction near the zero of V: the zero of the chord of that half of the interval at whose
    /// ends V has different signs, improved by Newton steps. The law is exact for a draw at any
    /// fraction; one near the zero saves refinements.
    #[inline(always)]
    fn near_zero(&self) -> L {
        let (zero, half) = (L::splat(0.0), L::splat(0.5));
        let middle = self.velocity(half);
        let is_late = middle.gt(zero);
        let (from, to) = (
            L::select(is_late, middle, self.d0),
            L::select(is_late, self.d1, middle),
        );
        let begin = L::select(is_late, half, zero);
        let mut p = begin + half * from / (from - to);
        for _ in 0..NEWTON_STEPS {
            let newton = p - self.velocity(p) / self.acceleration(p);
            p = L::select(L::and(newton.gt(begin), newton.lt(begin + half)), newton, p);
        }
        p
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_of_a_draw_inverts_the_precision_at_any_fraction() {
        for p in [1e-12f64, 1e-6, 0.01, 0.2, 0.276, 0.5, 0.7, 0.999] {
            let (u, r): (f64, f64) = (p, 1.0 - p);
            let off = (
                360.0 * (r.powi(-4) - u.powi(-4)),
                60.0 * (u.powi(-3) + r.powi(-3)),
            );
            let precision = [
                [720.0 * (u.powi(-5) + r.powi(-5)), off.0, off.1],
                [
                    off.0,
                    192.0 * (u.powi(-3) + r.powi(-3)),
                    36.0 * (r.powi(-2) - u.powi(-2)),
                ],
                [
                    off.1,
                    36.0 * (r.powi(-2) - u.powi(-2)),
                    9.0 * (1.0 / u + 1.0 / r),
                ],
            ];
            let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
                .map(|z| conditional_factor(p, z));
            // F^T (precision) F = 1.
            for (i, a) in columns.iter().enumerate() {
                for (j, b) in columns.iter().enumerate() {
                    let product: f64 = (0..9)
                        .map(|k| a[k / 3] * precision[k / 3][k % 3] * b[k % 3])
                        .sum();
                    assert!(
                        (product - f64::from(u8::from(i == j))).abs() < 1e-8,
                        "{p} {i} {j}: {product}"
                    );
                }
            }
        }
    }

    /// The motion at the start of an interval of length h, and the interval, for noise c.
    fn an_interval(h: f64, c: f64) -> (SlipVelocity, Interval) {
        let left = SlipVelocity {
            velocity: 0.7,
            acceleration: -1.3,
        };
        let end = SlipVelocity {
            velocity: -0.4,
            acceleration: 0.9,
        };
        (left, Interval::new(end, 0.31, h, c))
    }

    /// The mean motion has the values at the ends, the derivative of the distance is V, and the
    /// derivative of V is a.
    #[test]
    fn the_mean_motion_is_the_derivative_of_the_mean_distance() {
        let (left, next) = an_interval(0.8, 0.0);
        let step = KnownStep {
            start: left,
            end: next.end,
            travel: next.travel,
            length: 0.8,
            root_length: 0.8f64.sqrt(),
        };
        for i in 0..=20 {
            let (inside, d) = (0.8 * (f64::from(i) / 20.0).clamp(0.01, 0.99), 1e-4);
            let ((before, slow), (here, now), (after, fast)) = (
                step.mean(inside - d),
                step.mean(inside),
                step.mean(inside + d),
            );
            assert!(
                ((after - before) / (2.0 * d) - now.velocity).abs() < 1e-6,
                "{inside}: {here}"
            );
            assert!(
                ((fast.velocity - slow.velocity) / (2.0 * d) - now.acceleration).abs() < 1e-5,
                "{inside}"
            );
        }
        let (ends, whole) = (step.mean(0.8), step.mean(0.0));
        assert!((ends.0 - 0.31).abs() < 1e-12 && whole.0 == 0.0, "{ends:?}");
        assert!(
            (ends.1.acceleration - 0.9).abs() < 1e-11 && (whole.1.acceleration + 1.3).abs() < 1e-12,
            "{ends:?}"
        );
    }

    /// The state in the middle of an interval, given both ends, is Gaussian. Its precision is the
    /// sum of those from both ends, and its mean lies on the quintic between them. Both are linear
    /// in the normals, so a draw with zeros gives the mean, and a draw with each normal alone gives
    /// the factor of the covariance. The precision of (x, V, a) at u = r = h/2 for c = 1 is written
    /// at the head of this file.
    #[test]
    fn the_middle_of_an_interval_has_the_law_between_its_ends() {
        let (h, c) = (0.8, 1.7);
        let (left, next) = an_interval(h, c);
        let middle = |normals: [f64; 3]| {
            let (near, far) = halves(left, &next, normals);
            assert!(
                (near.travel + far.travel - next.travel).abs() < 1e-15
                    && near.length == 0.4
                    && far.length == 0.4
            );
            assert!(
                (near.noise - c * 0.4f64.sqrt()).abs() < 1e-15 && (far.inverse - 2.5).abs() < 1e-15
            );
            assert_eq!(
                (far.end.velocity, far.end.acceleration),
                (next.end.velocity, next.end.acceleration)
            );
            [near.travel, near.end.velocity, near.end.acceleration]
        };
        let mean = middle([0.0; 3]);
        let step = KnownStep {
            start: left,
            end: next.end,
            travel: next.travel,
            length: h,
            root_length: h.sqrt(),
        };
        let (travel, motion) = step.mean(0.5 * h);
        for (got, want) in mean
            .into_iter()
            .zip([travel, motion.velocity, motion.acceleration])
        {
            assert!((got - want).abs() < 1e-12, "{mean:?}");
        }
        let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|normals| {
            let with = middle(normals);
            [0, 1, 2].map(|i| with[i] - mean[i])
        });
        let u = 0.5 * h;
        let precision = [
            [1440.0 / u.powi(5), 0.0, 120.0 / u.powi(3)],
            [0.0, 384.0 / u.powi(3), 0.0],
            [120.0 / u.powi(3), 0.0, 18.0 / u],
        ];
        for (i, a) in columns.iter().enumerate() {
            for (j, b) in columns.iter().enumerate() {
                let product: f64 = (0..9)
                    .map(|k| a[k / 3] * precision[k / 3][k % 3] * b[k % 3])
                    .sum::<f64>()
                    / (c * c);
                assert!(
                    (product - f64::from(u8::from(i == j))).abs() < 1e-9,
                    "{i} {j}: {product}"
                );
            }
        }
    }
}
