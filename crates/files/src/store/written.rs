//! What was written to a file, to be compared with it when it is finished.

use crate::saved::Against;
use crate::saved::checksum::checksum;
use stickslip::dataset::{ColumnView, Dataset, ElementType, Entry, Source, layout};

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

/// Everything that was written to a file: a data set, and the rows of single paths, of which only
/// checksums are kept, however many there are.
#[derive(Debug, Default)]
pub(super) struct Written {
    pub dataset: Dataset,
    pub rows: Vec<(Entry, Sum)>,
}

impl Written {
    /// Compare everything with a file. The first difference is an error.
    pub fn compare(&self, file: &dyn Source) -> Result<(), String> {
        let mut against = Against::of(file);
        against.with_layout = true;
        against.variables(&self.dataset)?;
        against.exempt(&layout::EVENT);
        for (entry, sum) in &self.rows {
            against.described(entry)?;
            if sum_of(file, &entry.name, sum)? != *sum {
                return Err(format!("{} was not written correctly", entry.name));
            }
        }
        against.finish(&self.dataset)?;
        match against.difference {
            Some(difference) => Err(format!("{difference} was not written correctly")),
            None => Ok(()),
        }
    }
}

/// The sum of all values of a variable in a file that must have this number of them.
fn sum_of(file: &dyn Source, name: &str, Sum { kind, values, .. }: &Sum) -> Result<Sum, String> {
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
