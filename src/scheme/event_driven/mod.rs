//! The event-driven scheme: the paper's step-by-step construction of stick and slip phases (its
//! section on the cascade).
//!
//! ```text
//! law                what holds between two times at which a path is known
//! noiseless          without noise: closed forms between events, and no time step
//! noisy              with noise: the constants, and whether paths are scalar or vectorised
//!   macro_step_loop  the loop over macro steps
//!   scalar           a path crosses a macro step event by event, one path after the other
//!   vectorised       all paths that are simulated together cross it together, in lanes
//! user_force         a user-defined force, if there is one that is not absorbed
//! with_temperature   the temperature with noise that is not felt, without an absorbed force
//! work               a limit on the computing time of one path
//! ```
//!
//! [`EventDriven`] is the scheme with its tolerance; [`EventDrivenSimulation`] is the scheme on one
//! model.

mod law;
mod macro_step_loop;
mod noiseless;
mod noisy;
mod scalar;
mod simulation;
mod user_force;
mod vectorised;
mod with_temperature;
mod work;

pub use law::{
    DEFAULT_TOLERANCE, DrivenOscillator, HarmonicResponse, Resolution, SlipTransition, TOLERANCES,
};
pub use simulation::EventDrivenSimulation;
pub use work::{Simulated, Unresolved};

pub(super) use law::{Known, MacroStep, ObservationTime, Scene, StepRules, noise_between};
pub(super) use macro_step_loop::{SharedObserver, simulate};
pub(super) use noiseless::{
    End, ExactTime, FollowedSlip, Kinematics, Knots, Noiseless, PathSegment, PathSegments,
    unfelt_noise,
};
pub(super) use scalar::{Cascade, ObservedSegment, Path, PathObserver, Propagation, ScalarPaths};
pub(super) use with_temperature::WithTemperature;
pub(super) use work::{Resolved, WorkLeft};

use super::{Appearance, CheckError, Discretisation, Method, Parameter, Timeline};
use crate::model::{Problem, can_be_computed_with};

/// The event-driven scheme with this tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventDriven {
    /// Relative error that discretisation may leave in the statistics, within [`TOLERANCES`].
    pub tolerance: f64,
}

impl Default for EventDriven {
    fn default() -> Self {
        EventDriven {
            tolerance: DEFAULT_TOLERANCE,
        }
    }
}

impl Method for EventDriven {
    const NAME: &'static str = "event-driven";
    const MEANING: &'static str = "event by event, exact in law between events";
    const PARAMETER: Parameter = Parameter::Tolerance {
        grid: &[1e-2, 1e-3, 1e-4, 1e-5],
    };
    const APPEARANCE: Appearance = Appearance {
        colour: "#009E73",
        dash: "",
    };
    type Simulation = EventDrivenSimulation;

    fn with(tolerance: f64) -> Self {
        EventDriven { tolerance }
    }

    fn parameter(self) -> f64 {
        self.tolerance
    }

    fn simulation(self, model: &Problem, timeline: &Timeline) -> EventDrivenSimulation {
        EventDrivenSimulation::new(model, timeline, self.tolerance)
    }

    fn discretisation(self) -> Discretisation {
        Discretisation::Tolerance {
            tolerance: self.tolerance,
        }
    }

    fn resolution(self, model: &Problem, timeline: &Timeline) -> Option<Resolution> {
        self.simulation(model, timeline).resolution()
    }

    fn check(self, model: &Problem, end: f64) -> Result<(), CheckError> {
        check_friction(model, end)
    }
}

/// Whether the friction threshold f_s and the noise can be computed with together, for the schemes
/// without a time step.
///
/// These schemes compute when the noise moves b past f_s, which takes a time of order (f_s/s)^2. So
/// the squares of both forces, their product and their ratio must be representable.
pub(super) fn check_friction(model: &Problem, end: f64) -> Result<(), CheckError> {
    let f_s = model.friction.static_force;
    let felt = Scene::new(model).felt_noise(end);
    if felt.is_none() && model.temperature.is_pinned && model.temperature.is_random() {
        let problem = "`temperature.noise.pinned` is true, but the noise is negligible".to_string();
        return Err(CheckError::new(
            &[("temperature.noise.intensity", 0.0)],
            problem,
            "remove [temperature.noise]",
        ));
    }
    if felt.is_none() && model.temperature.has_two_noises() {
        let problem = "there are two noises, but they are negligible".to_string();
        return Err(CheckError::new(
            &[("temperature.noise.intensity", 0.0)],
            problem,
            "remove one of them",
        ));
    }
    let Some(noise) = felt.filter(|_| f_s > 0.0) else {
        return Ok(());
    };
    if can_be_computed_with(&[noise / f_s, 1.0 / (noise * f_s)]) {
        return Ok(());
    }
    let problem = format!(
        "is negligible compared with the noise, which moves b by {noise:e}: crossings of \
        f_s cannot be computed"
    );
    let remedy = "set `static = 0` and `dynamic = 0` for no friction, or choose units in which forces are \
        closer to 1";
    Err(CheckError::new(
        &[("friction.static", f_s)],
        problem,
        remedy,
    ))
}
