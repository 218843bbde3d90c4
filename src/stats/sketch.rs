//! The distribution of a quantity in a fixed, mergeable number of bins.
//!
//! A value v is counted in a bin of |v - c| + s: the top eight bits of the mantissa of a floating-point number and its
//! exponent, so bins are evenly spaced below the scale s and logarithmic above it. Counts are integers, hence merging
//! is exact and order does not matter; a mean of quantiles never arises.

use super::codec::{Codec, Damaged, Reader};

/// Mantissa bits that tell bins apart: 256 bins to an octave, few enough for the bins of hundreds of rows to stay in a
/// processor's cache.
const MANTISSA_BITS: u32 = 8;

/// How far an f64 is shifted to leave its exponent and `MANTISSA_BITS` of its mantissa.
const SHIFT: u32 = 52 - MANTISSA_BITS;

/// The last bin of either sign, 128 octaves out. It also counts everything beyond.
const LAST_KEY: i16 = i16::MAX;

/// A value lies within this share of |v - c| + s of any other value in its bin.
#[cfg(test)]
pub(super) const BIN_WIDTH: f64 = 1.0 / (1 << MANTISSA_BITS) as f64;

/// Where the bins of a quantity lie.
///
/// A quantile read off the bins is wrong by at most 2^-8 (|v - c| + s), and by far less where the density is smooth within
/// a bin. The value v = c has a bin of its own, so an atom there (a path that has not moved, a velocity of zero) is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    centre: f64,
    /// s, a power of two: the octaves of |v - c| + s then begin at bin edges.
    scale: f64,
    /// Lower edge of the last bin, in |v - c| + s.
    limit: f64,
}

impl Grid {
    /// Bins about `centre`, evenly spaced up to about `scale` from it.
    pub fn new(centre: f64, scale: f64) -> Self {
        // Far from both ends of the number range, so that s 2^-8 is not subnormal and s 2^128 is finite.
        let (smallest, largest) = (2f64.powi(-800), 2f64.powi(800));
        let scale = if scale > 0.0 { scale.clamp(smallest, largest) } else { 1.0 };
        let scale = f64::from_bits(scale.to_bits() & (0x7ff << 52));
        let limit = f64::from_bits(scale.to_bits() + ((LAST_KEY as u64 - 1) << SHIFT));
        Grid { centre, scale, limit }
    }

    /// The bin of a value; increases with it. 0 is the value `centre` itself.
    #[inline]
    pub fn key(&self, value: f64) -> i16 {
        let distance = value - self.centre;
        let shifted = distance.abs() + self.scale;
        let shifted = if shifted < self.limit { shifted } else { self.limit };
        let magnitude = ((shifted.to_bits() - self.scale.to_bits()) >> SHIFT) as i16 + 1;
        // No branch and no product, so that a row is done in vectors.
        let sign = (distance.to_bits() >> 63) as i16;
        let moved = i16::from(distance != 0.0);
        ((magnitude ^ -sign) + sign) & -moved
    }

    /// Lower and upper edge of a bin.
    pub fn bin(&self, key: i16) -> (f64, f64) {
        let magnitude = i32::from(key).abs();
        if magnitude == 0 {
            return (self.centre, self.centre);
        }
        let (near, far) = (self.distance(magnitude - 1), self.distance(magnitude));
        if key > 0 { (self.centre + near, self.centre + far) } else { (self.centre - far, self.centre - near) }
    }

    /// Distance from the centre of the edge between bins `edge` and `edge + 1`.
    pub fn distance(&self, edge: i32) -> f64 {
        f64::from_bits(self.scale.to_bits() + ((edge as u64) << SHIFT)) - self.scale
    }
}

/// How many keys are kept as they are before they are counted. A block then leaves two bytes a value, a small ensemble
/// never allocates bins, and a large one brings the bins of a row into the cache once for many blocks.
const PENDING_LIMIT: usize = 2048;

/// Bins are allocated in multiples of this many.
const PAGE: i32 = 64;

/// Counts by bin.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Sketch {
    /// Keys not yet counted, in the order they came.
    pending: Vec<i16>,
    /// The key of `counts[0]`.
    first: i32,
    /// How many of the other values have each key, from `first` on.
    counts: Vec<u64>,
}

impl Sketch {
    /// The sketch of all values.
    pub fn of(values: &[f64], grid: &Grid) -> Self {
        let grid = *grid;
        Sketch { pending: values.iter().map(|&v| grid.key(v)).collect(), first: 0, counts: Vec::new() }
    }

    /// Count one value.
    #[inline]
    pub fn push(&mut self, key: i16) {
        self.pending.push(key);
        if self.pending.len() >= PENDING_LIMIT {
            self.count_pending();
        }
    }

    /// Count the values that `other` counts.
    pub fn merge(&mut self, other: &Sketch) {
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

    /// The bins that are not empty, with their counts, in order.
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

    /// The bins from key `low` on, up to `high` at least.
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

/// The bins that are not empty, as the distance of each key from the one before it, and its count.
impl Codec for Sketch {
    fn write(&self, out: &mut Vec<u8>) {
        let bins = self.bins();
        (bins.len() as u64).write(out);
        let mut before = i32::from(-LAST_KEY) - 1;
        for (key, count) in bins {
            ((i32::from(key) - before) as u64).write(out);
            count.write(out);
            before = key.into();
        }
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        *self = Sketch::default();
        let mut key = i64::from(-LAST_KEY) - 1;
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

/// The quantile of order p, 0 <= p <= 1, of values counted in `bins`: between the order statistics either side of
/// rank p (n - 1), each placed by its rank within its bin. NaN if there are no values.
///
/// The smallest and largest value are known exactly; no quantile lies outside them.
pub(super) fn quantile(bins: &[(i16, u64)], grid: &Grid, extremes: (f64, f64), p: f64) -> f64 {
    let n: u64 = bins.iter().map(|(_, count)| count).sum();
    if n == 0 {
        return f64::NAN;
    }
    let rank = p * (n - 1) as f64;
    let below = order_statistic(bins, grid, rank.floor() as u64);
    let above = order_statistic(bins, grid, rank.ceil() as u64);
    let value = below + (above - below) * rank.fract();
    value.max(extremes.0).min(extremes.1)
}

/// The value of rank 0 <= `rank` < n, in the middle of its share of the bin.
fn order_statistic(bins: &[(i16, u64)], grid: &Grid, rank: u64) -> f64 {
    let mut before = 0;
    for &(key, count) in bins {
        if rank < before + count {
            let (low, high) = grid.bin(key);
            return low + (high - low) * ((rank - before) as f64 + 0.5) / count as f64;
        }
        before += count;
    }
    f64::NAN
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand_distr::{Distribution, Normal};
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::SeedableRng;

    fn extremes(values: &[f64]) -> (f64, f64) {
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)))
    }

    fn of_values(values: &[f64], grid: &Grid, p: f64) -> f64 {
        quantile(&Sketch::of(values, grid).bins(), grid, extremes(values), p)
    }

    /// Hyndman and Fan's definition 7, from the sorted values.
    fn exact(values: &[f64], p: f64) -> f64 {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let rank = p * (sorted.len() - 1) as f64;
        let (below, above) = (sorted[rank.floor() as usize], sorted[rank.ceil() as usize]);
        below + (above - below) * rank.fract()
    }

    proptest! {
        #[test]
        fn a_value_lies_in_its_bin_and_bins_are_as_narrow_as_promised(
            value in prop_oneof![-1e3..1e3f64, -1e-6..1e-6f64, -1e10..1e10f64],
            centre in -2.0..2.0f64,
            scale in prop_oneof![Just(1e-8), Just(0.3), Just(7.0)],
        ) {
            let grid = Grid::new(centre, scale);
            let (low, high) = grid.bin(grid.key(value));
            // |v - c| + s is rounded once: a value within one ulp of that of an edge may be counted on its other side.
            let ulp = f64::EPSILON * ((value - centre).abs() + grid.scale + centre.abs());
            prop_assert!(low - ulp <= value && value <= high + ulp, "{value} not in {low}..{high}");
            prop_assert!(high - low <= BIN_WIDTH * ((value - centre).abs() + grid.scale) + 2.0 * ulp);
        }

        #[test]
        fn keys_increase_with_the_value(a in -1e4..1e4f64, b in -1e4..1e4f64) {
            let grid = Grid::new(0.5, 0.25);
            let (small, large) = if a <= b { (a, b) } else { (b, a) };
            prop_assert!(grid.key(small) <= grid.key(large));
        }

        #[test]
        fn quantiles_are_within_a_bin_of_the_exact_ones(
            values in prop::collection::vec(prop_oneof![-50.0..50.0f64, Just(0.0), Just(6.0), Just(-1.25)], 1..400),
            p in 0.0..=1.0f64,
        ) {
            let grid = Grid::new(6.0, 2.0);
            let (sketched, exact) = (of_values(&values, &grid, p), exact(&values, p));
            // Both order statistics around p are within their own bin, and the wider of the two is that of the larger.
            let largest = values.iter().fold(0.0f64, |m, v| m.max((v - 6.0).abs()));
            let bound = BIN_WIDTH * ((exact - 6.0).abs() + 2.0);
            let across_a_gap = BIN_WIDTH * (largest + 2.0);
            let continuous = (p * (values.len() - 1) as f64).fract() == 0.0;
            let tolerance = if continuous { bound } else { across_a_gap };
            prop_assert!((sketched - exact).abs() <= tolerance, "{} {}", sketched, exact);
        }

        #[test]
        fn merging_in_any_grouping_counts_the_same(
            values in prop::collection::vec(-100.0..100.0f64, 0..9000),
            block in 1usize..3000,
        ) {
            let grid = Grid::new(0.0, 1.0);
            let whole = Sketch::of(&values, &grid);
            let (mut forward, mut backward, mut single) = (Sketch::default(), Sketch::default(), Sketch::default());
            values.chunks(block).for_each(|c| forward.merge(&Sketch::of(c, &grid)));
            values.rchunks(block).for_each(|c| backward.merge(&Sketch::of(c, &grid)));
            values.iter().for_each(|&v| single.push(grid.key(v)));
            let mut halves = [Sketch::default(), Sketch::default()];
            values.iter().enumerate().for_each(|(i, &v)| halves[i % 2].push(grid.key(v)));
            let [mut left, right] = halves;
            left.merge(&right);
            prop_assert_eq!(left.bins(), whole.bins());
            prop_assert_eq!(forward.bins(), whole.bins());
            prop_assert_eq!(backward.bins(), whole.bins());
            prop_assert_eq!(single.bins(), whole.bins());
        }
    }

    #[test]
    fn normal_quantiles_of_a_large_sample_are_those_of_the_sorted_sample() {
        // The sample is shared, so no sampling error enters: the stated bin width is the whole tolerance.
        let mut rng = Pcg64Dxsm::seed_from_u64(7);
        let normal = Normal::new(3.0, 0.5).unwrap();
        let values: Vec<f64> = (0..50_000).map(|_| normal.sample(&mut rng)).collect();
        let grid = Grid::new(0.0, 1.0);
        for p in [0.05, 0.25, 0.5, 0.75, 0.95] {
            let (sketched, exact) = (of_values(&values, &grid, p), exact(&values, p));
            assert!((sketched - exact).abs() <= BIN_WIDTH * (exact.abs() + 1.0), "{p}: {sketched} {exact}");
        }
    }

    #[test]
    fn quantiles_of_a_smooth_density_are_much_closer_than_a_bin() {
        // 100 000 even values in 0..10: hundreds in a bin, evenly spread in it, so placing them by rank is off by about
        // one spacing; a tenth of the narrowest bin is allowed, sixteen spacings.
        let values: Vec<f64> = (0..100_000).map(|i| (f64::from(i) + 0.3) * 1e-4).collect();
        let grid = Grid::new(0.0, 4.0);
        for i in 0..=100 {
            let p = f64::from(i) / 100.0;
            let (sketched, exact) = (of_values(&values, &grid, p), exact(&values, p));
            assert!((sketched - exact).abs() <= 0.1 * BIN_WIDTH * 4.0, "{p}: {sketched} {exact}");
        }
    }

    #[test]
    fn atoms_at_the_centre_and_equal_values_are_exact() {
        let grid = Grid::new(6.0, 3.0);
        let mut values = vec![6.0; 60];
        values.extend((0..40).map(|i| i as f64));
        assert_eq!(of_values(&values, &grid, 0.5), 6.0);
        assert_eq!(of_values(&vec![0.1; 300], &grid, 0.25), 0.1);
    }

    #[test]
    fn absurd_values_are_counted_at_the_ends() {
        let grid = Grid::new(0.0, 1.0);
        assert_eq!(grid.key(1e300), i16::MAX);
        assert_eq!(grid.key(f64::NEG_INFINITY), -i16::MAX);
        assert_eq!(grid.key(f64::NAN).abs(), i16::MAX);
        for scale in [0.0, f64::NAN, 1e-320, 1e308] {
            let grid = Grid::new(0.0, scale);
            assert_eq!((grid.key(0.0), grid.key(1.5 * grid.scale) > 0), (0, true), "{scale}");
        }
    }
}
