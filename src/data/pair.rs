//! Temperatures and displacements on one time axis, from one file or from two.

use super::error::DataError;
use super::query::{TimeColumn, Wanted};
use super::table::{DataColumn, Table};
use super::{parse, read};
use std::path::Path;

/// Where a table is read from.
#[derive(Clone, Copy, Debug)]
pub enum Origin<'a> {
    /// From a file.
    File(&'a Path),
    /// From a text: the name that messages use for it, and the text itself.
    Text(&'a str, &'a str),
}

impl Origin<'_> {
    /// The name that messages use.
    pub fn name(&self) -> String {
        match self {
            Origin::File(path) => path.display().to_string(),
            Origin::Text(name, _) => (*name).to_string(),
        }
    }

    /// Read columns whose times are in seconds. Times of an unknown unit are an error.
    pub fn read_in_seconds(&self, time: TimeColumn<'_>, wanted: &[Wanted<'_>]) -> Result<Table, DataError> {
        let table = match self {
            Origin::File(path) => read(path, time, wanted)?,
            Origin::Text(name, text) => parse(name, text.as_bytes(), time, wanted)?,
        };
        if table.in_seconds {
            return Ok(table);
        }
        let problem = format!("the name of column `{}` says no unit of time", time.name);
        let remedy = "rename it, e.g. to `time_s` or `time_h`, and say so where the column is named";
        Err(DataError::file(&self.name(), problem, remedy))
    }
}

/// The temperatures and displacements measured at a bearing.
#[derive(Clone, Debug, PartialEq)]
pub struct BearingData {
    /// Temperatures, in degrees Celsius or kelvin.
    pub temperature: DataColumn,
    /// Displacements, in metres.
    pub displacement: DataColumn,
    /// What was repaired, in sentences that begin with the name of the file.
    pub repairs: Vec<String>,
}

impl BearingData {
    /// Read a temperature and a displacement from one file. If the temperatures are in a file of
    /// their own, read both files; their times must then be stamps.
    pub fn read(
        data: Origin<'_>,
        temperatures: Option<Origin<'_>>,
        time: TimeColumn<'_>,
        [temperature, displacement]: [Wanted<'_>; 2],
    ) -> Result<BearingData, DataError> {
        let mut repairs = Vec::new();
        let mut read = |origin: Origin<'_>, wanted: &[Wanted<'_>]| {
            let table = origin.read_in_seconds(time, wanted)?;
            repairs.extend(table.repairs.sentences().iter().map(|sentence| format!("{}: {sentence}", origin.name())));
            Ok::<_, DataError>(table)
        };
        let Some(other) = temperatures else {
            let mut table = read(data, &[temperature, displacement])?;
            let displacement = table.columns.swap_remove(1);
            let temperature = table.columns.swap_remove(0);
            return Ok(BearingData { temperature, displacement, repairs });
        };
        let (mut air, mut sensor) = (read(other, &[temperature])?, read(data, &[displacement])?);
        let (Some(first), Some(later)) = (&air.start, &sensor.start) else {
            let problem = format!("it has no stamps in common with {}", other.name());
            let remedy = "give times as stamps, such as 2015-08-13T00:10:00Z, or one file";
            return Err(DataError::file(&data.name(), problem, remedy));
        };
        let later = later.since(first);
        let mut displacement = sensor.columns.swap_remove(0);
        displacement.times.iter_mut().for_each(|time| *time += later);
        Ok(BearingData { temperature: air.columns.swap_remove(0), displacement, repairs })
    }
}
