//! The search for the most likely processes, and their errors.
//!
//! A point holds log theta of each process, and for two processes the logarithm of the variance of
//! the second over that of the first. Last is the logarithm of the variance of the white noise over
//! that of the first, if there is any. Some of these numbers are searched, and the others are held.

use super::kalman::{Likelihood, Shape, likelihood};
use super::result::{Estimates, WeatherFit};
use super::simplex;
use crate::bearing::linear::{Matrix, cholesky, inverse};
use std::f64::consts::{LN_2, TAU};

/// The search ends when the deviances of the simplex agree to this. The parameters are then known
/// to a thousandth of their errors.
const ENOUGH: f64 = 1e-6;

/// The longest memory of a process as a share of the record. From fewer than ten memories neither
/// it nor the standard deviation can be told.
const LONGEST: f64 = 0.1;

/// A standard deviation must be known to this factor, as the standard error of its logarithm.
const KNOWN: f64 = LN_2;

/// The standard error of the logarithm of a rate that is held: a factor of 2.
const HELD_ERROR: f64 = LN_2;

/// The samples, with the columns of the regression.
pub struct ProcessSearch<'a> {
    times: &'a [f64],
    columns: Vec<Vec<f64>>,
    periods: &'a [f64],
    /// Number of processes.
    processes: usize,
    duration: f64,
}

/// A point of largest likelihood.
#[derive(Clone, Debug)]
pub struct Peak {
    point: Vec<f64>,
    /// Minus twice the logarithm of the likelihood there.
    pub deviance: f64,
    /// Whether the rate of the slowest process is held.
    is_held: bool,
}

impl<'a> ProcessSearch<'a> {
    /// A search for harmonics of these periods and so many processes.
    pub fn new(times: &'a [f64], temperatures: &[f64], periods: &'a [f64], processes: usize) -> Self {
        let mut columns = vec![vec![1.0; times.len()]];
        for period in periods {
            for function in [libm::cos, libm::sin] {
                columns.push(times.iter().map(|t| function(TAU / period * (t - times[0]))).collect());
            }
        }
        columns.push(temperatures.to_vec());
        let duration = times[times.len() - 1] - times[0];
        ProcessSearch { times, columns, periods, processes, duration }
    }

    /// The most likely point; `None` if nothing explains the samples. If the memory of the slowest
    /// process is longer than the record can show, or its standard deviation not known to a factor
    /// of 2, the memory is held at the longest that the record can show.
    pub fn best(&self) -> Option<Peak> {
        let free = self.searched(None)?;
        let held = -libm::log(LONGEST * self.duration);
        let is_slow = free.point[self.slowest()] < held;
        let is_known = || {
            let sd = self.errors(&free).map(|errors| errors[2 * self.slowest() + 1][2 * self.slowest() + 1].sqrt());
            sd.is_some_and(|sd| sd < KNOWN)
        };
        if is_slow || !is_known() { self.searched(Some(held)) } else { Some(free) }
    }

    /// The index of log theta of the slowest process, which comes last.
    fn slowest(&self) -> usize {
        self.processes - 1
    }

    /// The most likely point, with the rate of the slowest process held if one is given.
    fn searched(&self, held: Option<f64>) -> Option<Peak> {
        let interval = self.duration / (self.times.len() as f64 - 1.0);
        // The search starts from a correlation time of half a day, or from three hours and four
        // days.
        let starts: &[f64] = if self.processes == 1 { &[0.5] } else { &[0.125, 4.0] };
        let day = 86_400f64.min(self.duration / 20.0).max(4.0 * interval);
        let mut start: Vec<f64> = starts.iter().map(|days| libm::log(1.0 / (days * day))).collect();
        if self.processes > 1 {
            start.push(0.0);
        }
        if let Some(held) = held {
            start[self.slowest()] = held;
        }
        let exact = self.lowest(&start, held.is_some())?;
        // The search for white noise starts from a hundredth of the variance that the fastest
        // process gains per step.
        let white = libm::log(0.02 * libm::exp(exact.point[0]) * interval);
        let noisy = self.lowest(&[&exact.point[..], &[white]].concat(), held.is_some());
        // White noise is kept wherever it raises the likelihood, however little, because its error
        // then is part of the errors of all other numbers.
        let is_told = |noisy: &Peak| noisy.deviance < exact.deviance && self.errors(noisy).is_some();
        let found = noisy.filter(is_told).unwrap_or(exact);
        let found = self.fastest_first(found);
        // The process that is held has to be the slowest.
        (self.processes == 1 || found.point[0] > found.point[1]).then_some(found)
    }

    /// The lowest deviance, searched from this point.
    fn lowest(&self, start: &[f64], is_held: bool) -> Option<Peak> {
        let free = self.free(start.len(), is_held);
        let at = |x: &[f64]| {
            let mut point = start.to_vec();
            free.iter().zip(x).for_each(|(i, x)| point[*i] = *x);
            point
        };
        let from: Vec<f64> = free.iter().map(|i| start[*i]).collect();
        let (x, deviance) = match from.is_empty() {
            true => (from, self.deviance(start)),
            false => simplex::lowest(&from, 0.7, ENOUGH, |x| self.deviance(&at(x))),
        };
        deviance.is_finite().then(|| Peak { point: at(&x), deviance, is_held })
    }

    /// The numbers of a point that are searched.
    fn free(&self, length: usize, is_held: bool) -> Vec<usize> {
        (0..length).filter(|i| !(is_held && *i == self.slowest())).collect()
    }

    /// The same with the faster process first. A process that is held stays where it is.
    fn fastest_first(&self, found: Peak) -> Peak {
        let p = &found.point;
        if self.processes == 1 || found.is_held || p[0] >= p[1] {
            return found;
        }
        let mut point = vec![p[1], p[0], -p[2]];
        point.extend(p[3..].iter().map(|white| white - p[2]));
        Peak { point, ..found }
    }

    fn shape(&self, point: &[f64]) -> Shape {
        let (x, white) = point.split_at(2 * self.processes - 1);
        let mut processes = vec![(libm::exp(x[0]), 1.0)];
        if let [_, rate, ratio] = x {
            processes.push((libm::exp(*rate), libm::exp(*ratio)));
        }
        Shape { processes, white: white.first().map_or(0.0, |white| libm::exp(*white)) }
    }

    fn likelihood(&self, point: &[f64]) -> Option<Likelihood> {
        likelihood(self.times, &self.columns, &self.shape(point))
    }

    fn deviance(&self, point: &[f64]) -> f64 {
        self.likelihood(point).map_or(f64::INFINITY, |found| found.deviance)
    }

    /// The result at a point; `None` if the samples do not determine it.
    pub fn weather(&self, found: &Peak) -> Option<WeatherFit> {
        let best = self.likelihood(&found.point)?;
        let shape = self.shape(&found.point);
        let errors = self.errors(found)?;
        let slow = 2 * self.slowest() + 1;
        if self.processes > 1 && errors[slow][slow].sqrt() > KNOWN {
            return None;
        }
        let logarithms = shape.processes.iter().flat_map(|(theta, variance)| {
            let sd = (best.scale * variance).sqrt();
            [libm::log(*theta), libm::log(sd)]
        });
        Some(WeatherFit {
            samples: self.times.len(),
            duration: self.duration,
            white: (best.scale * shape.white).sqrt(),
            is_one_of_two: false,
            held_memory: found.is_held.then(|| libm::exp(-found.point[self.slowest()])),
            log_likelihood: -0.5 * best.deviance,
            periods: self.periods.to_vec(),
            coefficients: Estimates { factor: cholesky(&best.covariance)?, values: best.coefficients },
            logarithms: Estimates { values: logarithms.collect(), factor: cholesky(&errors)? },
        })
    }

    /// A step of number `i` that changes the deviance by about one, so that differences of it keep
    /// many digits.
    fn step(&self, point: &[f64], i: usize, lowest: f64) -> f64 {
        let mut step = 0.02;
        for _ in 0..40 {
            let moved = |sign: f64| self.deviance(&with(point, &[(i, sign * step)]));
            let rise = 0.5 * (moved(1.0) + moved(-1.0)) - lowest;
            match rise {
                rise if rise.is_nan() || rise > 4.0 => step *= 0.5,
                rise if rise < 0.25 && step < 4.0 => step *= 1.6,
                _ => break,
            }
        }
        step
    }

    /// The covariance of the errors of log theta_1, log sd_1, log theta_2, .... It is twice the
    /// inverse of the second derivatives of the deviance; the second derivative with respect to the
    /// logarithm of the scale is n - p.
    ///
    /// A rate that is held is known to a factor of 2, and what is known of its process beside that
    /// is how much it gains in a short time, 2 theta sd^2.
    fn errors(&self, found: &Peak) -> Option<Matrix> {
        let (point, lowest) = (&found.point, found.deviance);
        let n = (self.times.len() + 1 - self.columns.len()) as f64;
        let free = self.free(point.len(), found.is_held);
        let steps: Vec<f64> = free.iter().map(|i| self.step(point, *i, lowest)).collect();
        let mut bends = vec![vec![0.0; free.len()]; free.len()];
        for a in 0..free.len() {
            let moved = |sign: f64| self.deviance(&with(point, &[(free[a], sign * steps[a])]));
            bends[a][a] = (moved(1.0) + moved(-1.0) - 2.0 * lowest) / (steps[a] * steps[a]);
            for b in 0..a {
                let moved =
                    |x: f64, y: f64| self.deviance(&with(point, &[(free[a], x * steps[a]), (free[b], y * steps[b])]));
                let mixed = moved(1.0, 1.0) + moved(-1.0, -1.0) - moved(1.0, -1.0) - moved(-1.0, 1.0);
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
        let unit =
            |i: usize, value: f64| -> Vec<f64> { free.iter().map(|j| if i == *j { value } else { 0.0 }).collect() };
        let mut rows = Vec::new();
        for j in 0..self.processes {
            rows.push((unit(j, 1.0), 0.0));
            let ratio = if j == 0 { vec![0.0; free.len()] } else { unit(self.processes, 0.5) };
            rows.push((ratio.iter().zip(&slope).map(|(a, b)| a + 0.5 * b).collect(), 0.5));
        }
        let between = |(a, s): &(Vec<f64>, f64), (b, t): &(Vec<f64>, f64)| {
            let shapes: f64 = (0..free.len())
                .flat_map(|i| (0..free.len()).map(move |j| (i, j)))
                .map(|(i, j)| 2.0 * a[i] * profiled[i][j] * b[j])
                .sum();
            shapes + s * t * 2.0 / n
        };
        let mut errors: Matrix = rows.iter().map(|a| rows.iter().map(|b| between(a, b)).collect()).collect();
        if found.is_held {
            let (rate, sd, variance) = (2 * self.slowest(), 2 * self.slowest() + 1, HELD_ERROR * HELD_ERROR);
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
