//! What to know about the file of a run.

use crate::advice::derived::Derived;
use crate::numbers::bytes;
use std::fmt;

/// A large file.
#[derive(Clone, Debug, PartialEq)]
pub struct LargeOutput {
    /// Estimated size.
    pub bytes: f64,
}

/// Above this, a file deserves a word: one gigabyte.
const LARGE_OUTPUT: f64 = 1e9;

impl LargeOutput {
    pub(super) fn due(derived: &Derived) -> Option<Self> {
        (derived.output_bytes > LARGE_OUTPUT).then_some(LargeOutput { bytes: derived.output_bytes })
    }
}

impl fmt::Display for LargeOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the output file will be about {}; [record] says what is kept", bytes(self.bytes))
    }
}
