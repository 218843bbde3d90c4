//! Autocovariance and power spectrum of x and x' on the output grid.
//!
//! Let y_n be x or x' at row n of a segment of L rows, a time s apart, and y_n' its deviation from
//! the mean over paths at the same time. So the common response of all paths to the forcing is
//! excluded: it is a separate line spectrum ([`Line`]). The spectrum is the mean over paths and
//! segments, which overlap by half, of the periodograms of tapered segments (P. D. Welch, *The use
//! of fast Fourier transform for the estimation of power spectra*, IEEE Transactions on Audio and
//! Electroacoustics 15 (1967)), which cannot be negative. With Hann's taper h_n,
//!
//! ```text
//! spectrum         S(w) = s mean |sum_n h_n y_n' e^{-i w n s}|^2 / sum_n h_n^2
//! autocovariance   C(l) = mean sum_n h_n y_n' h_{n+l} y_{n+l}' / sum_n h_n h_{n+l},   l = 0 .. L/2
//! ```
//!
//! S is two-sided: its integral over w from -pi/s to pi/s, divided by 2 pi, is the variance C(0),
//! exactly. At the frequencies w_k = 2 pi k/(N s), N >= 2 L a power of two, both follow from the
//! transform of the segments, padded with zeros to N rows.
//!
//! The mean over paths is that over the n paths of a block, so a block counts as n - 1 paths.
//! Values of S with their errors are never negative, so their intervals are those of chi squares,
//! with as many degrees of freedom as the scatter between batches of whole paths allows, and no
//! more than independent Gaussian paths would have.

use super::{Fluctuations, Line, Spectrum};
use crate::model::Problem;
use crate::scheme::{Snapshot, Timeline};
use crate::sums::Ends;
use crate::sums::batches::{BATCHES, batch_of};
use crate::sums::codec::sums_of_fields;
use crate::sums::fourier::{COLUMNS, Fourier, Numbers};
use crate::sums::interval::{Measured, student};
use crate::sums::jackknife::standard_error;
use crate::sums::range::NORMAL;

/// The longest segment.
const LONGEST: usize = 1024;

/// Number of variables: x and x'.
const VARIABLES: usize = 2;

/// How many harmonics of the forcing are reported as lines.
const LINES: usize = 8;

/// How the counted rows are divided into segments.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Segments {
    /// The first row that is counted.
    first_row: usize,
    /// L.
    length: usize,
    count: usize,
}

impl Segments {
    fn of(timeline: &Timeline) -> Self {
        let first_row = timeline.first_row();
        let rows = timeline.rows().saturating_sub(first_row);
        // The fewest that overlap by half and reach from the first row to the last.
        let count = (2 * rows).div_ceil(LONGEST).saturating_sub(1).max(1);
        Segments {
            first_row,
            length: if count == 1 {
                rows
            } else {
                2 * (rows / (count + 1))
            },
            count,
        }
    }

    /// The distance from one segment to the next.
    fn stride(self) -> usize {
        if self.count == 1 {
            self.length
        } else {
            self.length / 2
        }
    }

    /// The number of lags.
    fn lags(self) -> usize {
        self.length.div_ceil(2)
    }

    /// Hann's taper.
    fn taper(self) -> Vec<f64> {
        let turn = std::f64::consts::TAU / self.length as f64;
        (0..self.length)
            .map(|n| 0.5 - 0.5 * libm::cos(turn * (n as f64 + 0.5)))
            .collect()
    }

    /// sum_n h_n h_{n+l} at each lag l.
    fn overlaps(self) -> Vec<f64> {
        let taper = self.taper();
        let overlap = |l: usize| -> f64 { taper.iter().zip(&taper[l..]).map(|(a, b)| a * b).sum() };
        (0..self.lags()).map(overlap).collect()
    }

    /// N.
    fn padded(self) -> usize {
        (2 * self.length).next_power_of_two().max(2)
    }

    /// The number of frequencies from 0 to pi/s.
    fn frequencies(self) -> usize {
        self.padded() / 2 + 1
    }
}

/// Sums of |Y_k|^2 over the paths and segments of each batch, where Y_k is the transform of y'.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SpectrumSums {
    /// For each of the frequencies w_0, w_1, ..., w_{N/2} and each variable, the sums of the
    /// batches.
    powers: Vec<f64>,
    /// The number of paths times segments of each batch, where n paths of a block count as n - 1.
    weights: [f64; BATCHES],
    /// For each variable, the number of segments of blocks in which the paths differ.
    differing: [u64; VARIABLES],
    /// The period of the forcing; 0 if it has none.
    forcing_period: f64,
}

sums_of_fields!(SpectrumSums {
    powers,
    weights,
    differing
});

impl SpectrumSums {
    /// The sums of no paths.
    pub fn empty(model: &Problem, timeline: &Timeline) -> Self {
        SpectrumSums {
            powers: vec![0.0; BATCHES * VARIABLES * Segments::of(timeline).frequencies()],
            weights: [0.0; BATCHES],
            differing: [0; VARIABLES],
            forcing_period: model.temperature.period().unwrap_or(0.0),
        }
    }

    /// The sums of a variable over all batches but one, divided by their weight.
    fn mean_power(&self, variable: usize, without: Option<usize>) -> Vec<f64> {
        let frequencies = self.powers.len() / (BATCHES * VARIABLES);
        let sum = |of: &[f64]| -> f64 {
            (0..BATCHES)
                .filter(|batch| Some(*batch) != without)
                .map(|b| of[b])
                .sum()
        };
        // Paths that do not differ have no spectrum.
        let weight = if self.differing[variable] == 0 {
            f64::NAN
        } else {
            sum(&self.weights)
        };
        let at = |k: usize| {
            sum(&self.powers[(k * VARIABLES + variable) * BATCHES..][..BATCHES]) / weight
        };
        (0..frequencies).map(at).collect()
    }

    /// Autocovariance and spectrum, and the lines of the mean motion, which `bands` has at every
    /// row.
    pub fn summary(&self, timeline: &Timeline, mean_motion: [&[f64]; VARIABLES]) -> Spectrum {
        let segments = Segments::of(timeline);
        let spacing = timeline.output_step;
        let fourier = Fourier::new(segments.padded());
        let overlaps = segments.overlaps();
        let [displacement, velocity] = std::array::from_fn(|variable| {
            self.fluctuations(variable, segments, spacing, &fourier, &overlaps)
        });
        let frequency =
            |k: usize| std::f64::consts::TAU * k as f64 / (segments.padded() as f64 * spacing);
        Spectrum {
            segments: segments.count as u64,
            lag: (0..segments.lags()).map(|l| l as f64 * spacing).collect(),
            frequency: (0..segments.frequencies()).map(frequency).collect(),
            displacement,
            velocity,
            lines: lines(self.forcing_period, timeline, segments, mean_motion),
        }
    }

    /// Autocovariance and spectrum of a variable. `overlaps` are those of the segments.
    fn fluctuations(
        &self,
        variable: usize,
        segments: Segments,
        spacing: f64,
        fourier: &Fourier,
        overlaps: &[f64],
    ) -> Fluctuations {
        let batches = (0..BATCHES).filter(|batch| self.weights[*batch] > 0.0);
        let powers: Vec<Vec<f64>> = std::iter::once(None)
            .chain(batches.map(Some))
            .map(|without| self.mean_power(variable, without))
            .collect();
        let covariance = |products: Vec<f64>| -> Vec<f64> {
            products
                .iter()
                .zip(overlaps)
                .map(|(product, overlap)| product / overlap)
                .collect()
        };
        let covariances: Vec<Vec<f64>> = self
            .transformed(fourier, &powers)
            .into_iter()
            .map(covariance)
            .collect();
        let energy = overlaps.first().copied().unwrap_or(f64::NAN);
        let scale = |power: f64| power * spacing / energy;
        let spectra: Vec<Vec<f64>> = powers
            .into_iter()
            .map(|powers| powers.into_iter().map(scale).collect())
            .collect();
        let paths = self.weights.iter().sum::<f64>() / segments.count as f64 + 1.0;
        let least = self.least_variance(segments);
        let last = segments.frequencies() - 1;
        Fluctuations {
            autocovariance_ends: ends(&covariances, |_, value, without| {
                match without.len() as u64 {
                    0..FEWEST => [f64::NAN; 2],
                    _ => Measured::jackknifed(value, without)
                        .about_mean_of(paths)
                        .interval(),
                }
            }),
            spectrum_ends: ends(&spectra, |k, value, without| {
                // The transform is real at both ends, and its square has half the freedom.
                let is_real = k == 0 || k == last;
                let least = if is_real { 2.0 * least } else { least };
                power_interval(value, without, least)
            }),
            autocovariance: covariances.into_iter().next().unwrap_or_default(),
            spectrum: spectra.into_iter().next().unwrap_or_default(),
        }
    }

    /// The relative variance of a value of the spectrum of independent Gaussian paths. Segments that
    /// overlap by half under Hann's taper are correlated by 1/6.
    fn least_variance(&self, segments: Segments) -> f64 {
        let count = segments.count as f64;
        (1.0 + (count - 1.0) / count / 18.0) / self.weights.iter().sum::<f64>()
    }

    /// For each sequence of N/2 + 1 numbers p_k, its cosine transform
    /// 1/N sum_{k=0}^{N-1} p_k cos(2 pi j k/N), where p_{N-k} = p_k.
    fn transformed(&self, fourier: &Fourier, sequences: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut out = Vec::with_capacity(sequences.len());
        for columns in sequences.chunks(COLUMNS) {
            let half = columns[0].len() - 1;
            let length = 2 * half;
            let mut real: Vec<Numbers> = vec![[0.0; COLUMNS]; length];
            for (column, sequence) in columns.iter().enumerate() {
                for (k, row) in real.iter_mut().enumerate() {
                    row[column] = sequence[k.min(length - k)];
                }
            }
            fourier.transform(&mut real, &mut vec![[0.0; COLUMNS]; length]);
            let column = |column: usize| {
                (0..=half)
                    .map(|j| real[j][column] / length as f64)
                    .collect()
            };
            out.extend((0..columns.len()).map(column));
        }
        out
    }
}

/// An autocovariance needs this number of batches of paths for an interval.
const FEWEST: u64 = 5;

/// The ends of the intervals of a curve, from the curve and the curves without each batch: of a place,
/// the value there, and the values without each batch.
fn ends(curves: &[Vec<f64>], interval: impl Fn(usize, f64, &[f64]) -> [f64; 2]) -> Ends {
    let (curve, without) = (&curves[0], &curves[1..]);
    let at = |i: usize| {
        interval(
            i,
            curve[i],
            &without.iter().map(|curve| curve[i]).collect::<Vec<f64>>(),
        )
    };
    (0..curve.len()).map(at).collect()
}

/// The interval of a value of the spectrum, from the values without each batch and the least
/// relative variance.
fn power_interval(value: f64, without: &[f64], least: f64) -> [f64; 2] {
    let freedom = without.len().saturating_sub(1) as u64;
    let [error, wider] = if freedom == 0 {
        [0.0; 2]
    } else {
        [standard_error(without), student(freedom) / NORMAL]
    };
    chi_square(value, least.max((wider * error / value).powi(2)))
}

/// The 95 % interval of a positive number with this relative variance r, whose law is that of a chi
/// square with 2/r degrees of freedom: S nu/chi^2. The quantiles are those of E. B. Wilson and M. M.
/// Hilferty, *The distribution of chi-square*, PNAS 17 (1931), which are within 3 % from 6 degrees of
/// freedom on, and err on the safe side below.
fn chi_square(value: f64, relative_variance: f64) -> [f64; 2] {
    let ninth = relative_variance.min(1.0) / 9.0;
    [1.0, -1.0].map(|side| value / (1.0 - ninth + side * NORMAL * ninth.sqrt()).powi(3))
}

/// The amplitudes of the mean motion at the harmonics of the forcing, by Hann's window.
fn lines(
    period: f64,
    timeline: &Timeline,
    segments: Segments,
    mean_motion: [&[f64]; VARIABLES],
) -> Vec<Line> {
    let rows = timeline.rows().saturating_sub(segments.first_row);
    let counted = rows as f64 * timeline.output_step;
    let turn = std::f64::consts::TAU;
    // The window separates two lines that are four over its length apart.
    if period <= 0.0 || counted < 4.0 * period {
        return Vec::new();
    }
    let window = |n: usize| 1.0 - libm::cos(turn * (n as f64 + 0.5) / rows as f64);
    let amplitude = |motion: &[f64], frequency: f64| {
        let counted = motion.get(segments.first_row..).unwrap_or_default();
        let total: f64 = (0..counted.len()).map(window).sum();
        let mean = counted
            .iter()
            .enumerate()
            .map(|(n, y)| window(n) * y)
            .sum::<f64>()
            / total;
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (n, y) in counted.iter().enumerate() {
            let (sin, cos) = libm::sincos(frequency * n as f64 * timeline.output_step);
            real += window(n) * (y - mean) * cos;
            imaginary += window(n) * (y - mean) * sin;
        }
        2.0 * real.hypot(imaginary) / total
    };
    let highest = std::f64::consts::PI / timeline.output_step;
    let frequencies = (1..=LINES)
        .map(|n| n as f64 * turn / period)
        .take_while(|frequency| *frequency < highest);
    let line = |frequency| {
        let [displacement, velocity] = mean_motion.map(|motion| amplitude(motion, frequency));
        Line {
            frequency,
            displacement,
            velocity,
        }
    };
    frequencies.map(line).collect()
}

/// Transforms the paths of one block, segment by segment.
pub(super) struct SpectrumFold {
    segments: Segments,
    fourier: Fourier,
    taper: Vec<f64>,
    batches: Vec<usize>,
    /// The deviations of x and x' on the rows of the present segment, row after row.
    rows: [Vec<f64>; VARIABLES],
    /// For each variable, whether the paths have differed on a row.
    differ: [bool; VARIABLES],
    sums: SpectrumSums,
}

impl SpectrumFold {
    /// The paths of these units, added to sums of no paths.
    pub fn new(timeline: &Timeline, units: &[u64], sums: SpectrumSums) -> Self {
        let segments = Segments::of(timeline);
        SpectrumFold {
            segments,
            fourier: Fourier::new(segments.padded()),
            taper: segments.taper(),
            differ: [false; VARIABLES],
            batches: units.iter().map(|unit| batch_of(*unit)).collect(),
            rows: std::array::from_fn(|_| Vec::with_capacity(segments.length * units.len())),
            sums,
        }
    }

    /// Add a row of the output grid.
    pub fn row(&mut self, row: usize, snapshot: &Snapshot<'_>) {
        let (
            Segments {
                first_row, length, ..
            },
            paths,
        ) = (self.segments, self.batches.len());
        if length == 0 || row < first_row || paths < 2 {
            return;
        }
        for (variable, values) in [snapshot.displacement, snapshot.velocity]
            .into_iter()
            .enumerate()
        {
            let mean = values.iter().sum::<f64>() / paths as f64;
            self.rows[variable].extend(values.iter().map(|y| y - mean));
            self.differ[variable] |= values.iter().any(|y| *y != values[0]);
        }
        if self.rows[0].len() == length * paths {
            self.transform();
            self.rows
                .iter_mut()
                .for_each(|rows| drop(rows.drain(..self.segments.stride() * paths)));
        }
    }

    /// Adds the powers of a segment.
    fn transform(&mut self) {
        let (paths, length) = (self.batches.len(), self.segments.length);
        self.sums
            .differing
            .iter_mut()
            .zip(self.differ)
            .for_each(|(count, differ)| *count += u64::from(differ));
        let (padded, frequencies) = (self.segments.padded(), self.segments.frequencies());
        let [mut real, mut imaginary] = [const { Vec::<Numbers>::new() }; 2];
        for (chunk, batches) in self.batches.chunks(COLUMNS).enumerate() {
            // x is the real part and x' the imaginary part, so that one transform serves both.
            for (part, rows) in [&mut real, &mut imaginary].into_iter().zip(&self.rows) {
                part.clear();
                part.resize(padded, [0.0; COLUMNS]);
                for ((numbers, row), taper) in part
                    .iter_mut()
                    .zip(rows.chunks(paths))
                    .zip(&self.taper)
                    .take(length)
                {
                    let columns = &row[chunk * COLUMNS..][..batches.len()];
                    numbers
                        .iter_mut()
                        .zip(columns)
                        .for_each(|(number, y)| *number = taper * y);
                }
            }
            self.fourier.transform(&mut real, &mut imaginary);
            // Mostly the columns belong to successive batches.
            let first = batches[0];
            let is_in_a_row = batches.len() == COLUMNS
                && batches
                    .iter()
                    .zip(first..)
                    .all(|(batch, next)| *batch == next);
            for k in 0..frequencies {
                let mirrored = (padded - k) % padded;
                let [a, b, c, d] = [real[k], real[mirrored], imaginary[k], imaginary[mirrored]];
                let square = |y: f64, z: f64| 0.25 * (y * y + z * z);
                let power = |of: fn([f64; 4]) -> [f64; 2]| -> Numbers {
                    std::array::from_fn(|i| {
                        let [y, z] = of([a[i], b[i], c[i], d[i]]);
                        square(y, z)
                    })
                };
                let powers = [
                    power(|[a, b, c, d]| [a + b, c - d]),
                    power(|[a, b, c, d]| [c + d, a - b]),
                ];
                for (variable, powers) in powers.iter().enumerate() {
                    let sums =
                        &mut self.sums.powers[(k * VARIABLES + variable) * BATCHES..][..BATCHES];
                    match sums.get_mut(first..first + COLUMNS).filter(|_| is_in_a_row) {
                        Some(sums) => sums
                            .iter_mut()
                            .zip(powers)
                            .for_each(|(sum, power)| *sum += power),
                        None => batches
                            .iter()
                            .zip(powers)
                            .for_each(|(batch, power)| sums[*batch] += power),
                    }
                }
            }
            let weight = (paths - 1) as f64 / paths as f64;
            batches
                .iter()
                .for_each(|batch| self.sums.weights[*batch] += weight);
        }
    }

    /// The sums of all segments.
    pub fn finish(self) -> SpectrumSums {
        self.sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::synthetic::model;
    use crate::sums::coverage::Coverage;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::SeedableRng;

    /// The spectrum of paths whose x is y_{n+1} = y_n/2 + a normal, and whose x' is `velocity`.
    fn spectrum(rng: &mut Pcg64Dxsm, paths: usize, rows: usize, velocity: f64) -> Spectrum {
        let timeline = Timeline {
            end: (rows - 1) as f64,
            output_step: 1.0,
            period: None,
            after: 0.0,
        };
        let numbers: Vec<u64> = (0..paths as u64).collect();
        let mut fold = SpectrumFold::new(
            &timeline,
            &numbers,
            SpectrumSums::empty(&model(), &timeline),
        );
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let mut x: Vec<f64> = (0..paths).map(|_| normal() / 0.75f64.sqrt()).collect();
        for row in 0..rows {
            x.iter_mut().for_each(|x| *x = 0.5 * *x + normal());
            let (v, is_static) = (vec![velocity; paths], vec![false; paths]);
            let seen = Snapshot {
                time: row as f64,
                displacement: &x,
                velocity: &v,
                temperature: &v,
                is_static: &is_static,
            };
            fold.row(row, &seen);
        }
        fold.finish().summary(&timeline, [&[], &[]])
    }

    /// S(w) = 1/|1 - e^{-iw}/2|^2. Null: the interval holds it in 95 % of all ensembles, from two paths
    /// on, in one segment and in three, at a low, a middle and a high frequency; 1000 ensembles of each,
    /// so a share is off by 0.7 % in the standard deviation. Two paths err on the safe side, by the
    /// approximation of the quantiles. An error of 2 in the variance would give 83 or 99.4 %.
    #[test]
    fn intervals_of_a_spectrum_hold_the_truth_from_two_paths_on() {
        let mut rng = Pcg64Dxsm::seed_from_u64(1967);
        for (paths, rows, least) in [
            (2, 200, 0.93),
            (5, 200, 0.93),
            (40, 200, 0.93),
            (8, 2000, 0.93),
        ] {
            let mut held = Coverage::default();
            for _ in 0..334 {
                let found = spectrum(&mut rng, paths, rows, 0.0);
                for share in [0.1, 0.4, 0.8] {
                    let k = (share * found.frequency.len() as f64) as usize;
                    let truth = 1.0 / (1.25 - libm::cos(found.frequency[k]));
                    let [low, high] = found.displacement.spectrum_ends.at(k);
                    assert!(
                        0.0 < low && low < high && high.is_finite(),
                        "{paths}: {low} {high}"
                    );
                    held.count(low <= truth && truth <= high);
                }
            }
            println!("{paths} paths, {rows} rows: {}", held.share());
            assert!(
                (least..0.985).contains(&held.share()),
                "{paths} paths, {rows} rows: {}",
                held.share()
            );
        }
    }

    /// The integral of S is the variance, which is 4/3, and S is positive everywhere. What is the same in
    /// all paths has no spectrum.
    #[test]
    fn the_integral_of_a_spectrum_is_the_variance() {
        let found = spectrum(&mut Pcg64Dxsm::seed_from_u64(2), 300, 1500, 0.25);
        let of = &found.displacement;
        let inside: f64 = of.spectrum[1..of.spectrum.len() - 1].iter().sum();
        let integral = (of.spectrum[0] + of.spectrum[of.spectrum.len() - 1] + 2.0 * inside)
            * found.frequency[1]
            / std::f64::consts::TAU;
        assert!(
            (integral - of.autocovariance[0]).abs() < 1e-12 && (integral - 4.0 / 3.0).abs() < 0.03,
            "{integral}"
        );
        assert!(
            (of.autocovariance[3] - integral / 8.0).abs() < 0.02,
            "{:?}",
            &of.autocovariance[..4]
        );
        assert!(of.spectrum.iter().all(|power| *power > 0.0) && found.segments == 2);
        assert!(
            found
                .velocity
                .spectrum
                .iter()
                .chain(&found.velocity.autocovariance)
                .all(|value| value.is_nan())
        );
    }

    /// The line of a mean motion a cos(w t + phi) at the period of the forcing is a, and a w for its
    /// velocity, from five periods on; its other harmonics are zero. From fewer than four there are
    /// no lines.
    #[test]
    fn a_line_is_the_amplitude_of_the_mean_motion() {
        let (amplitude, period) = (1.7, 10.0);
        let rate = std::f64::consts::TAU / period;
        for (periods, wanted) in [(3.9, 0), (5.0, LINES), (21.3, LINES)] {
            let timeline = Timeline {
                end: 12.0 + periods * period,
                output_step: 0.1,
                period: Some(period),
                after: 12.0,
            };
            let time = |row: usize| 0.1 * row as f64;
            let motion = |of: fn(f64) -> f64| -> Vec<f64> {
                (0..timeline.rows())
                    .map(|row| of(rate * time(row) + 0.4))
                    .collect()
            };
            let x: Vec<f64> = motion(f64::cos)
                .iter()
                .map(|y| 9.0 + amplitude * y)
                .collect();
            let v: Vec<f64> = motion(f64::sin)
                .iter()
                .map(|y| -amplitude * rate * y)
                .collect();
            let found = lines(period, &timeline, Segments::of(&timeline), [&x, &v]);
            assert_eq!(found.len(), wanted, "{periods}");
            for (n, line) in (1..).zip(found) {
                let is_first = f64::from(u8::from(n == 1));
                assert!((line.frequency - f64::from(n) * rate).abs() < 1e-12);
                for (seen, of) in [
                    (line.displacement, amplitude),
                    (line.velocity, amplitude * rate),
                ] {
                    assert!(
                        (seen - is_first * of).abs() < 0.01 * of,
                        "{periods}: {n} {seen}"
                    );
                }
            }
        }
    }
}
