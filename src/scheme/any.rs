//! The closed set of schemes, chosen once, outside every loop.

use super::{DiscreteVi, EventDriven, Observer, QuasiStatic};

/// A scheme ready to simulate paths of one model.
#[derive(Clone, Debug)]
pub enum Scheme {
    /// The discrete variational inequality, as in the paper or corrected.
    DiscreteVi(DiscreteVi),
    /// From event to event.
    EventDriven(Box<EventDriven>),
    /// The paper's recursion for slow forcing.
    QuasiStatic(Box<QuasiStatic>),
}

impl Scheme {
    /// What it runs on, in words.
    pub fn kernel(&self) -> String {
        match self {
            Scheme::DiscreteVi(scheme) => format!("{} lanes", scheme.instructions().name()),
            Scheme::EventDriven(_) | Scheme::QuasiStatic(_) => "scalar, path by path".to_string(),
        }
    }

    /// h: all events lie at multiples of it. None for the schemes without a step.
    pub fn step(&self) -> Option<f64> {
        match self {
            Scheme::DiscreteVi(scheme) => Some(scheme.step()),
            Scheme::EventDriven(_) | Scheme::QuasiStatic(_) => None,
        }
    }

    /// Simulate these paths of the ensemble with this seed. Returns the lanes (positions in `paths`) of the paths that
    /// diverged or had to be given up; what the observer saw of them is worthless.
    pub fn simulate<O: Observer>(&self, seed: u64, paths: &[u64], observer: &mut O) -> Vec<usize> {
        match self {
            Scheme::DiscreteVi(scheme) => scheme.simulate(seed, paths, observer),
            Scheme::EventDriven(scheme) => scheme.simulate(seed, paths, observer),
            Scheme::QuasiStatic(scheme) => scheme.simulate(seed, paths, observer),
        }
    }
}
