//! The cost of accuracy: every scheme is measured over a grid of settings, and the cheapest run for
//! a target is predicted.
//!
//! ```text
//! SettingGrid::of        which settings a scenario can be run with: steps, tolerances
//!   -> PlannedCost       how many paths of each, from a budget of time
//!     -> measure    for each setting: CPU time per path, estimates, and changes from step to step
//!       -> Law      bias = C h^p, fitted to those changes and the distance from the reference
//!         -> Trade::best   the cheapest setting for a target, with its paths and its cost
//! ```
//!
//! The mean square error of a run of N paths is bias^2 + variance/N. More paths reduce the second
//! term and a finer setting the first, and both cost CPU time. With the cost c of a path, the
//! cheapest setting for a target eps is the one with the least N c, where N = variance/(eps^2 -
//! bias^2).
//!
//! Except for times, everything is a function of the scenario, the seed and the [`PlannedCost`].

mod cost_curves;
mod error;
mod law;
mod measure;
mod pairing;
mod planned_cost;
mod predict;
mod setting;
mod settings;
mod standing;
mod timing;

pub use cost_curves::{CostCurve, CostCurves};
pub use error::TradeError;
pub use law::{Change, Law};
pub use measure::{Limits, measure, measure_within};
pub use pairing::Pairing;
pub use planned_cost::PlannedCost;
pub use predict::{Choice, Refusal, TARGETS};
pub use setting::{Cost, TradeSetting};
pub use settings::{LeftOut, SettingGrid};
pub use standing::Standing;

use crate::scenario::Scenario;
use crate::scheme::{CheckError, Kind};
use crate::stats::Statistic;

/// A number and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

impl Number {
    /// The number and its error as shares of a positive number.
    pub(crate) fn relative_to(self, scale: f64) -> Number {
        Number {
            value: self.value / scale,
            error: self.error / scale,
        }
    }

    /// An upper bound of the absolute value at one-sided 95 %.
    pub fn bound(self) -> f64 {
        self.value.abs() + ONE_SIDED * self.error
    }
}

/// The 95 % quantile of the standard normal distribution.
const ONE_SIDED: f64 = 1.645;

/// The measured grid of a scenario.
#[derive(Clone, Debug)]
pub struct Trade {
    /// The settings, scheme by scheme, from coarse to fine.
    pub settings: Vec<TradeSetting>,
    /// The index of the reference setting, the event-driven run with the tightest tolerance,
    /// against which every bias is measured.
    pub reference: usize,
    /// The schemes and settings that were not run, with the reasons.
    pub left_out: Vec<LeftOut>,
    /// Whether paths are antithetic pairs, or how pairs would change the variance.
    pub pairing: Pairing,
    /// Whether paths differ at all.
    pub is_random: bool,
    /// Whether f_s and f_d are (nearly) equal under noise, so that counts and durations of single
    /// phases have no limit as the step falls.
    pub has_limitless_phases: bool,
}

impl Trade {
    /// The trade of a scenario whose settings were measured. Fails if the scheme of the reference
    /// is inconsistent with the scenario.
    pub fn of_rungs(
        scenario: &Scenario,
        settings: Vec<TradeSetting>,
        reference: usize,
        pairing: Pairing,
    ) -> Result<Trade, CheckError> {
        let has_limitless_phases = scenario
            .with_scheme(settings[reference].scheme)?
            .resolution()
            .is_some();
        let is_random = scenario.model.is_random();
        Ok(Trade {
            settings,
            reference,
            left_out: Vec::new(),
            pairing,
            is_random,
            has_limitless_phases,
        })
    }

    /// The setting against which every bias is measured.
    pub fn reference(&self) -> &TradeSetting {
        &self.settings[self.reference]
    }

    /// Whether a setting is the reference. No two settings have the same scheme with the same step or
    /// tolerance, so comparing these is enough.
    pub fn is_reference(&self, setting: &TradeSetting) -> bool {
        setting.scheme == self.reference().scheme
    }

    /// The bias of a statistic on a setting, estimated as the difference from the reference.
    pub fn bias(&self, setting: &TradeSetting, statistic: Statistic) -> Number {
        if self.is_reference(setting) {
            return Number {
                value: 0.0,
                error: 0.0,
            };
        }
        let (here, there) = (
            setting.estimate(statistic),
            self.reference().estimate(statistic),
        );
        Number {
            value: here.value - there.value,
            error: here.error.hypot(there.error),
        }
    }

    /// The law by which the bias of a scheme falls with its step; `None` if it is not resolved, or
    /// for a scheme without steps.
    pub fn law(&self, scheme: Kind, statistic: Statistic) -> Option<Law> {
        let settings: Vec<&TradeSetting> = self.rungs_of(scheme).collect();
        let (finest, coarser) = settings.split_last()?;
        let changes: Option<Vec<Change>> = coarser
            .iter()
            .map(|setting| {
                Some(Change {
                    h: setting.scheme.step()?,
                    change: setting.change(statistic)?,
                })
            })
            .collect();
        Law::fit(
            &changes?,
            finest.scheme.step()?,
            self.bias(finest, statistic),
        )
    }

    /// The settings of a scheme, from coarse to fine.
    pub fn rungs_of(&self, scheme: Kind) -> impl DoubleEndedIterator<Item = &TradeSetting> {
        self.settings
            .iter()
            .filter(move |setting| setting.scheme.kind() == scheme)
    }

    /// The schemes that were run, in the order of the settings.
    pub fn schemes(&self) -> Vec<Kind> {
        let mut schemes: Vec<Kind> = self
            .settings
            .iter()
            .map(|setting| setting.scheme.kind())
            .collect();
        schemes.dedup();
        schemes
    }
}
