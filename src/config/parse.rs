//! Keys -> a checked scenario. What leaves this file is finite, in range, and can be computed with.

use super::blame::blame;
use super::error::Fault;
use super::fields::Fields;
use super::keys;
use super::physics::{Physics, bearing, physics};
use super::source::Sources;
use super::time::scheme_and_time;
use super::tree;
use crate::scenario::{Ensemble, MAX_PATHS, MAX_TRAJECTORIES, Scenario, Statistics, Units};
use crate::stats::Record;

/// Paths of a scenario that does not say how many.
const DEFAULT_PATHS: u64 = 10_000;

/// A fixed default, so that a scenario without a seed is still reproducible.
const DEFAULT_SEED: u64 = 1;

/// Read the tree, key by key.
pub(super) fn scenario(sources: &Sources<'_>, default_title: &str) -> Result<Scenario, Box<Fault>> {
    let tree = tree::read(sources)?;
    let root = Fields::root(sources, &tree)?;
    refuse_unknown_keys(&root)?;
    let Physics { model, measured, is_balanced } = physics(sources, &root)?;
    let bearing = bearing(&root)?;
    let (scheme, time) = scheme_and_time(sources, &root, &model)?;
    // 0.0, never -0.0.
    let statistics = Statistics { after: root.table("statistics")?.number_or(keys::AFTER, 0.0)?.value.abs() };
    statistics.check(time.end).map_err(|misfit| blame(sources, &root, &misfit))?;
    let ensemble = root.table("ensemble")?;
    let ensemble = Ensemble {
        paths: ensemble.whole_or("paths", DEFAULT_PATHS, (1, MAX_PATHS))?,
        seed: ensemble.whole_or("seed", DEFAULT_SEED, (0, u64::MAX))?,
        antithetic: ensemble.flag_or("antithetic", false)?,
    };
    ensemble.check().map_err(|misfit| blame(sources, &root, &misfit))?;
    let record = root.table("record")?;
    let units = root.table("units")?;
    Ok(Scenario {
        title: root.line_or("title", default_title)?,
        model,
        measured,
        is_balanced,
        bearing,
        time,
        scheme,
        statistics,
        ensemble,
        record: Record {
            paths: record.flag_or("paths", true)?,
            events: record.flag_or("events", false)?,
            trajectories: record.whole_or("trajectories", 0, (0, MAX_TRAJECTORIES))?,
        },
        units: Units {
            time: units.line_or("time", "")?,
            length: units.line_or("length", "")?,
            force: units.line_or("force", "")?,
            temperature: units.line_or("temperature", "")?,
        },
    })
}

/// Open every table before any is read: a misspelt key is the better explanation of a missing one.
fn refuse_unknown_keys(root: &Fields<'_>) -> Result<(), Box<Fault>> {
    for name in keys::of_table("").iter().filter(|name| !keys::of_table(name).is_empty()) {
        root.table(name)?;
    }
    let temperature = root.table("temperature")?;
    temperature.tables("harmonics")?;
    temperature.one_or_more("noise")?;
    temperature.table("series")?;
    Ok(())
}
