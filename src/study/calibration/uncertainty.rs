//! How far an estimate may be off.
//!
//! Blocks of time are weighted anew, each with an exponential random number, and everything is
//! estimated again: the Bayesian bootstrap (Rubin, *Annals of Statistics* 9, 1981) of blocks. No
//! block is cut out, so that the history of the temperature, which a body with friction remembers,
//! stays whole.

use super::level::Sums;
use super::quantity::{Quantity, Values, values};
use super::samples::{Record, correlation};
use super::slips::Evidence;
use crate::noise::Stream;

/// How many times everything is estimated again.
const REPLICATES: u64 = 600;

/// What the random numbers are drawn from.
const SEED: u64 = 0xCA11;

/// Evidence at a lag, and at two lags around it if the lag was estimated and not given.
#[derive(Clone, Debug)]
pub struct Around {
    /// At the lag itself.
    pub here: Evidence,
    /// At a shorter and a longer one, and how far they are away, in seconds.
    pub beside: Option<([Evidence; 2], f64)>,
}

impl Around {
    /// What the slips say at this lag, which was estimated.
    pub fn lag(here: Evidence, record: &Record, lag: f64) -> Around {
        let step = (0.2 * lag).max(60.0).min(lag);
        let at = |lag: f64| here.with_temperatures(&record.lagged(lag).samples());
        let beside = at(lag - step).zip(at(lag + step)).map(|(less, more)| ([less, more], step));
        Around { here, beside }
    }

    /// The lag's distance from the likeliest one, and all quantities, with these weights.
    fn replicate(&self, weights: &[f64], shear_stiffness: f64) -> Option<(f64, Values)> {
        let at = |evidence: &Evidence| Some(values(&evidence.fit(weights)?, Some(shear_stiffness)));
        let here = at(&self.here)?;
        let Some(([less, more], step)) = &self.beside else { return Some((0.0, here)) };
        let deviance = |evidence: &Evidence| Sums::weighted(&evidence.sums, weights).deviance();
        let [low, middle, high] = [deviance(less), deviance(&self.here), deviance(more)];
        // The vertex of the parabola through three deviances, no farther than parabolas hold.
        let bend = low - 2.0 * middle + high;
        let vertex = if bend > 0.0 { (0.5 * (low - high) / bend).clamp(-3.0, 3.0) } else { 0.0 };
        let (low, high) = (at(less)?, at(more)?);
        let moved = std::array::from_fn(|i| here[i] + 0.5 * vertex * (high[i] - low[i]));
        Some((vertex * step, moved))
    }
}

/// What everything is when blocks are weighted at random.
#[derive(Clone, Debug, PartialEq)]
pub struct Replicates {
    values: Vec<Values>,
    lags: Vec<f64>,
}

impl Replicates {
    /// From random weights of the blocks of this evidence.
    pub fn new(around: &Around, shear_stiffness: f64) -> Replicates {
        let evidence = &around.here;
        let scatter = evidence.scatter();
        let replicate = |number: u64| {
            let mut random = Stream::new(SEED, number);
            let weights: Vec<f64> = evidence.sums.iter().map(|_| -libm::log(random.uniform())).collect();
            let (lag, mut values) = around.replicate(&weights, shear_stiffness)?;
            // The temperature of the first slip is one number, which no weight changes.
            let beta = values[Quantity::Dilatation as usize];
            values[Quantity::Displacement as usize] += beta * scatter * random.normal();
            Some((lag, values))
        };
        let (lags, values) = (0..REPLICATES).filter_map(replicate).unzip();
        Replicates { values, lags }
    }

    /// The standard deviation of each quantity.
    pub fn deviations(&self) -> Values {
        std::array::from_fn(|i| deviation(&self.column(i)))
    }

    /// That of the lag, in seconds.
    pub fn lag_deviation(&self) -> f64 {
        deviation(&self.lags)
    }

    /// Their correlations, one row after another.
    pub fn correlations(&self) -> Vec<Values> {
        let columns: Vec<Vec<f64>> = (0..Quantity::ALL.len()).map(|i| self.column(i)).collect();
        let between = |a: &[f64], b: &[f64]| correlation(&a.iter().zip(b).map(|(a, b)| [*a, *b]).collect::<Vec<_>>());
        columns.iter().map(|a| std::array::from_fn(|j| between(a, &columns[j]))).collect()
    }

    /// How far each quantity goes with this one.
    pub fn gains(&self, with: Quantity) -> Values {
        let other = self.column(with as usize);
        let spread = deviation(&other);
        std::array::from_fn(|i| {
            let own = self.column(i);
            let pairs: Vec<[f64; 2]> = own.iter().zip(&other).map(|(a, b)| [*a, *b]).collect();
            let gain = correlation(&pairs) * deviation(&own) / spread;
            if gain.is_finite() { gain } else { 0.0 }
        })
    }

    /// Every replicate changed.
    pub fn change(&mut self, change: impl Fn(&Values) -> Values) {
        for values in &mut self.values {
            *values = change(values);
        }
    }

    fn column(&self, i: usize) -> Vec<f64> {
        self.values.iter().map(|values| values[i]).collect()
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The standard deviation.
pub fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0)).sqrt()
}
