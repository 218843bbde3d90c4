//! A data set in memory.

use super::layout::Described;
use super::{Attribute, Column, ColumnView, Element, ElementType, Source, attributes_of};
use crate::stats::{Dimension, Units};
use ndarray::ArrayViewD;
use std::ops::Range;

/// A data set in memory, with the same variables and attributes as a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dataset {
    /// Attributes of the data set, by name.
    pub attributes: Vec<(String, Attribute)>,
    /// Variables. A coordinate comes before the variables that lie along it.
    pub entries: Vec<Entry>,
    units: Units,
}

/// A variable of a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Name of the variable. A variable with the name of its only axis is the coordinate of that
    /// dimension.
    pub name: String,
    /// Names of the dimensions, the slowest first.
    pub axes: Vec<String>,
    /// Attributes of the variable, by name.
    pub attributes: Vec<(String, Attribute)>,
    /// Values, the last axis fastest.
    pub column: Column,
}

impl Entry {
    /// Whether the variable gives a dimension its name and length.
    pub fn is_coordinate(&self) -> bool {
        self.axes == [self.name.as_str()]
    }
}

impl Dataset {
    /// An empty data set whose units have these labels.
    pub fn new(units: &Units) -> Self {
        Dataset {
            units: units.clone(),
            ..Dataset::default()
        }
    }

    /// A data set from its attributes and variables.
    pub fn of(attributes: Vec<(String, Attribute)>, entries: Vec<Entry>) -> Self {
        Dataset {
            attributes,
            entries,
            ..Dataset::default()
        }
    }

    /// Write a variable. A variable without values is left out, and so is its dimension.
    pub fn write<T: Element>(&mut self, variable: &Described, values: &[T]) {
        if !values.is_empty() {
            self.begin(variable, T::values(values));
        }
    }

    /// Write the units of these dimensions.
    pub(super) fn write_units(
        &mut self,
        variable: &Described,
        dimensions: impl Iterator<Item = Dimension>,
    ) {
        let units: Vec<String> = dimensions
            .map(|dimension| dimension.udunits(&self.units))
            .collect();
        self.write(variable, &units);
    }

    /// Set an attribute of the data set. It replaces an earlier value.
    pub fn set_attribute(&mut self, name: &str, value: impl Into<Attribute>) {
        let value = value.into();
        match self.attributes.iter_mut().find(|(of, _)| of == name) {
            Some((_, earlier)) => *earlier = value,
            None => self.attributes.push((name.to_owned(), value)),
        }
    }

    /// The variable with this name, if there is one.
    pub fn entry(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.name == name)
    }

    /// The attribute of the data set with this name, if there is one.
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes
            .iter()
            .find(|(of, _)| of == name)
            .map(|(_, value)| value)
    }

    /// The lengths of the axes of a variable. A dimension without a coordinate, which is that of
    /// events, has the length of its variables.
    pub fn shape(&self, entry: &Entry) -> Vec<usize> {
        let known = |axis: &String| self.entry(axis).map(|coordinate| coordinate.column.len());
        let lengths: Vec<Option<usize>> = entry.axes.iter().map(known).collect();
        let others: usize = lengths.iter().flatten().product();
        lengths
            .into_iter()
            .map(|length| length.unwrap_or(entry.column.len().checked_div(others).unwrap_or(0)))
            .collect()
    }

    /// The values of a variable of this type as an array with the shape of its axes. Nothing is
    /// copied. `None` if there is no such variable, or if its values have another type.
    pub fn array<'a, T>(&'a self, name: &str) -> Option<ArrayViewD<'a, T>>
    where
        &'a [T]: TryFrom<&'a Column>,
    {
        let entry = self.entry(name)?;
        let values = <&[T]>::try_from(&entry.column).ok()?;
        ArrayViewD::from_shape(self.shape(entry), values).ok()
    }

    /// Write a variable, which may have no values yet.
    pub(super) fn begin(&mut self, variable: &Described, values: ColumnView) {
        let attributes = attributes_of(variable, &self.units);
        let axes = variable.axes.iter().map(|axis| axis.to_string()).collect();
        self.entries.push(Entry {
            name: variable.name.into(),
            axes,
            attributes,
            column: values.to_column(),
        });
    }
}

impl Source for Dataset {
    fn names(&self) -> Result<Vec<String>, String> {
        Ok(self
            .entries
            .iter()
            .map(|entry| entry.name.clone())
            .collect())
    }

    fn has(&self, name: &str) -> bool {
        self.entry(name).is_some()
    }

    fn column(&self, variable: &Described, _: ElementType) -> Result<Option<Column>, String> {
        let Some(entry) = self.entry(variable.name) else {
            return Ok(None);
        };
        let known = |axis: &&str| self.entry(axis).map(|coordinate| coordinate.column.len());
        match variable.axes.iter().map(known).product::<Option<usize>>() {
            Some(length) if length == entry.column.len() => Ok(Some(entry.column.clone())),
            Some(_) => Err(format!(
                "the shape of {} differs from its axes",
                variable.name
            )),
            None => Err(format!("{} has values but no coordinate", variable.name)),
        }
    }

    fn rows(&self, name: &str, _: ElementType, rows: &Range<usize>) -> Result<Column, String> {
        let entry = self
            .entry(name)
            .ok_or_else(|| format!("{name} is missing"))?;
        let width = self.shape(entry).iter().skip(1).product::<usize>();
        entry
            .column
            .slice(rows.start * width..rows.end * width)
            .ok_or_else(|| format!("{name} is too short"))
    }

    fn length(&self, variable: &str) -> Result<Option<usize>, String> {
        Ok(self
            .entry(variable)
            .map(|entry| self.shape(entry).first().copied().unwrap_or(0)))
    }

    fn attribute(&self, variable: Option<&str>, name: &str) -> Result<Option<Attribute>, String> {
        let found = self
            .attributes(variable)?
            .into_iter()
            .find(|(of, _)| of == name);
        Ok(found.map(|(_, value)| value))
    }

    fn attributes(&self, variable: Option<&str>) -> Result<Vec<(String, Attribute)>, String> {
        let of_entry = |variable| self.entry(variable).map(|entry| &entry.attributes);
        Ok(variable
            .map_or(Some(&self.attributes), of_entry)
            .cloned()
            .unwrap_or_default())
    }

    fn is_laid_out_anew(&self) -> bool {
        true
    }
}
