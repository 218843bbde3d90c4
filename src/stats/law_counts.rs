//! The counts of one law, such as that of stick durations: quantiles, the interval of the median,
//! and the survival function, which takes the censored phases into account.
//!
//! The words below are those of stick durations. Jumps and times from slip to slip are counted in
//! the same way.

use super::survival::Survival;
use super::{Distribution, Histogram, QUANTILE_LEVELS};
use crate::sums::Merge;
use crate::sums::batches::{BATCHES, batch_of};
use crate::sums::bins::Shape;
use crate::sums::codec::{Codec, Damaged, Reader};
use crate::sums::dyadic::{List, coarsen, coarsened, nearest, width};
use crate::sums::interval::Measured;
use crate::sums::log_scale::LogScale;
use crate::sums::ordered::Ordered;
use crate::sums::quantile;
use crate::sums::sketch::Sketch;
use crate::sums::steps::Steps;
use std::borrow::Cow;

/// The level of the bins of the public histogram: 8 bins per octave.
const PUBLIC: i32 = -3;

/// The level of the bins of survival curves: 256 bins per octave. If the bins of a batch are wider,
/// because it has many durations, its width is used.
const FINE: i32 = -8;

/// Below this share of the scale of a law, values are binned evenly instead of logarithmically. They
/// are differences of numbers of that scale, and little more than rounding. The share is large
/// enough for places to distinguish a whole number of steps from the edge of a bin just below it.
const RESOLUTION: f64 = 1.0 / (1u64 << 40) as f64;

/// A batch keeps up to this many durations one by one, and counts more than these in up to as many
/// bins. Since the scale has 128 octaves, these are never wider than those of the histogram.
const LIMIT: usize = 16_384;

/// Up to this many sticks are listed before they are counted in their batches.
const LISTED: usize = 8192;

/// The durations of the sticks of one batch that have ended, and so far of those that run at t_end.
type Batch = [Sketch; 2];
const ENDED: usize = 0;
const CENSORED: usize = 1;

/// The shape of the durations of this many batches together.
fn shape(scale: LogScale, batches: usize) -> Shape {
    Shape {
        centre: 0.0,
        scale: Some(scale),
        values: batches * LIMIT,
        bins: batches * LIMIT,
    }
}

/// Counts of the values of one law.
#[derive(Clone, Debug)]
pub(super) struct LawCounts {
    scale: LogScale,
    /// h, if all durations are multiples of h.
    step: Option<f64>,
    batches: [Batch; BATCHES],
    /// Sticks of a block that are in no batch yet, each with its batch and its duration, in the
    /// order in which they ended. [`LawCounts::merge`] counts them in the batches of the run,
    /// so that mostly a block has no batches of its own to fill.
    listed: Vec<(u32, f64)>,
}

/// Add the counts of `other`. Counts that are still empty take over the step of `other`.
impl Merge for LawCounts {
    fn merge(&mut self, other: &Self) {
        if self.step != other.step && other.step.is_some() {
            debug_assert_eq!(self.step, None, "durations of different steps");
            self.set_step(other.step);
        }
        self.batches.merge(&other.batches);
        count(&mut self.batches, &other.listed, self.step);
    }
}

impl LawCounts {
    /// No values. `scale` is the largest value that is to be expected, roughly; it determines the
    /// bins.
    pub fn empty(scale: f64) -> Self {
        let scale = LogScale::new(scale * RESOLUTION);
        let empty = |_| [0; 2].map(|_| Sketch::empty(shape(scale, 1)));
        LawCounts {
            scale,
            step: None,
            batches: std::array::from_fn(empty),
            listed: Vec::new(),
        }
    }

    /// Set the step of the scheme, if it has one, before anything is counted.
    pub fn set_step(&mut self, step: Option<f64>) {
        self.step = step;
    }

    /// A stick, j >= 1, of a path of this unit has ended.
    #[inline]
    pub fn completed(&mut self, unit: u64, duration: f64) {
        if self.listed.len() == self.listed.capacity() {
            self.make_room();
        }
        self.listed.push((batch_of(unit) as u32, duration));
    }

    #[cold]
    fn make_room(&mut self) {
        let mut listed = std::mem::take(&mut self.listed);
        count(&mut self.batches, &listed, self.step);
        listed.clear();
        listed.reserve(LISTED);
        self.listed = listed;
    }

    /// Counts the waiting values ([`Sketch::settle`]).
    pub fn settle(&mut self) {
        count(
            &mut self.batches,
            &std::mem::take(&mut self.listed),
            self.step,
        );
        self.batches.iter_mut().flatten().for_each(Sketch::settle);
    }

    /// The batches with all sticks in them.
    fn batches(&self) -> Cow<'_, [Batch; BATCHES]> {
        let mut batches = Cow::Borrowed(&self.batches);
        if !self.listed.is_empty() {
            count(batches.to_mut(), &self.listed, self.step);
        }
        batches
    }

    /// A stick, j >= 1, of a path of this unit runs at t_end and has lasted for `so_far`.
    pub fn censored(&mut self, unit: u64, so_far: f64) {
        self.batches[batch_of(unit)][CENSORED].push(so_far);
    }

    /// The durations of each batch, and those of all batches, in order.
    pub fn ordered(&self) -> OrderedLaw {
        let batches = self.batches();
        let mut pooled = Sketch::empty(shape(self.scale, BATCHES));
        // The only form of each, because the pooled bins would keep how fine a batch happens to be.
        batches
            .iter()
            .for_each(|batch| pooled.merge(&batch[ENDED].normalised()));
        let batches: Vec<Ordered> = batches.iter().map(|batch| batch[ENDED].ordered()).collect();
        let pooled = pooled.ordered();
        match self.step {
            Some(step) => OrderedLaw::Steps {
                step,
                batches: batches.iter().map(|batch| Steps::of(batch, step)).collect(),
                pooled: Steps::of(&pooled, step),
            },
            None => OrderedLaw::Continuous { batches, pooled },
        }
    }

    /// The median without the sticks of each batch; NaN where durations are whole numbers of steps.
    pub fn medians_without_each_batch(&self) -> [f64; BATCHES] {
        match self.step.map_or_else(|| Some(self.ordered()), |_| None) {
            Some(OrderedLaw::Continuous { batches, pooled }) => {
                std::array::from_fn(|batch| pooled.median_without(&batches[batch]))
            }
            _ => [f64::NAN; BATCHES],
        }
    }

    /// All reported numbers of the durations, given in order by `ordered`. `random_units` is the
    /// number of units with a completed stick, if these are random.
    pub fn summary(&self, ordered: &OrderedLaw, random_units: Option<u64>) -> Distribution {
        let batches = self.batches();
        let level = batches
            .iter()
            .flatten()
            .map(Sketch::finest_level)
            .fold(FINE, i32::max);
        let fine: Vec<[List; 2]> = batches
            .iter()
            .map(|batch| batch.each_ref().map(|of| of.counts(level)))
            .collect();
        // Durations of exactly zero belong to the first bin.
        let bins = |list: &List| {
            coarsen(list, (PUBLIC - level) as u32)
                .into_iter()
                .map(|(i, n)| ((i - 1).max(0), n))
        };
        let public: Vec<[List; 2]> = fine
            .iter()
            .map(|lists| lists.each_ref().map(|list| bins(list).collect()))
            .collect();
        let ends = public
            .iter()
            .flatten()
            .flat_map(|list| list.first().into_iter().chain(list.last()));
        let (first, end) = ends.fold((i64::MAX, 0), |(first, end), bin| {
            (first.min(bin.0), end.max(bin.0 + 1))
        });
        let first = first.min(end);
        let pooled = |which: usize| {
            let mut counts = vec![0; (end - first) as usize];
            public
                .iter()
                .flat_map(|of| &of[which])
                .for_each(|&(bin, n)| counts[(bin - first) as usize] += n);
            counts
        };
        let (counts, censored_counts) = (pooled(0), pooled(1));
        let bin_of =
            |index: i64| ((coarsened(index, (PUBLIC - level) as u32) - 1).max(0) - first) as usize;
        let survival = Survival::new(fine, bin_of, counts.len());
        let quantiles = QUANTILE_LEVELS.map(|p| ordered.quantile(p));
        Distribution {
            step: self.step,
            completed: counts.iter().sum(),
            censored: censored_counts.iter().sum(),
            histogram: Histogram {
                edges: (first..=end)
                    .map(|edge| self.scale.number(edge as f64 * width(PUBLIC)))
                    .collect(),
                counts,
            },
            censored_counts,
            survival_ends: survival.ends(random_units),
            survival: survival.curve,
            quantiles: quantiles
                .iter()
                .map(|quantile| quantile.estimate())
                .collect(),
            quantile_ends: quantiles
                .iter()
                .map(|quantile| quantile.interval())
                .collect(),
        }
    }
}

/// The durations of completed sticks in order, of each batch and of all batches together, in whole
/// steps if there is a step. Putting them in order takes long, so this is done once for all
/// statistics that need it.
pub(super) enum OrderedLaw {
    Continuous {
        batches: Vec<Ordered>,
        pooled: Ordered,
    },
    Steps {
        step: f64,
        batches: Vec<Steps>,
        pooled: Steps,
    },
}

impl OrderedLaw {
    /// The median with its interval.
    pub fn median(&self) -> Measured {
        self.quantile(0.5)
    }

    /// The quantile of order p with its interval.
    fn quantile(&self, p: f64) -> Measured {
        match self {
            OrderedLaw::Continuous { batches, pooled } => quantile::continuous(batches, pooled, p),
            OrderedLaw::Steps {
                step,
                batches,
                pooled,
            } => quantile::of_steps(batches, pooled, p).times(*step),
        }
    }
}

/// Count sticks in their batches. Each is given by its batch and its duration.
fn count(batches: &mut [Batch; BATCHES], sticks: &[(u32, f64)], step: Option<f64>) {
    for &(batch, duration) in sticks {
        let exact = step.map_or(duration, |step| nearest(duration / step) * step);
        batches[batch as usize][ENDED].push(exact);
    }
}

impl PartialEq for LawCounts {
    fn eq(&self, other: &Self) -> bool {
        (self.scale, self.step) == (other.scale, other.step) && self.batches() == other.batches()
    }
}

impl Codec for LawCounts {
    fn write(&self, out: &mut Vec<u8>) {
        // Zero stands for no step.
        self.step.unwrap_or(0.0).write(out);
        self.batches().write(out);
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        let step: f64 = from.value()?;
        if !(step >= 0.0 && step.is_finite()) {
            return Err(Damaged);
        }
        self.set_step(Some(step).filter(|step| *step > 0.0));
        self.batches.read(from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::coverage::Coverage;
    use rand_distr::{Distribution, Exp1, StandardUniform, Uniform};
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::SeedableRng;

    #[test]
    fn survival_is_that_of_the_textbook_example() {
        // Remission times in weeks of the 6-MP group of Freireich et al. (1963), the standard
        // example (Cox and Oakes, *Analysis of Survival Data*, table 1.1): 9 relapses and 12
        // censored. The estimates below are the printed ones.
        let relapsed = [6.0, 6.0, 6.0, 7.0, 10.0, 13.0, 16.0, 22.0, 23.0];
        let censored = [
            6.0, 9.0, 10.0, 11.0, 17.0, 19.0, 20.0, 25.0, 32.0, 32.0, 34.0, 35.0,
        ];
        let printed = [
            (6.0, 0.857),
            (7.0, 0.807),
            (10.0, 0.753),
            (13.0, 0.690),
            (16.0, 0.627),
            (22.0, 0.538),
            (23.0, 0.448),
        ];
        let mut totals = LawCounts::empty(64.0);
        relapsed.iter().for_each(|&d| totals.completed(0, d));
        censored.iter().for_each(|&d| totals.censored(0, d));
        let summary = totals.summary(&totals.ordered(), Some(21));
        assert_eq!((summary.completed, summary.censored), (9, 12));
        // All these times lie in different public bins, except 22 and 23 (bins are 2 wide there).
        for (time, survival) in printed.into_iter().filter(|p| p.0 != 22.0) {
            let bin = summary
                .histogram
                .edges
                .windows(2)
                .position(|e| e[0] <= time && time < e[1])
                .unwrap();
            assert!(
                (summary.survival[bin] - survival).abs() <= 0.0005,
                "{time}: {}",
                summary.survival[bin]
            );
        }
    }

    /// The sticks of the test below: their counts, and in order their durations and whether they
    /// are completed.
    fn alike_within_paths(paths: u64, rng: &mut Pcg64Dxsm) -> (LawCounts, Vec<(f64, bool)>) {
        let exponential =
            |mean: f64, rng: &mut Pcg64Dxsm| mean * Distribution::<f64>::sample(&Exp1, rng);
        let mut totals = LawCounts::empty(64.0);
        let mut sticks = Vec::new();
        for path in 0..paths {
            let is_short = Distribution::<f64>::sample(&StandardUniform, rng) < 0.5;
            let mean = if is_short { 0.5 } else { 2.0 };
            for _ in 0..Uniform::new(2, 9).expect("not empty").sample(rng) {
                let duration = exponential(mean, rng);
                let clock = exponential(3.0, rng);
                if duration <= clock {
                    totals.completed(path, duration);
                } else {
                    totals.censored(path, clock);
                }
                sticks.push((duration.min(clock), duration <= clock));
            }
        }
        sticks.sort_by(|a, b| a.0.total_cmp(&b.0));
        (totals, sticks)
    }

    /// The relative error of the survival function at a time by Greenwood's formula.
    fn greenwood_error(sticks: &[(f64, bool)], time: f64) -> f64 {
        let at_risk = |i: usize| (sticks.len() - i) as f64;
        let passed = sticks
            .iter()
            .enumerate()
            .take_while(|(_, stick)| stick.0 < time);
        let sum: f64 = passed
            .filter(|(_, s)| s.1)
            .map(|(i, _)| 1.0 / (at_risk(i) * (at_risk(i) - 1.0)))
            .sum();
        sum.sqrt()
    }

    /// Sticks that depend on each other within a path. A fair coin decides for a whole path whether
    /// the mean duration of its sticks is 1/2 or 2, and each stick is cut off by an independent
    /// clock of mean 3. P(D > t) is the mean of e^{-2t} and e^{-t/2}. (In a path of the program,
    /// sticks that end early leave room for others. Here the truth is known in closed form.)
    ///
    /// Null: the interval of the survival function covers the truth in 95 % of all ensembles, at
    /// each of three bins at which 88 %, 45 % and 7 % of the sticks last longer. So does the interval
    /// of the upper quartile.
    /// [`Coverage::assert_95_percent`] states the false-alarm rate. If sticks were taken for
    /// independent, as in Greenwood's formula, the coverage would be about 80 %.
    #[test]
    fn intervals_of_survival_cover_where_sticks_are_alike() {
        let (ensembles, paths) = (2000, 300_u64);
        let mut rng = Pcg64Dxsm::seed_from_u64(1958);
        let survival = |t: f64| ((-2.0 * t).exp() + (-t / 2.0).exp()) / 2.0;
        // The probability that a stick ends, and does so before t. Its density is that of D times
        // P(C > t) = e^{-t/3}, where C is the clock.
        let ended_by = |t: f64| {
            let of =
                |rate: f64| rate / (rate + 1.0 / 3.0) * (1.0 - (-(rate + 1.0 / 3.0) * t).exp());
            (of(2.0) + of(0.5)) / 2.0
        };
        let ended = ended_by(f64::INFINITY);
        let times = [0.1, 0.75, 4.0];
        let mut held: [Coverage; 3] = Default::default();
        let mut greenwood: [Coverage; 3] = Default::default();
        let mut quantiles = Coverage::default();
        for _ in 0..ensembles {
            let (totals, sticks) = alike_within_paths(paths, &mut rng);
            let summary = totals.summary(&totals.ordered(), Some(paths));
            let edges = &summary.histogram.edges;
            let bin = |time: f64| {
                edges
                    .windows(2)
                    .position(|e| e[0] <= time && time < e[1])
                    .expect("a bin")
            };
            for ((held, greenwood), bin) in held.iter_mut().zip(&mut greenwood).zip(times.map(bin))
            {
                let (low, high) = (
                    summary.survival_ends.low[bin],
                    summary.survival_ends.high[bin],
                );
                let truth = survival(edges[bin + 1]);
                assert!(
                    0.0 <= low
                        && low <= summary.survival[bin]
                        && summary.survival[bin] <= high
                        && high <= 1.0
                );
                held.count(low <= truth && truth <= high);
                let error = summary.survival[bin] * greenwood_error(&sticks, edges[bin + 1]);
                greenwood.count((summary.survival[bin] - truth).abs() <= 1.96 * error);
            }
            let (low, high) = (summary.quantile_ends.low[3], summary.quantile_ends.high[3]);
            quantiles.count(ended_by(low) / ended <= 0.75 && 0.75 <= ended_by(high) / ended);
        }
        for ((held, greenwood), time) in held.iter().zip(&greenwood).zip(times) {
            held.assert_95_percent(&format!("survival at {time}"));
            println!("of Greenwood's: {:.4}", greenwood.share());
        }
        assert!(greenwood[1].share() < 0.85, "{}", greenwood[1].share());
        quantiles.assert_95_percent("upper quartile");
    }

    /// Laws as they occur: over decades, of two humps of which one is a fiftieth wide, and on the
    /// lattice of a step.
    #[test]
    fn quantiles_are_exact_up_to_a_small_part_of_their_own_error() {
        let mut rng = Pcg64Dxsm::seed_from_u64(1938);
        let uniform = |rng: &mut Pcg64Dxsm| -> f64 { StandardUniform.sample(rng) };
        let exponential = |rng: &mut Pcg64Dxsm| -> f64 { Exp1.sample(rng) };
        for (name, step) in [
            ("decades", None),
            ("humps", None),
            ("lattice", Some(1e-3)),
            ("long lattice", Some(1e-5)),
        ] {
            for number in [300, 30_000, 600_000] {
                let mut counts = LawCounts::empty(64.0);
                counts.set_step(step);
                let mut values: Vec<f64> = Vec::new();
                for i in 0..number {
                    let value = match name {
                        "decades" => (-8.0 * exponential(&mut rng)).exp() * exponential(&mut rng),
                        "humps" if uniform(&mut rng) < 0.3 => {
                            3.0 + 0.03 * (uniform(&mut rng) + uniform(&mut rng))
                        }
                        "humps" => 1e-3 * exponential(&mut rng),
                        _ => exponential(&mut rng).powi(2),
                    };
                    counts.completed(i, value);
                    values.push(step.map_or(value, |step| nearest(value / step) * step));
                }
                values.sort_by(f64::total_cmp);
                let ordered = counts.ordered();
                for p in [0.05, 0.25, 0.5, 0.75, 0.95] {
                    // Definition 7 of Hyndman and Fan, and definition 1 on a lattice.
                    let at = |p: f64| match step {
                        Some(_) => {
                            values[((p * number as f64 * (1.0 - 1e-12)).ceil() as usize).max(1) - 1]
                        }
                        None => {
                            let rank = p * (number - 1) as f64;
                            let [below, above] =
                                [rank.floor(), rank.ceil()].map(|rank| values[rank as usize]);
                            below + (above - below) * rank.fract()
                        }
                    };
                    let error = (p * (1.0 - p) / number as f64).sqrt();
                    let [below, above] = [p - error, p + error].map(|p| at(p.clamp(0.0, 1.0)));
                    let off = (ordered.quantile(p).estimate() - at(p)).abs()
                        / (above - below).max(step.unwrap_or(0.0));
                    // As long as they are kept one by one, they are exact.
                    assert!(
                        number > 100_000 || off == 0.0,
                        "{name}, {number} values, {p}: {off}"
                    );
                    assert!(off < 0.1, "{name}, {number} values, {p}: {off}");
                }
            }
        }
    }

    /// Quantiles do not depend on how a run was cut into blocks, nor which of them were merged first, where
    /// batches count their values in bins.
    #[test]
    fn quantiles_do_not_depend_on_how_a_run_was_cut() {
        let values: Vec<f64> = Exp1
            .sample_iter(Pcg64Dxsm::seed_from_u64(7))
            .take(40 * LIMIT)
            .collect();
        // Most of the values are in a few batches.
        let unit = |i: usize| (i % 7) as u64;
        let cut = |block: usize| {
            let blocks = values.chunks(block).enumerate().map(|(number, values)| {
                let mut counts = LawCounts::empty(64.0);
                values
                    .iter()
                    .enumerate()
                    .for_each(|(i, value)| counts.completed(unit(number * block + i), *value));
                counts
            });
            let mut all = LawCounts::empty(64.0);
            blocks
                .collect::<Vec<_>>()
                .iter()
                .for_each(|block| all.merge(block));
            QUANTILE_LEVELS.map(|p| all.ordered().quantile(p).estimate())
        };
        let whole = cut(values.len());
        for block in [1000, 30_000, 200_000] {
            assert_eq!(cut(block), whole, "{block}");
        }
    }

    /// Blocks of 20 sticks are always listed, and one of 20 000 has most of its sticks in its
    /// batches. Some of these sticks are cut off.
    #[test]
    fn sticks_are_the_same_whether_they_are_listed_or_counted() {
        for step in [None, Some(1.0 / 1024.0)] {
            let empty = || {
                let mut counts = LawCounts::empty(64.0);
                counts.set_step(step);
                counts
            };
            let (mut whole, mut merged) = (empty(), LawCounts::empty(64.0));
            for block in 0..1000 {
                let mut part = empty();
                for stick in 0..20 {
                    let duration = f64::from((block * 20 + stick) * 7919 % 20_011) / 1024.0;
                    for counts in [&mut whole, &mut part] {
                        counts.completed(block as u64, duration);
                        if stick == 0 {
                            counts.censored(block as u64, duration);
                        }
                    }
                }
                merged.merge(&part);
            }
            assert_eq!(
                (whole.listed.len(), merged.listed.len()),
                (20_000 % LISTED, 0)
            );
            assert_eq!(whole, merged);
            assert_eq!(whole.ordered().median(), merged.ordered().median());
            assert_eq!(
                whole.medians_without_each_batch().map(f64::to_bits),
                merged.medians_without_each_batch().map(f64::to_bits)
            );
            let bytes = |counts: &LawCounts| {
                let mut bytes = Vec::new();
                counts.write(&mut bytes);
                bytes
            };
            assert_eq!(bytes(&whole), bytes(&merged));
            let summary = |counts: &LawCounts| counts.summary(&counts.ordered(), Some(1000));
            assert_eq!(
                format!("{:?}", summary(&whole)),
                format!("{:?}", summary(&merged))
            );
            // Counting what waits changes nothing, now and for sticks that come later.
            let mut settled = whole.clone();
            settled.settle();
            assert!(settled.listed.is_empty());
            assert_eq!(bytes(&settled), bytes(&whole));
            for counts in [&mut settled, &mut whole] {
                (0..9000).for_each(|stick| {
                    counts.completed(stick, f64::from(stick as u32 * 7919 % 20_011) / 1024.0)
                });
            }
            assert_eq!(bytes(&settled), bytes(&whole));
        }
    }

    #[test]
    fn a_curve_that_few_tell_is_not_certain() {
        let mut totals = LawCounts::empty(64.0);
        (0..4).for_each(|path| totals.completed(path, 1.0 + 0.4 * path as f64));
        let sticks = totals.summary(&totals.ordered(), Some(4));
        let (last, low, high) = (
            sticks.survival.len() - 1,
            &sticks.survival_ends.low,
            &sticks.survival_ends.high,
        );
        assert_eq!((sticks.survival[last], low[last]), (0.0, 0.0));
        assert!(high[last] > 0.2 && low[0] < 0.6, "{low:?} {high:?}");
        // Where nothing is random, every number is certain.
        let sticks = totals.summary(&totals.ordered(), None);
        assert_eq!(sticks.survival_ends.low, sticks.survival);
        assert_eq!(sticks.survival_ends.high, sticks.survival);
    }

    #[test]
    fn public_bins_are_eighths_of_octaves_and_hold_every_stick_once() {
        let mut totals = LawCounts::empty(64.0);
        for i in 0..1000u64 {
            totals.completed(i, 0.75 + 0.001 * i as f64);
        }
        totals.completed(5, 0.0);
        let histogram = totals.summary(&totals.ordered(), Some(1000)).histogram;
        assert_eq!(histogram.edges.len(), histogram.counts.len() + 1);
        assert_eq!(histogram.edges[0], 0.0);
        for (edges, &count) in histogram.edges.windows(2).zip(&histogram.counts) {
            let inside = |d: f64| edges[0] <= d && d < edges[1];
            let expected = (0..1000)
                .filter(|&i| inside(0.75 + 0.001 * i as f64))
                .count();
            assert_eq!(
                count,
                expected as u64 + u64::from(edges[0] == 0.0),
                "{edges:?}"
            );
        }
        // The scale is 64 / 2^40. The edges of the octave from 1 on are 1, 9/8, 10/8, ... less
        // that.
        for eighth in 8..14 {
            let edge = f64::from(eighth) / 8.0 - 64.0 / 2f64.powi(40);
            assert!(histogram.edges.contains(&edge), "{edge}");
        }
    }

    #[test]
    fn the_median_of_equal_paths_has_no_error() {
        let mut totals = LawCounts::empty(64.0);
        for path in 0..100 {
            [1.1, 2.3, 3.7]
                .iter()
                .for_each(|&d| totals.completed(path, d));
        }
        let e = totals.ordered().median().measurement();
        assert_eq!(
            (e.estimate, e.standard_error, e.low, e.high),
            (2.3, 0.0, 2.3, 2.3)
        );
    }

    #[test]
    fn few_sticks_bound_the_median_by_nothing() {
        let mut totals = LawCounts::empty(64.0);
        assert!(totals.ordered().median().measurement().estimate.is_nan());
        totals.completed(0, 1.0);
        let one = totals.ordered().median().measurement();
        assert_eq!(one.estimate, 1.0);
        assert!(one.low.is_nan() && one.high.is_nan());
        totals.completed(1, 2.0);
        let two = totals.ordered().median().measurement();
        assert_eq!((two.low, two.high), (0.0, f64::INFINITY));
    }
}
