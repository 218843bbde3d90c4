//! Constants that pages quote have the values in the code.

use super::markdown::{Page, names};
use stickslip::dataset::FORMAT_VERSION;
use stickslip::ensemble::BLOCK_SIZE;
use stickslip::noise::MAX_NORMAL_ERROR;
use stickslip::scenario::{MAX_PATHS, MAX_PERIODS, MAX_ROWS, MAX_STEPS, MAX_TRAJECTORIES};
use stickslip::scheme::{DEFAULT_TOLERANCE, TOLERANCES};
use stickslip::stats::{QUANTILE_LEVELS, Statistic};

#[track_caller]
fn says(page: &str, sentence: &str) {
    let text = Page::read(page)
        .text
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    assert!(text.contains(sentence), "{page} does not say: {sentence}");
}

#[test]
fn the_error_of_the_normals() {
    let error = format!("{MAX_NORMAL_ERROR:e}");
    says(
        "DESIGN.md",
        &format!("is off by at most {error} (`noise::MAX_NORMAL_ERROR`"),
    );
    says(
        "docs/performance.md",
        &format!("with an error of at most {error} up to 9.1 sigma"),
    );
    says("CHANGELOG.md", &format!("(error {error} at most"));
}

#[test]
fn the_version_of_the_format() {
    let (major, minor) = FORMAT_VERSION;
    says(
        "docs/output-format.md",
        &format!("This page describes version {major}.{minor}."),
    );
    says("CHANGELOG.md", &format!("format {major}.{minor}"));
}

#[test]
fn block_size_quantiles_and_tolerance() {
    says(
        "DESIGN.md",
        &format!("### Why blocks of {BLOCK_SIZE} paths?"),
    );
    says("README.md", &format!("a block of {BLOCK_SIZE} paths"));
    let levels = QUANTILE_LEVELS.map(|level| level.to_string()).join(", ");
    says("docs/output-format.md", &format!("levels: {levels}"));
    says(
        "docs/event-driven.md",
        &format!("`scheme.tolerance` (default {DEFAULT_TOLERANCE:e})"),
    );
}

#[test]
fn the_limits_of_a_scenario() {
    let power = |n: f64| format!("2^{}", n.log2());
    says(
        "docs/scenario.md",
        &format!("a run has at most {} steps", power(MAX_STEPS)),
    );
    says(
        "docs/scenario.md",
        &format!("A run with more than {MAX_PERIODS} periods has neither."),
    );
    let keys = [
        format!("| 10000 | 1 to {} |", power(MAX_PATHS as f64)),
        format!("whole steps; at most {MAX_ROWS} rows"),
        format!("| 0 | 0 to {MAX_TRAJECTORIES} |"),
        format!(
            "| 1e-3 | a number from {:e} to {} |",
            TOLERANCES.start(),
            TOLERANCES.end()
        ),
    ];
    keys.iter().for_each(|row| says("docs/keys.md", row));
}

/// docs/statistics.md lists the statistics in the order of the catalogue, each with its full name.
#[test]
fn the_statistics() {
    let page = Page::read("docs/statistics.md").section("## The list");
    let listed: Vec<String> = page
        .rows("name")
        .iter()
        .flat_map(|row| names(&row[0]))
        .collect();
    assert_eq!(
        listed,
        Statistic::ALL.map(|statistic| statistic.name().to_string())
    );
}
