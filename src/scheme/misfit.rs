//! Values that are each in their range and do not go together: which they are, why not, and what
//! would.

use std::fmt;

/// Why a scenario cannot be simulated as it is asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct Misfit {
    /// The values it is about, by their dotted keys in a scenario. The first is the one to blame,
    /// unless a command line changed another.
    pub about: Vec<(&'static str, f64)>,
    /// What is wrong: the rest of a sentence that begins with the first key and its value, or a
    /// whole sentence that names them.
    pub problem: String,
    /// What would be right.
    pub remedy: String,
}

impl Misfit {
    /// About these values.
    pub fn new(about: &[(&'static str, f64)], problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Misfit { about: about.to_vec(), problem: problem.into(), remedy: remedy.into() }
    }

    /// What is wrong, in one line.
    pub fn sentence(&self) -> String {
        match self.about.first() {
            Some((key, value)) if !self.names(key) => format!("`{key}` = {value:?} {}", self.problem),
            _ => self.problem.clone(),
        }
    }

    /// Whether the problem is a sentence of its own, which names this key and its value.
    fn names(&self, key: &str) -> bool {
        self.problem.contains(&format!("`{key}` = "))
    }
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n  fix: {}", self.sentence(), self.remedy)
    }
}
