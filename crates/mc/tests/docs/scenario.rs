//! docs/scenario.md lists the keys, schemes, warnings and shipped scenarios that the code has.

use super::markdown::{Page, names, same};
use std::collections::BTreeSet;
use stickslip::advice::Warning;
use stickslip::config::{SHIPPED, keys, symbol_and_meaning};
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

/// A key of the table of keys as the page writes it. The parameters have names of the user's own.
fn written(key: &str) -> String {
    key.replace("harmonics.0.", "harmonics.")
}

#[test]
fn every_key_is_listed_and_every_listed_key_exists() {
    let of_code: BTreeSet<String> = keys().iter().map(|key| written(key)).collect();
    // The page has the array of harmonics and the table of parameters, whose keys it lists or are
    // free.
    let containers = ["temperature.harmonics", "parameters"].map(String::from);
    let of_code = of_code.into_iter().chain(containers).collect();
    same(&first_column(&page(), "key"), &of_code);
}

#[test]
fn the_symbol_of_every_key_stands_in_its_row() {
    let mut compared = 0;
    for row in page().rows("key") {
        for key in names(&row[0]) {
            let Some((symbol, _)) = symbol_and_meaning(&key) else {
                continue;
            };
            let words = row[1].split(|c: char| c.is_whitespace() || ",;:".contains(c));
            assert!(
                symbol.is_empty() || words.into_iter().any(|word| word == symbol),
                "{key}: {symbol} is not in {:?}",
                row[1]
            );
            compared += usize::from(!symbol.is_empty());
        }
    }
    assert!(compared > 20, "{compared} symbols");
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
