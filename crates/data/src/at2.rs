//! Records of ground acceleration in the format AT2 of the PEER database: four header lines, the
//! last of which says how many values follow and how far apart they are, and then the values, in g.

use super::column::{DataColumn, LARGEST_MEASURED};
use super::error::DataError;
use super::query::Wanted;
use super::repairs::Repairs;
use super::table::Table;
use super::unit::{ColumnQuantity, InputUnit};

/// Lines before the values.
const HEADER: usize = 4;

/// The record in a text, if its fourth line is that of such a file and an input is wanted.
pub(super) fn record(file: &str, text: &[u8], wanted: &[Wanted<'_>]) -> Option<Result<Table, DataError>> {
    let [Wanted { quantity: quantity @ ColumnQuantity::Input, unit, .. }] = wanted else { return None };
    let start = text.split_inclusive(|byte| *byte == b'\n').take(HEADER).map(<[u8]>::len).sum::<usize>();
    let header = String::from_utf8_lossy(&text[..start]).to_uppercase();
    let [.., third, fourth] = header.lines().collect::<Vec<_>>()[..] else { return None };
    let after = |key: &str| fourth.split_once(key)?.1.split([',', ' ']).find(|word| !word.is_empty());
    let (count, step) = (after("NPTS=")?, after("DT=")?);
    let wrong = |line: usize, problem: String, remedy: &str| DataError::file(file, problem, remedy).line(line as u64);
    let read = || {
        let count: Option<usize> = count.parse().ok().filter(|count| *count >= 2);
        let step: Option<f64> = step.parse().ok().filter(|step: &f64| *step > 0.0 && step.is_finite());
        let (Some(count), Some(step)) = (count, step) else {
            let problem = format!("is not the header of a record: `{}`", fourth.trim());
            return Err(wrong(HEADER, problem, "write e.g. `NPTS=  4000, DT=   .0050 SEC,`"));
        };
        let said = third.split_once("UNITS OF ").map_or("G", |(_, said)| said.split_whitespace().next().unwrap_or("G"));
        let name = unit.unwrap_or(said);
        let Some(unit) = quantity.unit(name) else {
            let remedy = format!("give the unit of the values as `unit`: {}", quantity.units());
            return Err(wrong(HEADER - 1, format!("has the unknown unit `{name}`"), &remedy));
        };
        let values = values(text, start, &unit).map_err(|(line, value)| {
            let remedy = "fix the value; values of an input are not repaired or left out";
            wrong(line, format!("`{value}` is not a number"), remedy)
        })?;
        if values.len() != count {
            let problem = format!("has {} values, but its header says NPTS = {count}", values.len());
            let remedy = "use the complete file";
            return Err(wrong(HEADER, problem, remedy));
        }
        let times = (0..count).map(|i| i as f64 * step).collect();
        let column = DataColumn { name: String::new(), times, values, averaged: 0.0, unit: unit.name };
        let repairs = Repairs::default();
        let (rows, columns) = (count as u64, vec![column]);
        Ok(Table { start: None, begin: 0.0, in_seconds: true, rows, time: String::new(), columns, repairs })
    };
    Some(read())
}

/// The values behind the header in the unit of the results, or the line and the word that is none.
fn values(text: &[u8], start: usize, unit: &InputUnit) -> Result<Vec<f64>, (usize, String)> {
    let body = String::from_utf8_lossy(&text[start..]);
    let words = body.lines().enumerate().flat_map(|(i, line)| line.split_whitespace().map(move |word| (i, word)));
    let value = |(i, word): (usize, &str)| {
        let number = word.parse().ok().filter(|value: &f64| value.abs() <= LARGEST_MEASURED);
        number.map(|value| unit.of(value)).ok_or_else(|| (HEADER + 1 + i, word.to_string()))
    };
    words.map(value).collect()
}
