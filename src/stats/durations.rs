//! Stick durations: their quantiles, the interval of their median, and their survival with the cut-off ones in it.

use super::batches::{BATCHES, batch_of};
use super::bins::Shape;
use super::codec::{Codec, Damaged, Reader, codec_of_fields};
use super::dyadic::nearest;
use super::interval::Measured;
use super::log_bins::{LogBins, LogGrid};
use super::median;
use super::ordered::Ordered;
use super::sketch::Sketch;
use super::steps::Steps;
use super::{Histogram, QUANTILE_LEVELS, StickDurations};
use crate::scheme::Timeline;

/// Fine bins that make one bin of the public histogram: 8 to an octave.
const COARSENING: i32 = 32;

/// Below this share of t_end, durations are binned evenly instead of logarithmically.
const RESOLUTION: f64 = 1.0 / (1u64 << 30) as f64;

/// So many durations of a batch are kept as they are, and so many bins are counted when there are more.
const LIMIT: usize = 4096;

/// The completed sticks of every path number with one residue.
#[derive(Clone, Debug, PartialEq)]
struct Batch {
    durations: Sketch,
    bins: LogBins,
}

codec_of_fields!(Batch { durations, bins });

impl Batch {
    /// Of durations in whole steps, or of any.
    fn empty(is_stepping: bool) -> Self {
        let floor = if is_stepping { 0 } else { i32::MIN };
        let shape = Shape { centre: 0.0, floor, values: LIMIT, bins: LIMIT };
        Batch { durations: Sketch::empty(shape), bins: LogBins::default() }
    }

    fn merge(&mut self, other: &Batch) {
        self.durations.merge(&other.durations);
        self.bins.merge(&other.bins);
    }
}

/// Counts of stick durations.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DurationCounts {
    grid: LogGrid,
    /// h, if all durations are multiples of it: they are then counted as whole numbers of steps.
    step: Option<f64>,
    completed: [Batch; BATCHES],
    censored: LogBins,
    first_completed: u64,
    first_censored: u64,
}

impl DurationCounts {
    pub fn empty(timeline: &Timeline) -> Self {
        DurationCounts {
            grid: LogGrid::new(timeline.end * RESOLUTION),
            step: None,
            completed: std::array::from_fn(|_| Batch::empty(false)),
            censored: LogBins::default(),
            first_completed: 0,
            first_censored: 0,
        }
    }

    /// The same, before anything is counted, where a scheme has a step.
    pub fn set_step(&mut self, step: Option<f64>) {
        self.step = step;
        self.completed = std::array::from_fn(|_| Batch::empty(step.is_some()));
    }

    /// A stick, j >= 1, of this path has ended.
    #[inline]
    pub fn completed(&mut self, path: u64, duration: f64) {
        let batch = &mut self.completed[batch_of(path)];
        batch.durations.push(match self.step {
            Some(step) => nearest(duration / step),
            None => duration,
        });
        batch.bins.push(self.grid.key(duration));
    }

    /// A stick, j >= 1, runs at t_end and has lasted so long.
    pub fn censored(&mut self, so_far: f64) {
        self.censored.push(self.grid.key(so_far));
    }

    /// A first stick has ended.
    #[inline]
    pub fn first_completed(&mut self) {
        self.first_completed += 1;
    }

    /// A first stick runs at t_end.
    pub fn first_censored(&mut self) {
        self.first_censored += 1;
    }

    /// What has counted nothing takes the step of the other.
    pub fn merge(&mut self, other: &DurationCounts) {
        if self.step != other.step && other.step.is_some() {
            debug_assert_eq!(self.step, None, "durations of different steps");
            self.set_step(other.step);
        }
        for (mine, more) in self.completed.iter_mut().zip(&other.completed) {
            mine.merge(more);
        }
        self.censored.merge(&other.censored);
        self.first_completed += other.first_completed;
        self.first_censored += other.first_censored;
    }

    /// The durations of all batches, in whole steps if there is a step.
    fn pooled(&self) -> Ordered {
        let mut pooled = Batch::empty(self.step.is_some()).durations;
        self.completed.iter().for_each(|batch| pooled.merge(&batch.durations));
        pooled.ordered()
    }

    /// The median with its interval.
    pub fn median(&self) -> Measured {
        let batches: Vec<Ordered> = self.completed.iter().map(|batch| batch.durations.ordered()).collect();
        match self.step {
            Some(step) => median::of_steps(&batches, &self.pooled()).times(step),
            None => median::continuous(&batches, &self.pooled()),
        }
    }

    /// Of the orders `QUANTILE_LEVELS`.
    fn quantiles(&self) -> Vec<f64> {
        let pooled = self.pooled();
        match self.step {
            Some(step) => {
                let steps = Steps::of(&pooled);
                QUANTILE_LEVELS.map(|p| steps.at_least(p).1 * step).to_vec()
            }
            None => QUANTILE_LEVELS.map(|p| pooled.quantile(p)).to_vec(),
        }
    }

    pub fn summary(&self) -> StickDurations {
        let mut bins = LogBins::default();
        self.completed.iter().for_each(|batch| bins.merge(&batch.bins));
        let (completed, censored) = (bins.bins(), self.censored.bins());
        let number = |bins: &[(i16, u64)]| bins.iter().map(|(_, count)| count).sum();
        let coarse = |bins: &[(i16, u64)]| bins.iter().map(|&(k, n)| (coarse_bin(k), n)).collect::<Vec<_>>();
        let (ended, cut) = (coarse(&completed), coarse(&censored));
        let first = ended.first().into_iter().chain(cut.first()).map(|b| b.0).min().unwrap_or(0);
        let end = ended.last().into_iter().chain(cut.last()).map(|b| b.0 + 1).max().unwrap_or(0);
        let counts = |bins: &[(i32, u64)]| {
            let mut counts = vec![0; (end - first) as usize];
            bins.iter().for_each(|&(bin, n)| counts[(bin - first) as usize] += n);
            counts
        };
        StickDurations {
            step: self.step,
            completed: number(&completed),
            censored: number(&censored),
            first_completed: self.first_completed,
            first_censored: self.first_censored,
            histogram: Histogram {
                edges: (first..=end).map(|edge| self.grid.edge(edge * COARSENING)).collect(),
                counts: counts(&ended),
            },
            censored_counts: counts(&cut),
            survival: survival(&completed, &censored, first, end),
            quantiles: self.quantiles(),
        }
    }
}

/// The public bin of a fine bin. Fine bin 0, a duration of exactly zero, belongs to the first.
fn coarse_bin(key: i16) -> i32 {
    (i32::from(key) - 1).max(0) / COARSENING
}

impl Codec for DurationCounts {
    fn write(&self, out: &mut Vec<u8>) {
        // Zero is no step.
        self.step.unwrap_or(0.0).write(out);
        self.completed.write(out);
        self.censored.write(out);
        self.first_completed.write(out);
        self.first_censored.write(out);
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        let mut step = 0.0_f64;
        step.read(from)?;
        if !(step >= 0.0 && step.is_finite()) {
            return Err(Damaged);
        }
        self.set_step(Some(step).filter(|step| *step > 0.0));
        self.completed.read(from)?;
        self.censored.read(from)?;
        self.first_completed.read(from)?;
        self.first_censored.read(from)
    }
}

/// Kaplan-Meier estimate of P(D > t) at the upper edges of the public bins `first..end`: the product of 1 - d/n, where n
/// sticks reached a fine bin and d of them ended in it. (E. L. Kaplan and P. Meier, *Nonparametric estimation from
/// incomplete observations*, Journal of the American Statistical Association 53 (1958).) A stick cut off in a bin counts as
/// having reached all of it, as with ties there.
fn survival(completed: &[(i16, u64)], censored: &[(i16, u64)], first: i32, end: i32) -> Vec<f64> {
    let mut at_risk: u64 = completed.iter().chain(censored).map(|(_, count)| count).sum();
    let mut surviving = 1.0;
    let (mut completed, mut censored) = (completed.iter().peekable(), censored.iter().peekable());
    let mut curve = Vec::with_capacity((end - first) as usize);
    for bin in first..end {
        loop {
            let next = completed.peek().into_iter().chain(censored.peek()).map(|b| b.0).min();
            let Some(key) = next.filter(|&key| coarse_bin(key) == bin) else { break };
            let ended = completed.next_if(|b| b.0 == key).map_or(0, |b| b.1);
            let cut = censored.next_if(|b| b.0 == key).map_or(0, |b| b.1);
            // In integers up to the one division: the last stick to end leaves exactly zero.
            surviving *= (at_risk - ended) as f64 / at_risk as f64;
            at_risk -= ended + cut;
        }
        curve.push(surviving);
    }
    curve
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timeline() -> Timeline {
        Timeline { end: 64.0, output_step: 64.0, period: None }
    }

    #[test]
    fn survival_is_that_of_the_textbook_example() {
        // Remission times in weeks of the 6-MP group of Freireich et al. (1963), the standard example (Cox and Oakes,
        // *Analysis of Survival Data*, table 1.1): 9 relapses, 12 censored; the estimates below are the printed ones.
        let relapsed = [6.0, 6.0, 6.0, 7.0, 10.0, 13.0, 16.0, 22.0, 23.0];
        let censored = [6.0, 9.0, 10.0, 11.0, 17.0, 19.0, 20.0, 25.0, 32.0, 32.0, 34.0, 35.0];
        let printed =
            [(6.0, 0.857), (7.0, 0.807), (10.0, 0.753), (13.0, 0.690), (16.0, 0.627), (22.0, 0.538), (23.0, 0.448)];
        let mut totals = DurationCounts::empty(&timeline());
        relapsed.iter().for_each(|&d| totals.completed(0, d));
        censored.iter().for_each(|&d| totals.censored(d));
        let summary = totals.summary();
        assert_eq!((summary.completed, summary.censored), (9, 12));
        // All these times differ by more than a public bin, but 22 and 23 (bins are 2 wide there).
        for (time, survival) in printed.into_iter().filter(|p| p.0 != 22.0) {
            let bin = summary.histogram.edges.windows(2).position(|e| e[0] <= time && time < e[1]).unwrap();
            assert!((summary.survival[bin] - survival).abs() <= 0.0005, "{time}: {}", summary.survival[bin]);
        }
    }

    #[test]
    fn public_bins_are_eighths_of_octaves_and_hold_every_stick_once() {
        let mut totals = DurationCounts::empty(&timeline());
        for i in 0..1000u64 {
            totals.completed(i, 0.75 + 0.001 * i as f64);
        }
        totals.completed(5, 0.0);
        let histogram = totals.summary().histogram;
        assert_eq!(histogram.edges.len(), histogram.counts.len() + 1);
        assert_eq!(histogram.edges[0], 0.0);
        for (edges, &count) in histogram.edges.windows(2).zip(&histogram.counts) {
            let inside = |d: f64| edges[0] <= d && d < edges[1];
            let expected = (0..1000).filter(|&i| inside(0.75 + 0.001 * i as f64)).count();
            assert_eq!(count, expected as u64 + u64::from(edges[0] == 0.0), "{edges:?}");
        }
        // Scale 64 / 2^30: the edges of the octave from 1 are 1, 9/8, 10/8, ... less that.
        for eighth in 8..14 {
            let edge = f64::from(eighth) / 8.0 - 64.0 / 2f64.powi(30);
            assert!(histogram.edges.contains(&edge), "{edge}");
        }
    }

    #[test]
    fn the_median_of_equal_paths_has_no_error() {
        let mut totals = DurationCounts::empty(&timeline());
        for path in 0..100 {
            [1.1, 2.3, 3.7].iter().for_each(|&d| totals.completed(path, d));
        }
        let e = totals.median().named(crate::stats::Statistic::StickDurationMedian);
        assert_eq!((e.estimate, e.standard_error, e.low, e.high), (2.3, 0.0, 2.3, 2.3));
    }

    #[test]
    fn few_sticks_bound_the_median_by_nothing() {
        let mut totals = DurationCounts::empty(&timeline());
        assert!(totals.median().named(crate::stats::Statistic::StickDurationMedian).estimate.is_nan());
        totals.completed(0, 1.0);
        let one = totals.median().named(crate::stats::Statistic::StickDurationMedian);
        assert_eq!(one.estimate, 1.0);
        assert!(one.low.is_nan() && one.high.is_nan());
        totals.completed(1, 2.0);
        let two = totals.median().named(crate::stats::Statistic::StickDurationMedian);
        assert_eq!((two.low, two.high), (0.0, f64::INFINITY));
    }
}
