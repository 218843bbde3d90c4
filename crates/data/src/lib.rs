//! Reading measured data: named columns of a CSV file, records of ground motion, or arrays. This is the only module that uses the crates `csv-core` and `jiff`.
//!
//! ```text
//! encoding  the bytes of a file -> UTF-8
//! rows      the cells of one row after the other: separators, quotes, comments
//! header    the line that names the columns, and which of them are wanted
//! unit      the unit that the name of a column gives
//! stamp     a date and a time of day, as loggers and spreadsheets write them
//! parts     a time in several columns -> one stamp
//! orders    the order of day, month and year, inferred from all dates together
//! clock     a cell of the time column -> seconds: stamps, zones, dates as numbers, numbers
//! decimals  whether a comma is decimal
//! labels    columns that distinguish several series in one file
//! marks     which cells hold no value
//! outliers  values that stand out from the others
//! column    the samples of one column, checked, sorted and repaired
//! repairs   what was repaired and assumed, in sentences
//! table     the rows in order of time: a Table
//! at2       a record with a constant step as a Table: ground acceleration, or plain values
//! arrays    measurements in memory, with the same checks and repairs
//! pair      temperatures and displacements of a bearing on one time axis, from one file or two
//! span      "6h" as seconds
//! query     which columns are wanted, and how a file is laid out
//! error     what is wrong with a file, and where
//! ```
//!
//! Repairs are counted ([`Repairs`]): rows out of order are sorted, cells without a value are left
//! out, and a repeated row is used once. Anything ambiguous is an error with its line. Inputs are
//! not repaired: their rows and values must be valid.

mod arrays;
mod at2;
mod clock;
mod column;
mod decimals;
#[cfg(test)]
mod defect_tests;
#[cfg(test)]
mod dialect_tests;
mod encoding;
mod error;
mod header;
mod labels;
#[cfg(test)]
mod logger_tests;
mod marks;
mod orders;
mod outliers;
mod pair;
mod parts;
mod query;
mod repairs;
mod rows;
mod span;
mod stamp;
mod table;
#[cfg(test)]
mod tests;
mod unit;

pub use arrays::{Array, arrays};
pub use clock::Start;
pub use column::{DataColumn, absurd, is_constant, remedy};
pub use error::DataError;
pub use outliers::{median, resolution, spread};
pub use pair::{BearingData, ColumnSource, Origin};
pub use query::{DateOrder, Layout, Name, Wanted, Wording};
pub use repairs::{ColumnRepairs, Repairs};
pub use span::seconds;
pub use table::Table;
pub use unit::{ColumnQuantity, input_unit};

use std::io::Read as _;
use std::path::Path;

/// Largest file, in bytes; a usual file of this size has 2 10^7 rows.
const MAX_FILE: u64 = 1 << 30;

/// Read columns of a CSV file in one pass. Fails with a [`DataError`] that names the file, the place
/// and the remedy.
pub fn read(path: &Path, layout: &Layout, wanted: &[Wanted<'_>]) -> Result<Table, DataError> {
    let name = path.display().to_string();
    let unreadable = |problem: &str, remedy: &str| DataError::file(&name, problem, remedy);
    if path.is_dir() {
        return Err(unreadable(
            "it is a directory",
            "give the path of a CSV file",
        ));
    }
    let mut bytes = Vec::new();
    let mut fits = || -> std::io::Result<bool> {
        let file = std::fs::File::open(path)?;
        // The size of a regular file is checked before memory is allocated. The size of a pipe is
        // unknown.
        if file.metadata()?.len() > MAX_FILE {
            return Ok(false);
        }
        Ok(file.take(MAX_FILE + 1).read_to_end(&mut bytes)? as u64 <= MAX_FILE)
    };
    let fits = fits().map_err(|error| {
        unreadable(
            &format!("cannot be read: {error}"),
            "give the path of a CSV file",
        )
    })?;
    if !fits {
        return Err(unreadable(
            "it is larger than 1 GiB",
            "split it, or keep only the columns that are needed",
        ));
    }
    parse(&name, &bytes, layout, wanted)
}

/// Read columns of a CSV text; messages call it `name`.
///
/// ```
/// use stickslip_data::{ColumnQuantity, Layout, Wanted, parse};
///
/// let text = "time;temperature_degC\n2015-08-13 00:00;15,5\n2015-08-13 00:10;\n2015-08-13 00:20;14,8\n";
/// let layout = Layout { zone: Some("UTC".into()), ..Layout::default() };
/// let table = parse("t.csv", text.as_bytes(), &layout, &[Wanted::of(ColumnQuantity::Temperature, None, None)])?;
/// assert_eq!((&table.columns[0].times[..], &table.columns[0].values[..]), (&[0.0, 1200.0][..], &[15.5, 14.8][..]));
/// let repairs = ["left out 1 cell without a value in `temperature_degC`", "read 2 decimal commas"];
/// assert_eq!(table.repairs.sentences(), repairs);
/// # Ok::<(), stickslip_data::DataError>(())
/// ```
pub fn parse(
    name: &str,
    bytes: &[u8],
    layout: &Layout,
    wanted: &[Wanted<'_>],
) -> Result<Table, DataError> {
    let foreign = |what: &str, remedy| DataError::file(name, format!("it is {what}"), remedy);
    if bytes.starts_with(b"\x89HDF\r\n\x1a\n") {
        return Err(foreign(
            "an HDF5 file, not CSV",
            "write its variables as columns of a CSV file, or give them to the package for Python",
        ));
    }
    if bytes.starts_with(b"PK\x03\x04") {
        return Err(foreign(
            "a spreadsheet or another zip archive, not CSV",
            "export the sheet as CSV",
        ));
    }
    if bytes.starts_with(b"\x1f\x8b") {
        return Err(foreign(
            "compressed, not CSV",
            "decompress it, e.g. with gunzip",
        ));
    }
    let Some((text, encoding)) = encoding::decoded(bytes) else {
        return Err(foreign(
            "binary, or UTF-16 without a byte-order mark",
            "save it as CSV in UTF-8",
        ));
    };
    let is_input = wanted
        .iter()
        .all(|one| one.quantity == ColumnQuantity::Input);
    if let Some(format) = at2::other_format(&text).filter(|_| is_input && layout.step.is_none()) {
        let remedy =
            "convert it to CSV; the documentation page on records shows how, for each format";
        return Err(foreign(
            &format!("a record in the format of {format}"),
            remedy,
        ));
    }
    if let Some(record) = at2::record(name, &text, layout, wanted) {
        return record;
    }
    let is_numbered = is_input
        && layout
            .time
            .as_ref()
            .is_some_and(|time| time.parse::<u32>().is_ok());
    let text = if is_numbered {
        rows::with_tabs(text)
    } else {
        text
    };
    let (rows, header) = header::open(name, &text, layout, wanted).map_err(|not_found| {
        // What else must be given is reported at once.
        let more = not_found
            .likely
            .and_then(|(rows, header)| table::problem(name, &header, rows, layout, wanted));
        match more {
            Some(more) => not_found.error.and(more),
            None => not_found.error,
        }
    })?;
    let mut table = table::table(name, &header, rows, layout, wanted)?;
    table.repairs.encoding = encoding;
    Ok(table)
}
