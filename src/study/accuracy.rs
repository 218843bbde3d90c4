//! Choosing the scheme, its step or tolerance, and the number of paths for a given error.
//!
//! A pilot of a few seconds measures the [`Trade`] of the scenario. The choice is the cheapest of
//! its settings for which the relative root mean square error is at most the target in every
//! requested statistic.

use super::trade::{Choice, Limits, Refusal, Standing, Trade, TradeError, measure_within};
use crate::engine::MOST_PATHS;
use crate::scenario::Scenario;
use crate::scheme::CheckError;
use crate::stats::Statistic;
use std::fmt;
use std::str::FromStr;
use std::time::Duration;

/// CPU time of the pilot on each thread.
pub const PILOT: Duration = Duration::from_secs(8);

/// The longest run that is chosen if the caller sets no time limit.
pub const LONGEST: Duration = Duration::from_secs(30 * 86_400);

/// Fewest paths of a run with noise. With fewer, the confidence interval of the run is not
/// reliable, and the variance measured by the pilot predicts its error badly.
pub const FEWEST_PATHS: u64 = 32;

/// The range of targets that are accepted.
pub const TARGETS: std::ops::RangeInclusive<f64> = 1e-6..=0.5;

/// Targets that a message may propose instead of an unreachable one.
const ALTERNATIVES: [f64; 18] = [
    0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6,
    2e-6, 1e-6,
];

/// The requested accuracy.
///
/// ```no_run
/// use stickslip::engine::Run;
/// use stickslip::scenario::Scenario;
/// use stickslip::stats::Statistic;
/// use stickslip::study::{accuracy::Accuracy, trade::Limits};
///
/// let scenario = Scenario::shipped("rho025")?;
/// let wanted = Accuracy { target: 0.01, named: &[Statistic::StickDurationMean], max_time: None, threads: 2 };
/// let (decision, _) = wanted.choose(&scenario, Limits::default())?; // measures for some seconds
/// println!("{} and {} paths", decision.choice.scheme, decision.choice.paths);
/// let outcome = Run::of(&decision.scenario).simulate()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Accuracy<'a> {
    /// The largest relative root mean square error, within [`TARGETS`].
    pub target: f64,
    /// The statistics that must reach it. An empty list means all for which the scenario has an
    /// answer.
    pub named: &'a [Statistic],
    /// Wall-clock time that the run may take; `None` means [`LONGEST`].
    pub max_time: Option<Duration>,
    /// Number of threads of the pilot and of the run.
    pub threads: usize,
}

/// How to run a scenario for a target.
#[derive(Clone, Debug)]
pub struct Decision {
    /// The scenario with the chosen scheme and number of paths, as antithetic pairs if these were
    /// chosen.
    pub scenario: Scenario,
    /// The target.
    pub target: f64,
    /// The statistics that reach it.
    pub asked: Vec<Statistic>,
    /// The chosen run and its predicted cost.
    pub choice: Choice,
}

/// Another target that can be reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alternative {
    /// The target.
    pub target: f64,
    /// Wall-clock seconds that a run for it takes.
    pub seconds: f64,
}

/// Why nothing could be chosen.
#[derive(Debug, thiserror::Error)]
pub enum AccuracyError {
    /// The pilot could not be run.
    #[error(transparent)]
    Pilot(#[from] TradeError),
    /// The chosen scheme is inconsistent with the other values of the scenario.
    #[error(transparent)]
    CheckError(#[from] CheckError),
    /// A named statistic has no relative error in this scenario.
    #[error("{}: {standing}", statistic.name())]
    NoAnswer {
        /// The statistic.
        statistic: Statistic,
        /// The reason.
        standing: Standing,
    },
    /// A named statistic needs levels, and the scenario has none.
    #[error("{}: it needs `statistics.levels` in the scenario", statistic.name())]
    Unasked {
        /// The statistic.
        statistic: Statistic,
    },
    /// No statistic of this scenario has a relative error.
    #[error(
        "no statistic of this scenario can determine the run: each is zero, absent or without a limit"
    )]
    NothingToChoose,
    /// No setting has a bias that is small enough.
    #[error("it cannot be guaranteed: {refusal}")]
    OutOfReach {
        /// The reason.
        refusal: Refusal,
        /// The smallest target that can be reached, if there is one.
        instead: Option<Alternative>,
    },
    /// The cheapest run takes longer than allowed.
    #[error(
        "it takes about {seconds:.0} s, for {} and {} paths, longer than the time limit (30 days by default)",
        choice.scheme, choice.paths
    )]
    TooLong {
        /// The cheapest run.
        choice: Choice,
        /// Wall-clock seconds that it takes.
        seconds: f64,
        /// The smallest target that can be reached in time, if there is one.
        instead: Option<Alternative>,
    },
}

impl Accuracy<'_> {
    /// Measure a pilot, and choose from it. Returns the choice and what the pilot measured. A
    /// statistic that a run measures only on request is requested if it is named. Fails if the
    /// pilot cannot be run, or if no setting reaches the target in time.
    pub fn choose(
        &self,
        scenario: &Scenario,
        limits: Limits<'_>,
    ) -> Result<(Decision, Trade), AccuracyError> {
        let mut scenario = scenario.clone();
        for &statistic in self.named {
            let unasked = AccuracyError::Unasked { statistic };
            scenario.record = scenario.record.asking_for(statistic).ok_or(unasked)?;
        }
        let trade = measure_within(&scenario, PILOT, self.threads, limits)?;
        Ok((self.decide(&scenario, &trade)?, trade))
    }

    /// Choose from the measurements of a pilot.
    pub fn decide(&self, scenario: &Scenario, trade: &Trade) -> Result<Decision, AccuracyError> {
        let asked = self.answerable(trade)?;
        let instead = || self.alternative(trade, &asked);
        let choice =
            trade
                .best(None, &asked, self.target)
                .map_err(|refusal| AccuracyError::OutOfReach {
                    refusal,
                    instead: instead(),
                })?;
        if !self.is_in_time(&choice) {
            let seconds = self.seconds(&choice);
            return Err(AccuracyError::TooLong {
                choice,
                seconds,
                instead: instead(),
            });
        }
        let fewest = if trade.is_random { FEWEST_PATHS } else { 1 };
        let choice = Choice {
            paths: choice.paths.max(fewest),
            ..choice
        };
        let mut scenario = scenario.with_scheme(choice.scheme)?;
        (scenario.ensemble.paths, scenario.ensemble.antithetic) =
            (choice.paths, choice.is_antithetic);
        Ok(Decision {
            scenario,
            target: self.target,
            asked,
            choice,
        })
    }

    /// The requested statistics; an error if a named one has no relative error.
    fn answerable(&self, trade: &Trade) -> Result<Vec<Statistic>, AccuracyError> {
        if let Some(&statistic) = self
            .named
            .iter()
            .find(|statistic| trade.standing(**statistic).scale().is_none())
        {
            return Err(AccuracyError::NoAnswer {
                statistic,
                standing: trade.standing(statistic),
            });
        }
        let asked = if self.named.is_empty() {
            trade.answerable()
        } else {
            self.named.to_vec()
        };
        if asked.is_empty() {
            Err(AccuracyError::NothingToChoose)
        } else {
            Ok(asked)
        }
    }

    /// Wall-clock seconds of a run on the threads that are available.
    fn seconds(&self, choice: &Choice) -> f64 {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        choice.seconds / self.threads.min(cores) as f64
    }

    fn is_in_time(&self, choice: &Choice) -> bool {
        self.seconds(choice) <= self.max_time.unwrap_or(LONGEST).as_secs_f64()
            && choice.paths <= MOST_PATHS
    }

    /// The smallest of the [`ALTERNATIVES`] that can be reached in time.
    fn alternative(&self, trade: &Trade, asked: &[Statistic]) -> Option<Alternative> {
        let reached = |target: &f64| {
            trade
                .best(None, asked, *target)
                .ok()
                .filter(|choice| self.is_in_time(choice))
        };
        let within = ALTERNATIVES
            .into_iter()
            .map_while(|target| Some((target, reached(&target)?)));
        within.last().map(|(target, choice)| Alternative {
            target,
            seconds: self.seconds(&choice),
        })
    }
}

impl Decision {
    /// The target with the number of paths that it takes, to be stored with the run.
    pub fn accuracy_goal(&self) -> AccuracyGoal {
        let Choice {
            paths,
            bias,
            decisive,
            ..
        } = self.choice;
        AccuracyGoal {
            target: self.target,
            paths,
            bias,
            decisive,
        }
    }
}

/// The error that a chosen run has once all its paths are done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccuracyGoal {
    /// The relative root mean square error.
    pub target: f64,
    /// The number of paths of the choice.
    pub paths: u64,
    /// The relative bias, which does not fall with the number of paths.
    pub bias: f64,
    /// The statistic that needs the most paths.
    pub decisive: Statistic,
}

impl AccuracyGoal {
    /// The relative error of a run that stopped after `completed` paths; `None` if these are all
    /// paths of the choice.
    ///
    /// The square of the error is bias^2 + variance/N, and equals `target`^2 for the number of
    /// paths of the choice.
    pub fn error_after(&self, completed: u64) -> Option<f64> {
        let AccuracyGoal {
            target,
            paths,
            bias,
            ..
        } = *self;
        let spread = (target * target - bias * bias) * paths as f64 / completed as f64;
        (completed < paths).then(|| spread.sqrt().hypot(bias))
    }
}

/// Writes the line that is kept with a run; `from_str` reads it.
impl fmt::Display for AccuracyGoal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let AccuracyGoal {
            target,
            paths,
            bias,
            decisive,
        } = self;
        write!(f, "{target:?} {paths} {bias:?} {}", decisive.name())
    }
}

impl FromStr for AccuracyGoal {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let words: Vec<&str> = text.split(' ').collect();
        let [target, paths, bias, decisive] = words.as_slice() else {
            return Err(());
        };
        Ok(AccuracyGoal {
            target: target.parse().map_err(|_| ())?,
            paths: paths.parse().map_err(|_| ())?,
            bias: bias.parse().map_err(|_| ())?,
            decisive: Statistic::from_name(decisive).ok_or(())?,
        })
    }
}

#[cfg(test)]
#[path = "tests/reference.rs"]
mod reference;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::trade::{Cost, Pairing, PlannedCost, SettingGrid, measure};
    use std::sync::LazyLock;

    /// A pilot of about a second. The costs are replaced by fixed ones, so that no choice depends
    /// on the machine: 1.2 ns for a step, 30 us for an event-driven path.
    fn pilot(name: &str, steps: usize, free_paths: &[u64]) -> (Scenario, Trade) {
        let scenario = Scenario::shipped(name).expect("a shipped scenario");
        let planned = PlannedCost {
            steps,
            coupled_paths: 640,
            free_paths: free_paths.to_vec(),
            timing: 0.0,
        };
        let mut trade = measure(
            &scenario,
            &SettingGrid::of(&scenario),
            &planned,
            2,
            Limits::default(),
        )
        .expect("measured");
        for setting in &mut trade.settings {
            let seconds = setting.scheme.step().map_or(30e-6, |h| 1.2e-9 * 60.0 / h);
            setting.cost = Cost {
                first: seconds,
                each: seconds,
            };
        }
        (scenario, trade)
    }

    static RHO025: LazyLock<(Scenario, Trade)> =
        LazyLock::new(|| pilot("rho025", 5, &[1024, 1024, 1024, 16_384]));

    const MEAN: Statistic = Statistic::StickDurationMean;

    fn wanted(target: f64, named: &[Statistic]) -> Accuracy<'_> {
        Accuracy {
            target,
            named,
            max_time: None,
            threads: 1,
        }
    }

    /// Null: over 400 runs of the choice for 2 %, the relative root mean square error is 2 %, or
    /// less by as much as the true bias is below the bound that was used. The truth is the value of
    /// another program (tests/reference/noisy.c, known to 4e-4). From 400 runs the error is known
    /// to 3.5 % of itself. The test allows four times that, and 3 % for the pilot's own error of
    /// the variance, which gives a false-alarm rate below 1e-4. Half or twice the number of paths
    /// would change the error by a factor of 1.41.
    #[test]
    fn many_runs_of_what_is_chosen_have_the_error_asked_for() {
        let (scenario, trade) = &*RHO025;
        let decision = wanted(0.02, &[MEAN])
            .decide(scenario, trade)
            .expect("a choice");
        let (mut chosen, choice) = (decision.scenario, decision.choice);
        chosen.time.output_step = chosen.time.end;
        chosen.record.paths = false;
        let (truth, _) = reference::limit(MEAN.name());
        let square = |seed: u64| {
            chosen.ensemble.seed = 5000 + seed;
            let summary = chosen.plan().run(2);
            (summary.estimate(MEAN).estimate / truth - 1.0).powi(2)
        };
        let ratio = ((0..400).map(square).sum::<f64>() / 400.0).sqrt() / 0.02;
        let (play, least) = (
            4.0 / 800f64.sqrt() + 0.03,
            (1.0 - (choice.bias / 0.02).powi(2)).sqrt(),
        );
        println!(
            "{} x{}: {ratio}, least {least}",
            choice.scheme, choice.paths
        );
        assert!(
            (least * (1.0 - play)..1.0 + play).contains(&ratio),
            "{ratio} {choice:?}"
        );
    }

    /// The same for the mean displacement at the end and a target of 0.5 %, for which antithetic
    /// pairs need about a seventh of the paths. The reference value is that of 2^18 event-driven
    /// paths of another seed in pairs, known to 3e-4 of itself.
    #[test]
    fn many_runs_of_chosen_pairs_have_the_error_asked_for() {
        let (scenario, trade) = &*RHO025;
        let asked = [Statistic::DisplacementEndMean];
        let decision = wanted(0.005, &asked)
            .decide(scenario, trade)
            .expect("a choice");
        let (mut chosen, choice) = (decision.scenario, decision.choice);
        assert!(
            choice.is_antithetic && chosen.ensemble.antithetic,
            "{choice:?}"
        );
        let alone = Trade {
            pairing: Pairing::Unknown,
            ..trade.clone()
        };
        let independent = wanted(0.005, &asked)
            .decide(scenario, &alone)
            .expect("a choice")
            .choice
            .paths;
        let gain = independent as f64 / choice.paths as f64;
        assert!(
            (5.0..9.0).contains(&gain),
            "{independent} paths alone, {} in pairs",
            choice.paths
        );
        chosen.time.output_step = chosen.time.end;
        chosen.record.paths = false;
        let mut pooled = chosen.clone();
        (pooled.ensemble.seed, pooled.ensemble.paths) = (77, 1 << 18);
        let truth = pooled.plan().run(2).estimate(asked[0]).estimate;
        let square = |seed: u64| {
            chosen.ensemble.seed = 5000 + seed;
            let summary = chosen.plan().run(2);
            (summary.estimate(asked[0]).estimate / truth - 1.0).powi(2)
        };
        let ratio = ((0..400).map(square).sum::<f64>() / 400.0).sqrt() / 0.005;
        // The pilot knows the variance from 2048 paths in pairs to 3 %, and so the error to 1.6 %.
        let (play, least) = (
            4.0 / 800f64.sqrt() + 0.05,
            (1.0 - (choice.bias / 0.005).powi(2)).sqrt(),
        );
        println!(
            "{} x{}: {ratio}, least {least}",
            choice.scheme, choice.paths
        );
        assert!(
            (least * (1.0 - play)..1.0 + play).contains(&ratio),
            "{ratio} {choice:?}"
        );
    }

    /// The alternative that is proposed is accepted when it is asked for, and a target 2.6 times
    /// smaller is rejected.
    #[test]
    fn a_target_that_takes_too_long_is_refused() {
        let limits = [
            (1e-6, None),
            (1e-3, Some(Duration::from_secs(1))),
            (0.01, Some(Duration::from_millis(10))),
        ];
        for (target, max_time) in limits {
            let asked = |target| Accuracy {
                max_time,
                ..wanted(target, &[MEAN])
            };
            let Err(AccuracyError::TooLong {
                choice, instead, ..
            }) = asked(target).decide(&RHO025.0, &RHO025.1)
            else {
                panic!("{target} is out of reach");
            };
            assert_eq!(choice.decisive, MEAN);
            let reached = instead.expect("something is in reach").target;
            assert!(
                asked(reached).decide(&RHO025.0, &RHO025.1).is_ok(),
                "{reached}"
            );
            assert!(
                asked(reached / 2.6).decide(&RHO025.0, &RHO025.1).is_err(),
                "{reached}: a finer one is in reach"
            );
        }
        let never = Accuracy {
            max_time: Some(Duration::from_nanos(1)),
            ..wanted(0.01, &[MEAN])
        };
        let refused = never.decide(&RHO025.0, &RHO025.1);
        assert!(
            matches!(refused, Err(AccuracyError::TooLong { instead: None, .. })),
            "{refused:?}"
        );
    }

    /// The variance of a mean is inversely proportional to the number of paths. Without bias, a
    /// quarter of the paths gives twice the error.
    #[test]
    fn fewer_paths_leave_the_error_of_their_number() {
        let (scenario, trade) = &*RHO025;
        let mut decision = wanted(0.02, &[MEAN])
            .decide(scenario, trade)
            .expect("a choice");
        (decision.choice.bias, decision.choice.paths) = (0.0, 1024);
        assert_eq!(
            (
                decision.accuracy_goal().error_after(1024),
                decision.accuracy_goal().error_after(256)
            ),
            (None, Some(0.04))
        );
        assert_eq!(decision.accuracy_goal().error_after(0), Some(f64::INFINITY));
    }

    #[test]
    fn statistics_without_a_share_are_refused_when_named() {
        let refused =
            |named: &[Statistic], (scenario, trade): &(Scenario, Trade)| match wanted(0.1, named)
                .decide(scenario, trade)
            {
                Err(AccuracyError::NoAnswer { standing, .. }) => standing,
                other => panic!("{other:?}"),
            };
        let equal = pilot("equal-friction", 2, &[64, 64, 64]);
        assert_eq!(
            refused(&[Statistic::SticksPerPath], &equal),
            Standing::NoLimit
        );
        let decision = wanted(0.1, &[])
            .decide(&equal.0, &equal.1)
            .expect("others have one");
        assert!(!matches!(
            decision.choice.decisive,
            Statistic::SticksPerPath | Statistic::StickDurationMean
        ));
        let never = pilot("never-slips", 2, &[64, 64, 64, 64]);
        assert_eq!(refused(&[Statistic::SticksPerPath], &never), Standing::Zero);
        assert_eq!(refused(&[MEAN], &never), Standing::Absent);
        // All paths are equal there, so the smallest number of paths is chosen.
        let decision = wanted(0.1, &[Statistic::StickingFraction])
            .decide(&never.0, &never.1)
            .expect("it has a value");
        assert_eq!(decision.scenario.ensemble.paths, FEWEST_PATHS);
    }
}
