//! From keys to a checked scenario. Every number in the result is finite and in range.

use super::diagnose::report_check_error;
use super::error::ScenarioError;
use super::fields::Fields;
use super::keys;
use super::overrides::Override;
use super::physics::{Physics, bearing, physics};
use super::source::Sources;
use super::time::scheme_and_time;
use super::tree;
use crate::scenario::build::{DEFAULT_PATHS, DEFAULT_SEED};
use crate::scenario::{
    AsWritten, Ensemble, MAX_PATHS, MAX_TRAJECTORIES, Scenario, Statistics, Time, Units,
};
use crate::stats::{PassageLevels, Record};
use std::path::Path;

/// The beginning of the list of changes in a title.
const CHANGED: &str = " (changed: ";

/// The title with the changes that the overrides make to the physics, so that tables, pictures and
/// citations are headed by what was simulated. A title among the overrides is kept as it is.
pub(super) fn titled(title: String, overrides: &[Override]) -> String {
    let set_later = |i: usize| {
        overrides[i + 1..]
            .iter()
            .any(|later| later.key == overrides[i].key)
    };
    let changes: Vec<String> = (0..overrides.len())
        .filter(|i| !set_later(*i))
        .filter_map(|i| overrides[i].change_of_physics())
        .collect();
    if changes.is_empty() || overrides.iter().any(|change| change.sets("title")) {
        return title;
    }
    let changes = changes.join(", ");
    match title
        .strip_suffix(')')
        .filter(|title| title.contains(CHANGED))
    {
        Some(earlier) => format!("{earlier}, {changes})"),
        None => format!("{title}{CHANGED}{changes})"),
    }
}

/// The stem of the source's name.
fn default_title(name: &str) -> String {
    let stem = Path::new(name)
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    stem.chars().filter(|c| !c.is_control()).collect()
}

/// Read the whole tree, key by key.
pub(super) fn scenario(sources: &Sources<'_>) -> Result<Scenario, ScenarioError> {
    let tree = tree::read(sources)?;
    let root = Fields::root(sources, &tree);
    report_unknown_keys(&root);
    let Physics {
        mut model,
        written,
        unused,
    } = physics(sources, &root);
    let bearing = bearing(&root);
    let (scheme, end, output_step) = scheme_and_time(sources, &root, &written.measured);
    match written
        .white_noise
        .map(|noise| noise.simulated(&model, scheme, end))
    {
        None => {}
        Some(Ok(noise)) => model.temperature.noises = vec![noise],
        Some(Err(check_error)) => report_check_error(sources, &root, check_error),
    }
    let statistics = root.table("statistics");
    let levels = PassageLevels::of(&statistics.list(keys::LEVELS, PassageLevels::MOST));
    let title = default_title(sources.name);
    let scenario = Scenario {
        // `abs` turns -0.0 into 0.0.
        statistics: Statistics {
            after: statistics.number_or(keys::AFTER, 0.0).abs(),
            period: statistics.number_if_present(keys::COMPARED),
        },
        ensemble: ensemble(&root.table("ensemble")),
        title: titled(root.line_or(keys::TITLE, &title), sources.overrides),
        model,
        bearing,
        time: output_step.map_or_else(
            || Time::with_default_rows(end, scheme),
            |output_step| Time { end, output_step },
        ),
        scheme,
        record: record(&root.table("record"), levels),
        units: units(&root.table("units")),
        written: AsWritten {
            named: sources.all_named(),
            ..written
        },
    };
    let scenario = scenario.with_first_path();
    let is_named = |name: &str| {
        scenario
            .written
            .named
            .iter()
            .any(|(_, named)| named == name)
    };
    unused
        .into_iter()
        .filter(|(name, _)| !is_named(name))
        .for_each(|(_, diagnostic)| sources.report(diagnostic));
    scenario
        .check_errors()
        .into_iter()
        .for_each(|check_error| report_check_error(sources, &root, check_error));
    sources.outcome(scenario)
}

fn ensemble(table: &Fields<'_>) -> Ensemble {
    Ensemble {
        paths: table
            .whole_if_present(keys::PATHS, 1..=MAX_PATHS)
            .unwrap_or(DEFAULT_PATHS),
        seed: table
            .whole_if_present(keys::SEED, 0..=u64::MAX)
            .unwrap_or(DEFAULT_SEED),
        antithetic: table.flag_or(keys::ANTITHETIC, false),
    }
}

fn record(table: &Fields<'_>, levels: PassageLevels) -> Record {
    Record {
        paths: table.flag_or(keys::RECORD_PATHS, true),
        events: table.flag_or(keys::EVENTS, false),
        trajectories: table
            .whole_if_present(keys::TRAJECTORIES, 0..=MAX_TRAJECTORIES)
            .unwrap_or(0),
        laws: table.flag_or(keys::LAWS, false),
        density: table.flag_or(keys::DENSITY, false),
        spectrum: table.flag_or(keys::SPECTRUM, false),
        energy: table.flag_or(keys::ENERGY, false),
        levels,
    }
}

fn units(table: &Fields<'_>) -> Units {
    Units {
        time: table.line_or(keys::TIME_LABEL, ""),
        length: table.line_or(keys::LENGTH_LABEL, ""),
        force: table.line_or(keys::FORCE_LABEL, ""),
        temperature: table.line_or(keys::TEMPERATURE_LABEL, ""),
    }
}

/// Open every table, even one that is not read below, so that its unknown keys are reported.
fn report_unknown_keys(root: &Fields<'_>) {
    let tables = keys::of_table("")
        .into_iter()
        .filter(|name| !keys::of_table(name).is_empty());
    for name in tables.filter(|name| *name != keys::INPUT.name) {
        root.table(name);
    }
    let temperature = root.table("temperature");
    temperature.tables("harmonics");
    temperature.one_or_more("noise");
    temperature.table("series");
}
