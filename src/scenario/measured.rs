//! The measured parts of a scenario: its temperature and its inputs, and the sensor at the bearing.

use super::Scenario;
use crate::model::{NamedSeries, Series};
use std::sync::Arc;
use stickslip_data::Layout;

/// The table of a measured temperature.
pub const TEMPERATURE_SERIES: &str = "temperature.series";

/// The prefix of the table of an input, before its name.
pub const INPUT: &str = "input.";

/// Measured values, and their source as stated in the scenario.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The table that describes them, such as `temperature.series` or `input.ag`.
    pub table: String,
    /// The samples, which are also in the model.
    pub series: Arc<Series>,
    /// The file as the scenario names it, relative to the folder of the scenario.
    pub file: String,
    /// The name of the column of values; empty if the file has no columns.
    pub value: String,
    /// The unit in the file, if given: for temperatures by the scenario, for inputs by the scenario
    /// or the file.
    pub unit: Option<String>,
    /// The first time in a column of numbers, which is t = 0.
    pub begin: f64,
    /// The layout of the file, with the name of the time column.
    pub layout: Layout,
    /// The longest time allowed between two samples; `None` for no limit.
    pub max_gap: Option<f64>,
    /// The stamp of t = 0, if the file has stamps.
    pub start: Option<String>,
    /// What was repaired in the file, in sentences; empty if the samples come from the file of a
    /// run.
    pub repairs: Vec<String>,
}

/// The repairs are not compared, because they are known only when the data file itself is read.
impl PartialEq for Measured {
    fn eq(&self, other: &Self) -> bool {
        let said = |m: &Self| {
            (
                m.file.clone(),
                m.value.clone(),
                m.unit.clone(),
                m.layout.clone(),
                m.start.clone(),
            )
        };
        let are_same = self.table == other.table && self.series == other.series;
        are_same && said(self) == said(other) && self.max_gap == other.max_gap
    }
}

impl Measured {
    /// The name of an input, if it is one.
    pub fn input(&self) -> Option<&str> {
        self.table.strip_prefix(INPUT)
    }
}

impl Scenario {
    /// All measured values, each by the table that describes it.
    pub fn samples(&self) -> Vec<NamedSeries> {
        let samples = |measured: &Measured| (measured.table.clone(), measured.series.clone());
        self.measured
            .iter()
            .map(samples)
            .map(|(name, series)| NamedSeries { name, series })
            .collect()
    }
}

/// The sensor at the bearing: z = z0 + x + F/K_BP. The bearing does not act on the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorBearing {
    /// K_BP > 0, the shear stiffness of the bearing under the friction force F; `None` for a rigid
    /// bearing.
    pub stiffness: Option<f64>,
    /// z0, the reading at x = 0 and F = 0.
    pub offset: f64,
}

impl SensorBearing {
    /// The reading z at displacement x and friction force F.
    pub fn displacement(&self, x: f64, friction: f64) -> f64 {
        self.offset + x + self.stiffness.map_or(0.0, |stiffness| friction / stiffness)
    }
}
