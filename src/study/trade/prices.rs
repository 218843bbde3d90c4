//! The prices of accuracy of one statistic, as tables and pictures show them.

use super::{TARGETS, Trade};
use crate::scheme::Kind;
use crate::stats::Statistic;

/// What accuracy costs for one statistic.
#[derive(Clone, Debug, PartialEq)]
pub struct Prices {
    /// What was simulated.
    pub title: String,
    /// Of which statistic the error is.
    pub statistic: Statistic,
    /// For each scheme the CPU seconds on one thread, and the relative error that they buy.
    pub curves: Vec<(Kind, Vec<[f64; 2]>)>,
}

impl Prices {
    /// As a trade predicts them.
    pub fn of(trade: &Trade, statistic: Statistic, title: &str) -> Self {
        let cost =
            |scheme: Kind, target: f64| Some([trade.best(Some(scheme), &[statistic], target).ok()?.seconds, target]);
        let curve = |scheme: Kind| (scheme, TARGETS.iter().filter_map(|target| cost(scheme, *target)).collect());
        let curves = trade.schemes().into_iter().map(curve).collect();
        Prices { title: title.to_string(), statistic, curves }
    }

    /// Whether any scheme reaches any target.
    pub fn is_known(&self) -> bool {
        self.curves.iter().any(|(_, points)| !points.is_empty())
    }
}
