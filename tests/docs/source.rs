//! The source as a list of files, and the code in them without comments.

use super::markdown::root;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Every Rust file at or below a path, with its text.
pub fn all(place: &Path) -> Vec<(PathBuf, String)> {
    let place = root().join(place);
    if place.is_file() {
        let text = fs::read_to_string(&place).expect("readable");
        return vec![(place, text)];
    }
    let mut entries: Vec<PathBuf> =
        fs::read_dir(&place).expect("a folder").map(|entry| entry.expect("readable").path()).collect();
    entries.sort();
    let is_source = |path: &PathBuf| path.is_dir() || path.extension().is_some_and(|extension| extension == "rs");
    entries.into_iter().filter(is_source).flat_map(|path| all(&path)).collect()
}

/// The text of the only file of `src/` with this name.
pub fn find(name: &str) -> String {
    let mut files: Vec<_> = all("src".as_ref()).into_iter().filter(|(path, _)| path.ends_with(name)).collect();
    assert_eq!(files.len(), 1, "one file is called {name}");
    files.remove(0).1
}

/// The text without comments.
pub fn code_and_texts(text: &str) -> String {
    stripped(text, true)
}

/// The text without comments and without the contents of string literals.
pub fn code(text: &str) -> String {
    stripped(text, false)
}

fn stripped(text: &str, with_texts: bool) -> String {
    let c: Vec<char> = text.chars().collect();
    let at = |i: usize| c.get(i).copied().unwrap_or('\0');
    let (mut out, mut i) = (String::new(), 0);
    while i < c.len() {
        let raw_hashes = (1..4).take_while(|n| at(i + n) == '#').count();
        let is_raw =
            at(i) == 'r' && at(i + 1 + raw_hashes) == '"' && !(i > 0 && is_word(at(i - 1)) && at(i - 1) != 'b');
        if at(i) == '/' && at(i + 1) == '/' {
            while i < c.len() && at(i) != '\n' {
                i += 1;
            }
        } else if at(i) == '/' && at(i + 1) == '*' {
            while i < c.len() && !(at(i) == '*' && at(i + 1) == '/') {
                i += 1;
            }
            i += 2;
        } else if is_raw || at(i) == '"' {
            let start = if is_raw { i + 2 + raw_hashes } else { i + 1 };
            let closes = |j: usize| at(j) == '"' && (!is_raw || (1..=raw_hashes).all(|n| at(j + n) == '#'));
            let mut j = start;
            while j < c.len() && !closes(j) {
                j += if at(j) == '\\' && !is_raw { 2 } else { 1 };
            }
            let inside: String = if with_texts { c[start..j.min(c.len())].iter().collect() } else { String::new() };
            out.push_str(&format!("\"{inside}\""));
            i = j + 1 + if is_raw { raw_hashes } else { 0 };
        } else if at(i) == '\'' && (at(i + 2) == '\'' || at(i + 1) == '\\') {
            // A character literal, not a lifetime.
            i += 2;
            while i < c.len() && at(i) != '\'' {
                i += 1;
            }
            i += 1;
            out.push_str("' '");
        } else {
            out.push(at(i));
            i += 1;
        }
    }
    out
}

/// Whether the character can be part of a name.
pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The contents of the string literals, in order.
pub fn texts(code_and_texts: &str) -> Vec<String> {
    code_and_texts.split('"').skip(1).step_by(2).map(String::from).collect()
}

/// The words of a text.
pub fn words(text: &str) -> BTreeSet<String> {
    text.split(|c| !is_word(c)).filter(|word| !word.is_empty()).map(String::from).collect()
}

/// The length of the item that begins the code: up to its semicolon, or to the brace that closes
/// it.
pub fn item_length(code: &str) -> usize {
    let mut depth = 0;
    for (i, c) in code.char_indices() {
        match c {
            ';' if depth == 0 => return i + 1,
            '{' => depth += 1,
            '}' if depth == 1 => return i + 1,
            '}' => depth -= 1,
            _ => {}
        }
    }
    code.len()
}

/// For each type, trait and implementation in a file, the words before its opening brace, and the
/// text between its braces.
pub fn blocks(code: &str) -> Vec<(BTreeSet<String>, &str)> {
    let starts = ["impl", "struct ", "enum ", "trait "].into_iter().flat_map(|start| code.match_indices(start));
    let block = |(at, _): (usize, &str)| {
        let block = &code[at..at + item_length(&code[at..])];
        block.split_once('{').map(|(head, body)| (words(head), body))
    };
    starts.filter_map(block).collect()
}
