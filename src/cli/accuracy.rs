//! `mc run --accuracy`: from an error that is good enough to the scheme, its step or tolerance, and the number of paths.

use super::failure::{Failure, note};
use super::numbers::{grouped, percent, significant, time, wrapped};
use super::trade as trade_verb;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use stick_slip::engine::MOST_PATHS;
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
        self.decide(scenario, &trade)
    }

    /// The same from a pilot.
    fn decide(&self, scenario: &Scenario, trade: &Trade) -> Result<(Scenario, Promise), Failure> {
        let asked = self.answerable(trade)?;
        let choice = trade.best(None, &asked, self.target).map_err(|refusal| {
            let problem = format!("--accuracy: {} cannot be promised: {refusal}", percent(self.target));
            Failure::usage(problem, self.instead(trade, &asked))
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
                choice.scheme,
                choice.paths
            );
            return Err(Failure::usage(problem, self.instead(trade, &asked)));
        }
        let fewest = if trade.is_random { FEWEST_PATHS } else { 1 };
        let choice = Choice { paths: choice.paths.max(fewest), ..choice };
        self.explain(scenario, trade, &asked, &choice);
        let mut chosen = scenario.with_scheme(choice.scheme)?;
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
        self.say(&format!("  {} --paths {}", choice.scheme, choice.paths));
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
                let unit = statistic.dimension().label(&scenario.units);
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
    use std::path::Path;
    use std::sync::LazyLock;
    use stick_slip::trade::{Cost, Effort, Ladder, Limits, measure};

    fn shipped(name: &str) -> Scenario {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").join(name).with_extension("toml");
        Scenario::read(&path, &[]).expect("a shipped scenario")
    }

    /// A second of a pilot. The costs are fixed, so that no choice depends on the machine: 1.2 ns a step, 30 us an event-driven path.
    fn pilot(name: &str, steps: usize, free_paths: &[u64]) -> (Scenario, Trade) {
        let scenario = shipped(name);
        let effort = Effort { steps, coupled_paths: 640, free_paths: free_paths.to_vec(), timing: 0.0 };
        let mut trade = measure(&scenario, &Ladder::of(&scenario), &effort, 2, Limits::default()).expect("measured");
        for rung in &mut trade.rungs {
            let seconds = rung.scheme.step().map_or(30e-6, |h| 1.2e-9 * 60.0 / h);
            rung.cost = Cost { first: seconds, each: seconds };
        }
        (scenario, trade)
    }

    static RHO025: LazyLock<(Scenario, Trade)> = LazyLock::new(|| pilot("rho025", 5, &[1024, 1024, 1024, 16_384]));

    const MEAN: Statistic = Statistic::StickDurationMean;

    fn wish(target: f64, named: &[Statistic]) -> Wish<'_> {
        Wish { target, named, max_time: None, threads: 1, is_quiet: true }
    }

    #[track_caller]
    fn refusal(wish: &Wish<'_>, (scenario, trade): &(Scenario, Trade)) -> (String, String) {
        match wish.decide(scenario, trade) {
            Err(Failure::Usage { problem, remedy }) => (problem, remedy),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_target_is_a_share_or_a_percentage() {
        assert_eq!((target("1e-2"), target("0.5%"), target(" 10 % ")), (Ok(0.01), Ok(0.005), Ok(0.1)));
        for text in ["", "0", "-1%", "60%", "1e-7", "nan", "one"] {
            assert!(target(text).is_err(), "{text}");
        }
    }

    /// Null: the relative root mean square error over 400 runs of what is chosen for 2 %, against the value of another event-driven program
    /// (10^6 paths, 3e-4), is 2 %, or as much less as its bias is below the bound that was counted. From 400 runs it is known to
    /// 3.5 % of itself; four of these are allowed, and 3 % for the pilot's own error of the variance: false-alarm rate below 1e-4. Half
    /// or twice the paths change it by 1.41.
    #[test]
    fn many_runs_of_what_is_chosen_have_the_error_asked_for() {
        let (scenario, trade) = &*RHO025;
        let (mut chosen, promise) = wish(0.02, &[MEAN]).decide(scenario, trade).expect("a choice");
        chosen.time.output_step = chosen.time.end;
        chosen.record.paths = false;
        let square = |seed: u64| {
            chosen.ensemble.seed = 5000 + seed;
            let summary = chosen.plan().run(2);
            (summary.estimate(MEAN).estimate / 0.443052 - 1.0).powi(2)
        };
        let ratio = ((0..400).map(square).sum::<f64>() / 400.0).sqrt() / 0.02;
        let (play, least) = (4.0 / 800f64.sqrt() + 0.03, (1.0 - (promise.choice.bias / 0.02).powi(2)).sqrt());
        println!("{} x{}: {ratio}, least {least}", promise.choice.scheme, promise.choice.paths);
        assert!((least * (1.0 - play)..1.0 + play).contains(&ratio), "{ratio} {promise:?}");
    }

    /// What is named as in reach is accepted, and is no more than two and a half times what was refused for being out of it.
    #[test]
    fn what_takes_too_long_is_refused_with_what_does_not() {
        let limits = [(1e-6, None), (1e-3, Some(Duration::from_secs(1))), (0.01, Some(Duration::from_millis(10)))];
        for (target, max_time) in limits {
            let asked = |target| Wish { max_time, ..wish(target, &[MEAN]) };
            let (problem, remedy) = refusal(&asked(target), &RHO025);
            assert!(problem.contains("takes about") && problem.contains(MEAN.name()), "{problem}");
            let reached = remedy.strip_prefix("--accuracy ").and_then(|rest| rest.split_once(" is in reach"));
            let reached = super::target(reached.expect(&remedy).0).expect("an accuracy");
            assert!(asked(reached).decide(&RHO025.0, &RHO025.1).is_ok(), "{remedy}");
            let next = asked(reached / 2.6).decide(&RHO025.0, &RHO025.1);
            assert!(next.is_err(), "{remedy}: a finer one is in reach as well");
        }
        let never = Wish { max_time: Some(Duration::from_nanos(1)), ..wish(0.01, &[MEAN]) };
        assert!(refusal(&never, &RHO025).1.contains("give more time"));
    }

    /// The variance of a mean over n of N paths is N/n times that of all: with no bias, a quarter of the paths make twice the error.
    #[test]
    fn what_is_left_of_a_promise_is_told() {
        let (scenario, trade) = &*RHO025;
        let (_, mut promise) = wish(0.02, &[MEAN]).decide(scenario, trade).expect("a choice");
        promise.choice.bias = 0.0;
        promise.choice.paths = 1024;
        assert_eq!(promise.missed(1024), None);
        let told = promise.missed(256).expect("it is missed");
        assert!(told.contains("256 of 1 024 paths make about 4 % of stick_duration_mean"), "{told}");
        assert!(promise.missed(0).is_some_and(|told| told.contains("infinite")));
    }

    #[test]
    fn statistics_without_a_share_are_refused_when_named_and_left_out_of_all() {
        let equal = pilot("equal-friction", 2, &[64, 64, 64]);
        assert!(refusal(&wish(0.1, &[Statistic::SticksPerPath]), &equal).0.contains("no limit"));
        let (_, promise) = wish(0.1, &[]).decide(&equal.0, &equal.1).expect("others have one");
        assert!(!matches!(promise.choice.decisive, Statistic::SticksPerPath | Statistic::StickDurationMean));
        let never = pilot("never-slips", 2, &[64, 64, 64, 64]);
        assert!(refusal(&wish(0.1, &[Statistic::SticksPerPath]), &never).0.contains("exactly zero"));
        assert!(refusal(&wish(0.1, &[MEAN]), &never).0.contains("does not exist"));
        // All paths agree there: the fewest whose intervals say something.
        let (chosen, _) = wish(0.1, &[Statistic::StickingFraction]).decide(&never.0, &never.1).expect("it has a value");
        assert_eq!(chosen.ensemble.paths, FEWEST_PATHS);
    }
}
