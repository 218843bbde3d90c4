//! Physical bounds of the parameters of a bearing.

use super::bearing::Response;
use super::quantity::{Quantity, values};

/// The condition that every bearing satisfies.
pub(super) const CONDITION: &str = "A > 0.05 K, 0 < G <= 2 A and 0 < K/K_BP < 1";

/// The smallest A of a bearing, in kelvin. Bearings stick over several kelvins, and thermometers
/// resolve tenths.
const LEAST: f64 = 0.05;

/// A rigid bearing has K/K_BP = 0, and noise can make the estimate slightly negative. Without K_BP
/// no force is computed from it, so a value down to this is allowed.
const UNSHEARED: f64 = -0.02;

impl Response {
    /// The first quantity with an unphysical value, and this value. `None` for a possible bearing.
    pub fn impossible(&self, shear_stiffness: Option<f64>) -> Option<(Quantity, f64)> {
        let all = values(self, shear_stiffness);
        let of = |quantity: Quantity| all[quantity as usize];
        let (reach, jump, shear) = (of(Quantity::Reach), of(Quantity::Jump), of(Quantity::Shear));
        let least = if shear_stiffness.is_some() {
            0.0
        } else {
            UNSHEARED
        };
        [
            (Quantity::Reach, reach > LEAST && reach.is_finite()),
            (Quantity::Jump, jump > 0.0 && jump.is_finite()),
            (Quantity::DynamicWay, jump <= 2.0 * reach),
            (Quantity::Dilatation, of(Quantity::Dilatation) > 0.0),
            (Quantity::Shear, shear > least && shear < 1.0),
        ]
        .into_iter()
        .find_map(|(quantity, is_possible)| (!is_possible).then(|| (quantity, of(quantity))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::{Motion, Sensor};

    const MOTION: Motion = Motion {
        reach: 4.0,
        jump: 1.0,
        start: 15.0,
    };
    const SENSOR: Sensor = Sensor {
        offset: 0.0,
        moving: 9e-4,
        still: 1e-4,
    };

    fn first_impossible(
        [reach, jump]: [f64; 2],
        [moving, still]: [f64; 2],
        shear_stiffness: Option<f64>,
    ) -> Option<Quantity> {
        let response = Response {
            motion: Motion {
                reach,
                jump,
                ..MOTION
            },
            sensor: Sensor {
                moving,
                still,
                ..SENSOR
            },
        };
        let found = response.impossible(shear_stiffness);
        found.map(|(quantity, _)| quantity)
    }

    /// A possible bearing, and the same with one number out of its range after the other.
    #[test]
    fn every_condition_is_one_of_its_own() {
        let slopes = [SENSOR.moving, SENSOR.still];
        let cases = [
            ([4.0, 1.0], slopes, None),
            ([-4.0, 1.0], slopes, Some(Quantity::Reach)),
            ([0.04, 0.01], slopes, Some(Quantity::Reach)),
            ([f64::NAN, 1.0], slopes, Some(Quantity::Reach)),
            ([4.0, -1.0], slopes, Some(Quantity::Jump)),
            ([4.0, 0.0], slopes, Some(Quantity::Jump)),
            ([4.0, f64::INFINITY], slopes, Some(Quantity::Jump)),
            ([4.0, 8.1], slopes, Some(Quantity::DynamicWay)),
            ([4.0, 1.0], [-9e-4, 1e-4], Some(Quantity::Dilatation)),
            ([4.0, 1.0], [-0.5e-4, 1e-4], Some(Quantity::Shear)),
            ([4.0, 1.0], [9e-4, -1e-5], Some(Quantity::Shear)),
        ];
        for (motion, slopes, expected) in cases {
            let found = first_impossible(motion, slopes, Some(2e9));
            assert_eq!(found, expected, "{motion:?} {slopes:?}");
        }
        // A little below zero is noise where no force is asked for.
        assert_eq!(first_impossible([4.0, 1.0], [9e-4, -1e-5], None), None);
    }
}
