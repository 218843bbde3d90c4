//! Messages for two common mistakes: a file without a command, and keys of a scenario written as
//! options.

use crate::output::failure::Failure;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::path::Path;
use stickslip::config;
use stickslip_files::store;

/// A better message for an error of the argument parser; none if the parser's own is good.
pub fn answered(error: &clap::Error) -> Option<Failure> {
    let word = |kind| match error.get(kind)? {
        ContextValue::String(word) => Some(word.as_str()),
        _ => None,
    };
    match error.kind() {
        ErrorKind::InvalidSubcommand => file_without_verb(word(ContextKind::InvalidSubcommand)?),
        ErrorKind::UnknownArgument => {
            let option = word(ContextKind::InvalidArg)?;
            let name = option.strip_prefix('-')?.trim_start_matches('-');
            // Every option that contains a letter is similar to it, as `--until` to `--n`.
            if name.len() > 2 && error.get(ContextKind::SuggestedArg).is_some() {
                return None;
            }
            let key = config::key_meant(name);
            let remedy = key.map_or_else(
                || "add `--help` to the command to list its options".to_string(),
                |(key, meaning)| {
                    format!("write `--set {key}=...` for that key of the scenario ({meaning})")
                        .replace(" ()", "")
                },
            );
            Some(Failure::usage(format!("unknown option `{option}`"), remedy))
        }
        _ => None,
    }
}

/// The message for a file in the place of a verb, as in `mc mine.toml`: the verbs that take such a
/// file.
fn file_without_verb(word: &str) -> Option<Failure> {
    let path = Path::new(word);
    let is_shipped = config::shipped(word).is_some();
    let is_result = store::has_checksum(path).is_ok();
    let is_file =
        is_result || path.is_file() || [".toml", ".h5"].iter().any(|end| word.ends_with(end));
    let (what, remedy) = match (is_shipped, is_result) {
        (true, _) => (
            "a shipped scenario",
            format!("`mc run {word}` to simulate it, or `mc init --from {word}` to change it"),
        ),
        (_, true) => (
            "a file",
            format!("`mc show {word}` for its results, or `mc plot {word}` for a picture"),
        ),
        _ => (
            "a file",
            format!("`mc run {word}` to simulate it, or `mc check {word}` to check it"),
        ),
    };
    (is_shipped || is_file).then(|| {
        let problem = format!("{word} is {what}, but a command is missing");
        Failure::usage(problem, format!("write {remedy}"))
    })
}
