//! The scenarios that come with the program, comments and all.

use super::{Scenario, ScenarioError};

/// A shipped scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shipped {
    /// Its name: the stem of its file.
    pub name: &'static str,
    /// The file.
    pub text: &'static str,
}

macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        [$(Shipped { name: $name, text: include_str!(concat!("../../scenarios/", $name, ".toml")) }),*]
    };
}

/// Every shipped scenario; `scenarios/` holds the same files.
pub const SHIPPED: [Shipped; 8] = shipped![
    "shaw",
    "shaw-as-printed",
    "rho025",
    "rho025-as-printed",
    "equal-friction",
    "damped",
    "never-slips",
    "viaduct",
];

/// The shipped scenario of this name.
pub fn shipped(name: &str) -> Option<&'static Shipped> {
    SHIPPED.iter().find(|scenario| scenario.name == name)
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
