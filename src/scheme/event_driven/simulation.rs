//! The event-driven scheme on one model. Whether it is simulated with or without noise is chosen
//! once.

use super::noiseless::Noiseless;
use super::noisy::Noisy;
use super::scene::Scene;
use super::step_rules::{Resolution, StepRules};
use super::unfelt_noise::UnfeltNoise;
use super::work::Simulated;
use crate::lanes::InstructionSet;
use crate::model::Model;
use crate::scheme::{Observer, Simulate, Timeline};

/// The event-driven scheme on one model.
#[derive(Clone, Debug)]
pub struct EventDrivenSimulation {
    model: Model,
    timeline: Timeline,
    kernel: Kernel,
    resolution: Option<Resolution>,
}

/// The simulation with or without noise. Where the motion does not depend on the noise, no random
/// numbers are drawn for the motion.
#[derive(Clone, Debug)]
enum Kernel {
    Noiseless(Box<Noiseless>, UnfeltNoise),
    Noisy(Box<Noisy>),
}

impl EventDrivenSimulation {
    /// The scheme on a model, observed at the stops of a timeline, with relative discretisation
    /// errors of about `tolerance`. Without noise there is no discretisation error.
    pub fn new(model: &Model, timeline: &Timeline, tolerance: f64) -> Self {
        let scene = Scene::new(model);
        let (kernel, resolution) = if scene.felt_noise(timeline.end).is_some() {
            let rules = StepRules::new(tolerance);
            (Kernel::Noisy(Box::new(Noisy::new(model, timeline, &rules))), rules.resolution(&scene))
        } else {
            (Kernel::Noiseless(Box::new(Noiseless::new(model, timeline)), UnfeltNoise::new(model)), None)
        };
        EventDrivenSimulation { model: model.clone(), timeline: *timeline, kernel, resolution }
    }

    /// The threshold that is simulated instead of f_s where f_s and f_d are (nearly) equal under
    /// noise; usually none.
    pub fn resolution(&self) -> Option<Resolution> {
        self.resolution
    }

    /// [`Simulate::simulate`], which also returns the number of evaluations.
    pub fn simulate_counting(&self, seed: u64, paths: &[u64], observer: &mut dyn Observer) -> Simulated {
        match &self.kernel {
            Kernel::Noiseless(cascade, noise) => {
                cascade.simulate(paths.len(), &mut noise.added_before(observer, seed, paths))
            }
            Kernel::Noisy(cascade) => cascade.simulate(seed, paths, observer),
        }
    }
}

impl Simulate for EventDrivenSimulation {
    fn model(&self) -> &Model {
        &self.model
    }

    fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// A path is given up if it makes all the evaluations that it may, or if a value is not a
    /// number.
    fn simulate(&self, seed: u64, paths: &[u64], observer: &mut dyn Observer) -> Vec<usize> {
        self.simulate_counting(seed, paths, observer).lost
    }

    fn paths_abreast(&self) -> usize {
        match &self.kernel {
            Kernel::Noisy(cascade) => cascade.paths_abreast(),
            Kernel::Noiseless(..) => 1,
        }
    }

    fn kernel(&self) -> String {
        match &self.kernel {
            Kernel::Noisy(cascade) if cascade.has_one_step_a_cell() => {
                format!("{} lanes, cell by cell", InstructionSet::detect().name())
            }
            Kernel::Noisy(cascade) if cascade.has_equal_cells() => {
                format!("{} lanes for sticks, cell by cell; slips path by path", InstructionSet::detect().name())
            }
            _ => "scalar, path by path".to_string(),
        }
    }

    fn with_work_limit(mut self, limit: u64) -> Self {
        match &mut self.kernel {
            Kernel::Noiseless(cascade, _) => cascade.work_limit = limit,
            Kernel::Noisy(cascade) => cascade.work_limit = limit,
        }
        self
    }

    fn looked_at_closer(mut self, closeness: usize) -> Self {
        if let Kernel::Noisy(cascade) = &mut self.kernel {
            cascade.closeness = closeness;
        }
        self
    }
}
