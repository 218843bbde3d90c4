//! Messages for common mistakes: a file without a command, a file too many, and options with other
//! names.

use crate::output::failure::Failure;
use clap::CommandFactory as _;
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
            let given = word(ContextKind::InvalidArg)?;
            let all = crate::Arguments::command();
            let mut words = std::env::args_os().skip(1);
            unknown(given, words.find_map(|word| all.find_subcommand(word))?)
        }
        _ => None,
    }
}

/// The message for an argument that a command does not have: the option or the key that is probably
/// meant.
fn unknown(given: &str, command: &clap::Command) -> Option<Failure> {
    let options: Vec<&str> = command
        .get_arguments()
        .filter_map(|argument| argument.get_long())
        .collect();
    let Some(option) = given.strip_prefix('-') else {
        let remedy =
            format!("write `--temperature-file {given}` for a separate file of temperatures");
        let takes = options.contains(&"temperature-file");
        return takes.then(|| Failure::usage(format!("one file too many: {given}"), remedy));
    };
    let name = option.trim_start_matches('-');
    let key = config::key_meant(name).filter(|_| options.contains(&"set"));
    let remedy = match (config::option_meant(name, &options), key) {
        (Some(option), _) => format!("write `--{option}`"),
        (None, Some((key, meaning))) => {
            format!("write `--set {key}=...` for that key of the scenario ({meaning})")
                .replace(" ()", "")
        }
        (None, None) => format!("`mc {} --help` lists its options", command.get_name()),
    };
    Some(Failure::usage(format!("unknown option `{given}`"), remedy))
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
