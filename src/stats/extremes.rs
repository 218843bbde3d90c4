//! Largest displacement and speed, and first passages of levels, on request.

use super::law_counts::LawCounts;
use super::measure::{Measure, Sampled};
use super::motion::MotionFold;
use super::{Extremes, PassageLevels, Passages, Statistic};
use crate::sums::codec::{sums, sums_of_fields};
use crate::sums::interval::Measured;
use crate::sums::range::Sample;
use crate::sums::spread::SpreadMoments;
use crate::sums::{Ends, Replicate};

sums! {
    /// Moments over paths of the largest |x - x0| and the largest |x'|.
    #[derive(Clone, Debug, Default, PartialEq)]
    pub(super) struct ExtremeSums {
        displacement: SpreadMoments,
        velocity: SpreadMoments,
    }
}

impl ExtremeSums {
    /// The sums over the paths of a block.
    pub fn of(paths: &[MotionFold], unit: Replicate) -> Self {
        let column = |i: usize| {
            SpreadMoments::of(
                &paths
                    .iter()
                    .map(|path| path.largest[i])
                    .collect::<Vec<f64>>(),
                unit,
            )
        };
        ExtremeSums {
            displacement: column(0),
            velocity: column(1),
        }
    }
}

impl Measure for ExtremeSums {
    fn measured(&self, statistic: Statistic, _: &Sampled) -> Option<Measured> {
        Some(match statistic {
            Statistic::LargestDisplacementMean => Measured::mean_of_four(&self.displacement.units),
            Statistic::LargestDisplacementSd => self.displacement.standard_deviation(),
            Statistic::LargestSpeedMean => Measured::mean_of_four(&self.velocity.units),
            Statistic::LargestSpeedSd => self.velocity.standard_deviation(),
            _ => return None,
        })
    }
}

/// Counts of the largest |x - x0| and |x'|, and of the paths that have not yet reached a level.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ExtremeCounts {
    levels: PassageLevels,
    largest: [LawCounts; 2],
    /// For each level and row of the output grid, the number of paths whose |x - x0| has stayed
    /// below the level until then.
    below: Vec<u64>,
}

sums_of_fields!(ExtremeCounts { largest, below });

impl ExtremeCounts {
    /// No paths, on this number of rows of the output grid. The largest duration and the largest length
    /// that are to be expected, roughly, determine the bins.
    pub fn empty(levels: PassageLevels, rows: usize, [time, length]: [f64; 2]) -> Self {
        let speed = if time > 0.0 { length / time } else { length };
        ExtremeCounts {
            levels,
            largest: [length, speed].map(LawCounts::empty),
            below: vec![0; levels.iter().count() * rows],
        }
    }

    pub fn settle(&mut self) {
        self.largest.iter_mut().for_each(LawCounts::settle);
    }

    /// The number of rows of the output grid.
    fn rows(&self) -> usize {
        self.below.len() / self.levels.iter().count()
    }

    /// Add the paths of a block at a row of the output grid, where they are at these x.
    pub fn row(&mut self, row: usize, paths: &[MotionFold], at: &[f64]) {
        let rows = self.rows();
        for (i, level) in self.levels.iter().enumerate() {
            let is_below = |(path, x): &(&MotionFold, &f64)| {
                path.largest[0].max((*x - path.start).abs()) < level
            };
            self.below[i * rows + row] += paths.iter().zip(at).filter(is_below).count() as u64;
        }
    }

    /// Add a path that has ended.
    pub fn end(&mut self, unit: u64, path: &MotionFold) {
        self.largest
            .iter_mut()
            .zip(path.largest)
            .for_each(|(counts, largest)| counts.completed(unit, largest));
    }

    /// The reported numbers. `random_units` is the number of units, if these are random.
    pub fn summary(&self, random_units: Option<u64>, sample: Sample) -> Extremes {
        let [displacement, velocity] = self
            .largest
            .each_ref()
            .map(|counts| counts.summary(&counts.ordered(), random_units));
        let passages =
            self.levels
                .iter()
                .zip(self.below.chunks(self.rows()))
                .map(|(level, below)| Passages {
                    level,
                    survival: below
                        .iter()
                        .map(|count| *count as f64 / sample.paths as f64)
                        .collect(),
                    survival_ends: below
                        .iter()
                        .map(|count| sample.share(*count))
                        .collect::<Ends>(),
                });
        Extremes {
            displacement,
            velocity,
            passages: passages.collect(),
        }
    }
}
