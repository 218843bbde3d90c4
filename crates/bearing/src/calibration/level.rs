//! The relation of z to T while the body sticks, with white and red noise.
//!
//! During a stick z = level + still T + noise. The level of each stick is free, because the size of
//! slips is not known here. It also drifts, because sensor noise with a correlation time of a day
//! looks like a random walk over the hours that determine `still`. This is the local level model of
//! Kalman filtering: a random walk observed with white noise, which restarts after every slip and
//! every gap. Its one parameter is the variance of the walk per unit of time over that of the white
//! noise; it is fitted by maximum likelihood. The filter turns z and T into independent rows of a
//! regression.

use super::lowest::golden_section_minimum;

/// The mean of some neighbouring samples of a stick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Mean time, in seconds.
    pub time: f64,
    /// Mean temperature.
    pub temperature: f64,
    /// Mean reading.
    pub reading: f64,
    /// Number of samples.
    pub count: f64,
    /// Whether it is the first bin of a stick, so that no earlier bin determines the level.
    pub is_first: bool,
}

/// Sums over the rows of the regression, each row weighted with its inverse variance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LevelSums {
    /// Number of rows.
    pub rows: f64,
    /// Sum of the squares of the temperature.
    pub tt: f64,
    /// Sum of the products of temperature and reading.
    pub tz: f64,
    /// Sum of the squares of the reading.
    pub zz: f64,
    /// Sum of the logarithms of the variances of rows, in units of the white noise.
    pub log_variance: f64,
}

impl LevelSums {
    /// The slope of z against T, `still`.
    pub fn slope(&self) -> f64 {
        if self.tt > 0.0 {
            self.tz / self.tt
        } else {
            0.0
        }
    }

    /// The variance of the white noise.
    pub fn variance(&self) -> f64 {
        ((self.zz - self.slope() * self.tz) / self.rows).max(0.0)
    }

    /// Minus twice the logarithm of the likelihood, maximised over `still` and the white noise.
    pub fn deviance(&self) -> f64 {
        self.rows * self.variance().ln() + self.log_variance
    }
}

/// An estimate of the level of a stick, of both z and T, and its variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// The level of the readings.
    pub reading: f64,
    /// The level of the temperatures, with the same weights.
    pub temperature: f64,
    /// Variance of both, in units of the white noise.
    pub variance: f64,
}

impl Level {
    /// The level of z - still T.
    pub fn minus_slope(&self, still: f64) -> f64 {
        self.reading - still * self.temperature
    }
}

/// The level at each bin, estimated from the bins of its stick up to it, and, for every bin except
/// the first of a stick, the row of the regression: T, z, and the variance of both in units of the
/// white noise. If the bins run backwards in time, the levels are estimated from the later bins.
fn filtered(bins: &[Bin], walk: f64) -> impl Iterator<Item = (Level, Option<[f64; 3]>)> {
    let mut last: Option<(Level, f64)> = None;
    bins.iter().map(move |bin| {
        let own = Level {
            reading: bin.reading,
            temperature: bin.temperature,
            variance: 1.0 / bin.count,
        };
        let (level, row) = match last.filter(|_| !bin.is_first) {
            None => (own, None),
            Some((level, time)) => {
                let before = level.variance + walk * (bin.time - time).abs();
                let variance = before + own.variance;
                let (t, z) = (
                    bin.temperature - level.temperature,
                    bin.reading - level.reading,
                );
                let gain = before / variance;
                let reading = level.reading + gain * z;
                let temperature = level.temperature + gain * t;
                (
                    Level {
                        reading,
                        temperature,
                        variance: before * (1.0 - gain),
                    },
                    Some([t, z, variance]),
                )
            }
        };
        last = Some((level, bin.time));
        (level, row)
    })
}

/// The level at each bin.
pub fn levels(bins: &[Bin], walk: f64) -> Vec<Level> {
    filtered(bins, walk).map(|(level, _)| level).collect()
}

/// The sums over the rows of these bins.
pub fn sums(bins: &[Bin], walk: f64) -> LevelSums {
    let mut sums = LevelSums::default();
    for [t, z, variance] in filtered(bins, walk).filter_map(|(_, row)| row) {
        sums.rows += 1.0;
        sums.tt += t * t / variance;
        sums.tz += t * z / variance;
        sums.zz += z * z / variance;
        sums.log_variance += variance.ln();
    }
    sums
}

/// Bounds of the variance that the walk gains in an hour, in units of the white noise.
const WALKS: [f64; 2] = [1e-4, 1e5];

/// The most likely variance of the walk per second, in units of the white noise.
pub fn fitted_walk(bins: &[Bin]) -> f64 {
    let deviance = |log: f64| sums(bins, log.exp() / 3600.0).deviance();
    let [low, high] = WALKS.map(f64::ln);
    golden_section_minimum(low, high, 24, deviance).exp() / 3600.0
}
