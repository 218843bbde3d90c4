//! docs/scenario.md lists the warnings and shipped scenarios that the code has, docs/model.md the
//! schemes, and docs/keys.md the keys.

use super::markdown::{Page, names, root, same};
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

const KEYS: &str = "docs/keys.md";

/// The page of keys: a table for each table of a scenario.
fn page_of_keys() -> String {
    let mut text = "# Keys

Every key of [a scenario](scenario.md); this page is generated from their declarations.
Units are those of the scenario: `mass` stands for force time^2 / length.
"
    .to_string();
    let mut table = None;
    for key in keys() {
        let of = key
            .key
            .rsplit_once('.')
            .map_or("title, parameters", |(table, _)| table);
        let of = of.trim_end_matches(".0");
        if table.as_deref() != Some(of) {
            text += &format!(
                "\n## `{of}`\n\n| key | symbol | meaning | unit | default | allowed |\n|---|---|---|---|---|---|\n"
            );
            table = Some(of.to_string());
        }
        let name = format!("`{}`", key.key);
        let cells = [
            &name,
            key.symbol,
            key.meaning,
            key.unit,
            key.default,
            key.allowed,
        ];
        let cells = cells.map(|cell| format!(" {} ", cell.replace('|', "\\|")).replace("  ", " "));
        text += &format!("|{}|\n", cells.join("|"));
    }
    text
}

#[test]
fn the_page_of_keys_is_generated_from_their_declarations() {
    let (path, generated) = (root().join(KEYS), page_of_keys());
    if std::env::var_os("REWRITE_PAGES").is_some() {
        std::fs::write(&path, &generated).expect("written");
    }
    assert!(
        std::fs::read_to_string(path).is_ok_and(|text| text == generated),
        "{KEYS} is not as the keys are declared; `REWRITE_PAGES=1 cargo test --release -p stickslip-mc \
         --test docs page_of_keys` writes it"
    );
}

/// A key that a page names in code, with its table, exists.
#[test]
fn keys_that_pages_name_exist() {
    let known: BTreeSet<String> = keys().into_iter().map(|key| key.key).collect();
    let tables: BTreeSet<&str> = known
        .iter()
        .filter_map(|key| key.split('.').next())
        .collect();
    let is_key = |span: &str| {
        let is_name = span
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "._".contains(c));
        let (table, rest) = span.split_once('.').unwrap_or(("", ""));
        is_name && tables.contains(table) && !["toml", "rs"].contains(&rest)
    };
    let mut named = 0;
    for page in Page::all() {
        for span in page.spans().into_iter().filter(|span| is_key(span)) {
            let is_part = known
                .iter()
                .any(|key| *key == span || key.starts_with(&format!("{span}.")));
            let is_of_list = symbol_and_meaning(span).is_some();
            assert!(
                is_part || is_of_list,
                "{}: there is no key `{span}`",
                page.path.display()
            );
            named += 1;
        }
    }
    assert!(named > 100, "keys are recognised: {named}");
}

#[test]
fn every_scheme_is_listed() {
    let of_code = Kind::ALL
        .iter()
        .map(|kind| kind.name().to_string())
        .collect();
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
