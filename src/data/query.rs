//! Which columns of a file are asked for.

use super::unit::Quantity;

/// The column that says when.
#[derive(Clone, Copy, Debug)]
pub struct TimeColumn<'a> {
    /// Its name in the header.
    pub name: &'a str,
    /// The zone of stamps that name none: an IANA name, or an offset such as `+01:00`.
    pub zone: Option<&'a str>,
}

/// A column of values.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    /// Which.
    pub column: Name<'a>,
    /// What it measures, which says what units there are.
    pub quantity: Quantity,
    /// Its unit, if it is not the one in its name.
    pub unit: Option<&'a str>,
    /// The longest time between two values, in the unit of the times; none for any.
    pub max_gap: Option<f64>,
}

impl<'a> Wanted<'a> {
    /// The temperatures in the column of this name, or else in the one whose name begins with
    /// `temperature`.
    pub fn temperature(column: Option<&'a str>) -> Self {
        Wanted { column: named(column, "temperature"), quantity: Quantity::Temperature, unit: None, max_gap: None }
    }

    /// The displacements in the column of this name, or else in the one whose name begins with
    /// `displacement`.
    pub fn displacement(column: Option<&'a str>, unit: Option<&'a str>) -> Self {
        Wanted { column: named(column, "displacement"), quantity: Quantity::Displacement, unit, max_gap: None }
    }
}

fn named<'a>(name: Option<&'a str>, beginning: &'a str) -> Name<'a> {
    name.map_or(Name::Beginning(beginning), Name::Exactly)
}

/// How a column is found in the header.
#[derive(Clone, Copy, Debug)]
pub enum Name<'a> {
    /// By this name.
    Exactly(&'a str),
    /// By how its name begins, as no other does.
    Beginning(&'a str),
}
