//! From a question to the ensemble that answers it.

use super::{Scenario, SchemeKind};
use crate::ensemble::Plan;
use crate::scheme::{DiscreteVi, Scheme};

impl Scenario {
    /// The ensemble this scenario asks for.
    pub fn plan(&self) -> Plan {
        let timeline = self.timeline();
        let scheme = match self.scheme {
            SchemeKind::DiscreteVi => Scheme::DiscreteVi(DiscreteVi::new(&self.model, &timeline, self.time.step)),
        };
        Plan {
            model: self.model.clone(),
            scheme,
            timeline,
            record: self.record,
            seed: self.ensemble.seed,
            paths: self.ensemble.paths,
        }
    }
}
