//! The output that a page shows beside a command is what the command prints.

use super::markdown::{Page, root, spans};
use serde_json::Value;
use std::path::Path;

/// A folder with copies of the scenarios, in which commands run as in the root of the repository
/// and can write files.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scenarios = folder.path().join("scenarios");
    std::fs::create_dir(&scenarios).expect("room");
    for scenario in std::fs::read_dir(root().join("scenarios")).expect("the scenarios") {
        let path = scenario.expect("readable").path();
        std::fs::copy(&path, scenarios.join(path.file_name().expect("a file"))).expect("room");
    }
    folder
}

/// The standard output of `mc`.
fn printed(folder: &Path, words: &[&str]) -> String {
    let output = assert_cmd::Command::cargo_bin("mc")
        .expect("built")
        .current_dir(folder)
        .args(words)
        .output();
    let output = output.expect("runs");
    assert!(
        output.status.success(),
        "mc {}: {}",
        words.join(" "),
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The fenced blocks of a page in order, each with its language.
fn blocks(page: &Page) -> Vec<(&str, &str)> {
    let fences = page.text.split("\n```").skip(1).step_by(2);
    fences.filter_map(|block| block.split_once('\n')).collect()
}

/// Wherever a block of text follows a block of commands, the commands print these lines in this
/// order, perhaps with other lines before, between and after them.
#[test]
fn the_cascades_of_the_page_on_the_model() {
    let (page, folder) = (Page::read("docs/model.md"), workplace());
    let blocks = blocks(&page);
    let mut compared = 0;
    for pair in blocks
        .windows(2)
        .filter(|pair| (pair[0].0, pair[1].0) == ("sh", "text"))
    {
        let commands = pair[0]
            .1
            .split(" && ")
            .map(|command| command.split_whitespace().skip(1).collect::<Vec<_>>());
        let printed: String = commands
            .map(|words| printed(folder.path(), &words))
            .collect();
        let mut lines = printed.lines();
        for shown in pair[1].1.lines() {
            assert!(
                lines.any(|line| line == shown),
                "{}\ndoes not print: {shown}\n{printed}",
                pair[0].1
            );
        }
        compared += 1;
    }
    assert_eq!(compared, 3, "cascades");
}

/// The whole table is compared, except for the time that the run took. Warnings are on standard
/// error, and the page does not show them.
#[test]
fn the_table_of_the_readme() {
    let (page, folder) = (Page::read("README.md"), workplace());
    let (_, shown) = blocks(&page)
        .into_iter()
        .find(|(kind, _)| *kind == "text")
        .expect("a table");
    let printed = printed(
        folder.path(),
        &["run", "scenarios/rho025.toml", "--paths", "10000"],
    );
    let timeless = |text: &str| -> Vec<String> {
        let line = |line: &str| {
            line.split_once(" completed in ")
                .map_or(line, |(before, _)| before)
                .to_string()
        };
        text.lines().map(line).collect()
    };
    let (shown, printed) = (timeless(shown), timeless(&printed));
    assert_eq!(shown, printed);
}

/// Every row of a table contains options, the mean stick duration with these options, and its
/// interval.
#[test]
fn stick_durations_by_scheme_and_step() {
    let folder = workplace();
    let rows = Page::read("docs/model.md").rows("`mc run scenarios/rho025.toml` with");
    assert_eq!(rows.len(), 7, "the rows are recognised");
    for row in rows {
        let (options, mean, interval) = (spans(&row[0])[0], &row[1], &row[2]);
        let words = [
            "run scenarios/rho025.toml --paths 10000 --no-bias --force --json",
            options,
        ]
        .join(" ");
        let report = printed(folder.path(), &words.split(' ').collect::<Vec<_>>());
        let report: Value = serde_json::from_str(&report).expect("JSON");
        let number = |key: &str| {
            let number = report["statistics"]["stick_duration_mean"][key]
                .as_f64()
                .expect("a number");
            format!("{number:.4}")
        };
        assert_eq!(*mean, number("estimate"), "{options}");
        assert_eq!(
            *interval,
            format!("{} to {}", number("low"), number("high")),
            "{options}"
        );
    }
}
