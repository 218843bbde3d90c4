//! Errors of the engine as exceptions of `stickslip.errors`.

use pyo3::prelude::*;
use pyo3::types::{IntoPyDict as _, PyDict};
use std::fmt::Display;
use stickslip::config::{Diagnostic, ScenarioError, Unreadable};
use stickslip::ensemble::{self, Flaw};

/// An exception of the class `class` of `stickslip.errors`, with these attributes.
fn exception(
    py: Python<'_>,
    class: &str,
    message: &str,
    attributes: PyResult<Bound<'_, PyDict>>,
) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let class = py.import("stickslip.errors")?.getattr(class)?;
        Ok(PyErr::from_value(
            class.call((message,), Some(&attributes?))?,
        ))
    };
    made().unwrap_or_else(|error| error)
}

/// The exception for an error in a scenario.
pub fn of_scenario(py: Python<'_>, error: &ScenarioError) -> PyErr {
    let mut message = error.to_string();
    if let ScenarioError::Unreadable { path, cause } = error {
        let remedy = readable(path, cause);
        message = format!("cannot read {path}: {cause}\n  fix: {remedy}");
    }
    let attributes = || match error {
        ScenarioError::Unreadable { path, cause } => [
            ("origin", path),
            ("problem", &cause.to_string()),
            ("remedy", &readable(path, cause)),
        ]
        .into_py_dict(py),
        // The message names all errors; the attributes are those of the first one.
        ScenarioError::Invalid(diagnostics) => {
            let Some(first) = diagnostics.first() else {
                return Ok(PyDict::new(py));
            };
            let Diagnostic {
                origin,
                line,
                column,
                key,
                value,
                problem,
                remedy,
                excerpt,
            } = first;
            let attributes =
                [("origin", origin), ("problem", problem), ("remedy", remedy)].into_py_dict(py)?;
            attributes.set_item("line", line)?;
            attributes.set_item("column", column)?;
            attributes.set_item("key", key)?;
            attributes.set_item("value", value)?;
            attributes.set_item("excerpt", excerpt)?;
            Ok(attributes)
        }
    };
    exception(py, "ScenarioError", &message, attributes())
}

/// The remedy for a scenario that cannot be read, with the function that helps.
fn readable(path: &str, cause: &Unreadable) -> String {
    match cause {
        Unreadable::Results => {
            format!(
                "load(\"{path}\") opens it, and its attribute `scenario` is the scenario of its results"
            )
        }
        Unreadable::Missing(None) | Unreadable::Directory => {
            cause.remedy() + ", or the name of one of scenarios()"
        }
        _ => cause.remedy(),
    }
}

/// A problem with its remedy behind it. The text of some errors of the engine has its remedy already.
fn with_remedy(problem: &str, remedy: &str) -> String {
    if problem.contains("\n  fix: ") {
        problem.to_string()
    } else {
        format!("{problem}\n  fix: {remedy}")
    }
}

/// A problem without the remedy behind it.
fn bare(problem: &str) -> &str {
    problem.split("\n  fix: ").next().unwrap_or(problem)
}

/// The exception for a wrong argument of a function.
pub fn of_argument(
    py: Python<'_>,
    argument: &str,
    value: impl Display,
    problem: impl Display,
    remedy: &str,
) -> PyErr {
    let (value, problem) = (value.to_string(), problem.to_string());
    let message = format!("{argument} = {value}: {}", with_remedy(&problem, remedy));
    let attributes = [
        ("argument", argument),
        ("value", &value),
        ("problem", bare(&problem)),
        ("remedy", remedy),
    ]
    .into_py_dict(py);
    exception(py, "ArgumentError", &message, attributes)
}

/// The exception for a run, a trade, a calibration or a forecast without a result.
pub fn of_run(py: Python<'_>, problem: impl Display, remedy: &str) -> PyErr {
    let problem = problem.to_string();
    let attributes = [("problem", bare(&problem)), ("remedy", remedy)].into_py_dict(py);
    exception(py, "RunError", &with_remedy(&problem, remedy), attributes)
}

/// The exception for a panic in the engine.
pub fn of_flaw(py: Python<'_>, flaw: &Flaw) -> PyErr {
    of_run(py, flaw, Flaw::REMEDY)
}

/// Does some work, whose panic is an exception like any other failure. That of PyO3 is none that
/// `except Exception` catches.
pub fn guarded<R>(py: Python<'_>, work: impl FnOnce() -> PyResult<R>) -> PyResult<R> {
    ensemble::guarded(work).unwrap_or_else(|flaw| Err(of_flaw(py, &flaw)))
}
