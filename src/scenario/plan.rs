//! From a question to the ensemble that answers it.

use super::limits::MAX_PERIODS;
use super::{Scenario, Time};
use crate::bias::{BiasPlan, NoBias};
use crate::ensemble::Plan;
use crate::scheme::{Resolution, Timeline};

impl Scenario {
    /// When the paths are observed. The forcing period is the one that all harmonics share, unless
    /// there would be more than [`MAX_PERIODS`] of them.
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

    /// What the scheme simulates in place of the model where f_s and f_d (nearly) meet under noise;
    /// usually nothing.
    pub fn resolution(&self) -> Option<Resolution> {
        self.scheme.resolution(&self.model, &self.timeline())
    }

    /// The ensemble this scenario asks for.
    pub fn plan(&self) -> Plan {
        Plan {
            simulation: self.scheme.simulation(&self.model, &self.timeline()),
            record: self.record,
            seed: self.ensemble.seed,
            paths: self.ensemble.paths,
            antithetic: self.ensemble.antithetic,
        }
    }

    /// The simulations from which the error of its step is estimated, for a run of so many paths.
    pub fn bias_plan(&self, paths: u64) -> Result<BiasPlan, NoBias> {
        let plan = BiasPlan::new(self.scheme, &self.model, &self.timeline(), self.ensemble.seed, paths)?;
        Ok(if self.ensemble.antithetic { plan.in_pairs() } else { plan })
    }
}
