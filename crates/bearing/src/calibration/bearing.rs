//! The properties of a bearing that a record of its displacement can determine.

use super::motion::Motion;
use stickslip::scenario::BridgeScene;

/// The reading of the sensor: z = offset + moving xi + still T, with xi = x/beta.
///
/// With kappa = K/K_BP, `moving` is (1 - kappa) beta and `still` is kappa beta, because the bearing
/// is sheared by F/K_BP = kappa (beta T - x) while friction holds the body. The sum of squares of a
/// fit is quadratic in these three numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensor {
    /// z0, in the unit of displacement.
    pub offset: f64,
    /// (1 - kappa) beta, in the unit of displacement per kelvin: the change of z with xi in a slip.
    pub moving: f64,
    /// kappa beta, in the unit of displacement per kelvin: the change of z with T while the body
    /// sticks.
    pub still: f64,
}

impl Sensor {
    /// The sensor at a bearing with this beta and kappa.
    pub fn sheared(offset: f64, dilatation: f64, kappa: f64) -> Self {
        Sensor {
            offset,
            moving: (1.0 - kappa) * dilatation,
            still: kappa * dilatation,
        }
    }

    /// The reading z at this position xi and this temperature, both in kelvin.
    #[inline(always)]
    pub fn reading(&self, xi: f64, temperature: f64) -> f64 {
        self.offset + self.moving * xi + self.still * temperature
    }

    /// beta, in the unit of displacement per kelvin.
    pub fn dilatation(&self) -> f64 {
        self.moving + self.still
    }
}

/// The response of a bearing, as far as a record determines it: its motion, and the reading of the
/// sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// A, G and xi(0).
    pub motion: Motion,
    /// z0 and the two slopes.
    pub sensor: Sensor,
}

impl Response {
    /// The response of the bearing of a scenario. `temperature` is the one at the start: if the
    /// scenario gives no x(0), the body starts at zero spring force. Without K_BP the bearing is
    /// not sheared.
    pub fn of(scene: &BridgeScene, temperature: f64) -> Self {
        let BridgeScene {
            stiffness,
            dilatation,
            f_s,
            f_d,
            offset,
            ..
        } = *scene;
        let slope = stiffness * dilatation;
        let kappa = scene.shear_stiffness.map_or(0.0, |shear| stiffness / shear);
        let start = scene.displacement.unwrap_or(dilatation * temperature) / dilatation;
        Response {
            motion: Motion {
                reach: f_s / slope,
                jump: 2.0 * (f_s - f_d) / slope,
                start,
            },
            sensor: Sensor::sheared(offset, dilatation, kappa),
        }
    }
}
