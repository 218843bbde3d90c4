//! The definition of a scheme ([`Method`]), and its simulation of a model ([`Simulate`]).

use super::{CheckError, Observer, Resolution, Simulated, Stability, Timeline, Unresolved};
use crate::model::Problem;

/// A scheme with its one parameter, and its properties. Each scheme is a type in its own file that
/// implements this trait. The list in [`crate::scheme`] makes the enums of all schemes from these
/// types.
pub trait Method: Copy {
    /// The name in scenarios, tables, JSON and files.
    const NAME: &'static str;
    /// A description of the scheme in one line.
    const MEANING: &'static str;
    /// Which parameter the scheme has.
    const PARAMETER: Parameter;
    /// The appearance of the scheme in pictures.
    const APPEARANCE: Appearance;
    /// The scheme on one model and one timeline.
    type Simulation: Simulate;

    /// The scheme with this step or tolerance.
    fn with(parameter: f64) -> Self;

    /// The step (a time) or the relative tolerance.
    fn parameter(self) -> f64;

    /// The scheme on this model, observed on this timeline.
    fn simulation(self, model: &Problem, timeline: &Timeline) -> Self::Simulation;

    /// How its discretisation error can be measured.
    fn discretisation(self) -> Discretisation;

    /// The limit beyond which slips grow without bound; none for a scheme without a step.
    fn stability(self, _model: &Problem) -> Option<Stability> {
        None
    }

    /// The threshold that is simulated instead of f_s where f_s and f_d are (nearly) equal under
    /// noise; usually none.
    fn resolution(self, _model: &Problem, _timeline: &Timeline) -> Option<Resolution> {
        None
    }

    /// Checks whether the scheme can simulate this model up to `end`.
    fn check(self, _model: &Problem, _end: f64) -> Result<(), CheckError> {
        Ok(())
    }
}

/// A scheme on one model and one timeline, ready to simulate paths. A path is a function of the
/// seed and of its number alone.
pub trait Simulate: Sized {
    /// The model that is simulated.
    fn model(&self) -> &Problem;

    /// The instants at which the paths are observed.
    fn timeline(&self) -> &Timeline;

    /// Simulates these paths of the ensemble with this seed. Data of paths that diverged or were
    /// given up must be discarded.
    fn simulate_counting(&self, seed: u64, paths: &[u64], observer: &mut dyn Observer)
    -> Simulated;

    /// The same. Returns the lanes (positions in `paths`) of the paths that diverged or had to be
    /// given up.
    fn simulate(&self, seed: u64, paths: &[u64], observer: &mut dyn Observer) -> Vec<usize> {
        self.simulate_counting(seed, paths, observer).lost
    }

    /// Why this path of the ensemble was given up; it is simulated again. None if it was not, and
    /// for a scheme with a step, where every lost path has diverged.
    fn why_lost(&self, seed: u64, path: u64, observer: &mut dyn Observer) -> Option<Unresolved> {
        match self.step() {
            Some(_) => None,
            None => self.simulate_counting(seed, &[path], observer).why,
        }
    }

    /// The time step h; the times of all events are whole multiples of it. None for a scheme
    /// without a step.
    fn step(&self) -> Option<f64> {
        None
    }

    /// The best number of paths to simulate together. The result of a path does not depend on this
    /// number.
    fn vectorised_paths(&self) -> usize {
        1
    }

    /// The code that computes the paths, in words: the instruction set and the order of work.
    fn kernel(&self) -> String {
        "scalar, path by path".to_string()
    }

    /// The same simulation, where the noise of each step is that of `refinement` >= 1 steps of
    /// length h/refinement. So the steps h, 2h and 4h can be simulated on one realisation of the
    /// noise. A scheme without a step is not changed.
    fn fed_by_finer(self, _refinement: usize) -> Self {
        self
    }

    /// The same simulation, where each stop of the timeline is rounded to a whole multiple of
    /// `steps` >= 1 steps. So different steps can be observed at the same instants. A scheme
    /// without a step is not changed.
    fn observed_every(self, _steps: u64) -> Self {
        self
    }

    /// The same simulation of the same paths, where every `row_stride`-th row of the output grid
    /// belongs to the run (`row_stride` >= 1), and the rows in between are additional. The states in
    /// the rows of the run are the same with and without them. A scheme with a step is not changed,
    /// nor is a simulation without noise, because the states are known at every time there.
    fn with_additional_rows(self, _row_stride: usize) -> Self {
        self
    }

    /// The same simulation, where each path is given up after `limit` evaluations instead of the
    /// default, which takes a few seconds. A scheme with a step is not changed, because its work is
    /// its number of steps.
    fn with_work_limit(self, _limit: u64) -> Self {
        self
    }
}

/// The one parameter of a scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameter {
    /// The time step h. A trade starts at the largest step that suits the model and halves it
    /// repeatedly.
    Step,
    /// The relative error that discretisation may leave in the statistics.
    Tolerance {
        /// The tolerances that a trade measures, from the largest to the smallest.
        grid: &'static [f64],
    },
}

/// How the discretisation error of a scheme can be measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Discretisation {
    /// The scheme has a step. The error falls with a power of the step and can be extrapolated from
    /// h, 2h and 4h.
    Step {
        /// h.
        h: f64,
    },
    /// The scheme has a step and corrects its stick exits. The remaining error changes sign between
    /// the steps that would be compared, so only a reference run without a step measures it.
    CorrectedStep {
        /// h.
        h: f64,
    },
    /// The scheme has a tolerance, which relative errors do not exceed by much. Without noise there
    /// is no error.
    Tolerance {
        /// The tolerance, a relative error.
        tolerance: f64,
    },
    /// The error is that of an approximation of the model, independent of any parameter.
    Approximation,
}

/// The appearance of a scheme in pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Appearance {
    /// A colour as SVG writes it. The colours can be distinguished by colour-blind readers (Okabe
    /// and Ito).
    pub colour: &'static str,
    /// The lengths of strokes and gaps of a line as SVG writes them; empty for a line without gaps.
    pub dash: &'static str,
}
