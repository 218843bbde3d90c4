//! `mc run --accuracy`: from an error that is good enough to the scheme, its step or tolerance, and the number of paths.

use super::ending::MOST_PATHS;
use super::failure::{Failure, note};
use super::numbers::{grouped, percent, significant, time, wrapped};
use super::{report, trade as trade_verb};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use stick_slip::scenario::Scenario;
use stick_slip::stats::Statistic;
use stick_slip::trade::{Choice, Standing, Trade, TradeError};

/// The keys of a scenario that are chosen.
pub const CHOSEN: [&str; 4] = ["ensemble.paths", "scheme.kind", "scheme.tolerance", "time.step"];

/// How long the pilot may take.
const PILOT: Duration = Duration::from_secs(8);

/// The longest run that is begun without a time limit.
const LONGEST: Duration = Duration::from_secs(30 * 86_400);

/// Fewest paths of a run with noise: with fewer its own interval says nothing, and the pilot's variance little about its error.
const FEWEST_PATHS: u64 = 32;

/// Errors to ask for instead, where one is out of reach.
const ALTERNATIVES: [f64; 18] =
    [0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6];

/// What is asked for.
pub struct Wish<'a> {
    /// The relative root mean square error.
    pub target: f64,
    /// Of these statistics; of all that a run can answer, if there is none.
    pub named: &'a [Statistic],
    /// How long the run may take.
    pub max_time: Option<Duration>,
    /// Threads of the pilot and of the run.
    pub threads: usize,
    /// Whether to say nothing but errors.
    pub is_quiet: bool,
}

/// What a run was chosen for.
#[derive(Clone, Copy, Debug)]
pub struct Promise {
    target: f64,
    choice: Choice,
}

impl Promise {
    /// What is left of it if only so many paths are done, where that is not enough.
    ///
    /// The square of the error is bias^2 + variance/N, and `target`^2 at the paths of the choice.
    pub fn missed(&self, completed: u64) -> Option<String> {
        let Promise { target, choice: Choice { paths, bias, decisive, .. } } = *self;
        let spread = (target * target - bias * bias) * paths as f64 / completed as f64;
        (completed < paths).then(|| {
            format!(
                "the relative error of {} is not reached: {} of {} paths make about {} of {}",
                percent(target),
                grouped(completed),
                grouped(paths),
                percent(spread.sqrt().hypot(bias)),
                decisive.name()
            )
        })
    }
}

impl Wish<'_> {
    /// The scenario run the cheapest way that makes the relative root mean square error of each statistic `target`. Says what it chose
    /// and why. When `stop` is raised, nothing is chosen.
    pub fn choose(&self, scenario: &Scenario, stop: &AtomicBool) -> Result<(Scenario, Promise), Failure> {
        self.say(&format!("choosing how to run it: measuring for about {} s", PILOT.as_secs()));
        let trade = trade_verb::measured(scenario, PILOT, self.threads, stop, self.is_quiet).map_err(no_pilot)?;
        if stop.load(Ordering::Relaxed) {
            note("interrupted while choosing how to run it: nothing was run, nothing is written");
            return Err(Failure::Interrupted);
        }
        let asked = self.answerable(&trade)?;
        let choice = trade.best(None, &asked, self.target).map_err(|refusal| {
            let problem = format!("--accuracy: {} cannot be promised: {refusal}", percent(self.target));
            Failure::usage(problem, self.instead(&trade, &asked))
        })?;
        if !self.is_in_time(&choice) {
            let limit = match self.max_time {
                Some(limit) => format!("--max-time allows {}", time(limit.as_secs_f64())),
                None => format!("no run of more than {} is begun without --max-time", time(LONGEST.as_secs_f64())),
            };
            let problem = format!(
                "--accuracy: {} of {} takes about {} on {} threads, for {} --paths {}; {limit}",
                percent(self.target),
                choice.decisive.name(),
                time(self.seconds(&choice)),
                self.threads,
                choice.setting,
                choice.paths
            );
            return Err(Failure::usage(problem, self.instead(&trade, &asked)));
        }
        let fewest = if trade.is_random { FEWEST_PATHS } else { 1 };
        let choice = Choice { paths: choice.paths.max(fewest), ..choice };
        self.explain(scenario, &trade, &asked, &choice);
        let mut chosen = choice.setting.of(scenario)?;
        chosen.ensemble.paths = choice.paths;
        Ok((chosen, Promise { target: self.target, choice }))
    }

    /// The statistics that are asked for, each of which must have an answer.
    fn answerable(&self, trade: &Trade) -> Result<Vec<Statistic>, Failure> {
        if let Some(&statistic) = self.named.iter().find(|statistic| trade.standing(**statistic).scale().is_none()) {
            let remedy = match trade.standing(statistic) {
                Standing::Absent => "name another one with --statistic, or make `time.end` later",
                _ => "name another one with --statistic",
            };
            return Err(Failure::usage(format!("--accuracy: {}", why_not(trade, statistic)), remedy));
        }
        let asked = if self.named.is_empty() { trade.answerable() } else { self.named.to_vec() };
        if asked.is_empty() {
            let problem = "--accuracy: no statistic of this scene has an error to choose for: each is zero, absent or without a limit";
            return Err(Failure::usage(problem, "leave out --accuracy; mc trade says more"));
        }
        Ok(asked)
    }

    /// What was chosen, and why.
    fn explain(&self, scenario: &Scenario, trade: &Trade, asked: &[Statistic], choice: &Choice) {
        let of = match self.named {
            [] => format!("{} statistics", asked.len()),
            named => named.iter().map(|statistic| statistic.name()).collect::<Vec<_>>().join(" and "),
        };
        self.say(&format!("chosen for a relative error of {} of {of}:", percent(self.target)));
        self.say(&format!("  {} --paths {}", choice.setting, choice.paths));
        let (decisive, cost, bias) = (choice.decisive.name(), time(choice.seconds), percent(choice.bias));
        let paths = match choice.paths {
            1 => "nothing is random, so one path is the ensemble".into(),
            FEWEST_PATHS => format!("{FEWEST_PATHS} paths are the fewest whose intervals say something"),
            _ => format!("{decisive} asks for most paths"),
        };
        let mut why = format!(
            "the cheapest that was found, about {cost} of CPU; {paths}; the bias of {decisive} is at most {bias}"
        );
        if !choice.is_measured {
            why += ", by the law of the coarser steps: this step itself was not measured";
        }
        self.say(&why);
        for &statistic in asked {
            if let Standing::Deviation(deviation) = trade.standing(statistic) {
                let unit = report::unit(statistic.dimension(), &scenario.units);
                self.say(&format!(
                    "{} is zero within its error in the pilot, and a share of zero is no goal: {} is taken of its standard deviation \
                     per path, an error of {} {unit}",
                    statistic.name(),
                    percent(self.target),
                    significant(self.target * deviation, 2),
                ));
            }
        }
        if self.named.is_empty() {
            for standing in [Standing::Zero, Standing::NoLimit, Standing::Absent] {
                let left: Vec<_> = Statistic::ALL.into_iter().filter(|s| trade.standing(*s) == standing).collect();
                let names: Vec<_> = left.iter().map(|statistic| statistic.name()).collect();
                if !names.is_empty() {
                    self.say(&format!("nothing is promised of {}: {standing}", names.join(", ")));
                }
            }
        }
    }

    fn say(&self, sentence: &str) {
        if !self.is_quiet {
            note(wrapped(sentence, "  ").trim_end());
        }
    }

    /// Wall-clock seconds of a choice.
    fn seconds(&self, choice: &Choice) -> f64 {
        choice.seconds / self.threads.min(super::cores()) as f64
    }

    fn is_in_time(&self, choice: &Choice) -> bool {
        self.seconds(choice) <= self.max_time.unwrap_or(LONGEST).as_secs_f64() && choice.paths <= MOST_PATHS
    }

    /// What could be asked for instead.
    fn instead(&self, trade: &Trade, asked: &[Statistic]) -> String {
        let reached = |target: &f64| trade.best(None, asked, *target).ok().filter(|choice| self.is_in_time(choice));
        let within = ALTERNATIVES.into_iter().map_while(|target| Some((target, reached(&target)?)));
        match within.last() {
            Some((target, choice)) => {
                let seconds = time(self.seconds(&choice));
                format!(
                    "--accuracy {} is in reach, in about {seconds}; mc trade says more",
                    percent(target).replace(' ', "")
                )
            }
            None => "give more time, or name fewer statistics with --statistic; mc trade says more".into(),
        }
    }
}

/// Why nothing can be promised of a statistic.
fn why_not(trade: &Trade, statistic: Statistic) -> String {
    let name = statistic.name();
    match trade.standing(statistic) {
        Standing::Zero => {
            format!("{name} is exactly zero in the pilot, without scatter: there is no share of zero to ask for")
        }
        standing => format!("{name}: {standing}"),
    }
}

/// Where the pilot could not be made.
fn no_pilot(error: TradeError) -> Failure {
    match error {
        TradeError::BudgetTooSmall { .. } => {
            let remedy = "choose --scheme and --paths yourself; mc trade --budget measures longer";
            Failure::Run(format!("--accuracy: {error}, about {} s\n  fix: {remedy}", PILOT.as_secs()))
        }
        error => Failure::from(error),
    }
}

/// A target as it is typed: 1e-2 or 1%.
pub fn target(text: &str) -> Result<f64, String> {
    let (number, unit) = text.trim().strip_suffix('%').map_or((text.trim(), 1.0), |percent| (percent.trim(), 0.01));
    let target = number.parse::<f64>().map(|number| number * unit).unwrap_or(f64::NAN);
    if (1e-6..=0.5).contains(&target) {
        Ok(target)
    } else {
        Err("write a relative error from 1e-6 to 0.5, e.g. 1e-2 or 1%".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_is_a_share_or_a_percentage() {
        assert_eq!((target("1e-2"), target("0.5%"), target(" 10 % ")), (Ok(0.01), Ok(0.005), Ok(0.1)));
        for text in ["", "0", "-1%", "60%", "1e-7", "nan", "one"] {
            assert!(target(text).is_err(), "{text}");
        }
    }
}
