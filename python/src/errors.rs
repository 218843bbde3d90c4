//! Errors of the engine as exceptions of `stickslip.errors`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use stick_slip::config::{Fault, ScenarioError};
use stick_slip::ensemble::{self, Flaw};

/// An exception of the class `class` of `stickslip.errors`, with these attributes.
fn exception(
    py: Python<'_>,
    class: &str,
    message: &str,
    attributes: impl FnOnce(&Bound<'_, PyDict>) -> PyResult<()>,
) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let keywords = PyDict::new(py);
        attributes(&keywords)?;
        let class = py.import("stickslip.errors")?.getattr(class)?;
        Ok(PyErr::from_value(class.call((message,), Some(&keywords))?))
    };
    made().unwrap_or_else(|error| error)
}

/// The exception for an error in a scenario.
pub fn of_scenario(py: Python<'_>, error: &ScenarioError) -> PyErr {
    exception(py, "ScenarioError", &error.to_string(), |keywords| match error {
        ScenarioError::Unreadable { path, reason, remedy } => {
            keywords.set_item("origin", path)?;
            keywords.set_item("problem", reason)?;
            keywords.set_item("remedy", remedy)
        }
        // The message names all faults; the attributes are those of the first one.
        ScenarioError::Invalid(faults) => {
            let Some(first) = faults.first() else { return Ok(()) };
            let Fault { origin, line, column, key, value, problem, remedy, excerpt } = first;
            keywords.set_item("origin", origin)?;
            keywords.set_item("line", line)?;
            keywords.set_item("column", column)?;
            keywords.set_item("key", key)?;
            keywords.set_item("value", value)?;
            keywords.set_item("problem", problem)?;
            keywords.set_item("remedy", remedy)?;
            keywords.set_item("excerpt", excerpt)
        }
    })
}

/// A problem with its remedy behind it. The text of some errors of the engine has its remedy already.
fn with_remedy(problem: &str, remedy: &str) -> String {
    if problem.contains("\n  fix: ") { problem.to_string() } else { format!("{problem}\n  fix: {remedy}") }
}

/// A problem without the remedy behind it.
fn bare(problem: &str) -> &str {
    problem.split("\n  fix: ").next().unwrap_or(problem)
}

/// The exception for a wrong argument of a function.
pub fn of_argument(py: Python<'_>, argument: &str, value: &str, problem: &str, remedy: &str) -> PyErr {
    let message = format!("{argument} = {value}: {}", with_remedy(problem, remedy));
    exception(py, "ArgumentError", &message, |keywords| {
        keywords.set_item("argument", argument)?;
        keywords.set_item("value", value)?;
        keywords.set_item("problem", bare(problem))?;
        keywords.set_item("remedy", remedy)
    })
}

/// The exception for a run, a trade, a calibration or a forecast without a result.
pub fn of_run(py: Python<'_>, problem: &str, remedy: &str) -> PyErr {
    exception(py, "RunError", &with_remedy(problem, remedy), |keywords| {
        keywords.set_item("problem", bare(problem))?;
        keywords.set_item("remedy", remedy)
    })
}

/// The exception for a panic in the engine.
pub fn of_flaw(py: Python<'_>, flaw: &Flaw) -> PyErr {
    of_run(py, &flaw.to_string(), Flaw::REMEDY)
}

/// Does some work, whose panic is an exception like any other failure. That of PyO3 is none that
/// `except Exception` catches.
pub fn guarded<R>(py: Python<'_>, work: impl FnOnce() -> PyResult<R>) -> PyResult<R> {
    ensemble::guarded(work).unwrap_or_else(|flaw| Err(of_flaw(py, &flaw)))
}
