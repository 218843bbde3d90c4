//! Comparison of a data set with a stored one.

use super::Difference;
use std::collections::{BTreeMap, BTreeSet};
use stickslip::dataset::layout::{Described, Unit, variable};
use stickslip::dataset::rows::RowAxis;
use stickslip::dataset::{Attribute, Dataset, ElementType, Entry, Source, read_other_program};
use stickslip::stats::EVENT_COUNT;
use stickslip::stats::column::FirstDifference;

/// Attributes that may differ between programs or versions although every number is the same: names
/// of the program, the version of the format, and the text of the scenario.
const OF_PROGRAM: [&str; 6] = [
    "program_version",
    "git_hash",
    "source",
    "Conventions",
    "format_version",
    "scenario",
];

/// Attributes of the layout of a netCDF file. xarray adds the first to coordinates, and does not
/// pass on the second.
const OF_LAYOUT: [&str; 2] = ["_FillValue", "coordinates"];

/// A stored data set while another one is compared with it.
pub(crate) struct Against<'a> {
    pub held: &'a dyn Source,
    /// Names of the variables that were compared.
    seen: BTreeSet<String>,
    /// Whether attributes of the layout are compared: not if another program laid the data set out.
    pub with_layout: bool,
    /// Number of values and texts compared so far.
    pub values: u64,
    /// The first difference, if there is one.
    pub difference: Option<Difference>,
}

impl<'a> Against<'a> {
    pub fn of(held: &'a dyn Source) -> Self {
        let with_layout = !held.is_laid_out_anew();
        Against {
            held,
            seen: BTreeSet::new(),
            with_layout,
            values: 0,
            difference: None,
        }
    }

    /// Keep a difference if it is the first one. Later differences often follow from it.
    pub fn differs(
        &mut self,
        variable: &str,
        path: Option<u64>,
        (index, stored, computed): FirstDifference,
    ) {
        let difference = || Difference {
            variable: variable.to_owned(),
            path,
            index,
            stored,
            computed,
        };
        self.difference.get_or_insert_with(difference);
    }

    /// Compare all variables of a data set with those that are stored.
    pub fn variables(&mut self, expected: &Dataset) -> Result<(), String> {
        for entry in &expected.entries {
            self.described(entry)?;
            let values = entry.column.values();
            self.values += values.len() as u64;
            let axes: Vec<&str> = entry.axes.iter().map(String::as_str).collect();
            let stored = match RowAxis::of(entry) {
                None => {
                    let variable = variable(&entry.name, &axes, Unit::None, "");
                    self.held.column(&variable, values.kind())?
                }
                // The dimension of events has no coordinate that would give its length.
                Some(along) => {
                    let rows = expected.shape(entry)[0];
                    let lengths = [
                        self.held.length(&entry.name)?.unwrap_or(0),
                        self.held.length(along.axis())?.unwrap_or(rows),
                    ];
                    if let Some(there) = self.other_length(lengths, rows) {
                        let lengths = (format!("one of {there} rows"), format!("one of {rows}"));
                        self.differs(&entry.name, None, (None, lengths.0, lengths.1));
                        continue;
                    }
                    Some(self.held.rows(&entry.name, values.kind(), &(0..rows))?)
                }
            };
            let found = match stored {
                Some(stored) => stored.values().first_difference(values),
                None => Some((None, "missing".into(), "there".into())),
            };
            if let Some((at, stored, computed)) = found {
                let (path, index) = place(expected, entry, at);
                self.differs(&entry.name, path, (index, stored, computed));
            }
        }
        Ok(())
    }

    /// The length of a variable, or of its dimension, if it differs. Another program may have left
    /// out the length of a dimension without a variable.
    fn other_length(&self, [variable, dimension]: [usize; 2], rows: usize) -> Option<usize> {
        let is_left_out = dimension == 0 && self.held.is_laid_out_anew();
        let dimension = if is_left_out { rows } else { dimension };
        [variable, dimension]
            .into_iter()
            .find(|there| *there != rows)
    }

    /// Compare the attributes of a variable.
    pub fn described(&mut self, entry: &Entry) -> Result<(), String> {
        self.seen.insert(entry.name.clone());
        if !self.held.has(&entry.name) {
            return Ok(());
        }
        let mut expected = entry.attributes.clone();
        if entry.column.values().kind() == ElementType::F64 && !entry.is_coordinate() {
            expected.push(("_FillValue".into(), Attribute::Real(f64::NAN)));
        }
        self.attributes(Some(&entry.name), &expected, &[])
    }

    /// Check that a variable is stored, by name only.
    pub fn exempt(&mut self, variable: &Described) {
        self.seen.insert(variable.name.to_owned());
    }

    /// Compare the attributes of the data set, and check that nothing else is stored.
    pub fn finish(&mut self, expected: &Dataset) -> Result<(), String> {
        let is_own = read_other_program(self.held)?.is_none();
        self.attributes(
            None,
            &expected.attributes,
            if is_own { &[] } else { &OF_PROGRAM },
        )?;
        let surplus = self
            .held
            .names()?
            .into_iter()
            .find(|name| !self.seen.contains(name));
        surplus
            .into_iter()
            .for_each(|name| self.differs(&name, None, (None, "there".into(), "missing".into())));
        Ok(())
    }

    fn attributes(
        &mut self,
        variable: Option<&str>,
        expected: &[(String, Attribute)],
        left_out: &[&str],
    ) -> Result<(), String> {
        let (there, expected): (BTreeMap<_, _>, BTreeMap<_, _>) = (
            self.held.attributes(variable)?.into_iter().collect(),
            expected.iter().cloned().collect(),
        );
        let names = there
            .keys()
            .chain(expected.keys().filter(|name| !there.contains_key(*name)));
        let left_out = [left_out, if self.with_layout { &[] } else { &OF_LAYOUT }].concat();
        for name in names.filter(|name| !left_out.contains(&name.as_str())) {
            self.values += 1;
            // Reals are compared as they are printed, which distinguishes any two of them except
            // NaNs.
            let (stored, computed) = (there.get(name), expected.get(name));
            let [stored, computed] = lines_that_differ(stored, computed).unwrap_or_else(|| {
                [stored, computed].map(|attribute| attribute.map_or("missing".into(), shown))
            });
            if stored != computed {
                let name = variable
                    .map_or_else(|| name.clone(), |variable| format!("{name} of {variable}"));
                self.differs(&name, None, (None, stored, computed));
            }
        }
        Ok(())
    }
}

/// The path of a value of a variable, if it belongs to a single path, and its index there.
fn place(dataset: &Dataset, entry: &Entry, at: Option<usize>) -> (Option<u64>, Option<usize>) {
    let (Some(along), Some(at)) = (RowAxis::of(entry), at) else {
        return (None, at);
    };
    let width: usize = dataset.shape(entry)[1..].iter().product();
    let (mut path, mut index) = (at / width, at % width);
    if along == RowAxis::Event
        && let Some(counts) = dataset.array::<u32>(EVENT_COUNT.name)
    {
        (path, index) = (0, at);
        for count in counts {
            match index.checked_sub(*count as usize) {
                Some(rest) => (path, index) = (path + 1, rest),
                None => break,
            }
        }
    }
    (Some(path as u64), Some(index))
}

/// The first lines that differ between two texts of several lines, such as a scenario.
fn lines_that_differ(
    stored: Option<&Attribute>,
    computed: Option<&Attribute>,
) -> Option<[String; 2]> {
    let (Attribute::Text(stored), Attribute::Text(computed)) = (stored?, computed?) else {
        return None;
    };
    let (stored, computed) = stored
        .lines()
        .zip(computed.lines())
        .find(|(stored, computed)| stored != computed)?;
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
