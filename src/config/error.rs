//! Errors in scenarios, with their remedies.

use super::SHIPPED;
use std::fmt;

/// Why a scenario cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// The file cannot be read at all.
    #[error("cannot read {path}: {cause}\n  fix: {}", cause.remedy())]
    Unreadable {
        /// The file.
        path: String,
        /// Why.
        cause: Unreadable,
    },
    /// The file can be read, but it or an override is wrong in at least one place. The errors are
    /// in the order of the file. Inconsistent values are reported only if each of them is valid by
    /// itself.
    #[error("{}", .0.iter().map(Diagnostic::to_string).collect::<Vec<_>>().join("\n"))]
    Invalid(Vec<Diagnostic>),
}

/// Why the text of a scenario cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unreadable {
    /// There is no such file; perhaps the shipped scenario of this name is meant.
    #[error("no such file")]
    Missing(Option<&'static str>),
    /// The system refuses to read it, for this reason.
    #[error("{0}")]
    Refused(String),
    /// It is a directory.
    #[error("it is a directory")]
    Directory,
    /// It holds results.
    #[error("it is an HDF5 file")]
    Results,
    /// It is larger than any scenario.
    #[error("it is larger than 1 MiB")]
    TooLarge,
    /// This line is not text.
    #[error("line {0} is not UTF-8 text")]
    NotText(usize),
    /// No shipped scenario has this name.
    #[error("no shipped scenario has this name")]
    NotShipped,
}

impl Unreadable {
    /// How to fix it.
    pub fn remedy(&self) -> String {
        match self {
            Unreadable::Missing(Some(name)) => {
                format!("give the path of a scenario, a TOML file, or `{name}`, which is shipped")
            }
            Unreadable::NotText(_) => "save it as UTF-8, without a byte-order mark".into(),
            Unreadable::NotShipped => {
                let names = SHIPPED.map(|scenario| scenario.name);
                format!("choose one of {}", names.join(", "))
            }
            _ => "give the path of a scenario, a TOML file".into(),
        }
    }
}

impl From<Box<Diagnostic>> for ScenarioError {
    fn from(diagnostic: Box<Diagnostic>) -> Self {
        ScenarioError::Invalid(vec![*diagnostic])
    }
}

/// An error and its place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnostic {
    /// The file, or the override as it was typed.
    pub origin: String,
    /// Line in the file, from 1; an override has none.
    pub line: Option<usize>,
    /// Column in the file, from 1.
    pub column: Option<usize>,
    /// The dotted key, if the error is about one.
    pub key: Option<String>,
    /// The value as written, if there is one.
    pub value: Option<String>,
    /// What is wrong.
    pub problem: String,
    /// How to fix it.
    pub remedy: String,
    /// The line of the file with a caret under the place, ready to print.
    pub excerpt: Option<String>,
}

impl Diagnostic {
    /// The same error, with its key set.
    pub(super) fn of(mut self: Box<Self>, key: &str) -> Box<Diagnostic> {
        self.key = Some(key.to_string());
        self
    }

    /// The same error, with its value set.
    pub(super) fn value(mut self: Box<Self>, value: String) -> Box<Diagnostic> {
        self.value = Some(value);
        self
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.origin)?;
        if let (Some(line), Some(column)) = (self.line, self.column) {
            write!(f, ":{line}:{column}")?;
        }
        f.write_str(": ")?;
        // A problem that already names the key is printed as a sentence of its own.
        let key = self
            .key
            .as_ref()
            .filter(|key| !self.problem.contains(&format!("`{key}` = ")));
        match (key, &self.value) {
            (Some(key), Some(value)) => write!(f, "`{key}` = {value} ")?,
            (Some(key), None) => write!(f, "`{key}` ")?,
            _ => {}
        }
        writeln!(f, "{}", self.problem)?;
        if let Some(excerpt) = &self.excerpt {
            for line in excerpt.lines() {
                writeln!(f, "  {}", line.trim_end())?;
            }
        }
        write!(f, "  fix: {}", self.remedy)
    }
}
