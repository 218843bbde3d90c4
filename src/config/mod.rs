//! From text to a checked scenario, and back. This is the only module that reads or writes TOML.
//!
//! ```text
//! source    the texts: a file, and the overrides of a command line
//!   -> tree      TOML with the place of every value, and the overrides applied to it
//!        -> fields    a table read key by key: unknown keys, types, ranges (keys lists them all)
//!             -> parse     the whole scenario (physics and time are files of their own)
//!                  -> a checked Scenario, or the Faults with their places (blame, error)
//! series    the files of a measured temperature and of inputs
//! bridge    reads only what a study of measurements needs, from the same tree: a BridgeScene
//! text      a Scenario as TOML with every default; reading it again gives the same Scenario
//! shipped   the scenarios that come with the program
//! ```

mod bridge;
mod diagnose;
mod error;
mod fields;
mod force;
mod keys;
mod overrides;
mod parse;
mod physics;
mod random;
mod series;
mod shipped;
mod source;
mod synonyms;
mod text;
mod time;
mod tree;

#[cfg(test)]
mod tests;

pub use bridge::temperature_source;
pub use error::{Diagnostic, ScenarioError, Unreadable};
pub use overrides::Override;
pub use shipped::{SHIPPED, Shipped, shipped, shipped_at};
pub use synonyms::{OPTIONS, key_meant, option_meant};
pub use text::temperature_part;

use crate::model::{NamedSeries, RandomInput};
use crate::scenario::Scenario;
use source::{MeasuredFrom, Sources};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The symbol of the paper and the meaning of a dotted key with a numeric value. The symbol is
/// empty if the key has none.
///
/// ```
/// use stickslip::config::symbol_and_meaning;
///
/// assert_eq!(symbol_and_meaning("temperature.noise.intensity"), Some(("rho", "weight of v in T")));
/// assert_eq!(symbol_and_meaning("temperature.harmonics.0.amplitude").map(|key| key.0), Some("a"));
/// assert_eq!(symbol_and_meaning("ensemble.paths"), None);
/// ```
pub fn symbol_and_meaning(key: &str) -> Option<(&'static str, &'static str)> {
    keys::of_name(key).map(|key| (key.symbol, key.meaning))
}

/// A key of a scenario, in the words of the documentation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyDescription {
    /// The dotted key. Of the harmonics only the first is listed, and `NAME` denotes that of an
    /// input.
    pub key: String,
    /// The symbol of the paper; empty if there is none.
    pub symbol: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// The default, or `required`.
    pub default: &'static str,
    /// The permitted values.
    pub allowed: &'static str,
}

/// Every key of a scenario, in the order in which `mc check` prints them.
pub fn keys() -> Vec<KeyDescription> {
    let dotted = |table: &str, name: &str| match table {
        "" => name.to_string(),
        "temperature.harmonics" => format!("{table}.0.{name}"),
        "input" => format!("{table}.NAME.{name}"),
        table => format!("{table}.{name}"),
    };
    let described = |(table, key): (&str, &keys::Key)| KeyDescription {
        key: dotted(table, key.name),
        symbol: key.symbol,
        meaning: key.meaning,
        unit: key.unit,
        default: match (table, key.default) {
            ("displacement.series", "") => "none",
            ("displacement.series", _)
                if ![keys::VALUE.name, keys::UNIT.name].contains(&key.name) =>
            {
                "as in `temperature.series`"
            }
            (_, "") => "required",
            (_, default) => default,
        },
        allowed: match key.allowed {
            "" => key.range.words(),
            allowed => allowed,
        },
    };
    let is_table = |key: &KeyDescription| keys::TABLES.iter().any(|(table, _)| *table == key.key);
    let all = keys::TABLES
        .iter()
        .flat_map(|(table, keys)| keys.iter().map(|key| described((table, key))));
    all.filter(|key| !is_table(key)).collect()
}

/// Largest scenario file, in bytes. A larger file is assumed to be of another kind.
const MAX_FILE: u64 = 1 << 20;

/// The first bytes of an HDF5 file.
const HDF5_SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// The path that denotes standard input.
pub const STANDARD_INPUT: &str = "-";

/// Everything, up to one byte more than the limit of a scenario.
fn read_all(from: impl Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    from.take(MAX_FILE + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The bytes of standard input. They are kept, because a stream can be read only once, and a sweep
/// reads its scenario again for each of its points.
fn standard_input() -> io::Result<Vec<u8>> {
    static KEPT: Mutex<Option<Vec<u8>>> = Mutex::new(None);
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if kept.is_none() {
        *kept = Some(read_all(io::stdin().lock())?);
    }
    Ok(kept.clone().unwrap_or_default())
}

/// The text of a scenario file, or of standard input if the path is "-". The first string returned
/// is the name that messages use for it.
pub fn text_of(path: &Path) -> Result<(String, String), ScenarioError> {
    let is_standard_input = path == Path::new(STANDARD_INPUT);
    let name = if is_standard_input {
        "standard input".to_string()
    } else {
        path.display().to_string()
    };
    let unreadable = |cause: Unreadable| ScenarioError::Unreadable {
        path: name.clone(),
        cause,
    };
    if path.is_dir() {
        return Err(unreadable(Unreadable::Directory));
    }
    let read = match is_standard_input {
        true => standard_input(),
        false => std::fs::File::open(path).and_then(read_all),
    };
    let bytes = read.map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            unreadable(Unreadable::Missing(shipped::nearest(&stem)))
        }
        _ => unreadable(Unreadable::Refused(error.to_string())),
    })?;
    if bytes.starts_with(HDF5_SIGNATURE) {
        return Err(unreadable(Unreadable::Results));
    }
    if bytes.len() as u64 > MAX_FILE {
        return Err(unreadable(Unreadable::TooLarge));
    }
    let text = String::from_utf8(bytes).map_err(|e| {
        let valid = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line = valid.iter().filter(|byte| **byte == b'\n').count() + 1;
        unreadable(Unreadable::NotText(line))
    })?;
    Ok((name, text))
}

/// All input files of a scenario, which must not be overwritten: its own, and those that it or an
/// override names. Every key with a file is called `file`.
pub fn input_files(path: &Path, overrides: &[Override]) -> Vec<PathBuf> {
    let shipped = shipped_at(path);
    let read = || {
        shipped
            .map(|found| (found.name.into(), found.text.into()))
            .or_else(|| text_of(path).ok())
    };
    let Some((name, text)) = read() else {
        return vec![path.to_owned()];
    };
    let sources = Sources::new(&name, &text, overrides, MeasuredFrom::Files);
    let sources = shipped.into_iter().fold(sources, Sources::of_shipped);
    // Errors in the text are reported when the scenario is read.
    let tree = tree::read(&sources).ok();
    let named = tree.iter().flat_map(|tree| tree.texts_at(keys::FILE.name));
    // The data of a shipped scenario are not in files.
    let named = named
        .filter(|(place, file)| sources.data(file).is_none() || sources.is_override(Some(*place)));
    std::iter::once(path.to_owned())
        .chain(named.map(|(place, file)| sources.path_of(file, Some(place))))
        .collect()
}

impl Shipped {
    /// The scenario with the overrides applied, checked. The data files that its text names are
    /// those that are built into the program; only a file that an override names is read.
    pub fn parse(&self, overrides: &[Override]) -> Result<Scenario, ScenarioError> {
        parse::scenario(
            &Sources::new(self.name, self.text, overrides, MeasuredFrom::Files).of_shipped(self),
        )
    }
}

impl Scenario {
    /// The shipped scenario of this name, checked. If there is none, the error lists the names.
    pub fn shipped(name: &str) -> Result<Self, ScenarioError> {
        match shipped(name) {
            Some(found) => found.parse(&[]),
            None => Err(ScenarioError::Unreadable {
                path: name.to_string(),
                cause: Unreadable::NotShipped,
            }),
        }
    }

    /// Read a file, apply the overrides in order, and check the result. The name of a shipped
    /// scenario is accepted instead of a file.
    pub fn read(path: &Path, overrides: &[Override]) -> Result<Self, ScenarioError> {
        if let Some(found) = shipped_at(path) {
            return found.parse(overrides);
        }
        let (name, text) = text_of(path)?;
        Self::parse(&name, &text, overrides)
    }

    /// Read a text, apply the overrides, and check the result. Messages call the text `name`, and
    /// the stem of `name` is the default title. Data files named in the text are relative to the
    /// folder of `name`.
    pub fn parse(name: &str, text: &str, overrides: &[Override]) -> Result<Self, ScenarioError> {
        parse::scenario(&Sources::new(name, text, overrides, MeasuredFrom::Files))
    }

    /// The same for a text whose measured values are stored with it, as in the file of a run, each
    /// named by the table that describes it. No other file is read unless an override names one.
    pub fn parse_stored(
        name: &str,
        text: &str,
        overrides: &[Override],
        stored: &[NamedSeries],
    ) -> Result<Self, ScenarioError> {
        parse::scenario(&Sources::new(
            name,
            text,
            overrides,
            MeasuredFrom::Stored(stored),
        ))
    }

    /// The same with given values in place of the tables with these names, such as
    /// `temperature.series` or `input.ag`. These may be missing. The file of a run keeps the values
    /// beside the text, like those of a data file.
    pub fn parse_measured(
        name: &str,
        text: &str,
        overrides: &[Override],
        samples: &[NamedSeries],
    ) -> Result<Self, ScenarioError> {
        parse::scenario(&Sources::new(
            name,
            text,
            overrides,
            MeasuredFrom::Given(samples, &[]),
        ))
    }

    /// The same with given values and processes in place of the tables with these names.
    pub fn parse_drawn(
        name: &str,
        text: &str,
        overrides: &[Override],
        samples: &[NamedSeries],
        random: &[RandomInput],
    ) -> Result<Self, ScenarioError> {
        let given = MeasuredFrom::Given(samples, random);
        parse::scenario(&Sources::new(name, text, overrides, given))
    }

    /// The number at a dotted key of the resolved scenario, if there is one.
    ///
    /// ```
    /// use stickslip::scenario::Scenario;
    ///
    /// let scenario = Scenario::shipped("rho025")?;
    /// assert_eq!(scenario.number_at("temperature.harmonics.0.angular_frequency"), Some(0.25));
    /// assert_eq!(scenario.number_at("friction.sttic"), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn number_at(&self, key: &str) -> Option<f64> {
        let text = self.to_toml();
        let tree = tree::read(&Sources::new("", &text, &[], MeasuredFrom::Files)).ok()?;
        let parameter = |name: &str| tree.at(&format!("{}.{name}", tree::PARAMETERS))?.number();
        let found = tree.at(&tree::in_one_scope(key).unwrap_or_else(|| key.to_string()));
        match found.map(|node| (&node.value, node.number())) {
            // A parameter is a key by itself, as in an override.
            None => parameter(key),
            Some((tree::Value::Text(name), _)) => parameter(name),
            Some((_, number)) => number,
        }
    }
}
