//! What every scheme says of itself, and what it can do once it has a model.

use super::{Misfit, Observer, Resolution, Stability, Timeline};
use crate::model::Model;

/// A scheme with its one parameter, and what is known of it. Each scheme is a type of its own,
/// which implements this in its own file. The list in [`crate::scheme`] makes the closed enums of
/// them.
pub trait Method: Copy {
    /// The name in scenarios, tables, JSON and files.
    const NAME: &'static str;
    /// What it is, in a line.
    const MEANING: &'static str;
    /// What its parameter is.
    const PARAMETER: Parameter;
    /// How pictures tell it from the others.
    const LOOK: Look;
    /// The scheme on one model and one timeline.
    type Simulation: Simulate;

    /// The scheme with this step or tolerance.
    fn with(parameter: f64) -> Self;

    /// Its step or tolerance.
    fn parameter(self) -> f64;

    /// The scheme on this model, looked at on this timeline.
    fn simulation(self, model: &Model, timeline: &Timeline) -> Self::Simulation;

    /// How the error of its discretisation is known.
    fn discretisation(self) -> Discretisation;

    /// How long its step may be before slips grow without bound, if they can.
    fn stability(self, _model: &Model) -> Option<Stability> {
        None
    }

    /// What is simulated in place of the model where f_s and f_d (nearly) meet under noise; usually
    /// nothing.
    fn resolution(self, _model: &Model, _timeline: &Timeline) -> Option<Resolution> {
        None
    }

    /// Whether it can simulate this model up to `end`.
    fn check(self, _model: &Model, _end: f64) -> Result<(), Misfit> {
        Ok(())
    }
}

/// A scheme on one model and one timeline, ready to simulate paths. A path is a function of the
/// seed and of its number alone.
pub trait Simulate: Sized {
    /// What is simulated.
    fn model(&self) -> &Model;

    /// When the paths are looked at.
    fn timeline(&self) -> &Timeline;

    /// Simulate these paths of the ensemble with this seed. The lanes (positions in `paths`) of the
    /// paths that diverged or had to be given up are returned; what the observer saw of them is
    /// worthless.
    fn simulate(&self, seed: u64, paths: &[u64], observer: &mut dyn Observer) -> Vec<usize>;

    /// h, of which the times of all events are whole multiples; none for a scheme without a step.
    fn step(&self) -> Option<f64> {
        None
    }

    /// How many paths it had best be given at a time, where there are so many. What a path does is
    /// the same in any company.
    fn paths_abreast(&self) -> usize {
        1
    }

    /// What it runs on, in words.
    fn kernel(&self) -> String {
        "scalar, path by path".to_string()
    }

    /// The same simulation, each step of which is fed the noise of `refinement` >= 1 steps of
    /// h/refinement, so that the steps h, 2h and 4h can be simulated on one realisation. A scheme
    /// without a step stays as it is.
    fn fed_by_finer(self, _refinement: usize) -> Self {
        self
    }

    /// The same simulation, each stop of its timeline rounded to a whole multiple of `steps` >= 1
    /// steps, so that different steps look at their paths at the same instants. A scheme without a
    /// step stays as it is.
    fn observed_every(self, _steps: u64) -> Self {
        self
    }

    /// The same simulation and the same paths, of whose output rows every `closeness`-th >= 1 is
    /// one of the run and the others are a closer look: what a run sees of a path is the same with
    /// and without rows between. A scheme with a step stays as it is, and so does one where nothing
    /// is random: their paths are known everywhere.
    fn looked_at_closer(self, _closeness: usize) -> Self {
        self
    }

    /// The same simulation, each path of which is given up after `limit` evaluations instead of the
    /// usual 10^8. A scheme whose work is its number of steps stays as it is.
    fn with_work_limit(self, _limit: u64) -> Self {
        self
    }
}

/// What the one parameter of a scheme is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameter {
    /// The time step h. A trade measures the coarsest step that suits the model, and one halving of
    /// it after another.
    Step,
    /// The relative error that discretisation may leave in the statistics.
    Tolerance {
        /// What a trade measures, from the loosest to the tightest.
        ladder: &'static [f64],
    },
}

/// How the error that a scheme's discretisation leaves in the statistics is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Discretisation {
    /// A step. The error falls with a power of it and can be extrapolated from h, 2h and 4h.
    Step {
        /// h.
        h: f64,
    },
    /// A step whose stick exits are corrected. The error that is left changes sign between the
    /// steps that would be compared, so that only a reference run without a step measures it.
    CorrectedStep {
        /// h.
        h: f64,
    },
    /// A tolerance, which the scheme keeps: relative errors are at most about as large, and there
    /// are none where nothing is random.
    Tolerance {
        /// The size.
        tolerance: f64,
    },
    /// The error is that of an approximation of the model, which no parameter makes smaller.
    Approximation,
}

/// How pictures tell a scheme from the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// A colour as SVG writes it. The colours remain distinct for colour-blind readers (Okabe and
    /// Ito).
    pub colour: &'static str,
    /// The lengths of strokes and gaps of a line as SVG writes them; empty for a line without gaps.
    pub dash: &'static str,
}
