//! Measured values: samples in order of time, interpolated linearly.

use std::sync::Arc;

/// Values S at the times t_0 = 0 < t_1 < ..., interpolated linearly.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    times: Vec<f64>,
    values: Vec<f64>,
}

/// A series with a name: that by which expressions call it, or the table that describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSeries {
    /// The name.
    pub name: String,
    /// The samples. Clones share them.
    pub series: Arc<Series>,
}

/// The error for numbers that are not a valid series.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a series needs at least two samples, one finite value for each time, and increasing times that begin at 0"
)]
pub struct NoSeries;

impl Series {
    /// A series from times and values.
    ///
    /// ```
    /// use stickslip::model::Series;
    ///
    /// let series = Series::new(vec![0.0, 10.0, 20.0], vec![15.0, 16.0, 14.0])?;
    /// assert_eq!([series.at(5.0), series.at(15.0), series.end()], [15.5, 15.0, 20.0]);
    /// # Ok::<(), stickslip::model::NoSeries>(())
    /// ```
    pub fn new(times: Vec<f64>, values: Vec<f64>) -> Result<Self, NoSeries> {
        let is_finite = times.iter().chain(&values).all(|x| x.is_finite());
        let is_ordered = times.windows(2).all(|pair| pair[0] < pair[1]);
        let is_long = times.len() >= 2 && times.len() == values.len() && times[0] == 0.0;
        if is_finite && is_ordered && is_long {
            Ok(Series { times, values })
        } else {
            Err(NoSeries)
        }
    }

    /// A series without values: a path that meets it is lost.
    pub fn unknown() -> Self {
        Series {
            times: vec![0.0, 1.0],
            values: vec![f64::NAN; 2],
        }
    }

    /// Zero at all times.
    pub fn nothing() -> Self {
        Series {
            times: vec![0.0, 1.0],
            values: vec![0.0; 2],
        }
    }

    /// The same, where two samples at one time are a jump: a line that is too short to matter, up to
    /// that time.
    pub fn with_jumps(mut times: Vec<f64>, values: Vec<f64>) -> Result<Self, NoSeries> {
        for i in 1..times.len() {
            if times[i] == times[i - 1] {
                times[i - 1] = before(times[i]);
            }
        }
        Series::new(times, values)
    }

    /// The same, where each value lasts until the next sample.
    pub fn held(times: &[f64], values: &[f64]) -> Result<Self, NoSeries> {
        if times.len() != values.len() {
            return Err(NoSeries);
        }
        let mut samples: Vec<(f64, f64)> = Vec::with_capacity(2 * times.len());
        for (i, (time, value)) in times.iter().zip(values).enumerate() {
            if i > 0 && before(*time) > times[i - 1] {
                samples.push((before(*time), values[i - 1]));
            }
            samples.push((*time, *value));
        }
        let (times, values) = samples.into_iter().unzip();
        Series::new(times, values)
    }

    /// The sum of several series, each times a factor, from 0 to the end of the shortest.
    pub fn sum(parts: &[(f64, &Series)]) -> Self {
        let ends = parts.iter().map(|(_, series)| series.end());
        let end = ends.fold(f64::INFINITY, f64::min);
        let all = parts.iter().flat_map(|(_, series)| series.times());
        let mut times: Vec<f64> = all.copied().filter(|time| *time <= end).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let at = |t: &f64| {
            let values = parts.iter().map(|(factor, series)| factor * series.at(*t));
            values.sum()
        };
        let values = times.iter().map(at).collect();
        Series { times, values }
    }

    /// The times of the samples; the first is 0.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The values of the samples.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The time of the last sample.
    pub fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// The number of the segment that contains a time. Segment i lasts from t_i to t_{i+1}; the
    /// last one also contains all later times.
    pub fn piece(&self, t: f64) -> usize {
        self.times
            .partition_point(|time| *time <= t)
            .clamp(1, self.times.len() - 1)
            - 1
    }

    /// S at a time in a segment. At the start of the segment it is exactly the sample.
    pub fn on(&self, piece: usize, t: f64) -> f64 {
        self.values[piece] + self.slope(piece) * (t - self.times[piece])
    }

    /// S' in a segment.
    pub fn slope(&self, piece: usize) -> f64 {
        (self.values[piece + 1] - self.values[piece]) / (self.times[piece + 1] - self.times[piece])
    }

    /// S at a time.
    pub fn at(&self, t: f64) -> f64 {
        self.on(self.piece(t), t)
    }

    /// Whether there are samples that are closer than rounding of their times resolves: jumps.
    pub fn has_jumps(&self) -> bool {
        self.times.windows(2).any(is_jump)
    }

    /// The largest |S|.
    pub fn bound(&self) -> f64 {
        self.values
            .iter()
            .fold(0.0, |most, value| value.abs().max(most))
    }

    /// The largest |S'|.
    pub fn steepest(&self) -> f64 {
        (0..self.times.len() - 1).fold(0.0, |most, piece| self.slope(piece).abs().max(most))
    }

    /// The times of the smallest and of the largest S.
    pub fn extremes(&self) -> [f64; 2] {
        let (low, high) = self.range();
        [low, high].map(|value| {
            self.values
                .iter()
                .position(|other| *other == value)
                .map_or(0.0, |i| self.times[i])
        })
    }

    /// The smallest and the largest S.
    pub fn range(&self) -> (f64, f64) {
        self.values
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| {
                (value.min(low), value.max(high))
            })
    }

    /// The total variation of S: the sum of |S(t_{i+1}) - S(t_i)|.
    pub fn variation(&self) -> f64 {
        self.values
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs())
            .sum()
    }

    /// The median time between two samples; of two middle ones the longer.
    pub fn usual_spacing(&self) -> f64 {
        usual_spacing(&self.times)
    }

    /// The longest time between two samples.
    pub fn longest_spacing(&self) -> f64 {
        self.times
            .windows(2)
            .fold(0.0, |longest, pair| (pair[1] - pair[0]).max(longest))
    }

    /// A number that identifies the series: FNV-1a over the bits of all samples. Another series has
    /// the same number with a probability of 2^-64.
    pub fn fingerprint(&self) -> u64 {
        let numbers = self.times.iter().chain(&self.values);
        let bytes = numbers.flat_map(|x| x.to_bits().to_le_bytes());
        fnv1a(bytes)
    }
}

/// FNV-1a of these bytes, a number that identifies them.
pub(crate) fn fnv1a(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// The time at which the line that stands for a jump begins: four roundings before it.
pub(crate) fn before(time: f64) -> f64 {
    time - 9e-16 * time
}

/// Whether two times are the ends of a jump.
pub fn is_jump(pair: &[f64]) -> bool {
    pair[1] - pair[0] < 1e-14 * pair[1]
}

/// The median time between two of these, at least two, without jumps; of two middle ones the longer.
pub fn usual_spacing(times: &[f64]) -> f64 {
    let pairs = times.windows(2).filter(|pair| !is_jump(pair));
    let mut spacings: Vec<f64> = pairs.map(|pair| pair[1] - pair[0]).collect();
    let middle = spacings.len() / 2;
    *spacings.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series() -> Series {
        Series::new(vec![0.0, 1.0, 3.0, 4.0], vec![2.0, -1.0, 5.0, 5.0]).unwrap()
    }

    #[test]
    fn samples_are_joined_by_straight_lines() {
        let series = series();
        for (t, value) in [
            (0.0, 2.0),
            (0.5, 0.5),
            (1.0, -1.0),
            (2.0, 2.0),
            (3.0, 5.0),
            (3.5, 5.0),
            (4.0, 5.0),
        ] {
            assert_eq!(series.at(t), value, "{t}");
        }
        assert_eq!(
            [0.0, 0.9, 1.0, 3.0, 4.0, 9.0].map(|t| series.piece(t)),
            [0, 0, 1, 2, 2, 2]
        );
        assert_eq!(
            (series.bound(), series.steepest(), series.range()),
            (5.0, 3.0, (-1.0, 5.0))
        );
        assert_eq!(
            (series.variation(), series.end(), series.extremes()),
            (9.0, 4.0, [1.0, 3.0])
        );
    }

    #[test]
    fn every_sample_leaves_its_mark_on_the_fingerprint() {
        let mut marks = vec![series().fingerprint()];
        for i in 0..4 {
            let mut other = series();
            other.values[i] = other.values[i].next_up();
            marks.push(other.fingerprint());
        }
        marks.push(
            Series::new(vec![0.0, 1.0, 3.0, 4.5], vec![2.0, -1.0, 5.0, 5.0])
                .unwrap()
                .fingerprint(),
        );
        let distinct: std::collections::BTreeSet<u64> = marks.iter().copied().collect();
        assert_eq!(distinct.len(), marks.len());
        // The same hash computed independently: FNV-1a of sixteen zero bytes and the bits of 1.0
        // and 0.0 (0x3ff0000000000000, little-endian), in the order of the samples.
        let two = Series::new(vec![0.0, 1.0], vec![0.0, 0.0]).unwrap();
        let bytes = [[0; 8], [0, 0, 0, 0, 0, 0, 0xf0, 0x3f], [0; 8], [0; 8]].concat();
        let prime = 1_099_511_628_211_u128;
        let hash = bytes
            .iter()
            .fold(14_695_981_039_346_656_037_u128, |hash, byte| {
                ((hash ^ byte) * prime) % (1 << 64)
            });
        assert_eq!(u128::from(two.fingerprint()), hash);
    }

    #[test]
    fn what_is_no_series_is_refused() {
        for (times, values) in [
            (vec![0.0], vec![1.0]),
            (vec![1.0, 2.0], vec![1.0, 1.0]),
            (vec![0.0, 0.0], vec![1.0, 1.0]),
            (vec![0.0, 1.0], vec![1.0]),
            (vec![0.0, 1.0], vec![1.0, f64::NAN]),
            (vec![0.0, f64::INFINITY], vec![1.0, 1.0]),
        ] {
            assert_eq!(Series::new(times, values), Err(NoSeries));
        }
    }
}
