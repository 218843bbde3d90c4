//! The ensemble that a scenario asks for.

use super::limits::MAX_PERIODS;
use super::{Scenario, Time};
use crate::bias::{BiasPlan, NoBias};
use crate::ensemble::Plan;
use crate::scheme::{Resolution, Timeline};

impl Scenario {
    /// The times at which paths are observed. The forcing period is the common period of all
    /// harmonics; there is none if they have none, or if the run would contain more than
    /// [`MAX_PERIODS`] of them.
    pub fn timeline(&self) -> Timeline {
        let few = |period: &f64| self.time.end / period <= MAX_PERIODS as f64;
        let period = self.model.temperature.period().filter(few);
        let Time { end, output_step } = self.time;
        Timeline { end, output_step, period, after: self.statistics.after }
    }

    /// Number of steps of a path, if the scheme has steps.
    pub fn steps(&self) -> Option<u64> {
        self.scheme.step().map(|h| (self.time.end / h).round() as u64)
    }

    /// The static threshold that the scheme simulates in place of f_s if f_s and f_d are (nearly)
    /// equal under noise; `None` for most scenarios.
    pub fn resolution(&self) -> Option<Resolution> {
        self.scheme.resolution(&self.model, &self.timeline())
    }

    /// The ensemble that this scenario asks for.
    pub fn plan(&self) -> Plan {
        Plan {
            simulation: self.scheme.simulation(&self.model, &self.timeline()),
            record: self.record,
            seed: self.ensemble.seed,
            paths: self.ensemble.paths,
            antithetic: self.ensemble.antithetic,
        }
    }

    /// The simulations from which the discretisation bias of a run of `paths` paths is estimated;
    /// an error if the scenario allows no such estimate.
    pub fn bias_plan(&self, paths: u64) -> Result<BiasPlan, NoBias> {
        let plan = BiasPlan::new(self.scheme, &self.model, &self.timeline(), self.ensemble.seed, paths)?;
        Ok(if self.ensemble.antithetic { plan.in_pairs() } else { plan })
    }
}
