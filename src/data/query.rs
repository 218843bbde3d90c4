//! Which columns of a file are wanted.

use super::unit::ColumnQuantity;

/// The column of times.
#[derive(Clone, Copy, Debug)]
pub struct TimeColumn<'a> {
    /// Its name in the header.
    pub name: &'a str,
    /// The time zone of stamps that name none: an IANA name, or an offset such as `+01:00`.
    pub zone: Option<&'a str>,
}

/// A column of values.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    /// How the column is found.
    pub column: Name<'a>,
    /// What it measures, which decides the units that are allowed.
    pub quantity: ColumnQuantity,
    /// Its unit, if it is not the one that its name gives.
    pub unit: Option<&'a str>,
    /// The longest time allowed between two values, in the unit of the times; `None` for no limit.
    pub max_gap: Option<f64>,
}

impl<'a> Wanted<'a> {
    /// The temperatures in the column of this name, or, without a name, in the one whose name
    /// begins with `temperature`.
    pub fn temperature(column: Option<&'a str>) -> Self {
        Wanted {
            column: named(column, "temperature"),
            quantity: ColumnQuantity::Temperature,
            unit: None,
            max_gap: None,
        }
    }

    /// The displacements in the column of this name, or, without a name, in the one whose name
    /// begins with `displacement`.
    pub fn displacement(column: Option<&'a str>, unit: Option<&'a str>) -> Self {
        Wanted { column: named(column, "displacement"), quantity: ColumnQuantity::Displacement, unit, max_gap: None }
    }
}

fn named<'a>(name: Option<&'a str>, beginning: &'a str) -> Name<'a> {
    name.map_or(Name::Beginning(beginning), Name::Exactly)
}

/// How a column is found in the header.
#[derive(Clone, Copy, Debug)]
pub enum Name<'a> {
    /// The column of this name.
    Exactly(&'a str),
    /// The only column whose name begins with this text.
    Beginning(&'a str),
}

impl Name<'_> {
    /// What a message says of such a column.
    pub(super) fn description(&self) -> String {
        match self {
            Name::Exactly(name) => format!("is called `{name}`"),
            Name::Beginning(start) => format!("has a name that begins with `{start}`"),
        }
    }
}
