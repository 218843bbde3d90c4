//! The response of a bearing, computed from its slips.

use super::bearing::{Response, Sensor};
use super::motion::Motion;
use super::samples::{median, spread};
use super::slips::{Evidence, Slip};
use super::zero::{MiddleLine, Zero};

impl Evidence {
    /// A, G, xi(0), z0, the two slopes and the movement of the zero, with these weights of the
    /// blocks of time. `None` if too few slips were seen.
    ///
    /// Each number is computed from a different part of the data, and none of them depends on how
    /// many slips were missed in between.
    ///
    /// - The slope of z against T during sticks is `still`.
    /// - Between a slip and the next slip in the other direction, T changes by 2 A - G = 2 f_d/(K
    ///   beta).
    /// - The middle of a jump, minus still T, is z0 + moving (T -+ (A - G/2)), a line whose slope
    ///   is `moving`, plus what the zero of the sensor has moved (`zero.rs`).
    /// - The height of a jump is moving G.
    /// - The temperature of the first slip differs from xi(0) by A. If that slip fell into a gap,
    ///   xi(0) follows from the level before it.
    ///
    /// f_s may vary from slip to slip; the results are then right for its mean.
    pub fn fit(&self, weights: &[f64]) -> Option<(Response, Zero)> {
        let still = self.still(weights);
        let kinetic = self.kinetic_reach(weights);
        let MiddleLine {
            offset,
            slope: moving,
            zero,
            ..
        } = self.zero.line(&self.middles(weights))?;
        let usual = self.slips.iter().filter(|slip| slip.is_usual);
        let jump = self.mean(
            weights,
            usual.map(|slip| (slip.size(still), self.block(slip.time))),
        ) / moving;
        let reach = kinetic + 0.5 * jump;
        let first = self.slips.first()?;
        let start = match &self.beginning {
            None => first.temperature - first.sign * reach,
            Some(level) => (level.minus_slope(still) - offset) / moving,
        };
        let fit = Response {
            motion: Motion { reach, jump, start },
            sensor: Sensor {
                offset,
                moving,
                still,
            },
        };
        (reach.is_finite() && jump.is_finite()).then_some((fit, zero))
    }
}

impl Evidence {
    /// The standard error of xi(0) when everything else is known, in kelvin. If xi(0) comes from
    /// the temperature of one slip, this follows from the scatter of the reversals, each of which
    /// contains two such temperatures. If it comes from a level, it follows from the distances of
    /// the middles of jumps from their line.
    pub fn scatter(&self) -> f64 {
        if self.beginning.is_some() {
            let Some((Response { motion, sensor }, zero)) = self.fit(&self.unweighted()) else {
                return 0.0;
            };
            let kinetic = motion.kinetic_reach();
            let off = |slip: &Slip| {
                let line = sensor.offset
                    + zero.at(slip.time)
                    + sensor.moving * (slip.temperature - slip.sign * kinetic);
                (slip.middle(sensor.still) - line) / sensor.moving
            };
            return spread(
                &self
                    .slips
                    .iter()
                    .filter(|slip| slip.is_usual)
                    .map(off)
                    .collect::<Vec<_>>(),
            );
        }
        let changes: Vec<f64> = self
            .reversals
            .iter()
            .map(|reversal| reversal.change)
            .collect();
        if changes.len() < 2 {
            0.0
        } else {
            spread(&changes) / std::f64::consts::SQRT_2
        }
    }
}

impl Evidence {
    /// The standard deviation of the sizes of slips beyond the noise of the sensor, divided by
    /// their mean.
    pub fn excess_scatter(&self) -> f64 {
        let still = self.still(&self.unweighted());
        let sizes: Vec<f64> = self.slips.iter().map(|slip| slip.size(still)).collect();
        let middle = median(&mut sizes.clone());
        // Two slips between two samples look like one of twice the size, and are left out.
        let single: Vec<f64> = sizes
            .into_iter()
            .filter(|size| *size < 1.5 * middle)
            .collect();
        let noise = self.contrast.recip();
        ((spread(&single) / middle).powi(2) - noise * noise)
            .max(0.0)
            .sqrt()
    }

    /// The share of the motion that the visible slips explain while the body moves on in one
    /// direction. It is 1 if all slips are seen, because the next one comes after T has changed by
    /// G. If the body slides without jumps, only part of its motion appears as slips.
    pub fn explained(&self, response: &Response) -> f64 {
        let onwards = self
            .slips
            .windows(2)
            .filter(|pair| pair[0].sign == pair[1].sign);
        let [seen, gone] = onwards.fold([0.0; 2], |[seen, gone], pair| {
            let change = (pair[1].temperature - pair[0].temperature) * pair[1].sign;
            [
                seen + pair[0].size(response.sensor.still) / response.sensor.moving,
                gone + change,
            ]
        });
        if gone > 0.0 { seen / gone } else { f64::NAN }
    }
}
