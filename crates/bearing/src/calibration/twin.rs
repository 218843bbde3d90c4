//! Synthetic records: the model, measured with an imperfect sensor and thermometer.

use super::air::Air;
use super::bearing::Response;
use super::course::Course;
use super::trajectory::{STEP, Trajectory, trajectory};
use super::zero::Zero;
use std::ops::Range;
use stickslip::noise::{Stream, Transition};

/// The imperfections of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imperfections {
    /// Standard deviation of the white noise of the sensor, in the unit of displacement.
    pub white: f64,
    /// Stationary standard deviation of the red noise of the sensor, an Ornstein-Uhlenbeck process.
    pub red: f64,
    /// Correlation time of the red noise, in seconds.
    pub memory: f64,
    /// Relative standard deviation of f_s from slip to slip; f_d does not vary.
    pub scatter: f64,
    /// Lag of the steel behind the thermometer, in seconds.
    pub lag: f64,
    /// Resolution of the thermometer, in kelvin; 0 for a perfect one.
    pub resolution: f64,
    /// Fraction of displacements that are outliers, by up to 20 standard deviations of red and
    /// white noise together.
    pub spikes: f64,
    /// Number of gaps, of one to five days each.
    pub gaps: u32,
    /// Drift of the sensor, in the unit of displacement per year.
    pub drift: f64,
    /// When the zero of the sensor is reset, in seconds, and the shift.
    pub zero_set: Option<(f64, f64)>,
    /// The thermometer shows only one in this many samples.
    pub thermometer_every: usize,
}

impl Imperfections {
    /// A perfect measurement.
    pub const NONE: Imperfections = Imperfections {
        white: 0.0,
        red: 0.0,
        memory: 86_400.0,
        scatter: 0.0,
        lag: 0.0,
        resolution: 0.0,
        spikes: 0.0,
        gaps: 0,
        drift: 0.0,
        zero_set: None,
        thermometer_every: 1,
    };
}

/// A synthetic record: times in seconds, temperatures in kelvin, and readings in the unit of
/// displacement.
#[derive(Clone, Debug, PartialEq)]
pub struct Twin {
    /// Times of the samples, in seconds.
    pub times: Vec<f64>,
    /// Temperatures that the thermometer shows, in kelvin; NaN where it shows none.
    pub temperatures: Vec<f64>,
    /// Readings of the sensor.
    pub readings: Vec<f64>,
    /// xi, which is not measured.
    pub positions: Vec<f64>,
    /// Number of slips.
    pub slips: u64,
}

/// A record of a bearing under this temperature, measured with these imperfections.
pub fn twin(response: &Response, air: &Air, imperfections: &Imperfections, seed: u64) -> Twin {
    // Each imperfection has its own stream of random numbers, so that changing one leaves the
    // others unchanged.
    let [mut sensor, friction, mut spikes, mut gaps, between] =
        std::array::from_fn(|i| Stream::new(seed, i as u64));
    let Trajectory {
        steel,
        positions,
        slips,
    } = trajectory(
        (response, &Course::default()),
        air,
        imperfections.lag,
        imperfections.scatter,
        STEP,
        [friction, between],
    );
    let [times, temperatures] = air.samples();
    let zero = Zero::moving(
        times.first().copied().unwrap_or(0.0),
        imperfections.drift,
        imperfections.zero_set,
    );
    let mut red = imperfections.red * sensor.normal();
    let mut readings = Vec::with_capacity(times.len());
    for i in 0..times.len() {
        if i > 0 {
            let diffusion = imperfections.red * (2.0 / imperfections.memory).sqrt();
            red = Transition::new(
                1.0 / imperfections.memory,
                diffusion,
                times[i] - times[i - 1],
            )
            .next(red, sensor.normal());
        }
        let mut reading = response.sensor.reading(positions[i], steel[i])
            + red
            + imperfections.white * sensor.normal();
        reading += zero.at(times[i]);
        if spikes.uniform() < imperfections.spikes {
            reading += 20.0
                * imperfections.white.hypot(imperfections.red)
                * (2.0 * spikes.uniform() - 1.0);
        }
        readings.push(reading);
    }
    let shown = |t: &f64| {
        if imperfections.resolution > 0.0 {
            (t / imperfections.resolution).round() * imperfections.resolution
        } else {
            *t
        }
    };
    let seen = |(i, t): (usize, &f64)| {
        if i.is_multiple_of(imperfections.thermometer_every) {
            shown(t)
        } else {
            f64::NAN
        }
    };
    let temperatures: Vec<f64> = temperatures.iter().enumerate().map(seen).collect();
    let length = times.last().copied().unwrap_or(0.0) - times.first().copied().unwrap_or(0.0);
    let mut twin = Twin {
        times,
        temperatures,
        readings,
        positions,
        slips,
    };
    for _ in 0..imperfections.gaps {
        let from = twin.times[0] + length * gaps.uniform();
        twin.remove(from..from + 86_400.0 * (1.0 + 4.0 * gaps.uniform()));
    }
    twin
}

impl Twin {
    /// Remove the samples between these times.
    fn remove(&mut self, gap: Range<f64>) {
        let kept: Vec<bool> = self.times.iter().map(|t| !gap.contains(t)).collect();
        for values in [
            &mut self.times,
            &mut self.temperatures,
            &mut self.readings,
            &mut self.positions,
        ] {
            let mut keeps = kept.iter();
            values.retain(|_| *keeps.next().unwrap_or(&true));
        }
    }
}
