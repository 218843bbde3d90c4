//! How far steel is behind air.

use super::level::{self, Sums};
use super::lowest::golden;
use super::samples::{HOUR, Record, Samples};
use super::slips::Evidence;
use super::sticks::{bins, sticks};

/// The longest lag that is looked for, in seconds.
pub const LONGEST: f64 = 4.0 * HOUR;

/// By how much twice the logarithm of the likelihood must gain for a lag to be believed.
///
/// Twins without a lag gain less than 3, and less than 10 with a thermometer of 1 K; one of five
/// minutes gains 40.
pub const CONVINCING: f64 = 15.0;

/// The lags of the profile that is kept, in minutes.
const MINUTES: [f64; 12] = [0.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0, 240.0];

/// What z says inside sticks of the lag of steel behind the thermometer.
#[derive(Clone, Debug, PartialEq)]
pub struct LagProfile {
    /// The likeliest, in seconds.
    pub likeliest: f64,
    /// By how much twice the logarithm of the likelihood is larger there than without a lag.
    pub gain: f64,
    /// Lags in seconds, and how far each is below the likeliest in the same measure.
    pub profile: Vec<(f64, f64)>,
}

/// Profile the lag, with the slips that were found.
pub fn lag_profile(record: &Record, evidence: &Evidence) -> LagProfile {
    let samples = record.samples();
    let sticks = sticks(&samples, evidence.slips.iter().map(|slip| slip.index));
    let binned = |samples: &Samples| bins(samples, &sticks, evidence.bin, 2);
    let walk = level::fitted_walk(&binned(&samples));
    let deviance = |lag: f64| {
        let steel = binned(&record.lagged(lag).samples());
        Sums::weighted(&level::sums(&steel, walk, 1, |_| 0), &[1.0]).deviance()
    };
    let likeliest = golden(0.0, LONGEST, 20, deviance);
    let (at_best, without) = (deviance(likeliest), deviance(0.0));
    let likeliest = if at_best < without { likeliest } else { 0.0 };
    let lowest = at_best.min(without);
    let profile = MINUTES.iter().map(|minutes| (60.0 * minutes, deviance(60.0 * minutes) - lowest)).collect();
    LagProfile { likeliest, gain: without - lowest, profile }
}

impl LagProfile {
    /// How far this lag is below the likeliest, on a line between the lags of the profile.
    pub fn against(&self, lag: f64) -> f64 {
        let after = self.profile.iter().position(|(at, _)| *at >= lag).unwrap_or(self.profile.len() - 1).max(1);
        let ((a, low), (b, high)) = (self.profile[after - 1], self.profile[after]);
        low + (high - low) * (lag - a) / (b - a)
    }
}
