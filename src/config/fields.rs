//! Reading a table of the tree key by key. Types and ranges are checked here, once for all keys.
//!
//! A value that cannot be used is reported to the sources and replaced by a valid one, so that
//! reading goes on and one pass finds all mistakes.

use super::error::Fault;
use super::keys::{self, Allowed, Key};
use super::source::{Place, Sources};
use super::tree::{KeyValue, Node, Value};
use crate::excerpt::short;
use crate::model::LARGEST;

/// A number with its place. `place` is `None` if the number is a default.
#[derive(Clone, Copy, Debug)]
pub(super) struct Read {
    pub value: f64,
    pub place: Option<Place>,
}

/// A table of which the known keys can be read.
pub(super) struct Fields<'a> {
    sources: &'a Sources<'a>,
    /// The dotted name that messages use, such as "temperature.harmonics.0".
    path: String,
    /// The place of the table; `None` for the root and for a missing table, which is read as an
    /// empty one.
    place: Option<Place>,
    entries: &'a [KeyValue],
    /// Whether a fault in this table is reported already that may be the reason why a key is
    /// missing.
    is_misread: bool,
}

impl<'a> Fields<'a> {
    /// The root table.
    pub fn root(sources: &'a Sources<'a>, node: &'a Node) -> Self {
        let root = Self::open(sources, "", String::new(), node);
        Fields { place: None, ..root }
    }

    /// Open a table of the kind `schema` (see `keys::TABLES`) and report its unknown keys.
    fn open(sources: &'a Sources<'a>, schema: &str, path: String, node: &'a Node) -> Self {
        let place = Some(node.place);
        let Value::Table(entries) = &node.value else {
            let names = keys::of_table(schema).join(", ");
            let remedy = format!("write a table with the keys {names}");
            sources.report(wrong_kind(sources, node, &path, "a table", &remedy));
            return Fields { sources, path, place, entries: &[], is_misread: true };
        };
        let known = keys::of_table(schema);
        let mut is_misread = false;
        for entry in entries.iter().filter(|entry| !known.contains(&entry.key.as_str())) {
            is_misread = true;
            let table = if schema.is_empty() { "a scenario".to_string() } else { format!("`{schema}`") };
            let (hint, remedy) = match keys::suggestion(schema, &entry.key) {
                // Harmonics form an array, so the remedy shows a harmonic within its array.
                Some(name) if name.starts_with("temperature.harmonics.") && schema != "temperature.harmonics" => {
                    let example =
                        "write `harmonics = [{ amplitude = 1.0, angular_frequency = 0.25 }]` under [temperature]";
                    (format!("; did you mean `{name}`?"), example.to_string())
                }
                Some(name) => (format!("; did you mean `{name}`?"), format!("write `{name}`, or remove it")),
                None => (String::new(), "remove it".to_string()),
            };
            let problem = format!("unknown key `{}`{hint}", short(&entry.key));
            let remedy = format!("{remedy}; {table} takes {}", known.join(", "));
            sources.report(sources.fault(Some(entry.key_place), problem, remedy));
        }
        Fields { sources, path, place, entries, is_misread }
    }

    fn dotted(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_string() } else { format!("{}.{name}", self.path) }
    }

    fn node(&self, name: &str) -> Option<&'a Node> {
        self.entries.iter().find(|entry| entry.key == name).map(|entry| &entry.node)
    }

    /// The place of the value of a key, if it is there. The key may be dotted, for a table within
    /// this one; in an array of tables it is that of the first table that has the key.
    pub fn place_of(&self, dotted: &str) -> Option<Place> {
        let (first, rest) = dotted.split_once('.').map_or((dotted, None), |(first, rest)| (first, Some(rest)));
        place_in(self.node(first)?, rest)
    }

    /// A table within this one; an empty one if it is missing.
    pub fn table(&self, name: &str) -> Fields<'a> {
        let path = self.dotted(name);
        match self.node(name) {
            Some(node) => Self::open(self.sources, &path.clone(), path, node),
            None => Fields { sources: self.sources, path, place: None, entries: &[], is_misread: self.is_misread },
        }
    }

    /// A table within this one, if it is there.
    pub fn table_if_present(&self, name: &str) -> Option<Fields<'a>> {
        self.node(name).is_some().then(|| self.table(name))
    }

    /// The tables of an array of tables; a missing array is empty.
    pub fn tables(&self, name: &str) -> Vec<Fields<'a>> {
        let path = self.dotted(name);
        let Some(node) = self.node(name) else { return Vec::new() };
        let Value::Array(items) = &node.value else {
            let remedy = format!("write {name} = [{{ ... }}], with the keys {}", keys::of_table(&path).join(", "));
            self.sources.report(wrong_kind(self.sources, node, &path, "an array of tables", &remedy));
            return Vec::new();
        };
        items.iter().enumerate().map(|(i, item)| Self::open(self.sources, &path, format!("{path}.{i}"), item)).collect()
    }

    /// The tables of a key that may hold one table or an array of tables.
    pub fn one_or_more(&self, name: &str) -> Vec<Fields<'a>> {
        match self.node(name) {
            Some(Node { value: Value::Array(_), .. }) => self.tables(name),
            _ => self.table_if_present(name).into_iter().collect(),
        }
    }

    /// The numbers of a table whose keys are free, with their places; none if it is missing.
    pub fn numbers(&self, name: &str) -> Vec<(String, f64, Option<Place>)> {
        let Some(node) = self.node(name) else { return Vec::new() };
        let path = self.dotted(name);
        let Value::Table(entries) = &node.value else {
            self.sources.report(wrong_kind(self.sources, node, &path, "a table", "write names with numbers"));
            return Vec::new();
        };
        let table = Fields { sources: self.sources, path, place: Some(node.place), entries, is_misread: false };
        let read = |entry: &KeyValue| {
            let key = Key { name: "", symbol: "", meaning: "a parameter", range: Allowed::Any };
            let value = self.sources.or_report(table.number_of(&entry.node, &entry.key, key)).unwrap_or(1.0);
            (entry.key.clone(), value, Some(entry.key_place))
        };
        entries.iter().map(read).collect()
    }

    /// A number that must be there; if it is missing, this is reported.
    pub fn number(&self, key: Key) -> f64 {
        self.number_if_present(key).map_or_else(|| self.missing(key), |read| read.value)
    }

    /// A number that must be there, towards larger and towards smaller x: one for both, or a table.
    pub fn by_direction(&self, key: Key) -> [f64; 2] {
        let Some(Node { value: Value::Table(entries), place }) = self.node(key.name) else {
            return [self.number(key); 2];
        };
        let path = self.dotted(key.name);
        let table = Fields { sources: self.sources, path, place: Some(*place), entries, is_misread: false };
        for entry in entries.iter().filter(|entry| !DIRECTIONS.contains(&entry.key.as_str())) {
            let problem = format!("unknown key `{}`", short(&entry.key));
            let remedy = format!("write {} = {{ forward = 1.2, backward = 1.4 }}", key.name);
            self.sources.report(self.sources.fault(Some(entry.key_place), problem, remedy));
        }
        DIRECTIONS.map(|name| table.number(Key { name, ..key }))
    }

    /// A number, or its default if it is missing.
    pub fn number_or(&self, key: Key, default: f64) -> f64 {
        self.number_if_present(key).map_or(default, |read| read.value)
    }

    /// A number, if it is there.
    pub fn number_if_present(&self, key: Key) -> Option<Read> {
        let node = self.node(key.name)?;
        let value = self.sources.or_report(self.number_in(node, key)).unwrap_or_else(|| key.range.stand_in());
        Some(Read { value, place: Some(node.place) })
    }

    /// The numbers of a list, at most `most` of them; none if the key is missing.
    pub fn list(&self, key: Key, most: usize) -> Vec<f64> {
        let Some(node) = self.node(key.name) else { return Vec::new() };
        let path = self.dotted(key.name);
        match &node.value {
            Value::Array(items) if items.len() <= most => {
                let read = |item: &Node| self.sources.or_report(self.number_in(item, key));
                items.iter().map(|item| read(item).unwrap_or_else(|| key.range.stand_in())).collect()
            }
            Value::Array(items) => {
                let problem = format!("holds {} numbers, more than {most}", items.len());
                self.sources.report(self.fault(node, &path, problem, format!("leave out all but {most} of them")));
                Vec::new()
            }
            _ => {
                let remedy = format!("write {} = [1.0, 2.0]", key.name);
                self.sources.report(wrong_kind(self.sources, node, &path, "a list of numbers", &remedy));
                Vec::new()
            }
        }
    }

    /// The number in the node of a key, checked.
    fn number_in(&self, node: &Node, key: Key) -> Result<f64, Box<Fault>> {
        self.number_of(node, key.name, key)
    }

    /// The number in the node of a key that is called `name`, checked.
    fn number_of(&self, node: &Node, name: &str, key: Key) -> Result<f64, Box<Fault>> {
        let path = self.dotted(name);
        let allowed = key.range.words();
        let symbol = if key.symbol.is_empty() { String::new() } else { format!("{}, ", key.symbol) };
        let remedy = format!("give {allowed} ({symbol}{})", key.meaning);
        let value = float(node).ok_or_else(|| wrong_kind(self.sources, node, &path, allowed, &remedy))?;
        let problem = match value {
            x if x.is_nan() => "is not a number".to_string(),
            x if x.is_infinite() => "is not finite".to_string(),
            x if !key.range.holds(x) => format!("is out of range: it must be {allowed}"),
            x if x.abs() > LARGEST && key.range != Allowed::Threshold => {
                let remedy = format!("choose units in which it is closer to 1, or {remedy}");
                return Err(self.fault(
                    node,
                    &path,
                    format!("is above {:e}, too large to compute with", LARGEST),
                    remedy,
                ));
            }
            _ => return Ok(value),
        };
        Err(self.fault(node, &path, problem, remedy))
    }

    /// A length of time, if it is there: a number as it is, or a text such as "6h" in seconds.
    pub fn span_if_present(&self, key: Key) -> Option<f64> {
        let node = self.node(key.name)?;
        let Value::Text(text) = &node.value else { return Some(self.number_or(key, key.range.stand_in())) };
        let read = crate::data::seconds(text).ok_or_else(|| {
            let remedy = "write a length of time above 0 such as \"6h\", \"90min\" or \"2d\", or a number".to_string();
            self.fault(node, &self.dotted(key.name), "is no length of time".into(), remedy)
        });
        self.sources.or_report(read)
    }

    /// The fault for a table that should not be there.
    pub fn fault_of_table(&self, problem: &str, remedy: &str) -> Box<Fault> {
        self.sources.fault(self.place, problem.to_string(), remedy.to_string()).of(&self.path)
    }

    /// The fault for a text that is missing.
    pub fn missing_text(&self, name: &str, remedy: &str) -> Box<Fault> {
        self.sources.fault(self.place, format!("missing key `{}`", self.dotted(name)), remedy.to_string())
    }

    /// A number or a word from a list, if it is there: `Ok(number)` or `Err(word)`.
    pub fn number_or_word(&self, key: Key, words: &[&'static str]) -> Option<Result<f64, &'static str>> {
        let node = self.node(key.name)?;
        let Value::Text(text) = &node.value else { return Some(Ok(self.number(key))) };
        match words.iter().find(|word| **word == text) {
            Some(word) => Some(Err(word)),
            None => {
                let allowed = format!("{} or one of", key.range.words());
                self.sources.report(self.unknown_word(node, key.name, words, &allowed));
                Some(Ok(key.range.stand_in()))
            }
        }
    }

    /// A word from a list, if it is there.
    pub fn word(&self, key: Key, words: &[&'static str]) -> Option<&'static str> {
        self.sources.or_report(self.word_in(self.node(key.name)?, key.name, words))
    }

    fn word_in(&self, node: &Node, name: &str, words: &[&'static str]) -> Result<&'static str, Box<Fault>> {
        match &node.value {
            Value::Text(text) => match words.iter().find(|word| **word == text) {
                Some(word) => Ok(word),
                None => Err(self.unknown_word(node, name, words, "one of")),
            },
            _ => {
                let remedy = format!("write one of {}", quoted(words));
                Err(wrong_kind(self.sources, node, &self.dotted(name), "a string", &remedy))
            }
        }
    }

    fn unknown_word(&self, node: &Node, name: &str, words: &[&'static str], allowed: &str) -> Box<Fault> {
        let text = if let Value::Text(text) = &node.value { text.as_str() } else { "" };
        let likeness = |word: &&'static str| (strsim::jaro_winkler(text, word), *word);
        let alike = words.iter().map(likeness).filter(|(likeness, _)| *likeness > 0.8);
        let nearest = alike.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, word)| word);
        let hint = nearest.map_or(String::new(), |word| format!("; did you mean \"{word}\"?"));
        let problem = format!("is not {allowed} {}{hint}", quoted(words));
        self.fault(node, &self.dotted(name), problem, format!("write {allowed} {}", quoted(words)))
    }

    /// A whole number within a range, or its default if it is missing.
    pub fn whole_or(&self, key: Key, default: u64, range: (u64, u64)) -> u64 {
        let name = key.name;
        self.node(name).and_then(|node| self.sources.or_report(self.whole_in(node, name, range))).unwrap_or(default)
    }

    fn whole_in(&self, node: &Node, name: &str, range: (u64, u64)) -> Result<u64, Box<Fault>> {
        let path = self.dotted(name);
        let (low, high) = range;
        let allowed = format!("a whole number from {low} to {high}");
        let inside = |n: i128| u64::try_from(n).ok().filter(|n| (low..=high).contains(n));
        match &node.value {
            Value::Integer { digits, radix } => {
                i128::from_str_radix(digits, *radix).ok().and_then(inside).ok_or_else(|| {
                    let problem = format!("is out of range: it must be {allowed}");
                    self.fault(node, &path, problem, format!("give {allowed}"))
                })
            }
            // 1e4 and "10k" are natural ways to write ten thousand, but not TOML integers.
            Value::Float(text) | Value::Text(text) if count(text).is_some() => {
                count(text).and_then(inside).ok_or_else(|| {
                    let problem = format!("is out of range: it must be {allowed}");
                    self.fault(node, &path, problem, format!("give {allowed}"))
                })
            }
            _ => Err(wrong_kind(self.sources, node, &path, &allowed, &format!("give {allowed}"))),
        }
    }

    /// True or false, or the default if it is missing.
    pub fn flag_or(&self, key: Key, default: bool) -> bool {
        match self.node(key.name) {
            None => default,
            Some(Node { value: Value::Boolean(value), .. }) => *value,
            Some(node) => {
                let path = self.dotted(key.name);
                self.sources.report(wrong_kind(self.sources, node, &path, "true or false", "write true or false"));
                default
            }
        }
    }

    /// One line of text, or the default if it is missing.
    pub fn line_or(&self, key: Key, default: &str) -> String {
        let name = key.name;
        let read = self.node(name).and_then(|node| self.sources.or_report(self.line_in(node, name)));
        read.unwrap_or_else(|| default.to_string())
    }

    fn line_in(&self, node: &Node, name: &str) -> Result<String, Box<Fault>> {
        self.text_in(node, name, char::is_control)
    }

    /// A text that may have line breaks and tabs; none if it is missing or cannot be used, which is
    /// reported.
    pub fn lines_if_sound(&self, key: Key) -> Option<String> {
        let is_wrong = |c: char| c.is_control() && !matches!(c, '\n' | '\r' | '\t');
        self.sources.or_report(self.text_in(self.node(key.name)?, key.name, is_wrong))
    }

    fn text_in(&self, node: &Node, name: &str, is_wrong: fn(char) -> bool) -> Result<String, Box<Fault>> {
        let path = self.dotted(name);
        match &node.value {
            Value::Text(text) if text.chars().any(is_wrong) => {
                let problem = "holds a line break or another control character".to_string();
                Err(self.fault(node, &path, problem, "write it on one line".into()))
            }
            Value::Text(text) => Ok(text.clone()),
            _ => Err(wrong_kind(self.sources, node, &path, "a string", "put it in quotes")),
        }
    }

    /// One line of text, if it is there and not empty.
    pub fn line_if_present(&self, key: Key) -> Option<String> {
        Some(self.line_or(key, "")).filter(|text| !text.is_empty())
    }

    /// Numbers and texts of an array, as texts; none if it is missing. A number or a text alone is
    /// accepted as well.
    pub fn marks(&self, key: Key) -> Vec<String> {
        let Some(node) = self.node(key.name) else { return Vec::new() };
        let items = if let Value::Array(items) = &node.value { &items[..] } else { std::slice::from_ref(node) };
        let text = |item: &Node| match &item.value {
            Value::Text(text) => Some(text.clone()),
            _ => float(item).map(|number| number.to_string()),
        };
        let read: Option<Vec<String>> = items.iter().map(text).collect();
        read.unwrap_or_else(|| {
            let remedy = "write e.g. [-9999, \"no data\"]";
            self.sources.report(wrong_kind(self.sources, node, &self.dotted(key.name), "numbers and texts", remedy));
            Vec::new()
        })
    }

    /// Report that a key is missing, and return the number that replaces it.
    fn missing(&self, key: Key) -> f64 {
        if self.is_misread {
            return key.range.stand_in();
        }
        let (symbol, meaning) = (key.symbol, key.meaning);
        let problem = format!("missing key `{}`", self.dotted(key.name));
        let under = if self.place.is_some() { "there" } else { &format!("under [{}]", self.path) };
        let remedy = format!("add `{} = ...` {under}: {symbol}, {meaning}; {}", key.name, key.range.words());
        self.sources.report(self.sources.fault(self.place, problem, remedy));
        key.range.stand_in()
    }

    fn fault(&self, node: &Node, path: &str, problem: String, remedy: String) -> Box<Fault> {
        self.sources.fault(Some(node.place), problem, remedy).of(path).value(self.sources.quote(node.place))
    }
}

/// The keys of a number by direction: towards larger x, and towards smaller.
pub(super) const DIRECTIONS: [&str; 2] = ["forward", "backward"];

/// The whole number that a text such as "1e5", "1_000_000", "10k" or "2.5M" means.
fn count(text: &str) -> Option<i128> {
    let plain = text.replace('_', "");
    let (digits, unit) = match plain.strip_suffix(['k', 'K', 'M', 'G']) {
        None => (plain.as_str(), 1.0),
        Some(digits) if plain.ends_with('M') => (digits, 1e6),
        Some(digits) if plain.ends_with('G') => (digits, 1e9),
        Some(digits) => (digits, 1e3),
    };
    // Rounding is allowed for, because 1.1 times a thousand, for example, is not exactly a whole
    // number in floating point.
    let number = digits.parse::<f64>().ok()? * unit;
    let whole = number.round();
    (whole.abs() < EXACT_INTEGERS && (number - whole).abs() <= f64::EPSILON * whole.abs()).then_some(whole as i128)
}

/// 2^53: above it, not every whole number is a double.
const EXACT_INTEGERS: f64 = 9_007_199_254_740_992.0;

/// The number in a node. A whole number is accepted as well.
fn float(node: &Node) -> Option<f64> {
    match &node.value {
        Value::Float(text) => text.parse().ok(),
        Value::Integer { digits, radix: 10 } => digits.parse().ok(),
        Value::Integer { digits, radix } => i128::from_str_radix(digits, *radix).ok().map(|n| n as f64),
        _ => None,
    }
}

/// The place of a value below a node, by its dotted key; that of the node itself without one.
fn place_in(node: &Node, dotted: Option<&str>) -> Option<Place> {
    let Some(dotted) = dotted else { return Some(node.place) };
    match &node.value {
        Value::Table(entries) => {
            let (first, rest) = dotted.split_once('.').map_or((dotted, None), |(first, rest)| (first, Some(rest)));
            place_in(&entries.iter().find(|entry| entry.key == first)?.node, rest)
        }
        Value::Array(items) => items.iter().find_map(|item| place_in(item, Some(dotted))),
        _ => None,
    }
}

fn wrong_kind(sources: &Sources<'_>, node: &Node, path: &str, expected: &str, remedy: &str) -> Box<Fault> {
    let problem = format!("is {}; it must be {expected}", node.value.kind());
    let fault = sources.fault(Some(node.place), problem, remedy.to_string());
    // The text of a whole table or array would not help as a value.
    match node.value {
        Value::Array(_) | Value::Table(_) => fault.of(path),
        _ => fault.of(path).value(sources.quote(node.place)),
    }
}

fn quoted(words: &[&str]) -> String {
    words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
}
