//! TOML with the place of every value: the file as a tree, and the overrides applied to it.

use super::error::Diagnostic;
use super::keys;
use super::overrides::Override;
use super::source::{Place, Sources};
use std::borrow::Cow;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and its place.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub place: Place,
    pub value: Value,
}

/// A TOML value. Numbers are kept as written, so that none is rounded or overflows before it is
/// checked.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Text(String),
    Integer { digits: String, radix: u32 },
    Float(String),
    Boolean(bool),
    Datetime,
    Array(Vec<Node>),
    Table(Vec<KeyValue>),
}

/// A key of a table, with its value.
#[derive(Clone, Debug)]
pub(super) struct KeyValue {
    pub key: String,
    pub key_place: Place,
    pub node: Node,
}

impl Node {
    /// The node at this dotted key, if there is one. In an array of tables it is that of the table
    /// with this number, or without a number that of the first table that has the key.
    pub fn at(&self, dotted: &str) -> Option<&Node> {
        match &self.value {
            Value::Array(items) => {
                let numbered = dotted
                    .split_once('.')
                    .and_then(|(i, rest)| Some((i.parse::<usize>().ok()?, rest)));
                match numbered {
                    Some((i, rest)) => items.get(i)?.at(rest),
                    None => items.iter().find_map(|item| item.at(dotted)),
                }
            }
            Value::Table(entries) => node_at(entries, dotted),
            _ => None,
        }
    }

    /// The number in it. A whole number is accepted as well.
    pub fn number(&self) -> Option<f64> {
        match &self.value {
            Value::Float(text) => text.parse().ok(),
            Value::Integer { digits, radix: 10 } => digits.parse().ok(),
            Value::Integer { digits, radix } => {
                i128::from_str_radix(digits, *radix).ok().map(|n| n as f64)
            }
            _ => None,
        }
    }

    /// The texts of this key, in whatever table it is, with their places.
    pub fn texts_at(&self, key: &str) -> Vec<(Place, &str)> {
        match &self.value {
            Value::Array(items) => items.iter().flat_map(|item| item.texts_at(key)).collect(),
            Value::Table(entries) => entries
                .iter()
                .flat_map(|entry| entry.texts_at(key))
                .collect(),
            _ => Vec::new(),
        }
    }
}

/// The node at this dotted key below a table, as [`Node::at`].
pub(super) fn node_at<'n>(entries: &'n [KeyValue], dotted: &str) -> Option<&'n Node> {
    let (first, rest) = dotted
        .split_once('.')
        .map_or((dotted, None), |(first, rest)| (first, Some(rest)));
    let node = &entries.iter().find(|entry| entry.key == first)?.node;
    rest.map_or(Some(node), |rest| node.at(rest))
}

impl KeyValue {
    fn texts_at(&self, key: &str) -> Vec<(Place, &str)> {
        match &self.node.value {
            Value::Text(text) if self.key == key => vec![(self.node.place, text)],
            _ => self.node.texts_at(key),
        }
    }
}

impl Value {
    /// The name of such a value in messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Text(_) => "a string",
            Value::Integer { .. } => "a whole number",
            Value::Float(_) => "a number",
            Value::Boolean(_) => "true or false",
            Value::Datetime => "a date",
            Value::Array(_) => "an array",
            Value::Table(_) => "a table",
        }
    }
}

/// The tree of the file with every override applied, in order.
pub(super) fn read(sources: &Sources<'_>) -> Result<Node, Box<Diagnostic>> {
    let parsed = DeTable::parse(sources.text).map_err(|e| {
        let place = e.span().map(|span| Place {
            text: 0,
            start: span.start,
            end: span.end,
        });
        let remedy = "write TOML: `key = value` lines under `[table]` headers";
        sources.diagnostic(
            place,
            format!("not valid TOML: {}", one_line(e.message())),
            remedy,
        )
    })?;
    let mut root = Node {
        place: Place {
            text: 0,
            start: 0,
            end: 0,
        },
        value: table(parsed.into_inner(), 0),
    };
    gather_parameters(&mut root);
    for i in 0..sources.overrides.len() {
        lay_over(&mut root, sources, i)?;
    }
    gather_parameters(&mut root);
    let unit = root.at("units.time").map(|unit| &unit.value);
    let is_in_seconds =
        matches!(unit, Some(Value::Text(unit)) if !unit.is_empty() && SECONDS.contains(&&**unit));
    sources.set_scope(parameters(&root), is_in_seconds);
    Ok(root)
}

/// The labels of `units.time` that mean seconds.
pub(super) const SECONDS: [&str; 5] = ["", "s", "sec", "second", "seconds"];

/// Tables that may contain parameters next to their expression, as in `force.parameters`.
const OTHER_SCOPES: [&str; 2] = ["force", "friction"];

/// The key in the one table of parameters, of a parameter in that of [`OTHER_SCOPES`].
pub(super) fn in_one_scope(key: &str) -> Option<String> {
    let rest = OTHER_SCOPES.iter().find_map(|home| {
        let rest = key.strip_prefix(home)?.strip_prefix('.')?;
        rest.strip_prefix(PARAMETERS)
    })?;
    rest.starts_with('.').then(|| format!("{PARAMETERS}{rest}"))
}

/// Moves the parameters of [`OTHER_SCOPES`] to the one table of parameters. A parameter already
/// there with the same value is left out.
fn gather_parameters(root: &mut Node) {
    for home in OTHER_SCOPES {
        let Value::Table(tables) = &mut root.value else {
            return;
        };
        let moved = tables
            .iter_mut()
            .find(|table| table.key == home)
            .and_then(|table| match &mut table.node.value {
                Value::Table(entries) => {
                    let is_scope = |entry: &mut KeyValue| {
                        entry.key == PARAMETERS && matches!(entry.node.value, Value::Table(_))
                    };
                    entries.extract_if(.., is_scope).next()
                }
                _ => None,
            });
        let known = tables.iter_mut().find(|table| table.key == PARAMETERS);
        match (moved, known.map(|table| &mut table.node.value)) {
            (Some(moved), None) => tables.push(moved),
            (Some(moved), Some(Value::Table(known))) => {
                let Value::Table(more) = moved.node.value else {
                    continue;
                };
                for entry in more {
                    let is_same = |other: &KeyValue| {
                        other.key == entry.key && other.node.number() == entry.node.number()
                    };
                    if !known.iter().any(is_same) {
                        known.push(entry);
                    }
                }
            }
            _ => {}
        }
    }
}

/// The parameters. One that is not a number is reported where it is read, and is 1 until then.
fn parameters(root: &Node) -> Vec<(String, f64)> {
    let Some(Node {
        value: Value::Table(entries),
        ..
    }) = root.at(PARAMETERS)
    else {
        return Vec::new();
    };
    entries
        .iter()
        .map(|entry| (entry.key.clone(), entry.node.number().unwrap_or(1.0)))
        .collect()
}

fn node(value: Spanned<DeValue<'_>>, text: usize) -> Node {
    let span = value.span();
    let place = Place {
        text,
        start: span.start,
        end: span.end,
    };
    let value = match value.into_inner() {
        DeValue::String(s) => Value::Text(s.into_owned()),
        DeValue::Integer(i) => Value::Integer {
            digits: i.as_str().to_string(),
            radix: i.radix(),
        },
        DeValue::Float(x) => Value::Float(x.as_str().to_string()),
        DeValue::Boolean(b) => Value::Boolean(b),
        DeValue::Datetime(_) => Value::Datetime,
        DeValue::Array(items) => {
            Value::Array(items.into_iter().map(|item| node(item, text)).collect())
        }
        DeValue::Table(entries) => table(entries, text),
    };
    Node { place, value }
}

fn table(entries: DeTable<'_>, text: usize) -> Value {
    let mut entries: Vec<KeyValue> = entries
        .into_iter()
        .map(|(key, value)| {
            let span = key.span();
            let key_place = Place {
                text,
                start: span.start,
                end: span.end,
            };
            KeyValue {
                key: key.into_inner().into_owned(),
                key_place,
                node: node(value, text),
            }
        })
        .collect();
    // Entries are in the order of the file, so that the first mistake in it is reported first.
    entries.sort_by_key(|entry| entry.key_place.start);
    Value::Table(entries)
}

/// Apply override `i`: follow its dotted key, creating tables on the way, and set its value there.
fn lay_over(root: &mut Node, sources: &Sources<'_>, i: usize) -> Result<(), Box<Diagnostic>> {
    let this = &sources.overrides[i];
    let place = Place {
        text: i + 1,
        start: 0,
        end: 0,
    };
    let is_table = keys::of_table("").contains(&this.key.as_str());
    let parameter = format!("{PARAMETERS}.{}", this.key);
    let key = if !is_table && root.at(&parameter).is_some() {
        parameter
    } else {
        in_one_scope(&this.key).unwrap_or_else(|| this.key.clone())
    };
    let mut spot = root;
    let mut walked = String::new();
    for segment in key.split('.') {
        let segment = segment.trim();
        spot = child(spot, segment, &walked, &this.key, place)
            .map_err(|(problem, remedy)| sources.diagnostic(Some(place), problem, remedy))?;
        if !walked.is_empty() {
            walked.push('.');
        }
        walked.push_str(segment);
    }
    spot.value = override_value(this, i + 1)
        .map_err(|(problem, remedy)| sources.diagnostic(Some(place), problem, remedy))?;
    relocate(spot, place);
    Ok(())
}

/// The problem with an override, and its remedy.
type Wrong = (String, String);

/// The node of a segment of the override `key`, below the node at `walked`; created if it is a new
/// key of a table or the next entry of an array.
fn child<'n>(
    node: &'n mut Node,
    segment: &str,
    walked: &str,
    key: &str,
    place: Place,
) -> Result<&'n mut Node, Wrong> {
    if segment.is_empty() {
        return Err((
            format!("`{key}` is not a key"),
            "write table.key=value, e.g. friction.static=1.3, or temperature.harmonics.0.amplitude=2".into(),
        ));
    }
    let empty = Node {
        place,
        value: Value::Table(Vec::new()),
    };
    match &mut node.value {
        Value::Table(entries) => {
            let at = entries
                .iter()
                .position(|entry| entry.key == segment)
                .unwrap_or_else(|| {
                    entries.push(KeyValue {
                        key: segment.to_string(),
                        key_place: place,
                        node: empty,
                    });
                    entries.len() - 1
                });
            Ok(&mut entries[at].node)
        }
        Value::Array(items) => {
            let n = items.len();
            // An index one past the end appends an entry.
            let index = segment.parse().ok().filter(|&index| index <= n);
            let index: usize = index.ok_or_else(|| {
                (
                    format!("`{walked}` has {n} entries, and `{segment}` is not one of them"),
                    format!("number them from 0; `{walked}.{n}` adds one"),
                )
            })?;
            if index == n {
                items.push(empty);
            }
            Ok(&mut items[index])
        }
        other => Err((
            format!("`{walked}` is {}, so there is no `{key}`", other.kind()),
            format!("set `{walked}` itself"),
        )),
    }
}

/// The value of an override, which is this text of the sources.
fn override_value(this: &Override, number: usize) -> Result<Value, Wrong> {
    let text = &whole(this.value.trim());
    let is_quoted = text.starts_with(['"', '\'']);
    match DeValue::parse(text) {
        // An expression needs no quotes on a command line, where a shell would remove them.
        _ if EXPRESSIONS.contains(&this.key.trim()) && !is_quoted => {
            Ok(Value::Text(text.to_string()))
        }
        Ok(value) => Ok(node(value, number).value),
        // The value is a bare word, a count such as 10k, or a duration such as 6h.
        Err(_)
            if text.starts_with(|c: char| c.is_alphabetic())
                || is_count(text)
                || stickslip_data::seconds(text).is_some() =>
        {
            Ok(Value::Text(text.to_string()))
        }
        Err(e) => Err((
            format!("`{text}` is not a TOML value: {}", one_line(e.message())),
            "give a number, a word, true, false, \"a string\" or { key = value }".into(),
        )),
    }
}

/// The table of parameters, each of which is a key.
pub(super) const PARAMETERS: &str = keys::PARAMETERS.name;

/// A number such as .5 with the zero that TOML requires.
fn whole(text: &str) -> Cow<'_, str> {
    let digits = text.trim_start_matches(['-', '+']);
    let begins = digits.starts_with('.') && digits[1..].starts_with(|c: char| c.is_ascii_digit());
    if begins {
        Cow::Owned(text.replacen('.', "0.", 1))
    } else {
        Cow::Borrowed(text)
    }
}

/// The keys whose values are expressions.
const EXPRESSIONS: [&str; 2] = ["force.expression", "friction.load"];

/// Whether a text is a number followed by a unit, such as 10k.
fn is_count(text: &str) -> bool {
    let digits = text.strip_suffix(['k', 'K', 'M', 'G']).unwrap_or_default();
    !digits.is_empty()
        && digits
            .chars()
            .all(|c| c.is_ascii_digit() || "._".contains(c))
}

/// The place of every value within an override is the override as a whole.
fn relocate(node: &mut Node, place: Place) {
    node.place = place;
    match &mut node.value {
        Value::Array(items) => items.iter_mut().for_each(|item| relocate(item, place)),
        Value::Table(entries) => entries.iter_mut().for_each(|entry| {
            entry.key_place = place;
            relocate(&mut entry.node, place);
        }),
        _ => {}
    }
}

fn one_line(message: &str) -> String {
    message
        .trim_end_matches(", expected nothing")
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}
