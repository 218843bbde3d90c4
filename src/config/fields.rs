//! A table of the tree, read key by key: types and ranges are checked here, once for all keys.

use super::error::Fault;
use super::keys::{self, Key, Range};
use super::source::{Place, Sources};
use super::tree::{Entry, Node, Value};
use crate::model::LARGEST;

/// A number that was read, and where; `place` is none where a default stands in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Read {
    pub value: f64,
    pub place: Option<Place>,
}

/// A table whose keys are all known.
pub(super) struct Fields<'a> {
    sources: &'a Sources<'a>,
    /// The dotted name, as in a message: "temperature.harmonics.0".
    path: String,
    /// The header; none where the table is missing, which is an empty table.
    place: Option<Place>,
    entries: &'a [Entry],
}

impl<'a> Fields<'a> {
    /// The root table.
    pub fn root(sources: &'a Sources<'a>, node: &'a Node) -> Result<Self, Box<Fault>> {
        let mut root = Self::open(sources, "", String::new(), node)?;
        root.place = None;
        Ok(root)
    }

    /// A table of the kind `schema` (see `keys::TABLES`); an unknown key in it is an error.
    fn open(sources: &'a Sources<'a>, schema: &str, path: String, node: &'a Node) -> Result<Self, Box<Fault>> {
        let Value::Table(entries) = &node.value else {
            let names = keys::of_table(schema).join(", ");
            return Err(wrong_kind(sources, node, &path, "a table", &format!("write a table with the keys {names}")));
        };
        let known = keys::of_table(schema);
        if let Some(entry) = entries.iter().find(|entry| !known.contains(&entry.key.as_str())) {
            let table = if schema.is_empty() { "a scenario".to_string() } else { format!("`{schema}`") };
            let (hint, remedy) = match keys::suggestion(schema, &entry.key) {
                Some(name) => (format!("; did you mean `{name}`?"), format!("write `{name}`, or remove the line")),
                None => (String::new(), "remove the line".to_string()),
            };
            let problem = format!("unknown key `{}`{hint}", entry.key);
            let remedy = format!("{remedy}; {table} takes {}", known.join(", "));
            return Err(sources.fault(Some(entry.key_place), problem, remedy));
        }
        Ok(Fields { sources, path, place: Some(node.place), entries })
    }

    fn dotted(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_string() } else { format!("{}.{name}", self.path) }
    }

    fn node(&self, name: &str) -> Option<&'a Node> {
        self.entries.iter().find(|entry| entry.key == name).map(|entry| &entry.node)
    }

    /// Where the value of a key, in this table or dotted in one below, is, if it is there.
    pub fn place_of(&self, dotted: &str) -> Option<Place> {
        let mut names = dotted.split('.');
        let mut node = self.node(names.next()?)?;
        for name in names {
            let Value::Table(entries) = &node.value else { return None };
            node = &entries.iter().find(|entry| entry.key == name)?.node;
        }
        Some(node.place)
    }

    /// A table in this one; if it is missing, an empty one.
    pub fn table(&self, name: &str) -> Result<Fields<'a>, Box<Fault>> {
        let path = self.dotted(name);
        match self.node(name) {
            Some(node) => Self::open(self.sources, &path.clone(), path, node),
            None => Ok(Fields { sources: self.sources, path, place: None, entries: &[] }),
        }
    }

    /// A table in this one, if it is there.
    pub fn table_if_present(&self, name: &str) -> Result<Option<Fields<'a>>, Box<Fault>> {
        if self.node(name).is_some() { self.table(name).map(Some) } else { Ok(None) }
    }

    /// The tables of an array of tables; a missing array is empty.
    pub fn tables(&self, name: &str) -> Result<Vec<Fields<'a>>, Box<Fault>> {
        let path = self.dotted(name);
        let Some(node) = self.node(name) else { return Ok(Vec::new()) };
        let Value::Array(items) = &node.value else {
            let remedy = format!("write {name} = [{{ ... }}], with the keys {}", keys::of_table(&path).join(", "));
            return Err(wrong_kind(self.sources, node, &path, "an array of tables", &remedy));
        };
        items.iter().enumerate().map(|(i, item)| Self::open(self.sources, &path, format!("{path}.{i}"), item)).collect()
    }

    /// A table, or the tables of an array of them: what may be there once or more often.
    pub fn one_or_more(&self, name: &str) -> Result<Vec<Fields<'a>>, Box<Fault>> {
        match self.node(name) {
            Some(Node { value: Value::Array(_), .. }) => self.tables(name),
            _ => Ok(self.table_if_present(name)?.into_iter().collect()),
        }
    }

    /// A number that must be there.
    pub fn number(&self, key: Key) -> Result<Read, Box<Fault>> {
        self.number_if_present(key)?.ok_or_else(|| self.missing(key))
    }

    /// A number, or its default.
    pub fn number_or(&self, key: Key, default: f64) -> Result<Read, Box<Fault>> {
        let read = self.number_if_present(key)?;
        Ok(read.unwrap_or(Read { value: default, place: None }))
    }

    /// A number, if it is there.
    pub fn number_if_present(&self, key: Key) -> Result<Option<Read>, Box<Fault>> {
        let Some(node) = self.node(key.name) else { return Ok(None) };
        let path = self.dotted(key.name);
        let allowed = key.range.words();
        let symbol = if key.symbol.is_empty() { String::new() } else { format!("{}, ", key.symbol) };
        let remedy = format!("give {allowed} ({symbol}{})", key.meaning);
        let value = float(node).ok_or_else(|| wrong_kind(self.sources, node, &path, allowed, &remedy))?;
        let problem = match value {
            x if x.is_nan() => "is not a number".to_string(),
            x if x.is_infinite() => "is not finite".to_string(),
            x if !key.range.holds(x) => format!("is out of range: it must be {allowed}"),
            x if x.abs() > LARGEST && key.range != Range::Threshold => {
                let remedy = format!("choose units in which it is closer to 1, or {remedy}");
                return Err(self.fault(
                    node,
                    &path,
                    format!("is above {:e}, too large to compute with", LARGEST),
                    remedy,
                ));
            }
            _ => return Ok(Some(Read { value, place: Some(node.place) })),
        };
        Err(self.fault(node, &path, problem, remedy))
    }

    /// A length of time, if it is there: a number, or a text such as "6h", which is in seconds.
    pub fn span_if_present(&self, key: Key) -> Result<Option<f64>, Box<Fault>> {
        let Some(node) = self.node(key.name) else { return Ok(None) };
        let Value::Text(text) = &node.value else { return Ok(self.number_if_present(key)?.map(|read| read.value)) };
        crate::data::seconds(text).map(Some).ok_or_else(|| {
            let remedy = "write a length of time above 0 such as \"6h\", \"90min\" or \"2d\", or a number".to_string();
            self.fault(node, &self.dotted(key.name), "is no length of time".into(), remedy)
        })
    }

    /// The fault of a table that should not be there.
    pub fn wrong(&self, problem: &str, remedy: &str) -> Box<Fault> {
        self.sources.fault(self.place, problem.to_string(), remedy.to_string()).of(&self.path)
    }

    /// The fault of a text that is not there.
    pub fn absent(&self, name: &str, remedy: &str) -> Box<Fault> {
        self.sources.fault(self.place, format!("missing key `{}`", self.dotted(name)), remedy.to_string())
    }

    /// A number or a word from a list: `Ok(Ok(number))` or `Ok(Err(word))`.
    pub fn number_or_word(
        &self,
        key: Key,
        words: &[&'static str],
    ) -> Result<Option<Result<Read, &'static str>>, Box<Fault>> {
        let Some(node) = self.node(key.name) else { return Ok(None) };
        let Value::Text(text) = &node.value else { return Ok(self.number_if_present(key)?.map(Ok)) };
        match words.iter().find(|word| **word == text) {
            Some(word) => Ok(Some(Err(word))),
            None => Err(self.unknown_word(node, key.name, words, &format!("{} or one of", key.range.words()))),
        }
    }

    /// A word from a list, if it is there.
    pub fn word(&self, name: &str, words: &[&'static str]) -> Result<Option<&'static str>, Box<Fault>> {
        let Some(node) = self.node(name) else { return Ok(None) };
        match &node.value {
            Value::Text(text) => match words.iter().find(|word| **word == text) {
                Some(word) => Ok(Some(word)),
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

    /// A whole number in a range, or its default.
    pub fn whole_or(&self, name: &str, default: u64, range: (u64, u64)) -> Result<u64, Box<Fault>> {
        let Some(node) = self.node(name) else { return Ok(default) };
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
            Value::Float(text) => {
                // 1e4 is the natural way to write ten thousand, and not a TOML integer.
                let whole = text.parse::<f64>().ok().filter(|x| x.fract() == 0.0 && x.abs() < EXACT_INTEGERS);
                let remedy = match whole.and_then(|x| inside(x as i128)) {
                    Some(n) => format!("write {n}"),
                    None => format!("give {allowed}"),
                };
                Err(wrong_kind(self.sources, node, &path, &allowed, &remedy))
            }
            _ => Err(wrong_kind(self.sources, node, &path, &allowed, &format!("give {allowed}"))),
        }
    }

    /// True or false, or the default.
    pub fn flag_or(&self, name: &str, default: bool) -> Result<bool, Box<Fault>> {
        match self.node(name) {
            None => Ok(default),
            Some(Node { value: Value::Boolean(value), .. }) => Ok(*value),
            Some(node) => {
                Err(wrong_kind(self.sources, node, &self.dotted(name), "true or false", "write true or false"))
            }
        }
    }

    /// One line of text, or the default.
    pub fn line_or(&self, name: &str, default: &str) -> Result<String, Box<Fault>> {
        let Some(node) = self.node(name) else { return Ok(default.to_string()) };
        let path = self.dotted(name);
        match &node.value {
            Value::Text(text) if text.chars().any(char::is_control) => {
                let problem = "holds a line break or another control character".to_string();
                Err(self.fault(node, &path, problem, "write it on one line".into()))
            }
            Value::Text(text) => Ok(text.clone()),
            _ => Err(wrong_kind(self.sources, node, &path, "a string", "put it in quotes")),
        }
    }

    fn missing(&self, key: Key) -> Box<Fault> {
        let (symbol, meaning) = (key.symbol, key.meaning);
        let problem = format!("missing key `{}`", self.dotted(key.name));
        let under = if self.place.is_some() { "there" } else { &format!("under [{}]", self.path) };
        let remedy = format!("add `{} = ...` {under}: {symbol}, {meaning}; {}", key.name, key.range.words());
        self.sources.fault(self.place, problem, remedy)
    }

    fn fault(&self, node: &Node, path: &str, problem: String, remedy: String) -> Box<Fault> {
        self.sources.fault(Some(node.place), problem, remedy).of(path).value(self.sources.quote(node.place))
    }
}

/// Above this, not every whole number is a double.
const EXACT_INTEGERS: f64 = 9_007_199_254_740_992.0;

/// The number in a node. Whole numbers are numbers too.
fn float(node: &Node) -> Option<f64> {
    match &node.value {
        Value::Float(text) => text.parse().ok(),
        Value::Integer { digits, radix: 10 } => digits.parse().ok(),
        Value::Integer { digits, radix } => i128::from_str_radix(digits, *radix).ok().map(|n| n as f64),
        _ => None,
    }
}

fn wrong_kind(sources: &Sources<'_>, node: &Node, path: &str, expected: &str, remedy: &str) -> Box<Fault> {
    let problem = format!("is {}; it must be {expected}", node.value.kind());
    let fault = sources.fault(Some(node.place), problem, remedy.to_string());
    // A whole table or array says nothing as a value.
    match node.value {
        Value::Array(_) | Value::Table(_) => fault.of(path),
        _ => fault.of(path).value(sources.quote(node.place)),
    }
}

fn quoted(words: &[&str]) -> String {
    words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
}
