//! The first time at which a Brownian bridge meets a threshold, and which of two it meets first.
//!
//! Let y be a Brownian motion over 0 <= s <= S with both ends known. The threshold is d0 > 0 above
//! y at the start, and d1 above y at the end (negative if it is below). For a threshold that is
//! linear in s only these distances matter, and the law is exact:
//!
//! ```text
//! P(met)          = exp(-2 d0 d1 / S) if d1 > 0, else 1
//! meeting place   u = q/(S + q) of S,   q inverse-Gaussian with mean d0 S/|d1| and shape d0^2
//! ```
//!
//! (Borodin and Salminen, *Handbook of Brownian Motion*, 2.1 and IV; Karatzas and Shreve, section
//! 4.3.) The second line holds given that the threshold is met, for either sign of d1, by
//! reflection of the end.
//!
//! With a second threshold at a distance w from the first, at both ends, the order in which they
//! are met follows by repeated reflection (Anderson, Annals of Mathematical Statistics 31, 1960,
//! section 4). With p = max(d1, 0) and m = max(-d1, 0),
//!
//! ```text
//! P(met first) = exp(-2 d0 p/S) - exp(-2 (w - d0 + p) (w + m)/S) + exp(-2 (w + p) (w + d0 + m)/S) - ..
//! ```
//!
//! The terms are the probabilities to meet this threshold, the other and then this one, and this
//! one, the other, and this one again. The first omitted term is below exp(-4 w^2/S) where both
//! ends lie between the thresholds.

use crate::lanes::{Lanes, exp};

/// The distances of a threshold above y at the start and at the end.
pub type Distances<L> = (L, L);

/// P(met) where only one of two thresholds can be met; 1 where an end is on the threshold or beyond
/// it.
#[inline(always)]
pub fn meeting_probability<L: Lanes>((d0, d1): Distances<L>, duration: L) -> L {
    let zero = L::splat(0.0);
    let is_met = L::or(d0.le(zero), d1.le(zero));
    L::select(
        is_met,
        L::splat(1.0),
        exp(d0 * d1 * (L::splat(-2.0) / duration)),
    )
}

/// The probability that a threshold is met, and before the other threshold, given the distances of
/// both.
#[inline(always)]
pub fn first_meeting_probability<L: Lanes>(
    this: Distances<L>,
    other: Distances<L>,
    duration: L,
) -> L {
    let zero = L::splat(0.0);
    let twice_rate = L::splat(-2.0) / duration;
    let (inside, beyond) = (this.1.or_at_least(zero), (-this.1).or_at_least(zero));
    let width = this.0 + other.0;
    let other_first = (other.0 + inside) * (width + beyond) * twice_rate;
    let this_again = (width + inside) * (width + this.0 + beyond) * twice_rate;
    let probability =
        meeting_probability(this, duration) - (exp(other_first.or_at_most(zero)) - exp(this_again));
    probability.or_at_least(zero)
}

/// The probability that neither of two thresholds is met.
#[inline(always)]
pub fn no_meeting_probability<L: Lanes>(this: Distances<L>, other: Distances<L>, duration: L) -> L {
    let met = first_meeting_probability(this, other, duration)
        + first_meeting_probability(other, this, duration);
    (L::splat(1.0) - met).or_at_least(L::splat(0.0))
}

/// The probability that another threshold is not met before the first meeting with this one, which
/// takes place after `passed`, given that meeting and d0 > 0. The way to it is a Bessel bridge of
/// dimension 3. `width` is the distance of the two thresholds.
///
/// It is the derivative of [`no_meeting_probability`] with respect to d1 at d1 = 0, divided by that
/// with one threshold.
#[inline(always)]
pub fn misses_other<L: Lanes>(d0: L, width: L, passed: L) -> L {
    let one = L::splat(1.0);
    // Both are kept above zero, where the terms vanish.
    let rate = width * -2.0 / passed.or_at_least(L::splat(1e-200));
    let ratio = width * 2.0 / d0.or_at_least(L::splat(1e-200));
    let (once, twice) = (
        exp(((width - d0) * rate).or_at_most(L::splat(0.0))),
        exp((width + d0) * rate),
    );
    let probability = one + (one - ratio) * once + (one + ratio) * twice;
    probability.or_at_least(L::splat(0.0))
}

/// The place u of the first meeting, as a fraction of S, given that the threshold is met, from a
/// standard normal and a uniform number.
///
/// The inverse Gaussian is drawn by the method of Michael, Schucany and Haas (The American
/// Statistician 30, 1976). With y = normal^2, the smaller root of their quadratic is mu + mu^2 y/(2
/// l) - (mu/(2 l)) sqrt(4 mu l y + mu^2 y^2). Without its cancellation it is 4 l/(y (1 + g)^2), g =
/// sqrt(1 + 4 l/(mu y)), which stays finite as mu grows without bound (d1 -> 0).
#[inline(always)]
pub fn meeting_place<L: Lanes>((d0, d1): Distances<L>, duration: L, normal: L, uniform: L) -> L {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    // Divisions are slow, so there are few. A normal that rounds to zero counts as a small one.
    let y = (normal * normal).or_at_least(L::splat(1e-60));
    let (inverse_y, inverse) = (one / y, one / duration);
    let rate = d1.abs() * inverse; // d0/mu
    let shape = d0 * 4.0 * inverse_y;
    let g = (shape * rate + 1.0).sqrt() + 1.0;
    let part = one / (g * g);
    // The larger root mu^2/small replaces the smaller one with probability small/(mu + small).
    let is_larger = (uniform * (shape * rate * part + 1.0)).gt(one);
    // q as a fraction, because 1/q may be zero.
    let upper = L::select(is_larger, one, shape * d0 * part);
    let lower = L::select(is_larger, rate * rate * 4.0 * inverse_y * part, one);
    L::select(d0.le(zero), zero, upper / (duration * lower + upper))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_straight_step_of_an_ornstein_uhlenbeck_process_is_exact() {
        // theta = sigma = 1 and U(t) = e^{-t} (0.5 + 0.3 s), which is straight after the time
        // change. The probability for the bridge, integrated over its end by the midpoint rule, is
        // compared with the exact first-passage law of Brownian motion to a line.
        let exact = 0.652_644_296_302_603_9;
        let total = (f64::exp(2.0) - 1.0) / 2.0;
        let (n, farthest) = (200_000, 9.0);
        let sum: f64 = (0..n)
            .map(|i| {
                let z = -farthest + 2.0 * farthest * (i as f64 + 0.5) / n as f64;
                let end = 0.5 + 0.3 * total - total.sqrt() * z;
                meeting_probability((0.5, end), total) * (-0.5 * z * z).exp()
            })
            .sum();
        let probability = sum * 2.0 * farthest / n as f64 / (2.0 * std::f64::consts::PI).sqrt();
        assert!((probability - exact).abs() < 1e-9, "{probability}");
    }

    /// The probability that a bridge over 1 meets neither of two thresholds at distance `width`, by
    /// the method of images: the transition density of Brownian motion that is absorbed at both,
    /// divided by that of free motion.
    fn by_images(d0: f64, d1: f64, width: f64) -> f64 {
        let ratio = |gap: f64| (0.5 * ((d0 - d1).powi(2) - gap * gap)).exp();
        (-20..=20)
            .map(|k| 2.0 * f64::from(k) * width)
            .map(|w| ratio(d0 - d1 + w) - ratio(d0 + d1 + w))
            .sum()
    }

    /// The omitted terms are below 2 exp(-4 w^2), 7e-4 for the smallest width.
    #[test]
    fn a_bridge_meets_neither_threshold_as_often_as_the_images_tell() {
        for width in [1.4, 1.8, 2.5, 4.0] {
            for (d0, d1) in [(0.1, 0.1), (0.1, 0.8), (0.5, 0.5), (0.9, 0.2), (0.3, 0.97)]
                .map(|(a, b)| (a * width, b * width))
            {
                let got = no_meeting_probability((d0, d1), (width - d0, width - d1), 1.0);
                let want = by_images(d0, d1, width);
                let bound = 2.0 * (-4.0 * width * width).exp() + 1e-12;
                assert!(
                    (got - want).abs() < bound,
                    "{width} {d0} {d1}: {got} {want}"
                );
                // Given the first meeting at the end, with the other threshold missed before.
                let near = 1e-6;
                let got = misses_other(d0, width, 1.0);
                let want = by_images(d0, near, width) / -(-2.0 * d0 * near).exp_m1();
                assert!(
                    (got - want).abs() < 20.0 * bound + 1e-4,
                    "{width} {d0}: {got} {want}"
                );
            }
        }
    }

    /// The probability of Brownian motion to meet the threshold at d0 before 1 and before the other
    /// one, from the reflected motions, is the mean of that of the bridge over the end.
    #[test]
    fn the_order_of_two_thresholds_is_that_of_brownian_motion() {
        let erfc = |x: f64| libm::erfc(x / std::f64::consts::SQRT_2);
        for (d0, width) in [(0.3, 1.8), (0.9, 1.8), (1.7, 2.0), (2.2, 2.5), (1.5, 3.0)] {
            let terms = (0..20).map(|k| 2.0 * f64::from(k) * width);
            let exact: f64 = terms
                .map(|w| erfc(w + d0) - erfc(w + 2.0 * width - d0))
                .sum();
            let (n, farthest) = (20_000, 9.0);
            let mass = (0..n).map(|i| {
                let end = -farthest + 2.0 * farthest * (f64::from(i) + 0.5) / f64::from(n);
                let (d1, o0) = (d0 - end, width - d0);
                first_meeting_probability((d0, d1), (o0, width - d1), 1.0)
                    * (-0.5 * end * end).exp()
            });
            let got =
                mass.sum::<f64>() * 2.0 * farthest / f64::from(n) / std::f64::consts::TAU.sqrt();
            assert!(
                (got - exact).abs() < 2.0 * (-4.0 * width * width).exp() + 1e-6,
                "{d0} {width}: {got} {exact}"
            );
        }
    }
}
