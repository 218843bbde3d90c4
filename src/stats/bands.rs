//! Pointwise distribution of x, x' and T over the ensemble, row by row of the output grid.

use super::deterministic::Deterministic;
use super::{Band, Bands, QUANTILE_LEVELS};
use crate::model::Problem;
use crate::scheme::{Snapshot, Timeline};
use crate::sums::bins::Shape;
use crate::sums::interval::{ErrorLaw, Measured};
use crate::sums::moments::Moments;
use crate::sums::ordered::Ordered;
use crate::sums::range::{NORMAL, Range, Sample};
use crate::sums::sketch::Sketch;
use crate::sums::{Codec, Damaged, Reader};
use crate::sums::{Merge, Replicate};
use ndarray::Array2;
use std::borrow::Cow;
use std::sync::Arc;

/// The variables that have a band, in this order: x, x', T.
const VARIABLES: usize = 3;

/// The place of T among them.
const TEMPERATURE: usize = 2;

/// The values of these variables in a snapshot, each with one value per path.
fn variables<'a>(snapshot: &Snapshot<'a>) -> [&'a [f64]; VARIABLES] {
    [
        snapshot.displacement,
        snapshot.velocity,
        snapshot.temperature,
    ]
}

/// Mean and spread of each variable at each time: the part of the bands that consists of
/// floating-point sums.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BandSums {
    /// Moments of the means of units, one entry per row of the output grid.
    rows: [Vec<Moments>; VARIABLES],
    /// Sum over units of the squared deviations of their paths from the mean of the unit, one entry
    /// per row. It exists only where units are pairs, because a single path does not deviate from
    /// itself.
    within: Option<[Vec<f64>; VARIABLES]>,
}

impl Merge for BandSums {
    fn merge(&mut self, other: &Self) {
        self.rows.merge(&other.rows);
        if let Some(more) = &other.within {
            self.within
                .get_or_insert_with(|| no_squares(more[0].len()))
                .merge(more);
        }
    }
}

impl BandSums {
    pub fn empty(rows: usize) -> Self {
        BandSums {
            rows: std::array::from_fn(|_| vec![Moments::default(); rows]),
            within: None,
        }
    }

    /// Set row `row` of the output grid from all paths of the block. A row beyond the grid is
    /// ignored.
    pub fn fold(&mut self, row: usize, snapshot: &Snapshot<'_>, unit: Replicate) {
        let rows = self.rows[0].len();
        if row >= rows {
            return;
        }
        for (rows, values) in self.rows.iter_mut().zip(variables(snapshot)) {
            rows[row] = Moments::of(&unit.means(values));
        }
        if unit == Replicate::Pair {
            let within = self.within.get_or_insert_with(|| no_squares(rows));
            for (within, values) in within.iter_mut().zip(variables(snapshot)) {
                within[row] = values
                    .as_chunks()
                    .0
                    .iter()
                    .map(|[a, b]| 0.5 * (a - b) * (a - b))
                    .sum();
            }
        }
    }

    /// The variance of a variable over paths, row by row.
    fn variances(&self, variable: usize) -> Vec<f64> {
        let rows = self.rows[variable].iter();
        match &self.within {
            None => rows.map(Moments::variance).collect(),
            // The variance of 2n paths that form n pairs.
            Some(within) => {
                let of_pairs = |(m, &within): (&Moments, &f64)| {
                    (2.0 * m.m2 + within) / (2 * m.count - 1) as f64
                };
                rows.zip(&within[variable])
                    .map(|(m, within)| {
                        if m.count == 0 {
                            f64::NAN
                        } else {
                            of_pairs((m, within))
                        }
                    })
                    .collect()
            }
        }
    }
}

fn no_squares(rows: usize) -> [Vec<f64>; VARIABLES] {
    std::array::from_fn(|_| vec![0.0; rows])
}

impl Codec for BandSums {
    fn write(&self, out: &mut Vec<u8>) {
        self.rows.write(out);
        u64::from(self.within.is_some()).write(out);
        self.within.iter().for_each(|within| within.write(out));
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        self.rows.read(from)?;
        self.within = match from.value::<u64>()? {
            0 => None,
            1 => Some(no_squares(self.rows[0].len())),
            _ => return Err(Damaged),
        };
        self.within
            .iter_mut()
            .try_for_each(|within| within.read(from))
    }
}

/// All sketches together keep at most this many values, or half as many bins, which with everything
/// that belongs to them takes at most 100 MB. With more than 5859 rows of the output grid, the
/// lower of [`VALUES_PER_SKETCH`] applies instead.
const VALUES_TOGETHER: usize = 4_500_000;

/// The smallest and the largest number of values that one sketch keeps.
const VALUES_PER_SKETCH: [usize; 2] = [256, 2048];

/// Blocks wait until they have this many paths or this many values together. Then each sketch
/// counts the values of all of them in turn, so that its bins are read once for many blocks.
const WAITING_PATHS: usize = 1024;
const WAITING_VALUES: usize = 1 << 19;

/// The values of a block of paths, one by one.
#[derive(Clone, Debug, Default)]
struct BlockValues {
    paths: usize,
    /// x of all paths, then x', then T, for one row after another.
    values: Vec<f64>,
    /// Index in `values` at which each row begins; none for a row that was not observed.
    starts: Vec<Option<usize>>,
}

impl BlockValues {
    fn of(&self, variable: usize, row: usize) -> Option<&[f64]> {
        let start = (*self.starts.get(row)?)? + variable * self.paths;
        self.values.get(start..start + self.paths)
    }
}

/// The values of each variable at each time, and the number of static paths: the part of the bands
/// that consists of counts and merges exactly.
#[derive(Clone, Debug)]
pub(super) struct BandCounts {
    rows: [Vec<Sketch>; VARIABLES],
    /// The values of blocks that wait to be counted. They are in no sketch yet.
    waiting: Vec<Arc<BlockValues>>,
    /// For each row, the number of paths and how many of them are static.
    occupancy: Vec<[u64; 2]>,
}

impl Merge for BandCounts {
    fn merge(&mut self, other: &Self) {
        self.rows.merge(&other.rows);
        self.occupancy.merge(&other.occupancy);
        self.waiting.extend_from_slice(&other.waiting);
        let together = |of: fn(&BlockValues) -> usize| {
            self.waiting.iter().map(|block| of(block)).sum::<usize>()
        };
        if together(|block| block.paths) >= WAITING_PATHS
            || together(|block| block.values.len()) >= WAITING_VALUES
        {
            self.count_waiting();
        }
    }
}

impl BandCounts {
    /// Counts of no paths. The centres of the sketches are values that many paths may share: x0,
    /// where every path starts and where a path that never slips stays, and the velocity zero.
    pub fn empty(model: &Problem, rows: usize) -> Self {
        let [least, most] = VALUES_PER_SKETCH;
        let values = (VALUES_TOGETHER / (VARIABLES * rows)).clamp(least, most);
        let bins = (values / 2).max(least);
        let row = |centre| {
            Sketch::empty(Shape {
                centre,
                scale: None,
                values,
                bins,
            })
        };
        BandCounts {
            rows: [model.initial_displacement, 0.0, 0.0].map(|centre| vec![row(centre); rows]),
            waiting: Vec::new(),
            occupancy: vec![[0, 0]; rows],
        }
    }

    /// Set row `row` of the output grid from all paths of the block. A row beyond the grid is
    /// ignored.
    pub fn fold(&mut self, row: usize, snapshot: &Snapshot<'_>) {
        let (rows, paths) = (self.occupancy.len(), snapshot.is_static.len());
        if row >= rows {
            return;
        }
        if self.waiting.is_empty() {
            let values = Vec::with_capacity(VARIABLES * rows * paths);
            self.waiting.push(Arc::new(BlockValues {
                paths,
                values,
                starts: vec![None; rows],
            }));
        }
        let block = Arc::make_mut(&mut self.waiting[0]);
        block.starts[row] = Some(block.values.len());
        variables(snapshot)
            .iter()
            .for_each(|values| block.values.extend_from_slice(values));
        let is_static = snapshot.is_static.iter().map(|&s| u64::from(s)).sum();
        self.occupancy[row] = [paths as u64, is_static];
    }

    /// Count the values of the blocks that wait.
    fn count_waiting(&mut self) {
        let waiting = std::mem::take(&mut self.waiting);
        // This is the order in which the values lie in memory.
        for row in 0..self.occupancy.len() {
            for (variable, rows) in self.rows.iter_mut().enumerate() {
                let parts: Vec<&[f64]> = waiting
                    .iter()
                    .filter_map(|block| block.of(variable, row))
                    .collect();
                rows[row].extend_by_parts(&parts);
            }
        }
    }

    /// Counts the waiting values ([`Sketch::settle`]).
    pub fn settle(&mut self) {
        self.count_waiting();
        self.rows.iter_mut().flatten().for_each(Sketch::settle);
    }

    /// The same counts with all values in the sketches.
    fn normalised(&self) -> Cow<'_, Self> {
        let mut normalised = Cow::Borrowed(self);
        if !self.waiting.is_empty() {
            normalised.to_mut().count_waiting();
        }
        normalised
    }
}

impl PartialEq for BandCounts {
    fn eq(&self, other: &Self) -> bool {
        let (mine, theirs) = (self.normalised(), other.normalised());
        mine.rows == theirs.rows && mine.occupancy == theirs.occupancy
    }
}

impl Codec for BandCounts {
    fn write(&self, out: &mut Vec<u8>) {
        self.normalised().rows.write(out);
        self.occupancy.write(out);
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        self.waiting.clear();
        self.rows.read(from)?;
        self.occupancy.read(from)
    }
}

/// The bands of a run, from their sums and their counts.
pub(super) fn summary(
    sums: &BandSums,
    counts: &BandCounts,
    timeline: &Timeline,
    deterministic: Deterministic,
    unit: Replicate,
) -> Bands {
    let counts = counts.normalised();
    let band = |variable| band(sums, &counts, variable, deterministic, unit);
    let is_static = |(row, &[paths, still]): (usize, &[u64; 2])| {
        let is_random = !(deterministic.everything || row == 0 && deterministic.start);
        Sample {
            paths,
            units: paths / unit.size(),
            is_random,
        }
        .share(still)
    };
    Bands {
        time: timeline.output_times(),
        displacement: band(0),
        velocity: band(1),
        temperature: band(2),
        static_probability: counts
            .occupancy
            .iter()
            .map(|&[paths, still]| still as f64 / paths as f64)
            .collect(),
        static_probability_ends: counts.occupancy.iter().enumerate().map(is_static).collect(),
    }
}

/// The band of a variable; all values are in the sketches.
fn band(
    sums: &BandSums,
    counts: &BandCounts,
    variable: usize,
    deterministic: Deterministic,
    unit: Replicate,
) -> Band {
    let size = unit.size() as f64;
    let moments = &sums.rows[variable];
    let variances = sums.variances(variable);
    let rows = &counts.rows[variable];
    let values: Vec<Ordered> = rows.iter().map(Sketch::ordered).collect();
    let quantile = |level: f64| values.iter().map(move |row| row.quantile(level));
    let quantiles: Vec<f64> = QUANTILE_LEVELS.into_iter().flat_map(quantile).collect();
    let may_differ = |row: usize| !agrees_by_law(variable, row, deterministic);
    let ends_of = |level: f64| {
        values.iter().enumerate().map(move |(row, values)| {
            let [least, most] = [0.0, 1.0].map(|p| values.quantile(p));
            let is_point = least == most && !may_differ(row) && values.count() > unit.size();
            if is_point {
                [least; 2]
            } else {
                ends(values, level, size)
            }
        })
    };
    let random_units = |row: usize, moments: &Moments| may_differ(row).then_some(moments.count);
    let mean_ends = |(row, m): (usize, &Moments)| {
        let law = ErrorLaw::of_freedom(m.count.saturating_sub(1) as f64);
        Measured::mean(m, law)
            .in_range(Range::ANY, random_units(row, m))
            .interval()
    };
    let sd_ends = |(((row, m), variance), values): (((usize, &Moments), &f64), &Ordered)| {
        let sd = variance.sqrt();
        let (relative, law) = values.error_of_spread();
        let law = law.with_freedom(law.freedom / size);
        let error = if sd == 0.0 {
            0.0
        } else {
            sd * relative * size.sqrt()
        };
        Measured::spread(sd, error, law, m.count)
            .in_range(Range::NOT_NEGATIVE, random_units(row, m))
            .interval()
    };
    Band {
        mean: moments.iter().map(Moments::mean).collect(),
        mean_ends: moments.iter().enumerate().map(mean_ends).collect(),
        sd: variances.iter().map(|variance| variance.sqrt()).collect(),
        sd_ends: moments
            .iter()
            .enumerate()
            .zip(&variances)
            .zip(&values)
            .map(sd_ends)
            .collect(),
        quantiles: Array2::from_shape_fn((QUANTILE_LEVELS.len(), rows.len()), |(i, j)| {
            quantiles[i * rows.len() + j]
        }),
        quantile_ends: QUANTILE_LEVELS.into_iter().flat_map(ends_of).collect(),
    }
}

/// Whether agreement of all paths on a variable in a row follows from the scenario and not from
/// chance. At t = 0 each is at rest at x0. The temperature of two paths is the same where it is
/// known, at a sample of a pinned series or at t = 0, and nowhere else.
fn agrees_by_law(variable: usize, row: usize, deterministic: Deterministic) -> bool {
    deterministic.everything || row == 0 || variable == TEMPERATURE
}

/// The 95 % interval of a quantile by Woodruff's method, where `size` values form one independent
/// unit. The interval of the share of values below the quantile is read back through the quantiles.
fn ends(values: &Ordered, level: f64, size: f64) -> [f64; 2] {
    let n = values.count() as f64 / size;
    if n < 2.0 {
        return [f64::NAN; 2];
    }
    let half_width = NORMAL * (level * (1.0 - level) / n).sqrt();
    let low = if half_width < level {
        values.quantile(level - half_width)
    } else {
        f64::NEG_INFINITY
    };
    let high = if level + half_width < 1.0 {
        values.quantile(level + half_width)
    } else {
        f64::INFINITY
    };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::synthetic::model;
    use crate::sums::coverage::Coverage;
    use rand_distr::{Distribution, Normal, StandardUniform};
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::SeedableRng;

    /// The quantile of order p by Hyndman and Fan's definition 7.
    fn exact(values: &[f64], p: f64) -> f64 {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let rank = p * (sorted.len() - 1) as f64;
        let (below, above) = (sorted[rank.floor() as usize], sorted[rank.ceil() as usize]);
        below + (above - below) * rank.fract()
    }

    /// Three times 1000 paths, more than a sketch keeps one by one, of which one in seven is at x0:
    /// counting what waits after each part gives the same state as counting it at the end.
    #[test]
    fn counting_what_waits_changes_no_result() {
        let timeline = Timeline {
            end: 1.0,
            output_step: 1.0,
            period: None,
            after: 0.0,
        };
        let empty = || BandCounts::empty(&model(), timeline.rows());
        let bytes = |counts: &BandCounts| {
            let mut bytes = Vec::new();
            counts.write(&mut bytes);
            bytes
        };
        let mut rng = Pcg64Dxsm::seed_from_u64(40);
        let law = Normal::new(4.0, 1.5).unwrap();
        let (mut settled, mut whole) = (empty(), empty());
        for _ in 0..3 {
            let x0 = model().initial_displacement;
            let x: Vec<f64> = (0..1000)
                .map(|i| if i % 7 == 0 { x0 } else { law.sample(&mut rng) })
                .collect();
            let is_static: Vec<bool> = x.iter().map(|x| *x > 4.0).collect();
            let snapshot = Snapshot {
                time: 1.0,
                displacement: &x,
                velocity: &x,
                temperature: &x,
                is_static: &is_static,
            };
            let mut part = empty();
            part.fold(1, &snapshot);
            settled.merge(&part);
            settled.settle();
            assert!(settled.waiting.is_empty());
            whole.merge(&part);
            assert_eq!(bytes(&settled), bytes(&whole));
        }
    }

    /// Null: at one time, the intervals of mean, standard deviation, upper quartile and static
    /// probability cover the truth in 95 % of all ensembles of 200 paths. Here x is normal, and a
    /// path is static with probability 0.3. [`Coverage::assert_95_percent`] states the false-alarm
    /// rate.
    #[test]
    fn intervals_at_a_time_cover_what_they_bound() {
        let timeline = Timeline {
            end: 1.0,
            output_step: 1.0,
            period: None,
            after: 0.0,
        };
        let mut rng = Pcg64Dxsm::seed_from_u64(39);
        let law = Normal::new(4.0, 1.5).unwrap();
        let mut held: [Coverage; 4] = Default::default();
        for _ in 0..2000 {
            let mut part = (
                BandSums::empty(timeline.rows()),
                BandCounts::empty(&model(), timeline.rows()),
            );
            let x: Vec<f64> = (0..200).map(|_| law.sample(&mut rng)).collect();
            let uniform = |rng: &mut Pcg64Dxsm| Distribution::<f64>::sample(&StandardUniform, rng);
            let is_static: Vec<bool> = x.iter().map(|_| uniform(&mut rng) < 0.3).collect();
            let snapshot = Snapshot {
                time: 1.0,
                displacement: &x,
                velocity: &x,
                temperature: &x,
                is_static: &is_static,
            };
            part.0.fold(1, &snapshot, Replicate::Path);
            part.1.fold(1, &snapshot);
            let bands = summary(
                &part.0,
                &part.1,
                &timeline,
                Deterministic::NOTHING,
                Replicate::Path,
            );
            let x = &bands.displacement;
            // The upper quartile of the standard normal law is 0.674490. It is the fourth level,
            // and there are two times, so its index is 3 * 2 + 1 at the second time.
            let curves = [
                (&x.mean_ends, 1, 4.0),
                (&x.sd_ends, 1, 1.5),
                (&x.quantile_ends, 3 * 2 + 1, 4.0 + 1.5 * 0.674_490),
                (&bands.static_probability_ends, 1, 0.3),
            ];
            for (held, (ends, point, truth)) in held.iter_mut().zip(curves) {
                held.count(ends.low[point] <= truth && truth <= ends.high[point]);
            }
        }
        for (held, what) in held.iter().zip([
            "mean",
            "standard deviation",
            "upper quartile",
            "static probability",
        ]) {
            held.assert_95_percent(what);
        }
    }

    #[test]
    fn bands_merged_over_blocks_are_those_of_all_paths_at_once() {
        let timeline = Timeline {
            end: 1.0,
            output_step: 1.0,
            period: None,
            after: 0.0,
        };
        let normal = Normal::new(4.0, 1.5).unwrap();
        let mut rng = Pcg64Dxsm::seed_from_u64(3);
        // 5000 paths, two fifths of which have not left x0 = 6.
        let x: Vec<f64> = (0..5000)
            .map(|i| {
                if i % 5 < 2 {
                    6.0
                } else {
                    normal.sample(&mut rng)
                }
            })
            .collect();
        let empty = || {
            (
                BandSums::empty(timeline.rows()),
                BandCounts::empty(&model(), timeline.rows()),
            )
        };
        let (mut sums, mut counts) = empty();
        for block in x.chunks(256) {
            let mut part = empty();
            let is_static: Vec<bool> = block.iter().map(|&x| x == 6.0).collect();
            let v: Vec<f64> = block.iter().map(|x| x - 6.0).collect();
            let snapshot = Snapshot {
                time: 1.0,
                displacement: block,
                velocity: &v,
                temperature: &v,
                is_static: &is_static,
            };
            part.0.fold(1, &snapshot, Replicate::Path);
            part.1.fold(1, &snapshot);
            sums.merge(&part.0);
            counts.merge(&part.1);
        }
        let bands = summary(
            &sums,
            &counts,
            &timeline,
            Deterministic::NOTHING,
            Replicate::Path,
        );
        assert_eq!(
            (bands.time.clone(), bands.static_probability[1]),
            (vec![0.0, 1.0], 0.4)
        );
        assert!(bands.static_probability[0].is_nan() && bands.displacement.mean[0].is_nan());
        // The reference is computed in two passes over all values. Rounding is 1e-16 per value.
        let mean = x.iter().sum::<f64>() / 5000.0;
        let sd = (x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 4999.0).sqrt();
        assert!((bands.displacement.mean[1] - mean).abs() < 1e-12);
        assert!((bands.displacement.sd[1] - sd).abs() < 1e-12);
        for (i, &p) in QUANTILE_LEVELS.iter().enumerate() {
            // 5000 paths have more than the 2048 values that a sketch keeps. The 3000 that have
            // moved span nine standard deviations, and lie in bins that are a hundredth of one
            // wide.
            let exact = exact(&x, p);
            assert!(
                (bands.displacement.quantiles[[i, 1]] - exact).abs() <= 0.01 * sd,
                "{p}"
            );
            assert!(
                (bands.velocity.quantiles[[i, 1]] - (exact - 6.0)).abs() <= 0.01 * sd,
                "{p}"
            );
        }
        // The atom at x0 holds the quantiles from 0.53 to 0.96, so those between are exact.
        assert_eq!(bands.displacement.quantiles[[3, 1]], 6.0);
        assert_eq!(bands.velocity.quantiles[[3, 1]], 0.0);
    }
}
