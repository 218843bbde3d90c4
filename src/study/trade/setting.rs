//! The measurement of a scheme with one step or tolerance.

use super::Number;
use crate::scheme::Scheme;
use crate::stats::Statistic;

/// Number of groups of paths. Each is left out in turn to find the error of a change (the
/// jackknife).
pub(super) const GROUPS: u64 = 20;

/// CPU seconds on one thread. All statistics are computed, but nothing is written to a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Cost of a run of one path.
    pub first: f64,
    /// Cost of each path of a large run.
    pub each: f64,
}

impl Cost {
    /// The cost of paths that have not been timed yet.
    pub(super) const UNKNOWN: Cost = Cost {
        first: f64::NAN,
        each: f64::NAN,
    };

    /// Cost of a run of this number of paths. If paths are simulated in lanes, one path costs as
    /// much as a full vector register.
    pub fn of(&self, paths: f64) -> f64 {
        self.first.max(paths * self.each)
    }
}

/// The measurement of one scheme with one step or tolerance.
#[derive(Clone, Debug)]
pub struct TradeSetting {
    /// The scheme with its step or tolerance; different for each setting.
    pub scheme: Scheme,
    /// Number of paths simulated for the estimates.
    pub paths: u64,
    /// Number of paths that diverged; they are in no estimate.
    pub diverged: u64,
    /// The cost of its paths.
    pub cost: Cost,
    /// One for each of `Statistic::ALL`, in that order.
    pub estimates: Vec<Number>,
    /// S(h) - S(h/2) on one realisation of the noise, for each of `Statistic::ALL`; empty if there
    /// is no finer step to compare with.
    pub changes: Vec<Number>,
}

impl TradeSetting {
    /// A statistic with its standard error.
    pub fn estimate(&self, statistic: Statistic) -> Number {
        self.estimates[statistic.index()]
    }

    /// The variance of a statistic per path. The variance of a run of N paths is this divided by N.
    pub fn variance(&self, statistic: Statistic) -> f64 {
        (self.paths - self.diverged) as f64 * self.estimate(statistic).error.powi(2)
    }

    /// S(h) - S(h/2), if it was measured.
    pub fn change(&self, statistic: Statistic) -> Option<Number> {
        self.changes.get(statistic.index()).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scheme::DiscreteVi;

    /// 40 of 100 paths are left, and the standard error of their mean is 0.5. The standard
    /// deviation of a path is then 0.5 sqrt(40), not 0.5 sqrt(100).
    #[test]
    fn the_variance_of_a_rung_is_that_of_the_paths_that_are_left() {
        let estimates = vec![
            Number {
                value: 3.0,
                error: 0.5
            };
            Statistic::ALL.len()
        ];
        let scheme = DiscreteVi { step: 0.1 }.into();
        let setting = TradeSetting {
            scheme,
            paths: 100,
            diverged: 60,
            cost: Cost::UNKNOWN,
            estimates,
            changes: Vec::new(),
        };
        assert_eq!(setting.variance(Statistic::SticksPerPath), 10.0);
    }
}
