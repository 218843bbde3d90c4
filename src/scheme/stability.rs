//! How long a step may be before slips grow without bound.

/// What keeps a scheme with a step from growing without bound in slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stability {
    /// The explicit step of an undamped oscillator adds energy to a slip, however short it is.
    /// Above the critical amplitude friction takes less than that.
    Undamped {
        /// A_c = 4 f_d / (pi w0 h K).
        critical_amplitude: f64,
    },
    /// The explicit step of an underdamped oscillator, alpha^2 < K m, is stable below a limit.
    Underdamped {
        /// The limit: 2 alpha / K.
        largest_step: f64,
    },
    /// The explicit step of an overdamped oscillator, alpha^2 >= K m, is stable below a limit.
    Overdamped {
        /// The limit: 2 / |lambda_max|.
        largest_step: f64,
    },
    /// A step that moves with the new velocity is stable below a limit, whether there is damping or
    /// not.
    NewVelocity {
        /// The limit: 2 / (w0 (z + sqrt(1 + z^2))), where z = alpha / (m w0).
        largest_step: f64,
    },
}
