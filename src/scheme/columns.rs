//! The buffers of a snapshot, for the schemes that follow their paths one by one.

use super::Snapshot;

/// The state of every path at one time, one entry a lane.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    temperature: Vec<f64>,
    is_static: Vec<bool>,
}

impl Columns {
    /// Buffers for `lanes` lanes.
    pub(super) fn new(lanes: usize) -> Self {
        let zeros = vec![0.0; lanes];
        Columns {
            displacement: zeros.clone(),
            velocity: zeros.clone(),
            temperature: zeros,
            is_static: vec![true; lanes],
        }
    }

    /// Sets x, x', T and whether the path is static, for one lane.
    pub(super) fn set(&mut self, lane: usize, (x, v, temperature, is_static): (f64, f64, f64, bool)) {
        self.displacement[lane] = x;
        self.velocity[lane] = v;
        self.temperature[lane] = temperature;
        self.is_static[lane] = is_static;
    }

    /// Sets the same values for every lane.
    pub(super) fn fill(&mut self, (x, v, temperature, is_static): (f64, f64, f64, bool)) {
        self.displacement.fill(x);
        self.velocity.fill(v);
        self.temperature.fill(temperature);
        self.is_static.fill(is_static);
    }

    /// The buffers as the snapshot that an observer receives.
    pub(super) fn snapshot(&self, time: f64) -> Snapshot<'_> {
        Snapshot {
            time,
            displacement: &self.displacement,
            velocity: &self.velocity,
            temperature: &self.temperature,
            is_static: &self.is_static,
        }
    }
}
