//! How long a step may be before slips grow without bound.

/// What keeps a scheme with a step from growing without bound in slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stability {
    /// Any step adds energy to an undamped slip, and friction takes it: above this amplitude less than is added.
    Undamped {
        /// A_c = 4 f_d / (pi w0 h K).
        critical_amplitude: f64,
    },
    /// The explicit step of an underdamped oscillator, alpha^2 < K m.
    Underdamped {
        /// It must stay below this: 2 alpha / K.
        largest_step: f64,
    },
    /// The explicit step of an overdamped oscillator, alpha^2 >= K m.
    Overdamped {
        /// It must stay below this: 2 / |lambda_max|.
        largest_step: f64,
    },
    /// A step that moves with the new velocity, damped or not.
    NewVelocity {
        /// It must stay below this: 2 / (w0 (z + sqrt(1 + z^2))), where z = alpha / (m w0).
        largest_step: f64,
    },
}
