//! A run compared with a second simulation of its scenario.

use crate::dataset::{Handed, from_python};
use crate::errors;
use crate::studies::Threads;
use crate::watched::watched;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use stick_slip::saved::{Again, BlocksAgain, again_in_memory};

/// A difference: variable, path, index, the stored and the computed value, and its place in words.
type Differs = (String, Option<u64>, Option<usize>, String, String, String);

/// Number of blocks, those that were simulated again, how many paths these are, whether statistics
/// were computed again, the number of values compared, and the first difference.
type Verified = (u64, Vec<u64>, u64, bool, u64, Option<Differs>);

/// Compares the data set of a run with a second simulation of so many of its blocks; of all, if
/// `blocks` is none.
#[pyfunction]
pub fn verify(py: Python<'_>, run: Handed<'_>, blocks: Option<u64>, threads: Threads) -> PyResult<Verified> {
    let dataset = from_python(run)?;
    let sample = blocks.map_or(BlocksAgain::All, BlocksAgain::Some);
    let (again, is_interrupted) = watched(py, None, |watch| again_in_memory(&dataset, sample, threads.0, &watch.stop))?;
    let again = again.map_err(|problem| errors::of_run(py, &problem, "take the data set as it was made"))?;
    if is_interrupted {
        return Err(PyKeyboardInterrupt::new_err("interrupted while blocks were simulated again"));
    }
    let Again { blocks, simulated, paths, has_statistics, values, difference } = again;
    let difference = difference.map(|difference| {
        let place = difference.to_string();
        (difference.variable, difference.path, difference.index, difference.stored, difference.computed, place)
    });
    Ok((blocks.end - blocks.start, simulated.into_iter().collect(), paths, has_statistics, values, difference))
}
