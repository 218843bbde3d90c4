//! From a question to the ensemble that answers it.

use super::Scenario;
use crate::bias::{BiasPlan, NoBias};
use crate::ensemble::Plan;

impl Scenario {
    /// The ensemble this scenario asks for.
    pub fn plan(&self) -> Plan {
        Plan {
            simulation: self.scheme.simulation(&self.model, &self.timeline()),
            record: self.record,
            seed: self.ensemble.seed,
            paths: self.ensemble.paths,
        }
    }

    /// The simulations from which the error of its step is estimated, for a run of so many paths.
    pub fn bias_plan(&self, paths: u64) -> Result<BiasPlan, NoBias> {
        BiasPlan::new(self.scheme, &self.model, &self.timeline(), self.ensemble.seed, paths)
    }
}
