//! Warnings about the file of a run and about its memory.

use super::case::Case;
use stickslip_text::numbers::bytes;

/// The number of rows of the output grid above which to warn.
const MANY_ROWS: usize = 10_000;

pub(super) fn many_rows(case: &Case) -> Option<String> {
    let rows = case.derived.rows;
    (rows > MANY_ROWS).then(|| {
        let [one, two] = [1, 2].map(|threads| {
            case.scenario
                .run_bytes(case.scenario.ensemble.paths, threads)
        });
        format!(
            "the bands of {rows} rows take up to about {} of memory on one thread, and {} on two; \
             increase `time.output_step` or use fewer threads to reduce this",
            bytes(one),
            bytes(two)
        )
    })
}

/// The file size above which to warn, one gigabyte.
const LARGE_OUTPUT: f64 = 1e9;

pub(super) fn large_output(case: &Case) -> Option<String> {
    let size = case.derived.output_bytes;
    (size > LARGE_OUTPUT).then(|| {
        format!(
            "the output file will be about {}; [record] controls what is kept",
            bytes(size)
        )
    })
}
