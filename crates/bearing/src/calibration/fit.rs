//! The response of a bearing, computed from its slips.

use super::bearing::{Response, Sensor};
use super::course::Course;
use super::motion::Motion;
use super::samples::spread;
use super::slips::{DetectedSlips, Reversal, Slip};
use super::zero::{MiddleLine, Zero};
use crate::linear::Normal;
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

/// A response, and how the zero of the sensor and friction change around it.
#[derive(Clone, Debug, PartialEq)]
pub struct SlipFit {
    /// The response at mean friction.
    pub response: Response,
    /// How the zero moves.
    pub zero: Zero,
    /// How friction varies.
    pub course: Course,
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
    /// f_s may vary from slip to slip; the results then apply to its mean. If it varies over time, they
    /// apply to its mean over a year or over the record (`course.rs`).
    pub fn fit(&self) -> Option<SlipFit> {
        let still = self.still();
        let MiddleLine {
            offset,
            slope: moving,
            zero,
            course: kinetic,
            ..
        } = self.zero.line(&self.middles())?;
        let sizes: Vec<f64> = self.usual().map(|slip| slip.size(still)).collect();
        let mut course = Course {
            shape: self.shape,
            kinetic,
            ..Course::default()
        };
        let mut jump = mean(&sizes) / moving;
        if course.varies() {
            let columns = self.shape.columns();
            let mut normal = Normal::of(1 + columns);
            for (slip, size) in self.usual().zip(&sizes) {
                normal.add(
                    &self.shape.row(&[slip.time])[..=columns],
                    size / moving,
                    1.0,
                );
            }
            let found = normal.solve()?;
            jump = found[0];
            course.jump[..columns].copy_from_slice(&found[1..]);
        }
        let [_, a, b] = self.mean_row();
        let kinetic = self.kinetic_reach() - kinetic[0] * a - kinetic[1] * b;
        let mut motion = Motion {
            reach: kinetic + 0.5 * jump,
            jump,
            start: 0.0,
        };
        let first = self.slips.first()?;
        motion.start = match &self.beginning {
            None => first.temperature - first.sign * course.motion(&motion, first.time).reach,
            Some(level) => (level.minus_slope(still) - offset) / moving,
        };
        let response = Response {
            motion,
            sensor: Sensor {
                offset,
                moving,
                still,
            },
        };
        let is_known = motion.reach.is_finite() && jump.is_finite();
        is_known.then_some(SlipFit {
            response,
            zero,
            course,
        })
    }

    /// The noise of the sensor: white from differences of readings, and red from its growth during
    /// sticks and from the distances of the middles of jumps from their line.
    pub fn noise(&self, fit: &SlipFit) -> SensorNoise {
        let SlipFit {
            response: Response { motion, sensor },
            zero,
            course,
        } = fit;
        let off = |slip: &Slip| {
            let kinetic = course.motion(motion, slip.time).kinetic_reach();
            let line = sensor.offset
                + zero.at(slip.time)
                + sensor.moving * (slip.temperature - slip.sign * kinetic);
            slip.middle(sensor.still) - line
        };
        let all = spread(&self.usual().map(off).collect::<Vec<_>>());
        // Part of these distances is due to errors of the temperatures of slips, two for each
        // reversal.
        let expected = |time: &f64| course.motion(motion, *time).kinetic_reach();
        let of_course = |reversal: &Reversal| reversal.times.iter().map(expected).sum::<f64>();
        let changes: Vec<f64> = self
            .reversals
            .iter()
            .map(|reversal| reversal.change - of_course(reversal))
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
        let mut sizes = self.relative_sizes();
        // Two slips between two samples look like one of twice the size; they are left out.
        sizes.retain(|size| *size < 1.5);
        let noise = self.contrast.recip();
        (spread(&sizes).powi(2) - noise * noise).max(0.0).sqrt()
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
