//! Reads a table of the tree key by key. Types and ranges are checked here, for all keys.
//!
//! An invalid value is reported to the sources and replaced by a valid one, so that reading
//! continues and one pass finds all errors.

use super::error::Diagnostic;
use super::keys::{self, Allowed, Key};
use super::source::{Place, Sources};
use super::synonyms::suggestion;
use super::tree::{KeyValue, Node, Value, node_at};
use crate::model::LARGEST;
use std::ops::RangeInclusive;
use stickslip_text::excerpt::short;

/// A value with its dotted key.
struct ValueAt<'a> {
    sources: &'a Sources<'a>,
    path: String,
    node: &'a Node,
}

impl ValueAt<'_> {
    fn diagnostic(&self, problem: impl Into<String>, remedy: impl Into<String>) -> Box<Diagnostic> {
        let diagnostic = self
            .sources
            .diagnostic(Some(self.node.place), problem, remedy)
            .of(&self.path);
        match self.node.value {
            // The text of a whole table or array is too long to quote.
            Value::Array(_) | Value::Table(_) => diagnostic,
            _ => diagnostic.value(self.sources.quote(self.node.place)),
        }
    }

    fn wrong_kind(&self, expected: &str, remedy: impl Into<String>) -> Box<Diagnostic> {
        self.diagnostic(
            format!("is {}; it must be {expected}", self.node.value.kind()),
            remedy,
        )
    }

    /// A number or the name of a parameter, checked.
    fn number(&self, key: Key) -> Result<f64, Box<Diagnostic>> {
        let named = match &self.node.value {
            Value::Text(text) => match self.sources.duration(key, text) {
                Some(seconds) => Ok(Some(seconds)),
                None => self.sources.named(&self.path, text).map(Some),
            },
            _ => Ok(None),
        };
        let allowed = key.range.words();
        let symbol = if key.symbol.is_empty() {
            String::new()
        } else {
            format!("{}, ", key.symbol)
        };
        let or_duration = match key.is_time() {
            true => ", or, if `units.time` = \"s\", a duration such as \"6h\"",
            false => "",
        };
        let remedy = format!("give {allowed} ({symbol}{}){or_duration}", key.meaning);
        let known = named.as_ref().err().filter(|known| !known.is_empty());
        if let Some(known) = known {
            let problem = format!("is neither a number nor a parameter; it must be {allowed}");
            return Err(self.diagnostic(
                problem,
                format!("{remedy}, or name a parameter: {}", known.join(", ")),
            ));
        }
        let value = self.node.number().or(named.ok().flatten());
        let Some(value) = value else {
            return Err(self.wrong_kind(allowed, remedy));
        };
        // 1e999 is a mistake.
        let is_word = matches!(&self.node.value, Value::Float(text) if text.ends_with("inf"));
        let is_never = is_word && key.range == Allowed::StaticThreshold;
        let problem = match value {
            x if x.is_nan() => "is not a number".to_string(),
            x if x.is_infinite() && !(x > 0.0 && is_never) => "is not finite".to_string(),
            x if !key.range.holds(x) => format!("is out of range: it must be {allowed}"),
            x if x.abs() > LARGEST
                && !matches!(key.range, Allowed::Threshold | Allowed::StaticThreshold) =>
            {
                let problem = format!("must not exceed {LARGEST:e}");
                return Err(self.diagnostic(
                    problem,
                    format!("choose units in which it is closer to 1, or {remedy}"),
                ));
            }
            _ => return Ok(value),
        };
        Err(self.diagnostic(problem, remedy))
    }

    /// A number that cannot be the name of a parameter.
    fn literal(&self, key: Key) -> Result<f64, Box<Diagnostic>> {
        match self.node.value {
            Value::Text(_) => {
                let remedy = "write a number; the name of a parameter is not allowed here";
                Err(self.wrong_kind(key.range.words(), remedy))
            }
            _ => self.number(key),
        }
    }

    fn whole(&self, range: RangeInclusive<u64>) -> Result<u64, Box<Diagnostic>> {
        let allowed = format!("a whole number from {} to {}", range.start(), range.end());
        let number = match &self.node.value {
            Value::Integer { digits, radix } => {
                Some(i128::from_str_radix(digits, *radix).unwrap_or(-1))
            }
            // 1e4 and "10k" are natural ways to write ten thousand, but not TOML integers.
            Value::Float(text) | Value::Text(text) => count(text),
            _ => None,
        };
        let remedy = format!("give {allowed}");
        let Some(number) = number else {
            return Err(self.wrong_kind(&allowed, remedy));
        };
        let inside = u64::try_from(number).ok().filter(|n| range.contains(n));
        inside.ok_or_else(|| {
            self.diagnostic(format!("is out of range: it must be {allowed}"), remedy)
        })
    }

    fn flag(&self) -> Result<bool, Box<Diagnostic>> {
        match self.node.value {
            Value::Boolean(value) => Ok(value),
            _ => Err(self.wrong_kind("true or false", "write true or false")),
        }
    }

    fn text(&self, is_wrong: fn(char) -> bool) -> Result<String, Box<Diagnostic>> {
        match &self.node.value {
            Value::Text(text) if text.chars().any(is_wrong) => Err(self.diagnostic(
                "contains a line break or another control character",
                "write it on one line",
            )),
            Value::Text(text) => Ok(text.clone()),
            _ => Err(self.wrong_kind("a string", "put it in quotes")),
        }
    }

    /// A word from a list, which `allowed` introduces.
    fn word(&self, words: &[&'static str], allowed: &str) -> Result<&'static str, Box<Diagnostic>> {
        let Value::Text(text) = &self.node.value else {
            return Err(self.wrong_kind("a string", format!("write {allowed} {}", quoted(words))));
        };
        if let Some(word) = words.iter().find(|word| **word == text) {
            return Ok(word);
        }
        let likeness = |word: &&'static str| (strsim::jaro_winkler(text, word), *word);
        let alike = words
            .iter()
            .map(likeness)
            .filter(|(likeness, _)| *likeness > 0.8);
        let nearest = alike
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, word)| word);
        let hint = nearest.map_or(String::new(), |word| format!("; did you mean \"{word}\"?"));
        let words = quoted(words);
        Err(self.diagnostic(
            format!("is not {allowed} {words}{hint}"),
            format!("write {allowed} {words}"),
        ))
    }
}

/// A table whose known keys can be read.
pub(super) struct Fields<'a> {
    sources: &'a Sources<'a>,
    /// The dotted name that messages use, such as "temperature.harmonics.0".
    path: String,
    /// The place of the table; `None` for the root and for a missing table, which is read as an
    /// empty one.
    pub place: Option<Place>,
    entries: &'a [KeyValue],
    /// Whether an error already reported for this table may explain a missing key.
    is_misread: bool,
}

impl<'a> Fields<'a> {
    /// The root table.
    pub fn root(sources: &'a Sources<'a>, node: &'a Node) -> Self {
        let root = Self::open(sources, "", String::new(), node);
        Fields {
            place: None,
            ..root
        }
    }

    /// Open a table of the kind `schema` (see `keys::TABLES`) and report its unknown keys.
    fn open(sources: &'a Sources<'a>, schema: &str, path: String, node: &'a Node) -> Self {
        let place = Some(node.place);
        let known = keys::of_table(schema);
        let Value::Table(entries) = &node.value else {
            let at = ValueAt {
                sources,
                path,
                node,
            };
            sources.report(at.wrong_kind(
                "a table",
                format!("write a table with the keys {}", known.join(", ")),
            ));
            return Fields {
                sources,
                path: at.path,
                place,
                entries: &[],
                is_misread: true,
            };
        };
        let mut is_misread = false;
        for entry in entries
            .iter()
            .filter(|entry| !known.contains(&entry.key.as_str()))
        {
            is_misread = true;
            let table = if schema.is_empty() {
                "a scenario".to_string()
            } else {
                format!("`{schema}`")
            };
            let meant = suggestion(schema, &entry.key);
            let hint = meant.as_ref().map_or(String::new(), |(name, _)| {
                format!("; did you mean `{name}`?")
            });
            let remedy = match meant {
                // Harmonics form an array, so the remedy shows a harmonic within its array.
                Some((name, _)) if name.starts_with("temperature.harmonics.") && schema != "temperature.harmonics" => {
                    "write `harmonics = [{ amplitude = 1.0, angular_frequency = 0.25 }]` under [temperature]"
                        .to_string()
                }
                Some((name, note)) => format!("write `{name}`{note}, or remove it"),
                None => "remove it".to_string(),
            };
            let problem = format!("unknown key `{}`{hint}", short(&entry.key));
            let remedy = format!("{remedy}; {table} takes {}", known.join(", "));
            sources.report(sources.diagnostic(Some(entry.key_place), problem, remedy));
        }
        Fields {
            sources,
            path,
            place,
            entries,
            is_misread,
        }
    }

    /// The dotted name of a key of this table.
    pub fn dotted(&self, name: &str) -> String {
        if self.path.is_empty() {
            name.to_string()
        } else {
            format!("{}.{name}", self.path)
        }
    }

    fn node(&self, name: &str) -> Option<&'a Node> {
        node_at(self.entries, name)
    }

    fn value(&self, name: &str) -> Option<ValueAt<'a>> {
        Some(ValueAt {
            sources: self.sources,
            path: self.dotted(name),
            node: self.node(name)?,
        })
    }

    /// The value of a key; none if it is missing, or invalid, which is reported.
    fn sound<T>(
        &self,
        key: Key,
        read: impl FnOnce(&ValueAt<'a>) -> Result<T, Box<Diagnostic>>,
    ) -> Option<T> {
        self.sources.or_report(read(&self.value(key.name)?))
    }

    /// The place of the value of a key, if present. The key may be dotted, for a table within this
    /// one; in an array of tables it is that of the table with the number that the key gives, or of
    /// the first table that has the key.
    pub fn place_of(&self, dotted: &str) -> Option<Place> {
        Some(node_at(self.entries, dotted)?.place)
    }

    /// A table within this one; an empty one if it is missing.
    pub fn table(&self, name: &str) -> Fields<'a> {
        let path = self.dotted(name);
        match self.node(name) {
            Some(node) => Self::open(self.sources, &path.clone(), path, node),
            None => Fields {
                sources: self.sources,
                path,
                place: None,
                entries: &[],
                is_misread: self.is_misread,
            },
        }
    }

    /// A table within this one, if present.
    pub fn table_if_present(&self, name: &str) -> Option<Fields<'a>> {
        self.node(name).is_some().then(|| self.table(name))
    }

    /// The tables of an array of tables; a missing array is empty.
    pub fn tables(&self, name: &str) -> Vec<Fields<'a>> {
        let Some(at) = self.value(name) else {
            return Vec::new();
        };
        let (sources, path) = (self.sources, &at.path);
        let Value::Array(items) = &at.node.value else {
            let remedy = format!(
                "write {name} = [{{ ... }}], with the keys {}",
                keys::of_table(path).join(", ")
            );
            sources.report(at.wrong_kind("an array of tables", remedy));
            return Vec::new();
        };
        items
            .iter()
            .enumerate()
            .map(|(i, item)| Self::open(sources, path, format!("{path}.{i}"), item))
            .collect()
    }

    /// The tables of a table whose keys are free names, with these; none if it is missing.
    pub fn named_tables(&self, name: &str) -> Vec<(&'a str, Fields<'a>)> {
        let Some(at) = self.value(name) else {
            return Vec::new();
        };
        let Value::Table(entries) = &at.node.value else {
            let remedy = format!(
                "write a table [{name}.NAME] with the keys {}",
                keys::of_table(name).join(", ")
            );
            self.sources.report(at.wrong_kind("a table", remedy));
            return Vec::new();
        };
        let open = |KeyValue { key, node, .. }: &'a KeyValue| {
            (
                key.as_str(),
                Self::open(self.sources, name, format!("{name}.{key}"), node),
            )
        };
        entries.iter().map(open).collect()
    }

    /// The tables of a key that may hold one table or an array of tables.
    pub fn one_or_more(&self, name: &str) -> Vec<Fields<'a>> {
        match self.node(name) {
            Some(Node {
                value: Value::Array(_),
                ..
            }) => self.tables(name),
            _ => self.table_if_present(name).into_iter().collect(),
        }
    }

    /// The numbers of a table whose keys are free, with their places; none if it is missing.
    pub fn numbers(&self, key: Key) -> Vec<(String, f64, Option<Place>)> {
        let read = |at: &ValueAt<'a>| {
            let Value::Table(entries) = &at.node.value else {
                return Err(at.wrong_kind("a table", "write names with numbers"));
            };
            let read = |KeyValue {
                            key,
                            key_place,
                            node,
                        }: &'a KeyValue| {
                let inside = ValueAt {
                    path: format!("{}.{key}", at.path),
                    node,
                    ..*at
                };
                (
                    key.clone(),
                    self.sources
                        .or_report(inside.literal(keys::PARAMETER))
                        .unwrap_or(1.0),
                    Some(*key_place),
                )
            };
            Ok(entries.iter().map(read).collect())
        };
        self.sound(key, read).unwrap_or_default()
    }

    /// A required number; an error is reported if it is missing.
    pub fn number(&self, key: Key) -> f64 {
        self.number_if_present(key)
            .unwrap_or_else(|| self.missing(key))
    }

    /// A required number, towards larger and towards smaller x: one for both, or a table.
    pub fn by_direction(&self, key: Key) -> [f64; 2] {
        let Some(Node {
            value: Value::Table(entries),
            place,
        }) = self.node(key.name)
        else {
            return [self.number(key); 2];
        };
        let path = self.dotted(key.name);
        let table = Fields {
            sources: self.sources,
            path,
            place: Some(*place),
            entries,
            is_misread: false,
        };
        for entry in entries
            .iter()
            .filter(|entry| !DIRECTIONS.contains(&entry.key.as_str()))
        {
            let problem = format!("unknown key `{}`", short(&entry.key));
            let remedy = format!("write {} = {{ forward = 1.2, backward = 1.4 }}", key.name);
            self.sources.report(
                self.sources
                    .diagnostic(Some(entry.key_place), problem, remedy),
            );
        }
        DIRECTIONS.map(|name| table.number(Key { name, ..key }))
    }

    /// A number, or its default if it is missing.
    pub fn number_or(&self, key: Key, default: f64) -> f64 {
        self.number_if_present(key).unwrap_or(default)
    }

    /// A number, if present.
    pub fn number_if_present(&self, key: Key) -> Option<f64> {
        let read = self.value(key.name)?.number(key);
        Some(
            self.sources
                .or_report(read)
                .unwrap_or_else(|| key.range.stand_in()),
        )
    }

    /// The numbers of a list, at most `most` of them; none if the key is missing.
    pub fn list(&self, key: Key, most: usize) -> Vec<f64> {
        let read = |at: &ValueAt<'a>| match &at.node.value {
            Value::Array(items) if items.len() <= most => {
                let number = |node| {
                    ValueAt {
                        path: at.path.clone(),
                        node,
                        ..*at
                    }
                    .literal(key)
                };
                let sound = |node| {
                    self.sources
                        .or_report(number(node))
                        .unwrap_or_else(|| key.range.stand_in())
                };
                Ok(items.iter().map(sound).collect())
            }
            Value::Array(items) => {
                let problem = format!("has {} numbers; at most {most} are allowed", items.len());
                Err(at.diagnostic(problem, format!("keep at most {most} of them")))
            }
            _ => Err(at.wrong_kind(
                "a list of numbers",
                format!("write {} = [1.0, 2.0]", key.name),
            )),
        };
        self.sound(key, read).unwrap_or_default()
    }

    /// A length of time, if present: a number unchanged, or a text such as "6h" in seconds.
    pub fn span_if_present(&self, key: Key) -> Option<f64> {
        let read = |at: &ValueAt<'a>| match &at.node.value {
            Value::Text(text) => stickslip_data::seconds(text).ok_or_else(|| {
                let remedy =
                    "write a positive duration such as \"6h\", \"90min\" or \"2d\", or a number";
                at.diagnostic("is not a duration", remedy)
            }),
            _ => at.number(key),
        };
        self.sound(key, read)
    }

    /// The error for a table that should not be there.
    pub fn diagnostic_of_table(&self, problem: &str, remedy: &str) -> Box<Diagnostic> {
        self.sources
            .diagnostic(self.place, problem, remedy)
            .of(&self.path)
    }

    /// The error for a text that is missing.
    pub fn missing_text(&self, key: Key, remedy: &str) -> Box<Diagnostic> {
        self.sources.diagnostic(
            self.place,
            format!("missing key `{}`", self.dotted(key.name)),
            remedy,
        )
    }

    /// A number or a word from a list, if present: `Ok(number)` or `Err(word)`.
    pub fn number_or_word(
        &self,
        key: Key,
        words: &[&'static str],
    ) -> Option<Result<f64, &'static str>> {
        let at = self.value(key.name)?;
        let is_name =
            |text: &str| !words.contains(&text) && self.sources.named(&at.path, text).is_ok();
        if !matches!(&at.node.value, Value::Text(text) if !is_name(text)) {
            return Some(Ok(self.number(key)));
        }
        let word = at.word(words, &format!("{} or one of", key.range.words()));
        Some(
            self.sources
                .or_report(word)
                .map_or_else(|| Ok(key.range.stand_in()), Err),
        )
    }

    /// A word from a list, if present.
    pub fn word(&self, key: Key, words: &[&'static str]) -> Option<&'static str> {
        self.sound(key, |at| at.word(words, "one of"))
    }

    /// A whole number within a range, if present.
    pub fn whole_if_present(&self, key: Key, range: RangeInclusive<u64>) -> Option<u64> {
        self.sound(key, |at| at.whole(range))
    }

    /// True or false, or the default if it is missing.
    pub fn flag_or(&self, key: Key, default: bool) -> bool {
        self.sound(key, ValueAt::flag).unwrap_or(default)
    }

    /// One line of text, or the default if it is missing.
    pub fn line_or(&self, key: Key, default: &str) -> String {
        self.sound(key, |at| at.text(char::is_control))
            .unwrap_or_else(|| default.to_string())
    }

    /// A text that may have line breaks and tabs; none if it is missing or invalid, which is
    /// reported.
    pub fn lines_if_sound(&self, key: Key) -> Option<String> {
        self.sound(key, |at| {
            at.text(|c| c.is_control() && !matches!(c, '\n' | '\r' | '\t'))
        })
    }

    /// The name of a column, or its number, if present.
    pub fn column_if_present(&self, key: Key) -> Option<String> {
        self.sound(key, |at| match &at.node.value {
            Value::Integer { digits, radix: 10 } => Ok(digits.clone()),
            _ => at.text(char::is_control),
        })
        .filter(|text| !text.is_empty())
    }

    /// One line of text, if present and not empty.
    pub fn line_if_present(&self, key: Key) -> Option<String> {
        Some(self.line_or(key, "")).filter(|text| !text.is_empty())
    }

    /// Numbers and texts of an array, as texts; none if it is missing. A number or a text alone is
    /// accepted as well.
    pub fn marks(&self, key: Key) -> Vec<String> {
        let read = |at: &ValueAt<'a>| {
            let items = if let Value::Array(items) = &at.node.value {
                items
            } else {
                std::slice::from_ref(at.node)
            };
            let text = |item: &Node| match &item.value {
                Value::Text(text) => Some(text.clone()),
                _ => item.number().map(|number| number.to_string()),
            };
            let texts: Option<Vec<String>> = items.iter().map(text).collect();
            texts.ok_or_else(|| {
                at.wrong_kind("numbers and strings", "write e.g. [-9999, \"no data\"]")
            })
        };
        self.sound(key, read).unwrap_or_default()
    }

    /// Report that a key is missing, and return the number that replaces it.
    fn missing(&self, key: Key) -> f64 {
        if self.is_misread {
            return key.range.stand_in();
        }
        let meaning = match key.symbol {
            "" => key.meaning.to_string(),
            symbol => format!("{symbol}, {}", key.meaning),
        };
        let problem = format!("missing key `{}`", self.dotted(key.name));
        let under = if self.place.is_some() {
            "there"
        } else {
            &format!("under [{}]", self.path)
        };
        let instead = match key.instead {
            "" => String::new(),
            instead => format!(", or {instead}"),
        };
        let remedy = format!(
            "add `{} = ...` {under}: {meaning}; {}{instead}",
            key.name,
            key.range.words()
        );
        self.sources
            .report(self.sources.diagnostic(self.place, problem, remedy));
        key.range.stand_in()
    }
}

/// The keys of a number by direction: towards larger x, and towards smaller.
pub(super) const DIRECTIONS: [&str; 2] = ["forward", "backward"];

/// The whole number given by a text such as "1e5", "1_000_000", "10k" or "2.5M".
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
    (whole.abs() < EXACT_INTEGERS && (number - whole).abs() <= f64::EPSILON * whole.abs())
        .then_some(whole as i128)
}

/// 2^53: above it, not every whole number is a double.
const EXACT_INTEGERS: f64 = 9_007_199_254_740_992.0;

fn quoted(words: &[&str]) -> String {
    words
        .iter()
        .map(|word| format!("\"{word}\""))
        .collect::<Vec<_>>()
        .join(", ")
}
