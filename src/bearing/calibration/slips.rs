//! The slips that are visible in a record: their times, temperatures and sizes.

use super::crossing::{Window, as_slips_say};
use super::detect::{self, Jumps, trimmed_slope};
use super::level::{Level, LevelSums};
use super::samples::{MeasuredRecord, Samples, median, spread};
use super::stick_analysis::{StickAnalysis, block};
use super::sticks::bin_length;
use super::thermometer::Thermometer;

/// One slip, or several between two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slip {
    /// The index of the first sample after it.
    pub index: usize,
    /// Its time in seconds, in the middle between two samples.
    pub time: f64,
    /// Its direction: 1 or -1.
    pub sign: f64,
    /// The temperature at which it began (`crossing.rs`).
    pub temperature: f64,
    /// The level of z before it, from all samples of its stick.
    pub before: Level,
    /// The level after it.
    pub after: Level,
    /// Whether it has the usual size, so that it is a single slip that was seen clearly.
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

/// Everything that the samples show of slips, and of the sticks between them.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// The slips in order of time.
    pub slips: Vec<Slip>,
    /// For each slip that follows one in the other direction, the difference of their temperatures
    /// and the index of its block.
    pub reversals: Vec<(f64, usize)>,
    /// Sums for the regression of z on T during sticks, for each block.
    pub sums: Vec<LevelSums>,
    /// The size of a usual jump divided by the standard deviation of the noise.
    pub contrast: f64,
    /// Length of the bins of that regression, in seconds.
    pub bin: f64,
    /// The thermometer, and how it moves between samples.
    pub thermometer: Thermometer,
    /// The level at the start of the record, if a gap lies between it and the first slip that was
    /// seen.
    pub beginning: Option<Level>,
    start: f64,
}

/// Largest number of repeated searches for slips.
const ROUNDS: usize = 6;

/// A value farther from the median than this many standard deviations is unusual.
const UNUSUAL: f64 = 2.5;

impl Evidence {
    /// Find the slips of a record; `None` if there are none.
    ///
    /// The first search compares windows and needs no knowledge of the bearing. The later ones use
    /// the sticks in between: how the level drifts, and where a level that is known from all
    /// samples of a stick jumps.
    pub fn find(record: &MeasuredRecord, resolution: f64) -> Option<Evidence> {
        let samples = &record.samples();
        let seconds = bin_length(samples, resolution);
        let mut found = detect::jumps(samples, trimmed_slope(samples));
        for _ in 0..ROUNDS {
            let better = StickAnalysis::new(samples, &found, seconds)?.jumps(samples, &found);
            let is_same = better.indices().eq(found.indices());
            found = better;
            if is_same {
                break;
            }
        }
        let thermometer = Thermometer::of(record);
        let moves = |windows: &[(Window, f64)]| as_slips_say(thermometer, windows);
        Evidence::of(samples, moves, &found, &StickAnalysis::new(samples, &found, seconds)?)
    }

    /// The evidence from these jumps. `moves` says how the thermometer moves between samples, from
    /// when slips were seen and their directions.
    fn of(
        samples: &Samples,
        moves: impl FnOnce(&[(Window, f64)]) -> Thermometer,
        found: &Jumps,
        sticks: &StickAnalysis,
    ) -> Option<Evidence> {
        let still = sticks.still();
        let start = samples.times[0];
        let mut slips = Vec::with_capacity(found.jumps.len());
        let mut windows = Vec::with_capacity(found.jumps.len());
        let mut since = 0;
        for jump in &found.jumps {
            let (i, sign) = (jump.index, jump.size.signum());
            let stretch = samples.starts.iter().rev().find(|start| **start <= i).copied().unwrap_or(0);
            let slip = Slip {
                index: i,
                time: 0.5 * (samples.times[i - 1] + samples.times[i]),
                sign,
                temperature: f64::NAN,
                before: sticks.before[i - 1],
                after: sticks.after[i],
                is_usual: false,
            };
            let since = samples.times[std::mem::replace(&mut since, i).max(stretch)];
            if slip.size(still) > 0.0 {
                slips.push(slip);
                windows.push((Window { since, before: samples.times[i - 1], after: samples.times[i] }, sign));
            }
        }
        let thermometer = moves(&windows);
        for (slip, (window, sign)) in slips.iter_mut().zip(&windows) {
            slip.temperature = thermometer.crossing(window, *sign)?.temperature;
        }
        mark_usual(&mut slips, still);
        let is_whole = |from: usize, to: usize| !samples.starts.iter().any(|start| (from + 1..=to).contains(start));
        let pairs =
            slips.windows(2).filter(|pair| pair[0].sign != pair[1].sign && is_whole(pair[0].index, pair[1].index));
        let changes =
            pairs.map(|pair| ((pair[1].temperature - pair[0].temperature) * pair[1].sign, block(start, pair[1].time)));
        let reversals = usual(changes.collect());
        let first = slips.first()?;
        let beginning = (!is_whole(0, first.index)).then(|| sticks.after[0]);
        Some(Evidence {
            slips,
            reversals,
            sums: sticks.sums.clone(),
            contrast: found.contrast,
            bin: sticks.bin,
            thermometer,
            beginning,
            start,
        })
    }

    /// The index of the block of a time.
    pub fn block(&self, time: f64) -> usize {
        block(self.start, time)
    }

    /// A weight of 1 for each block.
    pub fn unweighted(&self) -> Vec<f64> {
        vec![1.0; self.sums.len()]
    }

    /// The evidence from the same slips with other temperatures of the samples.
    pub fn with_temperatures(&self, record: &MeasuredRecord) -> Option<Evidence> {
        let samples = &record.samples();
        let jumps = self.slips.iter().map(|slip| detect::Jump { index: slip.index, size: slip.sign }).collect();
        let found = Jumps { jumps, window: 1, contrast: self.contrast };
        let is_rough = self.thermometer.roughness > 0.0;
        let moves = |_: &[(Window, f64)]| {
            let rough = Thermometer::of(record);
            if is_rough { rough } else { rough.moving(0.0) }
        };
        Evidence::of(samples, moves, &found, &StickAnalysis::new(samples, &found, self.bin)?)
    }
}

/// Mark the slips that have the usual size.
fn mark_usual(slips: &mut [Slip], still: f64) {
    let sizes: Vec<f64> = slips.iter().map(|slip| slip.size(still)).collect();
    let middle = median(&mut sizes.clone());
    let single: Vec<f64> = sizes.iter().copied().filter(|size| (0.5..1.5).contains(&(size / middle))).collect();
    let (middle, wide) = (median(&mut single.clone()), spread(&single));
    for (slip, size) in slips.iter_mut().zip(sizes) {
        slip.is_usual = (0.5..1.5).contains(&(size / middle)) && (size - middle).abs() <= UNUSUAL * wide;
    }
}

/// The values that are not far from the median. If a slip was not seen, the difference at the next
/// reversal is too large.
fn usual(values: Vec<(f64, usize)>) -> Vec<(f64, usize)> {
    let only: Vec<f64> = values.iter().map(|(value, _)| *value).collect();
    let (middle, wide) = (median(&mut only.clone()), spread(&only));
    values.into_iter().filter(|(value, _)| (value - middle).abs() <= UNUSUAL * wide).collect()
}
