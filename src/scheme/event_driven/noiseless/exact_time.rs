//! Time in double-double precision, so that phases do not drift over many periods.
//!
//! At t = 1e6 a double resolves 1e-10. A phase w t that is rounded there, or a time that is summed
//! from 1e5 durations, would move events by as much. Here a time is an unevaluated sum hi + lo of
//! two doubles (Dekker 1971; Knuth's two-sum), whose relative error is below 1e-31, and w t is
//! reduced modulo 2 pi from its exact product.

use crate::model::{Complex, ForcingTerm};

/// A time hi + lo, with |lo| at most half a unit in the last place of hi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactTime {
    hi: f64,
    lo: f64,
}

impl ExactTime {
    /// t = 0.
    pub const ZERO: ExactTime = ExactTime { hi: 0.0, lo: 0.0 };

    /// This time plus a duration.
    pub fn after(self, duration: f64) -> Self {
        let (sum, error) = two_sum(self.hi, duration);
        let (hi, lo) = two_sum(sum, error + self.lo);
        ExactTime { hi, lo }
    }

    /// The double nearest to this time.
    pub fn value(self) -> f64 {
        self.hi
    }

    /// t minus this time, for a time t given as a double.
    pub fn until(self, t: f64) -> f64 {
        (t - self.hi) - self.lo
    }

    /// P = F e^{z t} for a forcing term, where the angle w t is correct to rounding after its
    /// reduction modulo 2 pi.
    pub fn phased(self, term: &ForcingTerm) -> Complex {
        let ForcingTerm { amplitude, rate } = *term;
        // w hi = angle + error exactly. The sine and cosine of libm reduce `angle` modulo 2 pi with
        // all its digits (Payne and Hanek).
        let angle = rate.im * self.hi;
        let error = libm::fma(rate.im, self.hi, -angle) + rate.im * self.lo;
        amplitude * Complex::unit(angle) * Complex::unit(error) * libm::exp(rate.re * self.hi)
    }
}

/// a + b = sum + error exactly (Knuth, TAOCP 2, section 4.2.2).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_kept = sum - a;
    (sum, (a - (sum - b_kept)) + (b - b_kept))
}
