//! The systems of docs/own-scene.md are scenarios that can be simulated.

use super::markdown::{Page, names};
use stickslip::engine::Run;
use stickslip::model::{NamedSeries, Series};
use stickslip::scenario::Scenario;

/// The key of a line of TOML.
fn key(line: &str) -> &str {
    line.split_once('=').expect("a key and a value").0.trim()
}

/// Every row of the table has the keys of a system. Together with the lines of the remainder whose
/// keys it does not have, they are a scenario, and none of its paths diverges.
#[test]
fn every_system_of_the_page_is_simulated() {
    let page = Page::read("docs/own-scene.md");
    let (_, after) = page.text.split_once("```toml\n").expect("the remainder");
    let (remainder, _) = after.split_once("```").expect("its end");
    let rows = page.rows("your system");
    assert!(rows.len() >= 12, "systems are recognised: {}", rows.len());
    for row in rows {
        let lines = names(&row[2]);
        // White noise has no intensity.
        let of = |line: &str| {
            key(line)
                .replace("noise.intensity", "noise.kind")
                .to_string()
        };
        let is_new = |line: &&str| {
            !lines
                .iter()
                .any(|own| key(own) == key(line) || key(own) == of(line))
        };
        let text = lines
            .iter()
            .map(String::as_str)
            .chain(remainder.lines().filter(is_new))
            .collect::<Vec<_>>();
        let shakes =
            Series::new(vec![0.0, 4.0, 5.0, 10.0], vec![0.0, 9.0, -3.0, 0.0]).expect("a series");
        let record = NamedSeries {
            name: "input.ag".into(),
            series: shakes.into(),
        };
        let inputs: Vec<NamedSeries> = text
            .iter()
            .any(|line| line.starts_with("input.ag"))
            .then_some(record)
            .into_iter()
            .collect();
        let scenario = Scenario::parse_measured(&row[0], &text.join("\n"), &[], &inputs);
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
