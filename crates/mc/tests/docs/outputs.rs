//! The output that a page shows beside a command is what the command prints, and what a notebook
//! quotes is what the package says.

use super::markdown::{Page, root, spans};
use serde_json::Value;
use std::path::Path;
use stickslip::config::{Override, shipped};

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

/// The scenario that the first run changes, as its page says.
fn mine() -> String {
    let page = Page::read("docs/first-run.md").text;
    let text = shipped("rho025").expect("a shipped scenario").text;
    let edits = [
        ("static = 1.2", "static = 1.4"),
        ("end = 60.0", "end = 150.0"),
    ];
    edits.iter().fold(text.to_string(), |text, (from, to)| {
        assert!(
            page.contains(&format!("`{to}`")) && text.contains(from),
            "{to}"
        );
        text.replace(&format!("\n{from}"), &format!("\n{to}"))
    })
}

/// Wherever a block of text follows a block of commands, the commands print these lines in this
/// order, perhaps with other lines before, between and after them.
#[test]
fn commands_print_the_text_below_them() {
    let folder = workplace();
    std::fs::write(folder.path().join("mine.toml"), mine()).expect("room");
    let pages = ["docs/model.md", "docs/first-run.md"].map(Page::read);
    let pairs = pages.iter().flat_map(|page| {
        let blocks = blocks(page);
        let pairs = blocks.windows(2).map(|pair| (pair[0], pair[1]));
        let is_shown = |pair: &((&str, _), (&str, _))| (pair.0.0, pair.1.0) == ("sh", "text");
        pairs.filter(is_shown).collect::<Vec<_>>()
    });
    let mut compared = 0;
    for pair in pairs {
        let pair = [pair.0, pair.1];
        let lines = pair[0].1.lines().flat_map(|line| line.split(" && "));
        let commands = lines.filter_map(|line| line.strip_prefix("mc "));
        let printed: String = commands
            .map(|line| printed(folder.path(), &line.split_whitespace().collect::<Vec<_>>()))
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
    assert_eq!(compared, 5, "blocks of text");
}

/// A notebook quotes in backticks, in five words or more, how a warning begins that the package
/// gives for the paper's scenario at one of these steps.
#[test]
fn a_notebook_quotes_warnings_as_they_are_worded() {
    let warnings: String = ["0.0025", "0.01", "0.05", "0.2"]
        .iter()
        .flat_map(|step| {
            let set = [format!("time.step={step}"), "time.output_step=1".into()];
            let set = set.map(|text| Override::set(&text).expect("well formed"));
            let scenario = shipped("rho025")
                .expect("shipped")
                .parse(&set)
                .expect("valid");
            scenario.warnings()
        })
        .map(|warning| format!("{warning}\n"))
        .collect();
    let mut quotes = 0;
    for notebook in ["lesson", "tutorial", "motion"] {
        let text = Page::read(format!("examples/{notebook}.ipynb")).text;
        let cells: Value = serde_json::from_str(&text).expect("JSON");
        let cells = cells["cells"].as_array().expect("cells");
        let prose = cells.iter().filter(|cell| cell["cell_type"] == "markdown");
        let text: String = prose
            .map(|cell| match &cell["source"] {
                Value::Array(lines) => lines.iter().filter_map(Value::as_str).collect(),
                text => text.as_str().unwrap_or_default().to_string() + "\n",
            })
            .collect();
        for line in text.lines() {
            let is_quote = |span: &&str| {
                let words = span.split(' ').collect::<Vec<_>>();
                words.len() > 4 && !["mc", "pip"].contains(&words[0])
            };
            for quote in spans(line).into_iter().filter(is_quote) {
                assert!(warnings.contains(quote), "{notebook}: {quote}\n{warnings}");
                quotes += 1;
            }
        }
    }
    assert!(quotes > 3, "quotes are recognised: {quotes}");
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
