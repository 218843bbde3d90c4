//! How long a step may be before slips grow without bound.

use super::SchemeKind;
use crate::model::Oscillator;
use std::f64::consts::PI;

/// What keeps a time-stepping scheme from growing without bound in slip.
///
/// The discrete variational inequality multiplies (X, V) by 1 + h lambda along each eigenvector, where lambda solves
/// m lambda^2 + 2 alpha lambda + K = 0. The corrected one moves with the new velocity: see [`Stability::NewVelocity`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stability {
    /// alpha = 0: |1 + i h w0| > 1 for every h. The amplitude grows by exp(pi w0 h / 2) per half-cycle while friction
    /// takes 2 f_d / K from it; the two balance at A_c = 4 f_d / (pi w0 h K), above which it grows without bound.
    Undamped {
        /// A_c.
        critical_amplitude: f64,
    },
    /// alpha^2 < K m: |1 + h lambda| < 1 iff h < 2 alpha / K.
    Underdamped {
        /// 2 alpha / K.
        largest_step: f64,
    },
    /// alpha^2 >= K m: |1 + h lambda| < 1 for both lambda iff h < 2 / |lambda_max|.
    Overdamped {
        /// 2 / |lambda_max|, where |lambda_max| = (alpha + sqrt(alpha^2 - K m)) / m.
        largest_step: f64,
    },
    /// The corrected scheme. Its multipliers solve mu^2 - (2 - a - c) mu + 1 - a = 0 with a = 2 alpha h/m, c = (h w0)^2; both
    /// lie within the unit circle iff 2 a + c < 4 (on it without damping: the amplitude neither grows nor decays).
    NewVelocity {
        /// 2 / (w0 (z + sqrt(1 + z^2))), where z = alpha / (m w0).
        largest_step: f64,
    },
}

impl Stability {
    pub(super) fn new(scheme: SchemeKind, oscillator: &Oscillator, dynamic_force: f64, h: f64) -> Self {
        let Oscillator { mass: m, stiffness: k, damping: alpha, .. } = *oscillator;
        let w0 = oscillator.natural_frequency();
        // alpha / sqrt(K m), formed without the product K m, which may overflow.
        let ratio = alpha / (m * w0);
        if scheme == SchemeKind::CorrectedVi {
            Stability::NewVelocity { largest_step: 2.0 / (w0 * (ratio + ratio.hypot(1.0))) }
        } else if alpha == 0.0 {
            Stability::Undamped { critical_amplitude: 4.0 * dynamic_force / (PI * w0 * h * k) }
        } else if ratio < 1.0 {
            Stability::Underdamped { largest_step: 2.0 * alpha / k }
        } else {
            Stability::Overdamped { largest_step: 2.0 / (w0 * (ratio + (ratio * ratio - 1.0).sqrt())) }
        }
    }
}
