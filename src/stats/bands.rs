//! Pointwise distribution of x, x' and T over the ensemble, row by row of the output grid.

use super::codec::codec_of_fields;
use super::moments::Moments;
use super::sketch::{Grid, Sketch, quantile};
use super::{Band, Bands, QUANTILE_LEVELS};
use crate::model::Model;
use crate::scheme::{Snapshot, Timeline};
use ndarray::Array2;

/// The variables that have a band, in this order: x, x', T.
const VARIABLES: usize = 3;

/// Their values in a snapshot.
fn variables<'a>(snapshot: &Snapshot<'a>) -> [&'a [f64]; VARIABLES] {
    [snapshot.displacement, snapshot.velocity, snapshot.temperature]
}

/// Mean and spread of each variable at each time: the floating-point half of the bands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BandSums {
    rows: [Vec<Moments>; VARIABLES],
}

impl BandSums {
    pub fn empty(rows: usize) -> Self {
        BandSums { rows: std::array::from_fn(|_| vec![Moments::default(); rows]) }
    }

    /// Row `row` of the output grid, of every path of the block.
    pub fn fold(&mut self, row: usize, snapshot: &Snapshot<'_>) {
        for (rows, values) in self.rows.iter_mut().zip(variables(snapshot)) {
            if let Some(slot) = rows.get_mut(row) {
                *slot = Moments::of(values);
            }
        }
    }

    pub fn merge(&mut self, other: &BandSums) {
        for (mine, more) in self.rows.iter_mut().flatten().zip(other.rows.iter().flatten()) {
            mine.merge(more);
        }
    }
}

codec_of_fields!(BandSums { rows });

/// One variable at one time: how often which value was seen.
#[derive(Clone, Debug, PartialEq)]
struct RowCounts {
    smallest: f64,
    largest: f64,
    sketch: Sketch,
}

impl Default for RowCounts {
    fn default() -> Self {
        RowCounts { smallest: f64::INFINITY, largest: f64::NEG_INFINITY, sketch: Sketch::default() }
    }
}

impl RowCounts {
    fn of(values: &[f64], grid: &Grid) -> Self {
        let (smallest, largest) = extremes(values);
        RowCounts { smallest, largest, sketch: Sketch::of(values, grid) }
    }

    fn merge(&mut self, other: &RowCounts) {
        self.smallest = self.smallest.min(other.smallest);
        self.largest = self.largest.max(other.largest);
        self.sketch.merge(&other.sketch);
    }
}

codec_of_fields!(RowCounts { smallest, largest, sketch });

/// Smallest and largest value, by eights so that compilers can vectorise it.
fn extremes(values: &[f64]) -> (f64, f64) {
    let (mut low, mut high) = ([f64::INFINITY; 8], [f64::NEG_INFINITY; 8]);
    let (chunks, rest) = values.as_chunks::<8>();
    let mut widen = |i: usize, v: f64| {
        low[i] = if v < low[i] { v } else { low[i] };
        high[i] = if v > high[i] { v } else { high[i] };
    };
    for chunk in chunks {
        (0..8).for_each(|i| widen(i, chunk[i]));
    }
    rest.iter().enumerate().for_each(|(i, &v)| widen(i, v));
    (low.into_iter().fold(f64::INFINITY, f64::min), high.into_iter().fold(f64::NEG_INFINITY, f64::max))
}

/// Which values each variable takes at each time, and how many paths are static: the half of the bands that merges exactly.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BandCounts {
    grids: [Grid; VARIABLES],
    rows: [Vec<RowCounts>; VARIABLES],
    /// Paths at each time, and how many of them are static.
    occupancy: Vec<[u64; 2]>,
}

impl BandCounts {
    /// Bins of x lie about x0, where every path starts and where a path that never slips stays.
    pub fn empty(model: &Model, rows: usize) -> Self {
        let scales = Scales::of(model);
        BandCounts {
            grids: [
                Grid::new(model.initial_displacement, scales.displacement),
                Grid::new(0.0, scales.velocity),
                Grid::new(0.0, scales.temperature),
            ],
            rows: std::array::from_fn(|_| vec![RowCounts::default(); rows]),
            occupancy: vec![[0, 0]; rows],
        }
    }

    /// Row `row` of the output grid, of every path of the block.
    pub fn fold(&mut self, row: usize, snapshot: &Snapshot<'_>) {
        for ((rows, grid), values) in self.rows.iter_mut().zip(&self.grids).zip(variables(snapshot)) {
            if let Some(slot) = rows.get_mut(row) {
                *slot = RowCounts::of(values, grid);
            }
        }
        if let Some(occupancy) = self.occupancy.get_mut(row) {
            let is_static = snapshot.is_static.iter().map(|&s| u64::from(s)).sum();
            *occupancy = [snapshot.is_static.len() as u64, is_static];
        }
    }

    pub fn merge(&mut self, other: &BandCounts) {
        for (mine, more) in self.rows.iter_mut().flatten().zip(other.rows.iter().flatten()) {
            mine.merge(more);
        }
        for (mine, more) in self.occupancy.iter_mut().zip(&other.occupancy) {
            mine[0] += more[0];
            mine[1] += more[1];
        }
    }
}

codec_of_fields!(BandCounts { rows, occupancy });

/// The bands from their two halves.
pub(super) fn summary(sums: &BandSums, counts: &BandCounts, timeline: &Timeline) -> Bands {
    let band = |variable: usize| {
        let (moments, rows) = (&sums.rows[variable], &counts.rows[variable]);
        let mut quantiles = Array2::from_elem((QUANTILE_LEVELS.len(), rows.len()), f64::NAN);
        for (mut column, row) in quantiles.columns_mut().into_iter().zip(rows) {
            let bins = row.sketch.bins();
            for (q, &p) in column.iter_mut().zip(&QUANTILE_LEVELS) {
                *q = quantile(&bins, &counts.grids[variable], (row.smallest, row.largest), p);
            }
        }
        Band {
            mean: moments.iter().map(Moments::mean).collect(),
            sd: moments.iter().map(|row| row.variance().sqrt()).collect(),
            quantiles,
        }
    };
    Bands {
        time: timeline.output_times(),
        displacement: band(0),
        velocity: band(1),
        temperature: band(2),
        static_probability: counts.occupancy.iter().map(|&[paths, still]| still as f64 / paths as f64).collect(),
    }
}

/// How large x - x0, x' and T typically are: a quarter of a bound of the linear response, friction left out. Bins are
/// 2^-8 of that wide near the centre; a wrong guess makes quantiles coarser or bins more numerous, never wrong.
struct Scales {
    displacement: f64,
    velocity: f64,
    temperature: f64,
}

impl Scales {
    fn of(model: &Model) -> Self {
        let (oscillator, temperature) = (&model.oscillator, &model.temperature);
        let noise = temperature.noise.map_or(0.0, |n| {
            let initial = match n.initial {
                crate::model::InitialNoise::At(v) => v.abs(),
                crate::model::InitialNoise::Stationary => 0.0,
            };
            n.intensity * n.stationary_sd().max(initial)
        });
        let amplitude = temperature.harmonics.iter().map(|h| h.amplitude.abs()).sum::<f64>() + noise;
        let displacement = oscillator.dilatation.abs() * amplitude
            + model.friction.static_force / oscillator.stiffness
            + model.initial_displacement.abs();
        Scales {
            displacement: displacement / 4.0,
            velocity: displacement * oscillator.natural_frequency() / 4.0,
            temperature: amplitude / 4.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::sketch::BIN_WIDTH;
    use crate::stats::synthetic::model;
    use rand_distr::{Distribution, Normal};
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::SeedableRng;

    /// Hyndman and Fan's definition 7.
    fn exact(values: &[f64], p: f64) -> f64 {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let rank = p * (sorted.len() - 1) as f64;
        let (below, above) = (sorted[rank.floor() as usize], sorted[rank.ceil() as usize]);
        below + (above - below) * rank.fract()
    }

    #[test]
    fn bands_merged_over_blocks_are_those_of_all_paths_at_once() {
        let timeline = Timeline { end: 1.0, output_step: 1.0, period: None };
        let (scales, normal) = (Scales::of(&model()), Normal::new(4.0, 1.5).unwrap());
        let mut rng = Pcg64Dxsm::seed_from_u64(3);
        // 5000 paths, two fifths of which have not left x0 = 6.
        let x: Vec<f64> = (0..5000).map(|i| if i % 5 < 2 { 6.0 } else { normal.sample(&mut rng) }).collect();
        let empty = || (BandSums::empty(timeline.rows()), BandCounts::empty(&model(), timeline.rows()));
        let (mut sums, mut counts) = empty();
        for block in x.chunks(256) {
            let mut part = empty();
            let is_static: Vec<bool> = block.iter().map(|&x| x == 6.0).collect();
            let v: Vec<f64> = block.iter().map(|x| x - 6.0).collect();
            let snapshot =
                Snapshot { time: 1.0, displacement: block, velocity: &v, temperature: &v, is_static: &is_static };
            part.0.fold(1, &snapshot);
            part.1.fold(1, &snapshot);
            sums.merge(&part.0);
            counts.merge(&part.1);
        }
        let bands = summary(&sums, &counts, &timeline);
        assert_eq!((bands.time.clone(), bands.static_probability[1]), (vec![0.0, 1.0], 0.4));
        assert!(bands.static_probability[0].is_nan() && bands.displacement.mean[0].is_nan());
        // Two passes over all values; rounding is 1e-16 a value.
        let mean = x.iter().sum::<f64>() / 5000.0;
        let sd = (x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 4999.0).sqrt();
        assert!((bands.displacement.mean[1] - mean).abs() < 1e-12);
        assert!((bands.displacement.sd[1] - sd).abs() < 1e-12);
        for (i, &p) in QUANTILE_LEVELS.iter().enumerate() {
            let exact = exact(&x, p);
            let bound = BIN_WIDTH * ((exact - 6.0).abs() + scales.displacement);
            assert!((bands.displacement.quantiles[[i, 1]] - exact).abs() <= bound, "{p}");
            let bound = BIN_WIDTH * ((exact - 6.0).abs() + scales.velocity);
            assert!((bands.velocity.quantiles[[i, 1]] - (exact - 6.0)).abs() <= bound, "{p}");
        }
        // The atom holds the quantiles from 0.53 to 0.96, so those in it are exact.
        assert_eq!(bands.displacement.quantiles[[3, 1]], 6.0);
        assert_eq!(bands.velocity.quantiles[[3, 1]], 0.0);
    }
}
