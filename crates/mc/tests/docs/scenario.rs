//! docs/scenario.md lists the keys, schemes, warnings and shipped scenarios that the code has.

use super::markdown::{Page, names, same};
use std::collections::BTreeSet;
use stickslip::advice::Warning;
use stickslip::config::{Override, SHIPPED, shipped};
use stickslip::scenario::Scenario;
use stickslip::scheme::Kind;

fn page() -> Page {
    Page::read("docs/scenario.md")
}

fn first_column(page: &Page, heading: &str) -> BTreeSet<String> {
    page.rows(heading)
        .iter()
        .flat_map(|row| names(&row[0]))
        .collect()
}

/// The dotted keys of a resolved scenario. The array of harmonics is a key of its own, and so is a
/// table of parameters, whose keys are names of the user's own.
fn keys(table: &toml::Table, path: &str, into: &mut BTreeSet<String>) {
    for (name, value) in table {
        let key = if path.is_empty() {
            name.clone()
        } else {
            format!("{path}.{name}")
        };
        match value {
            toml::Value::Table(table) if name != "parameters" => keys(table, &key, into),
            toml::Value::Array(tables) => {
                tables
                    .iter()
                    .filter_map(toml::Value::as_table)
                    .for_each(|table| keys(table, &key, into));
                into.insert(key);
            }
            _ => drop(into.insert(key)),
        }
    }
}

#[test]
fn every_key_is_listed_and_every_listed_key_exists() {
    let mut of_code = BTreeSet::new();
    for scheme in Kind::ALL {
        let given = ["statistics.period=5", "statistics.levels=[1.0]"];
        let given = given.map(|set| Override::set(set).expect("well formed"));
        let set: Vec<Override> = given
            .into_iter()
            .chain([Override::flag("--scheme", "scheme.kind", scheme.name())])
            .collect();
        let text = shipped("rho025").expect("shipped").text;
        let resolved = Scenario::parse("rho025", text, &set)
            .expect("sound")
            .to_toml();
        keys(&resolved.parse().expect("TOML"), "", &mut of_code);
    }
    // A scenario with a measured temperature and a bearing.
    let given = [
        "temperature.series.zone=UTC",
        "temperature.series.unit=degC",
        "temperature.series.dates=ymd",
        "temperature.series.skip=0",
        "temperature.series.missing=[-9999]",
        "temperature.series.outliers=8",
        "temperature.series.decimal=\",\"",
        "temperature.series.averaged=0",
        "temperature.noise={intensity=1, pinned=true}",
    ];
    let given = given.map(|set| Override::set(set).expect("well formed"));
    let measured = shipped("bridge")
        .expect("shipped")
        .parse(&given)
        .expect("sound")
        .to_toml();
    keys(&measured.parse().expect("TOML"), "", &mut of_code);
    // A body on a belt, and a force of the user's own with parameters; both with a load on friction.
    for (name, parameters) in [
        ("belt", "parameters={c=1, f_d=1}"),
        ("stribeck-belt", "parameters={c=1, d=0.1, f_d=1}"),
    ] {
        let given = [
            "initial.velocity=1",
            "friction.load=\"c\"",
            "friction.dynamic=f_d",
            parameters,
        ];
        let given = given.map(|set| Override::set(set).expect("well formed"));
        let resolved = shipped(name)
            .expect("shipped")
            .parse(&given)
            .expect("sound")
            .to_toml();
        keys(&resolved.parse().expect("TOML"), "", &mut of_code);
    }
    // White noise.
    let given = [
        "temperature.noise={kind=\"white\", strength=1}",
        "friction.static=1",
        "scheme.kind=event-driven",
    ];
    let given = given.map(|set| Override::set(set).expect("well formed"));
    let resolved = shipped("shaw")
        .expect("shipped")
        .parse(&given)
        .expect("sound")
        .to_toml();
    keys(&resolved.parse().expect("TOML"), "", &mut of_code);
    // An input.
    let here = tempfile::tempdir().expect("a folder");
    let stamps = "time,N\n2020-01-01 00:00,1\n2020-01-01 00:10,2\n";
    std::fs::write(here.path().join("n.csv"), stamps).expect("written");
    std::fs::write(here.path().join("n.txt"), "1 2 3\n").expect("written");
    for input in [
        "input.NAME={file=\"n.csv\", column=\"N\", unit=\"kN\", zone=\"UTC\", dates=\"ymd\", skip=0, decimal=\".\"}",
        "input.NAME={file=\"n.txt\", step=60}",
    ] {
        let given = [input, "force.expression=NAME", "time.end=60"]
            .map(|set| Override::set(set).expect("well formed"));
        let name = here.path().join("input.toml").display().to_string();
        let resolved = Scenario::parse(&name, shipped("belt").expect("shipped").text, &given)
            .expect("sound")
            .to_toml();
        keys(&resolved.parse().expect("TOML"), "", &mut of_code);
    }
    // A run has no use for displacements, so its resolved scenario has none of their keys.
    let of_displacements = [
        "file", "value", "unit", "time", "zone", "dates", "skip", "missing", "outliers", "decimal",
        "averaged",
    ];
    of_code.extend(of_displacements.map(|key| format!("displacement.series.{key}")));
    same(&first_column(&page(), "key"), &of_code);
}

#[test]
fn every_scheme_is_listed() {
    let of_code: BTreeSet<String> = Kind::ALL
        .iter()
        .map(|kind| kind.name().to_string())
        .collect();
    let in_quotes = of_code.iter().map(|name| format!("\"{name}\"")).collect();
    same(&first_column(&page(), "`scheme.kind`"), &in_quotes);
    same(
        &first_column(&Page::read("docs/model.md"), "`scheme.kind`"),
        &of_code,
    );
}

#[test]
fn every_shipped_scenario_is_listed() {
    same(
        &first_column(&page(), "`mc init --from`"),
        &SHIPPED.map(|shipped| shipped.name.to_string()).into(),
    );
}

#[test]
fn every_warning_is_listed() {
    let of_code: BTreeSet<String> = Warning::names().map(str::to_string).collect();
    assert_eq!(
        of_code.len(),
        Warning::names().count(),
        "each warning has a name of its own"
    );
    same(&first_column(&page(), "name (`--json`)"), &of_code);
}
