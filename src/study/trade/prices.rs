//! The cost of accuracy for one statistic, in the form that tables and pictures use.

use super::{TARGETS, Trade};
use crate::scheme::Kind;
use crate::stats::Statistic;

/// The cost of accuracy for one statistic.
#[derive(Clone, Debug, PartialEq)]
pub struct Prices {
    /// Title of the scenario.
    pub title: String,
    /// The statistic whose error is meant.
    pub statistic: Statistic,
    /// For each scheme, pairs of CPU seconds on one thread and the relative error that is reached.
    pub curves: Vec<(Kind, Vec<[f64; 2]>)>,
}

impl Prices {
    /// The costs that a trade predicts for each of [`TARGETS`].
    pub fn of(trade: &Trade, statistic: Statistic, title: &str) -> Self {
        let cost =
            |scheme: Kind, target: f64| Some([trade.best(Some(scheme), &[statistic], target).ok()?.seconds, target]);
        let curve = |scheme: Kind| (scheme, TARGETS.iter().filter_map(|target| cost(scheme, *target)).collect());
        let curves = trade.schemes().into_iter().map(curve).collect();
        Prices { title: title.to_string(), statistic, curves }
    }

    /// Whether any scheme reaches any target.
    pub fn has_points(&self) -> bool {
        self.curves.iter().any(|(_, points)| !points.is_empty())
    }
}
