//! The parameters of a bearing, and their combinations that a record of its displacement
//! determines.

use super::motion::Motion;
use crate::scenario::BridgeScene;

/// How the sensor sees the body: z = offset + moving xi + still T, with xi = x/beta.
///
/// With kappa = K/K_BP, `moving` is (1 - kappa) beta and `still` is kappa beta, because the bearing
/// is sheared by F/K_BP = kappa (beta T - x) while friction holds the body. The sum of squares of a
/// fit is quadratic in these three numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensor {
    /// z0, in the unit of displacement.
    pub offset: f64,
    /// (1 - kappa) beta, in the unit of displacement per kelvin: how much of a slip the sensor
    /// sees.
    pub moving: f64,
    /// kappa beta, in the unit of displacement per kelvin: how z follows T while friction holds the
    /// body.
    pub still: f64,
}

impl Sensor {
    /// The reading z at this position xi and this temperature, both in kelvin.
    #[inline(always)]
    pub fn reading(&self, xi: f64, temperature: f64) -> f64 {
        self.offset + self.moving * xi + self.still * temperature
    }
}

/// What a record can determine of a bearing: its motion, and how the sensor sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// A, G and xi(0).
    pub motion: Motion,
    /// z0 and the two slopes.
    pub sensor: Sensor,
}

/// The parameters of a bearing, in the units of the scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// K, stiffness.
    pub stiffness: f64,
    /// beta, dilatation.
    pub dilatation: f64,
    /// f_s, static friction.
    pub f_s: f64,
    /// f_d, dynamic friction.
    pub f_d: f64,
    /// z0, offset of the sensor.
    pub offset: f64,
    /// x(0), initial displacement.
    pub displacement: f64,
    /// K_BP, shear stiffness of the bearing; infinite if the bearing is not sheared.
    pub shear_stiffness: f64,
}

impl Bearing {
    /// The bearing of a scenario. `temperature` is the one at the start: if the scenario gives no
    /// x(0), the body begins where no spring force acts.
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

    /// The motion, and how the sensor sees it.
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
