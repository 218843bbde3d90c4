//! Temperatures and displacements on one time axis, from one file or from two.

use super::clock::Start;
use super::column::DataColumn;
use super::error::DataError;
use super::query::{Layout, Wanted};
use super::table::Table;
use super::unit::ColumnQuantity;
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

    /// Read columns, whatever the unit of their times is.
    pub fn read(&self, layout: &Layout, wanted: &[Wanted<'_>]) -> Result<Table, DataError> {
        match self {
            Origin::File(path) => read(path, layout, wanted),
            Origin::Text(name, text) => parse(name, text.as_bytes(), layout, wanted),
        }
    }

    /// Read columns whose times are in seconds. Times of an unknown unit are an error.
    pub fn read_in_seconds(
        &self,
        layout: &Layout,
        wanted: &[Wanted<'_>],
    ) -> Result<Table, DataError> {
        let table = self.read(layout, wanted)?;
        if table.in_seconds {
            return Ok(table);
        }
        let problem = format!("the name of column `{}` gives no unit of time", table.time);
        let renamed = layout.wording.option("time", "time_h");
        let remedy = format!(
            "rename it in the file, e.g. to `time_s` or `time_h`, and use the new name, e.g. {renamed}"
        );
        Err(DataError::file(&self.name(), problem, &remedy))
    }
}

/// A column of a file: the file, the column, its unit, and the layout of the file, where given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnSource {
    /// The file.
    pub file: Option<String>,
    /// The name of the column of values. Without it, the column whose name begins with the
    /// quantity.
    pub column: Option<String>,
    /// The unit of the values, if the file does not give it.
    pub unit: Option<String>,
    /// How the file is laid out.
    pub layout: Layout,
}

impl ColumnSource {
    /// The column that is wanted.
    pub fn wanted(&self, quantity: ColumnQuantity) -> Wanted<'_> {
        Wanted {
            averaged: self.layout.averaged,
            ..Wanted::of(quantity, self.column.as_deref(), self.unit.as_deref())
        }
    }

    /// Read the column alone: its samples, the instant from which the times count if they are dates,
    /// and what was repaired, in sentences that begin with the name of the file.
    pub fn read(
        &self,
        from: Origin<'_>,
        quantity: ColumnQuantity,
    ) -> Result<(DataColumn, Option<Start>, Vec<String>), DataError> {
        let mut table = from.read_in_seconds(&self.layout, &[self.wanted(quantity)])?;
        let repairs = table.repairs.of_file(from.name());
        Ok((table.columns.swap_remove(0), table.start, repairs))
    }
}

/// The temperatures and displacements measured at a bearing.
#[derive(Clone, Debug, PartialEq)]
pub struct BearingData {
    /// Temperatures, in degrees Celsius or kelvin.
    pub temperature: DataColumn,
    /// Displacements, in metres.
    pub displacement: DataColumn,
    /// The instant from which the times count, if they are dates.
    pub start: Option<Start>,
    /// What was repaired, in sentences that begin with the name of the file.
    pub repairs: Vec<String>,
}

impl BearingData {
    /// Read a temperature and a displacement from one file, which has the layout of the
    /// displacements. If the temperatures are in a separate file, read both files; their times must
    /// then be dates. Errors of both files are reported together.
    pub fn read(
        data: Origin<'_>,
        temperatures: Option<Origin<'_>>,
        temperature: &ColumnSource,
        displacement: &ColumnSource,
    ) -> Result<BearingData, DataError> {
        let Some(other) = temperatures else {
            let both = [
                temperature.wanted(ColumnQuantity::Temperature),
                displacement.wanted(ColumnQuantity::Displacement),
            ];
            let mut table = data.read_in_seconds(&displacement.layout, &both)?;
            let displacement = table.columns.swap_remove(1);
            let temperature = table.columns.swap_remove(0);
            let repairs = table.repairs.of_file(data.name());
            return Ok(BearingData {
                temperature,
                displacement,
                start: table.start,
                repairs,
            });
        };
        let (given, of_data) = (&temperature.layout, &displacement.layout);
        let is_shared = given.time == of_data.time && given.dates == of_data.dates;
        let temperature = &ColumnSource {
            layout: Layout {
                is_of_other_file: is_shared,
                ..given.clone()
            },
            ..temperature.clone()
        };
        let air = temperature.read(other, ColumnQuantity::Temperature);
        let sensor = displacement.read(data, ColumnQuantity::Displacement);
        let ((air, start, repairs), (mut displacement, later, more)) = match (air, sensor) {
            (Ok(air), Ok(sensor)) => (air, sensor),
            (Err(air), Err(sensor)) => return Err(air.and(sensor)),
            (Err(error), _) | (_, Err(error)) => return Err(error),
        };
        let (Some(first), Some(later)) = (&start, &later) else {
            let numbered = if later.is_none() { &data } else { &other };
            let problem =
                "its times are numbers, which cannot be aligned with those of a second file"
                    .to_string();
            let remedy = "give dates as times in both files, such as 2015-08-13T00:10:00Z, or both columns in one file";
            return Err(DataError::file(&numbered.name(), problem, remedy));
        };
        let ahead = later.since(first);
        displacement
            .times
            .iter_mut()
            .for_each(|time| *time += ahead);
        if let Some(problem) = apart(first, &air, &displacement) {
            let remedy = "give files of the same days, and check the order of dates and the time zone of both";
            return Err(DataError::file(&other.name(), problem, remedy));
        }
        Ok(BearingData {
            temperature: air,
            displacement,
            start,
            repairs: [repairs, more].concat(),
        })
    }
}

/// The error of a temperature and a displacement without a common time. Both count from this
/// instant.
fn apart(start: &Start, air: &DataColumn, sensor: &DataColumn) -> Option<String> {
    let ends = |column: &DataColumn| Some([*column.times.first()?, *column.times.last()?]);
    let ([air, until], [sensor, end]) = (ends(air)?, ends(sensor)?);
    if air <= end && sensor <= until {
        return None;
    }
    let date = |seconds: f64| {
        start
            .after(seconds)
            .map_or(String::new(), |at| at.to_string())
    };
    Some(format!(
        "its temperatures, from {} to {}, have no time in common with the displacements, from {} to {}",
        date(air),
        date(until),
        date(sensor),
        date(end)
    ))
}
