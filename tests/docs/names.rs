//! A text between backticks that looks like a name of the code is one.
//!
//! A file is written with its folder or by its name alone (`stats/totals.rs`, `reading.rs`), an
//! item with its owner (`Splat::impulse`, `noise::MAX_NORMAL_ERROR`), a type alone (`Turn`). Other
//! words are names of data: keys, variables, statistics, options, schemes.
//!
//! A name of a type means one thing.

use super::markdown::{Page, root};
use super::modules::compiled;
use super::source::{all, blocks, code, code_and_texts, is_word, texts, words};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Names that do not belong to this package: of other programs, their types and units, of other
/// packages, a column that benches/peers/report.py prints, and columns of loggers.
const FOREIGN: &[&str] = &[
    "Air_Avg",
    "Mittelwert",
    "T_Mean",
    "agrees",
    "aarch64-unknown-linux-gnu",
    "apt-get",
    "h5diff",
    "h5dump",
    "hdf5-tools",
    "hours",
    "libhdf5-dev",
    "major.minor",
    "nan",
    "ncdump",
    "chromium",
    "netcdf-bin",
    "pkg-config",
    "python3-venv",
    "str",
    "sudo",
    "timedelta64",
    "_FillValue",
    "CF-1.11",
];

/// The source: the path and the code of each file, and all words in the code and its string
/// literals.
struct Source {
    files: Vec<(String, String)>,
    words: BTreeSet<String>,
}

impl Source {
    fn read() -> Source {
        let places = ["src", "tests", "benches", "examples"].map(Path::new);
        let files: Vec<_> = places.iter().flat_map(|place| all(place)).collect();
        let mut known: BTreeSet<String> =
            words(&std::fs::read_to_string(root().join("Cargo.toml")).expect("a manifest"));
        // The modules of the Python package contain the names that users of Python need.
        for entry in std::fs::read_dir(root().join("python/stickslip")).expect("the package for Python") {
            let path = entry.expect("readable").path();
            if path.extension().is_some_and(|ending| ending == "py") {
                known.extend(words(&std::fs::read_to_string(path).expect("text")));
            }
        }
        for (_, text) in &files {
            known.extend(words(&code(text)));
            known.extend(
                texts(&code_and_texts(text)).into_iter().flat_map(|text| words(&text).into_iter().chain([text])),
            );
        }
        let relative = |path: &Path| path.strip_prefix(root()).expect("below the root").display().to_string();
        Source { files: files.into_iter().map(|(path, text)| (relative(&path), code(&text))).collect(), words: known }
    }

    fn has_type(&self, name: &str) -> bool {
        self.files.iter().any(|(_, code)| TYPES.iter().any(|keyword| declares(code, keyword, name)))
    }

    /// Whether `owner::item` exists: a module of `src/` with an item that it declares, or a type
    /// with a function, constant, field or variant.
    fn has_item(&self, path: &str) -> bool {
        let segments: Vec<&str> = path.split("::").filter(|segment| *segment != "stick_slip").collect();
        let Some((item, owners)) = segments.split_last() else { return false };
        let Some(owner) = owners.last() else { return root().join("src").join(item).exists() };
        let (folder, file) = (format!("src/{owner}/"), format!("/{owner}.rs"));
        let of_module = |(path, code): &(String, String)| {
            (path.starts_with(&folder) || path.ends_with(&file))
                && TYPES.iter().chain(&ITEMS).any(|keyword| declares(code, keyword, item))
        };
        let of_type = |(_, code): &(String, String)| {
            let owned = |body: &str| ITEMS.iter().any(|keyword| declares(body, keyword, item)) || lists(body, item);
            blocks(code).into_iter().any(|(head, body)| head.contains(*owner) && owned(body))
        };
        self.files
            .iter()
            .any(|file| if owner.starts_with(char::is_uppercase) { of_type(file) } else { of_module(file) })
    }

    /// Whether there is a file or folder with this path from the root or from `src/`, or with this
    /// name alone. `*` stands for any name.
    fn has_file(&self, path: &str) -> bool {
        let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
        let is_named_alone =
            folder.is_empty() && self.files.iter().any(|(file, _)| file.ends_with(&format!("/{name}")));
        let place = if name.contains('*') { folder } else { path };
        is_named_alone || root().join(place).exists() || root().join("src").join(place).exists()
    }

    fn knows(&self, name: &str) -> bool {
        let is_file = name.contains('/') || [".rs", ".py", ".sh"].iter().any(|end| name.ends_with(end));
        if name.starts_with("target/") || name.chars().next().is_none_or(|c| !c.is_alphabetic() && c != '_') {
            return true;
        }
        if is_file {
            return self.has_file(name);
        }
        if name.contains("::") {
            return self.has_item(name);
        }
        let is_type = name.starts_with(char::is_uppercase) && name.chars().all(char::is_alphanumeric);
        if is_type && name.chars().any(char::is_lowercase) {
            return self.has_type(name) || self.words.contains(name);
        }
        self.words.contains(name) || name.split(['.', '-']).all(|part| self.words.contains(part))
    }
}

const TYPES: [&str; 4] = ["struct", "enum", "trait", "type"];
const ITEMS: [&str; 4] = ["fn", "const", "static", "mod"];

/// Whether the code declares the item with this keyword.
fn declares(code: &str, keyword: &str, item: &str) -> bool {
    let after = |(at, declared): (usize, &str)| code[at + declared.len()..].chars().next();
    code.match_indices(&format!("{keyword} {item}")).any(|found| after(found).is_none_or(|c| !is_word(c)))
}

/// Whether the body of a type has a field or a variant with this name.
fn lists(body: &str, item: &str) -> bool {
    [": ", ",", "(", " {"].iter().any(|end| body.contains(&format!(" {item}{end}")))
}

/// Whether the text is one word that could be a name: it has no spaces and is no formula, option,
/// or placeholder in capitals.
fn could_be_a_name(span: &str) -> bool {
    let is_word = span.chars().all(|c| c.is_ascii_alphanumeric() || "_:/.*-".contains(c));
    is_word && !span.starts_with('-') && !span.split(['.', '/', '_']).any(|part| part == "NAME")
}

#[test]
fn what_a_page_names_exists() {
    let source = Source::read();
    let mut looked_up = 0;
    let mut unknown = BTreeSet::new();
    for page in Page::all() {
        for span in page.spans().into_iter().filter(|span| could_be_a_name(span) && !FOREIGN.contains(span)) {
            looked_up += 1;
            // The ends of the interval of a variable have its name with an ending.
            let of = span.strip_suffix("_low").or_else(|| span.strip_suffix("_high")).unwrap_or(span);
            if !source.knows(span) && !source.knows(of) {
                unknown.insert(format!("{}: {span}", page.path.display()));
            }
        }
    }
    assert!(looked_up > 500, "names are recognised: {looked_up}");
    assert_eq!(unknown, BTreeSet::new(), "neither a file nor an item nor a name of data");
}

/// The type that a line of code declares, and whether it is declared `pub`.
fn declared_type(line: &str) -> Option<(String, bool)> {
    let (mut words, mut is_public) = (line.split_whitespace().peekable(), false);
    if words.peek().is_some_and(|word| word.starts_with("pub")) {
        is_public = words.next() == Some("pub");
    }
    let keyword = words.next()?;
    // Types in traits and their implementations are indented.
    let declares = TYPES.contains(&keyword) && (keyword != "type" || !line.starts_with(' '));
    let name: String = words.next()?.chars().take_while(|c| is_word(*c)).collect();
    (declares && name.starts_with(char::is_uppercase)).then_some((name, is_public))
}

/// The types of which there are several under one key, with their files. The key follows from the
/// room, the name of the type, and whether it is declared `pub`; a type without a key does not
/// count.
fn several(key: impl Fn(&str, &str, bool) -> Option<String>) -> BTreeMap<String, Vec<String>> {
    let mut files: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (place, code) in compiled() {
        let room = place.first().map_or("", String::as_str);
        for (name, is_public) in code.lines().filter_map(declared_type) {
            if let Some(key) = key(room, &name, is_public) {
                files.entry(key).or_default().push(place.join("/"));
            }
        }
    }
    assert!(files.len() > 300, "types are recognised: {}", files.len());
    files.into_iter().filter(|(_, files)| files.len() > 1).collect()
}

#[test]
fn a_room_has_one_type_of_a_name() {
    // Every verb of the command has its `Arguments`.
    let named = |room: &str, name: &str, _| (name != "Arguments").then(|| format!("{room}::{name}"));
    assert_eq!(several(named), BTreeMap::new());
}

#[test]
fn the_library_has_one_public_type_of_a_name() {
    let public = |room: &str, name: &str, is_public| (is_public && room != "cli").then(|| name.to_string());
    assert_eq!(several(public), BTreeMap::new());
}
