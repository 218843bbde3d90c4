//! The discretisation bias of every statistic of a run. It is measured in addition to the run, at
//! an eighth of its cost.
//!
//! There are two measurements, and each statistic uses one of them:
//!
//! ```text
//! differences     some paths of the run, again at h, 2h and 4h on the same noise. Precise for
//!                 displacements, since the same noise gives nearly the same path. Gives the order
//! reference run   event-driven paths, which have no step. Precise for sticks, because another step
//!                 changes every stick exit even on the same noise
//! ```

mod differences;
mod extrapolation;
mod no_bias;
mod reference_run;

#[doc(hidden)]
pub use differences::Differences;
pub use no_bias::NoBias;
#[doc(hidden)]
pub use reference_run::ReferenceRun;

use crate::model::Problem;
use crate::scheme::{Discretisation, Scheme, Timeline};
use crate::stats::{Bias, Estimate, Record, Statistic, Summary};
use differences::Extrapolated;
use reference_run::Referenced;
use std::sync::atomic::{AtomicBool, Ordering};

/// The reference run may cost one part in this many of the run, if differences are measured as
/// well.
const REFERENCE_ONE_PART_IN: u64 = 12;

/// The same if differences are not measured.
const REFERENCE_ALONE_ONE_PART_IN: u64 = 10;

/// The simulations that measure the bias of a run.
#[derive(Clone, Debug)]
pub struct BiasPlan {
    /// None for the corrected scheme.
    differences: Option<Differences>,
    /// None without noise, where all paths are the same.
    reference: Option<ReferenceRun>,
}

impl BiasPlan {
    /// The plan for a run of this scheme on this model and timeline, with this seed and number of
    /// paths.
    pub fn new(
        scheme: Scheme,
        model: &Problem,
        timeline: &Timeline,
        seed: u64,
        paths: u64,
    ) -> Result<Self, NoBias> {
        let is_random = model.is_random();
        let (h, is_corrected) = match scheme.discretisation() {
            Discretisation::Step { h } => (h, false),
            Discretisation::CorrectedStep { h } => (h, true),
            Discretisation::Tolerance { tolerance } => {
                let is_absorbed = model.force.is_none() || model.absorbed().is_some();
                return Err(match (!is_absorbed, is_random) {
                    (false, false) => NoBias::Exact,
                    (false, true) => NoBias::Tolerance(tolerance),
                    (true, false) => NoBias::Integrated,
                    (true, true) => NoBias::Followed(tolerance),
                });
            }
            Discretisation::Approximation => return Err(NoBias::Approximation),
        };
        let differences = Differences::new(scheme, model, timeline, seed, paths)?;
        let one_part_in = if is_corrected {
            REFERENCE_ALONE_ONE_PART_IN
        } else {
            REFERENCE_ONE_PART_IN
        };
        let reference =
            is_random.then(|| ReferenceRun::new(model, timeline, h, seed, paths, one_part_in));
        if is_corrected && reference.is_none() {
            return Err(NoBias::Corrected);
        }
        Ok(BiasPlan {
            differences: Some(differences).filter(|_| !is_corrected),
            reference,
        })
    }

    /// The same for a run with these records, possibly of antithetic pairs.
    pub fn recording(mut self, record: &Record, antithetic: bool) -> Self {
        let record = record.of_no_path();
        if let Some(reference) = &mut self.reference {
            reference.record = record;
        }
        let of_run = |mut differences: Differences| {
            differences.record = record;
            if antithetic {
                differences.in_pairs()
            } else {
                differences
            }
        };
        BiasPlan {
            differences: self.differences.map(of_run),
            ..self
        }
    }

    /// The bias of every statistic of `run` for which it is known well enough. The result has the
    /// same bits for any number of `threads`.
    pub fn estimate(
        &self,
        run: &Summary,
        threads: usize,
        stop: &AtomicBool,
    ) -> Result<Vec<(Statistic, Bias)>, NoBias> {
        let biases = self.simulate(threads, stop)?.of(run);
        if biases.is_empty() {
            Err(NoBias::Uncertain)
        } else {
            Ok(biases)
        }
    }

    /// Simulate the paths from which the bias is measured. This may be done before the run or after
    /// it.
    pub fn simulate(&self, threads: usize, stop: &AtomicBool) -> Result<AuxiliaryRun, NoBias> {
        let extrapolated = match &self.differences {
            None => Err(NoBias::Corrected),
            Some(differences) => differences.extrapolate(threads, stop),
        };
        // The reference run needs no coarse step. If 2h or 4h is unstable, it is the only
        // measurement.
        let is_alone = matches!(extrapolated, Err(NoBias::Diverged { .. }) | Ok((_, false)));
        let reference = self.reference.as_ref();
        let reference = if is_alone {
            reference.map(ReferenceRun::at_any_rate)
        } else {
            reference.cloned()
        };
        let referenced = reference.and_then(|reference| reference.simulate(threads, stop));
        match extrapolated {
            _ if stop.load(Ordering::Relaxed) => Err(NoBias::Stopped),
            Err(absent) if referenced.is_none() => Err(absent),
            Ok((extrapolated, is_stable)) if is_stable || referenced.is_none() => {
                Ok(AuxiliaryRun {
                    extrapolated,
                    referenced,
                })
            }
            _ => Ok(AuxiliaryRun {
                extrapolated: Vec::new(),
                referenced,
            }),
        }
    }
}

/// The results of the simulations that measure the bias of a run.
#[derive(Clone, Debug)]
pub struct AuxiliaryRun {
    /// The biases by extrapolation from three steps.
    extrapolated: Vec<Extrapolated>,
    referenced: Option<Referenced>,
}

impl AuxiliaryRun {
    /// The bias of every statistic of `run` for which it is known well enough.
    pub fn of(&self, run: &Summary) -> Vec<(Statistic, Bias)> {
        let referenced = self
            .referenced
            .as_ref()
            .map_or_else(Vec::new, |exact| exact.biases(run));
        let paths = run.valid_paths();
        let bias_of = |e: &Estimate| {
            let extrapolated = self
                .extrapolated
                .iter()
                .find(|found| found.statistic == e.statistic);
            // Without a reference run this is the best estimate.
            let is_typical =
                |found: &&Extrapolated| self.referenced.is_none() || found.is_typical_of(e, paths);
            let typical = extrapolated.filter(is_typical).map(|found| found.bias);
            let referenced = referenced
                .iter()
                .find(|(of, _)| *of == e.statistic)
                .map(|(_, bias)| *bias);
            let bias = chosen(typical, referenced).filter(|bias| is_informative(bias, e, paths))?;
            Some(Bias {
                order: extrapolated.and_then(|found| found.bias.order),
                ..bias
            })
        };
        run.estimates
            .iter()
            .filter_map(|e| Some((e.statistic, bias_of(e)?)))
            .collect()
    }
}

/// The extrapolation is used if its uncertainty is below this fraction of that of the reference
/// run, and the two are consistent. The uncertainty of the extrapolation has an error of 18 %
/// itself, because it comes from 16 groups.
const UNCERTAINTY_RATIO: f64 = 0.7;

/// The maximum uncertainty of the bias of a small number, in half-widths of its interval. It is 28 if
/// it is extrapolated, with p = 1/2, from a sixtieth of the paths, whose values at h and 2h are
/// independent: sqrt(60) sqrt(2)/(sqrt(2) - 1), times 2.131/1.96 for 16 groups.
const MOST_HALF_WIDTHS: f64 = 30.0;

/// Whether a bias is informative about an estimate from this number of paths: its uncertainty does
/// not exceed both the estimate and the uncertainty of the estimate. If all paths agree, it always
/// is. If they do not, and the step makes no difference, too few paths measure the bias to show
/// one; and if the run has too few paths for an interval, so has the measurement of the bias. A
/// single path has no interval, but nothing in it is random.
fn is_informative(bias: &Bias, e: &Estimate, paths: u64) -> bool {
    let half_width = e.half_width();
    let is_within = bias.uncertainty <= e.estimate.abs().max(MOST_HALF_WIDTHS * half_width);
    let shows_change = bias.uncertainty > 0.0 && !half_width.is_nan();
    half_width == 0.0 || is_within && (shows_change || paths == 1)
}

/// The chosen one of two measurements of a bias, or the only one.
///
/// The reference run assumes nothing about the order, so it is used unless the extrapolation is
/// clearly more precise. Using the more precise of two similar measurements would often select the
/// one whose uncertainty is too small by chance.
///
/// If a clearly more precise extrapolation contradicts the reference run, one of the two is wrong:
/// the order of the error is different, or the reference run is off by more than its uncertainty,
/// as one in several dozen is. The estimate is then that of the reference run, with an uncertainty
/// that covers the extrapolation. So an outlier is not mistaken for a bias, and a wrong
/// extrapolation is not used.
fn chosen(extrapolated: Option<Bias>, referenced: Option<Bias>) -> Option<Bias> {
    let (Some(extrapolated), Some(referenced)) = (extrapolated, referenced) else {
        return extrapolated.or(referenced);
    };
    let referenced = Bias {
        order: extrapolated.order,
        ..referenced
    };
    if extrapolated.uncertainty >= UNCERTAINTY_RATIO * referenced.uncertainty {
        return Some(referenced);
    }
    let apart = (extrapolated.estimate - referenced.estimate).abs();
    let is_possible = apart <= extrapolated.uncertainty + referenced.uncertainty;
    let uncertainty = referenced.uncertainty.max(apart + extrapolated.uncertainty);
    Some(if is_possible {
        extrapolated
    } else {
        Bias {
            uncertainty,
            ..referenced
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extrapolation_counts_where_it_is_much_more_precise() {
        let bias = |estimate, uncertainty, order| {
            Some(Bias {
                estimate,
                uncertainty,
                order,
            })
        };
        let referenced = bias(1.0, 0.4, None);
        assert_eq!(
            chosen(bias(0.7, 0.1, Some(0.5)), referenced),
            bias(0.7, 0.1, Some(0.5))
        );
        // It is not precise enough, and might only be so by chance.
        assert_eq!(
            chosen(bias(0.7, 0.3, Some(0.5)), referenced),
            bias(1.0, 0.4, Some(0.5))
        );
        assert_eq!(chosen(None, referenced), referenced);
        assert_eq!(chosen(referenced, None), referenced);
        assert_eq!(chosen(None, None), None);
    }

    /// The two are 0.625 apart where 0.5625 is possible. The estimate stays that of the reference
    /// run, and its interval from 0.25 to 1.75 holds that of the extrapolation, from 0.25 to 0.5.
    #[test]
    fn a_contradicted_reference_run_is_kept() {
        let bias = |estimate, uncertainty, order| {
            Some(Bias {
                estimate,
                uncertainty,
                order,
            })
        };
        let kept = chosen(bias(0.375, 0.125, Some(0.5)), bias(1.0, 0.4375, None));
        assert_eq!(kept, bias(1.0, 0.75, Some(0.5)));
    }

    /// The numbers of an overdamped scene whose reference run is off by 2.5 times the standard
    /// deviation, once in a hundred runs. The differences say that there is next to no bias, and
    /// the corrected number must be the estimate itself. If the uncertainty of the reference run
    /// stood as it is, 64 % of its error would be subtracted.
    #[test]
    fn an_outlier_of_the_reference_run_is_not_subtracted() {
        let extrapolated = Bias {
            estimate: -0.0014,
            uncertainty: 0.0014,
            order: Some(1.0),
        };
        let outlier = Bias {
            estimate: -0.044,
            uncertainty: 0.034,
            order: None,
        };
        let bias = chosen(Some(extrapolated), Some(outlier)).expect("two measurements");
        let estimate = |bias| Estimate {
            statistic: Statistic::PeriodDisplacementMean,
            estimate: 0.03,
            standard_error: 0.001,
            low: 0.028,
            high: 0.032,
            bias: Some(bias),
        };
        let corrected = estimate(bias).corrected().expect("a bias");
        assert!((corrected.estimate - 0.03).abs() < 1e-6, "{corrected:?}");
        assert!(
            corrected.low <= 0.03 + 0.0014 && 0.03 + 0.0014 <= corrected.high,
            "{corrected:?}"
        );
        let hasty = estimate(outlier).corrected().expect("a bias");
        assert!((hasty.estimate - 0.03) > 0.6 * 0.044, "{hasty:?}");
    }

    /// The differences are 20 times as precise as the reference run, and the truth is 0. Either of
    /// the two is right, and the other is off by up to four uncertainties of the reference run.
    /// Where the two contradict, a right reference run is kept, and a wrong one gets a wide uncertainty.
    #[test]
    fn where_two_contradict_the_interval_holds_both() {
        let bias = |estimate, uncertainty| Bias {
            estimate,
            uncertainty,
            order: None,
        };
        for off in (-400..=400).map(|i| f64::from(i) * 0.01) {
            // The uncertainty is 1 in either case.
            let right_differences =
                chosen(Some(bias(0.0, 0.05)), Some(bias(off, 1.0))).expect("a bias");
            let right_reference =
                chosen(Some(bias(off, 0.05)), Some(bias(0.0, 1.0))).expect("a bias");
            let holds = |bias: Bias| bias.estimate.abs() <= bias.uncertainty;
            assert!(holds(right_differences), "{off}: {right_differences:?}");
            assert!(
                off.abs() <= 1.05 || holds(right_reference),
                "{off}: {right_reference:?}"
            );
            assert!(
                off.abs() <= 1.05 || right_reference.estimate == 0.0,
                "{off}: {right_reference:?}"
            );
        }
    }

    /// An estimate of 5 to within 0.1, and one of 0.01 to within 0.1.
    #[test]
    fn a_bias_less_certain_than_the_estimate_is_not_stated() {
        let with = |paths: u64, half_width: f64, estimate: f64, uncertainty: f64| {
            let (statistic, standard_error) = (Statistic::JumpMean, half_width / 2.0);
            let e = Estimate {
                statistic,
                estimate,
                standard_error,
                low: estimate - half_width,
                high: estimate + half_width,
                bias: None,
            };
            is_informative(
                &Bias {
                    estimate: 48.0,
                    uncertainty,
                    order: None,
                },
                &e,
                paths,
            )
        };
        let of = |estimate, uncertainty| with(800, 0.1, estimate, uncertainty);
        assert_eq!(
            [
                of(5.0, 78.0),
                of(5.0, 5.1),
                of(5.0, 4.9),
                of(0.01, 3.1),
                of(0.01, 2.9)
            ],
            [false, false, true, false, true]
        );
        // Paths that differ show no difference between steps; all paths agree; no interval; one path.
        assert_eq!(
            [
                with(800, 0.1, 2.0, 0.0),
                with(800, 0.0, 2.0, 0.0),
                with(800, f64::NAN, 2.0, 0.1),
                with(1, f64::NAN, 2.0, 0.0)
            ],
            [false, true, false, true]
        );
    }
}
