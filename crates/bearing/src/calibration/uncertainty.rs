//! The uncertainty of the estimates.
//!
//! Blocks of time get random weights, exponentially distributed, and everything is estimated again:
//! the Bayesian bootstrap (Rubin, *Annals of Statistics* 9, 1981) of blocks. No block is cut out,
//! so the history of the temperature, on which a body with friction depends, stays complete.

use super::level::LevelSums;
use super::quantity::{Quantity, Values, response_of, values};
use super::question::CalibrationQuestion;
use super::samples::MeasuredRecord;
use super::slips::Evidence;
use crate::moments::{correlation, variance};
use stickslip::noise::Stream;

/// Number of times that everything is estimated again.
const REPLICATES: u64 = 600;

/// Seed of the random numbers.
const SEED: u64 = 0xCA11;

/// The evidence at a lag and, if the lag was estimated, at two neighbouring lags.
#[derive(Clone, Debug)]
pub struct AroundLag {
    /// The evidence at the lag itself.
    pub here: Evidence,
    /// The evidence at a shorter and at a longer lag, and their distance in seconds.
    pub beside: Option<([Evidence; 2], f64)>,
}

impl AroundLag {
    /// Compute the evidence around a lag that was estimated.
    pub fn lag(here: Evidence, record: &MeasuredRecord, lag: f64) -> AroundLag {
        let step = (0.2 * lag).max(60.0).min(lag);
        let at = |lag: f64| here.with_temperatures(&record.lagged(lag));
        let beside = at(lag - step)
            .zip(at(lag + step))
            .map(|(less, more)| ([less, more], step));
        AroundLag { here, beside }
    }

    /// The most likely lag, relative to the one that was estimated, and all quantities, with these
    /// weights.
    fn replicate(&self, weights: &[f64], shear_stiffness: f64) -> Option<(f64, Values)> {
        let at =
            |evidence: &Evidence| Some(values(&evidence.fit(weights)?.0, Some(shear_stiffness)));
        let here = at(&self.here)?;
        let Some(([less, more], step)) = &self.beside else {
            return Some((0.0, here));
        };
        let deviance =
            |evidence: &Evidence| LevelSums::weighted(&evidence.sums, weights).deviance();
        let [low, middle, high] = [deviance(less), deviance(&self.here), deviance(more)];
        // The vertex of the parabola through the three deviances, limited to the range in which a
        // parabola is a good approximation.
        let bend = low - 2.0 * middle + high;
        let vertex = if bend > 0.0 {
            (0.5 * (low - high) / bend).clamp(-3.0, 3.0)
        } else {
            0.0
        };
        let (low, high) = (at(less)?, at(more)?);
        let moved = std::array::from_fn(|i| here[i] + 0.5 * vertex * (high[i] - low[i]));
        Some((vertex * step, moved))
    }
}

/// The quantities and the lag for each set of random weights that gives those of a possible
/// bearing.
#[derive(Clone, Debug, PartialEq)]
pub struct Replicates {
    values: Vec<Values>,
    lags: Vec<f64>,
}

impl Replicates {
    /// Estimate everything again with random weights of the blocks.
    pub fn new(around: &AroundLag, question: &CalibrationQuestion) -> Replicates {
        let evidence = &around.here;
        let scatter = evidence.scatter();
        let shear_stiffness = question.shear_stiffness.unwrap_or(1.0);
        let replicate = |number: u64| {
            let mut random = Stream::new(SEED, number);
            let weights: Vec<f64> = evidence
                .sums
                .iter()
                .map(|_| -libm::log(random.uniform()))
                .collect();
            let (lag, mut values) = around.replicate(&weights, shear_stiffness)?;
            if response_of(&values)
                .impossible(question.shear_stiffness)
                .is_some()
            {
                return None;
            }
            // The temperature of the first slip is a single number that weights do not change, so
            // its error is added here.
            let beta = values[Quantity::Dilatation as usize];
            values[Quantity::Displacement as usize] += beta * scatter * random.normal();
            Some((lag, values))
        };
        let (lags, values) = (0..REPLICATES).filter_map(replicate).unzip();
        Replicates { values, lags }
    }

    /// Number of random weights that gave no possible bearing, and the number that was tried.
    pub fn impossible(&self) -> [usize; 2] {
        let all = REPLICATES as usize;
        [all - self.values.len(), all]
    }

    /// The standard deviation of each quantity.
    pub fn deviations(&self) -> Values {
        std::array::from_fn(|i| deviation(&self.column(i)))
    }

    /// The standard deviation of the lag, in seconds.
    pub fn lag_deviation(&self) -> f64 {
        deviation(&self.lags)
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
        let spread = deviation(&other);
        std::array::from_fn(|i| {
            let own = self.column(i);
            let gain = correlation(&own, &other) * deviation(&own) / spread;
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
}

/// The standard deviation of a sample.
pub fn deviation(values: &[f64]) -> f64 {
    variance(values).sqrt()
}
