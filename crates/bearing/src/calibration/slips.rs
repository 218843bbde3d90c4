//! The slips that are visible in a record: their times, temperatures and sizes.

use super::crossing::{Window, as_slips_say};
use super::detect::{self, Jumps, trimmed_slope};
use super::level::{Level, LevelSums};
use super::question::CalibrationError;
use super::samples::{MeasuredRecord, Samples, median, spread};
use super::stick_analysis::{StickAnalysis, block};
use super::sticks::bin_length;
use super::thermometer::Thermometer;
use super::zero::{Middle, ZeroColumns};

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
    /// The variance of that temperature, as far as samples do not tell it.
    pub variance: f64,
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

/// The difference between a slip and the one before it in the other direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reversal {
    /// By how many kelvin the temperature changed: 2 A - G.
    pub change: f64,
    /// The variance of that, as far as samples do not tell it.
    pub variance: f64,
    /// By how much the later slip is larger, in the unit of displacement.
    pub growth: f64,
    /// The time of the later slip, in seconds.
    pub time: f64,
    /// The index of the block whose weight it has.
    pub block: usize,
}

/// Everything that the samples show of slips, and of the sticks between them.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// The slips in order of time.
    pub slips: Vec<Slip>,
    /// For each slip that follows one in the other direction, the difference of their temperatures.
    pub reversals: Vec<Reversal>,
    /// Sums for the regression of z on T during sticks, for each block.
    pub sums: Vec<LevelSums>,
    /// The size of a usual jump divided by the standard deviation of the noise.
    pub contrast: f64,
    /// Length of the bins of that regression, in seconds.
    pub bin: f64,
    /// The thermometer, and how it moves between samples.
    pub thermometer: Thermometer,
    /// The movements of the zero of the sensor that the slips ask for.
    pub zero: ZeroColumns,
    /// Jumps that are no slips, but a zero that was set: the index of the first sample after each.
    pub set: Vec<usize>,
    /// The level at the start of the record, if a gap lies between it and the first slip that was
    /// seen.
    pub beginning: Option<Level>,
}

/// Reversals are some tens in a record, and their errors have long tails, so their mean under random
/// weights differs less from itself than from the truth, by this factor. It is measured in records with
/// little noise, in which nothing else makes f_s uncertain.
const FEW: f64 = 1.25;

/// Jumps that are less than this many steps of the resolution of the sensor may be such steps.
const COARSE: f64 = 3.5;

/// Largest number of repeated searches for slips.
const ROUNDS: usize = 6;

/// A value farther from the median than this many standard deviations is unusual.
const UNUSUAL: f64 = 2.5;

/// A value farther than this is unusual even if slips are larger.
const MOST_UNUSUAL: f64 = 4.0;

impl Evidence {
    /// Find the slips of a record whose thermometer, where it is rough, moves like this one; `None`
    /// if there are none.
    ///
    /// The first search compares windows and needs no knowledge of the bearing. The later ones use
    /// the sticks in between: how the level drifts, and where a level that is known from all
    /// samples of a stick jumps.
    pub fn find(record: &MeasuredRecord, rough: &Thermometer, resolution: f64) -> Option<Evidence> {
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
        let straight = rough.straight(record);
        // Means do not tell how a temperature moves between them.
        let is_told = record.averaged == [0.0; 2];
        let moves = |windows: &[(Window, f64)]| match is_told {
            true => as_slips_say(rough.clone(), straight.clone(), windows),
            false => rough.clone(),
        };
        let sticks = StickAnalysis::new(samples, &found, seconds)?;
        let evidence = Evidence::of(samples, moves, &found, &sticks, Vec::new())?;
        let jump = evidence
            .fit(&evidence.unweighted())
            .map_or(0.0, |(fit, _)| fit.motion.jump);
        let thermometer = evidence.thermometer.slipping(jump);
        let moves = |_: &[(Window, f64)]| thermometer.clone();
        let mut evidence = Evidence::of(samples, moves, &found, &sticks, Vec::new())?;
        let candidates: Vec<f64> = (found
            .indices()
            .chain(samples.starts.iter().copied().filter(|start| *start > 0)))
        .map(|i| 0.5 * (samples.times[i - 1] + samples.times[i]))
        .collect();
        for _ in 0..ROUNDS {
            let zero = ZeroColumns::asked_by(
                &evidence.middles(&evidence.unweighted()),
                &candidates,
                evidence.zero.start,
            );
            evidence.zero = zero;
            let set = evidence.jumps_of_zero();
            if set.is_empty() {
                break;
            }
            let set = [evidence.set, set].concat();
            evidence = Evidence::of(samples, moves, &found, &sticks, set)?;
        }
        Some(evidence)
    }

    /// The evidence from these jumps, of which those in `set` are no slips. `moves` says how the
    /// thermometer moves between samples, from when slips were seen and their directions.
    fn of(
        samples: &Samples,
        moves: impl Fn(&[(Window, f64)]) -> Thermometer,
        found: &Jumps,
        sticks: &StickAnalysis,
        set: Vec<usize>,
    ) -> Option<Evidence> {
        let still = sticks.still();
        let start = samples.times[0];
        let mut slips = Vec::with_capacity(found.jumps.len());
        let mut windows = Vec::with_capacity(found.jumps.len());
        let mut since = 0;
        for jump in found.jumps.iter().filter(|jump| !set.contains(&jump.index)) {
            let (i, sign) = (jump.index, jump.size.signum());
            let stretch = samples
                .starts
                .iter()
                .rev()
                .find(|start| **start <= i)
                .copied()
                .unwrap_or(0);
            let slip = Slip {
                index: i,
                time: 0.5 * (samples.times[i - 1] + samples.times[i]),
                sign,
                temperature: f64::NAN,
                variance: 0.0,
                before: sticks.before[i - 1],
                after: sticks.after[i],
                is_usual: false,
            };
            let since = samples.times[std::mem::replace(&mut since, i).max(stretch)];
            if slip.size(still) > 0.0 {
                slips.push(slip);
                windows.push((
                    Window {
                        since,
                        before: samples.times[i - 1],
                        after: samples.times[i],
                    },
                    sign,
                ));
            }
        }
        let thermometer = moves(&windows);
        for (slip, (window, sign)) in slips.iter_mut().zip(&windows) {
            let crossing = thermometer.crossing(window, *sign)?;
            (slip.temperature, slip.variance) = (crossing.temperature, crossing.variance);
        }
        mark_usual(&mut slips, still);
        let is_whole = |from: usize, to: usize| {
            !samples
                .starts
                .iter()
                .any(|start| (from + 1..=to).contains(start))
        };
        let reversals = usual(
            reversals(&slips, still, is_whole, |time| block(start, time)),
            thermometer.jump,
        );
        let first = slips.first()?;
        let beginning = (!is_whole(0, first.index)).then(|| sticks.after[0]);
        Some(Evidence {
            slips,
            reversals,
            sums: sticks.sums.clone(),
            contrast: found.contrast,
            bin: sticks.bin,
            thermometer,
            zero: ZeroColumns {
                start,
                ..ZeroColumns::default()
            },
            set,
            beginning,
        })
    }

    /// The slope of z against T during sticks, with these weights of the blocks.
    pub fn still(&self, weights: &[f64]) -> f64 {
        LevelSums::weighted(&self.sums, weights).slope()
    }

    /// f_d/(K beta), from the reversals, with these weights of the blocks, from which it differs by
    /// more than their mean does.
    pub fn kinetic_reach(&self, weights: &[f64]) -> f64 {
        let mean = |weights: &[f64]| {
            0.5 * self.mean(
                weights,
                self.reversals
                    .iter()
                    .map(|reversal| (reversal.change, reversal.block)),
            )
        };
        let usual = mean(&self.unweighted());
        usual + FEW * (mean(weights) - usual)
    }

    /// The mean of values, each with the index of its block, with these weights of the blocks.
    pub fn mean(&self, weights: &[f64], values: impl Iterator<Item = (f64, usize)>) -> f64 {
        let [sum, weight] = values.fold([0.0; 2], |[sum, all], (value, block)| {
            [sum + weights[block] * value, all + weights[block]]
        });
        sum / weight
    }

    /// The middles of the usual jumps, with these weights of the blocks.
    pub fn middles(&self, weights: &[f64]) -> Vec<Middle> {
        let still = self.still(weights);
        let kinetic = self.kinetic_reach(weights);
        let of = |slip: &Slip| Middle {
            time: slip.time,
            centre: slip.temperature - slip.sign * kinetic,
            place: slip.middle(still),
            weight: weights[self.block(slip.time)],
        };
        self.slips
            .iter()
            .filter(|slip| slip.is_usual)
            .map(of)
            .collect()
    }

    /// The slips that are none: the zero of the sensor moved there, by what z jumped to half of a
    /// usual slip.
    fn jumps_of_zero(&self) -> Vec<usize> {
        let still = self.still(&self.unweighted());
        let Some(line) = self.zero.line(&self.middles(&self.unweighted())) else {
            return Vec::new();
        };
        let sizes: Vec<f64> = self.slips.iter().map(|slip| slip.size(still)).collect();
        let usual = median(&mut sizes.clone());
        let is_set = |(slip, size): &(&Slip, f64)| {
            let step = line.zero.steps.iter().find(|(when, _)| *when == slip.time);
            step.is_some_and(|(_, step)| (slip.sign * size - step).abs() < 0.5 * usual)
        };
        self.slips
            .iter()
            .zip(sizes)
            .filter(is_set)
            .map(|(slip, _)| slip.index)
            .collect()
    }

    /// The readings that are means over a slip: of the two beside each jump, the one that is farther
    /// from the level on its side.
    pub fn mixed(&self, record: &MeasuredRecord) -> Vec<usize> {
        let seen: Vec<usize> = (0..record.times.len())
            .filter(|i| record.readings[*i].is_finite())
            .collect();
        let still = self.still(&self.unweighted());
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
        let still = self.still(&self.unweighted());
        let jump = median(
            &mut self
                .slips
                .iter()
                .map(|slip| slip.size(still))
                .collect::<Vec<_>>(),
        );
        match jump < COARSE * resolution {
            true => Err(CalibrationError::Coarse { jump, resolution }),
            false => Ok(()),
        }
    }

    /// The index of the block of a time.
    pub fn block(&self, time: f64) -> usize {
        block(self.zero.start, time)
    }

    /// A weight of 1 for each block.
    pub fn unweighted(&self) -> Vec<f64> {
        vec![1.0; self.sums.len()]
    }

    /// The evidence from the same slips with other temperatures of the samples.
    pub fn with_temperatures(&self, record: &MeasuredRecord) -> Option<Evidence> {
        let samples = &record.samples();
        let slips = self.slips.iter().map(|slip| detect::Jump {
            index: slip.index,
            size: slip.sign,
        });
        let set = self.set.iter().map(|index| detect::Jump {
            index: *index,
            size: 1.0,
        });
        let mut jumps: Vec<detect::Jump> = slips.chain(set).collect();
        jumps.sort_by_key(|jump| jump.index);
        let found = Jumps {
            jumps,
            window: 1,
            contrast: self.contrast,
        };
        let is_rough = self.thermometer.roughness > 0.0;
        let moves = |_: &[(Window, f64)]| {
            let rough = Thermometer::of(record);
            if is_rough { rough } else { rough.moving(0.0) }.slipping(self.thermometer.jump)
        };
        let sticks = StickAnalysis::new(samples, &found, self.bin)?;
        let zero = self.zero.clone();
        Some(Evidence {
            zero,
            ..Evidence::of(samples, moves, &found, &sticks, self.set.clone())?
        })
    }
}

/// Mark the slips that have the usual size.
fn mark_usual(slips: &mut [Slip], still: f64) {
    let sizes: Vec<f64> = slips.iter().map(|slip| slip.size(still)).collect();
    let middle = median(&mut sizes.clone());
    let single: Vec<f64> = sizes
        .iter()
        .copied()
        .filter(|size| (0.5..1.5).contains(&(size / middle)))
        .collect();
    let (middle, wide) = (median(&mut single.clone()), spread(&single));
    for (slip, size) in slips.iter_mut().zip(sizes) {
        slip.is_usual =
            (0.5..1.5).contains(&(size / middle)) && (size - middle).abs() <= UNUSUAL * wide;
    }
}

/// A jump of more than this many usual ones is that of several slips.
const TWO: f64 = 1.5;

/// The most reversals in a row that have one weight.
const IN_A_ROW: usize = 6;

/// The differences between slips and those before them in the other direction, each with the block
/// whose weight it has.
///
/// If the body turns twice in a row, the slip in between is in two differences, both of which its error
/// makes larger, or both smaller. With weights of their own they would count as independent, and
/// intervals of A would be too narrow by up to the root of 2; so they have one weight.
fn reversals(
    slips: &[Slip],
    still: f64,
    is_whole: impl Fn(usize, usize) -> bool,
    block: impl Fn(f64) -> usize,
) -> Vec<Reversal> {
    let size = |slip: &Slip| slip.size(still);
    let middle = median(&mut slips.iter().map(size).collect::<Vec<_>>());
    let mut all = Vec::new();
    let (mut row, mut of_row) = (0, 0);
    for pair in slips.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        // Of two slips between two samples, the temperature of one is known, and they are no single one.
        let is_single = size(&a).max(size(&b)) < TWO * middle;
        if a.sign == b.sign || !is_single || !is_whole(a.index, b.index) {
            row = 0;
            continue;
        }
        if row % IN_A_ROW == 0 {
            of_row = block(b.time);
        }
        row += 1;
        all.push(Reversal {
            change: (b.temperature - a.temperature) * b.sign,
            variance: a.variance + b.variance,
            growth: b.size(still) - a.size(still),
            time: b.time,
            block: of_row,
        });
    }
    all
}

/// The values that are not far from the median. If a slip was not seen, the difference at the next
/// reversal is too large by G, of which half tells them apart, within what makes sense for the scatter.
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

    /// Slips up, down, up, up and down, a day apart, with a threshold of 3 K to either side; each is in
    /// a block of its own. The first three make two differences that share a slip.
    #[test]
    fn differences_that_share_a_slip_have_one_weight() {
        let level = Level {
            reading: 0.0,
            temperature: 0.0,
            variance: 1.0,
        };
        let slip = |(index, (sign, temperature)): (usize, &(f64, f64))| {
            let (sign, temperature, time) = (*sign, *temperature, index as f64);
            Slip {
                index,
                time,
                sign,
                temperature,
                variance: 0.1,
                before: level,
                after: Level {
                    reading: sign,
                    ..level
                },
                is_usual: true,
            }
        };
        let turns = [
            (1.0, 3.0),
            (-1.0, -3.0),
            (1.0, 3.5),
            (1.0, 4.0),
            (-1.0, -2.0),
        ];
        let slips: Vec<Slip> = turns.iter().enumerate().map(slip).collect();
        let of = |is_whole: &dyn Fn(usize, usize) -> bool| -> Vec<(f64, usize)> {
            let all = reversals(&slips, 0.0, is_whole, |time| time as usize);
            all.iter()
                .map(|reversal| (reversal.change, reversal.block))
                .collect()
        };
        assert_eq!(of(&|_, _| true), [(6.0, 1), (6.5, 1), (6.0, 4)]);
        assert_eq!(of(&|from, _| from != 1), [(6.0, 1), (6.0, 4)]);
    }

    /// A difference that is 0.6 K too large stays where slips are of 2 K, and goes where they are of 1 K;
    /// 2.5 and 4 standard deviations are 0.37 and 0.59 K.
    #[test]
    fn a_slip_that_was_not_seen_makes_a_difference_unusual() {
        let of = |far: f64, jump: f64| {
            let values = [-0.2, -0.1, -0.1, 0.0, 0.0, 0.1, 0.1, 0.2, far].map(|off| Reversal {
                change: 16.0 + off,
                variance: 0.0,
                growth: 0.0,
                time: 0.0,
                block: 0,
            });
            usual(values.to_vec(), jump).len()
        };
        assert_eq!(
            [of(0.5, 2.0), of(0.5, 0.9), of(0.7, 2.0), of(0.3, 0.1)],
            [9, 8, 8, 9]
        );
    }
}
