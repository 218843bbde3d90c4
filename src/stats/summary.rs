//! What an ensemble comes down to: plain numbers, ready to print or store.

use super::Statistic;
use ndarray::Array2;

/// The quantile levels of every band and of the stick durations.
pub const QUANTILE_LEVELS: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// A number with its 95 % interval, the path being the independent unit. What does not exist is
/// NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// The estimate.
    pub estimate: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
}

/// One statistic with its 95 % interval. A number that does not exist (no stick ended, fewer than
/// two periods) is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Which statistic.
    pub statistic: Statistic,
    /// The estimate.
    pub estimate: f64,
    /// Its standard error, the path being the independent unit.
    pub standard_error: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// Discretisation bias, where it is known.
    pub bias: Option<Bias>,
}

/// By how much the step moves a statistic away from its value at zero step ([`crate::bias`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bias {
    /// Estimate at the step of the run minus the value at zero step.
    pub estimate: f64,
    /// The bias is within this of its estimate, at 95 %: error of sampling and of extrapolation
    /// together.
    pub uncertainty: f64,
    /// The power of the step with which the statistic was seen to change, where that is told by the
    /// paths.
    pub order: Option<f64>,
}

impl Estimate {
    /// Half the width of the 95 % interval.
    pub fn half_width(&self) -> f64 {
        (self.high - self.low) / 2.0
    }
}

/// Ends of the 95 % interval of each point of a curve, the path being the independent unit.
///
/// An end that the data do not bound is infinite, or where the quantity ends. Of fewer than two
/// paths there is no interval, and both are NaN.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ends {
    /// The lower ends, point by point.
    pub low: Vec<f64>,
    /// The upper ends.
    pub high: Vec<f64>,
}

impl Ends {
    /// The same times a number that is not negative.
    pub(super) fn times(&self, number: f64) -> Ends {
        let times = |ends: &[f64]| ends.iter().map(|end| end * number).collect();
        Ends { low: times(&self.low), high: times(&self.high) }
    }
}

impl FromIterator<[f64; 2]> for Ends {
    fn from_iter<I: IntoIterator<Item = [f64; 2]>>(ends: I) -> Self {
        let (low, high) = ends.into_iter().map(|[low, high]| (low, high)).unzip();
        Ends { low, high }
    }
}

/// Pointwise distribution of one variable over the ensemble, on the output grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Mean at each time.
    pub mean: Vec<f64>,
    /// Its interval.
    pub mean_ends: Ends,
    /// Standard deviation at each time.
    pub sd: Vec<f64>,
    /// Its interval.
    pub sd_ends: Ends,
    /// Quantiles, shape (QUANTILE_LEVELS, time).
    pub quantiles: Array2<f64>,
    /// Their intervals, row after row of `quantiles`.
    pub quantile_ends: Ends,
}

/// Bands of x, x', T and the probability of being static, on the output grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands {
    /// Output times.
    pub time: Vec<f64>,
    /// x(t).
    pub displacement: Band,
    /// x'(t).
    pub velocity: Band,
    /// T(t).
    pub temperature: Band,
    /// P(static at t).
    pub static_probability: Vec<f64>,
    /// Its interval.
    pub static_probability_ends: Ends,
}

/// Counts in consecutive bins: bin i is `[edges[i], edges[i + 1])`.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Bin edges, one more than there are bins.
    pub edges: Vec<f64>,
    /// Number of values in each bin.
    pub counts: Vec<u64>,
}

/// Stick durations D_j, j >= 1: those that ended, and those still running at t_end.
#[derive(Clone, Debug, PartialEq)]
pub struct StickDurations {
    /// h, where all durations are multiples of the step of the scheme; their quantiles then are
    /// multiples of it, too.
    pub step: Option<f64>,
    /// Sticks, j >= 1, that ended.
    pub completed: u64,
    /// Interval of their expected number in as many paths.
    pub completed_ends: [f64; 2],
    /// Sticks, j >= 1, still running at t_end (right-censored).
    pub censored: u64,
    /// Interval of their expected number in as many paths.
    pub censored_ends: [f64; 2],
    /// First sticks (j = 0) that ended.
    pub first_completed: u64,
    /// Interval of their expected number in as many paths.
    pub first_completed_ends: [f64; 2],
    /// First sticks (j = 0) still running at t_end.
    pub first_censored: u64,
    /// Interval of their expected number in as many paths.
    pub first_censored_ends: [f64; 2],
    /// Durations of the completed sticks, logarithmic bins.
    pub histogram: Histogram,
    /// Interval of the expected number in each bin among as many completed sticks.
    pub count_ends: Ends,
    /// Durations so far of the censored sticks, in the same bins.
    pub censored_counts: Vec<u64>,
    /// Interval of their expected number in as many paths.
    pub censored_count_ends: Ends,
    /// Kaplan-Meier estimate of P(D > t) at the upper edge of each bin.
    pub survival: Vec<f64>,
    /// Its interval.
    pub survival_ends: Ends,
    /// QUANTILE_LEVELS of the completed durations.
    pub quantiles: Vec<f64>,
    /// Their intervals.
    pub quantile_ends: Ends,
}

/// Distribution of k(j), the number of sub-phases of a dynamic phase.
#[derive(Clone, Debug, PartialEq)]
pub struct SubPhaseCounts {
    /// counts[k - 1]: completed dynamic phases with k sub-phases; the last entry also holds all
    /// larger k.
    pub counts: Vec<u64>,
    /// Interval of the expected number among as many completed dynamic phases.
    pub count_ends: Ends,
    /// shares[k - 1]: their share of the completed dynamic phases.
    pub shares: Vec<f64>,
    /// Its interval.
    pub share_ends: Ends,
    /// Dynamic phases still running at t_end.
    pub censored: u64,
    /// Interval of their expected number in as many paths.
    pub censored_ends: [f64; 2],
}

/// What the statistics leave out because it was before [`crate::scenario::Statistics::after`]; the
/// first stick is apart in any case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transient {
    /// When it ends.
    pub end: f64,
    /// Completed sticks, j >= 1, that began in it.
    pub sticks: u64,
    /// Interval of their expected number in as many paths.
    pub stick_ends: [f64; 2],
    /// Completed dynamic phases that began in it.
    pub slips: u64,
    /// Interval of their expected number in as many paths.
    pub slip_ends: [f64; 2],
    /// Mean displacement in it, x(end) - x0.
    pub displacement: Measurement,
}

/// Moments of x at the whole forcing periods.
#[derive(Clone, Debug, PartialEq)]
pub struct PeriodMoments {
    /// n P, n = 1, 2, ...
    pub time: Vec<f64>,
    /// Mean of x(n P) - x0.
    pub mean: Vec<f64>,
    /// Its interval.
    pub mean_ends: Ends,
    /// Variance of x(n P).
    pub variance: Vec<f64>,
    /// Its interval.
    pub variance_ends: Ends,
}

/// Everything that is known about an ensemble once its paths are folded.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Paths simulated to the end, diverged ones included.
    pub completed_paths: u64,
    /// Numbers of the diverged paths, in order; they are in no statistic.
    pub diverged: Vec<u64>,
    /// One estimate for each of `Statistic::ALL`, in that order.
    pub estimates: [Estimate; Statistic::ALL.len()],
    /// Stick durations.
    pub stick_durations: StickDurations,
    /// Sub-phase counts.
    pub sub_phases: SubPhaseCounts,
    /// The burn-in, if there is one.
    pub transient: Option<Transient>,
    /// x at the whole forcing periods, those of the burn-in as well.
    pub periods: PeriodMoments,
    /// The output grid.
    pub bands: Bands,
}

impl Summary {
    /// What is known of a statistic.
    pub fn estimate(&self, statistic: Statistic) -> &Estimate {
        &self.estimates[statistic.index()]
    }

    /// Whether the bias of any statistic is known.
    pub fn has_bias(&self) -> bool {
        self.estimates.iter().any(|e| e.bias.is_some())
    }

    /// The statistics whose bias is beyond doubt and larger than their intervals show, the surest
    /// first.
    ///
    /// Surest is the bias that is largest against its uncertainty, and not the one that exceeds its
    /// interval most: the interval of a median of durations, which are multiples of the step, has
    /// next to no width.
    pub fn dominated_by_bias(&self) -> Vec<Estimate> {
        let certainty = |e: &Estimate| e.bias.map_or(0.0, |bias| bias.estimate.abs() / bias.uncertainty);
        let exceeds = |e: &&Estimate| e.bias.is_some_and(|bias| bias.estimate.abs() > e.half_width());
        let is_certain = |e: &&Estimate| certainty(e) > 1.0;
        let mut dominated: Vec<Estimate> = self.estimates.iter().filter(exceeds).filter(is_certain).copied().collect();
        dominated.sort_by(|a, b| certainty(b).total_cmp(&certainty(a)));
        dominated
    }

    /// Add what is known of the bias. A statistic that does not exist has none.
    pub fn set_biases(&mut self, biases: &[(Statistic, Bias)]) {
        for e in self.estimates.iter_mut().filter(|e| e.estimate.is_finite()) {
            e.bias = biases.iter().find(|(of, _)| *of == e.statistic).map(|(_, bias)| *bias);
        }
    }
}
