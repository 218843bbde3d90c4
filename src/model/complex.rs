//! The few complex operations that exponentials of decaying and oscillating terms need.

use std::ops::{Add, Div, Mul, Sub};

/// The complex number re + i im.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Complex<L = f64> {
    /// Real part.
    pub re: L,
    /// Imaginary part.
    pub im: L,
}

impl Complex {
    /// The number 0.
    pub const ZERO: Complex = Complex { re: 0.0, im: 0.0 };
    /// The number 1.
    pub const ONE: Complex = Complex { re: 1.0, im: 0.0 };

    /// re + i im.
    pub const fn new(re: f64, im: f64) -> Self {
        Complex { re, im }
    }

    /// e^{i angle}.
    pub fn unit(angle: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Complex { re: cos, im: sin }
    }

    /// e^self.
    pub fn exp(self) -> Self {
        Complex::unit(self.im) * libm::exp(self.re)
    }

    /// e^self - 1 without cancellation: e^{a+ib} - 1 = (e^a - 1) cos b - 2 sin^2(b/2) + i e^a sin
    /// b.
    pub fn exp_m1(self) -> Self {
        let growth = libm::expm1(self.re);
        let half = libm::sin(0.5 * self.im);
        let (sin, cos) = libm::sincos(self.im);
        Complex {
            re: growth * cos - 2.0 * half * half,
            im: (growth + 1.0) * sin,
        }
    }

    /// |self|.
    pub fn abs(self) -> f64 {
        libm::hypot(self.re, self.im)
    }
}

impl Add for Complex {
    type Output = Complex;
    fn add(self, other: Complex) -> Complex {
        Complex {
            re: self.re + other.re,
            im: self.im + other.im,
        }
    }
}

impl Sub for Complex {
    type Output = Complex;
    fn sub(self, other: Complex) -> Complex {
        Complex {
            re: self.re - other.re,
            im: self.im - other.im,
        }
    }
}

impl Mul for Complex {
    type Output = Complex;
    fn mul(self, other: Complex) -> Complex {
        Complex {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}

impl Mul<f64> for Complex {
    type Output = Complex;
    fn mul(self, factor: f64) -> Complex {
        Complex {
            re: self.re * factor,
            im: self.im * factor,
        }
    }
}

impl Div for Complex {
    type Output = Complex;
    /// Scaled by the divisor's modulus, so that |divisor|^2 neither overflows nor underflows.
    fn div(self, other: Complex) -> Complex {
        let modulus = other.abs();
        let unit = Complex {
            re: other.re / modulus,
            im: -other.im / modulus,
        };
        (self * unit) * (1.0 / modulus)
    }
}
