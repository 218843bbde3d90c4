//! How z follows T while friction holds, in noise that is red and white.
//!
//! Inside a stick z = level + still T + noise. The level is free, because the way of a slip is not
//! known here, and it wanders, because a sensor's noise of a day is a random walk for the hours
//! that tell `still`. So this is the local level model of Kalman filtering: a random walk seen
//! through white noise, forgotten at every slip and gap. Its one parameter, the variance of a step
//! of the walk over that of the white noise, is fitted by likelihood, and the filter turns z and T
//! into independent rows of a regression.

/// Samples of a stick, taken together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Their mean time, in seconds.
    pub time: f64,
    /// Their mean temperature.
    pub temperature: f64,
    /// Their mean reading.
    pub reading: f64,
    /// How many they are.
    pub count: f64,
    /// Whether nothing before it tells the level: the first of a stick.
    pub is_first: bool,
}

/// Sums over the rows of one block of time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sums {
    /// How many rows there are.
    pub rows: f64,
    /// Of temperature squared.
    pub tt: f64,
    /// Of temperature times reading.
    pub tz: f64,
    /// Of reading squared.
    pub zz: f64,
    /// Of the logarithms of the variances of rows, in units of the white noise.
    pub log_variance: f64,
}

impl Sums {
    /// These, so many times.
    fn times(self, weight: f64) -> Sums {
        let Sums { rows, tt, tz, zz, log_variance } = self;
        Sums {
            rows: weight * rows,
            tt: weight * tt,
            tz: weight * tz,
            zz: weight * zz,
            log_variance: weight * log_variance,
        }
    }

    fn plus(self, other: Sums) -> Sums {
        Sums {
            rows: self.rows + other.rows,
            tt: self.tt + other.tt,
            tz: self.tz + other.tz,
            zz: self.zz + other.zz,
            log_variance: self.log_variance + other.log_variance,
        }
    }

    /// Of blocks with these weights.
    pub fn weighted(blocks: &[Sums], weights: &[f64]) -> Sums {
        blocks.iter().zip(weights).fold(Sums::default(), |sum, (block, weight)| sum.plus(block.times(*weight)))
    }

    /// `still`.
    pub fn slope(&self) -> f64 {
        if self.tt > 0.0 { self.tz / self.tt } else { 0.0 }
    }

    /// The variance of the white noise.
    pub fn variance(&self) -> f64 {
        ((self.zz - self.slope() * self.tz) / self.rows).max(0.0)
    }

    /// Twice the negative logarithm of the likelihood, `still` and the white noise chosen to make
    /// it largest.
    pub fn deviance(&self) -> f64 {
        self.rows * self.variance().ln() + self.log_variance
    }
}

/// A level that is known so well: its estimate from z and from T, and the variance of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Of the readings.
    pub reading: f64,
    /// Of the temperatures, weighted alike.
    pub temperature: f64,
    /// In units of the white noise.
    pub variance: f64,
}

impl Level {
    /// Of z - still T.
    pub fn less(&self, still: f64) -> f64 {
        self.reading - still * self.temperature
    }

    fn of(bin: &Bin) -> Level {
        Level { reading: bin.reading, temperature: bin.temperature, variance: 1.0 / bin.count }
    }
}

/// One step of the filter: the level after the bin, and the row: T, z, and the variance of both.
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

/// The rows, and the bin of each: T, z, and the variance of both in units of the white noise.
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

/// The level at each bin, from the bins of its stick up to it; of bins that run backwards in time,
/// from those after it.
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

/// The sums of each block; `block` tells the block of a time.
pub fn sums(bins: &[Bin], walk: f64, blocks: usize, block: impl Fn(f64) -> usize) -> Vec<Sums> {
    let mut out = vec![Sums::default(); blocks];
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

/// Between which the variance that the walk gains in an hour may lie, in units of the white noise.
const WALKS: [f64; 2] = [1e-4, 1e5];

/// The walk that makes the likelihood largest, per second.
pub fn fitted_walk(bins: &[Bin]) -> f64 {
    let deviance = |log: f64| sums(bins, log.exp() / 3600.0, 1, |_| 0)[0].deviance();
    let [low, high] = WALKS.map(f64::ln);
    super::lowest::golden(low, high, 24, deviance).exp() / 3600.0
}
