//! Deviations from the assumptions of the estimates: friction that changes over the record, and
//! slips at temperatures that the measured one does not explain.

use super::bearing::Response;
use super::slips::{DetectedSlips, Reversal};
use super::zero::Zero;
use crate::linear::Normal;

/// Further statistics of slips.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlipStatistics {
    /// Twice the log-likelihood ratio of a change of friction over time.
    pub gain: f64,
    /// The smallest and the largest A over the record relative to its mean, if it changes in this
    /// way.
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

/// A parabola over time, by least squares.
struct Parabola {
    coefficients: Vec<f64>,
    /// Twice the log-likelihood ratio to a constant.
    gain: f64,
    /// The root mean square of the residuals.
    rest: f64,
}

/// The minimum number of values that determine a change.
const FEWEST: usize = 10;

impl Parabola {
    /// The parabola through values at times from -1 to 1; `None` if they do not determine it.
    fn of(values: &[(f64, f64)]) -> Option<Self> {
        let rest = |columns: usize| {
            let mut normal = Normal::of(columns);
            values
                .iter()
                .for_each(|(u, y)| normal.add(&[1.0, *u, u * u][..columns], *y, 1.0));
            let found = normal.solve()?;
            let off = |(u, y): &(f64, f64)| {
                let at: f64 = found.iter().zip([1.0, *u, u * u]).map(|(a, b)| a * b).sum();
                (y - at).powi(2)
            };
            Some((values.iter().map(off).sum::<f64>(), found))
        };
        let n = values.len() as f64;
        let (constant, (squares, coefficients)) = (rest(1)?.0, rest(3)?);
        let gain = n * libm::log(constant / squares);
        (values.len() >= FEWEST).then(|| Parabola {
            coefficients,
            gain,
            rest: (squares / (n - 3.0)).sqrt(),
        })
    }

    fn at(&self, u: f64) -> f64 {
        self.coefficients
            .iter()
            .zip([1.0, u, u * u])
            .map(|(a, b)| a * b)
            .sum()
    }
}

impl DetectedSlips {
    /// Further statistics of these slips, given this response.
    pub fn statistics(&self, response: &Response, zero: &Zero) -> SlipStatistics {
        let Response { motion, sensor } = response;
        let [begin, end] =
            [self.slips.first(), self.slips.last()].map(|slip| slip.map_or(0.0, |slip| slip.time));
        let place = |time: f64| 2.0 * (time - begin) / (end - begin) - 1.0;
        let jumps: Vec<(f64, f64)> = self
            .usual()
            .map(|slip| (place(slip.time), slip.size(sensor.still) / sensor.moving))
            .collect();
        // A slip with a larger f_s than the previous one occurs later and is larger.
        let kinetic =
            |reversal: &Reversal| 0.5 * reversal.change - 0.25 * reversal.growth / sensor.moving;
        let changes: Vec<(f64, f64)> = self
            .reversals
            .iter()
            .map(|reversal| (place(reversal.time), kinetic(reversal)))
            .collect();
        let plain = SlipStatistics {
            early: self.early(),
            red: self.noise(response, zero).red,
            zero_gain: self.zero.gain(&self.middles()),
            ..SlipStatistics::default()
        };
        let Some((kinetic, jump)) = Parabola::of(&changes).zip(Parabola::of(&jumps)) else {
            return plain;
        };
        let reaches = || {
            changes
                .iter()
                .map(|(u, _)| kinetic.at(*u) + 0.5 * jump.at(*u))
        };
        let range = [
            reaches().fold(f64::INFINITY, f64::min),
            reaches().fold(0.0, f64::max),
        ];
        SlipStatistics {
            gain: kinetic.gain.max(jump.gain),
            range: range.map(|reach| reach / motion.reach),
            scatter: kinetic.rest,
            ..plain
        }
    }
}
