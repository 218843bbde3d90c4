//! Variables of an HDF5 or netCDF-4 file, read as if they were the columns of a CSV file.
//!
//! They are written to a CSV text in memory, which is then read like a file, so that both formats
//! have the same checks, repairs and errors.

use super::clock::Start;
use super::error::DataError;
use super::query::{Name, TimeColumn, Wanted};
use super::table::{self, Table};
use ::hdf5::types::{FixedAscii, FixedUnicode, VarLenAscii, VarLenUnicode};
use ::hdf5::{Dataset, File};
use std::fmt::Write as _;
use std::path::Path;

/// The first bytes of an HDF5 file.
pub(super) const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Largest number of values in a variable, which bounds the memory. No measured record of a bearing
/// is longer.
const MOST: usize = 50_000_000;

/// Read variables along one dimension, with one value for each time.
pub(super) fn read(path: &Path, time: TimeColumn<'_>, wanted: &[Wanted<'_>]) -> Result<Table, DataError> {
    let name = path.display().to_string();
    let wrong = |problem: String, remedy: &str| DataError::file(&name, problem, remedy);
    let damaged = |error: ::hdf5::Error| wrong(format!("cannot be read as HDF5: {error}"), "see that it is whole");
    let file = File::open(path).map_err(damaged)?;
    let names = file.member_names().map_err(damaged)?;
    let find = |of: Name<'_>| -> Result<(String, Dataset), DataError> {
        let is = |name: &str| match of {
            Name::Exactly(exact) => name == exact,
            Name::Beginning(start) => name.starts_with(start),
        };
        let what = match of {
            Name::Exactly(exact) => format!("is called `{exact}`"),
            Name::Beginning(start) => format!("has a name that begins with `{start}`"),
        };
        let found: Vec<&String> = names.iter().filter(|name| is(name)).collect();
        let [found] = found[..] else {
            let problem =
                format!("{} of its variables {what}", if found.is_empty() { "none" } else { "more than one" });
            return Err(wrong(problem, &format!("name one of {}", names.join(", "))));
        };
        let variable = file.dataset(found).map_err(damaged)?;
        if variable.ndim() != 1 || variable.size() > MOST {
            let problem = format!("`{found}` has the shape {:?}", variable.shape());
            return Err(wrong(problem, "give a variable with one value for each time, and no other dimension"));
        }
        Ok((found.clone(), variable))
    };
    let values = |found: &str, variable: &Dataset| -> Result<Vec<f64>, DataError> {
        let packed = ["scale_factor", "add_offset"].iter().any(|of| variable.attr(of).is_ok());
        if packed {
            return Err(wrong(format!("`{found}` is packed (scale_factor, add_offset)"), "write it as plain numbers"));
        }
        let fill = variable.attr("_FillValue").and_then(|fill| fill.read_raw::<f64>()).unwrap_or_default();
        let values = variable.read_raw::<f64>().map_err(damaged)?;
        Ok(values.into_iter().map(|value| if fill.contains(&value) { f64::NAN } else { value }).collect())
    };

    let (time_name, variable) = find(Name::Exactly(time.name))?;
    let times = values(&time_name, &variable)?;
    let (unit, since) = match text_of(&variable, "units") {
        None => (None, None),
        Some(units) => {
            let (unit, base) =
                units.split_once(" since ").map_or((units.trim(), None), |(unit, base)| (unit, Some(base)));
            let base = base.map(|base| {
                let remedy = "write e.g. `seconds since 2015-08-13 00:00:00`";
                Start::of_calendar(base)
                    .ok_or_else(|| wrong(format!("`{time_name}` has the units \"{units}\""), remedy))
            });
            (Some(unit.trim().to_string()), base.transpose()?)
        }
    };
    let mut columns = Vec::new();
    for one in wanted {
        let (found, variable) = find(one.column)?;
        let column = values(&found, &variable)?;
        if column.len() != times.len() {
            let problem = format!("`{found}` has {} values, and `{time_name}` {}", column.len(), times.len());
            return Err(wrong(problem, "give one value for each time"));
        }
        let unit = one.unit.map(str::to_string).or_else(|| text_of(&variable, "units"));
        columns.push((found, column, unit));
    }

    let header = unit.as_ref().map_or_else(|| time_name.clone(), |unit| format!("{time_name} [{unit}]"));
    let mut text = cell(&header);
    columns.iter().for_each(|(name, ..)| text.extend([",", &cell(name)]));
    for (i, time) in times.iter().enumerate() {
        let _ = write!(text, "\n{time:?}");
        for (_, column, _) in &columns {
            let _ = if column[i].is_nan() { write!(text, ",") } else { write!(text, ",{:?}", column[i]) };
        }
    }
    let wanted: Vec<Wanted<'_>> = columns
        .iter()
        .zip(wanted)
        .map(|((name, _, unit), one)| Wanted { column: Name::Exactly(name), unit: unit.as_deref(), ..*one })
        .collect();
    let of_values = |error: DataError| match error.line {
        // The header is the first line, so value n is on line n + 1.
        Some(line) => DataError { line: None, problem: format!("{} (value {})", error.problem, line - 1), ..error },
        None => error,
    };
    let mut table =
        table::table(&name, text.as_bytes(), TimeColumn { name: &header, zone: None }, &wanted).map_err(of_values)?;
    if let (Some(base), Some(seconds)) = (since, unit.as_deref().and_then(super::unit::seconds_of)) {
        let kept = |i: &usize| columns.iter().any(|(_, column, _)| !column[*i].is_nan());
        let begin = (0..times.len()).filter(kept).map(|i| seconds(times[i])).fold(f64::INFINITY, f64::min);
        table.start = base.after(begin);
    }
    Ok(table)
}

/// A name as a quoted cell of CSV.
fn cell(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

/// A text attribute, whichever of the HDF5 string types it has.
fn text_of(variable: &Dataset, name: &str) -> Option<String> {
    let attribute = variable.attr(name).ok()?;
    let read = attribute.read_scalar::<VarLenUnicode>().map(|text| text.to_string());
    let read = read.or_else(|_| attribute.read_scalar::<VarLenAscii>().map(|text| text.to_string()));
    let read = read.or_else(|_| attribute.read_scalar::<FixedAscii<256>>().map(|text| text.to_string()));
    read.or_else(|_| attribute.read_scalar::<FixedUnicode<256>>().map(|text| text.to_string())).ok()
}
