//! The measured parts of a scenario: where its temperature comes from, and how a sensor at the
//! bearing sees the body.

use crate::data::Layout;

/// Where a measured temperature comes from, as the scenario states it. The samples themselves are
/// in the model.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The file as the scenario names it, relative to the folder of the scenario.
    pub file: String,
    /// The name of the column of temperatures.
    pub value: String,
    /// The unit of the temperatures, if the scenario gives it.
    pub unit: Option<String>,
    /// How the file is laid out, with the name of the column of times.
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
        let said = |m: &Self| (m.file.clone(), m.value.clone(), m.unit.clone(), m.layout.clone(), m.start.clone());
        said(self) == said(other) && self.max_gap == other.max_gap
    }
}

/// How a sensor at the bearing sees the body: z = z0 + x + F/K_B. The bearing does not act on the
/// body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorBearing {
    /// K_B > 0, the stiffness with which the bearing is sheared by the friction force F; `None` for
    /// a rigid bearing.
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
