//! Answers to words that are no verb and no option: what is probably meant.

use crate::output::failure::Failure;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::path::Path;
use stickslip::config;
use stickslip::stats::Statistic;
use stickslip_files::store;

/// The answer to an error of the argument parser; none if what the parser says is good.
pub fn answered(error: &clap::Error) -> Option<Failure> {
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let word = text(error, ContextKind::InvalidSubcommand)?;
            file_without_verb(word)
                .or_else(|| no_verb(word, error.get(ContextKind::SuggestedSubcommand).is_some()))
        }
        ErrorKind::UnknownArgument if error.get(ContextKind::SuggestedArg).is_none() => {
            no_option(text(error, ContextKind::InvalidArg)?)
        }
        _ => None,
    }
}

fn text(error: &clap::Error, kind: ContextKind) -> Option<&str> {
    match error.get(kind)? {
        ContextValue::String(word) => Some(word),
        _ => None,
    }
}

/// The message where a file stands in the place of a verb, as in `mc mine.toml`: the verbs that
/// take such a file.
fn file_without_verb(word: &str) -> Option<Failure> {
    let path = Path::new(word);
    let is_file = path.is_file()
        || path
            .extension()
            .is_some_and(|ending| ending == "toml" || ending == "h5");
    let is_shipped = config::shipped(word).is_some();
    let remedy = match store::is_sealed(path) {
        _ if is_shipped => {
            format!("write `mc run {word}` to simulate it, or `mc init --from {word}` to change it")
        }
        _ if !is_file => return None,
        Ok(_) => {
            format!("write `mc show {word}` for its results, or `mc plot {word}` for a picture")
        }
        _ => format!("write `mc run {word}` to simulate it, or `mc check {word}` to check it"),
    };
    let what = if is_shipped {
        "a shipped scenario"
    } else {
        "a file"
    };
    Some(Failure::usage(
        format!("{word} is {what}, but a command is missing"),
        remedy,
    ))
}

/// What people look for under the name of a verb, and where it is.
const ELSEWHERE: [(&str, &str); 6] = [
    (
        "list",
        "`mc init --help` lists the shipped scenarios, and `mc --help` the commands",
    ),
    ("scenarios", "`mc init --help` lists the shipped scenarios"),
    (
        "events",
        "`mc run ... --set record.events=true` stores events in the file, and `mc replay FILE --path N` \
            prints one path's",
    ),
    (
        "statistics",
        "`mc show FILE` prints the statistics of a file, and `mc sweep --help` lists all of them",
    ),
    (
        "keys",
        "`mc check SCENARIO` prints every key of a scenario, and `mc init` every key with a comment",
    ),
    ("simulate", "`mc run SCENARIO` simulates"),
];

fn no_verb(word: &str, is_like_a_verb: bool) -> Option<Failure> {
    let lower = word.to_lowercase();
    let elsewhere = ELSEWHERE
        .iter()
        .find(|(known, _)| *known == lower)
        .map(|(_, remedy)| remedy.to_string());
    let statistic = || {
        let known = Statistic::ALL
            .into_iter()
            .find(|statistic| statistic.name() == lower)?;
        Some(format!(
            "it is a statistic, which `mc show FILE` prints: {}",
            known.words()
        ))
    };
    let key = || {
        (!is_like_a_verb)
            .then(|| config::key_meant(word))
            .flatten()
            .map(|key| of_key(&key))
    };
    let remedy = elsewhere.or_else(statistic).or_else(key)?;
    Some(Failure::usage(format!("unknown command `{word}`"), remedy))
}

fn of_key(key: &str) -> String {
    let meaning = config::symbol_and_meaning(key);
    let meaning = meaning.map_or_else(String::new, |(symbol, meaning)| match symbol {
        "" => format!(" ({meaning})"),
        symbol => format!(" ({symbol}, {meaning})"),
    });
    format!("write `--set {key}=...` for that key of the scenario{meaning}")
}

/// Options of other programs, and what does the same here.
const OPTIONS: [(&str, &str); 7] = [
    ("-n", "`--paths` is the number of paths"),
    ("--n", "`--paths` is the number of paths"),
    ("--samples", "`--paths` is the number of paths"),
    (
        "--stats",
        "`mc show FILE` prints all statistics, and `--format csv` and `--json` print them for programs",
    ),
    (
        "--latex",
        "`mc show FILE --format latex` prints a table for a paper",
    ),
    (
        "--csv",
        "`mc show FILE --format csv` prints comma-separated values",
    ),
    (
        "--format",
        "`mc show FILE --format csv|markdown|latex` prints a table; elsewhere the extension of -o selects the \
            format",
    ),
];

fn no_option(option: &str) -> Option<Failure> {
    if !option.starts_with('-') {
        return None;
    }
    let known = OPTIONS
        .iter()
        .find(|(known, _)| *known == option)
        .map(|(_, remedy)| remedy.to_string());
    let key = || config::key_meant(option.trim_start_matches('-')).map(|key| of_key(&key));
    let remedy = known
        .or_else(key)
        .unwrap_or_else(|| "add `--help` to the command to list its options".to_string());
    Some(Failure::usage(format!("unknown option `{option}`"), remedy))
}
