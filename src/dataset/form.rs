//! Attributes of a data set, and the sources from which it is read: a file or memory.

use super::layout::Described;
use super::{Column, Element, ElementType};
use crate::engine::Program;
use crate::stats::Units;
use crate::stats::column::values_of;
use std::ops::Range;

/// An attribute of a data set or of a variable.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// A text.
    Text(String),
    /// A real number.
    Real(f64),
    /// A count.
    Count(u64),
    /// Values of flags.
    Flags(Vec<i8>),
}

impl From<&str> for Attribute {
    fn from(text: &str) -> Self {
        Attribute::Text(text.to_owned())
    }
}

/// The attributes of a variable, in the order in which they are written.
pub fn attributes_of(variable: &Described, units: &Units) -> Vec<(String, Attribute)> {
    let flags = (!variable.flags.is_empty())
        .then(|| ("flag_values", Attribute::Flags(variable.flags.to_vec())));
    let unit = variable
        .unit
        .label(units)
        .map(|label| ("units", Attribute::Text(label)));
    let others = variable
        .attributes
        .iter()
        .map(|&(name, value)| (name, Attribute::from(value)));
    let all = [("long_name", Attribute::from(variable.long_name))]
        .into_iter()
        .chain(unit)
        .chain(flags)
        .chain(others);
    all.map(|(name, value)| (name.to_owned(), value)).collect()
}

/// A value stored as an attribute of a data set.
pub trait AttributeValue: Sized {
    /// The attribute; none if it is left out.
    fn attribute(&self) -> Option<Attribute>;

    /// The value of an attribute of this name, or the error in it.
    fn of(attribute: Option<Attribute>, name: &str) -> Result<Self, String>;
}

macro_rules! attribute_values {
    ($($type:ty, $kind:ident, $words:literal;)*) => {$(
        impl From<$type> for Attribute {
            fn from(value: $type) -> Self {
                Attribute::$kind(value)
            }
        }

        impl AttributeValue for $type {
            fn attribute(&self) -> Option<Attribute> {
                Some(Attribute::$kind(self.clone()))
            }

            fn of(attribute: Option<Attribute>, name: &str) -> Result<Self, String> {
                match attribute {
                    Some(Attribute::$kind(value)) => Ok(value),
                    Some(_) => Err(format!("{name} is not a {}", $words)),
                    None => Err(format!("{name} is missing")),
                }
            }
        }
    )*};
}

attribute_values! {
    String, Text, "text";
    f64, Real, "real number";
    u64, Count, "count";
}

impl<T: AttributeValue> AttributeValue for Option<T> {
    fn attribute(&self) -> Option<Attribute> {
        self.as_ref().and_then(T::attribute)
    }

    fn of(attribute: Option<Attribute>, name: &str) -> Result<Self, String> {
        attribute
            .map(|attribute| T::of(Some(attribute), name))
            .transpose()
    }
}

/// A flag, whose attribute is left out if it is not set.
impl AttributeValue for bool {
    fn attribute(&self) -> Option<Attribute> {
        self.then_some(Attribute::Count(1))
    }

    fn of(attribute: Option<Attribute>, _: &str) -> Result<Self, String> {
        Ok(attribute.is_some())
    }
}

/// Names as values of a variable.
pub fn texts<'a>(of: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    of.into_iter().map(str::to_owned).collect()
}

/// Numbers from this one on, as values of a variable.
pub fn counted(first: u32, count: usize) -> Vec<u32> {
    (first..).take(count).collect()
}

/// The columns of a table with these rows.
pub fn columns_of<const N: usize>(rows: impl IntoIterator<Item = [f64; N]>) -> [Vec<f64>; N] {
    let mut columns = [const { Vec::new() }; N];
    rows.into_iter().for_each(|row| {
        columns
            .iter_mut()
            .zip(row)
            .for_each(|(column, value)| column.push(value))
    });
    columns
}

/// A data set that is stored, in a file or in memory.
pub trait Source: Sync {
    /// The names of its variables.
    fn names(&self) -> Result<Vec<String>, String>;

    /// Whether there is a variable of this name.
    fn has(&self, name: &str) -> bool;

    /// The values of a variable; none if there is no such variable.
    fn column(&self, variable: &Described, kind: ElementType) -> Result<Option<Column>, String>;

    /// Some rows of a variable. Fewer rows than these are an error.
    fn rows(
        &self,
        variable: &str,
        kind: ElementType,
        rows: &Range<usize>,
    ) -> Result<Column, String>;

    /// The length of the first dimension of a variable; none if there is no such variable.
    fn length(&self, variable: &str) -> Result<Option<usize>, String>;

    /// An attribute of the data set, or of one of its variables; none if there is no such
    /// attribute.
    fn attribute(&self, variable: Option<&str>, name: &str) -> Result<Option<Attribute>, String>;

    /// The attributes of the data set, or of a variable, without those that only attach coordinates
    /// to variables.
    fn attributes(&self, variable: Option<&str>) -> Result<Vec<(String, Attribute)>, String>;

    /// Whether another program may have written it, without what only the layout needs.
    fn is_laid_out_anew(&self) -> bool;
}

/// Read an attribute of a data set.
pub fn read_attribute<T: AttributeValue>(from: &dyn Source, name: &str) -> Result<T, String> {
    T::of(from.attribute(None, name)?, name)
}

/// The program that wrote the data set, if it was a different one.
pub fn read_other_program(from: &dyn Source) -> Result<Option<String>, String> {
    let [version, hash]: [Result<String, _>; 2] =
        ["program_version", "git_hash"].map(|name| read_attribute(from, name));
    Ok(Program {
        version: version?,
        git_hash: hash?,
        ..Program::default()
    }
    .other())
}

/// Read a variable. A variable that is left out because one of its dimensions has no length gives
/// an empty list. Any other absent variable is an error.
pub fn read_or_empty<T: Element>(
    from: &dyn Source,
    variable: &Described,
) -> Result<Vec<T>, String> {
    match from.column(variable, T::KIND)? {
        Some(column) => values_of(variable, column),
        None if variable
            .axes
            .iter()
            .all(|axis| *axis != variable.name && from.has(axis)) =>
        {
            Err(format!("{} is missing", variable.name))
        }
        None => Ok(Vec::new()),
    }
}

/// Read a variable that must be present and have values.
pub fn read_variable<T: Element>(
    from: &dyn Source,
    variable: &Described,
) -> Result<Vec<T>, String> {
    match read_or_empty(from, variable)? {
        values if values.is_empty() => Err(format!("{} is missing", variable.name)),
        values => Ok(values),
    }
}

/// Read a variable that must have this number of values.
pub fn read_sized<T: Element>(
    from: &dyn Source,
    variable: &Described,
    length: usize,
) -> Result<Vec<T>, String> {
    let values = read_or_empty(from, variable)?;
    if values.len() == length {
        return Ok(values);
    }
    let (name, count) = (variable.name, values.len());
    Err(format!("{name} has {count} values, not {length}"))
}
