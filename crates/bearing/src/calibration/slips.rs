//! The slips that are visible in a record: their times, temperatures and sizes.

use super::course::{CourseRow, CourseShape, Typical};
use super::detect::{self, Jump, Jumps, trimmed_slope};
use super::level::{Level, LevelSums};
use super::question::CalibrationError;
use super::samples::{MeasuredRecord, Samples, median, spread};
use super::stick_analysis::StickAnalysis;
use super::sticks::bin_length;
use super::zero::{Middle, Middles, Turn, ZeroColumns};
use crate::moments::mean;

/// One slip, or several between two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slip {
    /// The index of the first sample after it.
    pub index: usize,
    /// Its time in seconds, in the middle between two samples.
    pub time: f64,
    /// Its direction: 1 or -1.
    pub sign: f64,
    /// The temperature at which it began, if the temperature is interpolated linearly between
    /// samples.
    pub temperature: f64,
    /// Whether no sample exceeds the extreme one before the slip, so that the temperature is not
    /// linear between samples.
    pub is_early: bool,
    /// The level of z before it, from all samples of its stick.
    pub before: Level,
    /// The level after it.
    pub after: Level,
    /// Whether it has the typical size and is therefore a single, clearly detected slip.
    pub is_usual: bool,
    /// Whether there is a gap between the slip before and this one.
    follows_gap: bool,
}

impl Slip {
    /// The jump of z - still T, in the direction of the slip.
    pub fn size(&self, still: f64) -> f64 {
        self.sign * (self.after.minus_slope(still) - self.before.minus_slope(still))
    }

    /// z - still T in the middle of the jump.
    pub fn middle(&self, still: f64) -> f64 {
        0.5 * (self.before.minus_slope(still) + self.after.minus_slope(still))
    }
}

/// The difference between a slip and the one before it in the other direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reversal {
    /// By how many kelvin the temperature changed: 2 A - G.
    pub change: f64,
    /// By how much the later slip is larger, in the unit of displacement.
    pub growth: f64,
    /// The times of both slips, in seconds.
    pub times: [f64; 2],
}

impl Reversal {
    /// The row of a regression on one and the functions of this shape.
    pub fn row(&self, shape: CourseShape) -> CourseRow {
        (shape.row(&self.times), self.change)
    }
}

/// The detected slips, and the sticks between them.
#[derive(Clone, Debug)]
pub struct DetectedSlips {
    /// The slips in order of time.
    pub slips: Vec<Slip>,
    /// For each slip that follows one in the other direction, the difference of their temperatures.
    pub reversals: Vec<Reversal>,
    /// Sums for the regression of z on T during sticks.
    pub sums: LevelSums,
    /// The size of a typical jump divided by the standard deviation of the noise.
    pub contrast: f64,
    /// Length of the bins of that regression, in seconds.
    pub bin: f64,
    /// The variances of the random walk of the level, as [`StickAnalysis::walks`].
    pub walks: [f64; 2],
    /// The standard deviation of the white noise of a reading.
    pub white: f64,
    /// The movements of the zero of the sensor that the slips show.
    pub zero: ZeroColumns,
    /// How friction varies over time.
    pub shape: CourseShape,
    /// Jumps that are not slips but resets of the zero: the index of the first sample after each.
    set: Vec<usize>,
    /// The level at the start of the record, if there is a gap between it and the first detected
    /// slip.
    pub beginning: Option<Level>,
}

/// Jumps smaller than this many resolution steps of the sensor may be such steps.
const COARSE: f64 = 3.5;

/// Threshold of twice the log-likelihood ratio for a change of friction over time. Neighbouring
/// values have correlated errors, so random gains are larger than for independent ones.
const CONVINCING: f64 = 20.0;

/// The fewest reversals that determine a change.
const FEWEST: usize = 10;

/// The shortest record that shows a season, in seconds.
const SEASON: f64 = 180.0 * 86_400.0;

/// Largest number of repeated searches for slips.
const ROUNDS: usize = 6;

/// A value farther from the median than this many standard deviations is unusual.
const UNUSUAL: f64 = 2.5;

/// A value farther than this is unusual even if slips are larger.
const MOST_UNUSUAL: f64 = 4.0;

impl DetectedSlips {
    /// Find the slips of a record; `None` if there are none.
    ///
    /// The first search compares windows and does not use the parameters of the bearing. Later ones
    /// use the sticks: the drift of their levels, and jumps between levels estimated from whole
    /// sticks.
    pub fn find(record: &MeasuredRecord, resolution: f64) -> Option<Self> {
        let samples = &record.samples();
        let seconds = bin_length(samples, resolution);
        let mut found = detect::jumps(samples, trimmed_slope(samples));
        for _ in 0..ROUNDS {
            let sticks = StickAnalysis::new(samples, &found, seconds, None);
            let better = sticks.jumps(samples, &found);
            let is_same = better.indices().eq(found.indices());
            found = better;
            if is_same {
                break;
            }
        }
        let sticks = StickAnalysis::new(samples, &found, seconds, None);
        let mut all = Self::of(record, &found, &sticks, Vec::new(), CourseShape::Constant)?;
        let shape = all.asked_shape(samples);
        all = all.with_shape(shape);
        let between = |i: usize| 0.5 * (samples.times[i - 1] + samples.times[i]);
        let gaps = samples.starts.iter().copied().filter(|start| *start > 0);
        let candidates: Vec<f64> = found.indices().chain(gaps).map(between).collect();
        for _ in 0..ROUNDS {
            all.zero = ZeroColumns::asked_by(&all.middles(), &candidates, all.zero.start);
            let set = all.jumps_of_zero();
            if set.is_empty() {
                break;
            }
            all = Self::of(record, &found, &sticks, [all.set, set].concat(), all.shape)?;
        }
        Some(all)
    }

    /// The slips of a similar record with approximately known jumps: the time of the first reading
    /// after each, and its size.
    pub fn like_these(&self, record: &MeasuredRecord, jumps: &[[f64; 2]]) -> Option<Self> {
        let samples = &record.samples();
        let jump = |[time, size]: &[f64; 2]| Jump {
            index: samples.times.partition_point(|t| *t < time - SAME),
            size: *size,
        };
        let mut jumps: Vec<Jump> = jumps.iter().map(jump).collect();
        jumps.retain(|jump| (1..samples.times.len()).contains(&jump.index));
        jumps.dedup_by_key(|jump| jump.index);
        let found = Jumps {
            jumps,
            window: 1,
            contrast: self.contrast,
        };
        let walks = Some(self.walks);
        let found = StickAnalysis::new(samples, &found, self.bin, walks).jumps(samples, &found);
        let sticks = StickAnalysis::new(samples, &found, self.bin, walks);
        Some(DetectedSlips {
            zero: self.zero.clone(),
            ..Self::of(record, &found, &sticks, Vec::new(), self.shape)?
        })
    }

    /// The same slips with other temperatures of the samples.
    pub fn with_temperatures(&self, record: &MeasuredRecord) -> Option<Self> {
        let slips = self.slips.iter().map(|slip| (slip.index, slip.sign));
        let set = self.set.iter().map(|index| (*index, 1.0));
        let mut jumps: Vec<Jump> = slips
            .chain(set)
            .map(|(index, size)| Jump { index, size })
            .collect();
        jumps.sort_by_key(|jump| jump.index);
        let found = Jumps {
            jumps,
            window: 1,
            contrast: self.contrast,
        };
        let sticks = StickAnalysis::new(&record.samples(), &found, self.bin, Some(self.walks));
        Some(DetectedSlips {
            zero: self.zero.clone(),
            ..Self::of(record, &found, &sticks, self.set.clone(), self.shape)?
        })
    }

    /// The slips among these jumps, excluding those in `set`, with friction that varies by this shape.
    fn of(
        record: &MeasuredRecord,
        found: &Jumps,
        sticks: &StickAnalysis,
        set: Vec<usize>,
        shape: CourseShape,
    ) -> Option<Self> {
        let samples = &record.samples();
        let still = sticks.still();
        let mut slips = Vec::with_capacity(found.jumps.len());
        let mut since = 0;
        for jump in found.jumps.iter().filter(|jump| !set.contains(&jump.index)) {
            let (i, sign) = (jump.index, jump.size.signum());
            let begins = samples.starts.partition_point(|start| *start <= i) - 1;
            let from = std::mem::replace(&mut since, i).max(samples.starts[begins]);
            let window = [from, i - 1, i].map(|i| samples.times[i]);
            let (temperature, is_early) = crossing(record, window, sign)?;
            let since_slip = slips.last().map_or(0, |slip: &Slip| slip.index);
            let mut starts = samples.starts.iter();
            let slip = Slip {
                index: i,
                time: 0.5 * (window[1] + window[2]),
                sign,
                temperature,
                is_early,
                before: sticks.before[i - 1],
                after: sticks.after[i],
                is_usual: false,
                follows_gap: starts.any(|start| (since_slip + 1..=i).contains(start)),
            };
            if slip.size(still) > 0.0 {
                slips.push(slip);
            }
        }
        let first = slips.first()?;
        let beginning = first.follows_gap.then(|| sticks.after[0]);
        let start = samples.times[0];
        let all = DetectedSlips {
            reversals: Vec::new(),
            slips,
            sums: sticks.sums,
            contrast: found.contrast,
            bin: sticks.bin,
            walks: sticks.walks,
            white: sticks.noise,
            zero: ZeroColumns {
                start,
                ..ZeroColumns::default()
            },
            shape,
            set,
            beginning,
        };
        Some(all.with_shape(shape))
    }

    /// The same slips with friction that varies by this shape, which decides which of them are usual.
    pub fn with_shape(mut self, shape: CourseShape) -> Self {
        self.shape = shape;
        self.mark_usual();
        self.reversals = self.all_reversals();
        let jump = self.fit().map_or(0.0, |fit| fit.response.motion.jump);
        self.reversals = usual(std::mem::take(&mut self.reversals), shape, jump);
        self
    }

    /// The size of each slip relative to that of a typical one at its time.
    pub fn relative_sizes(&self) -> Vec<f64> {
        let (sizes, still) = (self.sizes(), self.still());
        let middle = median(&mut sizes.clone());
        let typical = (self.shape != CourseShape::Constant)
            .then(|| Typical::of(&self.size_rows(self.shape, still), 1 + self.shape.columns()))
            .flatten();
        let at = |slip: &Slip| match &typical {
            Some(typical) => typical
                .value(&self.shape.row(&[slip.time]))
                .max(0.1 * middle),
            None => middle,
        };
        self.slips
            .iter()
            .zip(sizes)
            .map(|(slip, size)| size / at(slip))
            .collect()
    }

    /// The sizes of slips, as rows of a regression.
    fn size_rows(&self, shape: CourseShape, still: f64) -> Vec<CourseRow> {
        let row = |slip: &Slip| (shape.row(&[slip.time]), slip.size(still));
        self.slips.iter().map(row).collect()
    }

    /// How friction varies: with the season or steadily, if the changes of temperature between slips to
    /// either side or the sizes of slips show it clearly.
    fn asked_shape(&self, samples: &Samples) -> CourseShape {
        let [Some(begin), Some(end)] = [samples.times.first(), samples.times.last()] else {
            return CourseShape::Constant;
        };
        let all = self.all_reversals();
        if all.len() < FEWEST {
            return CourseShape::Constant;
        }
        let gains = |shape: CourseShape| {
            let columns = 1 + shape.columns();
            let changes: Vec<CourseRow> = all.iter().map(|turn| turn.row(shape)).collect();
            let gain = |rows: &[CourseRow]| {
                let gain = Typical::of(rows, columns)?.gain_over(&Typical::of(rows, 1)?, rows);
                Some(gain - shape.columns() as f64 * libm::log(rows.len() as f64))
            };
            [gain(&changes), gain(&self.size_rows(shape, self.still()))]
                .map(|gain| gain.unwrap_or(0.0))
        };
        let season = CourseShape::Season(*begin);
        let shapes = [CourseShape::Trend([*begin, *end]), season];
        let is_long = end - begin > SEASON;
        let clear = shapes
            .into_iter()
            .filter(|shape| is_long || *shape != season);
        let best = clear
            .map(|shape| (gains(shape), shape))
            .filter(|([a, b], _)| a.max(*b) > CONVINCING)
            .max_by(|([a, b], _), ([c, d], _)| (a + b).total_cmp(&(c + d)));
        best.map_or(CourseShape::Constant, |(_, shape)| shape)
    }

    /// Mark the slips of typical size.
    fn mark_usual(&mut self) {
        let sizes = self.relative_sizes();
        let is_single = |size: &f64| (0.5..TWO).contains(size);
        let single: Vec<f64> = sizes.iter().copied().filter(is_single).collect();
        let (middle, wide) = (median(&mut single.clone()), spread(&single));
        for (slip, size) in self.slips.iter_mut().zip(sizes) {
            slip.is_usual = is_single(&size) && (size - middle).abs() <= UNUSUAL * wide;
        }
    }

    /// The differences between slips and those before them in the other direction.
    fn all_reversals(&self) -> Vec<Reversal> {
        let (sizes, still) = (self.relative_sizes(), self.still());
        // Of two slips between two samples only one temperature is known, and they are not a single
        // slip.
        let is_turn = |i: &usize| {
            let [before, after] = [i - 1, *i].map(|i| &self.slips[i]);
            let is_single = sizes[i - 1] < TWO && sizes[*i] < TWO;
            before.sign != after.sign && is_single && !after.follows_gap
        };
        let reversal = |i: usize| {
            let [before, after] = [i - 1, i].map(|i| &self.slips[i]);
            Reversal {
                change: (after.temperature - before.temperature) * after.sign,
                growth: after.size(still) - before.size(still),
                times: [before.time, after.time],
            }
        };
        (1..self.slips.len())
            .filter(is_turn)
            .map(reversal)
            .collect()
    }

    /// The slope of z against T during sticks.
    pub fn still(&self) -> f64 {
        self.sums.slope()
    }

    /// The mean of f_d/(K beta) over the reversals.
    pub fn kinetic_reach(&self) -> f64 {
        let changes: Vec<f64> = self
            .reversals
            .iter()
            .map(|reversal| reversal.change)
            .collect();
        0.5 * mean(&changes)
    }

    /// The mean of one and the functions of the shape over the reversals.
    pub fn mean_row(&self) -> [f64; 3] {
        let rows: Vec<[f64; 3]> = self
            .reversals
            .iter()
            .map(|turn| turn.row(self.shape).0)
            .collect();
        std::array::from_fn(|k| mean(&rows.iter().map(|row| row[k]).collect::<Vec<_>>()))
    }

    /// The share of slips although no sample exceeds the previous extreme.
    pub fn early(&self) -> f64 {
        let early = self.slips.iter().filter(|slip| slip.is_early).count();
        early as f64 / self.slips.len() as f64
    }

    /// The log-likelihood ratio of the early slips, if their expected share is `a` rather than `b`.
    pub fn early_gain(&self, a: f64, b: f64) -> f64 {
        let count = self.slips.len() as f64;
        // A share of none in the synthetic records may be half a slip in this one.
        let [a, b] = [a, b].map(|share| share.clamp(0.5 / count, 1.0 - 0.5 / count));
        let early = self.early();
        let late = (1.0 - early) * libm::log((1.0 - a) / (1.0 - b));
        count * (early * libm::log(a / b) + late)
    }

    /// The sizes of all slips.
    pub fn sizes(&self) -> Vec<f64> {
        let still = self.still();
        self.slips.iter().map(|slip| slip.size(still)).collect()
    }

    /// The slips of typical size.
    pub fn usual(&self) -> impl Iterator<Item = &Slip> {
        self.slips.iter().filter(|slip| slip.is_usual)
    }

    /// The middles of the typical jumps, and what the reversals add to them if friction varies.
    pub fn middles(&self) -> Middles {
        let still = self.still();
        let (kinetic, [_, a, b]) = (self.kinetic_reach(), self.mean_row());
        let middle = |slip: &Slip| {
            let at = self.shape.at(slip.time);
            Middle {
                time: slip.time,
                centre: slip.temperature - slip.sign * kinetic,
                place: slip.middle(still),
                course: [-slip.sign * (at[0] - a), -slip.sign * (at[1] - b)],
            }
        };
        let turn = |reversal: &Reversal| {
            let row = reversal.row(self.shape).0;
            Turn {
                change: reversal.change - 2.0 * kinetic,
                course: [2.0 * (a - row[1]), 2.0 * (b - row[2])],
            }
        };
        let all = self.usual().map(middle).collect();
        let turns = self.reversals.iter().map(turn).collect();
        Middles::of(all, turns, self.shape.columns(), &self.zero)
    }

    /// False slips: the zero of the sensor was reset there, and z jumped by half of a typical slip
    /// or less.
    fn jumps_of_zero(&self) -> Vec<usize> {
        let Some(line) = self.zero.line(&self.middles()) else {
            return Vec::new();
        };
        let sizes = self.sizes();
        let usual = median(&mut sizes.clone());
        let is_set = |(slip, size): &(&Slip, f64)| {
            let step = line.zero.steps.iter().find(|(when, _)| *when == slip.time);
            step.is_some_and(|(_, step)| (slip.sign * size - step).abs() < 0.5 * usual)
        };
        let set = self.slips.iter().zip(sizes).filter(is_set);
        set.map(|(slip, _)| slip.index).collect()
    }

    /// Readings averaged over a slip: of the two next to each jump, the one farther from the level
    /// on its side.
    pub fn mixed(&self, record: &MeasuredRecord) -> Vec<usize> {
        let seen: Vec<usize> = (0..record.times.len())
            .filter(|i| record.readings[*i].is_finite())
            .collect();
        let still = self.still();
        let rest = |k: usize| {
            seen.get(k).map_or(f64::NAN, |i| {
                record.readings[*i] - still * record.temperatures[*i]
            })
        };
        let mixed = |slip: &Slip| {
            let k = slip.index;
            let off = |a: usize, b: usize| (rest(a) - rest(b)).abs();
            let is_before = k > 1 && off(k - 1, k - 2) > off(k, k + 1);
            seen[if is_before { k - 1 } else { k }]
        };
        self.slips.iter().map(mixed).collect()
    }

    /// Check that the jumps are larger than steps of a sensor of this resolution.
    pub fn check_resolution(&self, resolution: f64) -> Result<(), CalibrationError> {
        let jump = median(&mut self.sizes());
        match jump < COARSE * resolution {
            true => Err(CalibrationError::Coarse { jump, resolution }),
            false => Ok(()),
        }
    }
}

/// Times that are closer than this are the same, in seconds.
const SAME: f64 = 1e-3;

/// The temperature at which a slip began, and whether the slip is early. `times` are those of the
/// first sample after the slip before, and of the samples before and after this slip.
///
/// With linear interpolation it is between the extreme sample before the slip and the extreme one
/// up to the sample after it. A temperature that is rough between samples makes it too small;
/// synthetic records show by how much.
fn crossing(record: &MeasuredRecord, times: [f64; 3], sign: f64) -> Option<(f64, bool)> {
    let [since, before, after] = times;
    let until = |time: f64| record.times.partition_point(|t| *t <= time + SAME);
    let last = until(before).checked_sub(1)?;
    let first = until(since).checked_sub(1)?.min(last);
    let end = until(after).max(last + 2).min(record.times.len());
    let farthest = |range: std::ops::Range<usize>| {
        let away = record.temperatures[range].iter().map(|t| sign * t);
        away.fold(f64::NEG_INFINITY, f64::max)
    };
    let (held, reached) = (farthest(first..last + 1), farthest(last + 1..end));
    let beyond = (reached - held).max(0.0);
    Some((sign * (held + 0.5 * beyond), beyond == 0.0))
}

/// A jump larger than this many typical ones consists of several slips.
const TWO: f64 = 1.5;

/// The values close to those that are typical of the shape. If a slip was missed, the difference at the
/// next reversal is too large by G; the limit is half of that, within sensible bounds for the scatter.
fn usual(reversals: Vec<Reversal>, shape: CourseShape, jump: f64) -> Vec<Reversal> {
    let rows: Vec<CourseRow> = reversals.iter().map(|turn| turn.row(shape)).collect();
    let middle = median(&mut rows.iter().map(|row| row.1).collect::<Vec<_>>());
    let typical = (shape != CourseShape::Constant)
        .then(|| Typical::of(&rows, 1 + shape.columns()))
        .flatten();
    let off = |(row, change): &CourseRow| {
        change
            - typical
                .as_ref()
                .map_or(middle, |typical| typical.value(row))
    };
    let wide = spread(&rows.iter().map(off).collect::<Vec<_>>());
    let most = (0.5 * jump).max(UNUSUAL * wide).min(MOST_UNUSUAL * wide);
    let is_usual = |row: &CourseRow| off(row).abs() <= most;
    let kept = reversals
        .into_iter()
        .zip(&rows)
        .filter(|(_, row)| is_usual(row));
    kept.map(|(reversal, _)| reversal).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A difference that is 0.6 K too large stays where slips are of 2 K, and goes where they are of 1 K;
    /// 2.5 and 4 standard deviations are 0.37 and 0.59 K.
    #[test]
    fn a_slip_that_was_not_seen_makes_a_difference_unusual() {
        let kept = |far: f64, jump: f64| {
            let values = [-0.2, -0.1, -0.1, 0.0, 0.0, 0.1, 0.1, 0.2, far].map(|off| Reversal {
                change: 16.0 + off,
                growth: 0.0,
                times: [0.0; 2],
            });
            usual(values.to_vec(), CourseShape::Constant, jump).len()
        };
        assert_eq!(
            [
                kept(0.5, 2.0),
                kept(0.5, 0.9),
                kept(0.7, 2.0),
                kept(0.3, 0.1)
            ],
            [9, 8, 8, 9]
        );
    }
}
