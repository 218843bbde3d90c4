//! Comparing a finished file with what its scenario gives when it is simulated again.
//!
//! [`Verification`] takes the place of the writer: every value that would be written is compared
//! with the one in the file.

use super::error::cause;
use super::reader::{check_file, open};
use super::rows::column;
use super::{StoreError, seal};
use crate::dataset::layout::{self, Described, Variable};
use crate::dataset::read_text;
use crate::dataset::rows::{self, Along, Table};
use crate::dataset::{Attribute, Column, Destination, Kind, Rows, Source as _, Values, run};
use crate::engine::Status;
use crate::provenance::Provenance;
use crate::scenario::Bearing;
use crate::stats::{BlockResult, Summary, Units};
use hdf5::{File, Result};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The first value in a file that differs from the simulation of its scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The variable or attribute of the file.
    pub variable: String,
    /// The number of the path, if the variable holds rows of single paths.
    pub path: Option<u64>,
    /// The index of the value, from 0, among the values of the path or else of the variable.
    pub index: usize,
    /// The value in the file.
    pub stored: String,
    /// The value that the simulation gives.
    pub computed: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Difference { variable, path, index, stored, computed } = self;
        match path {
            Some(path) if *index > 0 => write!(f, "path {path}: {variable}, value {index} of the path,")?,
            Some(path) => write!(f, "path {path}: {variable}")?,
            None => write!(f, "{variable}, value {index},")?,
        }
        write!(f, " is {stored} in the file, and {computed} when it is simulated again")
    }
}

/// The result of checking a file against its checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sealed {
    /// Size of the file in bytes.
    pub bytes: u64,
    /// Whether the file has a checksum, which is then right. It has none if another program has
    /// changed the file.
    pub has_checksum: bool,
}

/// Check all bytes of a file against its checksum, however large the file is. A wrong checksum is
/// an error.
pub fn check_bytes(path: &Path) -> std::result::Result<Sealed, StoreError> {
    check_file(path)?;
    let has_checksum = seal::check_all(path)?;
    let there = std::fs::metadata(path).map_err(|source| StoreError::NotOpened { path: path.to_owned(), source })?;
    Ok(Sealed { bytes: there.len(), has_checksum })
}

/// Attributes that may differ although every number is the same: the program that wrote the file,
/// the text of its scenario, and how far the run went.
const NOT_COMPARED: [&str; 8] = [
    "Conventions",
    "format_version",
    "program_version",
    "git_hash",
    "generator",
    "status",
    "completed_paths",
    "scenario",
];

/// A finished file of a run while it is compared with a simulation of its scenario.
#[derive(Debug)]
pub struct Verification {
    path: PathBuf,
    file: File,
    /// The number of the first path in the file.
    origin: u64,
    bearing: Option<Bearing>,
    units: Units,
    /// The first path whose events are not counted yet, and the number of events before it.
    counted: (u64, usize),
    /// Names of the variables that were compared.
    seen: Vec<String>,
    values: u64,
    difference: Option<Difference>,
}

impl Verification {
    /// Open the file at `path`, whose first path is number `origin`, of a run with this header.
    pub fn open(path: &Path, origin: u64, header: &Provenance) -> std::result::Result<Self, StoreError> {
        Ok(Verification {
            path: path.to_owned(),
            file: open(path)?,
            origin,
            bearing: header.bearing,
            units: header.units.clone(),
            counted: (origin, 0),
            seen: Vec::new(),
            values: 0,
            difference: None,
        })
    }

    /// Number of values and texts that were compared so far.
    pub fn values(&self) -> u64 {
        self.values
    }

    /// The first difference that was found, if any.
    pub fn difference(&self) -> Option<&Difference> {
        self.difference.as_ref()
    }

    /// Compare the rows in the file with those of a block that was simulated again. Blocks must be
    /// given in ascending order.
    pub fn block(&mut self, block: &BlockResult) -> std::result::Result<(), StoreError> {
        let compared = rows::tables(&Rows::from(block), self.bearing, |table| self.table(block, &table));
        compared.map_err(|error| self.damaged(&error))
    }

    /// Compare the attributes and coordinates of the file, and all statistics if they were computed
    /// again.
    pub fn rest(&mut self, header: &Provenance, again: Option<&Summary>) -> std::result::Result<(), StoreError> {
        let mut compare = || -> Result<()> {
            run::write_start(self, header)?;
            let Some(summary) = again else { return Ok(()) };
            run::write_end(self, summary, Status::Complete)?;
            let is_known = |name: &String| self.seen.contains(name) || is_of_paths(name);
            let surplus = self.file.member_names()?.into_iter().find(|name| !is_known(name));
            if let Some(name) = surplus {
                self.differ(&name, None, (0, "there".into(), "missing".into()));
            }
            Ok(())
        };
        compare().map_err(|error| self.damaged(&error))
    }

    fn damaged(&self, error: &hdf5::Error) -> StoreError {
        StoreError::Damaged { path: self.path.clone(), cause: cause(error) }
    }

    /// Keep a difference if it is the first one. Later differences often follow from the first.
    fn differ(&mut self, variable: &str, path: Option<u64>, (index, stored, computed): FirstDifference) {
        let new = Difference { variable: variable.to_owned(), path, index, stored, computed };
        self.difference.get_or_insert(new);
    }

    /// Compare the rows of a block along one dimension.
    fn table(&mut self, block: &BlockResult, table: &Table) -> Result<()> {
        if self.difference.is_some() {
            return Ok(());
        }
        let first = (block.first_path - self.origin) as usize;
        let counts = block.events.as_ref().map_or(&[][..], |events| &events.count);
        let rows = match table.along {
            Along::Path | Along::Trajectory => first..first + table.rows,
            Along::Event => {
                let start = self.events_before(block.first_path)?;
                self.counted = (block.first_path + block.paths, start + table.rows);
                start..start + table.rows
            }
        };
        for (variable, values) in table.variables {
            let Some((at, stored, computed)) = self.held(variable, *values, &rows)? else { continue };
            let width = values.len() / table.rows;
            let (row, within) = (at / width, at % width);
            let (path, index) = match table.along {
                Along::Path | Along::Trajectory => (row, within),
                Along::Event => path_of(counts, row),
            };
            self.differ(variable.name, Some(block.first_path + path as u64), (index, stored, computed));
            return Ok(());
        }
        Ok(())
    }

    /// Compare some rows of a variable; returns the first difference.
    fn held(&mut self, variable: &Variable, values: Values, rows: &Range<usize>) -> Result<Option<FirstDifference>> {
        if rows.is_empty() {
            return Ok(None);
        }
        self.values += values.len() as u64;
        let file = &self.file;
        let stored = match values {
            Values::F64(_) => Column::F64(column(file, variable, rows)?),
            Values::U64(_) => Column::U64(column(file, variable, rows)?),
            Values::U32(_) => Column::U32(column(file, variable, rows)?),
            Values::I8(_) => Column::I8(column(file, variable, rows)?),
            Values::U8(_) => Column::U8(column(file, variable, rows)?),
            Values::Text(_) => return Err("no rows are texts".into()),
        };
        Ok(first_difference(&stored, values))
    }

    /// The number of events of all paths before this one, according to the file.
    fn events_before(&mut self, path: u64) -> Result<usize> {
        let (mut next, mut events) = self.counted;
        while next < path {
            let some = next..path.min(next + 65_536);
            let rows = (some.start - self.origin) as usize..(some.end - self.origin) as usize;
            let counts: Vec<u32> = column(&self.file, &layout::EVENT_COUNT, &rows)?;
            events += counts.iter().map(|&count| count as usize).sum::<usize>();
            next = some.end;
        }
        Ok(events)
    }
}

/// The path, counted from the first of the block, and the event of that path that a row of events
/// belongs to.
fn path_of(counts: &[u32], row: usize) -> (usize, usize) {
    let mut left = row;
    for (path, &count) in counts.iter().enumerate() {
        match left.checked_sub(count as usize) {
            Some(rest) => left = rest,
            None => return (path, left),
        }
    }
    (counts.len(), left)
}

/// Whether a variable holds rows of single paths or the state of a part. These are not part of the
/// comparison of statistics.
fn is_of_paths(name: &str) -> bool {
    let tables = [layout::PATH, layout::EVENT, layout::TRAJECTORY, layout::PART_STATE];
    let prefixed = ["path_", "event_", "trajectory_"];
    tables.iter().any(|table| table.name == name) || prefixed.iter().any(|prefix| name.starts_with(prefix))
}

/// Compares each value with the file instead of writing it.
impl Destination for Verification {
    type Error = hdf5::Error;

    fn units(&self) -> &Units {
        &self.units
    }

    fn write_variable<'a>(&mut self, variable: &Described, values: impl Into<Values<'a>>) -> Result<()> {
        let values = values.into();
        let kind = match values {
            Values::F64(_) => Kind::F64,
            Values::U64(_) => Kind::U64,
            Values::U32(_) => Kind::U32,
            Values::I8(_) => Kind::I8,
            Values::U8(_) => Kind::U8,
            Values::Text(_) => Kind::Text,
        };
        if values.len() == 0 {
            return Ok(());
        }
        self.seen.push(variable.name.to_owned());
        self.values += values.len() as u64;
        let stored = self.file.column(variable, kind)?;
        let found =
            stored.map_or(Some((0, "missing".into(), "there".into())), |stored| first_difference(&stored, values));
        if let Some(found) = found {
            self.differ(variable.name, None, found);
        }
        Ok(())
    }

    fn set_attribute(&mut self, name: &str, value: impl Into<Attribute>) -> Result<()> {
        if NOT_COMPARED.contains(&name) {
            return Ok(());
        }
        self.values += 1;
        let is_there = self.file.attr_names()?.iter().any(|there| there == name);
        let stored = |read: &dyn Fn() -> Result<String>| if is_there { read() } else { Ok("missing".into()) };
        let (stored, computed) = match value.into() {
            Attribute::Text(value) => {
                (stored(&|| Ok(format!("{:?}", read_text(&self.file, name)?)))?, format!("{value:?}"))
            }
            Attribute::Real(value) => {
                (stored(&|| Ok(format!("{:?}", self.file.attr(name)?.read_scalar::<f64>()?)))?, format!("{value:?}"))
            }
            Attribute::Count(value) => {
                (stored(&|| Ok(self.file.attr(name)?.read_scalar::<u64>()?.to_string()))?, value.to_string())
            }
            Attribute::Flags(_) => return Ok(()),
        };
        if stored != computed {
            self.differ(name, None, (0, stored, computed));
        }
        Ok(())
    }
}

/// The index of a difference, and the stored and the computed value as text.
type FirstDifference = (usize, String, String);

/// The first value that differs. Reals are compared bit for bit, except that all NaN are equal,
/// since NaN means a missing value.
fn first_difference(stored: &Column, computed: Values) -> Option<FirstDifference> {
    let same_real = |a: &f64, b: &f64| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
    match (stored, computed) {
        // `first` prints reals with `{:?}`, which gives enough digits to distinguish any two of
        // them.
        (Column::F64(stored), Values::F64(computed)) => first(stored, computed, same_real),
        (Column::U64(stored), Values::U64(computed)) => first(stored, computed, u64::eq),
        (Column::U32(stored), Values::U32(computed)) => first(stored, computed, u32::eq),
        (Column::I8(stored), Values::I8(computed)) => first(stored, computed, i8::eq),
        (Column::U8(stored), Values::U8(computed)) => first(stored, computed, u8::eq),
        (Column::Text(stored), Values::Text(computed)) => first(stored, computed, String::eq),
        _ => Some((0, "of another type".into(), "there".into())),
    }
}

fn first<T: fmt::Debug>(stored: &[T], computed: &[T], is_same: impl Fn(&T, &T) -> bool) -> Option<FirstDifference> {
    if stored.len() != computed.len() {
        return Some((0, format!("one of {} values", stored.len()), format!("one of {}", computed.len())));
    }
    let at = stored.iter().zip(computed).position(|(stored, computed)| !is_same(stored, computed))?;
    Some((at, format!("{:?}", stored[at]), format!("{:?}", computed[at])))
}
