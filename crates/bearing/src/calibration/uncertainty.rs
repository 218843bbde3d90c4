//! The errors of the estimates, from synthetic records like the measured one.
//!
//! Each record is drawn from the estimates given the samples of the thermometer (`synthetic.rs`),
//! and its slips are detected and fitted in the same way. The mean error of the estimates of these
//! records is the bias of the method for this sampling and this noise; it is removed from the
//! estimates (indirect inference: Gourieroux, Monfort and Renault, *Journal of Applied
//! Econometrics* 8, 1993). Their scatter gives the intervals (the parametric bootstrap: Efron and
//! Tibshirani, *An Introduction to the Bootstrap*, 1993).

use super::bearing::{Response, Sensor};
use super::by_slips::BySlips;
use super::fit::SensorNoise;
use super::friction::SlipStatistics;
use super::motion::Motion;
use super::quantity::{Quantity, Values, response_of, values};
use super::slips::DetectedSlips;
use super::steel::Steel;
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

/// Linear interpolation is used if the share of early slips is closer than this to that of
/// synthetic records with linear interpolation, relative to the distance to that of rough ones.
/// Outdoor temperatures are rough.
const STRAIGHT: f64 = 0.35;

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
        (response, noise): (Response, SensorNoise),
        numbers: std::ops::Range<u64>,
        workers: Workers,
    ) -> Self {
        let synthetic = steel.synthetic(slips, response, noise);
        let make = |offset: u64| {
            let number = numbers.start + offset;
            let (lag, found) = steel.slips_of(slips, synthetic.draw(number))?;
            let (mut fit, zero) = found.fit()?;
            fit.motion.start -= synthetic.shift(number);
            fit.impossible(None)
                .is_none()
                .then(|| (values(&fit, Some(1.0)), lag, found.statistics(&fit, &zero)))
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

    /// The corrected response, and the estimates of records drawn from it. `None` if there are none.
    pub fn corrected(
        steel: &mut Steel,
        found: &BySlips,
        shear_stiffness: Option<f64>,
        workers: Workers,
    ) -> Option<(Response, Self)> {
        let BySlips {
            response: fit,
            zero,
            slips,
            ..
        } = found;
        let noise = slips.noise(fit, zero);
        let records = |steel: &Steel, (from, noise): (Response, SensorNoise), numbers| {
            Replicates::new((steel, slips), (from, noise), numbers, workers)
        };
        let is_possible = |response: &Response| response.impossible(shear_stiffness).is_none();
        let mut first = records(steel, (*fit, noise), 0..FIRST);
        let rough = first.mean_of(|shown| shown.early);
        if steel.may_be_straight() && slips.early() < SURELY_ROUGH * rough {
            steel.straighten(true);
            let lines = records(steel, (*fit, noise), JUDGED..JUDGED + FIRST);
            let straight = lines.mean_of(|shown| shown.early);
            let is_straight = slips.early() - straight < STRAIGHT * (rough - straight);
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
        let all = records(steel, (from, noise), FIRST..FIRST + RECORDS);
        let response = all.corrected_from(&from, fit)?;
        Some((response, all))
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

    /// The mean of a statistic of their slips.
    pub fn mean_of(&self, statistic: impl Fn(&SlipStatistics) -> f64) -> f64 {
        mean(&self.statistics.iter().map(statistic).collect::<Vec<_>>())
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
