//! Comparing a data set that is stored, in a file or in memory, with what its scenario gives when
//! it is computed again.
//!
//! A data set is written by the same functions as always, but to a destination that compares
//! instead. Every variable and attribute that would be written must be there, bit for bit, and
//! nothing else may be. Everything that is not simulated again is compared with what is derived
//! from the rest of the data set, so that a number that was changed does not go with the others.
//!
//! ```text
//! Held      a data set that is stored
//! against   the destination that compares
//! rows      rows of blocks that are simulated again, and all that is no row
//! run       which blocks of a run are simulated again
//! ```

mod against;
mod rows;
mod run;

pub use run::{Again, BlocksAgain, drawn};

pub(crate) use against::Against;
pub(crate) use run::again;

use super::parts::RowSource;
use crate::dataset::{Attribute, Dataset, Source, StoredRun};
use crate::scenario::Scenario;
use crate::stats::column::FirstDifference;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::AtomicBool;

/// A data set that is stored.
pub(crate) trait Held: Source<Error: Send> + RowSource<Error = ReadError<Self>> + Sync {
    /// The names of its variables.
    fn names(&self) -> Result<Vec<String>, ReadError<Self>>;

    /// The attributes of a variable, or of the data set, without those that only attach coordinates
    /// to variables.
    fn attributes(&self, variable: Option<&str>) -> Result<BTreeMap<String, Attribute>, ReadError<Self>>;

    /// The length of the first dimension of a variable; none if there is no such variable.
    fn length(&self, variable: &str) -> Result<Option<usize>, ReadError<Self>>;

    /// Whether another program may have laid it out, and left out what only a layout needs.
    fn is_laid_out_anew(&self) -> bool;

    /// Where a dimension without a variable differs from one of this length, if it is stored.
    fn bare_difference(&self, dimension: &str, length: usize) -> Result<Option<FirstDifference>, ReadError<Self>>;
}

/// The error of reading a data set.
pub(crate) type ReadError<H> = <H as Source>::Error;

impl Held for Dataset {
    fn names(&self) -> Result<Vec<String>, String> {
        Ok(self.entries.iter().map(|entry| entry.name.clone()).collect())
    }

    fn attributes(&self, variable: Option<&str>) -> Result<BTreeMap<String, Attribute>, String> {
        let of_entry = |variable| self.entry(variable).map(|entry| &entry.attributes);
        let found = variable.map_or(Some(&self.attributes), of_entry);
        Ok(found.into_iter().flatten().cloned().collect())
    }

    fn length(&self, variable: &str) -> Result<Option<usize>, String> {
        Ok(self.entry(variable).map(|entry| {
            let width: usize = self.shape(entry).iter().skip(1).product();
            entry.column.len() / width.max(1)
        }))
    }

    fn is_laid_out_anew(&self) -> bool {
        true
    }

    fn bare_difference(&self, _: &str, _: usize) -> Result<Option<FirstDifference>, String> {
        Ok(None)
    }
}

/// Compare the data set of a run with a second simulation.
///
/// # Errors
///
/// The data set cannot be read as that of a run, or its scenario is none.
pub fn again_in_memory(
    dataset: &Dataset,
    sample: BlocksAgain,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Again, String> {
    let stored = StoredRun::read(dataset)?;
    let header = &stored.header;
    let scenario = Scenario::parse_stored("run", &header.scenario_text, &[], header.series.as_ref());
    again(dataset, &stored, &scenario.map_err(|error| error.to_string())?, sample, threads, stop)
}

/// The first value of a data set that differs from what its scenario gives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The variable or attribute.
    pub variable: String,
    /// The number of the path, if the variable holds rows of single paths.
    pub path: Option<u64>,
    /// The index of the value, from 0, among the values of the path or else of the variable; none
    /// for an attribute, and for a variable as a whole.
    pub index: Option<usize>,
    /// The value that is stored.
    pub stored: String,
    /// The value that the scenario gives.
    pub computed: String,
}

impl Difference {
    /// The difference as a sentence, of a `file` or a `data set`.
    pub fn of(&self, what: &str) -> String {
        let Difference { stored, computed, .. } = self;
        format!("{self} is {stored} in the {what}, and {computed} when it is computed again")
    }
}

/// The place of the difference.
impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Difference { variable, path, index, .. } = self;
        match (path, index) {
            (Some(path), Some(index)) if *index > 0 => {
                write!(f, "path {path}: {variable}, value {index} of the path,")
            }
            (Some(path), _) => write!(f, "path {path}: {variable}"),
            (None, Some(index)) => write!(f, "{variable}, value {index},"),
            (None, None) => f.write_str(variable),
        }
    }
}
