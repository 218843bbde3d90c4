//! The modules of `src/` without tests, and which of them uses items of which.

use super::markdown::root;
use super::source::{all, code, is_word, item_length};
use std::collections::{BTreeMap, BTreeSet};

/// The segments of a path such as `crate::stats::Record`. `*` stands for everything in a module.
pub type Segments = Vec<String>;

/// The words and punctuation marks of the code; `::` is one mark.
fn tokens(code: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let mut chars = code.chars().peekable();
    while let Some(c) = chars.next() {
        if is_word(c) {
            let mut word = c.to_string();
            while let Some(next) = chars.next_if(|next| is_word(*next)) {
                word.push(next);
            }
            tokens.push(word);
        } else if c == ':' && chars.next_if_eq(&':').is_some() {
            tokens.push("::".into());
        } else if !c.is_whitespace() {
            tokens.push(c.into());
        }
    }
    tokens
}

/// Collects the paths of the `use` tree that starts at token `i`. Returns the token behind it.
fn path_tree(tokens: &[String], mut i: usize, prefix: &[String], found: &mut Vec<Segments>) -> usize {
    let mut path = prefix.to_vec();
    loop {
        match tokens.get(i).map(String::as_str) {
            Some("{") if path.len() == prefix.len() || tokens[i - 1] == "::" => {
                i += 1;
                while i < tokens.len() && tokens[i] != "}" {
                    i = path_tree(tokens, i, &path, found);
                    while i < tokens.len() && ![",", "}"].contains(&tokens[i].as_str()) {
                        i += 1;
                    }
                    i += usize::from(tokens.get(i).is_some_and(|token| token == ","));
                }
                return i + 1;
            }
            Some(word) if word == "*" || word.starts_with(is_word) => path.push(word.to_string()),
            _ => return i,
        }
        i += 1;
        if tokens.get(i).is_none_or(|token| token != "::") || tokens.get(i + 1).is_some_and(|token| token == "<") {
            found.push(path);
            return i;
        }
        i += 1;
    }
}

/// The modules of `src/` that are compiled without tests, by their absolute paths.
pub struct Modules(pub BTreeMap<Segments, Module>);

/// The paths that a module contains.
#[derive(Default)]
pub struct Module {
    /// The absolute path of each name that the module imports. Other modules may use the name from
    /// here.
    imports: BTreeMap<String, Segments>,
    /// The absolute paths that the module uses itself: all but those that it only exports again
    /// with `pub use`.
    paths: Vec<Segments>,
}

impl Modules {
    /// Reads all modules.
    pub fn read() -> Modules {
        let files = compiled();
        let names: BTreeSet<Segments> = files.iter().map(|(place, _)| place.clone()).collect();
        let mut modules: BTreeMap<Segments, Module> = BTreeMap::new();
        for (place, code) in files {
            // main.rs and lib.rs have the same path.
            modules.entry(place.clone()).or_default().add(&place, &code, &names);
        }
        Modules(modules)
    }

    /// The other modules that define the items that a module uses.
    pub fn known(&self, place: &Segments) -> BTreeSet<Segments> {
        self.0[place].paths.iter().filter_map(|path| self.home(path, 0)).filter(|home| home != place).collect()
    }

    /// The module that defines the item at an absolute path, found through the imports of the
    /// modules on the way.
    fn home(&self, path: &[String], depth: usize) -> Option<Segments> {
        let length = (1..=path.len()).rev().find(|length| self.0.contains_key(&path[..*length]))?;
        let (place, rest) = path.split_at(length);
        let import = rest.first().and_then(|name| self.0[place].imports.get(name));
        match import.filter(|_| depth < 8) {
            Some(import) => self.home(import, depth + 1),
            None => Some(place.to_vec()),
        }
    }
}

impl Module {
    fn add(&mut self, place: &Segments, code: &str, modules: &BTreeSet<Segments>) {
        let tokens = tokens(code);
        let mut i = 0;
        while i < tokens.len() {
            let (start, mut found) = (i, Vec::new());
            let is_import = tokens[i] == "use";
            if is_import || (tokens[i].starts_with(is_word) && tokens.get(i + 1).is_some_and(|next| next == "::")) {
                i = path_tree(&tokens, i + usize::from(is_import), &[], &mut found);
            }
            i = i.max(start + 1);
            let is_passed_on = is_import && is_public(&tokens[..start]);
            for path in found.iter().filter_map(|path| absolute(place, path, modules)) {
                if let Some(name) = path.last().filter(|_| is_import) {
                    self.imports.insert(name.clone(), path.clone());
                }
                if !is_passed_on {
                    self.paths.push(path);
                }
            }
        }
    }
}

/// Whether `pub` or `pub(...)` is the last of these tokens.
fn is_public(tokens: &[String]) -> bool {
    let end = match tokens.last().map(String::as_str) {
        Some(")") => tokens.iter().rposition(|token| token == "(").unwrap_or(0),
        _ => tokens.len(),
    };
    tokens[..end].last().is_some_and(|token| token == "pub")
}

/// The absolute path of a path in a module, if it is in this crate.
fn absolute(place: &Segments, path: &[String], modules: &BTreeSet<Segments>) -> Option<Segments> {
    let child = [place.as_slice(), &path[..1]].concat();
    let (mut base, mut rest) = match path[0].as_str() {
        "crate" | "stick_slip" => (Vec::new(), &path[1..]),
        "self" => (place.clone(), &path[1..]),
        "super" => (place.clone(), path),
        _ if modules.contains(&child) => (child, &path[1..]),
        _ => return None,
    };
    while rest.first().is_some_and(|first| first == "super") {
        base.pop();
        rest = &rest[1..];
    }
    base.extend(rest.iter().filter(|segment| *segment != "self" && *segment != "*").cloned());
    Some(base)
}

/// Every file of the source that is not for tests only: its module, and its code without tests.
pub fn compiled() -> Vec<(Segments, String)> {
    let source = root().join("src");
    let files: Vec<(Segments, String)> = all(&source)
        .into_iter()
        .map(|(path, text)| {
            let place = path.strip_prefix(&source).expect("below src").with_extension("");
            let mut place: Segments = place.iter().map(|part| part.to_string_lossy().into_owned()).collect();
            place.pop_if(|last| ["mod", "lib", "main"].contains(&last.as_str()));
            (place, code(&text))
        })
        .collect();
    let for_tests: Vec<Segments> = files.iter().flat_map(|(place, code)| test_modules(place, code)).collect();
    // A folder `tests` holds what the tests of several modules share.
    let is_shared = |place: &Segments| place.iter().any(|part| part == "tests");
    let is_compiled = |place: &Segments| !is_shared(place) && !for_tests.iter().any(|test| place.starts_with(test));
    files
        .into_iter()
        .filter(|(place, _)| is_compiled(place))
        .map(|(place, code)| (place, without_tests(&code)))
        .collect()
}

/// The modules that a file declares for tests only.
fn test_modules(place: &Segments, code: &str) -> Vec<Segments> {
    let items = code.split(TEST).skip(1).map(|after| tokens(&after[..item_length(after)]));
    let names = items.filter_map(|item| {
        let at = item.iter().position(|word| word == "mod")?;
        (item.last()? == ";").then(|| item[at + 1].clone())
    });
    names.map(|name| [place.as_slice(), &[name]].concat()).collect()
}

const TEST: &str = "#[cfg(test)]";

/// The code without the items that are compiled for tests only.
fn without_tests(code: &str) -> String {
    let mut out = String::new();
    let mut rest = code;
    while let Some((before, after)) = rest.split_once(TEST) {
        out.push_str(before);
        rest = &after[item_length(after)..];
    }
    out + rest
}
