//! A scenario: one physical question, read from TOML and checked. The only home of TOML.
//!
//! ```text
//! source    the texts: a file, and the overrides of a command line
//!   -> tree      TOML with the place of every value, overrides laid over it
//!        -> fields    a table read key by key: unknown keys, types, ranges (keys lists them all)
//!             -> parse, time_keys   a checked Scenario, or the Fault that says what to change
//! time      duration and output grid, and whether they go with a scheme
//! text      a Scenario -> TOML, every default visible; reading it again gives the same Scenario
//! check     what follows from a Scenario before it is run; amplitude: how far it may go
//! warnings  what to know before trusting the run
//! plan      the ensemble that answers it
//! ```

mod amplitude;
mod check;
mod error;
mod fields;
mod keys;
mod parse;
mod plan;
mod shipped;
mod source;
mod text;
mod time;
mod time_keys;
mod tree;
mod warnings;

#[cfg(test)]
mod tests;

pub use check::Derived;
pub use error::{Fault, ScenarioError};
pub use parse::{MAX_PATHS, MAX_TRAJECTORIES};
pub use shipped::{SHIPPED, Shipped, shipped};
pub use time::{MAX_ROWS, MAX_STEPS, Time};
pub use warnings::Warning;

pub use crate::stats::Units;

use crate::model::Model;
use crate::scheme::{Scheme, Timeline};
use crate::stats::Record;
use source::Sources;
use std::fmt;
use std::io::Read as _;
use std::path::Path;

/// A checked scenario: every number in it is finite and in range.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// What the scenario asks, in a line.
    pub title: String,
    /// The physics.
    pub model: Model,
    /// Duration and output grid.
    pub time: Time,
    /// How it is simulated.
    pub scheme: Scheme,
    /// How many paths, from which seed.
    pub ensemble: Ensemble,
    /// What is kept of single paths.
    pub record: Record,
    /// Labels, used in tables and attributes only.
    pub units: Units,
}

/// How many paths, from which seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ensemble {
    /// Number of paths.
    pub paths: u64,
    /// Seed; with the path number it determines a path.
    pub seed: u64,
}

/// A key of a scenario with a value to put there, and how the user wrote it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    shown: String,
    key: String,
    value: String,
}

impl Override {
    /// From `--set key=value`: the key is dotted (`friction.static`, `temperature.harmonics.0.amplitude`), the value is
    /// TOML, or a bare word for a string.
    pub fn set(text: &str) -> Result<Self, ScenarioError> {
        let shown = format!("--set {text}");
        match text.split_once('=') {
            Some((key, value)) => Ok(Override { shown, key: key.trim().to_string(), value: value.trim().to_string() }),
            None => Err(Box::new(Fault {
                origin: shown,
                line: None,
                column: None,
                key: None,
                value: None,
                problem: "there is no `=`".into(),
                remedy: "write --set key=value, e.g. --set friction.static=1.3".into(),
                excerpt: None,
            })
            .into()),
        }
    }

    /// From a flag of its own, such as `--paths`.
    pub fn flag(flag: &str, key: &str, value: &str) -> Self {
        Override { shown: format!("{flag} {value}"), key: key.to_string(), value: value.to_string() }
    }

    /// Whether it sets this key, by itself or with the whole table it is in.
    pub fn sets(&self, key: &str) -> bool {
        key.strip_prefix(&self.key).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    }
}

/// As it was typed.
impl fmt::Display for Override {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.shown)
    }
}

/// Largest scenario file, in bytes; one that is larger is some other file.
const MAX_FILE: u64 = 1 << 20;

/// How an HDF5 file starts.
const HDF5_SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Most forcing periods at which x is observed; the drift statistics need few, and memory grows with them.
pub const MAX_PERIODS: usize = 10_000;

impl Scenario {
    /// Read a file, lay the overrides over it in order, check the result.
    pub fn read(path: &Path, overrides: &[Override]) -> Result<Self, ScenarioError> {
        let name = path.display().to_string();
        let unreadable =
            |reason: String, remedy: String| ScenarioError::Unreadable { path: name.clone(), reason, remedy };
        let not_scenario = || "give the path of a scenario, a TOML file; `mc init` writes one".to_string();
        if path.is_dir() {
            return Err(unreadable("it is a directory".into(), not_scenario()));
        }
        let mut bytes = Vec::new();
        std::fs::File::open(path).and_then(|file| file.take(MAX_FILE + 1).read_to_end(&mut bytes)).map_err(|e| {
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
            return Err(unreadable("it is an HDF5 file".into(), format!("`mc show {name}` shows the results in it")));
        }
        if bytes.len() as u64 > MAX_FILE {
            return Err(unreadable("it is larger than 1 MiB".into(), not_scenario()));
        }
        let text = String::from_utf8(bytes).map_err(|e| {
            let valid = &e.as_bytes()[..e.utf8_error().valid_up_to()];
            let line = valid.iter().filter(|byte| **byte == b'\n').count() + 1;
            unreadable(format!("line {line} is not UTF-8 text"), "save it as UTF-8, without a byte-order mark".into())
        })?;
        Self::parse(&name, &text, overrides)
    }

    /// Check a text with overrides laid over it; `name` is what messages call it, and its stem the default title.
    pub fn parse(name: &str, text: &str, overrides: &[Override]) -> Result<Self, ScenarioError> {
        let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
        let title: String = stem.chars().filter(|c| !c.is_control()).collect();
        Ok(parse::scenario(&Sources { name, text, overrides }, &title)?)
    }

    /// The whole scenario as TOML, every default visible; parsing it gives this scenario again.
    pub fn to_toml(&self) -> String {
        text::resolved(self)
    }

    /// When the paths are observed. The forcing period is that of the first harmonic with a frequency above zero, unless
    /// there would be more than [`MAX_PERIODS`] of them.
    pub fn timeline(&self) -> Timeline {
        let few = |period: &f64| self.time.end / period <= MAX_PERIODS as f64;
        let period = self.model.temperature.period().filter(few);
        Timeline { end: self.time.end, output_step: self.time.output_step, period }
    }
}
