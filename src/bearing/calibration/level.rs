//! How z follows T while friction holds the body, with noise that is partly white and partly red.
//!
//! During a stick z = level + still T + noise. The level of each stick is free, because the size of
//! slips is not known here. It also drifts, because a noise of the sensor with a memory of a day
//! looks like a random walk over the hours that determine `still`. This is the local level model of
//! Kalman filtering: a random walk observed with white noise, which starts anew after every slip
//! and every gap. Its one parameter is the variance of the walk per unit of time over that of the
//! white noise, and is fitted by maximum likelihood. The filter turns z and T into independent rows
//! of a regression.

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

/// Sums over the rows of one block of time, each row weighted with its inverse variance.
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
    /// The sum over blocks with these weights.
    pub fn weighted(blocks: &[LevelSums], weights: &[f64]) -> LevelSums {
        let mut sum = LevelSums::default();
        for (block, weight) in blocks.iter().zip(weights) {
            sum.rows += weight * block.rows;
            sum.tt += weight * block.tt;
            sum.tz += weight * block.tz;
            sum.zz += weight * block.zz;
            sum.log_variance += weight * block.log_variance;
        }
        sum
    }

    /// The slope of z against T, `still`.
    pub fn slope(&self) -> f64 {
        if self.tt > 0.0 { self.tz / self.tt } else { 0.0 }
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

/// An estimate of the level of a stick, for z and T alike, and its variance.
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

    fn of(bin: &Bin) -> Level {
        Level { reading: bin.reading, temperature: bin.temperature, variance: 1.0 / bin.count }
    }
}

/// One step of the filter. Returns the level after the bin, and the row: T, z, and the variance of
/// both.
#[inline(always)]
fn step(level: Level, elapsed: f64, bin: &Bin, walk: f64) -> (Level, [f64; 3]) {
    let before = level.variance + walk * elapsed;
    let variance = before + 1.0 / bin.count;
    let (t, z) = (bin.temperature - level.temperature, bin.reading - level.reading);
    let gain = before / variance;
    let level = Level {
        reading: level.reading + gain * z,
        temperature: level.temperature + gain * t,
        variance: before * (1.0 - gain),
    };
    (level, [t, z, variance])
}

/// The rows of the regression, each with the index of its bin: T, z, and the variance of both in
/// units of the white noise.
pub fn rows(bins: &[Bin], walk: f64) -> impl Iterator<Item = (usize, [f64; 3])> {
    let mut state: Option<(Level, f64)> = None;
    bins.iter().enumerate().filter_map(move |(i, bin)| {
        let known = state.take().filter(|_| !bin.is_first);
        let Some((level, time)) = known else {
            state = Some((Level::of(bin), bin.time));
            return None;
        };
        let (level, row) = step(level, bin.time - time, bin, walk);
        state = Some((level, bin.time));
        Some((i, row))
    })
}

/// The level at each bin, estimated from the bins of its stick up to it. If the bins run backwards
/// in time, these are the later ones.
pub fn levels(bins: &[Bin], walk: f64) -> Vec<Level> {
    let mut out: Vec<Level> = Vec::with_capacity(bins.len());
    for (i, bin) in bins.iter().enumerate() {
        let level = match out.last() {
            Some(level) if !bin.is_first => step(*level, (bin.time - bins[i - 1].time).abs(), bin, walk).0,
            _ => Level::of(bin),
        };
        out.push(level);
    }
    out
}

/// The sums of each block; `block` gives the index of the block of a time.
pub fn sums(bins: &[Bin], walk: f64, blocks: usize, block: impl Fn(f64) -> usize) -> Vec<LevelSums> {
    let mut out = vec![LevelSums::default(); blocks];
    for (i, [t, z, variance]) in rows(bins, walk) {
        let sums = &mut out[block(bins[i].time)];
        sums.rows += 1.0;
        sums.tt += t * t / variance;
        sums.tz += t * z / variance;
        sums.zz += z * z / variance;
        sums.log_variance += variance.ln();
    }
    out
}

/// Bounds of the variance that the walk gains in an hour, in units of the white noise.
const WALKS: [f64; 2] = [1e-4, 1e5];

/// The variance of the walk per second, in units of the white noise, of largest likelihood.
pub fn fitted_walk(bins: &[Bin]) -> f64 {
    let deviance = |log: f64| sums(bins, log.exp() / 3600.0, 1, |_| 0)[0].deviance();
    let [low, high] = WALKS.map(f64::ln);
    super::lowest::golden_section_minimum(low, high, 24, deviance).exp() / 3600.0
}
