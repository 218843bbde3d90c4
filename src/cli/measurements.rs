//! Measured columns of a bearing, as a scenario names them.

use super::failure::{Failure, note};
use std::path::Path;
use stick_slip::config::BridgeScene;
use stick_slip::data::{self, Name, Quantity, Table, TimeColumn, Wanted};

/// The column of this name, or else the one whose name begins so.
pub fn named<'a>(name: Option<&'a str>, beginning: &'a str) -> Name<'a> {
    name.map_or(Name::Beginning(beginning), Name::Exactly)
}

/// The temperature of a scenario.
pub fn temperature(scene: &BridgeScene) -> Wanted<'_> {
    let column = named(scene.value.as_deref(), "temperature");
    Wanted { column, quantity: Quantity::Temperature, unit: None, max_gap: None }
}

/// Read some columns against the time that the scenario names, and say what was repaired.
pub fn read(path: &Path, scene: &BridgeScene, wanted: &[Wanted<'_>]) -> Result<Table, Failure> {
    let table = data::read(path, TimeColumn { name: &scene.time, zone: scene.zone.as_deref() }, wanted)?;
    for sentence in table.repairs.sentences() {
        note(&format!("{}: {sentence}", path.display()));
    }
    Ok(table)
}
