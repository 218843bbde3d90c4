//! Deviations from the assumptions of the estimates: slips at temperatures that the measured one does not
//! explain.

use super::bearing::Response;
use super::course::Course;
use super::fit::SlipFit;
use super::slips::{DetectedSlips, Reversal};

/// Further statistics of slips.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlipStatistics {
    /// How friction varies over the record.
    pub course: Course,
    /// The smallest and the largest A over the record relative to its mean.
    pub range: [f64; 2],
    /// The standard deviation of half of the changes of temperature between slips to either side, in
    /// kelvin.
    pub scatter: f64,
    /// The share of slips although no sample exceeds the previous extreme.
    pub early: f64,
    /// The standard deviation of the red noise of the sensor.
    pub red: f64,
    /// Twice the log-likelihood ratio of the movements of the zero.
    pub zero_gain: f64,
}

impl DetectedSlips {
    /// Further statistics of these slips, given this fit.
    pub fn statistics(&self, fit: &SlipFit) -> SlipStatistics {
        let Response { motion, sensor } = &fit.response;
        // A slip with a larger f_s than the previous one occurs later and is larger.
        let off = |reversal: &Reversal| {
            let kinetic = reversal
                .times
                .map(|time| fit.course.motion(motion, time).kinetic_reach());
            let change = reversal.change - kinetic[0] - kinetic[1];
            (0.5 * change - 0.25 * reversal.growth / sensor.moving).powi(2)
        };
        let n = self.reversals.len() as f64;
        let free = n - 1.0 - self.shape.columns() as f64;
        SlipStatistics {
            course: fit.course,
            range: fit.course.range(motion),
            scatter: (self.reversals.iter().map(off).sum::<f64>() / free).sqrt(),
            early: self.early(),
            red: self.noise(fit).red,
            zero_gain: self.zero.gain(&self.middles()),
        }
    }
}
