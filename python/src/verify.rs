//! A run compared with a second simulation of its scenario.

use crate::dataset::{Handed, from_python};
use crate::errors;
use crate::studies::Threads;
use crate::watched::watched;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::path::PathBuf;
use stickslip_files::saved::{BlocksAgain, Difference, again_in_memory, seal};

/// What was compared: fields of `stickslip.Verified`.
#[derive(IntoPyObject)]
pub struct Compared<'py> {
    blocks: u64,
    blocks_checked: Bound<'py, PyTuple>,
    paths_checked: u64,
    statistics_checked: bool,
    values_checked: u64,
}

/// Fields of `stickslip.VerificationError`, and the place of the difference in words.
#[derive(IntoPyObject)]
pub struct Differs {
    variable: String,
    path: Option<u64>,
    index: Option<usize>,
    stored: String,
    computed: String,
    place: String,
}

/// Compares the data set of a run with a second simulation of so many of its blocks; of all, if
/// `blocks` is none.
#[pyfunction]
pub fn verify<'py>(
    py: Python<'py>,
    run: Handed<'_>,
    blocks: Option<u64>,
    threads: Threads,
) -> PyResult<(Compared<'py>, Option<Differs>)> {
    let dataset = from_python(run)?;
    let sample = blocks.map_or(BlocksAgain::All, BlocksAgain::Some);
    let (again, is_interrupted) = watched(py, None, |watch| {
        again_in_memory(&dataset, sample, threads.0, &watch.stop)
    })?;
    let again =
        again.map_err(|problem| errors::of_run(py, &problem, "use the unmodified data set"))?;
    if is_interrupted {
        return Err(PyKeyboardInterrupt::new_err(
            "interrupted while blocks were simulated again",
        ));
    }
    let difference = again.difference.map(|difference| {
        let place = difference.to_string();
        let Difference {
            variable,
            path,
            index,
            stored,
            computed,
        } = difference;
        Differs {
            variable,
            path,
            index,
            stored,
            computed,
            place,
        }
    });
    let compared = Compared {
        blocks: again.blocks.end - again.blocks.start,
        blocks_checked: PyTuple::new(py, again.simulated)?,
        paths_checked: again.paths,
        statistics_checked: again.has_statistics,
        values_checked: again.values,
    };
    Ok((compared, difference))
}

/// Whether the checksum of a file is right; None if it has none. Without `is_compared` it is only
/// looked for.
#[pyfunction]
pub fn sealed(path: PathBuf, is_compared: bool) -> std::io::Result<Option<bool>> {
    seal::is_right(&path, if is_compared { u64::MAX } else { 0 })
}
