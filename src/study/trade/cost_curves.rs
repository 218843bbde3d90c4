//! The cost of accuracy and the biases of one statistic, in the form that pictures use.

use super::{Number, TARGETS, Trade};
use crate::scenario::Scenario;
use crate::scheme::Kind;
use crate::stats::Statistic;

/// The cost of accuracy for one statistic.
#[derive(Clone, Debug, PartialEq)]
pub struct CostCurves {
    /// Title of the scenario.
    pub title: String,
    /// The seed of all paths.
    pub seed: u64,
    /// The reference run for biases.
    pub reference: String,
    /// The statistic whose error is meant.
    pub statistic: Statistic,
    /// The results for each scheme.
    pub curves: Vec<CostCurve>,
}

/// The cost of accuracy with one scheme, and its biases.
#[derive(Clone, Debug, PartialEq)]
pub struct CostCurve {
    /// The scheme.
    pub scheme: Kind,
    /// Pairs of CPU seconds on one thread and the relative error that is reached.
    pub costs: Vec<[f64; 2]>,
    /// Pairs of a step and the relative bias there; none of a scheme without steps.
    pub biases: Vec<(f64, Number)>,
    /// The order p of the bias C h^p, if it was resolved.
    pub order: Option<Number>,
}

impl CostCurves {
    /// The measurements of a trade of this scenario, and its predictions for each of [`TARGETS`].
    pub fn of(trade: &Trade, statistic: Statistic, scenario: &Scenario) -> Self {
        let cost = |scheme: Kind, target: f64| {
            Some([
                trade.best(Some(scheme), &[statistic], target).ok()?.seconds,
                target,
            ])
        };
        let scale = trade.standing(statistic).scale().unwrap_or(f64::NAN);
        let biases = |scheme: Kind| {
            let steps = trade
                .rungs_of(scheme)
                .filter_map(|setting| Some((setting.scheme.step()?, setting)));
            steps
                .map(|(step, setting)| (step, trade.bias(setting, statistic).relative_to(scale)))
                .collect()
        };
        let curve = |scheme: Kind| CostCurve {
            scheme,
            costs: TARGETS
                .iter()
                .filter_map(|target| cost(scheme, *target))
                .collect(),
            biases: biases(scheme),
            order: trade.law(scheme, statistic).map(|law| law.order),
        };
        CostCurves {
            title: scenario.title.clone(),
            seed: scenario.ensemble.seed,
            reference: trade.reference().scheme.to_string(),
            statistic,
            curves: trade.schemes().into_iter().map(curve).collect(),
        }
    }

    /// Whether any scheme reaches any target.
    pub fn has_points(&self) -> bool {
        self.curves.iter().any(|curve| !curve.costs.is_empty())
    }
}
