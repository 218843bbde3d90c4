//! The Ornstein-Uhlenbeck process dv = -theta v dt + sigma dW, exactly.

/// The exact transition over a time h: v(t + h) = decay v(t) + kick xi, xi standard normal, with
///
/// ```text
/// decay = e^{-theta h},   kick = sigma sqrt((1 - e^{-2 theta h}) / (2 theta))
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// e^{-theta h}
    pub decay: f64,
    /// The standard deviation of what is added.
    pub kick: f64,
}

impl Transition {
    /// Over a time `h` >= 0, for theta > 0 and sigma >= 0. Without cancellation for any theta h (expm1).
    pub fn new(theta: f64, sigma: f64, h: f64) -> Self {
        Transition {
            decay: libm::exp(-theta * h),
            kick: sigma * (-libm::expm1(-2.0 * theta * h) / (2.0 * theta)).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Stream;

    /// v(h) given v(0) has mean e^{-theta h} v(0) and variance (sigma^2 / 2 theta)(1 - e^{-2 theta h}); for small theta h that is
    /// sigma^2 h (1 - theta h + ...), which subtraction would lose.
    #[test]
    fn mean_and_variance_are_those_of_the_process() {
        for (theta, sigma, h) in [(1.0, 1.0, 0.01), (3.0, 0.5, 2.0), (1e-8, 2.0, 1e-4), (5.0, 1.0, 1e3)] {
            let Transition { decay, kick } = Transition::new(theta, sigma, h);
            let y: f64 = theta * h;
            let series = 1.0 - y + 2.0 / 3.0 * y * y;
            let variance = if y < 1e-6 {
                sigma * sigma * h * series
            } else {
                sigma * sigma / (2.0 * theta) * (1.0 - (-2.0 * y).exp())
            };
            assert!((decay - (-y).exp()).abs() <= 1e-15);
            assert!((kick * kick / variance - 1.0).abs() < 1e-13, "{theta} {sigma} {h}");
        }
    }

    /// Chapman-Kolmogorov: decays multiply, and variances add after decay.
    #[test]
    fn two_half_steps_have_the_law_of_one() {
        for h in [1e-9, 1e-3, 0.7, 40.0] {
            let (half, whole) = (Transition::new(1.3, 0.7, h / 2.0), Transition::new(1.3, 0.7, h));
            assert!((half.decay * half.decay - whole.decay).abs() < 1e-15);
            let variance = half.kick.powi(2) * (1.0 + half.decay.powi(2));
            assert!((variance / whole.kick.powi(2) - 1.0).abs() < 1e-14, "{h}");
        }
    }

    /// Null: started from N(0, sigma^2 / 2 theta), v(n h) keeps that law, and corr(v(0), v(n h)) = e^{-theta n h}. 2^16 paths, 20 steps.
    /// The sample variance has relative sd sqrt(2/N) = 0.0055 and the correlation sd below 1/sqrt(N) = 0.0039: bounds at 4 sd,
    /// false-alarm rate below 2e-4. A factor 2 in the variance, or one step of decay more (0.11), would be seen at once.
    #[test]
    fn a_stationary_start_stays_stationary_and_forgets_at_the_right_rate() {
        let (theta, sigma, h, paths) = (0.8, 1.7, 0.1, 1 << 16);
        let Transition { decay, kick } = Transition::new(theta, sigma, h);
        let stationary = sigma * sigma / (2.0 * theta);
        let (mut variance, mut product) = (0.0, 0.0);
        for path in 0..paths {
            let mut stream = Stream::new(7, path);
            let start = stationary.sqrt() * stream.normal();
            let end = (0..20).fold(start, |v, _| decay * v + kick * stream.normal());
            variance += end * end;
            product += start * end;
        }
        let n = paths as f64;
        assert!((variance / n / stationary - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "{}", variance / n / stationary);
        assert!(
            (product / n / stationary - (-theta * 2.0).exp()).abs() < 4.0 / n.sqrt(),
            "{}",
            product / n / stationary
        );
    }
}
