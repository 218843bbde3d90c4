//! Warnings about the file of a run and about its memory.

use super::case::{Case, when};
use crate::numbers::bytes;

/// More rows of the output grid than this are worth a warning.
const MANY_ROWS: usize = 10_000;

pub(super) fn many_rows(case: &Case) -> Vec<String> {
    let rows = case.derived.rows;
    when(rows > MANY_ROWS, || {
        format!(
            "the bands of {rows} rows take up to about {} of memory per thread; a longer `time.output_step` or \
             fewer `--threads` take less",
            bytes(case.derived.thread_bytes)
        )
    })
}

/// A larger file than this, one gigabyte, is worth a warning.
const LARGE_OUTPUT: f64 = 1e9;

pub(super) fn large_output(case: &Case) -> Vec<String> {
    let size = case.derived.output_bytes;
    when(size > LARGE_OUTPUT, || format!("the output file will be about {}; [record] says what is kept", bytes(size)))
}
