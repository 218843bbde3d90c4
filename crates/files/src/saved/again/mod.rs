//! Comparison of a data set, in a file or in memory, with a second computation from its scenario.
//!
//! All variables and attributes must be identical, bit for bit, and nothing else may be stored.

mod against;

pub(crate) use against::Against;

use std::fmt;
use std::sync::atomic::AtomicBool;
use stickslip::dataset::rows::RowAxis;
use stickslip::dataset::{Dataset, Recorder, Source, StoredRun, layout};
use stickslip::engine::{Asked, Progress, Run, RunError, Status};
use stickslip::ensemble::BLOCK_SIZE;
use stickslip::scenario::Scenario;

/// The result of comparing a data set.
#[derive(Clone, Debug)]
pub struct Verified {
    /// Number of values and texts that were compared.
    pub values: u64,
    /// The first difference, if there is one.
    pub difference: Option<Difference>,
}

/// Simulate a stored run again, with this scenario. The result is the data set that must be stored.
/// What ended the run before its last path does not follow from the scenario, and is taken from the
/// stored run. The run must not be a part.
///
/// # Errors
///
/// The simulation fails.
pub fn rerun(
    stored: &StoredRun,
    scenario: &Scenario,
    threads: usize,
    stop: &AtomicBool,
    progress: &mut dyn Progress,
) -> Result<Dataset, RunError> {
    let all = scenario.ensemble.paths;
    let early = match stored.status {
        _ if stored.ended_by.is_some() => Some((Status::Ended, stored.header.paths)),
        Status::Interrupted if stored.completed_paths < all => Some((Status::Interrupted, all)),
        _ => None,
    };
    let paths = early.map_or(all, |(_, paths)| {
        // It ended after a block that is not the last.
        (stored.completed_paths.min(paths) / BLOCK_SIZE * BLOCK_SIZE).max(1)
    });
    let mut recorder = Recorder::default();
    let asked = Asked {
        with_bias: stored.summary.has_bias(),
        ..Asked::paths(paths)
    };
    Run::of(scenario)
        .asked(asked)
        .threads(threads)
        .stopped_by(stop)
        .with_progress(progress)
        .into_sink(&mut recorder)
        .simulate()?;
    let mut again = recorder.into_dataset();
    if let Some((status, paths)) = early {
        again.set_attribute("status", status.name());
        again.set_attribute("paths", paths);
        let ended_by = stored.ended_by.iter().cloned();
        ended_by.for_each(|reason| again.set_attribute("ended_by", reason));
        if status == Status::Interrupted {
            // A run that was interrupted has no limit cycle.
            let of_cycle = [layout::CYCLE_NUMBER.name, layout::SECTION_STATE.name];
            again
                .entries
                .retain(|entry| !entry.axes.iter().any(|axis| of_cycle.contains(&&**axis)));
        }
    }
    Ok(again)
}

/// Compare a data set that is stored with one that was computed again.
pub(crate) fn compare(held: &dyn Source, again: &Dataset) -> Result<Verified, String> {
    let mut against = Against::of(held);
    against.variables(again)?;
    if again
        .entries
        .iter()
        .any(|entry| RowAxis::of(entry) == Some(RowAxis::Event))
    {
        against.exempt(&layout::EVENT);
    }
    against.finish(again)?;
    Ok(Verified {
        values: against.values,
        difference: against.difference,
    })
}

/// Compare the data set of a run with a second simulation.
///
/// # Errors
///
/// The data set is not that of a run, its scenario is invalid, or the simulation fails.
pub fn again_in_memory(
    dataset: &Dataset,
    threads: usize,
    stop: &AtomicBool,
    progress: &mut dyn Progress,
) -> Result<Verified, String> {
    let stored = StoredRun::read(dataset)?;
    let header = &stored.header;
    let scenario = Scenario::parse_stored("run", &header.scenario_text, &[], &header.samples)
        .map_err(|error| error.to_string())?;
    let again =
        rerun(&stored, &scenario, threads, stop, progress).map_err(|error| error.to_string())?;
    compare(dataset, &again)
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
