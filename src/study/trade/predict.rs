//! From measured settings to a choice: the cheapest setting for a target and its cost, or why there is
//! none.

use super::pairing::WORTH;
use super::{Law, Number, Pairing, Trade, TradeSetting};
use crate::scheme::{Discretisation, Kind, Scheme};
use crate::stats::Statistic;

/// The relative root mean square errors for which a trade is tabulated.
pub const TARGETS: [f64; 4] = [0.1, 0.01, 0.001, 0.0001];

/// Number of halvings of the finest measured step to which a law is extrapolated.
const HALVINGS: i32 = 40;

/// The cheapest run for a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The scheme with its step or tolerance.
    pub scheme: Scheme,
    /// Number of paths.
    pub paths: u64,
    /// Whether they are antithetic pairs.
    pub is_antithetic: bool,
    /// Predicted CPU seconds on one thread.
    pub seconds: f64,
    /// The statistic that needs the most paths.
    pub decisive: Statistic,
    /// The upper bound of the bias of that statistic, relative to its scale.
    pub bias: f64,
    /// Whether this setting was run; otherwise it is a finer step, for which the bias is predicted.
    pub is_measured: bool,
}

/// Why there is no run for a target.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The scheme was not run.
    #[error("it was not run")]
    NotRun,
    /// The statistic has no relative error; [`Trade::standing`] gives the reason.
    #[error("no run can estimate {}", .0.name())]
    NoAnswer(Statistic),
    /// No setting is known to have a bias below the target.
    #[error("the bias of {} is {}", .statistic.name(), match .is_unresolved {
        true => format!("known only to {least:.1e}; use a larger budget"),
        false => format!("up to {least:.1e} at the finest setting"),
    })]
    Bias {
        /// The statistic whose bias is too large.
        statistic: Statistic,
        /// The smallest bound of its bias, relative to its scale.
        least: f64,
        /// Whether that bound is the error of the measurement rather than a resolved bias.
        is_unresolved: bool,
    },
}

/// A setting that might be chosen. `terms` holds for each statistic the bound of the bias and the
/// variance per path, both in absolute terms.
struct Candidate {
    scheme: Scheme,
    cost: super::Cost,
    is_measured: bool,
    terms: Vec<(Statistic, BiasBound, f64)>,
}

/// An upper bound of the absolute bias. It is unresolved if it mostly is the error of the
/// measurement.
#[derive(Clone, Copy)]
struct BiasBound {
    value: f64,
    is_unresolved: bool,
}

impl BiasBound {
    /// The smaller of two bounds.
    fn or(self, other: BiasBound) -> BiasBound {
        if other.value < self.value {
            other
        } else {
            self
        }
    }
}

/// The sum over k >= 0 of the changes at the steps h/r, h/2r, h/4r, ..., divided by the change at
/// h, if changes are proportional to sqrt(h).
fn tail(r: f64) -> f64 {
    r.sqrt().recip() / (1.0 - 0.5f64.sqrt())
}

impl From<Number> for BiasBound {
    fn from(bias: Number) -> Self {
        BiasBound {
            value: bias.bound(),
            is_unresolved: bias.value.abs() < 2.0 * bias.error,
        }
    }
}

impl Trade {
    /// The cheapest run, of one scheme or of any, in which each of these statistics has a relative
    /// root mean square error of at most `target`. If there is none, the error gives the reason.
    ///
    /// The settings compared are the measured settings and further halvings of the finest step, whose
    /// bias follows from the fitted law. Steps in between would save little. With bias C h^p and
    /// cost 1/h, the cost is least where bias^2 = target^2/(2p + 1). The better of two steps, one
    /// twice the other, costs at most 13 % more than this minimum at p = 1/2, and 19 % more at p =
    /// 1.
    ///
    /// If antithetic pairs were measured in addition to independent paths, they are chosen if they
    /// make the run at least a fifth cheaper.
    ///
    /// A bias counts with its upper bound at one-sided 95 %, so that an unresolved bias counts with
    /// its largest possible value.
    pub fn best(
        &self,
        scheme: Option<Kind>,
        statistics: &[Statistic],
        target: f64,
    ) -> Result<Choice, Refusal> {
        if let Some(statistic) = statistics
            .iter()
            .find(|s| self.standing(**s).scale().is_none())
        {
            return Err(Refusal::NoAnswer(*statistic));
        }
        let candidates: Vec<Candidate> = (self.schemes().into_iter())
            .filter(|kind| scheme.is_none_or(|asked| asked == *kind))
            .flat_map(|kind| self.candidates(kind, statistics))
            .collect();
        let cheapest = |in_pairs: bool| {
            let mut refusal = Refusal::NotRun;
            let mut best: Option<Choice> = None;
            for candidate in &candidates {
                match self.run(candidate, target, in_pairs) {
                    Ok(choice) if best.is_none_or(|best| choice.seconds < best.seconds) => {
                        best = Some(choice)
                    }
                    Ok(_) => {}
                    Err(other) => refusal = refusal.or(other),
                }
            }
            best.ok_or(refusal)
        };
        let best = cheapest(false)?;
        let paired = matches!(self.pairing, Pairing::Measured(_))
            .then(|| cheapest(true).ok())
            .flatten();
        Ok(paired
            .filter(|paired| paired.seconds <= WORTH * best.seconds)
            .unwrap_or(best))
    }

    /// The number of paths of a candidate, N = variance/(target^2 - bias^2) for the statistic that
    /// needs the most, with independent paths or with the pairs that were measured in addition.
    fn run(&self, candidate: &Candidate, target: f64, in_pairs: bool) -> Result<Choice, Refusal> {
        let is_antithetic = in_pairs || self.pairing == Pairing::Asked;
        let mut choice: Option<Choice> = None;
        for (statistic, bound, variance) in &candidate.terms {
            let scale = self.standing(*statistic).scale().unwrap_or(f64::NAN);
            let ratio = self
                .pairing
                .ratio(*statistic)
                .filter(|_| in_pairs)
                .unwrap_or(1.0);
            let (bias, variance) = (bound.value / scale, ratio * variance / (scale * scale));
            let room = target * target - bias * bias;
            if !(room > 0.0 && variance.is_finite()) {
                let least = if bias.is_nan() { f64::INFINITY } else { bias };
                return Err(Refusal::Bias {
                    statistic: *statistic,
                    least,
                    is_unresolved: bound.is_unresolved,
                });
            }
            // An error estimate needs two paths, unless all paths are equal.
            let paths = (variance / room)
                .ceil()
                .max(if self.is_random { 2.0 } else { 1.0 });
            let paths = if is_antithetic {
                2.0 * (paths / 2.0).ceil()
            } else {
                paths
            };
            if choice.is_none_or(|choice| paths > choice.paths as f64) {
                let Candidate {
                    scheme,
                    cost,
                    is_measured,
                    ..
                } = *candidate;
                let (decisive, seconds) = (*statistic, cost.of(paths));
                let paths = paths as u64;
                choice = Some(Choice {
                    scheme,
                    paths,
                    is_antithetic,
                    seconds,
                    decisive,
                    bias,
                    is_measured,
                });
            }
        }
        choice
            .filter(|choice| choice.seconds.is_finite())
            .ok_or(Refusal::NotRun)
    }

    fn candidates(&self, kind: Kind, statistics: &[Statistic]) -> Vec<Candidate> {
        let settings: Vec<&TradeSetting> = self
            .rungs_of(kind)
            .filter(|setting| setting.diverged == 0)
            .collect();
        let laws: Vec<Option<Law>> = statistics
            .iter()
            .map(|statistic| self.law(kind, *statistic))
            .collect();
        let terms = |setting: &TradeSetting,
                     bound: &dyn Fn(Statistic, Option<&Law>) -> BiasBound| {
            let each = statistics.iter().zip(&laws);
            each.map(|(s, law)| (*s, bound(*s, law.as_ref()), setting.variance(*s)))
                .collect()
        };
        let measured = |setting: &&TradeSetting| {
            let terms = terms(setting, &|s, law| self.bound(setting, s, law));
            Candidate {
                scheme: setting.scheme,
                cost: setting.cost,
                is_measured: true,
                terms,
            }
        };
        let mut candidates: Vec<Candidate> = settings.iter().map(measured).collect();
        let finest = settings
            .last()
            .and_then(|setting| Some((*setting, setting.scheme.step()?)));
        if let Some((setting, finest)) = finest {
            candidates.extend((1..=HALVINGS).map(|i| {
                let finer = 2f64.powi(i);
                let h = finest / finer;
                let bound = |s: Statistic, law: Option<&Law>| {
                    law.map_or_else(|| self.finer(&settings, s, finer), |law| law.bias(h).into())
                };
                Candidate {
                    scheme: kind.with(h),
                    cost: super::Cost {
                        first: setting.cost.first * finer,
                        each: setting.cost.each * finer,
                    },
                    is_measured: false,
                    terms: terms(setting, &bound),
                }
            }));
        }
        candidates
    }

    /// An upper bound of the bias of a measured setting. It comes from the distance to the
    /// reference, or from the law if that is more precise. For a scheme with a tolerance it is the
    /// tolerance, unless the distance shows a larger bias.
    fn bound(&self, setting: &TradeSetting, statistic: Statistic, law: Option<&Law>) -> BiasBound {
        let measured = self.bias(setting, statistic);
        match (setting.scheme.discretisation(), setting.scheme.step(), law) {
            (Discretisation::Tolerance { tolerance }, ..) => {
                let relative = if self.is_random { tolerance } else { 0.0 };
                let allowed = relative * self.standing(statistic).scale().unwrap_or(f64::NAN);
                let is_exceeded = measured.value.abs() - BIAS_ERRORS * measured.error > allowed;
                match (self.is_reference(setting), is_exceeded) {
                    (true, _) => BiasBound {
                        value: allowed,
                        is_unresolved: false,
                    },
                    (false, true) => measured.into(),
                    (false, false) => BiasBound {
                        value: allowed.min(measured.bound()),
                        is_unresolved: false,
                    },
                }
            }
            (_, Some(h), Some(law)) if h <= law.coarsest && law.bias(h).error < measured.error => {
                law.bias(h).into()
            }
            (_, Some(_), None) => {
                BiasBound::from(measured).or(self.changes_from(setting, statistic))
            }
            _ => measured.into(),
        }
    }

    /// A bound of the bias of a step without a law: the sum of the changes from it to the finest
    /// step, and a bound of what is left beyond that. The latter assumes that the bias falls at
    /// least as fast as sqrt(h), the slowest rate of these schemes.
    fn changes_from(&self, setting: &TradeSetting, statistic: Statistic) -> BiasBound {
        let kind = setting.scheme.kind();
        let finer: Vec<Number> = (self.rungs_of(kind))
            .filter(|other| other.scheme.step() <= setting.scheme.step())
            .filter_map(|setting| setting.change(statistic))
            .collect();
        let sum = Number {
            value: finer.iter().map(|change| change.value).sum(),
            error: finer.iter().map(|change| change.error).sum(),
        };
        let last = self.last_change(kind, statistic);
        BiasBound {
            value: sum.bound() + last * tail(2.0),
            is_unresolved: sum.value.abs() < 2.0 * sum.error,
        }
    }

    /// The same at the finest step divided by `finer`.
    fn finer(&self, settings: &[&TradeSetting], statistic: Statistic, finer: f64) -> BiasBound {
        let Some(finest) = settings.last() else {
            return BiasBound {
                value: f64::NAN,
                is_unresolved: true,
            };
        };
        let beyond = self.last_change(finest.scheme.kind(), statistic) * tail(2.0 * finer);
        self.bound(finest, statistic, None).or(BiasBound {
            value: beyond,
            is_unresolved: true,
        })
    }

    /// A bound of the change between the two finest steps.
    fn last_change(&self, kind: Kind, statistic: Statistic) -> f64 {
        let mut changes = self
            .rungs_of(kind)
            .filter_map(|setting| setting.change(statistic));
        changes.next_back().map_or(f64::NAN, Number::bound)
    }
}

/// A run without a step counts as biased if it differs from the reference by more than its
/// tolerance and this many standard errors. Over 21 statistics and 3 settings this happens by chance
/// once in 600 scenarios.
const BIAS_ERRORS: f64 = 4.0;

impl Refusal {
    /// Of two reasons, the one with the smaller bias.
    fn or(self, other: Refusal) -> Refusal {
        match (self, other) {
            (Refusal::Bias { least: mine, .. }, Refusal::Bias { least: theirs, .. })
                if mine <= theirs =>
            {
                self
            }
            (Refusal::Bias { .. }, Refusal::NotRun | Refusal::NoAnswer(_)) => self,
            _ => other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Cost, Standing};
    use super::*;
    use crate::scheme::{DiscreteVi, EventDriven};

    /// The change from h to h/2 is C (sqrt(h) - sqrt(h/2)). The changes at h/r, h/2r, h/4r, ... are
    /// added one by one, up to the 200th.
    #[test]
    fn the_tail_is_the_sum_of_all_finer_changes() {
        for r in [1.0, 2.0, 4.0, 7.0, 2f64.powi(20)] {
            let change = |h: f64| h.sqrt() - (h / 2.0).sqrt();
            let sum: f64 = (0..200).map(|k| change(1.0 / (r * 2f64.powi(k)))).sum();
            assert!(
                (tail(r) * change(1.0) / sum - 1.0).abs() < 1e-12,
                "{r}: {} {}",
                tail(r),
                sum / change(1.0)
            );
        }
    }

    /// The changes 0.05, -0.02 and 0.01 follow no power, so there is no law, and the reference is
    /// known only to 0.1. The bias of a step is then bounded by the sum of the changes from it on,
    /// 0.04, -0.01 and 0.01, and, beyond the finest step, by 1/(sqrt 2 - 1) = 2.4142 times the last
    /// change, which is the rest if the bias falls like sqrt(h). Costs double from step to step and
    /// paths do not scatter, so the cheapest step is the coarsest one whose bound is below the
    /// target. At half the finest step the rest is 0.01 sqrt(1/4)/(1 - sqrt(1/2)).
    #[test]
    fn without_a_law_the_changes_and_their_tail_bound_the_bias() {
        let setting = |scheme: Scheme, seconds, error: f64, change: Option<f64>| TradeSetting {
            scheme,
            paths: 100,
            diverged: 0,
            cost: Cost {
                first: 0.0,
                each: seconds,
            },
            estimates: vec![Number { value: 1.0, error }; Statistic::ALL.len()],
            changes: change.map_or(Vec::new(), |value| {
                vec![Number { value, error: 0.0 }; Statistic::ALL.len()]
            }),
        };
        let settings = vec![
            setting(DiscreteVi { step: 0.4 }.into(), 1.0, 1e-9, Some(0.05)),
            setting(DiscreteVi { step: 0.2 }.into(), 2.0, 1e-9, Some(-0.02)),
            setting(DiscreteVi { step: 0.1 }.into(), 4.0, 1e-9, Some(0.01)),
            setting(DiscreteVi { step: 0.05 }.into(), 8.0, 1e-9, None),
            setting(EventDriven { tolerance: 1e-5 }.into(), 1000.0, 0.1, None),
        ];
        let (left_out, pairing) = (Vec::new(), Pairing::Unknown);
        let trade = Trade {
            reference: 4,
            settings,
            left_out,
            pairing,
            is_random: true,
            has_limitless_phases: false,
        };
        let statistic = Statistic::SticksPerPath;
        assert_eq!(
            (
                trade.law(Kind::DiscreteVi, statistic),
                trade.standing(statistic)
            ),
            (None, Standing::Value(1.0))
        );
        let left = 0.01 / (2f64.sqrt() - 1.0);
        for (setting, bound) in
            trade
                .settings
                .iter()
                .zip([0.04 + left, 0.01 + left, 0.01 + left, left])
        {
            let reported = trade.changes_from(setting, statistic).value;
            assert!(
                (reported - bound).abs() < 1e-12,
                "{}: {reported}, not {bound}",
                setting.scheme
            );
        }
        let best = |target: f64| {
            trade
                .best(Some(Kind::DiscreteVi), &[statistic], target)
                .expect("a choice")
        };
        for (target, step, is_measured, bias) in [
            (0.07, 0.4, true, 0.04 + left),
            (0.035, 0.2, true, 0.01 + left),
            (0.03, 0.05, true, left),
            (0.02, 0.025, false, 0.005 / (1.0 - 0.5f64.sqrt())),
        ] {
            let choice = best(target);
            assert_eq!(
                (choice.scheme, choice.is_measured),
                (DiscreteVi { step }.into(), is_measured),
                "{target}"
            );
            assert!(
                (choice.bias - bias).abs() < 1e-12,
                "{target}: {choice:?}, not {bias}"
            );
        }
    }
}
