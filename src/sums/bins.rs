//! Counts of values in bins of the dyadic lattice, at the finest level at which no more than a
//! given number of bins are occupied.
//!
//! An added value never reduces the number of occupied bins of a level. So the level only rises,
//! and the level of two merged parts follows from the parts. Level and counts ([`Bins::list`]) are
//! therefore functions of the values alone, and do not depend on the order, the grouping and the
//! number of steps in which the values came. Only the layout of the counts in memory depends on
//! them: where most of the values are, bins are slots of an array, and the few others are entries of
//! a list.

use super::codec::{Codec, Damaged, Reader};
use super::dyadic::{List, MAX_INDEX, Ruler, coarsen, counted, excess, finest, union};
use super::log_scale::{LogScale, OCTAVES};
use crate::lanes::{InstructionSet, LaneProgram, Lanes};

/// The centre of a sketch, and its capacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shape {
    /// A value that many paths may share: it has its own bin at every level. It is 0 where there is
    /// a scale.
    pub centre: f64,
    /// If there is one, its places are counted instead of the values themselves.
    pub scale: Option<LogScale>,
    /// Up to this many values are kept one by one, besides any number of values at the centre.
    pub values: usize,
    /// Beyond that, values are counted in up to this many bins; not more than `values`.
    pub bins: usize,
}

/// Number of slots beyond either end of the array, which are there for later values.
const MARGIN: i64 = 32;

/// The longest array, in slots per bin that may be occupied.
const AFFORDED: i64 = 4;

/// Number of values whose slots are computed together.
const CHUNK: usize = 64;

/// If more than one in this many added values lies outside the array, the array is laid out again.
const ONE_OUTSIDE_IN: usize = 8;

/// Counts of values that are more than `Shape::values`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bins {
    pub level: i32,
    pub smallest: f64,
    pub largest: f64,
    /// The counts of the bins from `first` on.
    first: i64,
    slots: Vec<u32>,
    /// The number of further values that may be counted before a slot can overflow.
    room: usize,
    /// How many values have been counted since the occupied bins were last counted.
    counted_since_check: usize,
    /// Other bins, and counts that are too large for a slot.
    listed: List,
}

/// Counts from this one on are kept in the list, so that as many more values can be counted before a
/// slot overflows.
const FULL: u32 = 1 << 31;

impl Bins {
    /// The bins of these values, of which there is at least one. All must be at a finite distance
    /// from the centre.
    pub fn of(values: &[f64], shape: &Shape) -> Self {
        let (smallest, largest) = extremes(values);
        let level = shape.lowest_level(smallest, largest);
        let ruler = Ruler::new(shape.centre, level);
        let list = counted(
            values
                .iter()
                .map(|&value| ruler.index(value) as i64)
                .collect(),
        );
        let mut bins = Bins {
            level,
            smallest,
            largest,
            ..Bins::default()
        };
        bins.lay_out(list, shape.bins);
        bins
    }

    /// Count more values, which come in parts. Values that are not at a finite distance from the
    /// centre are left out.
    pub fn count(&mut self, parts: &[&[f64]], shape: &Shape) {
        let number: usize = parts.iter().map(|part| part.len()).sum();
        if self.room < number {
            self.lay_out(self.list(), shape.bins);
        }
        self.room -= number;
        let mut others = self.count_inside(parts, &Ruler::new(shape.centre, self.level));
        others.retain(|value| (value - shape.centre).is_finite());
        let (smallest, largest) = extremes(&others);
        self.extend_to(smallest, largest, shape);
        let is_scattered = self.count_anywhere(&others, &Ruler::new(shape.centre, self.level))
            > number / ONE_OUTSIDE_IN;
        self.counted_since_check += number;
        if is_scattered || self.counted_since_check >= shape.values {
            self.normalise(
                shape.bins,
                is_scattered && self.level > shape.lowest_level(self.smallest, self.largest),
            );
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
        union(&self.listed, &filled(self.first, &self.slots))
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
        self.listed.len()
            + self
                .slots
                .iter()
                .map(|&count| u32::from(count > 0))
                .sum::<u32>() as usize
    }

    /// Count the values that have a slot and are surely not new extremes. Returns the other values.
    fn count_inside(&mut self, parts: &[&[f64]], ruler: &Ruler) -> Vec<f64> {
        // The bin of an extreme may hold values beyond it. Only bin 0 cannot, because it holds a
        // single value.
        let [lowest, highest] =
            [self.smallest, self.largest].map(|value| ruler.index(value) as i64);
        let (lowest, highest) = (
            lowest + i64::from(lowest != 0),
            highest - i64::from(highest != 0),
        );
        let first = self.first.max(lowest);
        let length =
            ((self.first + self.slots.len() as i64).min(highest + 1) - first).max(0) as usize;
        let start = (first - self.first) as usize;
        count_slots(
            parts,
            ruler,
            first,
            self.slots
                .get_mut(start..start + length)
                .unwrap_or_default(),
        )
    }

    /// The slot of a bin, if it has one.
    fn slot(&mut self, index: i64) -> Option<&mut u32> {
        usize::try_from(index.wrapping_sub(self.first))
            .ok()
            .and_then(|place| self.slots.get_mut(place))
    }

    /// Count values, whether or not they have a slot. Returns how many of them have none.
    fn count_anywhere(&mut self, values: &[f64], ruler: &Ruler) -> usize {
        let mut missed = Vec::new();
        for &value in values {
            let index = ruler.index(value) as i64;
            match self.slot(index) {
                Some(count) => *count += 1,
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
        let list = if levels > 0 {
            coarsen(&list, levels)
        } else {
            list
        };
        self.level += levels as i32;
        self.listed.clear();
        let Cluster { first, length, .. } = fullest(&list, AFFORDED * limit as i64);
        self.first = first - MARGIN;
        self.slots = vec![0; (length + 2 * MARGIN) as usize];
        for (index, count) in list {
            match self.slot(index).filter(|_| count < FULL.into()) {
                Some(slot) => *slot = count as u32,
                None => self.listed.push((index, count)),
            }
        }
        self.room = FULL as usize;
    }
}

impl Shape {
    /// The finest level that is used for values between these extremes.
    fn lowest_level(&self, smallest: f64, largest: f64) -> i32 {
        finest(
            (smallest - self.centre)
                .abs()
                .max((largest - self.centre).abs()),
        )
    }

    /// The place of a value on the scale, or its distance from the centre.
    pub fn place(&self, value: f64) -> f64 {
        self.scale
            .map_or(value - self.centre, |scale| scale.place(value))
    }

    /// The value at this place.
    pub fn value(&self, place: f64) -> f64 {
        self.scale
            .map_or(self.centre + place, |scale| scale.number(place))
    }
}

/// Occupied bins that lie close together.
#[derive(Clone, Copy, Default)]
struct Cluster {
    first: i64,
    length: i64,
    count: u64,
}

/// The bins with the most values between gaps, chosen such that they take no more than `most`
/// slots.
fn fullest(list: &[(i64, u64)], most: i64) -> Cluster {
    let mut gap = most;
    loop {
        let (mut fullest, mut last) = (Cluster::default(), Cluster::default());
        for &(index, count) in list {
            last = match last {
                Cluster {
                    first,
                    length,
                    count: before,
                } if before > 0 && index - (first + length) <= gap => Cluster {
                    first,
                    length: index - first + 1,
                    count: before + count,
                },
                _ => Cluster {
                    first: index,
                    length: 1,
                    count,
                },
            };
            fullest = if last.count > fullest.count {
                last
            } else {
                fullest
            };
        }
        // If no gap is longer than one, there are fewer than two slots per occupied bin.
        if gap <= 1 || fullest.length <= most {
            return fullest;
        }
        gap /= 2;
    }
}

/// Count values in the slots of the bins from `first` on. Returns the values that have no slot.
fn count_slots(parts: &[&[f64]], ruler: &Ruler, first: i64, slots: &mut [u32]) -> Vec<f64> {
    let mut count = CountSlots {
        parts,
        ruler,
        first,
        slots,
        others: Vec::new(),
    };
    InstructionSet::detect().run(&mut count);
    count.others
}

/// See [`count_slots`].
struct CountSlots<'a> {
    parts: &'a [&'a [f64]],
    ruler: &'a Ruler,
    first: i64,
    slots: &'a mut [u32],
    others: Vec<f64>,
}

impl LaneProgram for CountSlots<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let CountSlots {
            parts,
            ruler,
            first,
            slots,
            others,
        } = self;
        // From 2^52 to 2^53 consecutive numbers differ by 1, and so do their bits. So the bits of
        // 2^52 + (index - first), less those of 2^52, are the distance from the first bin. If the
        // bin is before the first, or the index is NaN, the difference wraps round to a place far
        // beyond the last slot.
        let start = (1u64 << 52) as f64;
        let offset = start - *first as f64;
        let mut places = [0_u64; CHUNK];
        for chunk in parts.iter().flat_map(|part| part.chunks(CHUNK)) {
            for (place, &value) in places.iter_mut().zip(chunk) {
                *place = (ruler.index(value) + offset)
                    .to_bits()
                    .wrapping_sub(start.to_bits());
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
fn filled(first: i64, slots: &[u32]) -> List {
    let mut list = List::with_capacity(slots.len());
    for (index, &count) in (first..).zip(slots) {
        if count > 0 {
            list.push((index, count.into()));
        }
    }
    list
}

/// Smallest and largest value. Both are 0 rather than -0, whichever of the two came first.
fn extremes(values: &[f64]) -> (f64, f64) {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values
        .iter()
        .fold(ends, |(low, high), &v| (low.min(v), high.max(v)));
    (low + 0.0, high + 0.0)
}

impl PartialEq for Bins {
    fn eq(&self, other: &Self) -> bool {
        let ends = |bins: &Bins| (bins.level, bins.smallest, bins.largest);
        ends(self) == ends(other) && self.list() == other.list()
    }
}

/// Bytes hold the level, the extremes, the number of occupied bins, and each of these bins by its
/// distance from the one before, with its count.
impl Bins {
    pub fn write(&self, out: &mut Vec<u8>) {
        let list = self.list();
        signed(self.level.into()).write(out);
        [self.smallest, self.largest].write(out);
        (list.len() as u64).write(out);
        let mut before = 0;
        for (index, count) in list {
            [signed(index - before), count].write(out);
            before = index;
        }
    }

    pub fn read(from: &mut Reader<'_>, shape: &Shape) -> Result<Self, Damaged> {
        let level = i32::try_from(unsigned(from.value()?)).map_err(|_| Damaged)?;
        let ends: [f64; 2] = from.value()?;
        let is_valid = |value: f64| match shape.scale {
            Some(_) => (0.0..=OCTAVES as f64).contains(&value),
            None => (value - shape.centre).is_finite(),
        };
        let [smallest, largest] = ends;
        if !(is_valid(smallest) && is_valid(largest) && smallest <= largest) {
            return Err(Damaged);
        }
        let lowest = shape.lowest_level(smallest, largest);
        let number = from.length()?;
        if !(lowest..=lowest + MAX_INDEX.ilog2() as i32).contains(&level) || number > shape.bins {
            return Err(Damaged);
        }
        let mut list = List::with_capacity(number);
        let mut index = 0_i64;
        for _ in 0..number {
            let [step, count] = from.value()?;
            index = index.wrapping_add(unsigned(step));
            list.push((index, count));
        }
        let ruler = Ruler::new(shape.centre, level);
        let ends = ends.map(|value| Some(ruler.index(value) as i64));
        let is_sound = list
            .iter()
            .all(|(index, count)| (-MAX_INDEX..=MAX_INDEX).contains(index) && *count > 0)
            && list.is_sorted_by(|a, b| a.0 < b.0)
            && list
                .iter()
                .try_fold(0_u64, |all, bin| all.checked_add(bin.1))
                .is_some()
            && [list.first(), list.last()].map(|bin| bin.map(|bin| bin.0)) == ends;
        if !is_sound {
            return Err(Damaged);
        }
        let mut bins = Bins {
            level,
            smallest,
            largest,
            ..Bins::default()
        };
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
