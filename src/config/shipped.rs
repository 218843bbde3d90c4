//! The scenarios that come with the program, comments and all.

use super::{Scenario, ScenarioError};

/// A shipped scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shipped {
    /// Its name: the stem of its file.
    pub name: &'static str,
    /// The file.
    pub text: &'static str,
    /// The files that it names, with what is in them.
    pub data: &'static [(&'static str, &'static str)],
}

macro_rules! shipped {
    ($($name:literal $(with $file:literal)*),* $(,)?) => {
        [$(Shipped {
            name: $name,
            text: include_str!(concat!("../../scenarios/", $name, ".toml")),
            data: &[$(($file, include_str!(concat!("../../scenarios/", $file)))),*],
        }),*]
    };
}

/// Every shipped scenario; `scenarios/` holds the same files.
pub const SHIPPED: [Shipped; 9] = shipped![
    "shaw",
    "shaw-as-printed",
    "rho025",
    "rho025-as-printed",
    "equal-friction",
    "damped",
    "never-slips",
    "viaduct",
    "bridge" with "bridge.csv",
];

/// The shipped scenario of this name.
pub fn shipped(name: &str) -> Option<&'static Shipped> {
    SHIPPED.iter().find(|scenario| scenario.name == name)
}

/// What is in a file that a shipped scenario names; a scenario that is read from a file has another
/// name, with an ending.
pub(super) fn shipped_data(scenario: &str, file: &str) -> Option<&'static str> {
    shipped(scenario)?.data.iter().find(|(name, _)| *name == file).map(|(_, text)| *text)
}

impl Scenario {
    /// The shipped scenario of this name, checked; an error names those that there are.
    pub fn shipped(name: &str) -> Result<Self, ScenarioError> {
        match shipped(name) {
            Some(found) => Scenario::parse(found.name, found.text, &[]),
            None => Err(ScenarioError::Unreadable {
                path: name.to_string(),
                reason: "no shipped scenario has this name".into(),
                remedy: format!("choose one of {}", SHIPPED.map(|scenario| scenario.name).join(", ")),
            }),
        }
    }
}
