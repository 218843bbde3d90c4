//! Durations in fixed bins, for histograms and survival curves. The width of a bin is a constant
//! share of its durations.
//!
//! The bin of a duration d is given by the exponent and the top eight bits of the mantissa of d + s
//! as a floating-point number. So bins are evenly spaced below the scale s and logarithmic above
//! it. Counts are integers, so merging is exact and order does not matter.

use super::codec::{Codec, Damaged, Reader};

/// Number of mantissa bits that distinguish bins, which gives 256 bins per octave.
const MANTISSA_BITS: u32 = 8;

/// Shifting an f64 by so many bits leaves its exponent and `MANTISSA_BITS` of its mantissa.
const SHIFT: u32 = 52 - MANTISSA_BITS;

/// The last bin, 128 octaves from the first. It also counts all longer durations.
const LAST_KEY: i16 = i16::MAX;

/// The edges of the bins. Bin 0 holds durations of zero and nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LogGrid {
    /// s, a power of two, so that the octaves of d + s begin at edges of bins.
    scale: f64,
    /// Lower edge of the last bin, in d + s.
    limit: f64,
}

impl LogGrid {
    /// A grid whose bins are evenly spaced up to about `scale`.
    pub fn new(scale: f64) -> Self {
        // The scale stays far from both ends of the number range, so that s 2^-8 is not subnormal
        // and s 2^128 is finite.
        let (smallest, largest) = (2f64.powi(-800), 2f64.powi(800));
        let scale = if scale > 0.0 { scale.clamp(smallest, largest) } else { 1.0 };
        let scale = f64::from_bits(scale.to_bits() & (0x7ff << 52));
        let limit = f64::from_bits(scale.to_bits() + ((LAST_KEY as u64 - 1) << SHIFT));
        LogGrid { scale, limit }
    }

    /// The bin of a duration; it increases with the duration.
    #[inline]
    pub fn key(&self, duration: f64) -> i16 {
        if duration.is_nan() || duration <= 0.0 {
            return 0;
        }
        let shifted = (duration + self.scale).min(self.limit);
        ((shifted.to_bits() - self.scale.to_bits()) >> SHIFT) as i16 + 1
    }

    /// The duration at the edge between bins `edge` and `edge + 1`.
    pub fn edge(&self, edge: i32) -> f64 {
        f64::from_bits(self.scale.to_bits() + ((edge as u64) << SHIFT)) - self.scale
    }
}

/// This many keys are stored before they are counted, so that a block or a small ensemble allocates
/// no bins.
const PENDING_LIMIT: usize = 2048;

/// Bins are allocated in multiples of this many.
const PAGE: i32 = 64;

/// Durations counted by bin.
#[derive(Clone, Debug, Default)]
pub(crate) struct LogBins {
    /// Keys that are not counted yet, in the order in which they came.
    pending: Vec<i16>,
    /// The key of `counts[0]`.
    first: i32,
    /// The number of the other durations with each key, from `first` on.
    counts: Vec<u64>,
}

impl LogBins {
    /// Count one duration, given its bin.
    #[inline]
    pub fn push(&mut self, key: i16) {
        self.pending.push(key);
        if self.pending.len() >= PENDING_LIMIT {
            self.count_pending();
        }
    }

    /// Count the durations that `other` counts.
    pub fn merge(&mut self, other: &LogBins) {
        if self.pending.len() + other.pending.len() > PENDING_LIMIT {
            self.count_pending();
        }
        self.pending.extend_from_slice(&other.pending);
        if !other.counts.is_empty() {
            let mine = self.bins_covering(other.first, other.first + other.counts.len() as i32 - 1);
            for (mine, more) in mine.iter_mut().zip(&other.counts) {
                *mine += more;
            }
        }
    }

    /// The bins that are not empty with their counts, in ascending order.
    pub fn bins(&self) -> Vec<(i16, u64)> {
        let mut all = self.clone();
        all.count_pending();
        let keyed = all.counts.iter().enumerate().filter(|(_, count)| **count > 0);
        keyed.map(|(i, count)| ((all.first + i as i32) as i16, *count)).collect()
    }

    fn count_pending(&mut self) {
        let mut keys = std::mem::take(&mut self.pending);
        let (low, high) = keys.iter().fold((i16::MAX, i16::MIN), |(l, h), &key| (l.min(key), h.max(key)));
        if low <= high {
            let counts = self.bins_covering(low.into(), high.into());
            for &key in &keys {
                counts[(i32::from(key) - i32::from(low)) as usize] += 1;
            }
        }
        keys.clear();
        self.pending = keys;
    }

    /// The counts of the bins from key `low` on, at least up to key `high`.
    fn bins_covering(&mut self, low: i32, high: i32) -> &mut [u64] {
        let page = low.div_euclid(PAGE) * PAGE;
        if self.counts.is_empty() {
            self.first = page;
        }
        if page < self.first {
            self.counts.splice(0..0, std::iter::repeat_n(0, (self.first - page) as usize));
            self.first = page;
        }
        let length = ((high.div_euclid(PAGE) + 1) * PAGE - self.first) as usize;
        if length > self.counts.len() {
            self.counts.resize(length, 0);
        }
        &mut self.counts[(low - self.first) as usize..]
    }
}

impl PartialEq for LogBins {
    fn eq(&self, other: &Self) -> bool {
        self.bins() == other.bins()
    }
}

/// Bytes hold each bin that is not empty: the distance of its key from the one before it, and its
/// count.
impl Codec for LogBins {
    fn write(&self, out: &mut Vec<u8>) {
        let bins = self.bins();
        (bins.len() as u64).write(out);
        let mut before = -1;
        for (key, count) in bins {
            ((i32::from(key) - before) as u64).write(out);
            count.write(out);
            before = key.into();
        }
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        *self = LogBins::default();
        let mut key = -1_i64;
        for _ in 0..from.length()? {
            let (mut distance, mut count) = (0_u64, 0_u64);
            distance.read(from)?;
            count.read(from)?;
            key = i64::try_from(distance).ok().and_then(|distance| key.checked_add(distance)).ok_or(Damaged)?;
            if distance == 0 || count == 0 || key > LAST_KEY.into() {
                return Err(Damaged);
            }
            self.bins_covering(key as i32, key as i32)[0] = count;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_duration_lies_in_its_bin_and_bins_are_as_narrow_as_promised(
            duration in prop_oneof![0.0..1e3f64, 0.0..1e-6f64, 0.0..1e10f64],
            scale in prop_oneof![Just(1e-8), Just(0.3), Just(7.0)],
        ) {
            let grid = LogGrid::new(scale);
            let key = i32::from(grid.key(duration));
            let (low, high) = (grid.edge((key - 1).max(0)), grid.edge(key));
            // d + s is rounded once, so that a duration within one rounding of an edge may be
            // counted on the other side of it.
            let ulp = f64::EPSILON * (duration + grid.scale);
            prop_assert!(low - ulp <= duration && duration <= high + ulp, "{duration} not in {low}..{high}");
            prop_assert!(high - low <= (duration + grid.scale) / 256.0 + 2.0 * ulp);
        }

        #[test]
        fn merging_in_any_grouping_counts_the_same(
            durations in prop::collection::vec(0.0..100.0f64, 0..9000),
            block in 1usize..3000,
        ) {
            let grid = LogGrid::new(1.0);
            let of = |durations: &[f64]| {
                let mut bins = LogBins::default();
                durations.iter().for_each(|&d| bins.push(grid.key(d)));
                bins
            };
            let whole = of(&durations);
            let (mut forward, mut backward) = (LogBins::default(), LogBins::default());
            durations.chunks(block).for_each(|c| forward.merge(&of(c)));
            durations.rchunks(block).for_each(|c| backward.merge(&of(c)));
            prop_assert_eq!(forward.bins(), whole.bins());
            prop_assert_eq!(backward.bins(), whole.bins());
        }
    }

    #[test]
    fn absurd_durations_are_counted_at_the_end() {
        assert_eq!(LogGrid::new(1.0).key(1e300), i16::MAX);
        for scale in [0.0, f64::NAN, 1e-320, 1e308] {
            let grid = LogGrid::new(scale);
            assert_eq!((grid.key(0.0), grid.key(1.5 * grid.scale) > 0), (0, true), "{scale}");
        }
    }
}
