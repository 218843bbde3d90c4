//! Comparing a file, once it is opened anew, with what was to be written to it. Rows of single paths
//! are kept as checksums, however many there are.

use super::failure::WriteFailure;
use crate::dataset::{ColumnView, Dataset, ElementType, Entry, Source as _, layout};
use crate::saved::{Against, checksum};
use hdf5::File;
use std::path::Path;

/// Number of values that are read at a time.
const PIECE: usize = 1 << 17;

/// Number, type and checksum of the values of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sum {
    kind: ElementType,
    values: usize,
    checksum: u32,
}

impl Sum {
    /// The sum of no values of this type.
    pub fn of(kind: ElementType) -> Self {
        Sum {
            kind,
            values: 0,
            checksum: 0,
        }
    }

    /// Add values, which must have the type of this sum.
    pub fn add(&mut self, values: ColumnView) {
        self.values += values.len();
        let mut bytes = Vec::new();
        values.write(&mut bytes);
        self.checksum = checksum(self.checksum, &bytes);
    }
}

/// Everything that was written to a file: a data set, and variables without their values, of which
/// there are sums.
#[derive(Debug, Default)]
pub(super) struct Written {
    pub dataset: Dataset,
    pub rows: Vec<(Entry, Sum)>,
}

impl Written {
    /// Compare everything with the file at `path`. The first difference is a failure.
    pub fn compare(&self, path: &Path) -> Result<(), WriteFailure> {
        let file = File::open(path)?;
        let mut against = Against::of(&file);
        against.with_layout = true;
        let failed = |cause| WriteFailure { cause, full: false };
        against.variables(&self.dataset).map_err(failed)?;
        against.exempt(&layout::EVENT);
        for (entry, sum) in &self.rows {
            against.described(entry).map_err(failed)?;
            if sum_of(&file, &entry.name, sum).map_err(failed)? != *sum {
                return Err(failed(format!("{} was not written correctly", entry.name)));
            }
        }
        against.finish(&self.dataset).map_err(failed)?;
        match against.difference {
            Some(difference) => Err(failed(format!("{difference} was not written correctly"))),
            None => Ok(()),
        }
    }
}

/// The sum of all values of a variable in a file that must have this number of them.
fn sum_of(file: &File, name: &str, Sum { kind, values, .. }: &Sum) -> Result<Sum, String> {
    let mut sum = Sum::of(*kind);
    let rows = file.length(name)?.unwrap_or(0);
    let some = (PIECE / (values / rows.max(1)).max(1)).max(1);
    for start in (0..rows).step_by(some) {
        sum.add(
            file.rows(name, *kind, &(start..(start + some).min(rows)))?
                .values(),
        );
    }
    Ok(sum)
}
