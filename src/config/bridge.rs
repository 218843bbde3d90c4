//! Reads only the part of a scenario that a study of measurements needs. Nothing is simulated, so
//! `[time]` and the tables of the forcing may be missing.

use super::error::ScenarioError;
use super::fields::Fields;
use super::keys;
use super::overrides::Override;
use super::parse::titled;
use super::series::source;
use super::source::{MeasuredFrom, Sources};
use super::{shipped_at, text_of, tree};
use crate::scenario::BridgeScene;
use std::path::Path;
use stickslip_data::ColumnSource;

impl BridgeScene {
    /// Read a file with the overrides applied. The name of a shipped scenario is accepted instead
    /// of a file.
    pub fn read(path: &Path, overrides: &[Override]) -> Result<Self, ScenarioError> {
        if let Some(found) = shipped_at(path) {
            return Self::parse(found.name, found.text, overrides);
        }
        let (name, text) = text_of(path)?;
        Self::parse(&name, &text, overrides)
    }

    /// Read a text with the overrides applied; messages call the text `name`.
    pub fn parse(name: &str, text: &str, overrides: &[Override]) -> Result<Self, ScenarioError> {
        scene(&Sources::new(name, text, overrides, MeasuredFrom::Files))
    }
}

/// The source of temperatures according to overrides of `temperature.series` alone.
pub fn temperature_source(overrides: &[Override]) -> Result<ColumnSource, ScenarioError> {
    let sources = Sources::new("", "", overrides, MeasuredFrom::Files);
    let tree = tree::read(&sources)?;
    sources.outcome(source(
        &Fields::root(&sources, &tree)
            .table("temperature")
            .table("series"),
        keys::VALUE,
        None,
    ))
}

fn scene(sources: &Sources<'_>) -> Result<BridgeScene, ScenarioError> {
    let tree = tree::read(sources)?;
    let root = Fields::root(sources, &tree);
    let (oscillator, friction) = (root.table("oscillator"), root.table("friction"));
    let bearing = root.table("bearing");
    let temperature_source = source(
        &root.table("temperature").table("series"),
        keys::VALUE,
        None,
    );
    let displacement_source = source(
        &root.table("displacement").table("series"),
        keys::VALUE,
        Some(&temperature_source),
    );
    let located = |table: &str, source: ColumnSource| {
        let place = root.place_of(&format!("{table}.file"));
        let path = |file: String| sources.path_of(&file, place).display().to_string();
        ColumnSource {
            file: source.file.map(path),
            ..source
        }
    };
    let stem = Path::new(sources.name)
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let initial = root
        .table("initial")
        .number_or_word(keys::DISPLACEMENT, &["balanced", "free"]);
    sources.outcome(BridgeScene {
        title: titled(root.line_or(keys::TITLE, &stem), sources.overrides),
        stiffness: oscillator.number(keys::STIFFNESS),
        dilatation: oscillator.number(keys::DILATATION),
        f_s: friction.number(keys::STATIC),
        f_d: friction.number(keys::DYNAMIC),
        shear_stiffness: bearing.number_if_present(keys::BEARING_STIFFNESS),
        offset: bearing.number_or(keys::OFFSET, 0.0),
        displacement: initial.and_then(Result::ok),
        temperature_source: located("temperature.series", temperature_source),
        displacement_source: located("displacement.series", displacement_source),
        text: sources.text.to_string(),
    })
}
