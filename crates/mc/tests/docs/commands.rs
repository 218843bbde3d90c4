//! Commands that a page shows can be typed: the tests, examples, benchmarks, scenarios and options
//! in them exist.

use super::markdown::{Page, root};
use std::path::{Path, PathBuf};
use stickslip::config::shipped;

/// The words of every span or line of code that begins with `start`, each with its page and text.
fn commands(start: &str) -> Vec<(String, Vec<String>)> {
    let mut found = Vec::new();
    for page in Page::all() {
        // A line of a table that a program printed is not a command.
        let code = page.code().filter(|line| !line.contains("   "));
        let lines = page.spans().into_iter().chain(code).flat_map(|text| text.split(" && "));
        for line in lines.map(|line| line.trim_start_matches(['(', ' '])).filter(|line| line.starts_with(start)) {
            let words = line.split_whitespace().map(|word| word.trim_end_matches(['`', ')']).to_string());
            found.push((format!("{}: {line}", page.path.display()), words.collect()));
        }
    }
    assert!(!found.is_empty(), "no page shows {start}");
    found
}

fn after<'a>(words: &'a [String], flag: &str) -> Option<&'a str> {
    let at = words.iter().position(|word| word == flag)?;
    words.get(at + 1).map(String::as_str)
}

/// The texts of all Rust files at or below a path, each after the path.
fn sources(place: &Path) -> Vec<String> {
    match std::fs::read_dir(place) {
        Ok(entries) => entries.flat_map(|entry| sources(&entry.expect("readable").path())).collect(),
        Err(_) if place.extension().is_some_and(|extension| extension == "rs") => {
            vec![place.to_string_lossy().into_owned() + &std::fs::read_to_string(place).expect("readable")]
        }
        Err(_) => Vec::new(),
    }
}

/// Where tests lie: those of the engine, and those of each crate.
const TESTS: [&str; 3] = ["tests", "crates/mc/tests", "crates/bearing/tests"];

#[test]
fn tests_that_a_page_names_exist() {
    for (shown, words) in commands("cargo test") {
        let Some(file) = after(&words, "--test") else { continue };
        let places = TESTS.map(|folder| root().join(folder).join(file));
        let path: &PathBuf =
            places.iter().find(|path| path.exists()).unwrap_or_else(|| panic!("{shown}: no such test"));
        let of_test = |word: &&String| !word.starts_with('-') && **word != file;
        let Some(filter) = words.iter().skip(2).find(of_test) else { continue };
        // `module::part_of_a_name`, where either may be missing.
        let has = |text: &str| filter.split("::").all(|part| text.contains(part));
        assert!(sources(path).iter().any(|text| has(text)), "{shown}: no test named so");
    }
}

#[test]
fn examples_and_benchmarks_that_a_page_names_exist() {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("the manifest");
    let is_declared = |name: &str| manifest.contains(&format!("name = \"{name}\""));
    for (shown, words) in commands("cargo run") {
        let Some(name) = after(&words, "--example") else { continue };
        let paths = [format!("examples/{name}.rs"), format!("examples/{name}/main.rs")];
        assert!(is_declared(name) || paths.iter().any(|path| root().join(path).exists()), "{shown}");
    }
    for (shown, words) in commands("cargo bench") {
        let name = after(&words, "--bench").unwrap_or_else(|| panic!("{shown}: names none"));
        assert!(is_declared(name), "{shown}");
    }
}

/// clap declares options from the fields of the arguments, and `--help` shows them.
#[test]
fn options_and_scenarios_that_a_page_gives_to_mc_exist() {
    for (shown, words) in commands("mc ") {
        let verb = words[1].as_str();
        if verb.starts_with('-') || ["help", "completions"].contains(&verb) {
            continue;
        }
        let help = super::command::mc(Path::new("."), &[verb, "--help"]);
        assert!(help.status.success(), "{shown}: there is no such verb");
        let help = String::from_utf8_lossy(&help.stdout).into_owned();
        for option in words.iter().map(|word| word.trim_matches(['[', ']'])).filter(|word| word.starts_with("--")) {
            assert!(help.contains(option), "{shown}: mc {verb} has no {option}");
        }
        for word in words.iter().filter_map(|word| word.strip_prefix("scenarios/")?.strip_suffix(".toml")) {
            let is_placeholder = word.chars().all(char::is_uppercase);
            assert!(is_placeholder || shipped(word).is_some(), "{shown}: there is no such scenario");
        }
    }
}
