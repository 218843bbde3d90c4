//! The limits beyond which slips of a scheme with a step grow without bound.

/// The condition under which slips of a scheme with a step stay bounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stability {
    /// The explicit step of an undamped oscillator adds energy to a slip, however short the step
    /// is. Above the critical amplitude, friction dissipates less energy than the step adds.
    Undamped {
        /// A_c = 4 f_d / (pi w0 h K), a length.
        critical_amplitude: f64,
    },
    /// The damping is negative, so the amplitude grows above the one at which friction dissipates
    /// the energy that the damping adds, also with the explicit step.
    Growing {
        /// A of [`Problem::runaway_amplitude`](crate::model::Problem::runaway_amplitude), a length.
        critical_amplitude: f64,
    },
    /// The explicit step of an underdamped oscillator, alpha^2 < K m, is stable below a limit.
    Underdamped {
        /// The limit 2 alpha / K of the step, a time.
        largest_step: f64,
    },
    /// The explicit step of an overdamped oscillator, alpha^2 >= K m, is stable below a limit.
    Overdamped {
        /// The limit 2 / |lambda_max| of the step, a time.
        largest_step: f64,
    },
    /// A step that moves with the new velocity is stable below a limit, with and without damping.
    NewVelocity {
        /// The limit 2 / (w0 (z + sqrt(1 + z^2))) of the step, a time, where z = alpha / (m w0).
        largest_step: f64,
    },
}

impl Stability {
    /// The limit of the step, if there is one.
    pub fn largest_step(self) -> Option<f64> {
        match self {
            Stability::Undamped { .. } | Stability::Growing { .. } => None,
            Stability::Underdamped { largest_step }
            | Stability::Overdamped { largest_step }
            | Stability::NewVelocity { largest_step } => Some(largest_step),
        }
    }
}
