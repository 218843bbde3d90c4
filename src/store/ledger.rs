//! What was to be written to a file.
//!
//! Values are kept as checksums, so that a ledger is small however large the file is.

use crate::dataset::{Attribute, ColumnView, ElementType};
use crate::saved::checksum;
use std::collections::BTreeMap;

/// Number, type and checksum of the values of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sum {
    /// The type of the values.
    pub kind: ElementType,
    values: usize,
    checksum: u32,
}

impl Sum {
    /// The sum of no values of this type.
    pub fn of(kind: ElementType) -> Self {
        Sum { kind, values: 0, checksum: 0 }
    }

    /// Add values, which must have the type of this sum.
    pub fn add(&mut self, values: ColumnView) {
        self.values += values.len();
        let mut bytes = Vec::new();
        // A text of HDF5 cannot contain the byte that ends it.
        values.write(&mut bytes);
        self.checksum = checksum(self.checksum, &bytes);
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

    /// The variables with their sums.
    pub fn variables(&self) -> impl Iterator<Item = (&String, &Sum)> {
        self.variables.iter()
    }

    /// The attributes of a variable, or of the file.
    pub fn attributes<'a>(&'a self, variable: &'a str) -> impl Iterator<Item = (&'a String, &'a Attribute)> {
        let from = (variable.to_owned(), String::new());
        let of = self.attributes.range(from..).take_while(move |((of, _), _)| of == variable);
        of.map(|((_, name), value)| (name, value))
    }
}
