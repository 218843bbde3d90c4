//! The event-driven scheme on one model. Whether it is simulated with or without noise is chosen
//! once.

use super::law::{Resolution, Scene, StepRules};
use super::noiseless::{GeneralNoiseless, Noiseless, Stretches, UnfeltNoise};
use super::noisy::Noisy;
use super::work::{Simulated, Unresolved};
use crate::lanes::InstructionSet;
use crate::model::Model;
use crate::scheme::{Observer, Simulate, Timeline};

/// The event-driven scheme on one model.
#[derive(Clone, Debug)]
pub struct EventDrivenSimulation {
    model: Model,
    timeline: Timeline,
    chosen: Chosen,
    resolution: Option<Resolution>,
}

/// The simulation with or without noise. Where the motion does not depend on the noise, no random
/// numbers are drawn for the motion.
#[derive(Clone, Debug)]
enum Chosen {
    Noiseless(Box<Noiseless>, UnfeltNoise),
    /// Without noise and with a force of the user's own.
    General(Box<GeneralNoiseless>, UnfeltNoise),
    Noisy(Box<Noisy>),
}

impl EventDrivenSimulation {
    /// The scheme on a model, observed at the stops of a timeline, with relative discretisation
    /// errors of about `tolerance`. Without noise there is no discretisation error.
    pub fn new(model: &Model, timeline: &Timeline, tolerance: f64) -> Self {
        let scene = Scene::new(model);
        let (chosen, resolution) = if scene.felt_noise(timeline.end).is_some() {
            let rules = StepRules::new(tolerance);
            (Chosen::Noisy(Box::new(Noisy::new(model, timeline, &rules))), rules.resolution(&scene))
        } else if model.force.is_some() {
            (Chosen::General(Box::new(GeneralNoiseless::new(model, timeline)), UnfeltNoise::new(model)), None)
        } else {
            (Chosen::Noiseless(Box::new(Noiseless::new(model, timeline)), UnfeltNoise::new(model)), None)
        };
        EventDrivenSimulation { model: model.clone(), timeline: *timeline, chosen, resolution }
    }

    /// The threshold that is simulated instead of f_s where f_s and f_d are (nearly) equal under
    /// noise; usually none.
    pub fn resolution(&self) -> Option<Resolution> {
        self.resolution
    }

    /// [`Simulate::simulate`], which also returns the number of evaluations.
    pub fn simulate_counting(&self, seed: u64, paths: &[u64], observer: &mut dyn Observer) -> Simulated {
        match &self.chosen {
            Chosen::Noiseless(cascade, noise) => {
                cascade.simulate(paths.len(), &mut noise.added_before(observer, seed, paths))
            }
            Chosen::General(cascade, noise) => {
                cascade.simulate(paths.len(), &mut noise.added_before(observer, seed, paths))
            }
            Chosen::Noisy(cascade) => cascade.simulate(seed, paths, observer),
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

    fn why_lost(&self, seed: u64, path: u64, observer: &mut dyn Observer) -> Option<Unresolved> {
        self.simulate_counting(seed, &[path], observer).why
    }

    fn paths_abreast(&self) -> usize {
        match &self.chosen {
            Chosen::Noisy(cascade) => cascade.paths_abreast(),
            Chosen::Noiseless(..) | Chosen::General(..) => 1,
        }
    }

    fn kernel(&self) -> String {
        match &self.chosen {
            Chosen::Noisy(cascade) if cascade.has_one_step_a_cell() => {
                format!("{} lanes, cell by cell", InstructionSet::detect().name())
            }
            Chosen::Noisy(cascade) if cascade.has_equal_cells() => {
                format!("{} lanes for sticks, cell by cell; slips path by path", InstructionSet::detect().name())
            }
            _ => "scalar, path by path".to_string(),
        }
    }

    fn with_work_limit(mut self, limit: u64) -> Self {
        match &mut self.chosen {
            Chosen::Noiseless(cascade, _) => cascade.work_limit = limit,
            Chosen::General(cascade, _) => cascade.work_limit = limit,
            Chosen::Noisy(cascade) => cascade.work_limit = limit,
        }
        self
    }

    fn looked_at_closer(mut self, closeness: usize) -> Self {
        if let Chosen::Noisy(cascade) = &mut self.chosen {
            cascade.closeness = closeness;
        }
        self
    }
}
