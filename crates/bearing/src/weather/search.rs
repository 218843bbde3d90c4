//! The search for the most likely processes, and their errors.
//!
//! A point holds log theta of each process, and for two processes the logarithm of the variance of
//! the second over that of the first. Then comes log tau, if their sum is smoothed, and last the
//! variance of the white noise over that of the first, if there is any. It is not a logarithm,
//! because it may be nearly zero, where the error of a logarithm is undefined. Some of these
//! numbers are searched, and the others are fixed.

use super::kalman::{Likelihood, Shape, likelihood};
use super::result::{Estimates, WeatherFit};
use super::simplex;
use crate::linear::{Matrix, cholesky, inverse};
use std::f64::consts::{LN_2, TAU};

/// The search ends when the deviances of the simplex agree to this. The parameters are then known
/// to a thousandth of their errors.
const ENOUGH: f64 = 1e-6;

/// The initial steps of a search, in logarithms: far from the most likely point, after a rough
/// search, and near that of other samples of the same weather.
const AFAR: f64 = 0.7;
const FROM_ROUGH: f64 = 0.1;
const FROM_ANOTHER: f64 = 0.3;

/// White noise of less than this share of the variance is rounding.
const LEAST_WHITE: f64 = 1e-10;

/// The longest correlation time of a process as a fraction of the record. From fewer than ten
/// correlation times neither it nor the standard deviation can be determined.
const LONGEST: f64 = 0.1;

/// A standard deviation must be known to this factor, as the standard error of its logarithm.
const KNOWN: f64 = LN_2;

/// The standard error of the logarithm of a fixed rate: a factor of 2.
const HELD_ERROR: f64 = LN_2;

/// A correlation time is not fixed if that lowers twice the log-likelihood by more than this: the
/// record then shows that it is shorter. This happens by chance in one of 20 records (chi^2 with
/// one degree of freedom).
const REFUSED: f64 = 3.84;

/// The samples, with the columns of the regression.
pub struct ProcessSearch<'a> {
    times: &'a [f64],
    columns: Vec<Vec<f64>>,
    /// Residuals of a regression of the temperatures. A search starts with them, because it takes a
    /// fifth of the time and ends near the most likely point.
    left: Vec<Vec<f64>>,
    /// The mean and the amplitudes of that regression.
    waves: Vec<f64>,
    periods: &'a [f64],
    /// Number of processes.
    processes: usize,
    /// Whether their sum is smoothed.
    smooths: bool,
    /// The time over which each sample is a mean, around its time.
    window: f64,
    duration: f64,
}

/// A point of largest likelihood.
#[derive(Clone, Debug)]
pub struct Peak {
    point: Vec<f64>,
    /// Minus twice the logarithm of the likelihood there.
    pub deviance: f64,
    /// Whether the rate of the slowest process is fixed.
    is_held: bool,
    /// The covariance of the errors; `None` if the samples do not determine them.
    errors: Option<Matrix>,
}

impl<'a> ProcessSearch<'a> {
    /// A search for this number of processes, smoothed or not, and harmonics of these periods, in samples
    /// that are means over this time.
    pub fn new(
        [times, temperatures]: [&'a [f64]; 2],
        periods: &'a [f64],
        processes: usize,
        smooths: bool,
        window: f64,
    ) -> Self {
        let mut columns = vec![vec![1.0; times.len()]];
        for period in periods {
            let half = 0.5 * TAU / period * window;
            let left = if half > 0.0 {
                libm::sin(half) / half
            } else {
                1.0
            };
            for function in [libm::cos, libm::sin] {
                columns.push(
                    times
                        .iter()
                        .map(|t| left * function(TAU / period * (t - times[0])))
                        .collect(),
                );
            }
        }
        columns.push(temperatures.to_vec());
        let duration = times[times.len() - 1] - times[0];
        let mut search = ProcessSearch {
            times,
            columns,
            left: Vec::new(),
            waves: Vec::new(),
            periods,
            processes,
            smooths,
            window,
            duration,
        };
        let forgetful = Shape {
            processes: vec![(1e3 / search.interval(), 1.0)],
            smoothing: 0.0,
            window: 0.0,
            white: 0.0,
        };
        search.waves = likelihood(times, &search.columns, &forgetful)
            .map_or_else(Vec::new, |found| found.coefficients);
        let wave = |k: usize| {
            search
                .columns
                .iter()
                .zip(&search.waves)
                .map(|(column, wave)| wave * column[k])
                .sum::<f64>()
        };
        search.left = vec![
            temperatures
                .iter()
                .enumerate()
                .map(|(k, temperature)| temperature - wave(k))
                .collect(),
        ];
        search
    }

    /// The same search in other samples.
    pub fn of<'b>(&self, samples: [&'b [f64]; 2]) -> ProcessSearch<'b>
    where
        'a: 'b,
    {
        ProcessSearch::new(
            samples,
            self.periods,
            self.processes,
            self.smooths,
            self.window,
        )
    }

    /// The regression at any time.
    pub fn wave(&self, time: f64) -> f64 {
        let phase = |period: &f64| TAU / period * (time - self.times[0]);
        let pair = |(period, pair): (&f64, &[f64])| {
            pair[0] * libm::cos(phase(period)) + pair[1] * libm::sin(phase(period))
        };
        let (mean, pairs) = self.waves.split_at(1);
        mean[0]
            + self
                .periods
                .iter()
                .zip(pairs.chunks_exact(2))
                .map(pair)
                .sum::<f64>()
    }

    /// The residual of each sample.
    pub fn left(&self) -> &[f64] {
        &self.left[0]
    }

    /// The shape at a point for the residuals of the regression, with variances of temperatures.
    pub fn scaled(&self, found: &Peak) -> Option<Shape> {
        let mut shape = self.shape(&found.point);
        let scale = likelihood(self.times, &self.left, &shape)?.scale;
        shape
            .processes
            .iter_mut()
            .for_each(|(_, variance)| *variance *= scale);
        shape.white *= scale;
        Some(shape)
    }

    /// The mean time between samples.
    fn interval(&self) -> f64 {
        self.duration / (self.times.len() as f64 - 1.0)
    }

    /// The most likely point; `None` if nothing explains the samples. If the correlation time of
    /// the slowest process is longer than the record can resolve, or its standard deviation not
    /// known to a factor of 2, the correlation time is fixed at the longest that the record can
    /// resolve, unless the likelihood excludes that.
    pub fn best(&self) -> Option<Peak> {
        let free = self.polished(&self.rough(None, 0.0)?, FROM_ROUGH)?;
        let held = -libm::log(LONGEST * self.duration);
        let is_short = free.point[self.slowest()] >= held;
        if is_short && self.is_known(&free) {
            return Some(free);
        }
        let longest = self
            .rough(Some(held), 0.0)
            .and_then(|rough| self.polished(&rough, FROM_ROUGH));
        let is_refused = |longest: &Peak| is_short && longest.deviance > free.deviance + REFUSED;
        match longest {
            Some(longest) if !is_refused(&longest) => Some(longest),
            _ => Some(free).filter(|_| is_short),
        }
    }

    /// The most likely point near that of other samples of the same weather.
    pub fn near(&self, other: &Peak) -> Option<Peak> {
        self.polished(other, FROM_ANOTHER)
    }

    /// Whether the standard deviation of the slowest process is known.
    fn is_known(&self, found: &Peak) -> bool {
        let slow = 2 * self.slowest() + 1;
        found
            .errors
            .as_ref()
            .is_some_and(|errors| errors[slow][slow].sqrt() < KNOWN)
    }

    /// The most likely point from this one on, with its errors.
    fn polished(&self, from: &Peak, step: f64) -> Option<Peak> {
        let found =
            self.fastest_first(self.lowest(&from.point, from.is_held, &self.columns, step)?);
        // The fixed process has to be the slowest.
        if self.processes > 1 && found.point[0] <= found.point[1] {
            return None;
        }
        Some(Peak {
            errors: self.errors(&found),
            ..found
        })
    }

    /// The index of log theta of the slowest process, which comes last.
    fn slowest(&self) -> usize {
        self.processes - 1
    }

    /// The most likely point for the residuals of a regression, with the rate of the slowest
    /// process fixed if one is given. White noise is kept if it lowers the deviance by more than
    /// `least`.
    pub fn rough(&self, held: Option<f64>, least: f64) -> Option<Peak> {
        let interval = self.interval();
        // The search starts from a correlation time of half a day, or from three hours and four
        // days.
        let starts: &[f64] = if self.processes == 1 {
            &[0.5]
        } else {
            &[0.125, 4.0]
        };
        let day = 86_400f64.min(self.duration / 20.0).max(4.0 * interval);
        let mut start: Vec<f64> = starts
            .iter()
            .map(|days| libm::log(1.0 / (days * day)))
            .collect();
        if self.processes > 1 {
            start.push(0.0);
        }
        if let Some(held) = held {
            start[self.slowest()] = held;
        }
        if self.smooths {
            start.push(libm::log(2.0 * interval));
        }
        let exact = self.lowest(&start, held.is_some(), &self.left, AFAR)?;
        // The search for white noise starts from a hundredth of the variance that the fastest
        // process gains per step and, because strong noise has taken the place of that process, from
        // half of it where all searches start.
        let with_noise = |point: &[f64], share: f64| {
            let white = 2.0 * share * libm::exp(point[0]) * interval;
            self.lowest(
                &[point, &[white]].concat(),
                held.is_some(),
                &self.left,
                AFAR,
            )
        };
        let noisy = [with_noise(&exact.point, 0.01), with_noise(&start, 0.5)];
        let noisy = noisy
            .into_iter()
            .flatten()
            .min_by(|a, b| a.deviance.total_cmp(&b.deviance));
        let is_clear = |noisy: &Peak| {
            noisy.deviance < exact.deviance - least
                && noisy.point[noisy.point.len() - 1] > LEAST_WHITE
        };
        Some(noisy.filter(is_clear).unwrap_or(exact))
    }

    /// The lowest deviance for these columns, searched from this point.
    fn lowest(
        &self,
        start: &[f64],
        is_held: bool,
        columns: &[Vec<f64>],
        step: f64,
    ) -> Option<Peak> {
        let free = self.free(start.len(), is_held);
        let is_white = |i: &usize| *i == self.without_white();
        let at = |x: &[f64]| {
            let mut point = start.to_vec();
            free.iter()
                .zip(x)
                .for_each(|(i, x)| point[*i] = if is_white(i) { libm::exp(*x) } else { *x });
            point
        };
        let from: Vec<f64> = free
            .iter()
            .map(|i| {
                if is_white(i) {
                    libm::log(start[*i].max(LEAST_WHITE))
                } else {
                    start[*i]
                }
            })
            .collect();
        let (x, deviance) = match from.is_empty() {
            true => (from, self.deviance(columns, start)),
            false => simplex::lowest(&from, step, ENOUGH, |x| self.deviance(columns, &at(x))),
        };
        deviance.is_finite().then(|| Peak {
            point: at(&x),
            deviance,
            is_held,
            errors: None,
        })
    }

    /// The length of a point without white noise.
    fn without_white(&self) -> usize {
        2 * self.processes - 1 + usize::from(self.smooths)
    }

    /// The components of a point that are searched.
    fn free(&self, length: usize, is_held: bool) -> Vec<usize> {
        (0..length)
            .filter(|i| !(is_held && *i == self.slowest()))
            .collect()
    }

    /// The same with the faster process first. A fixed process keeps its place.
    fn fastest_first(&self, found: Peak) -> Peak {
        let p = &found.point;
        if self.processes == 1 || found.is_held || p[0] >= p[1] {
            return found;
        }
        let mut point = vec![p[1], p[0], -p[2]];
        let (followers, white) = p[3..].split_at(usize::from(self.smooths));
        point.extend(
            followers
                .iter()
                .copied()
                .chain(white.iter().map(|white| white * libm::exp(-p[2]))),
        );
        Peak { point, ..found }
    }

    fn shape(&self, point: &[f64]) -> Shape {
        let (x, rest) = point.split_at(2 * self.processes - 1);
        let (smoothing, white) = rest.split_at(usize::from(self.smooths));
        let mut processes = vec![(libm::exp(x[0]), 1.0)];
        if let [_, rate, ratio] = x {
            processes.push((libm::exp(*rate), libm::exp(*ratio)));
        }
        let smoothing = smoothing.first().map_or(0.0, |tau| libm::exp(*tau));
        Shape {
            processes,
            smoothing,
            window: self.window,
            white: white.first().copied().unwrap_or(0.0),
        }
    }

    fn likelihood(&self, point: &[f64]) -> Option<Likelihood> {
        likelihood(self.times, &self.columns, &self.shape(point))
    }

    fn deviance(&self, columns: &[Vec<f64>], point: &[f64]) -> f64 {
        likelihood(self.times, columns, &self.shape(point))
            .map_or(f64::INFINITY, |found| found.deviance)
    }

    /// The result at a point; `None` if the samples do not determine it.
    pub fn weather(&self, found: &Peak) -> Option<WeatherFit> {
        let best = self.likelihood(&found.point)?;
        let shape = self.shape(&found.point);
        let errors = found.errors.clone()?;
        // A time constant shorter than the sampling interval is not resolved.
        if (self.processes > 1 && !self.is_known(found))
            || (self.smooths && shape.smoothing < 0.5 * self.interval())
        {
            return None;
        }
        let logarithms = shape.processes.iter().flat_map(|(theta, variance)| {
            let sd = (best.scale * variance).sqrt();
            [libm::log(*theta), libm::log(sd)]
        });
        let logarithms = logarithms.chain(self.smooths.then(|| libm::log(shape.smoothing)));
        Some(WeatherFit {
            samples: self.times.len(),
            duration: self.duration,
            white: (best.scale * shape.white).sqrt(),
            is_one_of_two: false,
            held_memory: found
                .is_held
                .then(|| libm::exp(-found.point[self.slowest()])),
            log_likelihood: -0.5 * best.deviance,
            periods: self.periods.to_vec(),
            is_smoothed: self.smooths,
            thinned: Vec::new(),
            coefficients: Estimates {
                factor: cholesky(&best.covariance)?,
                values: best.coefficients,
            },
            logarithms: Estimates {
                values: logarithms.collect(),
                factor: cholesky(&errors)?,
            },
        })
    }

    /// A step of number `i` that changes the deviance by about one, so that differences of it keep
    /// many digits. White noise may become negative, as long as the variances of the samples stay
    /// positive.
    fn step(&self, point: &[f64], i: usize, lowest: f64) -> f64 {
        let mut step = 0.02;
        for _ in 0..40 {
            let moved = |sign: f64| self.deviance(&self.columns, &with(point, &[(i, sign * step)]));
            let rise = 0.5 * (moved(1.0) + moved(-1.0)) - lowest;
            match rise {
                rise if rise.is_nan() || rise > 4.0 => step *= 0.5,
                rise if rise < 0.25 && step < point[i].max(4.0) => step *= 1.6,
                _ => break,
            }
        }
        step
    }

    /// The covariance of the errors of log theta_1, log sd_1, log theta_2, ..., log tau. It is twice the
    /// inverse of the second derivatives of the deviance; the second derivative with respect to the
    /// logarithm of the scale is n - p.
    ///
    /// A fixed rate is known to a factor of 2; otherwise only the growth of its process in a short
    /// time is known, 2 theta sd^2.
    fn errors(&self, found: &Peak) -> Option<Matrix> {
        let (point, lowest) = (&found.point, found.deviance);
        let n = (self.times.len() + 1 - self.columns.len()) as f64;
        let free = self.free(point.len(), found.is_held);
        let steps: Vec<f64> = free.iter().map(|i| self.step(point, *i, lowest)).collect();
        let mut bends = vec![vec![0.0; free.len()]; free.len()];
        for a in 0..free.len() {
            let moved = |sign: f64| {
                self.deviance(&self.columns, &with(point, &[(free[a], sign * steps[a])]))
            };
            bends[a][a] = (moved(1.0) + moved(-1.0) - 2.0 * lowest) / (steps[a] * steps[a]);
            for b in 0..a {
                let moved = |x: f64, y: f64| {
                    self.deviance(
                        &self.columns,
                        &with(point, &[(free[a], x * steps[a]), (free[b], y * steps[b])]),
                    )
                };
                let mixed =
                    moved(1.0, 1.0) + moved(-1.0, -1.0) - moved(1.0, -1.0) - moved(-1.0, 1.0);
                bends[a][b] = mixed / (4.0 * steps[a] * steps[b]);
            }
        }
        let profiled = inverse(&cholesky(&bends)?);
        // The derivative of the logarithm of the best scale s^2 with respect to each number.
        let slope = |a: usize| {
            let scale = |sign: f64| {
                let moved = self.likelihood(&with(point, &[(free[a], sign * steps[a])]));
                moved.map_or(f64::NAN, |moved| libm::log(moved.scale))
            };
            (scale(1.0) - scale(-1.0)) / (2.0 * steps[a])
        };
        let slope: Vec<f64> = (0..free.len()).map(slope).collect();
        // Each row holds the derivatives of one of log theta_1, log sd_1, ... with respect to the
        // numbers that were searched, and that with respect to log s^2.
        let unit = |i: usize, value: f64| -> Vec<f64> {
            free.iter()
                .map(|j| if i == *j { value } else { 0.0 })
                .collect()
        };
        let mut rows = Vec::new();
        for j in 0..self.processes {
            rows.push((unit(j, 1.0), 0.0));
            let ratio = if j == 0 {
                vec![0.0; free.len()]
            } else {
                unit(self.processes, 0.5)
            };
            rows.push((
                ratio.iter().zip(&slope).map(|(a, b)| a + 0.5 * b).collect(),
                0.5,
            ));
        }
        if self.smooths {
            rows.push((unit(2 * self.processes - 1, 1.0), 0.0));
        }
        let between = |(a, s): &(Vec<f64>, f64), (b, t): &(Vec<f64>, f64)| {
            let shapes: f64 = (0..free.len())
                .flat_map(|i| (0..free.len()).map(move |j| (i, j)))
                .map(|(i, j)| 2.0 * a[i] * profiled[i][j] * b[j])
                .sum();
            shapes + s * t * 2.0 / n
        };
        let mut errors: Matrix = rows
            .iter()
            .map(|a| rows.iter().map(|b| between(a, b)).collect())
            .collect();
        if found.is_held {
            let (rate, sd, variance) = (
                2 * self.slowest(),
                2 * self.slowest() + 1,
                HELD_ERROR * HELD_ERROR,
            );
            errors[rate][rate] += variance;
            errors[rate][sd] -= 0.5 * variance;
            errors[sd][rate] -= 0.5 * variance;
            errors[sd][sd] += 0.25 * variance;
        }
        Some(errors)
    }
}

/// The numbers with some of them moved.
fn with(all: &[f64], moves: &[(usize, f64)]) -> Vec<f64> {
    let mut moved = all.to_vec();
    moves.iter().for_each(|(i, by)| moved[*i] += by);
    moved
}
