//! Where results are written by default, and the warnings before and after a run.

use crate::output::failure;
use crate::output::numbers::counted;
use crate::{Failure, report};
use std::path::{Path, PathBuf};
use stickslip::advice::Warning;
use stickslip::config::{Override, STANDARD_INPUT, ScenarioError};
use stickslip::engine::RunError;
use stickslip::ensemble::Flaw;
use stickslip::scenario::Scenario;
use stickslip::stats::Summary;
use stickslip_files::saved::SavedError;
use stickslip_files::store::{StoreError, Stored};

/// The default output file of a scenario: in the current directory, with the name of the scenario
/// and this extension.
pub fn default_output(scenario: &Path, ending: &str) -> PathBuf {
    let is_standard_input = scenario == Path::new(STANDARD_INPUT);
    let stem = if is_standard_input {
        "stdin".as_ref()
    } else {
        scenario.file_stem().unwrap_or("run".as_ref())
    };
    let mut name = stem.to_os_string();
    name.push(ending);
    PathBuf::from(name)
}

/// The scenario of a file of results, with its measured temperature, after these overrides.
pub fn scenario(
    name: &str,
    stored: &Stored,
    overrides: &[Override],
) -> Result<Scenario, ScenarioError> {
    Scenario::parse_stored(
        name,
        &stored.header.scenario_text,
        overrides,
        &stored.header.samples,
    )
}

/// Checks that the ensemble of a file has a path of this number. A path of any number can be
/// simulated, but one outside the ensemble is probably a typing error.
pub fn check_path(stored: &Stored, path: u64) -> Result<(), Failure> {
    let paths = stored.header.paths;
    if path < paths {
        return Ok(());
    }
    let problem = format!("--path {path}: the ensemble has {}", counted(paths, "path"));
    Err(Failure::usage(
        problem,
        format!("give a number from 0 to {}", paths.saturating_sub(1)),
    ))
}

/// Prints the warnings of a scenario on standard error. Leaves out the warnings that only estimate
/// the bias of the step if the run measures it, and the one about few periods if a table reports it
/// at the drift.
pub fn warn(scenario: &Scenario, measures_bias: bool, has_table: bool) {
    let due = scenario.warnings_of_run(measures_bias);
    due.iter()
        .filter(|warning| !(has_table && warning.name() == "few-periods"))
        .for_each(failure::warn);
}

/// All warnings about results: those of the scenario and those that follow from the statistics.
/// Each is a name and a sentence.
pub fn warnings(summary: &Summary, scenario: Option<&Scenario>) -> Vec<(String, String)> {
    let due = scenario.map_or(Vec::new(), |scenario| {
        scenario.warnings_of_run(summary.has_bias())
    });
    named(&due)
        .into_iter()
        .chain(report::found(summary))
        .collect()
}

/// Names and sentences of warnings about a scenario.
pub fn named(warnings: &[Warning]) -> Vec<(String, String)> {
    warnings
        .iter()
        .map(|warning| (warning.name().to_string(), warning.to_string()))
        .collect()
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Sink { error, .. } => match error.downcast::<StoreError>() {
                Ok(error) => Failure::from(*error),
                Err(error) => Failure::Run(error.to_string()),
            },
            RunError::Threads(error) => crate::arguments::threads::refused(error),
            RunError::Flaw { flaw, .. } => flaw.into(),
            _ => Failure::Run(error.to_string()),
        }
    }
}

impl From<Flaw> for Failure {
    fn from(flaw: Flaw) -> Self {
        Failure::run(flaw, Flaw::REMEDY)
    }
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::NotOpened { .. }
            | StoreError::NotHdf5 { .. }
            | StoreError::Foreign { .. }
            | StoreError::OtherFormat { .. }
            | StoreError::NoFolder { .. }
            | StoreError::LeftOver { .. }
            | StoreError::Resumable { .. }
            | StoreError::NothingToResume { .. }
            | StoreError::InTheWay { .. }
            | StoreError::Saved(SavedError::OtherProgram { .. } | SavedError::Newer { .. })
            | StoreError::Busy { .. }
            | StoreError::OtherSweep { .. }
            | StoreError::NotASweep { .. }
            | StoreError::NoChecksum { .. } => Failure::Refused(error.to_string()),
            _ => Failure::Run(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_go_to_the_current_directory_by_scenario_name() {
        let named = |scenario: &str| default_output(Path::new(scenario), ".h5");
        assert_eq!(named("scenarios/rho025.toml"), Path::new("rho025.h5"));
        assert_eq!(named("my.study.toml"), Path::new("my.study.h5"));
        assert_eq!(named("-"), Path::new("stdin.h5"));
        assert_eq!(
            default_output(Path::new("-"), "-sweep.h5"),
            Path::new("stdin-sweep.h5")
        );
    }
}
