//! Autocovariance and power spectrum of x and x' on the output grid.
//!
//! Let y_n be x or x' at row n of a segment of L rows, a time s apart, and y_n' its deviation from
//! the mean over paths at the same time. So what the forcing does to all paths alike is left out:
//! it is a line spectrum of its own ([`Line`]). With the mean over paths and segments,
//!
//! ```text
//! autocovariance   C(l) = mean of 1/(L - l) sum_n y_n' y_{n+l}',   l = 0 .. L - 1
//! spectrum         S(w) = s [C(0) + 2 sum_{l=1}^{L-1} q(l/L) C(l) cos(w l s)]
//! ```
//!
//! with Parzen's lag window q(u) = 1 - 6 u^2 + 6 u^3 for u <= 1/2 and 2 (1 - u)^3 beyond, whose
//! side lobes fall as 1/w^4 (E. Parzen, *Mathematical considerations in the estimation of spectra*,
//! Technometrics 3 (1961)). S is two-sided: its integral over w from -pi/s to pi/s, divided by 2
//! pi, is the variance C(0), exactly. At the frequencies w_k = 2 pi k/(N s), N >= 2 L a power of
//! two, both follow from the transform of the segments, padded with zeros to N rows.
//!
//! The mean over paths is that over the paths of a block, n of them, so each product counts n/(n -
//! 1) times. Errors come from batches of whole paths, by the jackknife.

use super::{Fluctuations, Line, Spectrum};
use crate::model::Model;
use crate::scheme::{Snapshot, Timeline};
use crate::sums::batches::{BATCHES, batch_of};
use crate::sums::codec::{Codec, Damaged, Reader};
use crate::sums::fourier::{COLUMNS, Fourier, Numbers};
use crate::sums::interval::student;
use crate::sums::jackknife::standard_error;
use crate::sums::{Ends, Merge, Unit};

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
        let count = rows.div_ceil(LONGEST).max(1);
        Segments { first_row, length: rows / count, count }
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
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct SpectrumSums {
    /// For each of the frequencies w_0, w_1, ..., w_{N/2} and each variable, the sums of the
    /// batches.
    powers: Vec<f64>,
    /// The number of paths times segments of each batch.
    weights: [f64; BATCHES],
    /// The period of the forcing; 0 if it has none.
    forcing_period: f64,
}

impl Merge for SpectrumSums {
    fn merge(&mut self, other: &Self) {
        self.powers.iter_mut().zip(&other.powers).for_each(|(mine, more)| *mine += more);
        self.weights.iter_mut().zip(&other.weights).for_each(|(mine, more)| *mine += more);
    }
}

impl SpectrumSums {
    /// The sums of a variable over all batches but one, divided by their weight.
    fn mean_power(&self, variable: usize, without: Option<usize>) -> Vec<f64> {
        let frequencies = self.powers.len() / (BATCHES * VARIABLES);
        let sum = |of: &[f64]| -> f64 { (0..BATCHES).filter(|batch| Some(*batch) != without).map(|b| of[b]).sum() };
        let weight = sum(&self.weights);
        let at = |k: usize| sum(&self.powers[(k * VARIABLES + variable) * BATCHES..][..BATCHES]) / weight;
        (0..frequencies).map(at).collect()
    }

    /// Autocovariance and spectrum, and the lines of the mean motion, which `bands` has at every
    /// row.
    pub fn summary(&self, timeline: &Timeline, mean_motion: [&[f64]; VARIABLES]) -> Spectrum {
        let segments = Segments::of(timeline);
        let spacing = timeline.output_step;
        let fourier = Fourier::new(segments.padded());
        let batches: Vec<usize> = (0..BATCHES).filter(|batch| self.weights[*batch] > 0.0).collect();
        let leave_outs: Vec<Option<usize>> = std::iter::once(None).chain(batches.into_iter().map(Some)).collect();
        let [displacement, velocity] = std::array::from_fn(|variable| {
            let powers: Vec<Vec<f64>> = leave_outs.iter().map(|w| self.mean_power(variable, *w)).collect();
            let covariances = self.transformed(&fourier, &powers);
            let covariances: Vec<Vec<f64>> = covariances.into_iter().map(|c| covariance(&c, segments)).collect();
            let windowed: Vec<Vec<f64>> = covariances.iter().map(|c| windowed(c, segments)).collect();
            let mut spectra = self.transformed(&fourier, &windowed);
            spectra.iter_mut().flatten().for_each(|power| *power *= spacing * segments.padded() as f64);
            Fluctuations {
                autocovariance_ends: ends(&covariances, |value, reach| [value - reach, value + reach]),
                spectrum_ends: ends(&spectra, |value, reach| match value > 0.0 {
                    true => [value * (-reach / value).exp(), value * (reach / value).exp()],
                    false => [value - reach, value + reach],
                }),
                autocovariance: covariances.into_iter().next().unwrap_or_default(),
                aliased: aliased(&spectra[0]),
                spectrum: spectra.into_iter().next().unwrap_or_default(),
            }
        });
        let frequency = |k: usize| std::f64::consts::TAU * k as f64 / (segments.padded() as f64 * spacing);
        Spectrum {
            segments: segments.count as u64,
            lag: (0..segments.length).map(|l| l as f64 * spacing).collect(),
            frequency: (0..segments.frequencies()).map(frequency).collect(),
            displacement,
            velocity,
            lines: lines(self.forcing_period, timeline, segments, mean_motion),
        }
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
            let column = |column: usize| (0..=half).map(|j| real[j][column] / length as f64).collect();
            out.extend((0..columns.len()).map(column));
        }
        out
    }
}

/// C(l) from the sums of products at each lag.
fn covariance(products: &[f64], segments: Segments) -> Vec<f64> {
    let length = segments.length;
    products.iter().take(length).enumerate().map(|(l, product)| product / (length - l) as f64).collect()
}

/// q(l/L) C(l), with zeros up to the lag N/2.
fn windowed(covariance: &[f64], segments: Segments) -> Vec<f64> {
    let window = |u: f64| if u <= 0.5 { 1.0 - 6.0 * u * u * (1.0 - u) } else { 2.0 * (1.0 - u).powi(3) };
    let length = segments.length as f64;
    let mut all: Vec<f64> = covariance.iter().enumerate().map(|(l, c)| window(l as f64 / length) * c).collect();
    all.resize(segments.frequencies(), 0.0);
    all
}

/// The ends of the intervals of a curve, from the curve and the curves without each batch.
fn ends(curves: &[Vec<f64>], interval: impl Fn(f64, f64) -> [f64; 2]) -> Ends {
    let (curve, without) = (&curves[0], &curves[1..]);
    let freedom = without.len().saturating_sub(1) as u64;
    let at = |i: usize| match freedom {
        0 => [f64::NAN; 2],
        _ => {
            let error = standard_error(&without.iter().map(|curve| curve[i]).collect::<Vec<f64>>());
            interval(curve[i], student(freedom) * error)
        }
    };
    (0..curve.len()).map(at).collect()
}

/// An upper bound of what frequencies beyond pi/s, which the rows cannot tell from lower ones, add
/// to each value of a spectrum, if the spectrum falls there at least as fast as 1/w^2. With S the
/// spectrum at pi/s, half of which is aliased there, and u = w s/(2 pi), it is
///
/// ```text
/// S/2 sum_{m != 0} (1/2)^2/(u + m)^2 = S/8 [pi^2/sin^2(pi u) - 1/u^2]
/// ```
fn aliased(spectrum: &[f64]) -> Vec<f64> {
    let last = spectrum.len() - 1;
    let at = |k: usize| {
        let u = k as f64 / (2 * last) as f64;
        let pi = std::f64::consts::PI;
        let sum = if k == 0 { pi * pi / 3.0 } else { (pi / libm::sin(pi * u)).powi(2) - 1.0 / (u * u) };
        spectrum[last].max(0.0) / 8.0 * sum
    };
    (0..=last).map(at).collect()
}

/// The amplitudes of the mean motion at the harmonics of the forcing, by Hann's window.
fn lines(period: f64, timeline: &Timeline, segments: Segments, mean_motion: [&[f64]; VARIABLES]) -> Vec<Line> {
    let rows = timeline.rows().saturating_sub(segments.first_row);
    let counted = rows as f64 * timeline.output_step;
    let turn = std::f64::consts::TAU;
    // The window tells two lines apart that are four over its length apart.
    if period <= 0.0 || counted < 4.0 * period {
        return Vec::new();
    }
    let window = |n: usize| 1.0 - libm::cos(turn * (n as f64 + 0.5) / rows as f64);
    let amplitude = |motion: &[f64], frequency: f64| {
        let counted = motion.get(segments.first_row..).unwrap_or_default();
        let total: f64 = (0..counted.len()).map(window).sum();
        let mean = counted.iter().enumerate().map(|(n, y)| window(n) * y).sum::<f64>() / total;
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (n, y) in counted.iter().enumerate() {
            let (sin, cos) = libm::sincos(frequency * n as f64 * timeline.output_step);
            real += window(n) * (y - mean) * cos;
            imaginary += window(n) * (y - mean) * sin;
        }
        2.0 * real.hypot(imaginary) / total
    };
    let highest = std::f64::consts::PI / timeline.output_step;
    let frequencies = (1..=LINES).map(|n| n as f64 * turn / period).take_while(|frequency| *frequency < highest);
    let line = |frequency| {
        let [displacement, velocity] = mean_motion.map(|motion| amplitude(motion, frequency));
        Line { frequency, displacement, velocity }
    };
    frequencies.map(line).collect()
}

impl Codec for SpectrumSums {
    fn write(&self, out: &mut Vec<u8>) {
        self.powers.write(out);
        self.weights.write(out);
        self.forcing_period.write(out);
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        let length = from.clone().length()?;
        if length % (BATCHES * VARIABLES) != 0 || length > BATCHES * VARIABLES * (LONGEST + 1) {
            return Err(Damaged);
        }
        self.powers = vec![0.0; length];
        self.powers.read(from)?;
        self.weights.read(from)?;
        self.forcing_period.read(from)
    }
}

/// Transforms the paths of one block, segment by segment.
pub(super) struct SpectrumFold {
    segments: Segments,
    fourier: Fourier,
    batches: Vec<usize>,
    /// x and x' of the rows of the present segment, row after row.
    rows: [Vec<f64>; VARIABLES],
    sums: SpectrumSums,
}

impl SpectrumFold {
    /// The paths with these numbers.
    pub fn new(model: &Model, timeline: &Timeline, paths: &[u64]) -> Self {
        let segments = Segments::of(timeline);
        let powers = vec![0.0; BATCHES * VARIABLES * segments.frequencies()];
        let forcing_period = model.temperature.period().unwrap_or(0.0);
        SpectrumFold {
            segments,
            fourier: Fourier::new(segments.padded()),
            batches: paths.iter().map(|path| batch_of(*path)).collect(),
            rows: std::array::from_fn(|_| Vec::with_capacity(segments.length * paths.len())),
            sums: SpectrumSums { powers, weights: [0.0; BATCHES], forcing_period },
        }
    }

    /// Set another independent unit than the path.
    pub fn set_unit(&mut self, unit: Unit, paths: &[u64]) {
        self.batches = paths.iter().map(|path| batch_of(unit.of(*path))).collect();
    }

    /// Add a row of the output grid.
    pub fn row(&mut self, row: usize, snapshot: &Snapshot<'_>) {
        let Segments { first_row, length, count } = self.segments;
        if length == 0 || row < first_row || row >= first_row + count * length {
            return;
        }
        self.rows[0].extend_from_slice(snapshot.displacement);
        self.rows[1].extend_from_slice(snapshot.velocity);
        if (row + 1 - first_row).is_multiple_of(length) {
            self.transform();
            self.rows.iter_mut().for_each(Vec::clear);
        }
    }

    /// Adds the powers of a segment.
    fn transform(&mut self) {
        let (paths, length) = (self.batches.len(), self.segments.length);
        if paths < 2 {
            return;
        }
        for rows in &mut self.rows {
            for row in rows.chunks_mut(paths) {
                let mean = row.iter().sum::<f64>() / paths as f64;
                row.iter_mut().for_each(|y| *y -= mean);
            }
        }
        let (padded, frequencies) = (self.segments.padded(), self.segments.frequencies());
        let unbiased = paths as f64 / (paths - 1) as f64;
        let [mut real, mut imaginary] = [const { Vec::<Numbers>::new() }; 2];
        for (chunk, batches) in self.batches.chunks(COLUMNS).enumerate() {
            // x is the real part and x' the imaginary part, so that one transform serves both.
            for (part, rows) in [&mut real, &mut imaginary].into_iter().zip(&self.rows) {
                part.clear();
                part.resize(padded, [0.0; COLUMNS]);
                for (numbers, row) in part.iter_mut().zip(rows.chunks(paths)).take(length) {
                    let columns = &row[chunk * COLUMNS..][..batches.len()];
                    numbers[..batches.len()].copy_from_slice(columns);
                }
            }
            self.fourier.transform(&mut real, &mut imaginary);
            // Mostly the columns belong to successive batches.
            let first = batches[0];
            let is_in_a_row =
                batches.len() == COLUMNS && batches.iter().zip(first..).all(|(batch, next)| *batch == next);
            for k in 0..frequencies {
                let mirrored = (padded - k) % padded;
                let [a, b, c, d] = [real[k], real[mirrored], imaginary[k], imaginary[mirrored]];
                let square = |y: f64, z: f64| 0.25 * unbiased * (y * y + z * z);
                let power = |of: fn([f64; 4]) -> [f64; 2]| -> Numbers {
                    std::array::from_fn(|i| {
                        let [y, z] = of([a[i], b[i], c[i], d[i]]);
                        square(y, z)
                    })
                };
                let powers = [power(|[a, b, c, d]| [a + b, c - d]), power(|[a, b, c, d]| [c + d, a - b])];
                for (variable, powers) in powers.iter().enumerate() {
                    let sums = &mut self.sums.powers[(k * VARIABLES + variable) * BATCHES..][..BATCHES];
                    match sums.get_mut(first..first + COLUMNS).filter(|_| is_in_a_row) {
                        Some(sums) => sums.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power),
                        None => batches.iter().zip(powers).for_each(|(batch, power)| sums[*batch] += power),
                    }
                }
            }
            batches.iter().for_each(|batch| self.sums.weights[*batch] += 1.0);
        }
    }

    /// The sums of all segments.
    pub fn finish(self) -> SpectrumSums {
        self.sums
    }
}
