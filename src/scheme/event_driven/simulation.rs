//! The event-driven scheme on one model. Whether it is simulated with or without noise is chosen
//! once.

use super::law::{Resolution, Scene, StepRules};
use super::noiseless::{GeneralNoiseless, Noiseless, PathSegments, unfelt_noise};
use super::noisy::Noisy;
use super::with_temperature::{WithTemperature, given as given_temperature};
use super::work::Simulated;
use crate::lanes::InstructionSet;
use crate::model::{Absorbed, Problem};
use crate::scheme::{Observer, Simulate, Timeline};

/// The event-driven scheme on one model.
#[derive(Clone, Debug)]
pub struct EventDrivenSimulation {
    model: Problem,
    timeline: Timeline,
    /// The model without its force, if that is absorbed.
    absorbed: Option<Absorbed>,
    chosen: Chosen,
    resolution: Option<Resolution>,
}

/// The simulation with or without noise. Where the motion does not depend on the noise, no random
/// numbers are drawn for the motion.
#[derive(Clone, Debug)]
enum Chosen {
    Noiseless(Box<Noiseless>),
    /// Without noise and with a user-defined force.
    General(Box<GeneralNoiseless>),
    Noisy(Box<Noisy>),
}

impl EventDrivenSimulation {
    /// The scheme on a model, observed at the stops of a timeline, with relative discretisation
    /// errors of about `tolerance`. Without noise there is no discretisation error.
    pub fn new(model: &Problem, timeline: &Timeline, tolerance: f64) -> Self {
        let (given, absorbed) = (model, model.absorbed());
        let model = absorbed
            .as_ref()
            .map_or(model, |absorbed| &absorbed.problem);
        let scene = Scene::new(model);
        let (chosen, resolution) = if scene.felt_noise(timeline.end).is_some() {
            let rules = StepRules::new(tolerance);
            (
                Chosen::Noisy(Box::new(Noisy::new(model, timeline, &rules))),
                rules.resolution(&scene),
            )
        } else if model.force.is_some() {
            (
                Chosen::General(Box::new(GeneralNoiseless::new(model, timeline))),
                None,
            )
        } else {
            (
                Chosen::Noiseless(Box::new(Noiseless::new(model, timeline))),
                None,
            )
        };
        EventDrivenSimulation {
            model: given.clone(),
            timeline: *timeline,
            absorbed,
            chosen,
            resolution,
        }
    }

    /// The threshold that is simulated instead of f_s where f_s and f_d are (nearly) equal under
    /// noise; usually none.
    pub fn resolution(&self) -> Option<Resolution> {
        self.resolution
    }
}

impl Simulate for EventDrivenSimulation {
    fn model(&self) -> &Problem {
        &self.model
    }

    fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// A path is given up if it exceeds its number of evaluations, or if a value is NaN.
    fn simulate_counting(
        &self,
        seed: u64,
        paths: &[u64],
        observer: &mut dyn Observer,
    ) -> Simulated {
        let mut unfelt;
        let mut observer: &mut dyn Observer = match &self.chosen {
            Chosen::Noisy(_) => observer,
            Chosen::Noiseless(_) | Chosen::General(_) => {
                unfelt = WithTemperature::new(observer, unfelt_noise(&self.model, seed, paths));
                &mut unfelt
            }
        };
        let mut given;
        if let Some(absorbed) = &self.absorbed {
            given = WithTemperature::new(observer, given_temperature(&self.model, absorbed));
            observer = &mut given;
        }
        match &self.chosen {
            Chosen::Noiseless(cascade) => cascade.simulate(paths.len(), observer),
            Chosen::General(cascade) => cascade.simulate(paths.len(), observer),
            Chosen::Noisy(cascade) => cascade.simulate(seed, paths, observer),
        }
    }

    fn vectorised_paths(&self) -> usize {
        match &self.chosen {
            Chosen::Noisy(cascade) => cascade.vectorised_paths(),
            Chosen::Noiseless(_) | Chosen::General(_) => 1,
        }
    }

    fn kernel(&self) -> String {
        match &self.chosen {
            Chosen::Noisy(cascade) if cascade.has_one_step_a_macro_step() => {
                format!(
                    "{} lanes, macro step by macro step",
                    InstructionSet::detect().name()
                )
            }
            Chosen::Noisy(cascade) if cascade.has_equal_macro_steps() => {
                format!(
                    "{} lanes for sticks, macro step by macro step; slips path by path",
                    InstructionSet::detect().name()
                )
            }
            _ => "scalar, path by path".to_string(),
        }
    }

    fn with_work_limit(mut self, limit: u64) -> Self {
        match &mut self.chosen {
            Chosen::Noiseless(cascade) => cascade.work_limit = limit,
            Chosen::General(cascade) => cascade.work_limit = limit,
            Chosen::Noisy(cascade) => cascade.propagation.work_limit = limit,
        }
        self
    }

    fn with_additional_rows(mut self, row_stride: usize) -> Self {
        if let Chosen::Noisy(cascade) = &mut self.chosen {
            cascade.propagation.row_stride = row_stride;
        }
        self
    }
}
