//! Errors in data files: where they are and how to fix them.

use std::fmt;

/// An error and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DataError {
    /// The file.
    pub file: String,
    /// The line, from 1.
    pub line: Option<u64>,
    /// The cell in question, if the mistake is in one: its column and its content, cut to one short
    /// line, as a message shows them.
    pub cell: Option<String>,
    /// What is wrong.
    pub problem: String,
    /// How to fix it.
    pub remedy: String,
    /// Further errors, in the same file or in one that is read together with it.
    pub also: Option<Box<DataError>>,
}

/// What is wrong with a cell or a column, and the remedy.
pub(super) type ProblemAndRemedy = (String, String);

/// Longest quoted cell, in characters.
const QUOTE_LENGTH: usize = 40;

impl DataError {
    /// An error of the file as a whole.
    pub(super) fn file(file: &str, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        let (problem, remedy) = (problem.into(), remedy.into());
        DataError {
            file: file.into(),
            line: None,
            cell: None,
            problem,
            remedy,
            also: None,
        }
    }

    /// This error, followed by another one.
    pub(super) fn and(self, other: DataError) -> Self {
        let also = match self.also {
            Some(also) => also.and(other),
            None => other,
        };
        DataError {
            also: Some(Box::new(also)),
            ..self
        }
    }

    /// The same error, and those that follow it, with a text in the remedies replaced.
    pub(super) fn with_remedy(mut self, from: &str, to: &str) -> Self {
        self.remedy = self.remedy.replace(from, to);
        self.also = self.also.map(|also| Box::new(also.with_remedy(from, to)));
        self
    }

    /// All errors as one; none if there are none.
    pub(super) fn of_all(errors: impl IntoIterator<Item = DataError>) -> Option<Self> {
        errors.into_iter().reduce(DataError::and)
    }

    /// The same error, at this line.
    pub(super) fn line(mut self, line: u64) -> Self {
        self.line = Some(line);
        self
    }

    /// The same error, about this cell.
    pub(super) fn cell(mut self, column: &str, cell: &[u8]) -> Self {
        self.cell = Some(format!("`{column}` = \"{}\"", quoted(cell)));
        self
    }
}

/// A cell as one short printable line.
pub(super) fn quoted(cell: &[u8]) -> String {
    let text = String::from_utf8_lossy(cell);
    let short: String = text
        .chars()
        .take(QUOTE_LENGTH)
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if text.chars().nth(QUOTE_LENGTH).is_some() {
        format!("{short}...")
    } else {
        short
    }
}

impl fmt::Display for DataError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        f.write_str(": ")?;
        if let Some(cell) = &self.cell {
            write!(f, "{cell} ")?;
        }
        write!(f, "{}\n  fix: {}", self.problem, self.remedy)?;
        self.also
            .as_ref()
            .map_or(Ok(()), |also| write!(f, "\n{also}"))
    }
}

impl std::error::Error for DataError {}
