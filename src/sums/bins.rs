//! Counts of values in bins of the dyadic lattice, at the finest level at which no more than a
//! given number of bins are occupied.
//!
//! An added value never reduces the number of occupied bins of a level. So the level only rises,
//! and the level of two merged parts follows from the parts. Level and counts ([`Bins::list`]) are
//! therefore functions of the values alone, and do not depend on the order, the grouping and the
//! number of steps in which the values came. Only the layout of the counts in memory depends on
//! them: bins that are close together are slots of an array, and the few others are entries of a
//! list.

use super::codec::{Codec, Damaged, Reader};
use super::dyadic::{List, MAX_INDEX, Ruler, coarsen, counted, excess, exponent, finest, union};
use super::log_scale::{LogScale, OCTAVES};
use crate::lanes::{InstructionSet, LaneProgram, Lanes};

/// The centre of a sketch, and how much the sketch may hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shape {
    /// A value that many paths may share: it has a bin of its own at every level. It is 0 where
    /// there is a scale.
    pub centre: f64,
    /// If there is one, its places are counted instead of the values themselves.
    pub scale: Option<LogScale>,
    /// Up to this many values are kept one by one, besides any number of values at the centre.
    pub values: usize,
    /// Beyond that, values are counted in up to this many bins; not more than `values`.
    pub bins: usize,
}

/// The largest number of arrays of slots. Values in further clusters are counted in the list, which
/// is slower.
const MAX_RUNS: usize = 4;

/// The longest gap of empty bins within an array. A longer gap ends the array.
const LONGEST_GAP: i64 = 256;

/// Number of slots beyond either end of an array, which are there for later values.
const MARGIN: i64 = 32;

/// Limit for the total length of all clusters, in slots per bin that may be occupied.
const AFFORDED: i64 = 4;

/// Number of values whose slots are computed together.
const CHUNK: usize = 64;

/// If more than one in this many added values lies outside all arrays, the arrays are laid out
/// anew.
const ONE_OUTSIDE_IN: usize = 8;

/// Consecutive bins, from `first` on, in the slots `slot .. slot + length`.
#[derive(Clone, Copy, Debug)]
struct BinRun {
    first: i64,
    length: i64,
    slot: usize,
}

/// Counts of values that are more than `Shape::values`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bins {
    pub level: i32,
    pub smallest: f64,
    pub largest: f64,
    /// Ordered by their counts when they were laid out, the fullest first.
    runs: Vec<BinRun>,
    slots: Vec<u16>,
    /// How many more values may be counted before a slot can be full.
    free_counts: usize,
    /// How many values have been counted since the occupied bins were last counted.
    counted_since_check: usize,
    /// Bins outside the runs, and counts that are too large for a slot.
    listed: List,
}

/// A count with the highest bit set. The slots are laid out anew before such a slot counts further.
/// A single call counts at most [`MOST_AT_ONCE`] values, so that no slot overflows.
const FULL: u16 = 1 << 15;

/// The largest number of values that may be counted in one call.
pub(crate) const MOST_AT_ONCE: usize = FULL as usize;

/// With up to this many slots per value to be counted, all slots are read first.
const SPARSE: usize = 16;

impl Bins {
    /// The bins of these values, of which there is at least one. All must be at a finite distance
    /// from the centre.
    pub fn of(values: &[f64], shape: &Shape) -> Self {
        let (smallest, largest) = extremes(values);
        let lowest = shape.lowest_level(smallest, largest);
        // First try a single array over all values. If more than `shape.bins` of its slots are
        // taken, then that also holds at any finer level.
        let slots = (8 * shape.bins) as f64;
        let level = lowest.max(exponent(largest / slots - smallest / slots) + 1);
        let taken = Taken::by(values, (smallest, largest), &Ruler::new(shape.centre, level));
        let (level, list) = if level == lowest || taken.count(0) > shape.bins as u32 {
            let level = level + (0..GROUPS.len()).find(|&up| taken.count(up) <= shape.bins as u32).unwrap_or(0) as i32;
            let ruler = Ruler::new(shape.centre, level);
            let [first, last] = [smallest, largest].map(|value| ruler.index(value) as i64);
            let mut slots = vec![0; (last - first + 1) as usize];
            count_slots(&[values], &ruler, first, &mut slots);
            (level, filled(first, &slots))
        } else {
            // The values form clusters, or there is an outlier: start from the lowest level.
            let ruler = Ruler::new(shape.centre, lowest);
            (lowest, counted(values.iter().map(|&value| ruler.index(value) as i64).collect()))
        };
        let mut bins = Bins { level, smallest, largest, ..Bins::default() };
        bins.lay_out(list, shape.bins);
        bins
    }

    /// Count up to [`MOST_AT_ONCE`] more values, which come in parts. Values that are not at a
    /// finite distance from the centre are left out.
    pub fn count(&mut self, parts: &[&[f64]], shape: &Shape) {
        let number = parts.iter().map(|part| part.len()).sum();
        // The slots are so short that those of hundreds of rows stay in a cache. Where there are
        // many values to be counted, reading all slots in order brings them into the nearest cache
        // faster than the scattered accesses of counting would.
        if self.free_counts < number || self.slots.len() <= SPARSE * number {
            let fullest = fullest_slot(&self.slots);
            self.free_counts = FULL.saturating_sub(fullest).into();
            if fullest >= FULL {
                self.lay_out(self.list(), shape.bins);
            }
        }
        self.free_counts = self.free_counts.saturating_sub(number);
        let mut others = self.count_inside(parts, &Ruler::new(shape.centre, self.level));
        others.retain(|value| (value - shape.centre).is_finite());
        let (smallest, largest) = extremes(&others);
        self.extend_to(smallest, largest, shape);
        let is_scattered =
            self.count_anywhere(&others, &Ruler::new(shape.centre, self.level)) > number / ONE_OUTSIDE_IN;
        self.counted_since_check += number;
        if is_scattered || self.counted_since_check >= shape.values {
            self.normalise(shape.bins, is_scattered && self.level > shape.lowest_level(self.smallest, self.largest));
        }
    }

    /// Count this many values at the centre.
    pub fn count_at_centre(&mut self, number: u64, shape: &Shape) {
        if number > 0 {
            self.extend_to(shape.centre + 0.0, shape.centre + 0.0, shape);
            self.listed = union(&self.listed, &[(0, number)]);
        }
    }

    /// Rise to the level that the number of occupied bins requires. Between two calls, more bins
    /// than `limit` may be occupied.
    pub fn normalise(&mut self, limit: usize, is_scattered: bool) {
        self.counted_since_check = 0;
        if is_scattered || self.occupied(limit) > limit {
            self.lay_out(self.list(), limit);
        }
    }

    /// Whether nothing was counted since the occupied bins were last counted.
    pub fn is_normalised(&self) -> bool {
        self.counted_since_check == 0
    }

    /// Add the counts of `other`.
    pub fn merge(&mut self, other: &Bins, shape: &Shape) {
        self.extend_to(other.smallest, other.largest, shape);
        self.rise_to(other.level, shape.bins);
        let theirs = coarsen(&other.list(), (self.level - other.level) as u32);
        self.lay_out(union(&self.list(), &theirs), shape.bins);
    }

    /// The occupied bins with their counts, in ascending order.
    pub fn list(&self) -> List {
        let mut list = self.listed.clone();
        for run in &self.runs {
            let slots = &self.slots[run.slot..run.slot + run.length as usize];
            let filled = filled(run.first, slots);
            // The margins of two runs may overlap, so that both may have counted a bin.
            list = if list.is_empty() { filled } else { union(&list, &filled) };
        }
        list
    }

    /// Extend the extremes to these two values, and rise to the level that they require.
    fn extend_to(&mut self, smallest: f64, largest: f64, shape: &Shape) {
        self.smallest = self.smallest.min(smallest);
        self.largest = self.largest.max(largest);
        self.rise_to(shape.lowest_level(self.smallest, self.largest), shape.bins);
    }

    fn rise_to(&mut self, level: i32, limit: usize) {
        if level > self.level {
            let list = coarsen(&self.list(), (level - self.level) as u32);
            self.level = level;
            self.lay_out(list, limit);
        }
    }

    /// The number of occupied bins. Where an upper bound of it is not above `limit`, that bound is
    /// returned instead, because it takes no counting.
    fn occupied(&self, limit: usize) -> usize {
        if self.listed.len() + self.slots.len() <= limit {
            return self.listed.len() + self.slots.len();
        }
        self.listed.len() + self.slots.iter().map(|&count| u32::from(count > 0)).sum::<u32>() as usize
    }

    /// Count the values that lie in the first run, which is the fullest, and are surely not new
    /// extremes. Returns the other values.
    fn count_inside(&mut self, parts: &[&[f64]], ruler: &Ruler) -> Vec<f64> {
        // The bin of an extreme may hold values beyond it. Only bin 0 cannot, because it holds a
        // single value.
        let [lowest, highest] = [self.smallest, self.largest].map(|value| ruler.index(value) as i64);
        let (lowest, highest) = (lowest + i64::from(lowest != 0), highest - i64::from(highest != 0));
        let run = self.runs.first().copied().unwrap_or(BinRun { first: 0, length: 0, slot: 0 });
        let first = run.first.max(lowest);
        let length = ((run.first + run.length).min(highest + 1) - first).max(0) as usize;
        let start = run.slot + (first - run.first) as usize;
        count_slots(parts, ruler, first, self.slots.get_mut(start..start + length).unwrap_or_default())
    }

    /// Count values, whether or not they lie in a run. Returns how many of them lie outside all
    /// runs.
    fn count_anywhere(&mut self, values: &[f64], ruler: &Ruler) -> usize {
        let mut missed = Vec::new();
        for &value in values {
            let index = ruler.index(value) as i64;
            match self.runs.iter().find_map(|run| run.slot_of(index)) {
                Some(slot) => self.slots[slot] += 1,
                None => missed.push(index),
            }
        }
        let number = missed.len();
        if number > 0 {
            self.listed = union(&self.listed, &counted(missed));
        }
        number
    }

    /// Replace all counts by this list of bins of the present level, and rise by as many levels as
    /// the number of bins requires.
    fn lay_out(&mut self, list: List, limit: usize) {
        let levels = excess(&list, limit);
        let list = if levels > 0 { coarsen(&list, levels) } else { list };
        self.level += levels as i32;
        self.runs.clear();
        self.listed.clear();
        let mut length = 0;
        for cluster in fullest(clusters(&list, limit)) {
            let run = BinRun { first: cluster.first - MARGIN, length: cluster.length + 2 * MARGIN, slot: length };
            length += run.length as usize;
            self.runs.push(run);
        }
        self.slots = vec![0; length];
        for (index, count) in list {
            match self.runs.iter().find_map(|run| run.slot_of(index)).filter(|_| count < FULL.into()) {
                Some(slot) => self.slots[slot] = count as u16,
                None => self.listed.push((index, count)),
            }
        }
        self.free_counts = FULL.saturating_sub(fullest_slot(&self.slots)).into();
    }
}

impl Shape {
    /// The finest level that is used for values between these extremes.
    fn lowest_level(&self, smallest: f64, largest: f64) -> i32 {
        finest((smallest - self.centre).abs().max((largest - self.centre).abs()))
    }

    /// The place of a value on the scale, or its distance from the centre.
    pub fn place(&self, value: f64) -> f64 {
        self.scale.map_or(value - self.centre, |scale| scale.place(value))
    }

    /// The value at this place.
    pub fn value(&self, place: f64) -> f64 {
        self.scale.map_or(self.centre + place, |scale| scale.number(place))
    }
}

impl BinRun {
    #[inline]
    fn slot_of(&self, index: i64) -> Option<usize> {
        let offset = index.wrapping_sub(self.first);
        (0..self.length).contains(&offset).then(|| self.slot + offset as usize)
    }
}

/// Occupied bins that lie close together.
struct Cluster {
    first: i64,
    length: i64,
    count: u64,
}

/// Split the bins at long gaps. The longest gap within a cluster is halved until all clusters
/// together have no more than [`AFFORDED`] slots per bin that may be occupied.
fn clusters(list: &[(i64, u64)], limit: usize) -> Vec<Cluster> {
    let mut gap = LONGEST_GAP;
    loop {
        let mut clusters: Vec<Cluster> = Vec::new();
        for &(index, count) in list {
            match clusters.last_mut() {
                Some(last) if index - (last.first + last.length) <= gap => {
                    last.length = index - last.first + 1;
                    last.count += count;
                }
                _ => clusters.push(Cluster { first: index, length: 1, count }),
            }
        }
        // If no gap is longer than one, there are fewer than two slots per occupied bin.
        if gap == 1 || clusters.iter().map(|cluster| cluster.length).sum::<i64>() <= AFFORDED * limit as i64 {
            return clusters;
        }
        gap /= 2;
    }
}

/// The clusters with the most values, the fullest first.
fn fullest(mut clusters: Vec<Cluster>) -> Vec<Cluster> {
    clusters.sort_by_key(|cluster| std::cmp::Reverse(cluster.count));
    clusters.truncate(MAX_RUNS);
    clusters
}

/// Count values in the slots of the bins from `first` on. Returns the values that have no slot.
fn count_slots(parts: &[&[f64]], ruler: &Ruler, first: i64, slots: &mut [u16]) -> Vec<f64> {
    let mut count = CountSlots { parts, ruler, first, slots, others: Vec::new() };
    InstructionSet::detect().run(&mut count);
    count.others
}

/// See [`count_slots`].
struct CountSlots<'a> {
    parts: &'a [&'a [f64]],
    ruler: &'a Ruler,
    first: i64,
    slots: &'a mut [u16],
    others: Vec<f64>,
}

impl LaneProgram for CountSlots<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        self.count();
    }
}

/// The greatest count of a slot.
fn fullest_slot(slots: &[u16]) -> u16 {
    let mut fullest = FullestSlot { slots, count: 0 };
    InstructionSet::detect().run(&mut fullest);
    fullest.count
}

/// See [`fullest_slot`].
struct FullestSlot<'a> {
    slots: &'a [u16],
    count: u16,
}

impl LaneProgram for FullestSlot<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let mut most = 0;
        for &slot in self.slots {
            most = if slot > most { slot } else { most };
        }
        self.count = most;
    }
}

impl CountSlots<'_> {
    #[inline(always)]
    fn count(&mut self) {
        let CountSlots { parts, ruler, first, slots, others } = self;
        // From 2^52 to 2^53 consecutive numbers differ by 1, and so do their bits. So the bits of
        // 2^52 + (index - first), less those of 2^52, are the distance from the first bin. If the
        // bin is before the first, or the index is NaN, the difference wraps round to a place far
        // beyond the last slot.
        let start = (1u64 << 52) as f64;
        let offset = start - *first as f64;
        let mut places = [0_u64; CHUNK];
        for chunk in parts.iter().flat_map(|part| part.chunks(CHUNK)) {
            for (place, &value) in places.iter_mut().zip(chunk) {
                *place = (ruler.index(value) + offset).to_bits().wrapping_sub(start.to_bits());
            }
            for (&place, &value) in places.iter().zip(chunk) {
                match slots.get_mut(place as usize) {
                    Some(count) => *count += 1,
                    None => others.push(value),
                }
            }
        }
    }
}

/// The occupied bins among those from `first` on, with their counts.
fn filled(first: i64, slots: &[u16]) -> List {
    let mut list = List::with_capacity(slots.len());
    for (index, &count) in (first..).zip(slots) {
        if count > 0 {
            list.push((index, count.into()));
        }
    }
    list
}

/// Which bins are taken, with one bit per bin.
struct Taken {
    /// The bins on either side of the centre, without bin 0, so that bins that become one at the
    /// next level are neighbouring bits of one word.
    words: Vec<u64>,
    is_centre_taken: bool,
}

/// Each mask keeps the lowest of every 1, 2, 4, ..., 64 bits.
const GROUPS: [u64; 7] = [!0, !0 / 0x3, !0 / 0xf, !0 / 0xff, !0 / 0xffff, !0 / 0xffff_ffff, 1];

impl Taken {
    fn by(values: &[f64], (smallest, largest): (f64, f64), ruler: &Ruler) -> Self {
        let place = |value: f64| {
            let index = ruler.index(value) as i64;
            (index - i64::from(index > 0), index == 0)
        };
        let first = place(smallest).0.div_euclid(64) * 64;
        let mut words = vec![0; ((place(largest).0 - first) / 64 + 1) as usize];
        let mut is_centre_taken = false;
        for (place, is_centre) in values.iter().map(|&value| place(value)) {
            let bit = (place - first) as usize;
            words[bit / 64] |= u64::from(!is_centre) << (bit % 64);
            is_centre_taken |= is_centre;
        }
        Taken { words, is_centre_taken }
    }

    /// How many bins are taken `levels` levels up, for up to six levels.
    fn count(&self, levels: usize) -> u32 {
        let groups =
            |word: u64| (0..levels).fold(word, |word, level| (word | word >> (1 << level)) & GROUPS[level + 1]);
        u32::from(self.is_centre_taken) + self.words.iter().map(|&word| groups(word).count_ones()).sum::<u32>()
    }
}

/// Smallest and largest value. Both are 0 rather than -0, whichever of the two came first.
fn extremes(values: &[f64]) -> (f64, f64) {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.iter().fold(ends, |(low, high), &v| (low.min(v), high.max(v)));
    (low + 0.0, high + 0.0)
}

impl PartialEq for Bins {
    fn eq(&self, other: &Self) -> bool {
        let ends = |bins: &Bins| (bins.level, bins.smallest, bins.largest);
        ends(self) == ends(other) && self.list() == other.list()
    }
}

/// Bytes hold the level, the extremes, the number of occupied bins, and each of these bins with its
/// count. The first bin is given by its index, and each later one by its distance from the one
/// before.
impl Bins {
    pub fn write(&self, out: &mut Vec<u8>) {
        let list = self.list();
        signed(self.level.into()).write(out);
        self.smallest.write(out);
        self.largest.write(out);
        (list.len() as u64).write(out);
        let mut before = 0;
        for (place, (index, count)) in list.into_iter().enumerate() {
            let step = index - before;
            if place == 0 { signed(step) } else { step as u64 }.write(out);
            count.write(out);
            before = index;
        }
    }

    pub fn read(from: &mut Reader<'_>, shape: &Shape) -> Result<Self, Damaged> {
        let (mut level, mut smallest, mut largest) = (0_u64, 0.0_f64, 0.0_f64);
        level.read(from)?;
        smallest.read(from)?;
        largest.read(from)?;
        let level = i32::try_from(unsigned(level)).map_err(|_| Damaged)?;
        let is_valid = |value: f64| match shape.scale {
            Some(_) => (0.0..=OCTAVES as f64).contains(&value),
            None => (value - shape.centre).is_finite(),
        };
        if !(is_valid(smallest) && is_valid(largest) && smallest <= largest) {
            return Err(Damaged);
        }
        let lowest = shape.lowest_level(smallest, largest);
        if !(lowest..=lowest + MAX_INDEX.ilog2() as i32).contains(&level) {
            return Err(Damaged);
        }
        let mut list = List::new();
        let mut total = 0_u64;
        for place in 0..from.length()? {
            let (mut step, mut count) = (0_u64, 0_u64);
            step.read(from)?;
            count.read(from)?;
            let index = match list.last() {
                None => Some(unsigned(step)),
                Some(&(before, _)) => {
                    i64::try_from(step).ok().filter(|step| *step > 0).and_then(|step| step.checked_add(before))
                }
            };
            let index = index.filter(|index| index.abs() <= MAX_INDEX).ok_or(Damaged)?;
            total = total.checked_add(count).ok_or(Damaged)?;
            if count == 0 || place >= shape.bins {
                return Err(Damaged);
            }
            list.push((index, count));
        }
        let ruler = Ruler::new(shape.centre, level);
        let ends = [smallest, largest].map(|value| Some(ruler.index(value) as i64));
        if [list.first(), list.last()].map(|bin| bin.map(|bin| bin.0)) != ends {
            return Err(Damaged);
        }
        let mut bins = Bins { level, smallest, largest, ..Bins::default() };
        bins.lay_out(list, shape.bins);
        Ok(bins)
    }
}

/// A whole number with a sign as one without: 0, -1, 1, -2, ... become 0, 1, 2, 3, ...
fn signed(number: i64) -> u64 {
    ((number << 1) ^ (number >> 63)) as u64
}

/// The inverse of [`signed`].
fn unsigned(code: u64) -> i64 {
    (code >> 1) as i64 ^ -((code & 1) as i64)
}
