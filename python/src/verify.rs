//! A run compared with a second simulation of its scenario.

use crate::dataset::{Handed, from_python};
use crate::errors;
use crate::studies::ThreadCount;
use crate::watched::{Callback, watched};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::path::PathBuf;
use stickslip_files::saved::{Difference, again_in_memory, checksum::is_right};

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

/// Compares the data set of a run with a second simulation. Returns the number of values that were
/// compared, and the first difference.
#[pyfunction]
pub fn verify(
    py: Python<'_>,
    run: Handed<'_>,
    threads: ThreadCount,
    progress: Callback,
) -> PyResult<(u64, Option<Differs>)> {
    let dataset = from_python(run)?;
    let (again, is_interrupted) = watched(py, &progress, |watch| {
        again_in_memory(&dataset, threads.0, &watch.stop, &mut watch.paths(0))
    })?;
    let again =
        again.map_err(|problem| errors::of_run(py, &problem, "use the unmodified data set"))?;
    if is_interrupted {
        return Err(PyKeyboardInterrupt::new_err(
            "interrupted while the run was simulated again",
        ));
    }
    let differs = |difference: Difference| {
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
    };
    Ok((again.values, again.difference.map(differs)))
}

/// Whether the checksum of a file is right; None if it has none. Without `is_compared` it is only
/// looked for.
#[pyfunction]
pub fn checksum(path: PathBuf, is_compared: bool) -> std::io::Result<Option<bool>> {
    is_right(&path, if is_compared { u64::MAX } else { 0 })
}
