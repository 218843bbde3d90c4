//! The Ornstein-Uhlenbeck process dv = -theta v dt + sigma dW, exactly, over any time h.
//!
//! ```text
//! transition   v(t + h) = e^{-theta h} v(t) + sigma sqrt((1 - e^{-2 theta h})/(2 theta)) xi
//! time change  v cosh(theta h/2)/cosh(theta (t - h/2)) is a Brownian bridge, if v(0), v(h) are known
//! ```
//!
//! Here xi is a standard normal. The time change is that of Doob (Annals of Mathematics 43, 1942),
//! followed by the projective map of a Brownian bridge that makes it symmetric in both ends.

use crate::lanes::{Lanes, cosh_and_sinh_over, log1p};

/// The exact transition over a time h: v(t + h) = decay v(t) + increment_sd xi, xi standard normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// e^{-theta h}.
    pub decay: f64,
    /// sigma sqrt((1 - e^{-2 theta h})/(2 theta)), the standard deviation of v(t + h) given v(t).
    pub increment_sd: f64,
}

impl Transition {
    /// The transition over a time `h` >= 0, for theta > 0 and sigma >= 0. It uses expm1, so it does
    /// not cancel for any theta h.
    pub fn new(theta: f64, sigma: f64, h: f64) -> Self {
        let increment_sd = sigma * (forgotten(theta, h) / (2.0 * theta)).sqrt();
        Transition {
            decay: libm::exp(-theta * h),
            increment_sd,
        }
    }

    /// v(t + h) from v(t) and a standard normal.
    #[inline(always)]
    pub fn next(&self, v: f64, xi: f64) -> f64 {
        self.decay * v + self.increment_sd * xi
    }
}

/// The square of [`Transition::increment_sd`], with one rounding fewer.
pub fn increment_variance(theta: f64, sigma: f64, h: f64) -> f64 {
    sigma * sigma * forgotten(theta, h) / (2.0 * theta)
}

/// The process over a time h, given both ends, as a Brownian bridge with the same ends. The
/// fraction of the bridge that has elapsed at time t is
///
/// ```text
/// u = (1 + tanh(theta (t - h/2))/tanh(theta h/2))/2 = X/(shrink X + stretch),   X = e^{2 theta t} - 1
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeChange<L = f64> {
    /// S = sigma^2 sinh(theta h)/theta, the duration of the Brownian bridge.
    pub duration: L,
    /// (8/theta^2) (cosh(theta h/2) - 1) = h^2 (1 + (theta h)^2/48 + ..). A threshold U of v
    /// becomes a threshold of the Brownian bridge, with the same distances at both ends. At a
    /// fraction u it deviates from a straight line by -c bow u (1 - u)/2, where c = U'' - theta^2
    /// U. This is exact up to (theta h)^2/16 of itself if c is constant.
    pub bow: L,
    /// 1 - e^{-theta h}.
    shrink: L,
    /// 2 sinh(theta h).
    stretch: L,
}

impl TimeChange {
    /// The time change over a time `h` >= 0, for theta > 0 and sigma >= 0.
    #[inline(always)]
    pub fn new(theta: f64, sigma: f64, h: f64) -> Self {
        if theta * h <= 1.0 {
            Self::short(theta, sigma, h)
        } else {
            Self::long(theta, sigma, h)
        }
    }

    #[inline(never)]
    fn long(theta: f64, sigma: f64, h: f64) -> Self {
        let (sinh, quarter) = (libm::sinh(theta * h), libm::sinh(0.25 * theta * h));
        TimeChange {
            duration: sigma * sigma * sinh / theta,
            bow: 16.0 * quarter * quarter / (theta * theta),
            shrink: -libm::expm1(-theta * h),
            stretch: 2.0 * sinh,
        }
    }
}

impl<L: Lanes> TimeChange<L> {
    /// The time change for y = theta h <= 1, in terms of c = cosh y and s = sinh(y)/y.
    #[inline(always)]
    pub fn short(theta: f64, sigma: f64, h: L) -> Self {
        let y = h * theta;
        let y2 = y * y;
        let (c, s) = cosh_and_sinh_over(y2);
        let sinh = y * s;
        // The first omitted term is y^6/1290240.
        let bow = h * h * ((y2 * (1.0 / 120.0) + 1.0) * y2 * (1.0 / 48.0) + 1.0);
        TimeChange {
            duration: h * s * (sigma * sigma),
            bow,
            shrink: L::splat(1.0) - c + sinh,
            stretch: sinh * 2.0,
        }
    }

    /// The time t at which a fraction u of the Brownian bridge has passed.
    #[inline(always)]
    pub fn time_at(&self, theta: f64, u: L) -> L {
        let x = self.stretch * u / (L::splat(1.0) - u * self.shrink);
        log1p(x) * (0.5 / theta)
    }
}

/// The bridge half-way between two values n0 and n1 a time `h` apart: the factor of n0 + n1 in the
/// mean, and the standard deviation.
///
/// ```text
/// mean = (n0 + n1)/(2 cosh(theta h/2)),   variance = sigma^2/(2 theta) tanh(theta h/2)
/// ```
#[inline(always)]
pub fn bridge_middle(theta: f64, sigma: f64, h: f64) -> (f64, f64) {
    if theta * h <= 1.0 {
        return short_bridge_middle(theta, sigma, h);
    }
    let half = 0.5 * theta * h;
    let variance = sigma * sigma * libm::tanh(half) / (2.0 * theta);
    (0.5 / libm::cosh(half), variance.sqrt())
}

/// [`bridge_middle`] for theta h <= 1.
#[inline(always)]
pub fn short_bridge_middle<L: Lanes>(theta: f64, sigma: f64, h: L) -> (L, L) {
    let half = h * (0.5 * theta);
    let (c, s) = cosh_and_sinh_over(half * half);
    let inverse = L::splat(1.0) / c;
    (inverse * 0.5, (h * s * inverse).sqrt() * (0.5 * sigma))
}

/// The bridge between two known values n0 and n1, a time `before` after the first and `behind`
/// before the second: its mean and its standard deviation.
#[inline(always)]
pub fn bridge_at(
    theta: f64,
    sigma: f64,
    before: f64,
    behind: f64,
    (n0, n1): (f64, f64),
) -> (f64, f64) {
    let whole = before + behind;
    if theta * whole > 1.0 {
        return long_bridge_at(theta, sigma, before, behind, (n0, n1));
    }
    short_bridge_at(theta, sigma, before, behind, (n0, n1))
}

/// [`bridge_at`] for theta (before + behind) <= 1. With S(t) = sinh(theta t)/theta, the mean is (n0
/// S(behind) + n1 S(before))/S(whole) and the variance sigma^2 S(before) S(behind)/S(whole).
#[inline(always)]
pub fn short_bridge_at<L: Lanes>(
    theta: f64,
    sigma: f64,
    before: L,
    behind: L,
    (n0, n1): (L, L),
) -> (L, L) {
    let inverse = L::splat(1.0) / sinh_over(theta, before + behind);
    let (before, behind) = (sinh_over(theta, before), sinh_over(theta, behind));
    (
        (n0 * behind + n1 * before) * inverse,
        (before * behind * inverse).sqrt() * sigma,
    )
}

/// sinh(theta t)/theta for theta t <= 1.
#[inline(always)]
fn sinh_over<L: Lanes>(theta: f64, t: L) -> L {
    let y = t * theta;
    t * cosh_and_sinh_over(y * y).1
}

#[inline(never)]
fn long_bridge_at(
    theta: f64,
    sigma: f64,
    before: f64,
    behind: f64,
    (n0, n1): (f64, f64),
) -> (f64, f64) {
    let (to, from) = (
        Transition::new(theta, sigma, before),
        Transition::new(theta, sigma, behind),
    );
    let (q0, q1) = (
        to.increment_sd * to.increment_sd,
        from.increment_sd * from.increment_sd,
    );
    let all = from.decay * from.decay * q0 + q1;
    (
        (to.decay * n0 * q1 + from.decay * q0 * n1) / all,
        to.increment_sd * from.increment_sd / all.sqrt(),
    )
}

/// 1 - e^{-2 theta h}, the fraction of the stationary variance that does not come from the start.
fn forgotten(theta: f64, h: f64) -> f64 {
    -libm::expm1(-2.0 * theta * h)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Stream;

    /// v(h) given v(0) has mean e^{-theta h} v(0) and variance (sigma^2 / 2 theta)(1 - e^{-2 theta
    /// h}). For small theta h the variance is sigma^2 h (1 - theta h + ...), which subtraction
    /// would lose.
    #[test]
    fn mean_and_variance_are_those_of_the_process() {
        for (theta, sigma, h) in [
            (1.0, 1.0, 0.01),
            (3.0, 0.5, 2.0),
            (1e-8, 2.0, 1e-4),
            (5.0, 1.0, 1e3),
        ] {
            let Transition {
                decay,
                increment_sd,
            } = Transition::new(theta, sigma, h);
            let y: f64 = theta * h;
            let series = 1.0 - y + 2.0 / 3.0 * y * y;
            let variance = if y < 1e-6 {
                sigma * sigma * h * series
            } else {
                sigma * sigma / (2.0 * theta) * (1.0 - (-2.0 * y).exp())
            };
            assert!((decay - (-y).exp()).abs() <= 1e-15);
            assert!(
                (increment_sd * increment_sd / variance - 1.0).abs() < 1e-13,
                "{theta} {sigma} {h}"
            );
            assert!(
                (increment_variance(theta, sigma, h) / variance - 1.0).abs() < 1e-13,
                "{theta} {sigma} {h}"
            );
        }
    }

    /// Chapman-Kolmogorov: the decays of two half steps multiply, and their variances add after the
    /// decay.
    #[test]
    fn two_half_steps_have_the_law_of_one() {
        for h in [1e-9, 1e-3, 0.7, 40.0] {
            let (half, whole) = (
                Transition::new(1.3, 0.7, h / 2.0),
                Transition::new(1.3, 0.7, h),
            );
            assert!((half.decay * half.decay - whole.decay).abs() < 1e-15);
            let variance = half.increment_sd.powi(2) * (1.0 + half.decay.powi(2));
            assert!(
                (variance / whole.increment_sd.powi(2) - 1.0).abs() < 1e-14,
                "{h}"
            );
        }
    }

    /// Null: started from N(0, sigma^2 / 2 theta), v(n h) keeps that law, and corr(v(0), v(n h)) =
    /// e^{-theta n h}. 2^16 paths, 20 steps. The sample variance has relative sd sqrt(2/N) = 0.0055
    /// and the correlation sd below 1/sqrt(N) = 0.0039. The bounds are at 4 sd, so the false-alarm
    /// rate is below 2e-4. A factor 2 in the variance, or one step of decay more (0.11), would fail
    /// at once.
    #[test]
    fn a_stationary_start_stays_stationary() {
        let (theta, sigma, h, paths) = (0.8, 1.7, 0.1, 1 << 16);
        let transition = Transition::new(theta, sigma, h);
        let stationary = sigma * sigma / (2.0 * theta);
        let (mut variance, mut product) = (0.0, 0.0);
        for path in 0..paths {
            let mut stream = Stream::new(7, path);
            let start = stationary.sqrt() * stream.normal();
            let end = (0..20).fold(start, |v, _| transition.next(v, stream.normal()));
            variance += end * end;
            product += start * end;
        }
        let n = paths as f64;
        assert!(
            (variance / n / stationary - 1.0).abs() < 4.0 * (2.0 / n).sqrt(),
            "{}",
            variance / n / stationary
        );
        assert!(
            (product / n / stationary - (-theta * 2.0).exp()).abs() < 4.0 / n.sqrt(),
            "{}",
            product / n / stationary
        );
    }
    /// A Brownian bridge over S has the variance S u (1 - u) at a fraction u, and its mean is
    /// linear in u. The scale between v and the bridge is cosh(theta h/2)/cosh(theta (t - h/2)).
    /// Mean and variance of v at t, given both ends, are compared with [`bridge_at`]. The deviation
    /// of the threshold U = 1 from a straight line is compared with the one that `bow` gives, in
    /// the middle and at a quarter.
    #[test]
    fn the_time_change_makes_a_brownian_bridge() {
        for (theta, sigma, h) in [
            (1.0, 1.0, 0.01),
            (3.0, 0.5, 2.0),
            (1e-8, 2.0, 1e-4),
            (1.0, 1.5, 0.5),
            (0.3, 1.0, 30.0),
        ] {
            let change = TimeChange::new(theta, sigma, h);
            let ends = (0.7, -1.1);
            for u in [0.03, 0.25, 0.5, 0.9] {
                let t = change.time_at(theta, u);
                let scale: f64 = libm::cosh(0.5 * theta * h) / libm::cosh(theta * (t - 0.5 * h));
                let (mean, sd) = bridge_at(theta, sigma, t, h - t, ends);
                let straight = ends.0 + u * (ends.1 - ends.0);
                assert!(
                    (mean * scale - straight).abs() < 1e-12,
                    "{theta} {h} {u}: {mean} {scale}"
                );
                let variance = change.duration * u * (1.0 - u);
                assert!(
                    ((sd * scale).powi(2) / variance - 1.0).abs() < 1e-11,
                    "{theta} {h} {u}"
                );
                if theta * h <= 1.0 && theta * h > 1e-3 {
                    let bent = 0.5 * theta * theta * change.bow * u * (1.0 - u);
                    let bound = if u == 0.5 {
                        1e-6
                    } else {
                        (theta * h).powi(2) / 16.0 + 1e-6
                    };
                    assert!(
                        ((scale - 1.0) / bent - 1.0).abs() < bound,
                        "{theta} {h} {u}: {scale} {bent}"
                    );
                }
            }
            assert!(
                (change.time_at(theta, 1.0) / h - 1.0).abs() < 1e-12,
                "{theta} {h}"
            );
        }
    }

    /// The law of the bridge from the densities of both its parts: n0 -> n has precision 1/q0
    /// around its mean, and n -> n1 depends on n through the decay. The test covers both forms of
    /// the formula, on either side of theta h = 1, and the middle.
    #[test]
    fn the_bridge_is_where_both_its_halves_put_it() {
        for (theta, sigma, before, behind) in [
            (1.0, 1.0, 0.2, 0.3),
            (0.5, 2.0, 1e-6, 0.4),
            (3.0, 0.5, 0.1, 0.9),
            (1.0, 1.0, 0.5, 0.5),
            (2.0, 1.0, 3.0, 3.0),
        ] {
            let (n0, n1) = (0.7, -1.1);
            let (to, from) = (
                Transition::new(theta, sigma, before),
                Transition::new(theta, sigma, behind),
            );
            let (q0, q1) = (to.increment_sd.powi(2), from.increment_sd.powi(2));
            let precision = 1.0 / q0 + from.decay * from.decay / q1;
            let expected = (to.decay * n0 / q0 + from.decay * n1 / q1) / precision;
            let (mean, sd) = bridge_at(theta, sigma, before, behind, (n0, n1));
            assert!(
                (mean - expected).abs() < 1e-12 && (sd * sd * precision - 1.0).abs() < 1e-12,
                "{theta}: {mean} {sd}"
            );
            if before == behind {
                let (weight, middle) = bridge_middle(theta, sigma, before + behind);
                assert!(
                    (weight * (n0 + n1) - expected).abs() < 1e-12
                        && (middle / sd - 1.0).abs() < 1e-12
                );
            }
        }
    }
}
