//! The ensemble of a scenario.

use super::limits::MAX_PERIODS;
use super::{Scenario, Time};
use crate::bias::{BiasPlan, NoBias};
use crate::ensemble::Plan;
use crate::scheme::{Resolution, Timeline};

/// Without periodic forcing, x is compared this many times in the counted time.
const INSTANTS: f64 = 10.0;

/// P, the time between the instants n P at which x is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period {
    /// P.
    pub length: f64,
    /// The source of P.
    pub source: PeriodSource,
}

/// The source of the time between the instants at which x is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PeriodSource {
    /// `statistics.period`.
    Given,
    /// The shortest time after which every harmonic of the temperature repeats itself.
    Forcing,
    /// A tenth of the counted time.
    Share,
}

impl PeriodSource {
    /// The source of P, in words.
    pub fn words(self) -> &'static str {
        match self {
            PeriodSource::Given => "from statistics.period",
            PeriodSource::Forcing => "the period of the forcing",
            PeriodSource::Share => "a tenth of the counted time",
        }
    }
}

impl Scenario {
    /// The time between the instants at which x is compared, and its source. It is given by the
    /// scenario, or else the common period of the harmonics. Without periodic forcing, it is a
    /// fraction of the counted time. None if the run has no duration.
    pub fn period(&self) -> Option<Period> {
        let counted = self.time.end - self.statistics.after;
        let given = self.statistics.period.map(|length| Period {
            length,
            source: PeriodSource::Given,
        });
        let forcing = || {
            Some(Period {
                length: self.model.temperature.period()?,
                source: PeriodSource::Forcing,
            })
        };
        let share = || {
            Some(Period {
                length: counted / INSTANTS,
                source: PeriodSource::Share,
            })
            .filter(|_| counted > 0.0)
        };
        given.or_else(forcing).or_else(share)
    }

    /// The times at which paths are observed. x is not compared if the run would contain more than
    /// [`MAX_PERIODS`] periods.
    pub fn timeline(&self) -> Timeline {
        let Time { end, output_step } = self.time;
        let few = |period: &f64| end / period <= MAX_PERIODS as f64;
        let period = self.period().map(|period| period.length).filter(few);
        Timeline {
            end,
            output_step,
            period,
            after: self.statistics.after,
        }
    }

    /// Number of steps of a path, if the scheme has steps.
    pub fn steps(&self) -> Option<u64> {
        self.scheme
            .step()
            .map(|h| (self.time.end / h).round() as u64)
    }

    /// The static threshold that the scheme simulates in place of f_s if f_s and f_d are (nearly)
    /// equal under noise; `None` for most scenarios.
    pub fn resolution(&self) -> Option<Resolution> {
        self.scheme.resolution(&self.model, &self.timeline())
    }

    /// The ensemble of this scenario.
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
    /// an error if the scenario does not allow an estimate.
    pub fn bias_plan(&self, paths: u64) -> Result<BiasPlan, NoBias> {
        let plan = BiasPlan::new(
            self.scheme,
            &self.model,
            &self.timeline(),
            self.ensemble.seed,
            paths,
        )?;
        Ok(plan.recording(&self.record, self.ensemble.antithetic))
    }
}
