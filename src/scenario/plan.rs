//! From a question to the ensemble that answers it.

use super::{Scenario, SchemeKind};
use crate::bias::{BiasPlan, NoBias};
use crate::ensemble::Plan;
use crate::scheme::{DiscreteVi, EventDriven, QuasiStatic, Scheme};

impl Scenario {
    /// The ensemble this scenario asks for.
    pub fn plan(&self) -> Plan {
        let timeline = self.timeline();
        let (model, step) = (&self.model, self.time.step_or_row());
        let scheme = match self.scheme {
            SchemeKind::DiscreteVi => Scheme::DiscreteVi(DiscreteVi::new(model, &timeline, step)),
            SchemeKind::CorrectedVi => Scheme::DiscreteVi(DiscreteVi::corrected(model, &timeline, step)),
            SchemeKind::EventDriven { tolerance } => {
                Scheme::EventDriven(Box::new(EventDriven::new(model, &timeline, tolerance)))
            }
            SchemeKind::QuasiStatic { tolerance } => {
                Scheme::QuasiStatic(Box::new(QuasiStatic::new(model, &timeline, tolerance)))
            }
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

    /// The simulations from which the error of its step is estimated, for a run of so many paths.
    pub fn bias_plan(&self, paths: u64) -> Result<BiasPlan, NoBias> {
        match self.scheme {
            SchemeKind::DiscreteVi | SchemeKind::CorrectedVi => {
                let step = (self.time.step_or_row(), self.scheme == SchemeKind::CorrectedVi);
                BiasPlan::new(&self.model, &self.timeline(), step, self.ensemble.seed, paths)
            }
            SchemeKind::EventDriven { .. } if !self.model.temperature.is_random() => Err(NoBias::Exact),
            SchemeKind::EventDriven { tolerance } => Err(NoBias::Tolerance(tolerance)),
            SchemeKind::QuasiStatic { .. } => Err(NoBias::Approximation),
        }
    }
}
