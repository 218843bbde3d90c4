//! A warning about a calibration.

use std::fmt;

/// A reason why a result means less than it seems to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CalibrationWarning {
    pub(super) name: &'static str,
    pub(super) text: String,
}

impl CalibrationWarning {
    /// The name in files and for programs.
    pub fn name(&self) -> &'static str {
        self.name
    }
}

/// The warning in a sentence or two, for people.
impl fmt::Display for CalibrationWarning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.text)
    }
}
