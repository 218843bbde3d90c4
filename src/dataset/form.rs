//! Where a data set is written and from where it is read back, be it a file or memory.

use super::layout::Described;
use super::{Column, ColumnView, Element, ElementType};
use crate::engine::other_program;
use crate::stats::Units;
use crate::stats::column::values_of;

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

impl From<String> for Attribute {
    fn from(text: String) -> Self {
        Attribute::Text(text)
    }
}

impl From<f64> for Attribute {
    fn from(number: f64) -> Self {
        Attribute::Real(number)
    }
}

impl From<u64> for Attribute {
    fn from(count: u64) -> Self {
        Attribute::Count(count)
    }
}

/// The attributes of a variable, in the order in which they are written.
pub(crate) fn attributes_of<'a>(variable: &Described<'a>, units: &Units) -> Vec<(&'a str, Attribute)> {
    let flags = (!variable.flags.is_empty()).then(|| ("flag_values", Attribute::Flags(variable.flags.to_vec())));
    let unit = variable.unit.label(units).map(|label| ("units", Attribute::Text(label)));
    let others = variable.attributes.iter().map(|&(name, value)| (name, Attribute::from(value)));
    [("long_name", Attribute::from(variable.long_name))].into_iter().chain(unit).chain(flags).chain(others).collect()
}

/// A value that is kept as an attribute of a data set.
pub(crate) trait AttributeValue: Sized {
    /// The attribute; none if it is left out.
    fn attribute(&self) -> Option<Attribute>;

    /// The value of an attribute of this name, or what is wrong with it.
    fn of(attribute: Option<Attribute>, name: &str) -> Result<Self, String>;
}

macro_rules! attribute_values {
    ($($type:ty, $kind:ident, $words:literal;)*) => {$(
        impl AttributeValue for $type {
            fn attribute(&self) -> Option<Attribute> {
                Some(Attribute::$kind(self.clone()))
            }

            fn of(attribute: Option<Attribute>, name: &str) -> Result<Self, String> {
                match attribute {
                    Some(Attribute::$kind(value)) => Ok(value),
                    Some(_) => Err(format!("{name} is no {}", $words)),
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
        attribute.map(|attribute| T::of(Some(attribute), name)).transpose()
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
pub(crate) fn texts<'a>(of: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    of.into_iter().map(str::to_owned).collect()
}

/// The columns of a table with these rows.
pub(crate) fn columns_of<const N: usize>(rows: impl IntoIterator<Item = [f64; N]>) -> [Vec<f64>; N] {
    let mut columns = [const { Vec::new() }; N];
    rows.into_iter().for_each(|row| columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value)));
    columns
}

/// Where a data set is written.
pub(crate) trait Destination {
    /// The error of writing.
    type Error;

    /// Labels of the units.
    fn units(&self) -> &Units;

    /// Write a variable. A variable without values is left out, and so is its dimension.
    fn write_variable<'a>(
        &mut self,
        variable: &Described,
        values: impl Into<ColumnView<'a>>,
    ) -> Result<(), Self::Error>;

    /// Set an attribute of the data set. It replaces an earlier value.
    fn set_attribute(&mut self, name: &str, value: impl Into<Attribute>) -> Result<(), Self::Error>;
}

/// Where a data set is read back from.
pub(crate) trait Source {
    /// The error of reading.
    type Error: From<String>;

    /// The values of a variable; none if there is no such variable.
    fn column(&self, variable: &Described, kind: ElementType) -> Result<Option<Column>, Self::Error>;

    /// Whether there is a variable of this name.
    fn has(&self, name: &str) -> bool;

    /// An attribute of the data set, or of one of its variables; none if there is no such
    /// attribute.
    fn attribute(&self, variable: Option<&str>, name: &str) -> Result<Option<Attribute>, Self::Error>;
}

/// Read an attribute of a data set.
pub(crate) fn read_attribute<S: Source, T: AttributeValue>(from: &S, name: &str) -> Result<T, S::Error> {
    Ok(T::of(from.attribute(None, name)?, name)?)
}

/// Read an attribute of a variable.
pub(crate) fn read_attribute_of<S: Source, T: AttributeValue>(
    from: &S,
    variable: &str,
    name: &str,
) -> Result<T, S::Error> {
    let attribute: Option<T> = AttributeValue::of(from.attribute(Some(variable), name)?, name)?;
    attribute.ok_or_else(|| format!("{name} of {variable} is missing").into())
}

/// The program that wrote the data set, if it was another one.
pub(crate) fn read_other_program<S: Source>(from: &S) -> Result<Option<String>, S::Error> {
    let [version, hash]: [Result<String, _>; 2] =
        ["program_version", "git_hash"].map(|name| read_attribute(from, name));
    Ok(other_program(&version?, &hash?))
}

/// Read a variable. A variable that is left out because one of its dimensions has no length gives
/// an empty list. Any other absent variable is an error.
pub(crate) fn read_or_empty<S: Source, T: Element>(from: &S, variable: &Described) -> Result<Vec<T>, S::Error> {
    match from.column(variable, T::KIND)? {
        Some(column) => Ok(values_of(variable, column)?),
        None if variable.axes.iter().all(|axis| *axis != variable.name && from.has(axis)) => {
            Err(format!("{} is missing", variable.name).into())
        }
        None => Ok(Vec::new()),
    }
}

/// Read a variable that must be present and have values.
pub(crate) fn read_variable<S: Source, T: Element>(from: &S, variable: &Described) -> Result<Vec<T>, S::Error> {
    match read_or_empty(from, variable)? {
        values if values.is_empty() => Err(format!("{} is missing", variable.name).into()),
        values => Ok(values),
    }
}

/// Read a variable that must have a single value.
pub(crate) fn read_scalar<S: Source, T: Element>(from: &S, variable: &Described) -> Result<T, S::Error> {
    match read_variable::<S, T>(from, variable)?.as_slice() {
        [value] => Ok(value.clone()),
        values => Err(format!("{} has {} values, not one", variable.name, values.len()).into()),
    }
}
