//! Between what can be read off the data and what an engineer asks for.

use super::motion::Motion;
use crate::scenario::BridgeScene;

/// The sensor: z = offset + moving xi + still T.
///
/// With kappa = K/K_BP, `moving` is (1 - kappa) beta and `still` is kappa beta, because the bearing
/// is sheared by F/K_BP = kappa (beta T - x) while friction holds it. The criteria of a fit are
/// quadratic in these three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// z0, in the unit of displacement.
    pub offset: f64,
    /// (1 - kappa) beta, in the unit of displacement per kelvin: seen of slips.
    pub moving: f64,
    /// kappa beta, in the unit of displacement per kelvin: seen while friction holds.
    pub still: f64,
}

impl Sensor {
    /// z where the body has slipped to xi, at this temperature.
    #[inline(always)]
    pub fn reading(&self, xi: f64, temperature: f64) -> f64 {
        self.offset + self.moving * xi + self.still * temperature
    }
}

/// What the data can tell of a bearing: the motion, and how the sensor sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// A, G and xi(0).
    pub motion: Motion,
    /// z0 and the two slopes.
    pub sensor: Sensor,
}

/// The parameters of a bearing, in the units of the scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// K.
    pub stiffness: f64,
    /// beta.
    pub dilatation: f64,
    /// f_s.
    pub f_s: f64,
    /// f_d.
    pub f_d: f64,
    /// z0.
    pub offset: f64,
    /// x(0).
    pub displacement: f64,
    /// K_BP; infinite where the bearing is not sheared.
    pub shear_stiffness: f64,
}

impl Bearing {
    /// That of a scenario, under this temperature at first: a body whose place is not given is
    /// where no spring force acts.
    pub fn of(scene: &BridgeScene, temperature: f64) -> Self {
        Bearing {
            stiffness: scene.stiffness,
            dilatation: scene.dilatation,
            f_s: scene.f_s,
            f_d: scene.f_d,
            offset: scene.offset,
            displacement: scene.displacement.unwrap_or(scene.dilatation * temperature),
            shear_stiffness: scene.shear_stiffness.unwrap_or(f64::INFINITY),
        }
    }

    /// What a sensor sees of it.
    pub fn response(&self) -> Response {
        let slope = self.stiffness * self.dilatation;
        let kappa = self.stiffness / self.shear_stiffness;
        let motion = Motion {
            reach: self.f_s / slope,
            jump: 2.0 * (self.f_s - self.f_d) / slope,
            start: self.displacement / self.dilatation,
        };
        let sensor =
            Sensor { offset: self.offset, moving: (1.0 - kappa) * self.dilatation, still: kappa * self.dilatation };
        Response { motion, sensor }
    }
}
