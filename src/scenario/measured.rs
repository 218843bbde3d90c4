//! What of a scenario was measured, and what measures it: the file of a temperature, the bearing
//! with its sensor.

/// Where a measured temperature comes from: what a scenario says of it. The samples themselves are
/// in the model.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The file, as the scenario names it: relative to the folder of the scenario.
    pub file: String,
    /// The column of times.
    pub time: String,
    /// The column of temperatures.
    pub value: String,
    /// The zone of stamps that name none; empty for none.
    pub zone: String,
    /// The longest time between two samples; none for any.
    pub max_gap: Option<f64>,
    /// The stamp of t = 0, if the file has stamps.
    pub start: Option<String>,
    /// What was mended in the file, in words; nothing where the samples come from results.
    pub repairs: Vec<String>,
}

/// What was mended is not compared: it is told once, when the file is read.
impl PartialEq for Measured {
    fn eq(&self, other: &Self) -> bool {
        let said = |m: &Self| (m.file.clone(), m.time.clone(), m.value.clone(), m.zone.clone(), m.start.clone());
        said(self) == said(other) && self.max_gap == other.max_gap
    }
}

/// How a bearing shows the body to a sensor: z = z0 + x + F/K_B. It does not act on the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// K_B > 0, of the shear of the bearing under the friction force; none for a rigid one.
    pub stiffness: Option<f64>,
    /// z0.
    pub offset: f64,
}

impl Bearing {
    /// z from x and the friction force F.
    pub fn displacement(&self, x: f64, friction: f64) -> f64 {
        self.offset + x + self.stiffness.map_or(0.0, |stiffness| friction / stiffness)
    }
}
