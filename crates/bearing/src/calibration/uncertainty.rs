//! The errors of the estimates, from synthetic records like the measured one.
//!
//! Each record is drawn from the estimates given the samples of the thermometer (`synthetic.rs`),
//! and its slips are detected and fitted in the same way. The mean error of the estimates of these
//! records is the bias of the method for this sampling and this noise; it is removed from the
//! estimates (indirect inference: Gourieroux, Monfort and Renault, *Journal of Applied
//! Econometrics* 8, 1993). Their scatter gives the intervals (the parametric bootstrap: Efron and
//! Tibshirani, *An Introduction to the Bootstrap*, 1993).

use super::bearing::{Response, Sensor};
use super::course::Course;
use super::fit::{SensorNoise, SlipFit};
use super::friction::SlipStatistics;
use super::motion::Motion;
use super::quantity::{Quantity, Values, response_of, values};
use super::slips::DetectedSlips;
use super::steel::Steel;
use crate::linear::Matrix;
use crate::moments::{correlation, mean, variance};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use stickslip::ensemble::in_order;

/// Number of records, also for the first correction.
const RECORDS: u64 = 32;
const FIRST: u64 = 8;

/// First number of the records used to judge roughness.
const JUDGED: u64 = 1000;

/// If the share of early slips exceeds this times that of rough synthetic records, the temperature
/// is rough.
const SURELY_ROUGH: f64 = 0.6;

/// Linear interpolation is used if that raises the log-likelihood of the early slips by this. Air is
/// never straight between samples, so the odds against it are a thousand to one; only a temperature
/// that was itself computed by interpolation shows it.
const STRAIGHT: f64 = 7.0;

/// The estimates of synthetic records.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replicates {
    values: Vec<Values>,
    lags: Vec<f64>,
    /// Further statistics of their slips.
    pub statistics: Vec<SlipStatistics>,
    tried: usize,
}

/// Threads, and a flag that stops the work.
#[derive(Clone, Copy)]
pub struct Workers<'a> {
    pub threads: usize,
    pub stop: &'a AtomicBool,
}

impl Replicates {
    /// The estimates of synthetic records with these numbers, for a bearing with this response.
    fn new(
        (steel, slips): (&Steel, &DetectedSlips),
        (response, course, noise): (Response, Course, SensorNoise),
        numbers: std::ops::Range<u64>,
        workers: Workers,
    ) -> Self {
        let synthetic = steel.synthetic(slips, (response, course), noise);
        let make = |offset: u64| {
            let number = numbers.start + offset;
            let (lag, found) = steel.slips_of(slips, synthetic.draw(number))?;
            let mut fit = found.fit()?;
            fit.response.motion.start -= synthetic.shift(number);
            let response = fit.response;
            let is_possible = response.impossible(None).is_none();
            is_possible.then(|| (values(&response, Some(1.0)), lag, found.statistics(&fit)))
        };
        let mut all = Replicates::default();
        let deliver = |found: Option<(Values, f64, SlipStatistics)>| {
            all.tried += 1;
            if let Some((values, lag, statistics)) = found {
                all.values.push(values);
                all.lags.push(lag);
                all.statistics.push(statistics);
            }
            Ok::<_, Infallible>(ControlFlow::Continue(()))
        };
        let count = numbers.end - numbers.start;
        let Ok(_) = in_order(count, workers.threads, workers.stop, make, deliver);
        all
    }

    /// The corrected response and course of friction, and the estimates of records drawn from them.
    /// `None` if there are none.
    pub fn corrected(
        steel: &mut Steel,
        (slips, found): (&DetectedSlips, &SlipFit),
        shear_stiffness: Option<f64>,
        workers: Workers,
    ) -> Option<(Response, Course, Self)> {
        let (fit, course) = (&found.response, &found.course);
        let noise = slips.noise(found);
        let records = |steel: &Steel, from: (Response, Course, SensorNoise), numbers| {
            Replicates::new((steel, slips), from, numbers, workers)
        };
        let is_possible = |response: &Response| response.impossible(shear_stiffness).is_none();
        let mut first = records(steel, (*fit, *course, noise), 0..FIRST);
        let rough = first.mean_of(|shown| shown.early);
        if steel.may_be_straight() && slips.early() < SURELY_ROUGH * rough {
            steel.straighten(true);
            let lines = records(steel, (*fit, *course, noise), JUDGED..JUDGED + FIRST);
            let straight = lines.mean_of(|shown| shown.early);
            let is_straight = slips.early_gain(straight, rough) > STRAIGHT;
            steel.straighten(is_straight);
            if is_straight {
                first = lines;
            }
        }
        let noise = first.corrected_noise(noise);
        let from = first
            .corrected_from(fit, fit)
            .filter(is_possible)
            .unwrap_or(*fit);
        let varied = first.corrected_course(course, course);
        let all = records(steel, (from, varied, noise), FIRST..FIRST + RECORDS);
        let response = all.corrected_from(&from, fit)?;
        Some((response, all.corrected_course(&varied, course), all))
    }

    /// Noise whose red part is corrected by its estimates in these records: slips cluster in days,
    /// with the same noise.
    fn corrected_noise(&self, noise: SensorNoise) -> SensorNoise {
        let factor = noise.red / self.mean_of(|shown| shown.red);
        let factor = if factor.is_finite() {
            factor.clamp(0.7, 1.5)
        } else {
            1.0
        };
        SensorNoise {
            red: factor * noise.red,
            memory: factor * factor * noise.memory,
            ..noise
        }
    }

    /// The response `fit`, corrected for the bias of these estimates of records of `from`.
    fn corrected_from(&self, from: &Response, fit: &Response) -> Option<Response> {
        let responses: Vec<Response> = self.values.iter().map(response_of).collect();
        let off = |of: fn(&Response) -> f64| {
            let all: Vec<f64> = responses.iter().map(of).collect();
            of(fit) - (mean(&all) - of(from))
        };
        (responses.len() > 1).then(|| Response {
            motion: Motion {
                reach: off(|it| it.motion.reach),
                jump: off(|it| it.motion.jump),
                start: off(|it| it.motion.start),
            },
            sensor: Sensor {
                offset: off(|it| it.sensor.offset),
                moving: off(|it| it.sensor.moving),
                still: off(|it| it.sensor.still),
            },
        })
    }

    /// The course of friction `fit`, corrected in the same way for records of `from`.
    fn corrected_course(&self, from: &Course, fit: &Course) -> Course {
        let mut coefficients = fit.coefficients();
        for (i, (of, from)) in coefficients.iter_mut().zip(from.coefficients()).enumerate() {
            *of -= self.mean_of(|shown| shown.course.coefficients()[i]) - from;
        }
        fit.with(&coefficients)
    }

    /// The covariance of the errors of these quantities and then of the course of friction.
    pub fn covariance(&self, quantities: &[Quantity]) -> Matrix {
        let row = |(values, shown): (&Values, &SlipStatistics)| -> Vec<f64> {
            let known = quantities.iter().map(|quantity| values[*quantity as usize]);
            known.chain(shown.course.coefficients()).collect()
        };
        let rows: Vec<Vec<f64>> = self.values.iter().zip(&self.statistics).map(row).collect();
        let column = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = (0..rows.first().map_or(0, Vec::len)).map(column).collect();
        let product = |a: &Vec<f64>, b: &Vec<f64>| {
            let correlation = correlation(a, b);
            let sds = self.deviation(a) * self.deviation(b);
            if correlation.is_finite() {
                correlation * sds
            } else {
                0.0
            }
        };
        let row = |a: &Vec<f64>| columns.iter().map(|b| product(a, b)).collect();
        columns.iter().map(row).collect()
    }

    /// The mean of a statistic of their slips.
    pub fn mean_of(&self, statistic: impl Fn(&SlipStatistics) -> f64) -> f64 {
        mean(&self.statistics.iter().map(statistic).collect::<Vec<_>>())
    }

    /// The standard deviation of a statistic of their slips.
    pub fn deviation_of(&self, statistic: impl Fn(&SlipStatistics) -> f64) -> f64 {
        self.deviation(&self.statistics.iter().map(statistic).collect::<Vec<_>>())
    }

    /// Number of records with unphysical estimates, and of all records.
    pub fn impossible(&self) -> [usize; 2] {
        [self.tried - self.values.len(), self.tried]
    }

    /// The estimates, made without K_BP, scaled by it.
    pub fn with_shear(mut self, shear_stiffness: f64) -> Self {
        for all in &mut self.values {
            *all = values(&response_of(all), Some(shear_stiffness));
        }
        self
    }

    /// The standard deviation of each quantity.
    pub fn deviations(&self) -> Values {
        std::array::from_fn(|i| self.deviation(&self.column(i)))
    }

    /// The standard deviation of the lag, in seconds.
    pub fn lag_deviation(&self) -> f64 {
        self.deviation(&self.lags)
    }

    /// The correlations of the quantities, one row for each.
    pub fn correlations(&self) -> Vec<Values> {
        let columns: Vec<Vec<f64>> = (0..Quantity::ALL.len()).map(|i| self.column(i)).collect();
        columns
            .iter()
            .map(|a| std::array::from_fn(|j| correlation(a, &columns[j])))
            .collect()
    }

    /// The regression coefficient of each quantity on this one.
    pub fn gains(&self, with: Quantity) -> Values {
        let other = self.column(with as usize);
        let spread = variance(&other).sqrt();
        std::array::from_fn(|i| {
            let values = self.column(i);
            let gain = correlation(&values, &other) * variance(&values).sqrt() / spread;
            if gain.is_finite() { gain } else { 0.0 }
        })
    }

    /// Change every replicate.
    pub fn change(&mut self, change: impl Fn(&Values) -> Values) {
        for values in &mut self.values {
            *values = change(values);
        }
    }

    fn column(&self, i: usize) -> Vec<f64> {
        self.values.iter().map(|values| values[i]).collect()
    }

    /// The standard deviation of an estimate. The correction is the mean over the records and has
    /// an error itself, and the variance is estimated from few records, which makes the
    /// distribution Student's.
    fn deviation(&self, values: &[f64]) -> f64 {
        let n = values.len() as f64;
        (variance(values) * (1.0 + 1.0 / n) * (n - 1.0) / (n - 3.0)).sqrt()
    }
}
