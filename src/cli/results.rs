//! What every file of results says about where it comes from.

use super::failure::{Failure, note};
use super::numbers::wrapped;
use super::report;
use std::path::Path;
use stick_slip::advice::Warning;
use stick_slip::ensemble::BLOCK_SIZE;
use stick_slip::noise::GENERATOR;
use stick_slip::scenario::Scenario;
use stick_slip::stats::{Record, Summary};
use stick_slip::store::{Header, StoreError, Writer, check_space, discard_partial};

/// The header of the file that a scenario's run writes.
pub fn header(scenario: &Scenario) -> Header {
    let units = scenario.units.clone();
    Header {
        title: scenario.title.clone(),
        scenario_text: scenario.to_toml(),
        scheme: scenario.scheme.name().to_string(),
        step: scenario.scheme.step(),
        resolution: scenario.resolution().map(|resolution| resolution.shortest_slip),
        seed: scenario.ensemble.seed,
        generator: GENERATOR.to_string(),
        paths: scenario.ensemble.paths,
        block_size: BLOCK_SIZE,
        program_version: env!("CARGO_PKG_VERSION").to_string(),
        git_hash: env!("MC_GIT_HASH").to_string(),
        units: [units.time, units.length, units.force, units.temperature],
        time: scenario.timeline().output_times(),
    }
}

/// Say in what way the results of a scenario are not what they seem to be, on standard error. Where the bias of the step is
/// measured, the guess at it is left out.
pub fn warn(scenario: &Scenario, measures_bias: bool) {
    let is_guess = |warning: &Warning| matches!(warning, Warning::StickExitBias { .. } | Warning::CorrectedBias { .. });
    let is_measured = |warning: &Warning| measures_bias && is_guess(warning);
    for warning in scenario.warnings().iter().filter(|warning| !is_measured(warning)) {
        note(wrapped(&format!("warning: {warning}"), "  ").trim_end());
    }
}

/// Say so where the bias of the step is larger than the statistical interval tells.
pub fn warn_of_bias(summary: &Summary) {
    if let Some(line) = report::dominating_bias(summary) {
        note(wrapped(&format!("warning: {line}"), "  ").trim_end());
    }
}

/// Start the file of a run of so many paths at most, if its disk has room for those the scenario asks for. With `force`, what an
/// unfinished run to the same name left goes.
pub fn create(scenario: &Scenario, paths: u64, output: &Path, force: bool) -> Result<Writer, Failure> {
    check_space(output.parent().unwrap_or(Path::new(".")), scenario.derived().output_bytes as u64)?;
    start(&Header { paths, ..header(scenario) }, &scenario.record, output, force)
}

/// The same for a file known to be small, with a header of its own.
pub fn start(header: &Header, record: &Record, output: &Path, force: bool) -> Result<Writer, Failure> {
    if force {
        discard_partial(output)?;
    }
    Ok(Writer::create(output, header, record)?)
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::NotOpened { .. }
            | StoreError::NotHdf5 { .. }
            | StoreError::Foreign { .. }
            | StoreError::Newer { .. }
            | StoreError::Unfinished { .. }
            | StoreError::NoFolder { .. }
            | StoreError::LeftOver { .. } => Failure::Refused(error.to_string()),
            _ => Failure::Run(error.to_string()),
        }
    }
}
