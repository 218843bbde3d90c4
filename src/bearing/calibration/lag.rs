//! The lag of the temperature of the steel behind that of the air.

use super::level::{self, LevelSums};
use super::lowest::golden_section_minimum;
use super::samples::{HOUR, MeasuredRecord, Samples};
use super::slips::Evidence;
use super::sticks::{bins, sticks};

/// The longest lag that is considered, in seconds.
pub const LONGEST: f64 = 4.0 * HOUR;

/// A lag is accepted if twice the logarithm of the likelihood gains more than this.
///
/// In synthetic records without a lag the gain is below 3, and below 10 with a thermometer that
/// shows whole kelvins; a lag of five minutes gains 40.
pub const CONVINCING: f64 = 15.0;

/// The lags of the reported profile, in minutes.
const MINUTES: [f64; 12] = [0.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0, 240.0];

/// By how many hours two clocks may differ: summer time, and a time zone that was forgotten.
const CLOCKS: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];

/// The likelihood of the lag of steel behind the thermometer, from z during sticks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LagProfile {
    /// The most likely lag, in seconds.
    pub likeliest: f64,
    /// Twice the logarithm of the likelihood at that lag, minus the same without a lag.
    pub gain: f64,
    /// By how many seconds the clock of the sensor is behind that of the thermometer, in whole
    /// hours, if that explains the displacement far better than any lag does.
    pub clock: Option<f64>,
    /// Lags in seconds, and for each the deviance (minus twice the log-likelihood) above its
    /// minimum.
    pub profile: Vec<(f64, f64)>,
}

/// Compute the profile of the lag, given the slips that were found.
pub fn lag_profile(record: &MeasuredRecord, evidence: &Evidence) -> LagProfile {
    let samples = record.samples();
    let sticks = sticks(&samples, evidence.slips.iter().map(|slip| slip.index));
    let binned = |samples: &Samples| bins(samples, &sticks, evidence.bin, 2);
    let walk = level::fitted_walk(&binned(&samples));
    let deviance = |lag: f64| {
        let steel = binned(&record.lagged(lag).samples());
        LevelSums::weighted(&level::sums(&steel, walk, 1, |_| 0), &[1.0]).deviance()
    };
    let likeliest = golden_section_minimum(0.0, LONGEST, 20, deviance);
    let (at_best, without) = (deviance(likeliest), deviance(0.0));
    let likeliest = if at_best < without { likeliest } else { 0.0 };
    let lowest = at_best.min(without);
    let profile = MINUTES.iter().map(|minutes| (60.0 * minutes, deviance(60.0 * minutes) - lowest)).collect();
    let shifted = |seconds: f64| {
        let steel = binned(&record.shifted(seconds).samples());
        LevelSums::weighted(&level::sums(&steel, walk, 1, |_| 0), &[1.0]).deviance()
    };
    let shifts = CLOCKS.map(|hours| (HOUR * hours, shifted(HOUR * hours)));
    let best = shifts.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
    let clock = best.filter(|(_, deviance)| lowest - deviance > CONVINCING).map(|(seconds, _)| seconds);
    LagProfile { likeliest, gain: without - lowest, clock, profile }
}

impl LagProfile {
    /// The deviance of a lag above the minimum, interpolated linearly between the lags of the
    /// profile.
    pub fn against(&self, lag: f64) -> f64 {
        let after = self.profile.iter().position(|(at, _)| *at >= lag).unwrap_or(self.profile.len() - 1).max(1);
        let ((a, low), (b, high)) = (self.profile[after - 1], self.profile[after]);
        low + (high - low) * (lag - a) / (b - a)
    }
}
