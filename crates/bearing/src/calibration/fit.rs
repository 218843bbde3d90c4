//! The response of a bearing, computed from its slips.

use super::bearing::{Response, Sensor};
use super::motion::Motion;
use super::samples::{median, spread};
use super::slips::{DetectedSlips, Slip};
use super::zero::{MiddleLine, Zero};
use crate::moments::mean;

/// The errors of a displacement sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorNoise {
    /// Standard deviation of the white noise.
    pub white: f64,
    /// Standard deviation of the red noise, an Ornstein-Uhlenbeck process.
    pub red: f64,
    /// Correlation time of the red noise, in seconds.
    pub memory: f64,
}

impl DetectedSlips {
    /// A, G, xi(0), z0, the two slopes and the movement of the zero. `None` if too few slips were
    /// seen.
    ///
    /// Each number is computed from a different part of the data, and none of them depends on how
    /// many slips were missed in between.
    ///
    /// - The slope of z against T during sticks is `still`.
    /// - Between a slip and the next slip in the other direction, T changes by 2 A - G = 2 f_d/(K
    ///   beta).
    /// - The middle of a jump, minus still T, is z0 + moving (T -+ (A - G/2)), a line whose slope
    ///   is `moving`, plus the movement of the zero of the sensor (`zero.rs`).
    /// - The height of a jump is moving G.
    /// - The temperature of the first slip differs from xi(0) by A. If that slip fell into a gap,
    ///   xi(0) follows from the level before it.
    ///
    /// f_s may vary from slip to slip; the results then apply to its mean.
    pub fn fit(&self) -> Option<(Response, Zero)> {
        let still = self.still();
        let MiddleLine {
            offset,
            slope: moving,
            zero,
            ..
        } = self.zero.line(&self.middles())?;
        let sizes: Vec<f64> = self.usual().map(|slip| slip.size(still)).collect();
        let jump = mean(&sizes) / moving;
        let reach = self.kinetic_reach() + 0.5 * jump;
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

    /// The noise of the sensor: white from differences of readings, and red from its growth during
    /// sticks and from the distances of the middles of jumps from their line.
    pub fn noise(&self, response: &Response, zero: &Zero) -> SensorNoise {
        let Response { motion, sensor } = response;
        let kinetic = motion.kinetic_reach();
        let off = |slip: &Slip| {
            let line = sensor.offset
                + zero.at(slip.time)
                + sensor.moving * (slip.temperature - slip.sign * kinetic);
            slip.middle(sensor.still) - line
        };
        let all = spread(&self.usual().map(off).collect::<Vec<_>>());
        // Part of these distances is due to errors of the temperatures of slips, two for each
        // reversal.
        let changes: Vec<f64> = self
            .reversals
            .iter()
            .map(|reversal| reversal.change)
            .collect();
        let of_temperature = sensor.moving * spread(&changes) / std::f64::consts::SQRT_2;
        let variance = (all * all - of_temperature * of_temperature).max(0.0);
        let growth = self.walks[1] * self.white * self.white;
        SensorNoise {
            white: self.white,
            red: variance.sqrt(),
            memory: 2.0 * variance / growth,
        }
    }

    /// The standard deviation of the sizes of slips beyond the noise of the sensor, divided by
    /// their mean.
    pub fn excess_scatter(&self) -> f64 {
        let mut sizes = self.sizes();
        let middle = median(&mut sizes.clone());
        // Two slips between two samples look like one of twice the size; they are left out.
        sizes.retain(|size| *size < 1.5 * middle);
        let noise = self.contrast.recip();
        ((spread(&sizes) / middle).powi(2) - noise * noise)
            .max(0.0)
            .sqrt()
    }

    /// The share of the motion explained by visible slips while the body continues in one
    /// direction. It is 1 if all slips are seen, because the next one comes after T has changed by
    /// G. If the body slides without jumps, only part of its motion appears as slips.
    pub fn explained(&self, response: &Response) -> f64 {
        let pairs = self.slips.windows(2);
        let onwards = pairs.filter(|pair| pair[0].sign == pair[1].sign);
        let [seen, gone] = onwards.fold([0.0; 2], |[seen, gone], pair| {
            let change = (pair[1].temperature - pair[0].temperature) * pair[1].sign;
            let size = pair[0].size(response.sensor.still) / response.sensor.moving;
            [seen + size, gone + change]
        });
        if gone > 0.0 { seen / gone } else { f64::NAN }
    }
}
