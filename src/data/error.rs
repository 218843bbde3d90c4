//! What is wrong with a file of data, said so that the reader knows where to look and what to change.

use std::fmt;

/// One thing that is wrong, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DataError {
    /// The file.
    pub file: String,
    /// The line, from 1.
    pub line: Option<u64>,
    /// The column, by its name.
    pub column: Option<String>,
    /// The cell as written.
    pub value: Option<String>,
    /// What is wrong.
    pub problem: String,
    /// What would be right.
    pub remedy: String,
}

/// Longest quoted cell, in characters.
const QUOTE_LENGTH: usize = 40;

impl DataError {
    /// Something about the file as a whole.
    pub(super) fn file(file: &str, problem: String, remedy: &str) -> Self {
        DataError { file: file.into(), line: None, column: None, value: None, problem, remedy: remedy.into() }
    }

    /// The same error, at this line.
    pub(super) fn line(mut self, line: u64) -> Self {
        self.line = Some(line);
        self
    }

    /// The same error, about this cell.
    pub(super) fn cell(mut self, column: &str, cell: &[u8]) -> Self {
        self.column = Some(column.to_string());
        self.value = Some(quoted(cell));
        self
    }
}

/// A cell as one short printable line.
pub(super) fn quoted(cell: &[u8]) -> String {
    let text = String::from_utf8_lossy(cell);
    let short: String = text.chars().take(QUOTE_LENGTH).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(QUOTE_LENGTH).is_some() { format!("{short}...") } else { short }
}

impl fmt::Display for DataError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        f.write_str(": ")?;
        if let (Some(column), Some(value)) = (&self.column, &self.value) {
            write!(f, "`{column}` = \"{value}\" ")?;
        }
        write!(f, "{}\n  fix: {}", self.problem, self.remedy)
    }
}

impl std::error::Error for DataError {}
