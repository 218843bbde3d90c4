//! Slips as they were seen: when, at which temperature, and from where to where.

use super::detect::{self, Jumps, trimmed_slope};
use super::level::{Level, Sums};
use super::samples::{Samples, median, spread};
use super::sight::{Sight, block};
use super::sticks::bin_length;
use std::ops::Range;

/// One slip, or several between two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slip {
    /// The first sample after it.
    pub index: usize,
    /// When, in seconds: in the middle between two samples.
    pub time: f64,
    /// Which way: 1 or -1.
    pub sign: f64,
    /// Between which temperatures: that at the sample after it, and the farthest that was reached
    /// before without a slip.
    pub temperature: f64,
    /// The level of z before it, from all samples of its stick.
    pub before: Level,
    /// The level after it.
    pub after: Level,
    /// Whether it goes as far as usual, and so is one slip, seen well.
    pub is_usual: bool,
}

impl Slip {
    /// How far z - still T jumps, in the direction of the slip.
    pub fn size(&self, still: f64) -> f64 {
        self.sign * (self.after.less(still) - self.before.less(still))
    }

    /// z - still T in the middle of the jump.
    pub fn middle(&self, still: f64) -> f64 {
        0.5 * (self.before.less(still) + self.after.less(still))
    }
}

/// What the samples say of slips, and of sticks between them.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// In order of time.
    pub slips: Vec<Slip>,
    /// The differences of temperatures of slips that follow a slip the other way, and the block of
    /// each.
    pub reversals: Vec<(f64, usize)>,
    /// Of z against T inside sticks, block by block.
    pub sums: Vec<Sums>,
    /// A usual jump over the noise from which it was told.
    pub contrast: f64,
    /// The bins that z was regressed on T with, in seconds.
    pub bin: f64,
    /// The level of the stick in which the record begins, if the first slip that was seen does not
    /// end it, because there is a gap in between.
    pub beginning: Option<Level>,
    start: f64,
}

/// How often slips are looked for again, at most.
const ROUNDS: usize = 6;

/// Farther from the usual than so many standard deviations is unusual.
const UNUSUAL: f64 = 2.5;

impl Evidence {
    /// Look for slips, and at them. None where there is not one.
    ///
    /// First by windows, which need to know nothing, and then by what the sticks between say: how z
    /// wanders by itself, and where a level that is known from all samples of a stick jumps once
    /// more.
    pub fn find(samples: &Samples, resolution: f64) -> Option<Evidence> {
        let seconds = bin_length(samples, resolution);
        let mut found = detect::jumps(samples, trimmed_slope(samples));
        for _ in 0..ROUNDS {
            let better = Sight::new(samples, &found, seconds)?.jumps(samples, &found);
            let is_same = better.indices().eq(found.indices());
            found = better;
            if is_same {
                break;
            }
        }
        Evidence::of(samples, &found, &Sight::new(samples, &found, seconds)?)
    }

    /// Of these jumps.
    fn of(samples: &Samples, found: &Jumps, sight: &Sight) -> Option<Evidence> {
        let still = sight.still();
        let start = samples.times[0];
        let mut slips = Vec::with_capacity(found.jumps.len());
        let mut since = 0;
        for jump in &found.jumps {
            let (i, sign) = (jump.index, jump.size.signum());
            let stretch = samples.starts.iter().rev().find(|start| **start <= i).copied().unwrap_or(0);
            let slip = Slip {
                index: i,
                time: 0.5 * (samples.times[i - 1] + samples.times[i]),
                sign,
                temperature: crossing(&samples.temperatures, since.max(stretch)..i, sign),
                before: sight.before[i - 1],
                after: sight.after[i],
                is_usual: false,
            };
            since = i;
            if slip.size(still) > 0.0 {
                slips.push(slip);
            }
        }
        mark_usual(&mut slips, still);
        let is_whole = |from: usize, to: usize| !samples.starts.iter().any(|start| (from + 1..=to).contains(start));
        let pairs =
            slips.windows(2).filter(|pair| pair[0].sign != pair[1].sign && is_whole(pair[0].index, pair[1].index));
        let ways =
            pairs.map(|pair| ((pair[1].temperature - pair[0].temperature) * pair[1].sign, block(start, pair[1].time)));
        let reversals = usual(ways.collect());
        let first = slips.first()?;
        let beginning = (!is_whole(0, first.index)).then(|| sight.after[0]);
        Some(Evidence {
            slips,
            reversals,
            sums: sight.sums.clone(),
            contrast: found.contrast,
            bin: sight.bin,
            beginning,
            start,
        })
    }

    /// The block of a time.
    pub fn block(&self, time: f64) -> usize {
        block(self.start, time)
    }

    /// A weight of one for each block.
    pub fn unweighted(&self) -> Vec<f64> {
        vec![1.0; self.sums.len()]
    }

    /// What the same slips say when the temperature is this one, sample by sample.
    pub fn with_temperatures(&self, samples: &Samples) -> Option<Evidence> {
        let jumps = self.slips.iter().map(|slip| detect::Jump { index: slip.index, size: slip.sign }).collect();
        let found = Jumps { jumps, window: 1, contrast: self.contrast };
        Evidence::of(samples, &found, &Sight::new(samples, &found, self.bin)?)
    }
}

/// The temperature of a slip between the samples of `before` and the next one.
///
/// While it is warming, the slip comes when T has gone farther than ever since the last slip: it is
/// between the highest temperature so far and that of the next sample. In the middle of them it is
/// right on the mean.
fn crossing(temperatures: &[f64], before: Range<usize>, sign: f64) -> f64 {
    let next = sign * temperatures[before.end];
    let farthest = temperatures[before].iter().fold(f64::NEG_INFINITY, |far, t| far.max(sign * t));
    sign * if next > farthest { 0.5 * (next + farthest) } else { farthest }
}

/// Which slips go as far as most.
fn mark_usual(slips: &mut [Slip], still: f64) {
    let sizes: Vec<f64> = slips.iter().map(|slip| slip.size(still)).collect();
    let middle = median(&mut sizes.clone());
    let single: Vec<f64> = sizes.iter().copied().filter(|size| (0.5..1.5).contains(&(size / middle))).collect();
    let (middle, wide) = (median(&mut single.clone()), spread(&single));
    for (slip, size) in slips.iter_mut().zip(sizes) {
        slip.is_usual = (0.5..1.5).contains(&(size / middle)) && (size - middle).abs() <= UNUSUAL * wide;
    }
}

/// Those that are not far from the others: where a slip was not seen, the next reversal seems to go
/// farther.
fn usual(values: Vec<(f64, usize)>) -> Vec<(f64, usize)> {
    let only: Vec<f64> = values.iter().map(|(value, _)| *value).collect();
    let (middle, wide) = (median(&mut only.clone()), spread(&only));
    values.into_iter().filter(|(value, _)| (value - middle).abs() <= UNUSUAL * wide).collect()
}
