//! The slips that are visible in a record: their times, temperatures and sizes.

use super::detect::{self, Jump, Jumps, trimmed_slope};
use super::level::{Level, LevelSums};
use super::question::CalibrationError;
use super::samples::{MeasuredRecord, median, spread};
use super::stick_analysis::StickAnalysis;
use super::sticks::bin_length;
use super::zero::{Middle, ZeroColumns};
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
    /// The time of the later slip, in seconds.
    pub time: f64,
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
    /// Jumps that are not slips but resets of the zero: the index of the first sample after each.
    set: Vec<usize>,
    /// The level at the start of the record, if there is a gap between it and the first detected
    /// slip.
    pub beginning: Option<Level>,
}

/// Jumps smaller than this many resolution steps of the sensor may be such steps.
const COARSE: f64 = 3.5;

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
        let mut all = Self::of(record, &found, &sticks, Vec::new())?;
        let between = |i: usize| 0.5 * (samples.times[i - 1] + samples.times[i]);
        let gaps = samples.starts.iter().copied().filter(|start| *start > 0);
        let candidates: Vec<f64> = found.indices().chain(gaps).map(between).collect();
        for _ in 0..ROUNDS {
            all.zero = ZeroColumns::asked_by(&all.middles(), &candidates, all.zero.start);
            let set = all.jumps_of_zero();
            if set.is_empty() {
                break;
            }
            all = Self::of(record, &found, &sticks, [all.set, set].concat())?;
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
            ..Self::of(record, &found, &sticks, Vec::new())?
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
            ..Self::of(record, &found, &sticks, self.set.clone())?
        })
    }

    /// The slips among these jumps, excluding those in `set`.
    fn of(
        record: &MeasuredRecord,
        found: &Jumps,
        sticks: &StickAnalysis,
        set: Vec<usize>,
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
            let slip = Slip {
                index: i,
                time: 0.5 * (window[1] + window[2]),
                sign,
                temperature,
                is_early,
                before: sticks.before[i - 1],
                after: sticks.after[i],
                is_usual: false,
            };
            if slip.size(still) > 0.0 {
                slips.push(slip);
            }
        }
        mark_usual(&mut slips, still);
        let is_whole = |from: usize, to: usize| {
            let mut starts = samples.starts.iter();
            !starts.any(|start| (from + 1..=to).contains(start))
        };
        let first = slips.first()?;
        let beginning = (!is_whole(0, first.index)).then(|| sticks.after[0]);
        let start = samples.times[0];
        let mut all = DetectedSlips {
            reversals: reversals(&slips, still, is_whole),
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
            set,
            beginning,
        };
        let jump = all.fit().map_or(0.0, |(fit, _)| fit.motion.jump);
        all.reversals = usual(all.reversals, jump);
        Some(all)
    }

    /// The slope of z against T during sticks.
    pub fn still(&self) -> f64 {
        self.sums.slope()
    }

    /// f_d/(K beta), from the reversals.
    pub fn kinetic_reach(&self) -> f64 {
        let changes: Vec<f64> = self
            .reversals
            .iter()
            .map(|reversal| reversal.change)
            .collect();
        0.5 * mean(&changes)
    }

    /// The share of slips although no sample exceeds the previous extreme.
    pub fn early(&self) -> f64 {
        let early = self.slips.iter().filter(|slip| slip.is_early).count();
        early as f64 / self.slips.len() as f64
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

    /// The middles of the typical jumps.
    pub fn middles(&self) -> Vec<Middle> {
        let still = self.still();
        let kinetic = self.kinetic_reach();
        let middle = |slip: &Slip| Middle {
            time: slip.time,
            centre: slip.temperature - slip.sign * kinetic,
            place: slip.middle(still),
        };
        self.usual().map(middle).collect()
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

/// Mark the slips of typical size.
fn mark_usual(slips: &mut [Slip], still: f64) {
    let sizes: Vec<f64> = slips.iter().map(|slip| slip.size(still)).collect();
    let middle = median(&mut sizes.clone());
    let is_single = |size: &f64| (0.5..1.5).contains(&(size / middle));
    let single: Vec<f64> = sizes.iter().copied().filter(is_single).collect();
    let (middle_single, wide) = (median(&mut single.clone()), spread(&single));
    for (slip, size) in slips.iter_mut().zip(sizes) {
        slip.is_usual = is_single(&size) && (size - middle_single).abs() <= UNUSUAL * wide;
    }
}

/// A jump larger than this many typical ones consists of several slips.
const TWO: f64 = 1.5;

/// The differences between slips and those before them in the other direction.
fn reversals(slips: &[Slip], still: f64, is_whole: impl Fn(usize, usize) -> bool) -> Vec<Reversal> {
    let size = |slip: &Slip| slip.size(still);
    let middle = median(&mut slips.iter().map(size).collect::<Vec<_>>());
    // Of two slips between two samples only one temperature is known, and they are not a single
    // slip.
    let is_single = |pair: &[Slip]| pair.iter().all(|slip| size(slip) < TWO * middle);
    let turns = slips.windows(2).filter(|pair| {
        pair[0].sign != pair[1].sign && is_single(pair) && is_whole(pair[0].index, pair[1].index)
    });
    turns
        .map(|pair| Reversal {
            change: (pair[1].temperature - pair[0].temperature) * pair[1].sign,
            growth: size(&pair[1]) - size(&pair[0]),
            time: pair[1].time,
        })
        .collect()
}

/// The values close to the median. If a slip was missed, the difference at the next reversal is too
/// large by G; the limit is half of that, within sensible bounds for the scatter.
fn usual(reversals: Vec<Reversal>, jump: f64) -> Vec<Reversal> {
    let only: Vec<f64> = reversals.iter().map(|reversal| reversal.change).collect();
    let (middle, wide) = (median(&mut only.clone()), spread(&only));
    let most = (0.5 * jump).max(UNUSUAL * wide).min(MOST_UNUSUAL * wide);
    reversals
        .into_iter()
        .filter(|reversal| (reversal.change - middle).abs() <= most)
        .collect()
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
                time: 0.0,
            });
            usual(values.to_vec(), jump).len()
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
