//! Counts on the dyadic lattice: at the finest level at which no more than so many bins are
//! occupied.
//!
//! A value that is added occupies no fewer bins at any level, so the level only rises, and that of
//! two parts together follows from the parts. Level and counts are thus functions of the values
//! alone, in whatever order, grouping and number of steps they came ([`Bins::list`]). How the
//! counts lie in memory is not: bins that are close together are slots of an array, and the others,
//! few, are a list.

use super::codec::{Codec, Damaged, Reader};
use super::dyadic::{List, MAX_INDEX, Ruler, coarsen, counted, excess, exponent, finest, union};
use crate::lanes::{InstructionSet, LaneProgram, Lanes};

/// What a sketch is of, and how much it may hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    /// A value that may be shared by many: it has a bin of its own at every level.
    pub centre: f64,
    /// The finest level to be told apart; 0 for whole numbers.
    pub floor: i32,
    /// So many values are kept as they are, besides any number of that one.
    pub values: usize,
    /// Beyond that, so many bins are counted; not more than values are kept.
    pub bins: usize,
}

/// Arrays of slots at most; what lies in more clusters than this is counted more slowly.
const MAX_RUNS: usize = 4;

/// Empty bins that are bridged rather than ending an array, at most.
const LONGEST_GAP: i64 = 256;

/// Slots beyond either end of an array, for values to come.
const MARGIN: i64 = 32;

/// So many slots a bin are afforded.
const AFFORDED: i64 = 4;

/// Values whose slots are computed together.
const CHUNK: usize = 64;

/// In this share of the values counted, one outside all arrays is a reason to lay them out anew.
const MISSES: usize = 8;

/// Consecutive bins, from `first` on, in the slots `slot .. slot + length`.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: i64,
    length: i64,
    slot: usize,
}

/// Counts of more than `Shape::values` values.
#[derive(Clone, Debug, Default)]
pub(super) struct Bins {
    pub level: i32,
    pub smallest: f64,
    pub largest: f64,
    /// By their counts, the fullest first.
    runs: Vec<Run>,
    slots: Vec<u16>,
    /// So many values may be counted before a slot can be full.
    room: usize,
    /// How many values have been counted since the occupied bins were.
    unseen: usize,
    /// Bins outside the runs, and what is more than a slot can take.
    rest: List,
}

/// A slot with the highest bit set is laid out anew before it counts further. Half as many values
/// come in one go at most.
const FULL: u16 = 1 << 15;

/// With so many slots a value the slots are not read in vain.
const SPARSE: usize = 16;

impl Bins {
    /// The bins of these values, all at a finite distance from the centre, and not none.
    pub fn of(values: &[f64], shape: &Shape) -> Self {
        let (smallest, largest) = extremes(values);
        let lowest = shape.lowest_level(smallest, largest);
        // An array over all values: if too many of its slots are taken, then so are too many of any
        // finer ones.
        let slots = (8 * shape.bins) as f64;
        let level = lowest.max(exponent(largest / slots - smallest / slots) + 1);
        let taken = Taken::by(values, (smallest, largest), &Ruler::new(shape.centre, level));
        let (level, list) = if level == lowest || taken.count(0) > shape.bins as u32 {
            let level = level + (0..GROUPS.len()).find(|&up| taken.count(up) <= shape.bins as u32).unwrap_or(0) as i32;
            let ruler = Ruler::new(shape.centre, level);
            let [first, last] = [smallest, largest].map(|value| ruler.index(value) as i64);
            let mut slots = vec![0; (last - first + 1) as usize];
            count_slots(values, &ruler, first, &mut slots);
            (level, filled(first, &slots))
        } else {
            // Clusters, or an outlier: from the lowest level up.
            let ruler = Ruler::new(shape.centre, lowest);
            (lowest, counted(values.iter().map(|&value| ruler.index(value) as i64).collect()))
        };
        let mut bins = Bins { level, smallest, largest, ..Bins::default() };
        bins.lay_out(list, shape.bins);
        bins
    }

    /// Count more values. Those that are not at a finite distance from the centre are left out.
    pub fn count(&mut self, values: &[f64], shape: &Shape) {
        // So short are the slots that those of hundreds of rows stay near a processor; and where
        // there are many values for them, reading all of them in order here brings them nearer than
        // counting here and there would.
        if self.room < values.len() || self.slots.len() <= SPARSE * values.len() {
            let fullest = fullest_slot(&self.slots);
            self.room = FULL.saturating_sub(fullest).into();
            if fullest >= FULL {
                self.lay_out(self.list(), shape.bins);
            }
        }
        self.room = self.room.saturating_sub(values.len());
        let mut others = self.count_inside(values, &Ruler::new(shape.centre, self.level));
        others.retain(|value| (value - shape.centre).is_finite());
        let (smallest, largest) = extremes(&others);
        self.extend_to(smallest, largest, shape);
        let is_scattered = self.count_anywhere(&others, &Ruler::new(shape.centre, self.level)) > values.len() / MISSES;
        self.unseen += values.len();
        if is_scattered || self.unseen >= shape.values {
            self.settle(shape.bins, is_scattered && self.level > shape.lowest_level(self.smallest, self.largest));
        }
    }

    /// Count so many values at the centre.
    pub fn count_at_centre(&mut self, number: u64, shape: &Shape) {
        if number > 0 {
            self.extend_to(shape.centre + 0.0, shape.centre + 0.0, shape);
            self.rest = union(&self.rest, &[(0, number)]);
        }
    }

    /// Rise to the level that the number of occupied bins asks for; between times there may be too
    /// many of them.
    pub fn settle(&mut self, limit: usize, is_scattered: bool) {
        self.unseen = 0;
        if is_scattered || self.occupied(limit) > limit {
            self.lay_out(self.list(), limit);
        }
    }

    /// Add the counts of `other`.
    pub fn merge(&mut self, other: &Bins, shape: &Shape) {
        self.extend_to(other.smallest, other.largest, shape);
        self.rise_to(other.level, shape.bins);
        let theirs = coarsen(&other.list(), (self.level - other.level) as u32);
        self.lay_out(union(&self.list(), &theirs), shape.bins);
    }

    /// The bins that are not empty, ascending, with their counts.
    pub fn list(&self) -> List {
        let mut list = self.rest.clone();
        for run in &self.runs {
            let slots = &self.slots[run.slot..run.slot + run.length as usize];
            // The margins of two runs may overlap.
            list = union(&list, &filled(run.first, slots));
        }
        list
    }

    /// There are values between these, too.
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

    /// Bins that are not empty; not counted one by one if they cannot be more than `limit`.
    fn occupied(&self, limit: usize) -> usize {
        if self.rest.len() + self.slots.len() <= limit {
            return self.rest.len() + self.slots.len();
        }
        self.rest.len() + self.slots.iter().map(|&count| u32::from(count > 0)).sum::<u32>() as usize
    }

    /// Count the values that lie in the first run, the fullest, and are surely not extreme. Returns
    /// the others.
    fn count_inside(&mut self, values: &[f64], ruler: &Ruler) -> Vec<f64> {
        // All of bin 0 is one value.
        let [lowest, highest] = [self.smallest, self.largest].map(|value| ruler.index(value) as i64);
        let (lowest, highest) = (lowest + i64::from(lowest != 0), highest - i64::from(highest != 0));
        let run = self.runs.first().copied().unwrap_or(Run { first: 0, length: 0, slot: 0 });
        let first = run.first.max(lowest);
        let length = ((run.first + run.length).min(highest + 1) - first).max(0) as usize;
        let start = run.slot + (first - run.first) as usize;
        count_slots(values, ruler, first, self.slots.get_mut(start..start + length).unwrap_or_default())
    }

    /// Count values wherever they are. Returns how many of them lay outside all runs.
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
            self.rest = union(&self.rest, &counted(missed));
        }
        number
    }

    /// Take these bins of the present level, at as much coarser a one as their number asks for.
    fn lay_out(&mut self, list: List, limit: usize) {
        let levels = excess(&list, limit);
        let list = if levels > 0 { coarsen(&list, levels) } else { list };
        self.level += levels as i32;
        self.runs.clear();
        self.rest.clear();
        let mut length = 0;
        for cluster in fullest(clusters(&list, limit)) {
            let run = Run { first: cluster.first - MARGIN, length: cluster.length + 2 * MARGIN, slot: length };
            length += run.length as usize;
            self.runs.push(run);
        }
        self.slots = vec![0; length];
        for (index, count) in list {
            match self.runs.iter().find_map(|run| run.slot_of(index)).filter(|_| count < FULL.into()) {
                Some(slot) => self.slots[slot] = count as u16,
                None => self.rest.push((index, count)),
            }
        }
        self.room = FULL.saturating_sub(fullest_slot(&self.slots)).into();
    }
}

impl Shape {
    /// No bins below this level are looked at, where these are the extreme values.
    fn lowest_level(&self, smallest: f64, largest: f64) -> i32 {
        finest((smallest - self.centre).abs().max((largest - self.centre).abs())).max(self.floor)
    }
}

impl Run {
    #[inline]
    fn slot_of(&self, index: i64) -> Option<usize> {
        let offset = index.wrapping_sub(self.first);
        (0..self.length).contains(&offset).then(|| self.slot + offset as usize)
    }
}

/// Bins that lie close together.
struct Cluster {
    first: i64,
    length: i64,
    count: u64,
}

/// Split where the gaps are too long for all the slots between to be afforded, twice as many as
/// there may be bins.
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
        // With gaps of one there are less than two slots a bin.
        if gap == 1 || clusters.iter().map(|cluster| cluster.length).sum::<i64>() <= AFFORDED * limit as i64 {
            return clusters;
        }
        gap /= 2;
    }
}

/// Those with the most values, the fullest first.
fn fullest(mut clusters: Vec<Cluster>) -> Vec<Cluster> {
    clusters.sort_by_key(|cluster| std::cmp::Reverse(cluster.count));
    clusters.truncate(MAX_RUNS);
    clusters
}

/// Count values in the slots of the bins from `first` on. Returns those that have none.
fn count_slots(values: &[f64], ruler: &Ruler, first: i64, slots: &mut [u16]) -> Vec<f64> {
    let mut count = CountSlots { values, ruler, first, slots, others: Vec::new() };
    InstructionSet::detect().run(&mut count);
    count.others
}

/// See [`count_slots`].
struct CountSlots<'a> {
    values: &'a [f64],
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
        let CountSlots { values, ruler, first, slots, others } = self;
        // Between 2^52 and 2^53 numbers are 1 apart, and so are their bits: what is taken off those
        // of 2^52 is the distance from the first bin, and a bin before that, or none, wraps round
        // to a place far beyond the last.
        let start = (1u64 << 52) as f64;
        let offset = start - *first as f64;
        let mut places = [0_u64; CHUNK];
        for chunk in values.chunks(CHUNK) {
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

/// The bins from `first` on that are not empty.
fn filled(first: i64, slots: &[u16]) -> List {
    let mut list = List::with_capacity(slots.len());
    for (index, &count) in (first..).zip(slots) {
        if count > 0 {
            list.push((index, count.into()));
        }
    }
    list
}

/// Which bins are taken, a bit each.
struct Taken {
    /// On either side of the centre, so that bins that pair off are neighbouring bits of one word.
    words: Vec<u64>,
    is_centre_taken: bool,
}

/// The bits that stand for 1, 2, 4, ..., 64 of them.
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

    /// How many bins are taken so many levels up, six at most.
    fn count(&self, levels: usize) -> u32 {
        let groups =
            |word: u64| (0..levels).fold(word, |word, level| (word | word >> (1 << level)) & GROUPS[level + 1]);
        u32::from(self.is_centre_taken) + self.words.iter().map(|&word| groups(word).count_ones()).sum::<u32>()
    }
}

/// Smallest and largest value. -0 counts as 0, whichever came first.
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

/// Level, extremes, and the bins that are not empty: the first, the distance of each from the one
/// before it, and their counts.
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
        let is_finite = |value: f64| (value - shape.centre).is_finite();
        if !(is_finite(smallest) && is_finite(largest) && smallest <= largest) {
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

/// A whole number with a sign as one without: 0, -1, 1, -2, ...
fn signed(number: i64) -> u64 {
    ((number << 1) ^ (number >> 63)) as u64
}

/// And back.
fn unsigned(code: u64) -> i64 {
    (code >> 1) as i64 ^ -((code & 1) as i64)
}
