//! Measured columns of a bearing, as a scenario names them.

use super::failure::{Failure, note};
use std::path::Path;
use stick_slip::config::BridgeScene;
use stick_slip::data::{self, Name, Quantity, Table, TimeColumn, Wanted};
use stick_slip::study::calibration::Record;

/// The column of this name, or else the one whose name begins so.
pub fn named<'a>(name: Option<&'a str>, beginning: &'a str) -> Name<'a> {
    name.map_or(Name::Beginning(beginning), Name::Exactly)
}

/// The column of times of a scenario.
pub fn time(scene: &BridgeScene) -> TimeColumn<'_> {
    TimeColumn { name: &scene.time, zone: scene.zone.as_deref() }
}

/// The column of temperatures of this name, or else the one whose name begins so.
pub fn temperature(column: Option<&str>) -> Wanted<'_> {
    Wanted { column: named(column, "temperature"), quantity: Quantity::Temperature, unit: None, max_gap: None }
}

/// Read some columns against time, and say what was repaired.
pub fn read(path: &Path, time: TimeColumn<'_>, wanted: &[Wanted<'_>]) -> Result<Table, Failure> {
    let table = data::read(path, time, wanted)?;
    for sentence in table.repairs.sentences() {
        note(&format!("{}: {sentence}", path.display()));
    }
    Ok(table)
}

/// The same where times are to be in seconds.
pub fn read_in_seconds(path: &Path, time: TimeColumn<'_>, wanted: &[Wanted<'_>]) -> Result<Table, Failure> {
    let table = read(path, time, wanted)?;
    if table.in_seconds {
        return Ok(table);
    }
    let problem = format!("{}: the name of column `{}` says no unit of time", path.display(), time.name);
    Err(Failure::usage(problem, "rename it, e.g. to `time_s` or `time_h`, and say so where the column is named"))
}

/// A record in the columns that a scenario names.
pub fn record(
    path: &Path,
    scene: &BridgeScene,
    displacement: Option<&str>,
    unit: Option<&str>,
) -> Result<Record, Failure> {
    let column = named(displacement, "displacement");
    let displacement = Wanted { column, quantity: Quantity::Displacement, unit, max_gap: None };
    let wanted = [temperature(scene.value.as_deref()), displacement];
    let table = read_in_seconds(path, time(scene), &wanted)?;
    let [temperature, displacement] = [&table.columns[0], &table.columns[1]];
    Ok(Record::of([&temperature.times, &temperature.values], [&displacement.times, &displacement.values]))
}
