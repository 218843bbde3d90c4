//! Analysis of sticks with known ends: the slope of z against T, the noise, and jumps that the
//! first search missed.

use super::detect::{Jump, Jumps};
use super::level::{self, Bin, Level, LevelSums};
use super::samples::{Samples, median};
use super::sticks::{bin, bins, sticks};

/// The results from the sticks between jumps.
pub struct StickAnalysis {
    /// Sums for the regression of z on T during sticks.
    pub sums: LevelSums,
    /// Length of the bins of that regression, in seconds.
    pub bin: f64,
    /// The level at each sample, from the samples of its stick up to it.
    pub before: Vec<Level>,
    /// The level at each sample, from it and the later samples of its stick.
    pub after: Vec<Level>,
    /// The variance that the level gains per second, in units of the white noise of a bin and of a
    /// sample.
    pub walks: [f64; 2],
    /// The standard deviation of the white noise of a sample.
    pub noise: f64,
}

/// A new jump must exceed this many standard deviations.
const NEW: f64 = 4.0;

/// A previously detected jump is kept if it exceeds this many standard deviations.
const KEPT: f64 = 3.5;

/// A new jump must have at least this fraction of the typical size.
const SHARE: f64 = 0.35;

/// A new jump must be the clearest within this many samples on each side.
const APART: usize = 3;

impl StickAnalysis {
    /// Analyse the sticks between these jumps, with bins of this many seconds for the regression of
    /// z on T, and with these variances of the walk, if they are known.
    pub fn new(
        samples: &Samples,
        found: &Jumps,
        seconds: f64,
        walks: Option<[f64; 2]>,
    ) -> StickAnalysis {
        let sticks = sticks(samples, found.indices());
        let binned = bins(samples, &sticks, seconds, found.window / 2 + 1);
        let of_bins = walks.map_or_else(|| level::fitted_walk(&binned), |walks| walks[0]);
        let single = |i: usize, first: usize| bin(samples, i..i + 1, i == first);
        let empty = || Vec::with_capacity(samples.times.len());
        let (mut forward, mut backward): (Vec<Bin>, Vec<Bin>) = (empty(), empty());
        for stick in &sticks {
            forward.extend(stick.clone().map(|i| single(i, stick.start)));
        }
        for stick in sticks.iter().rev() {
            backward.extend(stick.clone().rev().map(|i| single(i, stick.end - 1)));
        }
        let walk = walks.map_or_else(|| level::fitted_walk(&forward), |walks| walks[1]);
        let noise = level::sums(&forward, walk).variance().sqrt();
        let before = level::levels(&forward, walk);
        let mut after = level::levels(&backward, walk);
        after.reverse();
        StickAnalysis {
            sums: level::sums(&binned, of_bins),
            bin: seconds,
            before,
            after,
            walks: [of_bins, walk],
            noise,
        }
    }

    /// The slope of z against T.
    pub fn still(&self) -> f64 {
        self.sums.slope()
    }

    /// For each sample, the jump of the level before it, and that jump divided by its standard
    /// deviation.
    fn steps(&self, samples: &Samples) -> Vec<[f64; 2]> {
        let still = self.still();
        let mut steps = vec![[0.0; 2]; samples.times.len()];
        for stretch in samples.stretches() {
            for (i, step) in steps
                .iter_mut()
                .enumerate()
                .take(stretch.end)
                .skip(stretch.start + 1)
            {
                let (before, after) = (&self.before[i - 1], &self.after[i]);
                let size = after.minus_slope(still) - before.minus_slope(still);
                let walked = self.walks[1] * (samples.times[i] - samples.times[i - 1]);
                let variance = before.variance + after.variance + walked;
                *step = [size, size / (self.noise * variance.sqrt())];
            }
        }
        steps
    }

    /// The significant jumps when every level is estimated from its whole stick: those of `found`
    /// that are still clear enough, and new ones.
    pub fn jumps(&self, samples: &Samples, found: &Jumps) -> Jumps {
        let steps = self.steps(samples);
        let clear = |i: usize| steps[i][1].abs();
        let mut is_kept = vec![false; steps.len()];
        for jump in found.jumps.iter().filter(|jump| clear(jump.index) >= KEPT) {
            is_kept[jump.index] = true;
        }
        let kept = || (0..steps.len()).filter(|i| is_kept[*i]);
        let usual = median(&mut kept().map(|i| steps[i][0].abs()).collect::<Vec<_>>());
        let is_clearest = |i: usize| {
            let around = i.saturating_sub(APART)..(i + APART + 1).min(steps.len());
            around
                .into_iter()
                .all(|j| clear(j) <= clear(i) || is_kept[j])
        };
        let is_new =
            |i: usize| clear(i) >= NEW && steps[i][0].abs() >= SHARE * usual && is_clearest(i);
        let all = (0..steps.len()).filter(|i| is_kept[*i] || is_new(*i));
        let jumps = all
            .map(|index| Jump {
                index,
                size: steps[index][0],
            })
            .collect();
        Jumps {
            jumps,
            window: 1,
            contrast: usual / self.noise,
        }
    }
}
