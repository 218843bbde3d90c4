//! The first time at which a Brownian bridge meets a moving threshold.
//!
//! Let y be a Brownian motion over 0 <= s <= S with both ends known. The threshold is d0 > 0 above
//! y at the start, and d1 above y at the end (negative if it is below). For a threshold that is
//! linear in s only these distances matter, and the law is exact:
//!
//! ```text
//! P(met)          = exp(-2 d0 d1 / S) if d1 > 0, else 1
//! meeting place   s* = S q/(S + q),   q inverse-Gaussian with mean d0 S/|d1| and shape d0^2
//! ```
//!
//! (Borodin and Salminen, *Handbook of Brownian Motion*, 2.1 and IV; Karatzas and Shreve, section
//! 4.3.) The second line holds given that the threshold is met, for either sign of d1, by
//! reflection of the end.
//!
//! An Ornstein-Uhlenbeck process becomes Brownian motion by [`super::TimeChange`]. A threshold U(t)
//! of it becomes e^{theta t} U, whose second derivative in s is (U'' - theta^2 U) e^{-3 theta t} /
//! sigma^4.

use crate::lanes::{Choose, Lanes, exp};

/// P(met), the probability that the threshold is met; 1 where an end is on the threshold or beyond
/// it.
#[inline(always)]
pub fn meeting_probability<L: Lanes>(d0: L, d1: L, duration: L) -> L {
    let zero = L::splat(0.0);
    let is_met = L::or(d0.le(zero), d1.le(zero));
    L::select(is_met, L::splat(1.0), exp(d0 * -2.0 * d1 * (L::splat(1.0) / duration)))
}

/// The place s* of the first meeting, given that the threshold is met, from a standard normal and a
/// uniform number.
///
/// The inverse Gaussian is drawn by the method of Michael, Schucany and Haas (The American
/// Statistician 30, 1976). With y = normal^2, the smaller root of their quadratic is mu + mu^2 y/(2
/// l) - (mu/(2 l)) sqrt(4 mu l y + mu^2 y^2). Without its cancellation it is 4 l/(y (1 + g)^2), g =
/// sqrt(1 + 4 l/(mu y)), which stays finite as mu grows without bound (d1 -> 0).
#[inline(always)]
pub fn meeting_place<L: Lanes>(d0: L, d1: L, duration: L, normal: L, uniform: L) -> L {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    // Divisions are slow, so there are few, and those by y and by S serve both calls for one piece.
    // A normal that rounds to zero counts as a small one.
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
    L::select(d0.le(zero), zero, duration * upper / (duration * lower + upper))
}

/// E[u (1 - u)] at the place u = s/S where the bridge touches a straight threshold, for d0, d1 > 0.
/// It gives the mean deviation of a bent threshold from a straight one.
///
/// The touching place has the density of a hitting time from one end and, backwards, from the
/// other,
///
/// ```text
/// p(s) ~ s^{-3/2} (S-s)^{-3/2} exp(-d0^2/(2 s) - d1^2/(2 (S-s))),
/// ```
///
/// because a small shift e(s) of the threshold changes exp(-2 d0 d1/S) to first order by its mean
/// under p. With int_0^S s^{-1/2} (S-s)^{-1/2} exp(..) ds = pi erfc((d0+d1)/sqrt(2S)) and the
/// convolution of two hitting densities,
///
/// ```text
/// E[u (1-u)] = sqrt(pi/2) d0 d1 / (D sqrt S) erfcx(D/sqrt(2S)),   D = d0 + d1
/// ```
///
/// erfcx(z) is replaced by its upper bound (2/sqrt pi)/(z + sqrt(z^2 + 4/pi)), which is within 6 %
/// (Abramowitz and Stegun 7.1.13). This is enough for a correction that is itself small.
#[inline(always)]
pub fn mean_touching_spread<L: Lanes>(d0: L, d1: L, duration: L) -> L {
    let sum = d0 + d1;
    let sum2 = sum * sum;
    // sqrt(pi/2) d0 d1/(D sqrt S) (2/sqrt pi) / (z + sqrt(z^2 + 4/pi)) with z^2 = D^2/(2S),
    // multiplied through by sqrt(2S)/D = 1/z.
    let root = (duration * (8.0 * std::f64::consts::FRAC_1_PI) / sum2 + 1.0).sqrt();
    d0 * 2.0 * d1 / (sum2 * (root + 1.0))
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
                meeting_probability(0.5, end, total) * (-0.5 * z * z).exp()
            })
            .sum();
        let probability = sum * 2.0 * farthest / n as f64 / (2.0 * std::f64::consts::PI).sqrt();
        assert!((probability - exact).abs() < 1e-9, "{probability}");
    }

    #[test]
    fn touching_spread_agrees_with_its_density() {
        for (d0, d1) in [(0.1, 0.1), (0.3, 1.0), (1.0, 1.0), (2.0, 0.2), (3.0, 3.0)] {
            let (mut mass, mut mean) = (0.0, 0.0);
            let n = 400_000;
            for i in 0..n {
                // The substitution u = sin^2(phi) removes the singularities at both ends.
                let phi = std::f64::consts::FRAC_PI_2 * (i as f64 + 0.5) / f64::from(n);
                let u = phi.sin().powi(2);
                let jacobian = phi.sin() * phi.cos();
                let p = (u * (1.0 - u)).powf(-1.5) * (-d0 * d0 / (2.0 * u) - d1 * d1 / (2.0 * (1.0 - u))).exp();
                mass += p * jacobian;
                mean += u * (1.0 - u) * p * jacobian;
            }
            let (got, want) = (mean_touching_spread(d0, d1, 1.0), mean / mass);
            assert!((got / want - 1.0).abs() < 0.06, "{d0} {d1}: {got} {want}");
        }
    }
}
