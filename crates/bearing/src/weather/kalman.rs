//! The exact likelihood of samples of the weather plus a regression, by a Kalman filter.
//!
//! The state is that of `system.rs`, stationary at the first sample. The filter is linear, so the
//! innovations of y - X b are those of y minus those of the columns of X times b. One pass over y
//! and all columns together therefore gives the weighted regression, the best b, and the best scale
//! s^2 of all variances:
//!
//! ```text
//! -2 log L = sum_k log S_k + log det(sum_k X_k X_k^T/S_k) + (n - p) (1 + log(2 pi s^2))
//! s^2 = (sum_k e_k^2/S_k)/(n - p)
//! ```
//!
//! Here S_k is the variance of innovation k for s = 1, e and X are the innovations of y - X b and
//! of the columns, and p is the number of columns. This is the restricted likelihood (Patterson and
//! Thompson, Biometrika 58, 1971). The fitted mean and harmonics absorb a part of the slow weather,
//! and the plain likelihood would underestimate its variance by that part.

use super::system::{Passage, STATES, Square, States, System, add, carried, dot, times, updated};
use crate::linear::{Matrix, cholesky, inverse, solve};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// The processes and their observation, with all variances relative to that of the first.
#[derive(Clone, Debug)]
pub struct Shape {
    /// theta_j, and the variance of u_j divided by that of u_1.
    pub processes: Vec<(f64, f64)>,
    /// tau, the time constant that smooths their sum; 0 for no smoothing.
    pub smoothing: f64,
    /// w, the averaging time of a sample; 0 if it is instantaneous.
    pub window: f64,
    /// r, divided by the variance of u_1.
    pub white: f64,
}

/// The likelihood of the samples for one shape.
#[derive(Clone, Debug)]
pub struct Likelihood {
    /// -2 log L, restricted, for the best b and s.
    pub deviance: f64,
    /// The best b.
    pub coefficients: Vec<f64>,
    /// The covariance of the errors of b.
    pub covariance: Matrix,
    /// s^2, the variance of u_1.
    pub scale: f64,
}

/// For evenly spaced samples, the filter has converged when the variance of an innovation changes
/// by less than this, relative to it.
const CONVERGED: f64 = 1e-13;

/// The variances and gains of the filter, which do not depend on the measured values.
struct Filter {
    system: System,
    white: f64,
    /// The covariance of the states, given the samples so far.
    covariance: Square,
    interval: f64,
    passage: Passage,
    /// The passages over intervals that have already occurred, each with its interval in
    /// microseconds.
    known: HashMap<i64, Passage>,
    variance: f64,
    log_variance: f64,
    gain: States,
    has_converged: bool,
}

impl Filter {
    /// The filter at the first sample, where the weather is stationary.
    fn new(shape: &Shape) -> Self {
        let system = System::new(&shape.processes, &[shape.smoothing], shape.window);
        let mut filter = Filter {
            covariance: system.stationary(),
            white: shape.white,
            interval: 0.0,
            passage: Passage {
                carry: [[0.0; STATES]; STATES],
                gained: [[0.0; STATES]; STATES],
            },
            known: HashMap::new(),
            variance: 0.0,
            log_variance: 0.0,
            gain: [0.0; STATES],
            has_converged: false,
            system,
        };
        filter.update();
        filter
    }

    /// Advance to the next sample, a time h later.
    fn advance(&mut self, h: f64) {
        // Stamps are whole seconds, but times computed from them are rounded, so intervals may
        // differ slightly.
        if (h - self.interval).abs() > 1e-9 * h {
            (self.interval, self.has_converged) = (h, false);
            self.passage = *self
                .known
                .entry((1e6 * h) as i64)
                .or_insert_with(|| self.system.passage(h));
        }
        if self.has_converged {
            return;
        }
        self.covariance = add(
            &carried(&self.passage.carry, &self.covariance),
            &self.passage.gained,
        );
        let before = self.variance;
        self.update();
        self.has_converged = (self.variance - before).abs() <= CONVERGED * before;
    }

    /// Compute the variance of the innovation, and update the covariance of the states with the
    /// sample.
    fn update(&mut self) {
        let seen = times(&self.covariance, &self.system.seen);
        self.variance = dot(&seen, &self.system.seen) + self.white;
        self.log_variance = libm::log(self.variance);
        self.gain = seen.map(|seen| seen / self.variance);
        self.covariance = updated(&self.covariance, &self.gain, &seen);
    }
}

/// The likelihood of samples at ascending times. `columns` holds the columns of X and then y, each
/// as long as `times`. `None` if the shape explains nothing, or if the columns of X are linearly
/// dependent.
pub fn likelihood(times: &[f64], columns: &[Vec<f64>], shape: &Shape) -> Option<Likelihood> {
    let filter = Filter::new(shape);
    // The number of states is known at compile time, which makes the sums over them fast.
    match filter.system.states {
        1 => filtered::<1>(filter, times, columns),
        2 => filtered::<2>(filter, times, columns),
        3 => filtered::<3>(filter, times, columns),
        _ => filtered::<STATES>(filter, times, columns),
    }
}

fn filtered<const N: usize>(
    mut filter: Filter,
    times: &[f64],
    columns: &[Vec<f64>],
) -> Option<Likelihood> {
    // The estimates of the states and the innovation, for each column.
    let mut tracks = vec![([0.0; N], 0.0); columns.len()];
    let mut gram = vec![vec![0.0; columns.len()]; columns.len()];
    let mut log_variances = 0.0;
    for k in 0..times.len() {
        if k > 0 {
            filter.advance(times[k] - times[k - 1]);
        }
        if !(filter.variance > 0.0 && filter.variance.is_finite()) {
            return None;
        }
        let Filter {
            passage: Passage { carry, .. },
            system: System { seen, .. },
            gain,
            ..
        } = &filter;
        for ((state, innovation), column) in tracks.iter_mut().zip(columns) {
            let expected: [f64; N] =
                std::array::from_fn(|i| (0..N).map(|j| carry[i][j] * state[j]).sum());
            *innovation = column[k] - (0..N).map(|i| seen[i] * expected[i]).sum::<f64>();
            *state = std::array::from_fn(|i| expected[i] + gain[i] * *innovation);
        }
        let weight = 1.0 / filter.variance;
        for (i, row) in gram.iter_mut().enumerate() {
            let weighted = weight * tracks[i].1;
            row.iter_mut()
                .zip(&tracks[..=i])
                .for_each(|(sum, (_, innovation))| *sum += weighted * innovation);
        }
        log_variances += filter.log_variance;
    }
    regression(&gram, times.len() as f64, log_variances)
}

/// The regression from the products of all innovations, of which the lower triangle is given.
fn regression(gram: &Matrix, n: f64, log_variances: f64) -> Option<Likelihood> {
    let (y, products) = gram.split_last()?;
    let (square, right) = y.split_last()?;
    let factor = cholesky(products)?;
    let coefficients = solve(&factor, right);
    let explained: f64 = coefficients
        .iter()
        .zip(right)
        .map(|(b, product)| b * product)
        .sum();
    let free = n - coefficients.len() as f64;
    let scale = (square - explained) / free;
    if scale.is_nan() || scale <= 0.0 {
        return None;
    }
    let covariance = inverse(&factor)
        .iter()
        .map(|row| row.iter().map(|x| scale * x).collect())
        .collect();
    let determinant: f64 = factor
        .iter()
        .enumerate()
        .map(|(i, row)| 2.0 * libm::log(row[i]))
        .sum();
    let deviance = log_variances + determinant + free * (libm::log(TAU * scale) + 1.0);
    Some(Likelihood {
        deviance,
        coefficients,
        covariance,
        scale,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::noise::Stream;

    /// The correlation of an Ornstein-Uhlenbeck process that was smoothed, from its spectrum, and
    /// of means of both over windows, by quadrature.
    fn correlated(theta: f64, smoothing: f64, window: f64, apart: f64) -> f64 {
        let point = |x: f64| {
            let decay = |rate: f64| libm::exp(-rate * x.abs());
            match smoothing {
                0.0 => decay(theta),
                tau => {
                    (decay(theta) - theta * tau * decay(1.0 / tau)) / (1.0 - (theta * tau).powi(2))
                }
            }
        };
        // The mean of a function of the difference of two times that are uniform in two windows.
        let parts = if window > 0.0 { 4000 } else { 0 };
        let triangle = |i: i32| {
            let x = (f64::from(i) + 0.5) / f64::from(parts) - 1.0;
            (1.0 - x.abs()) * point(apart + window * x) / f64::from(parts)
        };
        if parts == 0 {
            point(apart)
        } else {
            (0..2 * parts).map(triangle).sum()
        }
    }

    /// The same likelihood from the full covariance matrix. The samples are at uneven times first
    /// and then at even ones, for which the filter settles. There are two processes, white noise, a
    /// mean and a slope; samples are instantaneous, smoothed, means, or means of what is smoothed.
    #[test]
    fn the_likelihood_is_that_of_the_whole_covariance_matrix() {
        let mut random = Stream::new(4, 0);
        let mut times = vec![0.0];
        for k in 1..90 {
            times.push(times[k - 1] + if k < 40 { 0.05 + random.uniform() } else { 0.4 });
        }
        let column =
            |f: &mut dyn FnMut(f64) -> f64| times.iter().map(|t| f(*t)).collect::<Vec<_>>();
        let columns = [
            column(&mut |_| 1.0),
            column(&mut |t| 0.1 * t),
            column(&mut |t| 2.0 + 0.3 * t + random.normal()),
        ];
        let plain =
            [(0.0, 0.2), (3.0, 0.0), (0.4, 0.05)].map(|(second, white)| (second, white, 0.0, 0.0));
        let other = [
            (0.4, 0.05, 0.7, 0.0),
            (0.4, 0.05, 0.0, 0.05),
            (0.4, 0.05, 0.7, 0.05),
        ];
        for (second, white, smoothing, window) in plain.into_iter().chain(other) {
            let shape = Shape {
                processes: vec![(5.0, 1.0), (0.02, second)],
                white,
                smoothing,
                window,
            };
            let found = likelihood(&times, &columns, &shape).expect("a likelihood");
            let covariance: Matrix = times
                .iter()
                .map(|t| {
                    let between = |s: &f64| {
                        let of = |(theta, v): &(f64, f64)| {
                            v * correlated(*theta, smoothing, window, (t - s).abs())
                        };
                        shape.processes.iter().map(of).sum::<f64>()
                            + if s == t { white } else { 0.0 }
                    };
                    times.iter().map(between).collect()
                })
                .collect();
            let factor = cholesky(&covariance).expect("positive");
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let solved = columns.each_ref().map(|column| solve(&factor, column));
            let normal: Matrix = (0..2)
                .map(|i| (0..2).map(|j| dot(&columns[i], &solved[j])).collect())
                .collect();
            let root = cholesky(&normal).expect("positive");
            let b = solve(
                &root,
                &[dot(&columns[0], &solved[2]), dot(&columns[1], &solved[2])],
            );
            let left: Vec<f64> = (0..90)
                .map(|k| columns[2][k] - b[0] * columns[0][k] - b[1] * columns[1][k])
                .collect();
            let scale = dot(&left, &solve(&factor, &left)) / 88.0;
            let determinant = 2.0 * (0..90).map(|i| libm::log(factor[i][i])).sum::<f64>();
            let fitted = 2.0 * (0..2).map(|i| libm::log(root[i][i])).sum::<f64>();
            let deviance = determinant + fitted + 88.0 * (libm::log(TAU * scale) + 1.0);
            let near =
                |a: f64, b: f64| (a - b).abs() <= if window > 0.0 { 1e-5 } else { 1e-9 } * b.abs();
            assert!(
                near(found.deviance, deviance) && near(found.scale, scale),
                "{found:?} {deviance} {scale}"
            );
            assert!(
                found.coefficients.iter().zip(&b).all(|(a, b)| near(*a, *b)),
                "{found:?} {b:?}"
            );
            let errors = inverse(&root);
            let agrees = |i: usize, j: usize| near(found.covariance[i][j], scale * errors[i][j]);
            assert!((0..2).all(|i| (0..2).all(|j| agrees(i, j))), "{found:?}");
        }
    }
}
