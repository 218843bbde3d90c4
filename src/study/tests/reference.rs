//! The statistics of the noisy scene of the paper (`rho025`) from `tests/reference/noisy.c`, a
//! program that shares no code with this crate.
#![allow(dead_code, reason = "each test file uses its own part")]

const TABLE: &str = include_str!("noisy.csv");

/// A statistic of the model itself, at zero step, and its standard error.
#[track_caller]
pub fn limit(statistic: &str) -> (f64, f64) {
    value("limit", statistic)
}

/// A statistic of the discrete variational inequality with this step (0.02, 0.01 or 0.001), and its
/// standard error.
#[track_caller]
pub fn at_step(h: f64, statistic: &str) -> (f64, f64) {
    value(&h.to_string(), statistic)
}

#[track_caller]
fn value(case: &str, statistic: &str) -> (f64, f64) {
    let row = TABLE.lines().find_map(|line| {
        line.strip_prefix(case)?
            .strip_prefix(',')?
            .strip_prefix(statistic)?
            .strip_prefix(',')
    });
    let (estimate, error) = row
        .and_then(|row| row.split_once(','))
        .expect("a row of noisy.csv");
    (
        estimate.parse().expect("a number"),
        error.parse().expect("a number"),
    )
}
