//! The scenarios that are built into the program, including their comments.

use std::path::Path;

/// A shipped scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shipped {
    /// Its name, which is the stem of its file.
    pub name: &'static str,
    /// The text of its file.
    pub text: &'static str,
    /// The data files that it names: each name with the text of the file.
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

/// Every shipped scenario. The same files are in `scenarios/`.
pub const SHIPPED: [Shipped; 15] = shipped![
    "shaw",
    "shaw-as-printed",
    "rho025",
    "rho025-as-printed",
    "equal-friction",
    "damped",
    "never-slips",
    "belt",
    "stribeck-belt",
    "incline",
    "building",
    "duffing",
    "self-excited",
    "viaduct",
    "bridge" with "bridge.csv",
];

impl Shipped {
    /// The text of the data file of this name, if its scenario reads one.
    pub fn file(&self, name: &str) -> Option<&'static str> {
        self.data
            .iter()
            .find(|(file, _)| *file == name)
            .map(|(_, text)| *text)
    }
}

/// The shipped scenario of this name.
pub fn shipped(name: &str) -> Option<&'static Shipped> {
    SHIPPED.iter().find(|scenario| scenario.name == name)
}

/// The shipped scenario that a path denotes: one without a folder or an extension that is not an
/// existing file. A directory of the same name is not meant.
pub fn shipped_at(path: &Path) -> Option<&'static Shipped> {
    let is_name = path.components().count() == 1 && path.extension().is_none() && !path.is_file();
    path.to_str().filter(|_| is_name).and_then(shipped)
}

/// The name of the shipped scenario most similar to this word; none if none is similar.
pub(super) fn nearest(word: &str) -> Option<&'static str> {
    let alike = SHIPPED
        .iter()
        .map(|scenario| (strsim::jaro_winkler(word, scenario.name), scenario.name));
    alike
        .filter(|(likeness, _)| *likeness > 0.85)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}
