//! A scenario: one physical question, read from TOML and checked. The only home of TOML.

use crate::model::Model;
use crate::scheme::Timeline;
use crate::stats::Record;

/// A checked scenario: every number in it is finite and in range.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// What the scenario asks, in a line.
    pub title: String,
    /// The physics.
    pub model: Model,
    /// Duration, step, output grid.
    pub time: Time,
    /// Which scheme simulates it.
    pub scheme: SchemeKind,
    /// How many paths, from which seed.
    pub ensemble: Ensemble,
    /// What is kept of single paths.
    pub record: Record,
    /// Labels, used in tables and attributes only.
    pub units: Units,
}

/// Duration, step and output grid of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Time {
    /// t_end >= 0.
    pub end: f64,
    /// h > 0; `end` and `output_step` are whole multiples of it (time-stepping schemes).
    pub step: f64,
    /// Spacing of the output grid.
    pub output_step: f64,
}

/// The schemes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SchemeKind {
    /// The paper's discrete variational inequality.
    DiscreteVi,
}

/// How many paths, from which seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ensemble {
    /// Number of paths.
    pub paths: u64,
    /// Seed; with the path number it determines a path.
    pub seed: u64,
}

/// Unit labels; empty where the scenario is dimensionless.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Units {
    /// Label of time, e.g. "s".
    pub time: String,
    /// Label of length, e.g. "m".
    pub length: String,
    /// Label of force, e.g. "N".
    pub force: String,
    /// Label of temperature, e.g. "K".
    pub temperature: String,
}

impl Scenario {
    /// When the paths are observed. The forcing period is that of the first harmonic with a frequency above zero.
    pub fn timeline(&self) -> Timeline {
        Timeline { end: self.time.end, output_step: self.time.output_step, period: self.model.temperature.period() }
    }
}
