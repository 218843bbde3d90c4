//! The error for values that are each within their range but cannot be used together.

use std::fmt;

/// The reason why a scenario cannot be simulated, and the remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct CheckError {
    /// The values concerned, by their dotted keys in a scenario. The first one is reported, unless
    /// another one was set on the command line.
    pub about: Vec<(&'static str, f64)>,
    /// What is wrong: either the rest of a sentence that begins with the first key and its value,
    /// or a whole sentence that names them.
    pub problem: String,
    /// What to change.
    pub remedy: String,
}

impl CheckError {
    /// An error about these values.
    pub fn new(
        about: &[(&'static str, f64)],
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        CheckError {
            about: about.to_vec(),
            problem: problem.into(),
            remedy: remedy.into(),
        }
    }

    /// What is wrong, in one line.
    pub fn sentence(&self) -> String {
        match self.about.first() {
            Some((key, value)) if !self.names(key) => {
                format!("`{key}` = {value:?} {}", self.problem)
            }
            _ => self.problem.clone(),
        }
    }

    /// Whether the problem is a whole sentence, which names this key and its value.
    fn names(&self, key: &str) -> bool {
        self.problem.contains(&format!("`{key}` = "))
    }
}

impl fmt::Display for CheckError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n  fix: {}", self.sentence(), self.remedy)
    }
}
