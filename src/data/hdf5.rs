//! Variables of an HDF5 or netCDF-4 file, read as if they were the columns of a CSV file, so that
//! both formats have the same checks, repairs and errors.

use super::clock::Start;
use super::error::DataError;
use super::header::Header;
use super::query::{Layout, Name, Wanted};
use super::rows::Rows;
use super::table::{self, Table};
use super::unit;
use ::hdf5::types::{FixedAscii, FixedUnicode, FloatSize, IntSize, TypeDescriptor, VarLenAscii, VarLenUnicode};
use ::hdf5::{Dataset, File};
use std::path::Path;

/// The first bytes of an HDF5 file.
pub(super) const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Largest number of values in a variable, which bounds the memory. No measured record of a bearing
/// is longer.
const MOST: usize = 50_000_000;

/// The calendars of CF in which days since a date are those of the usual calendar.
const CALENDARS: [&str; 3] = ["standard", "gregorian", "proleptic_gregorian"];

/// An open file, with the names of its variables.
struct Container {
    /// Its path, as messages show it.
    path: String,
    file: File,
    names: Vec<String>,
}

/// A variable along one dimension. Values that are missing are NaN.
struct Variable {
    name: String,
    values: Vec<f64>,
    units: Option<String>,
    /// The calendar of dates.
    calendar: Option<String>,
}

/// The rows of a table whose columns are these. The times are the first of them.
struct ValueRows<'a> {
    columns: Vec<&'a [f64]>,
    /// Number of rows that were read.
    read: usize,
    /// The current row, as texts.
    cells: Vec<String>,
}

impl Rows for ValueRows<'_> {
    fn commas_are_decimal(&self) -> bool {
        false
    }

    fn rewind(&mut self) {
        self.read = 0;
    }

    fn next(&mut self) -> Result<bool, DataError> {
        let text = |(field, column): (usize, &&[f64])| match column.get(self.read)? {
            value if value.is_nan() && field > 0 => Some(String::new()),
            value => Some(format!("{value:?}")),
        };
        let cells: Option<Vec<String>> = self.columns.iter().enumerate().map(text).collect();
        let Some(cells) = cells else { return Ok(false) };
        self.cells = cells;
        self.read += 1;
        Ok(true)
    }

    fn cell(&self, field: usize) -> &[u8] {
        self.cells[field].as_bytes()
    }

    fn place(&self) -> u32 {
        self.read as u32
    }

    /// As in a file whose first line is the header.
    fn line(&self, place: u32) -> u64 {
        u64::from(place) + 1
    }
}

/// Read variables along one dimension, with one value for each time.
pub(super) fn read(path: &Path, layout: &Layout, wanted: &[Wanted<'_>]) -> Result<Table, DataError> {
    let container = Container::open(path)?;
    let times = container.variable(Name::Exactly(layout.time.as_deref().unwrap_or("time")))?;
    let (unit, since) = container.time_units(&times)?;
    let mut columns = Vec::new();
    for one in wanted {
        let found = container.variable(one.column)?;
        if found.values.len() != times.values.len() {
            let (name, count) = (&found.name, found.values.len());
            let problem = format!("`{name}` has {count} values, and `{}` {}", times.name, times.values.len());
            return Err(container.wrong(problem, "give one value for each time"));
        }
        columns.push(found);
    }
    let time_name = unit.map_or_else(|| times.name.clone(), |unit| format!("{} [{unit}]", times.name));
    let names: Vec<String> =
        std::iter::once(&time_name).chain(columns.iter().map(|column| &column.name)).cloned().collect();
    let header = Header { times: vec![0], values: (1..names.len()).collect(), names, skipped: 0 };
    let wanted: Vec<Wanted<'_>> = (columns.iter().zip(wanted))
        .map(|(column, one)| Wanted {
            column: Name::Exactly(&column.name),
            unit: one.unit.or(column.units.as_deref()),
            ..*one
        })
        .collect();
    let all = std::iter::once(&times).chain(&columns).map(|column| &column.values[..]).collect();
    let rows = ValueRows { columns: all, read: 0, cells: Vec::new() };
    let layout = Layout { missing: layout.missing.clone(), wording: layout.wording, ..Layout::default() };
    let mut table =
        table::table(&container.path, &header, rows, &layout, &wanted).map_err(|error| match error.line {
            // The header is the first line, so value n is on line n + 1.
            Some(line) => DataError { line: None, problem: format!("{} (value {})", error.problem, line - 1), ..error },
            None => error,
        })?;
    if let (Some(base), Some(seconds)) = (since, unit.and_then(unit::time)) {
        let kept = |i: &usize| columns.iter().any(|column| !column.values[*i].is_nan());
        let begin =
            (0..times.values.len()).filter(kept).map(|i| seconds.of(times.values[i])).fold(f64::INFINITY, f64::min);
        table.start = base.after(begin);
    }
    Ok(table)
}

impl Container {
    fn open(path: &Path) -> Result<Self, DataError> {
        let name = path.display().to_string();
        match File::open(path).and_then(|file| Ok((file.member_names()?, file))) {
            Ok((names, file)) => Ok(Container { path: name, file, names }),
            Err(error) => Err(damaged(&name, &error)),
        }
    }

    fn wrong(&self, problem: String, remedy: &str) -> DataError {
        DataError::file(&self.path, problem, remedy)
    }

    /// Find a variable, and read it.
    fn variable(&self, of: Name<'_>) -> Result<Variable, DataError> {
        let is = |name: &str| match of {
            Name::Exactly(exact) => name == exact,
            Name::Beginning(start) => name.starts_with(start),
        };
        let found: Vec<&String> = self.names.iter().filter(|name| is(name)).collect();
        let [name] = found[..] else {
            let what = of.description();
            let count = if found.is_empty() { "none" } else { "more than one" };
            let remedy = format!("name one of {}", self.names.join(", "));
            return Err(self.wrong(format!("{count} of its variables {what}"), &remedy));
        };
        let damaged = |error| damaged(&self.path, &error);
        let variable = self.file.dataset(name).map_err(damaged)?;
        if variable.ndim() != 1 || variable.size() > MOST {
            let problem = format!("`{name}` has the shape {:?}", variable.shape());
            return Err(self.wrong(problem, "give a variable with one value for each time, and no other dimension"));
        }
        if ["scale_factor", "add_offset"].iter().any(|of| variable.attr(of).is_ok()) {
            let problem = format!("`{name}` is packed (scale_factor, add_offset)");
            return Err(self.wrong(problem, "write it as plain numbers"));
        }
        let numbers = |of: &str| variable.attr(of).and_then(|found| found.read_raw::<f64>()).unwrap_or_default();
        let mut fills = numbers("_FillValue");
        if fills.is_empty() {
            fills.extend(default_fill(&variable));
        }
        fills.extend(numbers("missing_value"));
        let range = numbers("valid_range");
        let least = range.first().copied().or(numbers("valid_min").first().copied()).unwrap_or(f64::NEG_INFINITY);
        let most = range.get(1).copied().or(numbers("valid_max").first().copied()).unwrap_or(f64::INFINITY);
        let mut values = variable.read_raw::<f64>().map_err(damaged)?;
        let is_missing = |value: &f64| fills.contains(value) || !(least..=most).contains(value);
        values.iter_mut().filter(|value| is_missing(value)).for_each(|value| *value = f64::NAN);
        Ok(Variable {
            name: name.clone(),
            values,
            units: text_of(&variable, "units"),
            calendar: text_of(&variable, "calendar"),
        })
    }

    /// The unit of the times, and the instant from which they count, as far as their units say so.
    fn time_units<'t>(&self, times: &'t Variable) -> Result<(Option<&'t str>, Option<Start>), DataError> {
        let Some(units) = &times.units else { return Ok((None, None)) };
        let Some((unit, base)) = units.split_once(" since ") else { return Ok((Some(units.trim()), None)) };
        if let Some(calendar) = &times.calendar
            && !CALENDARS.contains(&calendar.to_lowercase().as_str())
        {
            let problem =
                format!("`{}` has the calendar \"{calendar}\", whose dates are not those of measurements", times.name);
            return Err(self.wrong(problem, "convert its times to the calendar \"standard\""));
        }
        let since = Start::of_calendar(base).ok_or_else(|| {
            let problem = format!("`{}` has the units \"{units}\"", times.name);
            self.wrong(problem, "write e.g. `seconds since 2015-08-13 00:00:00`")
        })?;
        Ok((Some(unit.trim()), Some(since)))
    }
}

/// The value that netCDF writes where nothing was written, if a variable has no `_FillValue`. There
/// is none for bytes.
fn default_fill(variable: &Dataset) -> Option<f64> {
    match variable.dtype().and_then(|kind| kind.to_descriptor()).ok()? {
        TypeDescriptor::Float(FloatSize::U4) => Some(f64::from(9.969_21e36_f32)),
        TypeDescriptor::Float(FloatSize::U8) => Some(9.969_209_968_386_869e36),
        TypeDescriptor::Integer(IntSize::U2) => Some(-32_767.0),
        TypeDescriptor::Integer(IntSize::U4) => Some(-2_147_483_647.0),
        TypeDescriptor::Integer(IntSize::U8) => Some(-9_223_372_036_854_775_806.0),
        TypeDescriptor::Unsigned(IntSize::U2) => Some(65_535.0),
        TypeDescriptor::Unsigned(IntSize::U4) => Some(4_294_967_295.0),
        TypeDescriptor::Unsigned(IntSize::U8) => Some(18_446_744_073_709_551_614.0),
        _ => None,
    }
}

fn damaged(path: &str, error: &::hdf5::Error) -> DataError {
    DataError::file(path, format!("cannot be read as HDF5: {error}"), "see that it is whole")
}

/// A text attribute, whichever of the HDF5 string types it has.
fn text_of(variable: &Dataset, name: &str) -> Option<String> {
    let attribute = variable.attr(name).ok()?;
    let read = attribute.read_scalar::<VarLenUnicode>().map(|text| text.to_string());
    let read = read.or_else(|_| attribute.read_scalar::<VarLenAscii>().map(|text| text.to_string()));
    let read = read.or_else(|_| attribute.read_scalar::<FixedAscii<256>>().map(|text| text.to_string()));
    read.or_else(|_| attribute.read_scalar::<FixedUnicode<256>>().map(|text| text.to_string())).ok()
}
