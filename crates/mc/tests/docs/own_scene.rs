//! The systems of docs/own-scene.md are scenarios that can be simulated.

use super::markdown::{Page, names};
use stickslip::config::shipped;
use stickslip::engine::Run;
use stickslip::model::{NamedSeries, Series};
use stickslip::scenario::Scenario;

/// The key of a line of TOML.
fn key(line: &str) -> &str {
    line.split_once('=').expect("a key and a value").0.trim()
}

/// The keys of a system, and the lines of the remainder whose keys it does not have.
fn completed(lines: &[String], remainder: &str) -> String {
    // White noise has no intensity.
    let replaced = |line: &str| {
        key(line)
            .replace("noise.intensity", "noise.kind")
            .to_string()
    };
    let is_new = |line: &&str| {
        !lines
            .iter()
            .any(|own| key(own) == key(line) || key(own) == replaced(line))
    };
    lines
        .iter()
        .map(String::as_str)
        .chain(remainder.lines().filter(is_new))
        .collect::<Vec<_>>()
        .join("\n")
}

/// Every row of the table names a shipped scenario, or a section with one, or the keys of a system,
/// which are one together with the remainder. None of its paths diverges.
#[test]
fn every_system_of_the_page_is_simulated() {
    let page = Page::read("docs/own-scene.md");
    let block = |of: &str| {
        let (_, after) = page.text.split_once(of).expect("a section");
        let (_, after) = after.split_once("```toml\n").expect("a scenario");
        after.split_once("```").expect("its end").0
    };
    let rows = page.rows("your system");
    assert!(rows.len() >= 12, "systems are recognised: {}", rows.len());
    for row in rows {
        let lines = names(&row[2]);
        let name = lines
            .first()
            .and_then(|line| line.strip_prefix("mc init --from "));
        let text = match name {
            Some(name) => shipped(name).expect("a shipped scenario").text.to_string(),
            None if lines.is_empty() => block("## Base excitation from a record").to_string(),
            None => completed(&lines, block("Each key and its value")),
        };
        let shakes =
            Series::new(vec![0.0, 4.0, 5.0, 10.0], vec![0.0, 9.0, -3.0, 0.0]).expect("a series");
        let record = NamedSeries {
            name: "input.ag".into(),
            series: shakes.into(),
        };
        let inputs: Vec<NamedSeries> = text
            .contains("\ninput.ag")
            .then_some(record)
            .into_iter()
            .collect();
        let scenario = Scenario::parse_measured(&row[0], &text, &[], &inputs);
        let scenario = scenario.unwrap_or_else(|error| panic!("{error}"));
        let outcome = Run::of(&scenario)
            .paths(20)
            .without_bias()
            .simulate()
            .expect("no sink");
        assert_eq!(outcome.summary.completed_paths, 20, "{}", row[0]);
        assert_eq!(outcome.summary.diverged, Vec::<u64>::new(), "{}", row[0]);
    }
}
