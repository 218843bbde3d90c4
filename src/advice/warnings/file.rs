//! Warnings about the file of a run and about its memory.

use crate::advice::derived::Derived;
use crate::numbers::bytes;
use std::fmt;

/// The output grid takes much memory.
#[derive(Clone, Debug, PartialEq)]
pub struct ManyRows {
    /// Number of rows.
    pub rows: usize,
    /// Memory that a thread needs for them, in bytes.
    pub bytes: f64,
}

/// More rows than this are worth a warning.
const MANY_ROWS: usize = 10_000;

impl ManyRows {
    pub(super) fn due(derived: &Derived) -> Option<Self> {
        let rows = derived.rows;
        (rows > MANY_ROWS).then_some(ManyRows { rows, bytes: derived.thread_bytes })
    }
}

impl fmt::Display for ManyRows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the bands of {} rows take up to about {} of memory per thread; a longer `time.output_step` or \
             fewer `--threads` take less",
            self.rows,
            bytes(self.bytes)
        )
    }
}

/// The output file is large.
#[derive(Clone, Debug, PartialEq)]
pub struct LargeOutput {
    /// Estimated size in bytes.
    pub bytes: f64,
}

/// A larger file than this, one gigabyte, is worth a warning.
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
