//! Errors in expressions, with their places.

use std::ops::Range;

/// Why a text is not an expression.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{problem}\n  fix: {remedy}")]
pub struct ExpressionError {
    /// The first byte of the place in the text.
    pub start: usize,
    /// The byte after the place. An error of a parameter has an empty place at 0.
    pub end: usize,
    /// The parameter, if the error is about its name or its value.
    pub parameter: Option<String>,
    /// What is wrong.
    pub problem: String,
    /// How to fix it.
    pub remedy: String,
}

impl ExpressionError {
    /// An error at these bytes of the text.
    pub(super) fn new(
        place: Range<usize>,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        let (problem, remedy) = (problem.into(), remedy.into());
        ExpressionError {
            start: place.start,
            end: place.end,
            parameter: None,
            problem,
            remedy,
        }
    }

    /// An error of a parameter.
    pub(super) fn of_parameter(
        name: &str,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        ExpressionError {
            parameter: Some(name.to_string()),
            ..ExpressionError::new(0..0, problem, remedy)
        }
    }
}
