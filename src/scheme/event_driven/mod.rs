//! Scheme B: event-driven, the paper's step-by-step construction of stick and slip phases (its
//! section on the cascade).
//!
//! ```text
//! rho = 0   Noiseless   every phase a closed form, every event a root; no step at all
//! rho > 0   Noisy       stick: exact noise, bridge crossings; slip: exact transitions, conditional bisection
//!                       StepRules   what the one tolerance means for its steps
//!                       path_loop   from stop to stop, from event to event
//! ```

mod exact_time;
mod first_root;
mod first_stop;
#[cfg(test)]
mod harness;
mod noiseless;
mod noisy;
mod path_loop;
mod scene;
mod slip_transition;
mod step_rules;
mod stick;
mod stick_step;
mod unfelt_noise;
mod work;

pub use slip_transition::{DrivenOscillator, HarmonicResponse, SlipTransition};
pub use step_rules::{DEFAULT_TOLERANCE, Resolution, TOLERANCES};
pub use work::Simulated;

pub(super) use exact_time::ExactTime;
pub(super) use noiseless::Noiseless;
pub(super) use path_loop::{Cascade, Path, simulate};
pub(super) use scene::{Scene, forcing};
pub(super) use step_rules::StepRules;
pub(super) use stick::StickSteps;
pub(super) use unfelt_noise::UnfeltNoise;
pub(super) use work::{Unresolved, WORK_LIMIT};

use super::{Observer, Timeline};
use crate::model::Model;
use noisy::Noisy;

/// What the noise of a scene moves b by until `end`, where the motion of the schemes without a step
/// feels it.
pub fn felt_noise(model: &Model, end: f64) -> Option<f64> {
    Scene::new(model).felt_noise(end)
}

/// The event-driven scheme for one scene.
#[derive(Clone, Debug)]
pub struct EventDriven {
    kernel: Kernel,
    resolution: Option<Resolution>,
}

/// Chosen once: a scene whose motion feels no noise draws none for it.
#[derive(Clone, Debug)]
enum Kernel {
    Noiseless(Box<Noiseless>, UnfeltNoise),
    Noisy(Box<Noisy>),
}

impl EventDriven {
    /// For a scene, observed at the stops of a timeline, with discretisation errors of about
    /// `tolerance` relative ([`DEFAULT_TOLERANCE`]; the noiseless cascade has none).
    pub fn new(model: &Model, timeline: &Timeline, tolerance: f64) -> Self {
        let scene = Scene::new(model);
        if scene.felt_noise(timeline.end).is_none() {
            return EventDriven {
                kernel: Kernel::Noiseless(Box::new(Noiseless::new(model, timeline)), UnfeltNoise::new(model)),
                resolution: None,
            };
        }
        let rules = StepRules::new(tolerance);
        let kernel = Kernel::Noisy(Box::new(Noisy::new(model, timeline, &rules)));
        EventDriven { kernel, resolution: rules.resolution(&scene) }
    }

    /// The same, each path given up after `limit` evaluations instead of the usual 10^8.
    pub fn with_work_limit(mut self, limit: u64) -> Self {
        match &mut self.kernel {
            Kernel::Noiseless(cascade, _) => cascade.work_limit = limit,
            Kernel::Noisy(cascade) => cascade.work_limit = limit,
        }
        self
    }

    /// What is simulated in place of the scene where f_s and f_d (nearly) meet under noise; usually
    /// nothing.
    pub fn resolution(&self) -> Option<Resolution> {
        self.resolution
    }

    /// Simulate the paths with these numbers, telling the observer; the lanes that had to be given
    /// up are returned.
    pub fn simulate<O: Observer>(&self, seed: u64, paths: &[u64], observer: &mut O) -> Vec<usize> {
        self.simulate_counting(seed, paths, observer).lost
    }

    /// The same, with what was evaluated for it.
    pub fn simulate_counting<O: Observer>(&self, seed: u64, paths: &[u64], observer: &mut O) -> Simulated {
        match &self.kernel {
            Kernel::Noiseless(cascade, noise) => {
                cascade.simulate(paths.len(), &mut noise.added_before(observer, seed, paths))
            }
            Kernel::Noisy(cascade) => cascade.simulate(seed, paths, observer),
        }
    }
}
