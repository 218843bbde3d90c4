//! The response of the free oscillator to an impulse and to an exponential force, for any damping
//! and at any resonance.
//!
//! The oscillator y'' + 2 gamma y' + w0^2 y has the characteristic roots l1, l2 = -gamma +-
//! sqrt(gamma^2 - w0^2). Its response to a unit impulse, and to a force e^{z t} switched on at t =
//! 0, are *divided differences* of the exponential over its roots (r is the time since then):
//!
//! ```text
//! S(r)   = exp[l1, l2]    = (e^{l1 r} - e^{l2 r}) / (l1 - l2)
//! G_z(r) = exp[z, l1, l2] = int_0^r S(r - u) e^{z u} du,        G_z' = z G_z + S
//! ```
//!
//! In this form critical damping (l1 = l2) and resonance (z = l1) need no special formula, because
//! a divided difference is an entire function of its arguments. It only has to be evaluated without
//! subtracting nearly equal numbers:
//!
//! - for small r (all |root| r <= 1), by its Taylor series, which starts at the leading term r^2/2;
//! - otherwise as a difference quotient over the two roots farthest apart. The first-order
//!   differences inside use sinh(q)/q where their own roots are close;
//! - where all three roots are close together and away from 0, by the Taylor series of the same
//!   difference about the centre of l1 and l2, because the quotient would be 0/0. It happens for
//!   z = -theta, with theta = gamma = w0.

use super::complex::Complex;

/// Below this value of |root| r the Taylor series is used: 1/n! falls below 2^-53 within
/// `TAYLOR_TERMS`.
const TAYLOR_RADIUS: f64 = 1.0;

/// Terms of the Taylor series: with |root| r <= 1, term k is below (k+1)/(k+2)! of the leading one,
/// which is 1e-17 at k = 18.
const TAYLOR_TERMS: usize = 20;

/// The oscillator without a force: gamma = alpha/m, w0^2 = K/m, and the characteristic roots.
#[derive(Clone, Copy, Debug)]
pub struct ImpulseResponse {
    /// gamma.
    damping_rate: f64,
    /// w0^2.
    stiffness_ratio: f64,
    /// The characteristic roots; of two real ones, the slow one first.
    pub roots: [Complex; 2],
}

impl ImpulseResponse {
    /// The oscillator with gamma = alpha/m, which may be negative, and w0 >= 0.
    pub fn new(damping_rate: f64, natural_frequency: f64) -> Self {
        let (g, w0) = (damping_rate, natural_frequency);
        let discriminant = (g - w0) * (g + w0);
        let root = libm::sqrt(discriminant.abs());
        let roots = if discriminant < 0.0 {
            [Complex::new(-g, root), Complex::new(-g, -root)]
        } else {
            // The slow root is w0^2 divided by the fast one, because gamma - root would cancel.
            let fast = g + root.copysign(g);
            let slow = if w0 == 0.0 { 0.0 } else { w0 * (w0 / fast) };
            [Complex::new(-slow, 0.0), Complex::new(-fast, 0.0)]
        };
        ImpulseResponse {
            damping_rate: g,
            stiffness_ratio: w0 * w0,
            roots,
        }
    }

    /// S(r).
    pub fn impulse(&self, r: f64) -> f64 {
        first_difference(self.roots[0], self.roots[1], r).re
    }

    /// S'(r) = l1 S + e^{l2 r}. In this form an overdamped motion keeps its digits, however small
    /// it has become.
    pub fn impulse_slope(&self, r: f64) -> f64 {
        let [l1, l2] = self.roots;
        (l1 * first_difference(l1, l2, r) + (l2 * r).exp()).re
    }

    /// G_z(r).
    pub fn exponential(&self, z: Complex, r: f64) -> Complex {
        let [l1, l2] = self.roots;
        let largest = z.abs().max(l1.abs()).max(l2.abs());
        if largest * r <= TAYLOR_RADIUS {
            return self.taylor(z, r, 2) * (r * r);
        }
        let (a, b, c) = farthest_apart(z, l1, l2);
        if (a - c).abs() * r <= TAYLOR_RADIUS {
            // exp[z, l1, l2] = e^{-gamma r} exp[z + gamma, l1 + gamma, l2 + gamma].
            let gamma = Complex::new(self.damping_rate, 0.0);
            let half_gap = (l1 - l2) * 0.5;
            let centred = ImpulseResponse {
                damping_rate: 0.0,
                stiffness_ratio: -(half_gap * half_gap).re,
                roots: [half_gap, Complex::ZERO - half_gap],
            };
            return centred.taylor(z + gamma, r, 2) * (r * r * libm::exp(-self.damping_rate * r));
        }
        (first_difference(a, b, r) - first_difference(b, c, r)) / (a - c)
    }

    /// G_z'(r) from `response` = G_z(r) and `impulse` = S(r).
    ///
    /// G_z' = a G_z + exp[b, c] for any order a, b, c of the roots z, l1, l2. The smallest root is
    /// taken as a, so that the two terms are of the size of their sum. The form z G_z + S would
    /// cancel where the force is faster than the oscillator.
    pub fn exponential_slope(
        &self,
        z: Complex,
        r: f64,
        response: Complex,
        impulse: f64,
    ) -> Complex {
        let [l1, l2] = self.roots;
        if z.abs() <= l1.abs() {
            z * response + Complex::new(impulse, 0.0)
        } else {
            l1 * response + first_difference(z, l2, r)
        }
    }

    /// G_z(r) - G_0(r), the response to e^{z t} - 1, a force that is zero when it is switched on.
    pub fn exponential_from_zero(&self, z: Complex, r: f64) -> Complex {
        let largest = z.abs().max(self.roots[0].abs()).max(self.roots[1].abs());
        if largest * r <= TAYLOR_RADIUS {
            return z * self.taylor(z, r, 3) * (r * r * r);
        }
        self.exponential(z, r) - self.exponential(Complex::ZERO, r)
    }

    /// int_0^r G_0, the response to a force that grows as r.
    pub fn ramp(&self, r: f64) -> f64 {
        if self.roots[0].abs().max(self.roots[1].abs()) * r <= TAYLOR_RADIUS {
            return self.taylor(Complex::ZERO, r, 3).re * (r * r * r);
        }
        let [slow, fast] = self.roots;
        let settled = self.exponential(Complex::ZERO, r).re;
        if fast.im == 0.0 && slow.abs() * r <= TAYLOR_RADIUS {
            // exp[0, 0, l1, l2] as a difference quotient over 0 and the fast root. The equation of
            // the oscillator, which is used below, would be divided by a K that is nearly zero.
            let without = ImpulseResponse {
                damping_rate: -0.5 * slow.re,
                stiffness_ratio: 0.0,
                roots: [Complex::ZERO, slow],
            };
            return (settled - without.exponential(Complex::ZERO, r).re) / fast.re;
        }
        // The displacement follows from the equation of the oscillator.
        (r - self.impulse(r) - 2.0 * self.damping_rate * settled) / self.stiffness_ratio
    }

    /// sum_k H_k r^k / (k + n)! where H_k is the complete homogeneous symmetric polynomial of z,
    /// l1, l2. Its generating function 1/((1 - z t)(1 + 2 gamma t + w0^2 t^2)) gives H_k = z^k - 2
    /// gamma H_{k-1} - w0^2 H_{k-2}.
    fn taylor(&self, z: Complex, r: f64, n: u32) -> Complex {
        let mut power = Complex::ONE;
        let (mut h, mut h_before) = (Complex::ONE, Complex::ZERO);
        let mut factorial: f64 = (1..=n).map(f64::from).product();
        let mut sum = h * (1.0 / factorial);
        for k in 1..TAYLOR_TERMS {
            power = power * z * r;
            let next = power
                - h * (2.0 * self.damping_rate * r)
                - h_before * (self.stiffness_ratio * r * r);
            (h_before, h) = (h, next);
            factorial *= k as f64 + f64::from(n);
            sum = sum + h * (1.0 / factorial);
        }
        sum
    }
}

/// exp[a, b] at r: r e^{(a+b) r/2} sinh(q)/q with q = (a - b) r/2, or the plain quotient where q is
/// not small.
fn first_difference(a: Complex, b: Complex, r: f64) -> Complex {
    let gap = a - b;
    if gap.abs() * r > TAYLOR_RADIUS {
        return ((a * r).exp() - (b * r).exp()) / gap;
    }
    let q = gap * (0.5 * r);
    let q2 = q * q;
    // sinh(q)/q = sum q^{2k}/(2k+1)!; |q| <= 1/2, so the ninth term is below 1e-17.
    let mut series = Complex::ONE;
    for k in (1..9).rev() {
        series = Complex::ONE + q2 * series * (1.0 / (2 * k * (2 * k + 1)) as f64);
    }
    ((a + b) * (0.5 * r)).exp() * series * r
}

/// The three roots in an order in which the first and the last are the two farthest apart.
fn farthest_apart(a: Complex, b: Complex, c: Complex) -> (Complex, Complex, Complex) {
    let (ab, bc, ac) = ((a - b).abs(), (b - c).abs(), (a - c).abs());
    if ac >= ab && ac >= bc {
        (a, b, c)
    } else if ab >= bc {
        (a, c, b)
    } else {
        (b, a, c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// G_z by brute force: Simpson's rule on the convolution, which uses no divided differences.
    fn convolution(gamma: f64, w0: f64, z: Complex, r: f64) -> Complex {
        let n = 20_000;
        let d2 = gamma * gamma - w0 * w0;
        let s = |u: f64| {
            let e = (-gamma * u).exp();
            if d2 == 0.0 {
                e * u
            } else if d2 < 0.0 {
                e * ((-d2).sqrt() * u).sin() / (-d2).sqrt()
            } else {
                e * (d2.sqrt() * u).sinh() / d2.sqrt()
            }
        };
        let step = r / n as f64;
        (0..=n).fold(Complex::ZERO, |sum, i| {
            let u = i as f64 * step;
            let weight = if i == 0 || i == n {
                1.0
            } else {
                2.0 + 2.0 * (i % 2) as f64
            };
            sum + (z * u).exp() * (s(r - u) * weight * step / 3.0)
        })
    }

    #[test]
    fn the_response_agrees_with_the_convolution() {
        for (gamma, w0) in [
            (0.0, 1.0),
            (0.3, 1.0),
            (1.0, 1.0),
            (1.0 + 1e-9, 1.0),
            (1.0 - 1e-7, 1.0),
            (3.0, 1.0),
        ] {
            let free = ImpulseResponse::new(gamma, w0);
            for z in [0.0, 0.25, 1.0, 1.0 + 1e-9, 1.0 - 1e-5, 2.5].map(|w| Complex::new(0.0, w)) {
                for r in [1e-3, 0.2, 0.9, 1.1, 4.0, 12.0] {
                    let (fast, slow) = (free.exponential(z, r), convolution(gamma, w0, z, r));
                    // With 2e4 intervals the error of Simpson's rule is (12/2e4)^4 w^4 / 180 * r ~
                    // 1e-13 of its largest terms.
                    let scale = slow.abs().max(0.5 * r * r * (-gamma * r).exp());
                    assert!(
                        (fast - slow).abs() <= 1e-11 * scale,
                        "{gamma} {w0} {z:?} {r}: {fast:?} {slow:?}"
                    );
                    let difference = slow - convolution(gamma, w0, Complex::ZERO, r);
                    let fast = free.exponential_from_zero(z, r);
                    assert!(
                        (fast - difference).abs() <= 1e-11 * scale,
                        "{gamma} {w0} {z:?} {r}"
                    );
                }
            }
        }
    }

    #[test]
    fn nothing_is_lost_across_the_switches_between_formulas() {
        // The function is smooth to rounding just below and above |root| r = 1, and around
        // resonance.
        let free = ImpulseResponse::new(0.0, 1.0);
        let z = Complex::new(0.0, 1.0);
        let (below, above) = (free.exponential(z, 1.0), free.exponential(z, 1.0 + 1e-15));
        assert!(
            (below - above).abs() < 4e-15,
            "slope is below 1: a jump would be a lost digit"
        );
        // At exact resonance, G_i(r) = (e^{ir} r - sin r) / (2i).
        for r in [0.5f64, 2.0, 30.0, 1e4] {
            let exact =
                (Complex::unit(r) * r - Complex::new(r.sin(), 0.0)) / Complex::new(0.0, 2.0);
            let got = free.exponential(z, r);
            assert!(
                (got - exact).abs() <= 8.0 * f64::EPSILON * exact.abs().max(r),
                "{r}: {got:?} {exact:?}"
            );
        }
    }

    #[test]
    fn the_slope_keeps_its_digits_at_every_frequency_of_the_force() {
        // Without damping and with w0 = 1: G_z = (e^{zr} - cos r - z sin r)/(z^2 + 1), written for
        // a purely imaginary z = iw.
        let (free, r) = (ImpulseResponse::new(0.0, 1.0), 2.5f64);
        for w in [1e-8f64, 1e-3, 0.5, 3.0, 1e4, 1e8] {
            let z = Complex::new(0.0, w);
            let got = free.exponential_slope(z, r, free.exponential(z, r), free.impulse(r));
            let (sin, cos) = (w * r).sin_cos();
            let exact =
                Complex::new(r.sin() - w * sin, w * cos - w * r.cos()) * (1.0 / (1.0 - w * w));
            let scale = w.recip().min(1.0);
            assert!(
                (got - exact).abs() <= 16.0 * f64::EPSILON * scale,
                "{w}: {got:?} {exact:?}"
            );
        }
    }

    /// At theta = gamma = w0 the three roots are one, and the response is r^2 e^{-r}/2. Close to
    /// it, the closed form for theta apart from a double root holds, to the digits that it has
    /// left.
    #[test]
    fn three_equal_roots_have_the_limit_of_close_ones() {
        let critical = ImpulseResponse::new(1.0, 1.0);
        for r in [0.5, 1.5, 7.0, 40.0] {
            let exact = r * r / 2.0 * libm::exp(-r);
            let [there, near] =
                [0.0, 1e-9].map(|gap| critical.exponential(Complex::new(-1.0 - gap, 0.0), r).re);
            assert!(
                (there - exact).abs() <= 1e-15 * exact.max(there),
                "{r}: {there} {exact}"
            );
            assert!(
                (near - exact).abs() <= 1e-8 * (1.0 + r) * exact,
                "{r}: {near} {exact}"
            );
            // exp[-1-d, -1, -1] = e^{-r} (e^{-d r} - 1 + d r)/d^2
            for gap in [-0.02, 0.01, 0.3] {
                let z = Complex::new(-1.0 - gap, 0.0);
                let expected = libm::exp(-r) * (libm::expm1(-gap * r) + gap * r) / (gap * gap);
                let response = critical.exponential(z, r).re;
                assert!(
                    (response - expected).abs() <= 1e-11 * expected,
                    "{r} {gap}: {response} {expected}"
                );
            }
        }
        // Roots -gamma +- i w close to z = -gamma + d: the convolution of e^{-gamma t} sin(w t)/w
        // and e^{z t}.
        let (w0, d) = (1.01_f64, -0.05);
        let w = libm::sqrt(w0 * w0 - 1.0);
        for r in [1.1, 3.0, 3.4, 9.0] {
            let swing = libm::cos(w * r) + d / w * libm::sin(w * r);
            let expected = libm::exp(-r) * (libm::exp(d * r) - swing) / (d * d + w * w);
            let response = ImpulseResponse::new(1.0, w0)
                .exponential(Complex::new(-1.0 + d, 0.0), r)
                .re;
            assert!(
                (response - expected).abs() <= 1e-12 * expected,
                "{r}: {response} {expected}"
            );
        }
    }
}
