//! A destination that compares a data set with one that is stored, instead of writing it.

use super::{Difference, Held, ReadError};
use crate::dataset::layout::Described;
use crate::dataset::{Attribute, ColumnView, Destination, ElementType, attributes_of, read_other_program};
use crate::stats::Units;
use crate::stats::column::FirstDifference;
use std::collections::{BTreeMap, BTreeSet};

/// Attributes that name the program. They are not compared, because a file of another program is
/// told apart before it is compared.
const OF_PROGRAM: [&str; 3] = ["program_version", "git_hash", "source"];

/// Attributes that another version may write otherwise although every number is the same: the
/// version of the format, and the text of the scenario.
const OF_FORMAT: [&str; 3] = ["Conventions", "format_version", "scenario"];

/// A data set that is stored, while another one is compared with it.
#[derive(Debug)]
pub(crate) struct Against<'a, H> {
    pub held: &'a H,
    units: Units,
    /// Names of the variables that were compared.
    seen: BTreeSet<String>,
    /// The attributes of the data set. A later value replaces an earlier one, so they are compared
    /// at the end.
    attributes: BTreeMap<String, Attribute>,
    /// Attributes that are not compared, because another program laid the data set out.
    laid_out: &'static [&'static str],
    values: u64,
    difference: Option<Difference>,
}

/// Attributes that say how a netCDF file is laid out. xarray gives a coordinate the first, and
/// keeps the second for itself.
const OF_LAYOUT: &[&str] = &["_FillValue", "coordinates"];

impl<'a, H: Held> Against<'a, H> {
    pub fn of(held: &'a H, units: Units) -> Self {
        let (seen, attributes) = Default::default();
        let laid_out = if held.is_laid_out_anew() { OF_LAYOUT } else { &[] };
        Against { held, units, seen, attributes, laid_out, values: 0, difference: None }
    }

    /// Number of values and texts that were compared so far.
    pub fn values(&self) -> u64 {
        self.values
    }

    /// Count values that were compared elsewhere.
    pub fn count(&mut self, values: usize) {
        self.values += values as u64;
    }

    /// The first difference that was found, if any.
    pub fn difference(&self) -> Option<&Difference> {
        self.difference.as_ref()
    }

    /// Keep a difference if it is the first one. Later differences often follow from the first.
    pub fn differ(&mut self, new: Difference) {
        self.difference.get_or_insert(new);
    }

    fn differs_at(&mut self, variable: &str, (index, stored, computed): FirstDifference) {
        self.differ(Difference { variable: variable.to_owned(), path: None, index, stored, computed });
    }

    /// Compare the attributes of a variable that is written elsewhere, or row by row.
    pub fn describe(&mut self, variable: &Described, kind: ElementType) -> Result<(), ReadError<H>> {
        self.seen.insert(variable.name.to_owned());
        if variable.is_bare_dimension() || !self.held.has(variable.name) {
            return Ok(());
        }
        let mut expected: BTreeMap<String, Attribute> = attributes_of(variable, &self.units)
            .into_iter()
            .map(|(name, attribute)| (name.to_owned(), attribute))
            .collect();
        if kind == ElementType::F64 && !variable.is_coordinate() {
            expected.insert("_FillValue".into(), Attribute::Real(f64::NAN));
        }
        self.compare_attributes(Some(variable.name), &expected, &[])
    }

    /// Compare the attributes of the data set, and see that nothing else is stored.
    pub fn finish(&mut self) -> Result<(), ReadError<H>> {
        let expected = std::mem::take(&mut self.attributes);
        let is_own = read_other_program(self.held)?.is_none();
        let left_out = if is_own { OF_PROGRAM.to_vec() } else { [&OF_PROGRAM[..], &OF_FORMAT[..]].concat() };
        self.compare_attributes(None, &expected, &left_out)?;
        let surplus = self.held.names()?.into_iter().find(|name| !self.seen.contains(name));
        if let Some(name) = surplus {
            self.differs_at(&name, (None, "there".into(), "missing".into()));
        }
        Ok(())
    }

    fn compare_attributes(
        &mut self,
        variable: Option<&str>,
        expected: &BTreeMap<String, Attribute>,
        left_out: &[&str],
    ) -> Result<(), ReadError<H>> {
        let there = self.held.attributes(variable)?;
        let names = there.keys().chain(expected.keys().filter(|name| !there.contains_key(*name)));
        let left_out = [left_out, self.laid_out].concat();
        for name in names.filter(|name| !left_out.contains(&name.as_str())) {
            self.values += 1;
            // Reals are compared as they are printed, which tells any two of them apart and takes
            // one NaN for another.
            let (stored, computed) = (there.get(name), expected.get(name));
            let [stored, computed] = lines_that_differ(stored, computed)
                .unwrap_or_else(|| [stored, computed].map(|attribute| attribute.map_or("missing".into(), shown)));
            if stored != computed {
                let name = variable.map_or_else(|| name.clone(), |variable| format!("{name} of {variable}"));
                self.differs_at(&name, (None, stored, computed));
            }
        }
        Ok(())
    }
}

/// The first lines that differ between two texts of several lines, such as a scenario.
fn lines_that_differ(stored: Option<&Attribute>, computed: Option<&Attribute>) -> Option<[String; 2]> {
    let (Attribute::Text(stored), Attribute::Text(computed)) = (stored?, computed?) else { return None };
    let (stored, computed) = stored.lines().zip(computed.lines()).find(|(stored, computed)| stored != computed)?;
    Some([format!("{stored:?}"), format!("{computed:?}")])
}

fn shown(attribute: &Attribute) -> String {
    match attribute {
        Attribute::Text(text) => format!("{text:?}"),
        Attribute::Real(value) => format!("{value:?}"),
        Attribute::Count(value) => value.to_string(),
        Attribute::Flags(values) => format!("{values:?}"),
    }
}

/// Compares each value with what is stored instead of writing it.
impl<H: Held> Destination for Against<'_, H> {
    type Error = ReadError<H>;

    fn units(&self) -> &Units {
        &self.units
    }

    fn write_variable<'a>(
        &mut self,
        variable: &Described,
        values: impl Into<ColumnView<'a>>,
    ) -> Result<(), ReadError<H>> {
        let values = values.into();
        if values.len() == 0 {
            return Ok(());
        }
        self.describe(variable, values.kind())?;
        self.count(values.len());
        let found = match self.held.column(variable, values.kind())? {
            Some(stored) => stored.values().first_difference(values),
            None => Some((None, "missing".into(), "there".into())),
        };
        if let Some(found) = found {
            self.differs_at(variable.name, found);
        }
        Ok(())
    }

    fn set_attribute(&mut self, name: &str, value: impl Into<Attribute>) -> Result<(), ReadError<H>> {
        self.attributes.insert(name.to_owned(), value.into());
        Ok(())
    }
}
