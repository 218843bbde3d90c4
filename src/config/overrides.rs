//! A new value for one key of a scenario, as given on a command line.

use super::error::{Diagnostic, ScenarioError};
use std::fmt;

/// The tables that do not describe the body and the forces on it.
const NOT_PHYSICS: [&str; 9] = [
    "title",
    "displacement",
    "bearing",
    "time",
    "scheme",
    "statistics",
    "ensemble",
    "record",
    "units",
];

/// The longest value that a title shows, in bytes.
const LONGEST_SHOWN: usize = 40;

/// A key of a scenario, the value to set, and how the user wrote both.
///
/// ```
/// use stickslip::config::{Override, shipped};
/// use stickslip::scenario::Scenario;
///
/// let text = shipped("rho025").expect("a shipped scenario").text;
/// let stronger = Scenario::parse("mine.toml", text, &[Override::set("friction.static=1.3")?])?;
/// assert_eq!(stronger.model.friction.static_force, 1.3);
/// let error = Scenario::parse("mine.toml", text, &[Override::set("friction.static=0.9")?]).unwrap_err();
/// assert!(error.to_string().contains("fix:"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    pub(super) shown: String,
    pub(super) key: String,
    pub(super) value: String,
}

impl Override {
    /// The override `key=value`. The key is dotted (`friction.static`,
    /// `temperature.harmonics.0.amplitude`). The value is TOML, and a bare word is taken as a
    /// string.
    pub fn set(text: &str) -> Result<Self, ScenarioError> {
        Self::typed(text, text)
    }

    /// The same for a text that messages show as the user typed it, e.g. with its option.
    pub fn typed(shown: &str, text: &str) -> Result<Self, ScenarioError> {
        let shown = shown.to_string();
        match text.split_once('=') {
            Some((key, value)) => Ok(Override {
                shown,
                key: key.trim().to_string(),
                value: value.trim().to_string(),
            }),
            None => {
                let remedy = "write key=value, e.g. friction.static=1.3";
                let diagnostic = Diagnostic {
                    origin: shown,
                    problem: "there is no `=`".into(),
                    remedy: remedy.into(),
                    ..Diagnostic::default()
                };
                Err(ScenarioError::Invalid(vec![diagnostic]))
            }
        }
    }

    /// The override of an option for a single key.
    pub fn flag(flag: &str, key: &str, value: &str) -> Self {
        Override {
            shown: format!("{flag} {value}"),
            key: key.to_string(),
            value: value.to_string(),
        }
    }

    /// An override with a computed number, for example from a sweep. A whole number is written
    /// without a decimal point, because counts and seeds must be whole.
    pub fn number(shown: &str, key: &str, value: f64) -> Self {
        let is_whole = value.fract() == 0.0 && value.abs() < 1e15;
        Override::flag(
            shown,
            key,
            &if is_whole {
                format!("{value:.0}")
            } else {
                format!("{value:?}")
            },
        )
    }

    /// The override of a flag whose value is a text, such as a title. The text is never interpreted
    /// as TOML.
    pub fn text(flag: &str, key: &str, value: &str) -> Self {
        let quoted = toml::Value::from(value).to_string();
        Override {
            shown: format!("{flag} {quoted}"),
            key: key.to_string(),
            value: quoted,
        }
    }

    /// `key = value` if the key belongs to the body or the forces on it; only the key if the value
    /// is long. How a file is read is no change, unlike which file.
    pub(super) fn change_of_physics(&self) -> Option<String> {
        let parts: Vec<&str> = self.key.split('.').collect();
        let is_layout = match parts[..] {
            ["temperature" | "displacement", "series", key] | ["input", _, key] => key != "file",
            _ => false,
        };
        let is_physics = !is_layout && !NOT_PHYSICS.contains(&parts[0]);
        is_physics.then(|| match self.value.len() <= LONGEST_SHOWN {
            true => format!("{} = {}", self.key, self.value),
            false => self.key.clone(),
        })
    }

    /// Whether it sets this key, alone or together with the whole table that holds it.
    pub fn sets(&self, key: &str) -> bool {
        key.strip_prefix(&self.key)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    }
}

/// Prints the override as it was typed.
impl fmt::Display for Override {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.shown)
    }
}
