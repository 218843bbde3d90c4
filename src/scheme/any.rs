//! The closed set of schemes, chosen once, outside every loop.

use super::{DiscreteVi, Observer};

/// A scheme ready to simulate paths of one model.
#[derive(Clone, Debug)]
pub enum Scheme {
    /// The paper's discrete variational inequality.
    DiscreteVi(DiscreteVi),
}

impl Scheme {
    /// What it runs on, in words.
    pub fn kernel(&self) -> String {
        match self {
            Scheme::DiscreteVi(scheme) => format!("{} lanes", scheme.instructions().name()),
        }
    }

    /// Simulate these paths of the ensemble with this seed. Returns the lanes (positions in `paths`) of the paths that
    /// diverged; what the observer saw of them is worthless.
    pub fn simulate<O: Observer>(&self, seed: u64, paths: &[u64], observer: &mut O) -> Vec<usize> {
        match self {
            Scheme::DiscreteVi(scheme) => scheme.simulate(seed, paths, observer),
        }
    }
}
