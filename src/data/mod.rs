//! Reading measured data: named columns of a CSV file, or variables of an HDF5 file. This is the
//! only module that uses the crates `csv-core` and `jiff`.
//!
//! ```text
//! rows      bytes -> the header and one row after the other: separators, quotes, comments
//! unit      the unit that the name of a column gives
//! clock     a cell of the time column -> seconds: stamps, zones, numbers
//! table     the rows in order of time, checked and repaired: a Table
//! hdf5      variables of an HDF5 file as rows (feature `store`)
//! pair      temperatures and displacements of a bearing on one time axis, from one file or two
//! span      "6h" as seconds
//! query     which columns are wanted, and how they are read
//! error     what is wrong with a file, and where
//! ```
//!
//! Repairs are counted ([`Repairs`]): rows out of order are sorted, cells without a value are left
//! out, and a repeated row is used once. Anything that could be read in two ways is an error with
//! its line.

mod clock;
mod error;
#[cfg(feature = "store")]
mod hdf5;
mod pair;
mod query;
mod rows;
mod span;
mod table;
#[cfg(test)]
mod tests;
mod unit;

pub use clock::Start;
pub use error::{DataError, TableCell};
pub use pair::{BearingData, Origin};
pub use query::{Name, TimeColumn, Wanted};
pub use span::seconds;
pub use table::{DataColumn, Repairs, Table, absurd, is_constant};
pub use unit::ColumnQuantity;

use rows::CsvRows;
use std::io::Read as _;
use std::path::Path;

/// Largest file, in bytes; a usual file of this size has 2 10^7 rows.
const MAX_FILE: u64 = 1 << 30;

/// Read columns of a CSV file in one pass, or, with the feature `store`, variables of an HDF5 file
/// along one dimension. Fails with a [`DataError`] that names the file, the place and the remedy.
pub fn read(path: &Path, time: TimeColumn<'_>, wanted: &[Wanted<'_>]) -> Result<Table, DataError> {
    let name = path.display().to_string();
    let unreadable = |problem: String, remedy: &str| DataError::file(&name, problem, remedy);
    if path.is_dir() {
        return Err(unreadable("it is a directory".into(), "give the path of a CSV file"));
    }
    let mut bytes = Vec::new();
    let mut fits = || -> std::io::Result<bool> {
        let file = std::fs::File::open(path)?;
        // The size of a regular file is checked before memory is allocated. A pipe does not know
        // its size.
        if file.metadata()?.len() > MAX_FILE {
            return Ok(false);
        }
        Ok(file.take(MAX_FILE + 1).read_to_end(&mut bytes)? as u64 <= MAX_FILE)
    };
    let fits = fits().map_err(|error| unreadable(format!("cannot be read: {error}"), "give the path of a CSV file"))?;
    if !fits {
        return Err(unreadable("it is larger than 1 GiB".into(), "cut it, or keep only the columns that are needed"));
    }
    #[cfg(feature = "store")]
    if bytes.starts_with(hdf5::SIGNATURE) {
        return hdf5::read(path, time, wanted);
    }
    parse(&name, &bytes, time, wanted)
}

/// Read columns of a CSV text; messages call it `name`.
///
/// ```
/// use stick_slip::data::{ColumnQuantity, Name, TimeColumn, Wanted, parse};
///
/// let text = b"time;temperature_degC\n2015-08-13 00:00;15,5\n2015-08-13 00:10;\n2015-08-13 00:20;14,8\n";
/// let temperature =
///     Wanted { column: Name::Exactly("temperature_degC"), quantity: ColumnQuantity::Temperature, unit: None, max_gap: None };
/// let table = parse("t.csv", text, TimeColumn { name: "time", zone: Some("UTC") }, &[temperature])?;
/// assert_eq!((&table.columns[0].times[..], &table.columns[0].values[..]), (&[0.0, 1200.0][..], &[15.5, 14.8][..]));
/// let repairs = ["left out 1 cell without a value in `temperature_degC`", "read 2 decimal commas"];
/// assert_eq!(table.repairs.sentences(), repairs);
/// # Ok::<(), stick_slip::data::DataError>(())
/// ```
pub fn parse(name: &str, bytes: &[u8], time: TimeColumn<'_>, wanted: &[Wanted<'_>]) -> Result<Table, DataError> {
    let (rows, header) = CsvRows::open(name, bytes)?;
    table::table(name, &header, rows, time, wanted)
}
