//! Measured columns of a bearing, as a scenario names them.

use super::failure::{Failure, note};
use std::path::{Path, PathBuf};
use stick_slip::config::BridgeScene;
use stick_slip::data::{self, Column, Name, Quantity, Table, TimeColumn, Wanted};
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

/// Where a record of a bearing is.
#[derive(Debug, clap::Args)]
pub struct Source {
    /// The measurement, a CSV file with times, temperatures and displacements
    #[arg(value_name = "DATA.csv")]
    pub data: PathBuf,
    /// The temperatures, if they are in a file of their own
    #[arg(long, value_name = "FILE.csv")]
    temperature: Option<PathBuf>,
    /// The column of displacements [default: the one whose name begins with `displacement`]
    #[arg(long, value_name = "COLUMN")]
    displacement: Option<String>,
    /// The unit of displacements, if the name of their column does not say it: m, cm, mm or um
    #[arg(long, value_name = "U")]
    unit: Option<String>,
}

impl Source {
    /// The files that a result is made from.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(self.data.as_path()).chain(self.temperature.as_deref())
    }

    /// The record, in the columns that a scenario names.
    pub fn record(&self, scene: &BridgeScene) -> Result<Record, Failure> {
        let column = named(self.displacement.as_deref(), "displacement");
        let unit = self.unit.as_deref();
        let displacement = Wanted { column, quantity: Quantity::Displacement, unit, max_gap: None };
        let temperature = temperature(scene.value.as_deref());
        let Some(file) = &self.temperature else {
            let table = read_in_seconds(&self.data, time(scene), &[temperature, displacement])?;
            let [temperature, displacement] = [&table.columns[0], &table.columns[1]];
            return Ok(joined(temperature, displacement, 0.0));
        };
        let air = read_in_seconds(file, time(scene), &[temperature])?;
        let sensor = read_in_seconds(&self.data, time(scene), &[displacement])?;
        let (Some(first), Some(other)) = (&air.start, &sensor.start) else {
            let problem = format!("{} and {} have no stamps in common", file.display(), self.data.display());
            return Err(Failure::usage(problem, "give times as stamps, such as 2015-08-13T00:10:00Z, or one file"));
        };
        Ok(joined(&air.columns[0], &sensor.columns[0], other.since(first)))
    }
}

/// Two columns, the second of which counts its times from so much later.
fn joined(temperature: &Column, displacement: &Column, later: f64) -> Record {
    let when: Vec<f64> = displacement.times.iter().map(|time| time + later).collect();
    Record::of([&temperature.times, &temperature.values], [&when, &displacement.values])
}
