//! The summary of an ensemble: plain numbers, ready to be printed or stored.

use super::{LimitCycle, PhaseLaw, Statistic};
use crate::sums::interval::Measured;
use crate::sums::{Ends, Measurement};
use ndarray::Array2;
use std::fmt;
use stickslip_text::numbers::Digits;

/// The quantile levels of every band and of the stick durations.
pub const QUANTILE_LEVELS: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// One statistic with its 95 % interval, in the unit of the statistic. A value that does not exist
/// (for example because no stick ended, or there are fewer than two periods) is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The statistic that is estimated.
    pub statistic: Statistic,
    /// The estimate.
    pub estimate: f64,
    /// Standard error of the estimate, for which the path is the independent unit.
    pub standard_error: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// Discretisation bias, where it is known.
    pub bias: Option<Bias>,
}

/// The bias of the step: the difference between a statistic at the step of the run and its value at
/// zero step ([`crate::bias`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bias {
    /// The value at the step of the run minus the value at zero step, in the unit of the statistic.
    pub estimate: f64,
    /// The bias lies within this distance of its estimate at 95 %. The errors of sampling and of
    /// extrapolation are both included.
    pub uncertainty: f64,
    /// The observed order of the error, that is the power of the step with which the statistic
    /// changes; none where the paths do not determine it.
    pub order: Option<f64>,
}

impl Estimate {
    /// The estimate of this statistic.
    pub(super) fn new(statistic: Statistic, measured: Measured) -> Self {
        let Measurement {
            estimate,
            standard_error,
            low,
            high,
        } = measured.measurement();
        Estimate {
            statistic,
            estimate,
            standard_error,
            low,
            high,
            bias: None,
        }
    }

    /// Half the width of the 95 % interval.
    pub fn half_width(&self) -> f64 {
        (self.high - self.low) / 2.0
    }
}

/// The name, the estimate, its interval and its bias.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = Digits::of(self.estimate, self.standard_error);
        let [estimate, low, high] = [self.estimate, self.low, self.high].map(|x| digits.show(x));
        let name = self.statistic.name();
        write!(f, "{name} = {estimate}, 95 % interval [{low}, {high}]")?;
        self.bias.map_or(Ok(()), |bias| {
            let digits = Digits::of(bias.estimate, bias.uncertainty);
            let [bias, uncertainty] = [bias.estimate, bias.uncertainty].map(|x| digits.show(x));
            write!(f, ", bias of the step {bias} +- {uncertainty}")
        })
    }
}

/// Pointwise distribution of one variable over the ensemble, on the output grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Band {
    /// Mean at each time.
    pub mean: Vec<f64>,
    /// Interval of the mean at each time.
    pub mean_ends: Ends,
    /// Standard deviation at each time.
    pub sd: Vec<f64>,
    /// Interval of the standard deviation at each time.
    pub sd_ends: Ends,
    /// Quantiles, with shape (QUANTILE_LEVELS, time).
    pub quantiles: Array2<f64>,
    /// Intervals of the quantiles, row after row of `quantiles`.
    pub quantile_ends: Ends,
}

/// Bands of x, x', T and the probability of being static, on the output grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bands {
    /// Output times.
    pub time: Vec<f64>,
    /// Displacement x(t).
    pub displacement: Band,
    /// Velocity x'(t).
    pub velocity: Band,
    /// Temperature T(t).
    pub temperature: Band,
    /// Probability that a path is static at t.
    pub static_probability: Vec<f64>,
    /// Interval of the static probability at each time.
    pub static_probability_ends: Ends,
}

/// Counts in consecutive bins: bin i is `[edges[i], edges[i + 1])`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Histogram {
    /// Bin edges, one more than there are bins.
    pub edges: Vec<f64>,
    /// Number of values in each bin.
    pub counts: Vec<u64>,
}

/// The distribution of a quantity of phases ([`PhaseLaw`]): of stick durations D_j, j >= 1, say.
/// Phases that still run at t_end are right-censored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Distribution {
    /// h, where all values are multiples of the step h of the scheme. Their quantiles are then
    /// multiples of h as well.
    pub step: Option<f64>,
    /// Phases that ended.
    pub completed: u64,
    /// Phases that still run at t_end (right-censored).
    pub censored: u64,
    /// Values of the completed phases, in logarithmic bins.
    pub histogram: Histogram,
    /// Values so far of the censored phases, in the same bins.
    pub censored_counts: Vec<u64>,
    /// Kaplan-Meier estimate of P(D > t) at the upper edge of each bin.
    pub survival: Vec<f64>,
    /// Interval of the survival probability at each edge.
    pub survival_ends: Ends,
    /// Quantiles of the values of the completed phases, at QUANTILE_LEVELS.
    pub quantiles: Vec<f64>,
    /// Interval of each quantile.
    pub quantile_ends: Ends,
}

/// First sticks (j = 0).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FirstSticks {
    /// First sticks that ended.
    pub completed: u64,
    /// First sticks that still run at t_end.
    pub censored: u64,
}

/// A density, cell by cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DensityCurve {
    /// Edges of the cells, one more than there are cells.
    pub edges: Vec<f64>,
    /// The share of the counted time that is spent in each cell, divided by the width of the cell.
    pub density: Vec<f64>,
    /// Interval of each density.
    pub ends: Ends,
}

/// The fraction of the counted time that the body spends in each part of its phase plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Densities {
    /// Of x, at all times.
    pub displacement: DensityCurve,
    /// Of x' in motion. Its integral is one minus the share of the time at rest.
    pub velocity: DensityCurve,
    /// The edges of the cells of `joint`: those of x, and those of x'.
    pub joint_edges: [Vec<f64>; 2],
    /// Of (x, x') in motion, with shape (x, x').
    pub joint: Array2<f64>,
    /// The share of the time at rest.
    pub at_rest: f64,
    /// Interval of this share.
    pub at_rest_ends: [f64; 2],
}

/// Autocovariance and power spectrum of a variable about its mean over paths
/// ([`crate::stats::Spectrum`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fluctuations {
    /// The autocovariance at each lag; NaN, like the following fields, if all paths are equal at
    /// every row, so that nothing fluctuates.
    pub autocovariance: Vec<f64>,
    /// Interval of each autocovariance.
    pub autocovariance_ends: Ends,
    /// The two-sided power spectrum at each frequency.
    pub spectrum: Vec<f64>,
    /// Interval of each value of the spectrum.
    pub spectrum_ends: Ends,
}

/// The amplitude of the mean motion at one harmonic of the forcing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Line {
    /// Angular frequency.
    pub frequency: f64,
    /// Amplitude of the mean of x over paths.
    pub displacement: f64,
    /// Amplitude of the mean of x' over paths.
    pub velocity: f64,
}

/// The fluctuations of x and x' about their means over paths, on the counted rows of the output
/// grid. The spectrum S(w) is the integral of the autocovariance C(t) times e^{-i w t}: its
/// integral over all frequencies, positive and negative, divided by 2 pi, is the variance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spectrum {
    /// Number of segments into which the rows are divided.
    pub segments: u64,
    /// Lags of the autocovariance.
    pub lag: Vec<f64>,
    /// Angular frequencies of the spectrum, from 0 on.
    pub frequency: Vec<f64>,
    /// Of x.
    pub displacement: Fluctuations,
    /// Of x'.
    pub velocity: Fluctuations,
    /// The mean motion at the harmonics of the forcing; empty without a period, or if fewer than
    /// four of them are counted.
    pub lines: Vec<Line>,
}

/// When paths first reach a distance from their initial displacement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Passages {
    /// The distance.
    pub level: f64,
    /// The probability that |x - x0| has stayed below the distance until each time of the output
    /// grid, between rows included.
    pub survival: Vec<f64>,
    /// Interval of each probability.
    pub survival_ends: Ends,
}

/// The largest displacement and speed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extremes {
    /// The distribution over paths of the largest |x - x0|.
    pub displacement: Distribution,
    /// The distribution over paths of the largest |x'|.
    pub velocity: Distribution,
    /// The first passages of each requested level.
    pub passages: Vec<Passages>,
}

/// Distribution of k(j), the number of sub-phases of a dynamic phase.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SubPhaseCounts {
    /// counts[k - 1] is the number of completed dynamic phases with k sub-phases. The last entry
    /// also counts all larger k.
    pub counts: Vec<u64>,
    /// shares[k - 1] is the share of these phases among all completed dynamic phases.
    pub shares: Vec<f64>,
    /// Interval of each share.
    pub share_ends: Ends,
    /// Dynamic phases that still run at t_end.
    pub censored: u64,
}

/// What the statistics exclude because it was before [`crate::scenario::Statistics::after`]. The
/// first stick is not part of it, because it has separate statistics in any case.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transient {
    /// The end of the burn-in.
    pub end: f64,
    /// Completed sticks, j >= 1, that began before this end.
    pub sticks: u64,
    /// Completed dynamic phases that began before this end.
    pub slips: u64,
    /// Mean displacement during the burn-in, x(end) - x0.
    pub displacement: Measurement,
}

/// Moments of x at the whole periods.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PeriodMoments {
    /// The long-term drift velocity, if the spring binds the body to beta T and T has a constant
    /// slope or none. The long-term diffusion coefficient is then zero. None if neither is known.
    pub drift_limit: Option<f64>,
    /// Ends n P of the periods, n = 1, 2, ...
    pub time: Vec<f64>,
    /// Mean displacement since the start, x(n P) - x0.
    pub mean: Vec<f64>,
    /// Interval of the mean at each period.
    pub mean_ends: Ends,
    /// Variance of the displacement x(n P).
    pub variance: Vec<f64>,
    /// Interval of the variance at each period.
    pub variance_ends: Ends,
}

/// All statistics of an ensemble whose paths have been folded.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Paths simulated to the end. The diverged ones are included.
    pub completed_paths: u64,
    /// Numbers of the diverged paths, in ascending order. They are in no statistic.
    pub diverged: Vec<u64>,
    /// One estimate for each entry of `Statistic::ALL`, in that order.
    pub estimates: [Estimate; Statistic::ALL.len()],
    /// Distribution of the stick durations.
    pub stick_durations: Distribution,
    /// First sticks.
    pub first_sticks: FirstSticks,
    /// The other laws, if requested, in the order of [`PhaseLaw::ASKED`].
    pub laws: Option<[Distribution; PhaseLaw::ASKED.len()]>,
    /// Distribution of the number of sub-phases of a dynamic phase.
    pub sub_phases: SubPhaseCounts,
    /// What the burn-in excludes, if there is one.
    pub transient: Option<Transient>,
    /// x at the whole periods, those of the burn-in included.
    pub periods: PeriodMoments,
    /// The variables on the output grid.
    pub bands: Bands,
    /// The densities of x and x', if requested.
    pub densities: Option<Densities>,
    /// Autocovariance and spectrum of x and x', if requested.
    pub spectrum: Option<Spectrum>,
    /// The largest displacement and speed, if levels were requested.
    pub extremes: Option<Extremes>,
    /// The long-term motion, if nothing is random. It takes a separate path.
    pub cycle: Option<LimitCycle>,
    /// The requested statistics, in the order of tables and files. The estimates of the others are
    /// NaN.
    pub asked: Vec<Statistic>,
}

impl Summary {
    /// The estimate of a statistic.
    pub fn estimate(&self, statistic: Statistic) -> &Estimate {
        &self.estimates[statistic.index()]
    }

    /// The distribution of a law; none if it was not requested.
    pub fn law(&self, law: PhaseLaw) -> Option<&Distribution> {
        match law {
            PhaseLaw::Stick => Some(&self.stick_durations),
            asked => self.laws.as_ref()?.get(asked as usize - 1),
        }
    }

    /// The estimates of the requested statistics, in the order of tables and files.
    pub fn reported(&self) -> impl Iterator<Item = &Estimate> {
        self.asked.iter().map(|statistic| self.estimate(*statistic))
    }

    /// Whether the bias of any statistic is known.
    pub fn has_bias(&self) -> bool {
        self.estimates.iter().any(|e| e.bias.is_some())
    }

    /// The statistics whose bias is certain and larger than half the width of their intervals, the
    /// most certain first.
    ///
    /// A bias is more certain the larger it is relative to its uncertainty. The ratio to the
    /// interval is not suitable, because the interval of a median of durations that are multiples
    /// of the step has almost no width.
    pub fn dominated_by_bias(&self) -> Vec<Estimate> {
        let certainty = |e: &Estimate| {
            e.bias
                .map_or(0.0, |bias| bias.estimate.abs() / bias.uncertainty)
        };
        let exceeds = |e: &&Estimate| {
            e.bias
                .is_some_and(|bias| bias.estimate.abs() > e.half_width())
        };
        let is_certain = |e: &&Estimate| certainty(e) > 1.0;
        let mut dominated: Vec<Estimate> = self
            .estimates
            .iter()
            .filter(exceeds)
            .filter(is_certain)
            .copied()
            .collect();
        dominated.sort_by(|a, b| certainty(b).total_cmp(&certainty(a)));
        dominated
    }

    /// Set the biases of the statistics. A statistic that does not exist has none.
    pub fn set_biases(&mut self, biases: &[(Statistic, Bias)]) {
        for e in self.estimates.iter_mut().filter(|e| e.estimate.is_finite()) {
            e.bias = biases
                .iter()
                .find(|(of, _)| *of == e.statistic)
                .map(|(_, bias)| *bias);
        }
    }
}
