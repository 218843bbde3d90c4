//! Flags that change keys of a scenario.

use crate::output::failure::Failure;
use std::path::{Path, PathBuf};
use stickslip::config::{OPTIONS, Override, ScenarioError, input_files};
use stickslip::scenario::Scenario;
use stickslip::scheme::Kind;
use stickslip::stats::{Goal, GoalError};

/// Flags shared by every verb that reads a scenario.
#[derive(Debug, Default, clap::Args)]
pub struct Overrides {
    // The numbers are strings here, because the check of the scenario has better messages than the
    // parser of arguments.
    /// Number of paths [ensemble.paths]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    paths: Option<String>,
    /// Seed of the random numbers [ensemble.seed]
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    seed: Option<String>,
    #[arg(long, value_name = "KIND", allow_hyphen_values = true, value_parser = crate::arguments::completion::SCHEME, hide_possible_values = true,
          help = format!("Scheme: {} [scheme.kind]", names(|_| true, "or")))]
    scheme: Option<String>,
    #[arg(long, value_name = "TOL", allow_hyphen_values = true,
          help = format!("Permitted relative discretisation error; {} schemes [scheme.tolerance]",
                         names(|kind| !kind.has_step(), "and")))]
    tolerance: Option<String>,
    #[arg(long, value_name = "H", allow_hyphen_values = true,
          help = format!("Time step h; {} schemes [time.step]", names(Kind::has_step, "and")))]
    step: Option<String>,
    /// End of the simulation [time.end]; or, for mc run, a goal "NAME < 0.5%" (or "NAME < 0.01", in
    /// the unit of NAME): simulate until the standard error of this statistic is below the bound;
    /// repeatable
    #[arg(long, value_name = "T|GOAL", allow_hyphen_values = true)]
    until: Vec<String>,
    #[command(flatten)]
    set: Settings,
}

/// The option `--set`.
#[derive(Debug, Default, clap::Args)]
pub struct Settings {
    /// Any key of the scenario, e.g. friction.static=1.3 or temperature.harmonics.0.amplitude=2;
    /// repeatable
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true, value_parser = crate::arguments::completion::SETTING,
          hide_possible_values = true)]
    set: Vec<String>,
}

impl Settings {
    /// The changes, in order.
    pub fn list(&self) -> Result<Vec<Override>, ScenarioError> {
        let typed = |text: &String| Override::typed(&format!("--set {text}"), text);
        self.set.iter().map(typed).collect()
    }
}

impl Overrides {
    /// Reads a scenario and applies the flags: every `--set` in order, then the flags for single
    /// keys.
    pub fn scenario(&self, path: &Path) -> Result<Scenario, Failure> {
        Ok(Scenario::read(path, &self.without_goals()?)?)
    }

    /// The files that the scenario is made from with these flags.
    pub fn inputs(&self, path: &Path) -> Result<Vec<PathBuf>, Failure> {
        Ok(input_files(path, &self.list()?))
    }

    /// The changes, for a verb without goals; a goal is an error there.
    pub fn without_goals(&self) -> Result<Vec<Override>, Failure> {
        match self.until.iter().find(|text| is_goal(text)) {
            None => Ok(self.list()?),
            Some(goal) => Err(Failure::usage(
                format!("--until \"{goal}\" is a goal of mc run"),
                "remove it here",
            )),
        }
    }

    /// Reads a scenario and applies the flags, then further changes.
    pub fn scenario_with(&self, path: &Path, more: &[Override]) -> Result<Scenario, Failure> {
        Ok(Scenario::read(
            path,
            &[self.list()?.as_slice(), more].concat(),
        )?)
    }

    /// Reads the scenario and the goals of a run.
    pub fn scenario_and_goals(&self, path: &Path) -> Result<(Scenario, Vec<Goal>), Failure> {
        let goals = self.until.iter().filter(|text| is_goal(text));
        let goals: Result<Vec<Goal>, Failure> = goals
            .map(|text| text.parse().map_err(|error| wrong_goal(text, &error)))
            .collect();
        Ok((Scenario::read(path, &self.list()?)?, goals?))
    }

    /// Whether `--paths` is given.
    pub fn gives_paths(&self) -> bool {
        self.paths.is_some()
    }

    /// The first flag, as typed, that sets one of these keys.
    pub fn decides(&self, keys: &[&str]) -> Option<String> {
        let list = self.list().unwrap_or_default();
        list.iter()
            .find(|given| keys.iter().any(|key| given.sets(key)))
            .map(Override::to_string)
    }

    fn list(&self) -> Result<Vec<Override>, ScenarioError> {
        let mut list = self.set.list()?;
        for (option, key) in OPTIONS {
            let values = match option {
                "paths" => self.paths.as_slice(),
                "seed" => self.seed.as_slice(),
                "scheme" => self.scheme.as_slice(),
                "tolerance" => self.tolerance.as_slice(),
                "step" => self.step.as_slice(),
                _ => self.until.as_slice(),
            };
            let is_value = |text: &&String| option != "until" || !is_goal(text);
            let values = values.iter().filter(is_value);
            list.extend(values.map(|value| Override::flag(&format!("--{option}"), key, value)));
        }
        Ok(list)
    }
}

/// The names of the schemes for which `of` is true, joined by commas and `word`: "a, b or c".
fn names(of: impl Fn(Kind) -> bool, word: &str) -> String {
    let names: Vec<&str> = Kind::ALL
        .iter()
        .filter(|kind| of(**kind))
        .map(|kind| kind.name())
        .collect();
    match names.split_last() {
        Some((last, [])) => last.to_string(),
        Some((last, others)) => format!("{} {word} {last}", others.join(", ")),
        None => String::new(),
    }
}

/// Whether an argument of `--until` is a goal, which contains a comparison, and not a time.
fn is_goal(until: &str) -> bool {
    until.contains('<')
}

fn wrong_goal(text: &str, error: &GoalError) -> Failure {
    let remedy = match error {
        GoalError::UnknownStatistic(_) => format!("one of {}", crate::statistic_names()),
        GoalError::NoComparison | GoalError::NoBound(_) => {
            "such as --until \"stick_duration_mean < 0.5%\"".to_string()
        }
    };
    Failure::usage(format!("--until \"{text}\": {error}"), remedy)
}
