//! Bounds of the velocity V inside an interval, given both ends: that it stays positive, or that it
//! has one zero.
//!
//! V is Gaussian given both ends ([`super::first_stop`]). Its mean is a polynomial of degree 4 in
//! the fraction p of the interval, and with q = p (1-p)
//!
//! ```text
//! sd V = c h^{3/2} q^{3/2} ((4 - 15 q)/12)^{1/2}
//! sd a = c h^{1/2} (q (1 - 8q + 20q^2))^{1/2} <= c h^{1/2}/4
//! ```
//!
//! A polynomial lies above another one if its Bezier control points do. So V is considered positive
//! on a half of the interval if the control points of its mean there lie above those of a
//! polynomial that is nowhere below `caution` sd V. It is taken to fall if those of its slope lie
//! below -`caution` c h^{1/2}/4. The halves have control points of their own, because those of the
//! whole interval lie so far from the polynomial that most intervals would have to be divided once
//! more.

use super::first_stop::{Interval, SlipVelocity};
use crate::lanes::Lanes;

/// The mean of V on an interval, and its uncertainty.
pub struct VelocityBounds<L: Lanes> {
    /// The Bezier control points of the mean of V.
    controls: [L; 5],
    /// caution c h^{3/2}.
    uncertainty: L,
}

/// Control points of a polynomial of degree 4 that is nowhere below sd V/(c h^{3/2}) on a half of
/// the interval, from the outer end of the half to the middle. The first one is 0, because V is
/// known there.
const SPREAD: [f64; 4] = [0.0165, 0.0355, 0.0355, 0.018_05];

/// The bound of sd a/(c h^{1/2}), over the factor 4 between control points of the slope and
/// differences of those of V.
const SLOPE_SPREAD: f64 = 0.25 / 4.0;

impl<L: Lanes> VelocityBounds<L> {
    /// The bounds that hold with `caution` standard deviations at every time.
    #[inline(always)]
    pub fn new(left: SlipVelocity<L>, next: &Interval<L>, caution: f64) -> Self {
        let (v0, v1, quarter) = (left.velocity, next.end.velocity, next.length * 0.25);
        let (q0, q1) = (quarter * left.acceleration, quarter * next.end.acceleration);
        let middle = next.travel * 5.0 * next.inverse - (v0 + v1) * 2.0 + (q1 - q0);
        VelocityBounds {
            controls: [v0, v0 + q0, middle, v1 - q1, v1],
            uncertainty: next.noise * next.length * caution,
        }
    }

    /// Whether V is positive throughout; it may be zero at the start.
    #[inline(always)]
    pub fn is_positive(&self) -> L::Mask {
        let ([v0, .., v1], zero) = (self.controls, L::splat(0.0));
        let [first, second] = halves(self.controls);
        let at_ends = L::and(v0.ge(zero), v1.gt(zero));
        L::and(at_ends, L::and(self.is_above(first), self.is_above(second)))
    }

    /// Whether V is positive at first, has one zero, where it falls, and is negative from there on.
    /// This is so if V is positive or falls on the first half, and falls or is negative on the
    /// second.
    #[inline(always)]
    pub fn has_one_zero(&self) -> L::Mask {
        let [v0, c1, c2, c3, v1] = self.controls;
        let zero = L::splat(0.0);
        let ([first, second], [falling, fallen]) = (
            halves(self.controls),
            slope_halves([c1 - v0, c2 - c1, c3 - c2, v1 - c3]),
        );
        let at_ends = L::and(v0.gt(zero), v1.le(zero));
        let before = L::or(self.is_above(first), self.falls(falling));
        let after = L::or(self.is_below(second), self.falls(fallen));
        L::and(at_ends, L::and(before, after))
    }

    /// Whether V is positive on a half with these control points.
    #[inline(always)]
    fn is_above(&self, [c1, c2, c3, c4]: [L; 4]) -> L::Mask {
        let [s1, s2, s3, s4] = self.uncertainties();
        L::and(L::and(c1.gt(s1), c2.gt(s2)), L::and(c3.gt(s3), c4.gt(s4)))
    }

    /// Whether V is negative there.
    #[inline(always)]
    fn is_below(&self, [c1, c2, c3, c4]: [L; 4]) -> L::Mask {
        let [s1, s2, s3, s4] = self.uncertainties();
        L::and(
            L::and(c1.lt(-s1), c2.lt(-s2)),
            L::and(c3.lt(-s3), c4.lt(-s4)),
        )
    }

    /// Whether V falls on a half whose slope has these control points.
    #[inline(always)]
    fn falls(&self, [d0, d1, d2, d3]: [L; 4]) -> L::Mask {
        let most = self.uncertainty * -SLOPE_SPREAD;
        L::and(
            L::and(d0.lt(most), d1.lt(most * 2.0)),
            L::and(d2.lt(most * 4.0), d3.lt(most * 8.0)),
        )
    }

    /// `caution` times [`SPREAD`], in the units of [`halves`].
    #[inline(always)]
    fn uncertainties(&self) -> [L; 4] {
        let [s1, s2, s3, s4] = SPREAD;
        [
            self.uncertainty * (2.0 * s1),
            self.uncertainty * (4.0 * s2),
            self.uncertainty * (8.0 * s3),
            self.uncertainty * (16.0 * s4),
        ]
    }
}

/// The control points of both halves by de Casteljau's algorithm: 2, 4, 8 and 16 times the second
/// to the fifth. The first one is that of the whole. The points of the second half are in reverse.
#[inline(always)]
fn halves<L: Lanes>([c0, c1, c2, c3, c4]: [L; 5]) -> [[L; 4]; 2] {
    let (s01, s12, s23, s34) = (c0 + c1, c1 + c2, c2 + c3, c3 + c4);
    let (t0, t1, t2) = (s01 + s12, s12 + s23, s23 + s34);
    let (u0, u1) = (t0 + t1, t1 + t2);
    let middle = u0 + u1;
    [[s01, t0, u0, middle], [s34, t2, u1, middle]]
}

/// The same for a polynomial of degree 3: 1, 2, 4 and 8 times the control points of each half.
#[inline(always)]
fn slope_halves<L: Lanes>([d0, d1, d2, d3]: [L; 4]) -> [[L; 4]; 2] {
    let (s0, s1, s2) = (d0 + d1, d1 + d2, d2 + d3);
    let (t0, t1) = (s0 + s1, s1 + s2);
    let middle = t0 + t1;
    [[d0, s0, t0, middle], [d3, s2, t1, middle]]
}

#[cfg(test)]
mod tests {
    use super::super::first_stop::{KnownStep, conditional_factor};
    use super::super::tests::free_step;
    use super::*;
    use crate::noise::AddressedDraws;

    /// sd V and sd a at a fraction of an interval with h = c = 1, from the factor of the
    /// conditional law.
    fn spreads(p: f64) -> [f64; 2] {
        let columns =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|z| conditional_factor(p, z));
        [1, 2].map(|row| {
            columns
                .iter()
                .map(|column| column[row] * column[row])
                .sum::<f64>()
                .sqrt()
        })
    }

    /// Bernstein's polynomial with these control points.
    fn bernstein(controls: &[f64], p: f64) -> f64 {
        let degree = controls.len() as i32 - 1;
        let mut binomial = 1.0;
        let mut sum = 0.0;
        for (k, control) in (0..).zip(controls) {
            sum += binomial * p.powi(k) * (1.0 - p).powi(degree - k) * control;
            binomial *= f64::from(degree - k) / f64::from(k + 1);
        }
        sum
    }

    /// The spreads are those of the conditional law, whose factor is tested against its precision,
    /// and `SPREAD` bounds sd V at every time; in the middle of the interval it exceeds sd V by
    /// less than 0.1 %. sd a is at most 1/4.
    #[test]
    fn the_bounds_are_nowhere_below_the_spread() {
        let [s1, s2, s3, s4] = SPREAD;
        for i in 1..=100_000 {
            // Equidistant fractions, and fractions down to 1e-12 near the end.
            for p in [
                0.5 * f64::from(i) / 1e5,
                0.5 * 10f64.powf(-12.0 * f64::from(i) / 1e5),
            ] {
                let (bound, [v, a], q) = (
                    bernstein(&[0.0, s1, s2, s3, s4], 2.0 * p),
                    spreads(p),
                    p * (1.0 - p),
                );
                let formula = [
                    q * (q * (4.0 - 15.0 * q) / 12.0).sqrt(),
                    (q * (1.0 - 8.0 * q + 20.0 * q * q)).sqrt(),
                ];
                assert!(
                    (v / formula[0] - 1.0).abs() < 1e-7 && (a / formula[1] - 1.0).abs() < 1e-7,
                    "{p}"
                );
                assert!(bound > v && a <= 0.25 + 1e-12, "{p}: {bound} {v} {a}");
            }
        }
        assert!((s4 / spreads(0.5)[0] - 1.0).abs() < 1e-3);
    }

    /// An interval as the search meets it: about as many that stay positive as not.
    fn any_interval(draws: &mut AddressedDraws) -> (SlipVelocity, Interval) {
        let (h, c) = ((-4.0 * draws.uniform()).exp(), 1.5);
        // In units of the spread of a free step.
        let start = SlipVelocity {
            velocity: (draws.normal() * 0.3).max(0.0) * c * h.powf(1.5),
            acceleration: c * h.sqrt() * draws.normal(),
        };
        let step = free_step(start, h, c, draws);
        (start, Interval::new(step.end, step.travel, h, c))
    }

    /// The answers are compared with the mean and the spread of V and a at 999 times of 200 000
    /// random intervals (seed 61). Where V is said to be positive, its mean is more than 4 standard
    /// deviations above zero at each time. Where V is said to have one zero, it is that far above
    /// zero at first and that far below at last, and in between the slope is that far below zero.
    /// Of the intervals for which this holds, 0.92 and 0.48 are found, and few are divided in vain
    /// as long as these are at least 0.9 and 0.45.
    #[test]
    fn what_is_said_of_an_interval_holds_at_every_time() {
        const CAUTION: f64 = 4.0;
        let mut draws = AddressedDraws::new(61, 0);
        let spread: Vec<[f64; 2]> = (1..1000).map(|i| spreads(f64::from(i) / 1000.0)).collect();
        let mut counts = [[0u32; 2]; 2];
        for _ in 0..200_000 {
            let (left, next) = any_interval(&mut draws);
            let bounds = VelocityBounds::new(left, &next, CAUTION);
            let step = KnownStep {
                start: left,
                end: next.end,
                travel: next.travel,
                length: next.length,
                root_length: next.length.sqrt(),
            };
            // 0 while V is positive, 1 while it falls, 2 while it is negative, 3 otherwise.
            let (mut phase, mut is_positive) = (0, true);
            for (i, [v, a]) in spread.iter().enumerate() {
                let (_, mean) = step.mean((i as f64 + 1.0) / 1000.0 * next.length);
                let uncertainty = CAUTION * next.noise;
                let (above, below) = (
                    uncertainty * next.length * v,
                    -uncertainty * next.length * v,
                );
                is_positive &= mean.velocity > above;
                if phase == 0 && mean.velocity <= above {
                    phase = 1;
                }
                if phase == 1 && mean.acceleration >= -uncertainty * a {
                    phase = 2;
                }
                if phase == 2 && mean.velocity >= below {
                    phase = 3;
                }
            }
            is_positive &= next.end.velocity > 0.0;
            let has_one_zero = left.velocity > 0.0 && next.end.velocity <= 0.0 && phase < 3;
            for (count, (said, is)) in counts.iter_mut().zip([
                (bounds.is_positive(), is_positive),
                (bounds.has_one_zero(), has_one_zero),
            ]) {
                assert!(is || !said, "{left:?} {next:?}");
                count[0] += u32::from(is);
                count[1] += u32::from(said);
            }
        }
        println!("{counts:?}");
        let [[positive, found], [zeros, stops]] = counts.map(|count| count.map(f64::from));
        assert!(positive > 5e3 && found > 0.9 * positive, "{counts:?}");
        assert!(zeros > 5e3 && stops > 0.45 * zeros, "{counts:?}");
    }

    /// The control points give the derivative of the mean distance, in the middle of each half too.
    #[test]
    fn the_control_points_are_those_of_the_mean_velocity() {
        let left = SlipVelocity {
            velocity: 0.7,
            acceleration: -1.3,
        };
        let next = Interval::new(
            SlipVelocity {
                velocity: -0.4,
                acceleration: 0.9,
            },
            0.31,
            0.8,
            0.0,
        );
        let controls = VelocityBounds::new(left, &next, 4.0).controls;
        let step = KnownStep {
            start: left,
            end: next.end,
            travel: next.travel,
            length: 0.8,
            root_length: 0.8f64.sqrt(),
        };
        let [first, second] = halves(controls);
        let [falling, fallen] = slope_halves([0, 1, 2, 3].map(|i| controls[i + 1] - controls[i]));
        let scaled =
            |outer: f64, [a, b, c, d]: [f64; 4]| [outer, a / 2.0, b / 4.0, c / 8.0, d / 16.0];
        let slope = |[a, b, c, d]: [f64; 4]| [a, b / 2.0, c / 4.0, d / 8.0].map(|d| 4.0 * d / 0.8);
        for i in 0..=20 {
            let p = f64::from(i) / 20.0;
            let mean = |p: f64| step.mean(p * 0.8).1;
            assert!(
                (bernstein(&controls, p) - mean(p).velocity).abs() < 1e-12,
                "{p}"
            );
            let (early, late) = (mean(0.5 * p), mean(1.0 - 0.5 * p));
            assert!(
                (bernstein(&scaled(0.7, first), p) - early.velocity).abs() < 1e-12,
                "{p}"
            );
            assert!(
                (bernstein(&scaled(-0.4, second), p) - late.velocity).abs() < 1e-12,
                "{p}"
            );
            assert!(
                (bernstein(&slope(falling), p) - early.acceleration).abs() < 1e-11,
                "{p}"
            );
            assert!(
                (bernstein(&slope(fallen), p) - late.acceleration).abs() < 1e-11,
                "{p}"
            );
        }
    }
}
