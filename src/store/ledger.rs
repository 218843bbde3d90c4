//! What was to be written to a file, and the comparison with the file once it is opened anew.
//!
//! Values are kept as checksums, so that a ledger is small however large the file is.

use super::draft::Failure;
use super::rows::some_rows;
use super::variable::read_attribute;
use crate::dataset::{Attribute, Kind, Values};
use crate::saved::checksum;
use hdf5::{Dataset, File};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

/// Number of values that are read at a time.
const PIECE: usize = 1 << 17;

/// Number, type and checksum of the values of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sum {
    kind: Kind,
    values: usize,
    checksum: u32,
}

impl Sum {
    /// The sum of no values of this type.
    pub fn of(kind: Kind) -> Self {
        Sum { kind, values: 0, checksum: 0 }
    }

    /// Add values, which must have the type of this sum.
    pub fn add(&mut self, values: Values) {
        self.values += values.len();
        self.checksum = checksum_of(self.checksum, values);
    }
}

/// Everything that was written to one file.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    variables: BTreeMap<String, Sum>,
    /// The attributes by variable and name. Those of the file itself are under an empty name.
    attributes: BTreeMap<(String, String), Attribute>,
}

impl Ledger {
    /// Note the values of a variable.
    pub fn variable(&mut self, name: &str, sum: Sum) {
        self.variables.insert(name.to_owned(), sum);
    }

    /// Note an attribute of a variable, or of the file if `variable` is empty. It replaces an
    /// earlier value.
    pub fn attribute(&mut self, variable: &str, name: &str, value: Attribute) {
        self.attributes.insert((variable.to_owned(), name.to_owned()), value);
    }

    /// Compare everything with the file at `path`. The first difference is a failure.
    pub fn compare(&self, path: &Path) -> Result<(), Failure> {
        let file = File::open(path)?;
        let lost = |name: &str| Err(Failure { cause: format!("{name} was not written as it is"), full: false });
        for (name, sum) in &self.variables {
            let dataset = file.dataset(name)?;
            if sum_of(&dataset, sum.kind)? != *sum || !self.attributes_are_in(name, &dataset)? {
                return lost(name);
            }
        }
        if self.attributes_are_in("", &file)? { Ok(()) } else { lost("an attribute of the file") }
    }

    /// Whether all attributes of a variable, or of the file, have their values.
    fn attributes_are_in(&self, variable: &str, location: &hdf5::Location) -> hdf5::Result<bool> {
        let from = (variable.to_owned(), String::new());
        for ((_, name), value) in self.attributes.range(from..).take_while(|((of, _), _)| of == variable) {
            // Reals are compared as they are printed, because a missing value is equal to itself.
            let there = read_attribute(location, name)?;
            if there.is_none_or(|there| format!("{there:?}") != format!("{value:?}")) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// The sum of all values of a variable in a file.
pub(super) fn sum_of(dataset: &Dataset, kind: Kind) -> hdf5::Result<Sum> {
    let mut sum = Sum::of(kind);
    let shape = dataset.shape();
    let (rows, width) = match shape[..] {
        [] => (1, 1),
        [rows, ref others @ ..] => (rows, others.iter().product::<usize>().max(1)),
    };
    let some = (PIECE / width).max(1);
    let pieces = (0..rows).step_by(some).map(|start| -> Range<usize> { start..(start + some).min(rows) });
    for piece in pieces {
        sum.add(some_rows(dataset, kind, &piece)?.values());
    }
    Ok(sum)
}

/// The checksum of these values, continued from that of the values before them.
fn checksum_of(before: u32, values: Values) -> u32 {
    let bytes: Vec<u8> = match values {
        Values::F64(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        Values::U64(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        Values::U32(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        Values::I8(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        Values::U8(values) => return checksum(before, values),
        // A text of HDF5 cannot contain the byte that ends it.
        Values::Text(texts) => texts.iter().flat_map(|text| text.bytes().chain([0])).collect(),
    };
    checksum(before, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Destination as _;
    use crate::dataset::layout;
    use crate::stats::Units;
    use crate::store::draft::Draft;

    /// A file whose ledger says something else than was written cannot be finished.
    #[test]
    fn what_is_not_in_the_file_as_it_was_to_be_written_is_found() {
        let changes: [fn(&mut Ledger); 5] = [
            |_| (),
            |ledger| {
                ledger.variable("quantile", {
                    let mut sum = Sum::of(Kind::F64);
                    sum.add((&[0.5, 0.25]).into());
                    sum
                })
            },
            |ledger| ledger.variable("lost", Sum::of(Kind::F64)),
            |ledger| ledger.attribute("", "title", "another".into()),
            |ledger| ledger.attribute("quantile", "long_name", "another".into()),
        ];
        for (i, change) in changes.into_iter().enumerate() {
            let here = tempfile::tempdir().expect("a folder");
            let path = here.path().join("a.h5");
            let mut draft = Draft::create(&path, Units::default()).expect("made");
            let written = draft.write(|place| {
                place.set_attribute("title", "a title")?;
                place.write_variable(&layout::QUANTILE, &[0.25, 0.5])?;
                change(&mut place.ledger);
                Ok(())
            });
            written.expect("written");
            assert_eq!(draft.finish().is_ok(), i == 0, "change {i}");
        }
    }
}
