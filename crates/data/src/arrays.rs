//! Measurements in memory, checked and repaired like those in a file.

use super::column::{Column, DataColumn, LARGEST_MEASURED, SampleSource, sorted};
use super::error::DataError;
use super::marks::Marks;
use super::query::{Layout, Wanted};
use super::repairs::Repairs;
use super::unit::ColumnQuantity;

/// A measurement in memory: what was measured, its times in seconds, and its values in the units of
/// the results. Values that are NaN are missing.
pub type Array<'a> = (ColumnQuantity, &'a [f64], &'a [f64]);

/// Check, sort and repair measurements in memory, with the marks and the outlier limit of a layout.
/// Their times are unchanged.
pub fn arrays(
    arrays: &[Array<'_>],
    layout: &Layout,
) -> Result<(Vec<DataColumn>, Repairs), DataError> {
    let marks = Marks::of(layout);
    let mut repairs = Repairs::default();
    let mut columns = Vec::new();
    for (quantity, times, values) in arrays {
        let name = quantity.word();
        let unit = match quantity {
            ColumnQuantity::Temperature => Some("degC"),
            ColumnQuantity::Displacement => Some("m"),
            ColumnQuantity::Input => None,
        };
        let wanted = Wanted {
            averaged: layout.averaged,
            ..Wanted::of(*quantity, Some(name), unit)
        };
        let whole = |(problem, remedy): (String, String)| DataError::file(name, problem, remedy);
        let mut column = Column::of(name, &wanted).map_err(whole)?;
        for (place, (time, value)) in times.iter().zip(*values).enumerate() {
            let wrong = |problem: &str, remedy: &str| {
                let error =
                    DataError::file(name, format!("{problem} (value {})", place + 1), remedy);
                error.cell(name, format!("{value}").as_bytes())
            };
            if value.is_nan() {
                column
                    .miss()
                    .map_err(|(problem, remedy)| wrong(problem, remedy))?;
                continue;
            }
            if time.is_nan() || time.abs() > LARGEST_MEASURED {
                return Err(wrong(
                    "has a time that is missing or too large",
                    "give the sample a time, or remove it",
                ));
            }
            column
                .take(*time, *value, place as u32, &marks)
                .map_err(|(problem, _)| {
                    wrong(problem, "fix the value; use NaN for a missing one")
                })?;
        }
        let source = SampleSource {
            file: name,
            layout,
            twice: "keep the right one of the two",
            line: &|place| u64::from(place) + 1,
            in_seconds: true,
        };
        sorted(&mut column, &mut repairs, &source)?;
        columns.push(column.finished(0.0));
    }
    Ok((columns, repairs))
}
