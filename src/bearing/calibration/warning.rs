//! A warning about a calibration.

use std::fmt;

/// A reason why a result means less than it seems to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    pub(super) name: &'static str,
    pub(super) text: String,
}

impl Warning {
    /// The name in files and for programs.
    pub fn name(&self) -> &'static str {
        self.name
    }
}

/// The warning in a sentence or two, for people.
impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.text)
    }
}
