//! Comparing a data set that is stored, in a file or in memory, with what its scenario gives when
//! it is computed again.
//!
//! Every variable and attribute that would be written must be there, bit for bit, and nothing else
//! may be. Everything that is not simulated again is compared with what is derived from the rest of
//! the data set, so that a number that was changed does not go with the others.
//!
//! ```text
//! against   the comparison of two data sets
//! rows      rows of blocks that are simulated again, and all that is no row
//! run       which blocks of a run are simulated again
//! ```

mod against;
mod rows;
mod run;

pub use run::{Again, BlocksAgain, drawn};

pub(crate) use against::Against;
pub(crate) use run::again;

use crate::dataset::{Dataset, StoredRun};
use std::fmt;
use std::sync::atomic::AtomicBool;
use stickslip::scenario::Scenario;

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
    let scenario = Scenario::parse_stored("run", &header.scenario_text, &[], &header.samples);
    again(
        dataset,
        &stored,
        &scenario.map_err(|error| error.to_string())?,
        sample,
        threads,
        stop,
    )
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
        let Difference {
            stored, computed, ..
        } = self;
        format!("{self} is {stored} in the {what}, but {computed} when computed again")
    }
}

/// The place of the difference.
impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Difference {
            variable,
            path,
            index,
            ..
        } = self;
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
