//! docs/commands.md describes the JSON objects that the program prints.

use crate::command::mc;
use crate::markdown::{Page, root};
use serde_json::Value;
use std::collections::BTreeSet;

/// Objects whose keys are names of statistics, quantities or keys of a scenario. All of these names
/// have the same description.
const NAMED: [&str; 6] = [
    "statistics",
    "parameters",
    "derived",
    "attrs",
    "coords",
    "data_vars",
];

/// Collects the path of every value that is not an object.
fn paths(value: &Value, path: &str, into: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => {
            let is_named = NAMED.contains(&path.rsplit('.').next().unwrap_or_default());
            for (key, value) in map {
                let name = if is_named { "*" } else { key };
                let below = if path.is_empty() {
                    name.to_string()
                } else {
                    format!("{path}.{name}")
                };
                paths(value, &below, into);
            }
        }
        Value::Array(items) if items.iter().any(Value::is_object) => {
            items
                .iter()
                .for_each(|item| paths(item, &format!("{path}[]"), into));
        }
        _ => drop(into.insert(path.to_string())),
    }
}

/// The keys that the page lists for a kind of object, and those that all objects have.
fn documented(kind: &str) -> BTreeSet<String> {
    let page = Page::read("docs/commands.md").section("## JSON").text;
    let mut parts = page.split("\n### ");
    let opening = parts.next().expect("an opening");
    let part = parts
        .find(|part| part.lines().next() == Some(kind))
        .unwrap_or_else(|| panic!("no part `{kind}`"));
    let rows = opening
        .lines()
        .chain(part.lines())
        .filter(|line| line.starts_with("| `"));
    let keys = rows.flat_map(|row| {
        row.split('|')
            .nth(1)
            .unwrap_or_default()
            .split(", ")
            .map(|key| key.trim().trim_matches('`'))
    });
    keys.map(str::to_string).collect()
}

/// Every key of every object is on the page under its kind, alone or with all keys of the object
/// that it is in, or has the name of a variable or an attribute of the output file; and an object
/// begins with its kind.
#[test]
fn every_key_of_every_object_is_described() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = |name: &str| root().join("scenarios").join(name).display().to_string();
    let bridge = |name: &str| {
        root()
            .join("examples/bridge")
            .join(name)
            .display()
            .to_string()
    };
    let (rho025, bearing, data) = (
        scenario("rho025.toml"),
        bridge("bridge.toml"),
        bridge("twin.csv"),
    );
    let lines: [(&str, Vec<&str>); 11] = [
        (
            "run",
            vec![
                "run",
                &rho025,
                "--paths",
                "512",
                "--set",
                "statistics.after=20",
                "-o",
                "a.h5",
            ],
        ),
        ("run", vec!["show", "a.h5"]),
        ("check", vec!["check", &rho025]),
        (
            "data set",
            vec!["trade", &rho025, "--budget", "2s", "-o", "trade.h5"],
        ),
        ("data set", vec!["show", "trade.h5"]),
        (
            "data set",
            vec![
                "sweep",
                &rho025,
                "--paths",
                "256",
                "--vary",
                "friction.static=1.2,1.3",
                "-o",
                "sweep.h5",
            ],
        ),
        (
            "data set",
            vec![
                "sweep",
                &rho025,
                "--paths",
                "256",
                "--elasticity",
                "friction.static",
                "-o",
                "star.h5",
            ],
        ),
        ("verification", vec!["verify", "a.h5", "--again"]),
        ("calibration", vec!["calibrate", &bearing, &data]),
        ("weather", vec!["fit-temperature", &data]),
        (
            "data set",
            vec!["forecast", &bearing, &data, "--draws", "2", "--years", "2"],
        ),
    ];
    let format = Page::read("docs/output-format.md");
    let of_file: BTreeSet<&str> = format.spans().into_iter().collect();
    for (kind, mut line) in lines {
        line.push("--json");
        let output = mc(folder.path(), &line);
        assert!(
            output.status.success(),
            "{line:?}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
        let value: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(
            (&value["document"], &value["schema_version"]),
            (&kind.into(), &1.into()),
            "{line:?}"
        );
        let mut found = BTreeSet::new();
        paths(&value, "", &mut found);
        let described = documented(kind);
        // An object that is absent is null, and the page describes the keys that it would have.
        let begins = |key: &str, start: &str| {
            key.strip_prefix(start)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        let is_described = |key: &String| {
            let name = key.rsplit('.').next().unwrap_or_default();
            of_file.contains(name)
                || described
                    .iter()
                    .any(|other| begins(other, key) || begins(key, other))
        };
        let unknown: Vec<&String> = found.iter().filter(|key| !is_described(key)).collect();
        assert!(
            unknown.is_empty(),
            "{line:?}: docs/commands.md does not describe {unknown:?}"
        );
        assert!(found.len() > 8, "{line:?}: {found:?}");
    }
}
