//! Text -> a checked scenario, and back. The only home of TOML.
//!
//! ```text
//! source    the texts: a file, and the overrides of a command line
//!   -> tree      TOML with the place of every value, overrides laid over it
//!        -> fields    a table read key by key: unknown keys, types, ranges (keys lists them all)
//!             -> parse     all of it: physics, time, and the rest
//!                  -> a Scenario whose values go together, or the Faults that say what to change (blame: where)
//! series    the file of a measured temperature
//! bridge    of the same tree only what a calibration needs -> a BridgeScene
//! text      a Scenario -> TOML, every default visible; reading it again gives the same Scenario
//! shipped   the scenarios that come with the program
//! ```

mod blame;
mod bridge;
mod error;
mod fields;
mod keys;
mod overrides;
mod parse;
mod physics;
mod series;
mod shipped;
mod source;
mod text;
mod time;
mod tree;

#[cfg(test)]
mod tests;

pub use error::{Fault, ScenarioError};
pub use overrides::Override;
pub use shipped::{SHIPPED, Shipped, shipped};

use crate::model::{Series, Temperature};
use crate::scenario::Scenario;
use source::{Samples, Sources};
use std::io::Read as _;
use std::path::Path;
use std::sync::Arc;

/// The paper's symbol of a dotted key that holds a number, and what it means; no symbol where it has none.
///
/// ```
/// use stick_slip::config::symbol_and_meaning;
///
/// assert_eq!(symbol_and_meaning("temperature.noise.intensity"), Some(("rho", "weight of v in T")));
/// assert_eq!(symbol_and_meaning("temperature.harmonics.0.amplitude").map(|key| key.0), Some("a"));
/// assert_eq!(symbol_and_meaning("ensemble.paths"), None);
/// ```
pub fn symbol_and_meaning(key: &str) -> Option<(&'static str, &'static str)> {
    keys::number(key).map(|key| (key.symbol, key.meaning))
}

/// Every key of a scenario, dotted, in the order in which `mc check` prints them; of harmonics the first.
pub fn keys() -> Vec<String> {
    let dotted = |table: &str, name: &str| match table {
        "" => name.to_string(),
        "temperature.harmonics" => format!("{table}.0.{name}"),
        table => format!("{table}.{name}"),
    };
    let is_table = |key: &String| keys::TABLES.iter().any(|(table, _)| table == key);
    let all = keys::TABLES.iter().flat_map(|(table, names)| names.iter().map(|name| dotted(table, name)));
    all.filter(|key| !is_table(key)).collect()
}

/// The part of a scenario that says its temperature: `[temperature.harmonics]` and `[temperature.noise]`. A series is
/// left out, because it is a file of its own.
pub fn temperature_part(temperature: &Temperature) -> String {
    text::of_temperature(temperature)
}

/// Largest scenario file, in bytes; one that is larger is some other file.
const MAX_FILE: u64 = 1 << 20;

/// How an HDF5 file starts.
const HDF5_SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// What stands for a scenario that is read from standard input in the place of a path.
pub const STANDARD_INPUT: &str = "-";

/// The text of a scenario file, or of standard input where the path is "-", and what messages call it.
pub fn text_of(path: &Path) -> Result<(String, String), ScenarioError> {
    let is_standard_input = path == Path::new(STANDARD_INPUT);
    let name = if is_standard_input { "standard input".to_string() } else { path.display().to_string() };
    let unreadable = |reason: String, remedy: String| ScenarioError::Unreadable { path: name.clone(), reason, remedy };
    let not_scenario = || "give the path of a scenario, a TOML file; `mc init` writes one".to_string();
    if path.is_dir() {
        return Err(unreadable("it is a directory".into(), not_scenario()));
    }
    let mut bytes = Vec::new();
    let read = match is_standard_input {
        true => std::io::stdin().lock().take(MAX_FILE + 1).read_to_end(&mut bytes),
        false => std::fs::File::open(path).and_then(|file| file.take(MAX_FILE + 1).read_to_end(&mut bytes)),
    };
    read.map_err(|e| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let remedy = match (e.kind(), shipped(&stem)) {
            (std::io::ErrorKind::NotFound, Some(_)) => {
                format!("`mc init --from {stem}` writes the shipped scenario")
            }
            _ => not_scenario(),
        };
        unreadable(e.to_string(), remedy)
    })?;
    if bytes.starts_with(HDF5_SIGNATURE) {
        let remedy = format!(
            "`mc show {name}` shows the results in it, and `mc show {name} --scenario` prints the scenario they are of"
        );
        return Err(unreadable("it is an HDF5 file".into(), remedy));
    }
    if bytes.len() as u64 > MAX_FILE {
        return Err(unreadable("it is larger than 1 MiB".into(), not_scenario()));
    }
    let text = String::from_utf8(bytes).map_err(|e| {
        let valid = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line = valid.iter().filter(|byte| **byte == b'\n').count() + 1;
        unreadable(format!("line {line} is not UTF-8 text"), "save it as UTF-8, without a byte-order mark".into())
    })?;
    Ok((name, text))
}

impl Scenario {
    /// Read a file, lay the overrides over it in order, check the result.
    pub fn read(path: &Path, overrides: &[Override]) -> Result<Self, ScenarioError> {
        let (name, text) = text_of(path)?;
        Self::parse(&name, &text, overrides)
    }

    /// Check a text with overrides laid over it; `name` is what messages call it, and its stem the
    /// default title. A file that the text names is looked for in the folder of `name`.
    pub fn parse(name: &str, text: &str, overrides: &[Override]) -> Result<Self, ScenarioError> {
        parsed(&Sources::new(name, text, overrides, None))
    }

    /// The same where the samples of a measured temperature are stored beside the text, as in results: no other file is read
    /// unless an override names one.
    pub fn parse_stored(
        name: &str,
        text: &str,
        overrides: &[Override],
        stored: Option<&Arc<Series>>,
    ) -> Result<Self, ScenarioError> {
        parsed(&Sources::new(name, text, overrides, stored.map(Samples::Stored)))
    }

    /// The same with the samples of a measured temperature in the place of `[temperature.series]`, which may be missing. Results
    /// hold them beside the text, as they hold those of a file.
    pub fn parse_measured(
        name: &str,
        text: &str,
        overrides: &[Override],
        samples: &Arc<Series>,
    ) -> Result<Self, ScenarioError> {
        parsed(&Sources::new(name, text, overrides, Some(Samples::Given(samples))))
    }

    /// The number at a dotted key of the resolved scenario, if there is one.
    ///
    /// ```
    /// use stick_slip::scenario::Scenario;
    ///
    /// let scenario = Scenario::shipped("rho025")?;
    /// assert_eq!(scenario.number_at("temperature.harmonics.0.angular_frequency"), Some(0.25));
    /// assert_eq!(scenario.number_at("friction.sttic"), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn number_at(&self, key: &str) -> Option<f64> {
        let mut spot = &toml::Value::Table(self.to_toml().parse().ok()?);
        for segment in key.split('.').map(str::trim) {
            spot = match spot {
                toml::Value::Table(table) => table.get(segment)?,
                toml::Value::Array(items) => items.get(segment.parse::<usize>().ok()?)?,
                _ => return None,
            };
        }
        spot.as_float().or_else(|| spot.as_integer().map(|whole| whole as f64))
    }

    /// The whole scenario as TOML to be changed by hand: every default visible, every key with a comment, and the parts that
    /// it does not use as comments. Parsing it gives this scenario again.
    pub fn to_template(&self) -> String {
        text::template(self)
    }

    /// The whole scenario as TOML, every default visible; parsing it gives this scenario again.
    pub fn to_toml(&self) -> String {
        text::resolved(self)
    }
}

/// The stem of the name is the default title.
fn parsed(sources: &Sources<'_>) -> Result<Scenario, ScenarioError> {
    let stem = Path::new(sources.name).file_stem().unwrap_or_default().to_string_lossy();
    let title: String = stem.chars().filter(|c| !c.is_control()).collect();
    parse::scenario(sources, &title)
}
