//! Synthetic records like a measured one, drawn given its samples: the temperature at and between
//! the samples from its posterior distribution, the bearing with known parameters, and the errors
//! of the sensor.

use super::air::Air;
use super::bearing::Response;
use super::course::Course;
use super::fit::SensorNoise;
use super::motion::Motion;
use super::samples::MeasuredRecord;
use super::trajectory::{STEP, Trajectory, trajectory};
use crate::weather::HiddenTemperature;
use stickslip::noise::{Stream, Transition};

/// The ingredients of synthetic records.
pub struct Synthetic<'a> {
    /// The record, whose samples they share.
    pub record: &'a MeasuredRecord,
    /// The temperature, if its samples do not show it directly.
    pub hidden: Option<&'a HiddenTemperature>,
    /// The variance that the temperature gains between samples, in K^2/s; 0 for linear
    /// interpolation.
    pub roughness: f64,
    /// The lag of the steel, in seconds.
    pub lag: f64,
    /// The bearing.
    pub response: Response,
    /// How its friction varies.
    pub course: Course,
    /// Relative standard deviation of f_s from slip to slip.
    pub scatter: f64,
    /// The errors of the displacement sensor.
    pub noise: SensorNoise,
}

/// Seeds of the random numbers.
const SEED: u64 = 0xCA11;
const SHIFT_SEED: u64 = 0x51F7;

/// The longest temperature step without a lag, in seconds. The extreme temperature within a step
/// has its exact law.
const LONGEST: f64 = 600.0;

/// Times that are closer than this are the same, in seconds.
const SAME: f64 = 1e-3;

/// Values at ascending times, as read by a sensor at these instants or as means over this many
/// seconds around them.
fn seen([times, values]: [&[f64]; 2], when: &[f64], over: f64) -> Vec<f64> {
    let before = |time: f64| times.partition_point(|t| *t <= time + SAME).max(1) - 1;
    if over == 0.0 {
        return when.iter().map(|time| values[before(*time)]).collect();
    }
    let mut sums = vec![0.0];
    for i in 1..times.len() {
        sums.push(sums[i - 1] + 0.5 * (times[i] - times[i - 1]) * (values[i] + values[i - 1]));
    }
    let until = |time: f64| {
        let i = before(time).min(times.len().saturating_sub(2));
        let share = ((time - times[i]) / (times[i + 1] - times[i])).clamp(0.0, 1.0);
        sums[i] + share * (sums[i + 1] - sums[i])
    };
    when.iter()
        .map(|time| (until(time + 0.5 * over) - until(time - 0.5 * over)) / over)
        .collect()
}

impl Synthetic<'_> {
    /// The shift of xi(0) in the record of this number: up to G/2 to either side, as far as the
    /// body still sticks. It changes the temperatures of all slips; otherwise they would occur
    /// between the same two samples in every record.
    pub fn shift(&self, number: u64) -> f64 {
        let Motion { reach, jump, start } = self.response.motion;
        let first = self.record.temperatures.first().copied().unwrap_or(start);
        let share = Stream::new(SHIFT_SEED, number).uniform() - 0.5;
        (start + share * jump).clamp(first - reach, first + reach) - start
    }

    /// The record of this number, and its jumps: the time of the first reading after each, and its
    /// size.
    pub fn draw(&self, number: u64) -> (MeasuredRecord, Vec<[f64; 2]>) {
        let [mut temperature, mut sensor, friction, between] =
            std::array::from_fn(|i| Stream::new(SEED, 4 * number + i as u64));
        let mut response = self.response;
        response.motion.start += self.shift(number);
        let air = match self.hidden.filter(|_| self.roughness > 0.0) {
            Some(hidden) => Air {
                roughness: self.roughness,
                ..Air::straight(
                    hidden.times.clone(),
                    hidden.posterior_sample(&mut temperature),
                )
            },
            None => Air {
                roughness: self.roughness,
                ..Air::straight(self.record.times.clone(), self.record.temperatures.clone())
            },
        };
        let Trajectory {
            steel, positions, ..
        } = trajectory(
            (&response, &self.course),
            &air,
            self.lag,
            self.scatter,
            if self.lag > 0.0 { STEP } else { LONGEST },
            [friction, between],
        );
        let [times, mut temperatures] = self.record.thermometer();
        let white = self.hidden.map_or(0.0, |hidden| hidden.white);
        if white > 0.0 {
            temperatures = seen(
                [&air.times, &air.temperatures],
                &times,
                self.record.averaged[0],
            );
            temperatures
                .iter_mut()
                .for_each(|t| *t += white * temperature.normal());
        }
        let when = self.record.samples().times;
        let z: Vec<f64> = positions
            .iter()
            .zip(&steel)
            .map(|(xi, steel)| response.sensor.reading(*xi, *steel))
            .collect();
        let mut readings = seen([&air.times, &z], &when, self.record.averaged[1]);
        self.add_noise(&when, &mut readings, &mut sensor);
        let places = seen([&air.times, &positions], &when, 0.0);
        let is_jump = |i: &usize| (places[*i] - places[i - 1]).abs() > 0.0;
        let jump = |i: usize| [when[i], places[i] - places[i - 1]];
        let both = MeasuredRecord::of([&times, &temperatures], [&when, &readings]);
        let averaged = self.record.averaged;
        (
            MeasuredRecord { averaged, ..both },
            (1..when.len()).filter(is_jump).map(jump).collect(),
        )
    }

    /// Add the errors of the sensor to readings at these times.
    fn add_noise(&self, times: &[f64], readings: &mut [f64], random: &mut Stream) {
        let SensorNoise { white, red, memory } = self.noise;
        let has_red = red > 0.0 && memory.is_finite();
        let mut drift = red * random.normal();
        for i in 0..times.len() {
            if i > 0 && has_red {
                let h = times[i] - times[i - 1];
                drift = Transition::new(1.0 / memory, red * (2.0 / memory).sqrt(), h)
                    .next(drift, random.normal());
            }
            readings[i] += white * random.normal() + if has_red { drift } else { 0.0 };
        }
    }
}
