//! How wrong the step makes a run: the discretisation bias of every statistic, measured beside the run at an eighth of its cost.
//!
//! Two measurements, of which the sharper one counts, statistic by statistic:
//!
//! ```text
//! differences   some of the run's paths again at h, 2h and 4h on one noise: good where the same noise makes the same path, as for
//!               displacements; tells the order
//! anchor        some paths without a step: good where every stick exit is another event at another step, as for sticks
//! ```

mod anchor;
mod differences;
mod extrapolation;
mod groups;

#[doc(hidden)]
pub use anchor::Anchor;
#[doc(hidden)]
pub use differences::Differences;

use crate::model::Model;
use crate::scheme::{Discretisation, Scheme, Timeline};
use crate::stats::{Bias, Statistic, Summary};
use differences::MIN_STEPS;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// Why there is no estimate of the bias.
#[derive(Clone, Debug, PartialEq)]
pub enum NoBias {
    /// The event-driven scheme under noise: it has a tolerance instead of a step.
    Tolerance(f64),
    /// The event-driven scheme where nothing is random.
    Exact,
    /// The quasi-static scheme: its error is that of an approximation, which no step makes smaller.
    Approximation,
    /// The corrected scheme, where paths without a step cost too much: its error changes sign between the steps that would be compared.
    Corrected,
    /// f_s = f_d under noise: stick statistics have no limit as h falls.
    EqualFriction,
    /// Too few paths.
    FewPaths {
        /// How many it takes.
        needed: u64,
    },
    /// Too few steps.
    FewSteps,
    /// Paths diverged at h, 2h or 4h.
    Diverged {
        /// How many, all steps together.
        paths: usize,
    },
    /// Stopped from outside.
    Stopped,
}

impl fmt::Display for NoBias {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NoBias::Tolerance(tolerance) => write!(
                f,
                "there is no step; the tolerance leaves discretisation {tolerance} of every statistic that has a limit"
            ),
            NoBias::Exact => {
                f.write_str("there is no step, and where nothing is random every event is exact to rounding")
            }
            NoBias::Approximation => {
                f.write_str("that the forcing stands still in a slip is an approximation, which no step mends")
            }
            NoBias::Corrected => f.write_str(
                "the error of corrected-vi cannot be extrapolated from h, 2h and 4h, and paths without a step, to compare with, \
                 take too long for this run; `mc trade` measures it",
            ),
            NoBias::EqualFriction => f.write_str("with f_s = f_d under noise, sticks have no limit as the step falls"),
            NoBias::FewPaths { needed } => write!(f, "it takes {needed} paths or more"),
            NoBias::FewSteps => write!(f, "it takes {MIN_STEPS} steps or more"),
            NoBias::Diverged { paths } => write!(f, "{paths} of the paths simulated for it at h, 2h and 4h diverged"),
            NoBias::Stopped => f.write_str("the run was stopped before"),
        }
    }
}

/// Paths without a step may cost one part in so many of a run, beside the differences.
const SHARE: u64 = 20;

/// The same without them.
const SHARE_ALONE: u64 = 10;

/// What the bias of a run is a function of, besides its result.
#[derive(Clone, Debug)]
pub struct BiasPlan {
    /// Not for the corrected scheme.
    differences: Option<Differences>,
    /// Not where nothing is random, where one path tells all.
    anchor: Option<Anchor>,
}

impl BiasPlan {
    /// For a run of this scheme, seed and number of paths.
    pub fn new(scheme: Scheme, model: &Model, timeline: &Timeline, seed: u64, paths: u64) -> Result<Self, NoBias> {
        let is_random = model.temperature.is_random();
        let (h, is_corrected) = match scheme.discretisation() {
            Discretisation::Step { h } => (h, false),
            Discretisation::CorrectedStep { h } => (h, true),
            Discretisation::Tolerance { .. } if !is_random => return Err(NoBias::Exact),
            Discretisation::Tolerance { tolerance } => return Err(NoBias::Tolerance(tolerance)),
            Discretisation::Approximation => return Err(NoBias::Approximation),
        };
        let differences = Differences::new(scheme, model, timeline, seed, paths)?;
        let share = if is_corrected { SHARE_ALONE } else { SHARE };
        let anchor = is_random.then(|| Anchor::new(model, timeline, h, seed, paths, share));
        if is_corrected && anchor.is_none() {
            return Err(NoBias::Corrected);
        }
        Ok(BiasPlan { differences: Some(differences).filter(|_| !is_corrected), anchor })
    }

    /// The same for a run of antithetic pairs.
    pub fn in_pairs(self) -> Self {
        BiasPlan { differences: self.differences.map(Differences::in_pairs), ..self }
    }

    /// The bias of every statistic that exists in the run whose result this is, on `threads` threads, the same bits for any number of them.
    pub fn estimate(&self, run: &Summary, threads: usize, stop: &AtomicBool) -> Result<Vec<(Statistic, Bias)>, NoBias> {
        Ok(self.simulate(threads, stop)?.of(run))
    }

    /// What the bias follows from beside the run, which may come before the run or after it.
    pub fn simulate(&self, threads: usize, stop: &AtomicBool) -> Result<BesideRun, NoBias> {
        let anchored = self.anchor.as_ref().and_then(|anchor| anchor.simulate(threads, stop));
        let Some(differences) = &self.differences else {
            let is_stopped = stop.load(Ordering::Relaxed);
            let absent = || if is_stopped { NoBias::Stopped } else { NoBias::Corrected };
            return Ok(BesideRun { extrapolated: Vec::new(), anchored: Some(anchored.ok_or_else(absent)?) });
        };
        Ok(BesideRun { extrapolated: differences.estimate(threads, stop)?, anchored })
    }
}

/// What was simulated beside a run for the bias of its step.
#[derive(Clone, Debug)]
pub struct BesideRun {
    /// The biases that follow from three steps.
    extrapolated: Vec<(Statistic, Bias)>,
    /// What paths without a step come to.
    anchored: Option<Summary>,
}

impl BesideRun {
    /// The bias of every statistic that exists in the run whose result this is.
    pub fn of(&self, run: &Summary) -> Vec<(Statistic, Bias)> {
        let anchored = self.anchored.as_ref().map_or_else(Vec::new, |exact| anchor::biases(run, exact));
        let of = |biases: &[(Statistic, Bias)], statistic| biases.iter().find(|(s, _)| *s == statistic).map(|b| b.1);
        let told = |statistic| chosen(of(&self.extrapolated, statistic), of(&anchored, statistic));
        Statistic::ALL.into_iter().filter_map(|statistic| Some((statistic, told(statistic)?))).collect()
    }
}

/// By what the 95 % uncertainty is multiplied that so many paths tell. With a few dozen paths the intervals of skewed laws
/// hold less often than they say, and what is promised is for every statistic of every scene (docs/bias.md).
fn caution(paths: u64) -> f64 {
    1.0 + 2.5 / (paths as f64).sqrt()
}

/// Extrapolation counts where it is sharper beyond doubt than the paths without a step, and does not contradict them.
const SHARPER: f64 = 0.5;

/// Of the two measurements of one bias, where there are two.
///
/// The anchor assumes nothing, so it is taken unless the other is sharper by far. If the sharper of two alike were taken, it would
/// often be the one whose uncertainty is too small by chance.
fn chosen(extrapolated: Option<Bias>, anchored: Option<Bias>) -> Option<Bias> {
    let (Some(extrapolated), Some(anchored)) = (extrapolated, anchored) else { return extrapolated.or(anchored) };
    let is_sharper = extrapolated.uncertainty < SHARPER * anchored.uncertainty;
    let apart = (extrapolated.estimate - anchored.estimate).abs();
    let is_possible = apart <= extrapolated.uncertainty + anchored.uncertainty;
    Some(if is_sharper && is_possible { extrapolated } else { Bias { order: extrapolated.order, ..anchored } })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extrapolation_counts_where_it_is_much_sharper_and_possible() {
        let bias = |estimate, uncertainty, order| Some(Bias { estimate, uncertainty, order });
        let anchored = bias(1.0, 0.4, None);
        assert_eq!(chosen(bias(0.7, 0.1, Some(0.5)), anchored), bias(0.7, 0.1, Some(0.5)));
        // No sharper by chance than chance may be; and in contradiction, 0.6 apart where 0.5 is possible.
        assert_eq!(chosen(bias(0.7, 0.3, Some(0.5)), anchored), bias(1.0, 0.4, Some(0.5)));
        assert_eq!(chosen(bias(0.4, 0.1, Some(0.5)), anchored), bias(1.0, 0.4, Some(0.5)));
        assert_eq!(chosen(None, anchored), anchored);
        assert_eq!(chosen(anchored, None), anchored);
        assert_eq!(chosen(None, None), None);
    }

    #[test]
    fn few_paths_are_trusted_less() {
        assert_eq!((caution(25), caution(10_000)), (1.5, 1.025));
    }
}
