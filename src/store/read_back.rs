//! Comparing a file, once it is opened anew, with what was to be written to it.

use super::failure::WriteFailure;
use super::ledger::{Ledger, Sum};
use super::rows::some_rows;
use super::variable::read_attribute;
use crate::dataset::ElementType;
use hdf5::{Dataset, File, Location};
use std::ops::Range;
use std::path::Path;

/// Number of values that are read at a time.
const PIECE: usize = 1 << 17;

/// Compare everything in a ledger with the file at `path`. The first difference is a failure.
pub(super) fn compare(ledger: &Ledger, path: &Path) -> Result<(), WriteFailure> {
    let file = File::open(path)?;
    let lost = |name: &str| Err(WriteFailure { cause: format!("{name} was not written as it is"), full: false });
    for (name, sum) in ledger.variables() {
        let dataset = file.dataset(name)?;
        if sum_of(&dataset, sum.kind)? != *sum || !attributes_are_in(ledger, name, &dataset)? {
            return lost(name);
        }
    }
    if attributes_are_in(ledger, "", &file)? { Ok(()) } else { lost("an attribute of the file") }
}

/// Whether all attributes of a variable, or of the file, have their values.
fn attributes_are_in(ledger: &Ledger, variable: &str, location: &Location) -> hdf5::Result<bool> {
    for (name, value) in ledger.attributes(variable) {
        // Reals are compared as they are printed, because a missing value is equal to itself.
        let there = read_attribute(location, name)?;
        if there.is_none_or(|there| format!("{there:?}") != format!("{value:?}")) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The sum of all values of a variable in a file.
pub(super) fn sum_of(dataset: &Dataset, kind: ElementType) -> hdf5::Result<Sum> {
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
