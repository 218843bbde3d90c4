//! The most likely parameters of the weather, and their errors.

use super::kalman::{Likelihood, Shape, likelihood};
use super::simplex;
use crate::bearing::linear::{Matrix, cholesky, inverse, times as product};
use crate::data::{absurd, is_constant};
use crate::model::{Harmonic, InitialNoise, Noise, Temperature};
use crate::noise::Stream;
use std::f64::consts::TAU;

/// One Ornstein-Uhlenbeck process of the weather.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Process {
    /// theta, in units of 1/time.
    pub relaxation_rate: f64,
    /// Its stationary standard deviation, in the unit of temperature.
    pub sd: f64,
    /// The standard error of the logarithm of theta.
    pub rate_error: f64,
    /// The standard error of the logarithm of the standard deviation.
    pub sd_error: f64,
}

/// One harmonic of the temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// The period.
    pub period: f64,
    /// The amplitude a of a cos(w t + phi), with t = 0 at the first sample.
    pub amplitude: f64,
    /// The phase phi, in radians.
    pub phase: f64,
    /// The standard error of the amplitude.
    pub error: f64,
}

/// A model of a temperature in the form of a scenario, with the errors of all its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct WeatherFit {
    /// Number of samples.
    pub samples: usize,
    /// The time from the first sample to the last.
    pub duration: f64,
    /// The standard deviation of the white noise that the thermometer adds to every sample; 0 if
    /// the data do not clearly show any.
    pub white: f64,
    /// log L, the logarithm of the restricted likelihood.
    pub log_likelihood: f64,
    /// The periods of the harmonics.
    periods: Vec<f64>,
    /// a_0, b_1, c_1, b_2, ...
    coefficients: Estimates,
    /// log theta_1, log sd_1, log theta_2, ..., the fastest process first.
    logarithms: Estimates,
}

/// Estimates with normal errors.
#[derive(Clone, Debug, PartialEq)]
struct Estimates {
    values: Vec<f64>,
    /// The Cholesky factor of the covariance of the errors.
    factor: Matrix,
}

impl Estimates {
    fn covariance(&self, i: usize, j: usize) -> f64 {
        self.factor[i].iter().zip(&self.factor[j]).map(|(a, b)| a * b).sum()
    }

    fn error(&self, i: usize) -> f64 {
        self.covariance(i, i).sqrt()
    }

    fn drawn(&self, random: &mut Stream) -> Vec<f64> {
        let normals: Vec<f64> = self.values.iter().map(|_| random.normal()).collect();
        self.values.iter().zip(product(&self.factor, &normals)).map(|(value, error)| value + error).collect()
    }
}

/// Why a temperature has no model.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WeatherError {
    /// The record has too few samples.
    #[error("{0} samples tell no weather; at least {LEAST} are needed")]
    TooShort(usize),
    /// The record is shorter than half a period.
    #[error("the record is shorter than half a period of {0} s, so it does not tell that harmonic")]
    ShorterThanPeriod(f64),
    /// Two harmonics have the same period.
    #[error("one period is named twice: {0} s")]
    PeriodTwice(f64),
    /// A temperature or its time is not finite, or too large to compute with.
    #[error("the temperature at {time:?} s is {value:?}: one of them is not finite, or too large to compute with")]
    Absurd {
        /// The time of the sample.
        time: f64,
        /// Its temperature.
        value: f64,
    },
    /// All temperatures are equal.
    #[error("the temperature is the same in all samples")]
    Constant,
    /// The samples leave nothing to fit.
    #[error("no process explains these samples: is the temperature constant, or purely periodic?")]
    NoProcess,
    /// Two processes cannot be distinguished: they have the same rate, or one of them is zero.
    #[error("the samples do not tell two processes apart")]
    OneIsEnough,
}

impl WeatherError {
    /// What the user can do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            WeatherError::TooShort(_) => "measure for longer",
            WeatherError::ShorterThanPeriod(_) => "measure for at least half of that period",
            WeatherError::PeriodTwice(_) => "name it once",
            WeatherError::Absurd { .. } => "mend the sample, or remove it",
            WeatherError::Constant | WeatherError::NoProcess => {
                "see that it is the right column, and that its sensor works"
            }
            WeatherError::OneIsEnough => "fit one process",
        }
    }
}

/// Fewest samples of a record.
const LEAST: usize = 100;

/// White noise is kept if twice the logarithm of the likelihood gains more than this. By chance it
/// gains as much in one of 3000 records (half of chi^2 with one degree of freedom).
const CONVINCING: f64 = 12.0;

/// The search ends when the deviances of the simplex agree to this. The parameters are then known
/// to a thousandth of their errors.
const ENOUGH: f64 = 1e-6;

/// Fit harmonics of these periods and one or two processes to samples at ascending times, by the
/// largest restricted likelihood.
///
/// # Errors
///
/// If the record is too short, a number in it is too large, all temperatures are equal, a period is
/// named twice, or the samples do not determine the processes.
pub fn fit(times: &[f64], temperatures: &[f64], periods: &[f64], processes: usize) -> Result<WeatherFit, WeatherError> {
    let n = times.len();
    if n < LEAST {
        return Err(WeatherError::TooShort(n));
    }
    if let Some((time, value)) = absurd(times, temperatures) {
        return Err(WeatherError::Absurd { time, value });
    }
    if is_constant(temperatures) {
        return Err(WeatherError::Constant);
    }
    let duration = times[n - 1] - times[0];
    if let Some((_, period)) = periods.iter().enumerate().find(|(i, period)| periods[..*i].contains(period)) {
        return Err(WeatherError::PeriodTwice(*period));
    }
    if let Some(period) = periods.iter().find(|period| duration < 0.5 * **period) {
        return Err(WeatherError::ShorterThanPeriod(*period));
    }
    let interval = duration / (n as f64 - 1.0);
    // The search starts from a correlation time of half a day, or from three hours and four days.
    let starts: &[f64] = if processes == 1 { &[0.5] } else { &[0.125, 4.0] };
    let day = 86_400f64.min(duration / 20.0).max(4.0 * interval);
    let regression = Regression::new(times, temperatures, periods, starts.len());
    let mut start: Vec<f64> = starts.iter().map(|days| libm::log(1.0 / (days * day))).collect();
    start.resize(2 * starts.len() - 1, 0.0);
    let (exact, without) = simplex::lowest(&start, 0.7, ENOUGH, |x| regression.deviance(x));
    // The search for white noise starts from a hundredth of the variance that the fastest process
    // gains per step.
    let white_start = [&exact[..], &[libm::log(0.02 * libm::exp(exact[0]) * interval)]].concat();
    let (noisy, with) = simplex::lowest(&white_start, 0.7, ENOUGH, |x| regression.deviance(x));
    let is_noisy = without - with > CONVINCING;
    regression.weather(if is_noisy { &noisy } else { &exact }, duration)
}

/// The samples, with the columns of the regression.
struct Regression<'a> {
    times: &'a [f64],
    columns: Vec<Vec<f64>>,
    periods: &'a [f64],
    /// Number of processes.
    processes: usize,
}

impl<'a> Regression<'a> {
    fn new(times: &'a [f64], temperatures: &[f64], periods: &'a [f64], processes: usize) -> Self {
        let mut columns = vec![vec![1.0; times.len()]];
        for period in periods {
            for function in [libm::cos, libm::sin] {
                columns.push(times.iter().map(|t| function(TAU / period * (t - times[0]))).collect());
            }
        }
        columns.push(temperatures.to_vec());
        Regression { times, columns, periods, processes }
    }

    /// The processes at a point of the search. It holds log theta of each process, for two
    /// processes the logarithm of the variance of the second over that of the first, and, where
    /// there is white noise, the logarithm of its variance over the same.
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

    /// The result at the best point.
    fn weather(&self, point: &[f64], duration: f64) -> Result<WeatherFit, WeatherError> {
        let best = self.likelihood(point).ok_or(WeatherError::NoProcess)?;
        let shape = self.shape(point);
        if let [first, second] = shape.processes[..]
            && first.0 < second.0
        {
            let mut swapped = vec![point[1], point[0], -point[2]];
            swapped.extend(point[3..].iter().map(|white| white - point[2]));
            return self.weather(&swapped, duration);
        }
        let errors = self.errors(point, best.deviance).ok_or(WeatherError::OneIsEnough)?;
        let logarithms = shape.processes.iter().flat_map(|(theta, variance)| {
            let sd = (best.scale * variance).sqrt();
            [libm::log(*theta), libm::log(sd)]
        });
        Ok(WeatherFit {
            samples: self.times.len(),
            duration,
            white: (best.scale * shape.white).sqrt(),
            log_likelihood: -0.5 * best.deviance,
            periods: self.periods.to_vec(),
            coefficients: Estimates {
                factor: cholesky(&best.covariance).ok_or(WeatherError::NoProcess)?,
                values: best.coefficients,
            },
            logarithms: Estimates {
                values: logarithms.collect(),
                factor: cholesky(&errors).ok_or(WeatherError::OneIsEnough)?,
            },
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
    fn errors(&self, point: &[f64], lowest: f64) -> Option<Matrix> {
        let n = (self.times.len() + 1 - self.columns.len()) as f64;
        let all = 0..point.len();
        let steps: Vec<f64> = all.clone().map(|i| self.step(point, i, lowest)).collect();
        let mut bends = vec![vec![0.0; all.len()]; all.len()];
        for i in all.clone() {
            let moved = |sign: f64| self.deviance(&with(point, &[(i, sign * steps[i])]));
            bends[i][i] = (moved(1.0) + moved(-1.0) - 2.0 * lowest) / (steps[i] * steps[i]);
            for j in 0..i {
                let moved = |a: f64, b: f64| self.deviance(&with(point, &[(i, a * steps[i]), (j, b * steps[j])]));
                let mixed = moved(1.0, 1.0) + moved(-1.0, -1.0) - moved(1.0, -1.0) - moved(-1.0, 1.0);
                bends[i][j] = mixed / (4.0 * steps[i] * steps[j]);
            }
        }
        let profiled = inverse(&cholesky(&bends)?);
        // The derivative of the logarithm of the best scale s^2 with respect to each number.
        let slope = |i: usize| {
            let scale = |sign: f64| {
                let found = self.likelihood(&with(point, &[(i, sign * steps[i])]));
                found.map_or(f64::NAN, |found| libm::log(found.scale))
            };
            (scale(1.0) - scale(-1.0)) / (2.0 * steps[i])
        };
        let slope: Vec<f64> = all.clone().map(slope).collect();
        // Each row holds the derivatives of one of log theta_1, log sd_1, ... with respect to
        // the numbers of the point, and that with respect to log s^2.
        let mut rows = Vec::new();
        for j in 0..self.processes {
            rows.push((unit(all.len(), j, 1.0), 0.0));
            let ratio = if j == 0 { vec![0.0; all.len()] } else { unit(all.len(), self.processes, 0.5) };
            rows.push((ratio.iter().zip(&slope).map(|(a, b)| a + 0.5 * b).collect(), 0.5));
        }
        let between = |(a, s): &(Vec<f64>, f64), (b, t): &(Vec<f64>, f64)| {
            let shapes: f64 = (0..point.len())
                .flat_map(|i| (0..point.len()).map(move |j| (i, j)))
                .map(|(i, j)| 2.0 * a[i] * profiled[i][j] * b[j])
                .sum();
            shapes + s * t * 2.0 / n
        };
        Some(rows.iter().map(|a| rows.iter().map(|b| between(a, b)).collect()).collect())
    }
}

/// The numbers with some of them moved.
fn with(all: &[f64], moves: &[(usize, f64)]) -> Vec<f64> {
    let mut moved = all.to_vec();
    moves.iter().for_each(|(i, by)| moved[*i] += by);
    moved
}

fn unit(n: usize, i: usize, value: f64) -> Vec<f64> {
    (0..n).map(|j| if i == j { value } else { 0.0 }).collect()
}

impl WeatherFit {
    /// The mean of the temperature, and its standard error.
    pub fn mean(&self) -> (f64, f64) {
        (self.coefficients.values[0], self.coefficients.error(0))
    }

    /// The harmonics, in the order of the periods that were given.
    pub fn cycles(&self) -> Vec<Cycle> {
        let Estimates { values: b, .. } = &self.coefficients;
        let cycle = |(i, period): (usize, &f64)| {
            let (cos, sin) = (2 * i + 1, 2 * i + 2);
            let amplitude = b[cos].hypot(b[sin]);
            let [along, across] = [b[cos] / amplitude, b[sin] / amplitude];
            let v = |i: usize, j: usize| self.coefficients.covariance(i, j);
            let variance =
                along * along * v(cos, cos) + 2.0 * along * across * v(sin, cos) + across * across * v(sin, sin);
            Cycle { period: *period, amplitude, phase: libm::atan2(-b[sin], b[cos]), error: variance.sqrt() }
        };
        self.periods.iter().enumerate().map(cycle).collect()
    }

    /// The processes, the fastest first.
    pub fn processes(&self) -> Vec<Process> {
        let of = |(j, pair): (usize, &[f64])| Process {
            relaxation_rate: libm::exp(pair[0]),
            sd: libm::exp(pair[1]),
            rate_error: self.logarithms.error(2 * j),
            sd_error: self.logarithms.error(2 * j + 1),
        };
        self.logarithms.values.chunks_exact(2).enumerate().map(of).collect()
    }

    /// The most likely temperature in the form of a scenario. Its noise is stationary from t = 0
    /// on, which is the first sample.
    pub fn temperature(&self) -> Temperature {
        self.of(&self.coefficients.values, &self.logarithms.values)
    }

    /// A temperature with parameters drawn from the distribution of their errors.
    pub fn drawn(&self, random: &mut Stream) -> Temperature {
        let coefficients = self.coefficients.drawn(random);
        let logarithms = self.logarithms.drawn(random);
        self.of(&coefficients, &logarithms)
    }

    fn of(&self, coefficients: &[f64], logarithms: &[f64]) -> Temperature {
        let mut harmonics = vec![Harmonic { amplitude: coefficients[0], angular_frequency: 0.0, phase: 0.0 }];
        for (period, pair) in self.periods.iter().zip(coefficients[1..].chunks_exact(2)) {
            harmonics.push(Harmonic {
                amplitude: pair[0].hypot(pair[1]),
                angular_frequency: TAU / period,
                phase: libm::atan2(-pair[1], pair[0]),
            });
        }
        let mut noises = logarithms.chunks_exact(2).map(|pair| {
            let (rate, sd) = (libm::exp(pair[0]), libm::exp(pair[1]));
            // v has the standard deviation 1, so rho is the standard deviation of the temperature.
            let diffusion = (2.0 * rate).sqrt();
            Noise { intensity: sd, relaxation_rate: rate, diffusion, initial: InitialNoise::Stationary }
        });
        Temperature { harmonics, noise: noises.next(), second_noise: noises.next(), ..Temperature::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bearing::calibration::Air;

    const DAY: f64 = 86_400.0;
    const PERIODS: [f64; 2] = [365.25 * DAY, DAY];

    fn noise(sd: f64, memory: f64) -> Noise {
        let rate = 1.0 / memory;
        Noise {
            intensity: sd,
            relaxation_rate: rate,
            diffusion: (2.0 * rate).sqrt(),
            initial: InitialNoise::Stationary,
        }
    }

    /// A mean of 12 degrees, a yearly harmonic of amplitude 8 and a daily one of 4, and weather of
    /// 3.5 K with 3 days and of 0.7 K with 2 hours.
    pub(super) fn truth() -> Temperature {
        let harmonic = |amplitude: f64, period: f64, phase: f64| Harmonic {
            amplitude,
            angular_frequency: if period > 0.0 { TAU / period } else { 0.0 },
            phase,
        };
        Temperature {
            harmonics: vec![harmonic(12.0, 0.0, 0.0), harmonic(8.0, PERIODS[0], 0.4), harmonic(4.0, PERIODS[1], -2.0)],
            noise: Some(noise(0.7, 7200.0)),
            second_noise: Some(noise(3.5, 3.0 * DAY)),
            ..Temperature::default()
        }
    }

    /// 40 records of 300 days, with a sample every hour. Null: each parameter's error divided by
    /// its standard error is standard normal. The mean square over 40 records then has an sd of
    /// 0.22. By chance it exceeds 1.9 once in 20 000 times and is below 0.35 once in 10 000. A
    /// factor of 2 in a standard error makes it 4 or 0.25. There are seven such numbers.
    #[test]
    fn parameters_are_off_by_as_much_as_their_errors_say() {
        let truth = truth();
        let expected = [12.0, 8.0, 4.0, 0.7, 3.5, 1.0 / 7200.0, 1.0 / (3.0 * DAY)];
        let mut squares = [0.0; 7];
        let records = 40;
        for seed in 0..records {
            let [times, temperatures] = Air::drawn(&truth, 7200, 3600.0, seed).samples();
            let fit = fit(&times, &temperatures, &PERIODS, 2).expect("a fit");
            let (mean, cycles, processes) = (fit.mean(), fit.cycles(), fit.processes());
            let [fast, slow] = [processes[0], processes[1]];
            let relative = |value: f64, expected: f64, error: f64| libm::log(value / expected) / error;
            let z = [
                (mean.0 - expected[0]) / mean.1,
                (cycles[0].amplitude - expected[1]) / cycles[0].error,
                (cycles[1].amplitude - expected[2]) / cycles[1].error,
                relative(fast.sd, expected[3], fast.sd_error),
                relative(slow.sd, expected[4], slow.sd_error),
                relative(fast.relaxation_rate, expected[5], fast.rate_error),
                relative(slow.relaxation_rate, expected[6], slow.rate_error),
            ];
            squares.iter_mut().zip(z).for_each(|(sum, z)| *sum += z * z / records as f64);
            assert_eq!(fit.white, 0.0, "no white noise is found where there is none");
        }
        println!("mean squares of mean, year, day, sd, sd, theta, theta: {squares:.2?}");
        assert!(squares.iter().all(|mean| (0.35..1.9).contains(mean)), "{squares:?}");
    }

    /// A thermometer that shows multiples of half a degree adds 0.144 K to every sample. Without a
    /// white part, the fast process would have to explain it, with a correlation time of minutes.
    /// There are four records of 140 days without a yearly harmonic; |z| exceeds 4 by chance once
    /// in 16 000 times.
    #[test]
    fn a_coarse_thermometer_is_told_from_weather() {
        let mut truth = truth();
        truth.harmonics.remove(1);
        for seed in 100..104 {
            let [times, temperatures] = Air::drawn(&truth, 20_000, 600.0, seed).samples();
            let shown: Vec<f64> = temperatures.iter().map(|t| 2.0 * t).map(|t| t.round() / 2.0).collect();
            let fit = fit(&times, &shown, &[DAY], 2).expect("a fit");
            let fast = fit.processes()[0];
            println!("white {:.3}, fast {fast:?}", fit.white);
            assert!((fit.white / (0.5 / 12f64.sqrt()) - 1.0).abs() < 0.1, "{}", fit.white);
            let z =
                [libm::log(fast.relaxation_rate * 7200.0) / fast.rate_error, libm::log(fast.sd / 0.7) / fast.sd_error];
            assert!(z.iter().all(|z| z.abs() < 4.0), "{z:?} {fast:?}");
        }
    }

    /// 4000 draws of the mean and of the logarithm of a rate scatter as their standard errors say.
    /// Four standard errors of a standard deviation are 4.5 %.
    #[test]
    fn draws_have_the_errors_of_the_fit() {
        let [times, temperatures] = Air::drawn(&truth(), 7200, 3600.0, 7).samples();
        let fit = fit(&times, &temperatures, &PERIODS, 2).expect("a fit");
        let mut random = Stream::new(1, 1);
        let draws: Vec<Temperature> = (0..4000).map(|_| fit.drawn(&mut random)).collect();
        let spread = |of: &dyn Fn(&Temperature) -> f64| {
            let values: Vec<f64> = draws.iter().map(of).collect();
            let mean = values.iter().sum::<f64>() / 4000.0;
            (mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 4000.0).sqrt())
        };
        let mean = spread(&|t| t.harmonics[0].amplitude);
        let fitted = fit.mean();
        assert!((mean.1 / fitted.1 - 1.0).abs() < 0.045 && (mean.0 - fitted.0).abs() < 0.07 * fitted.1);
        let rate = spread(&|t| libm::log(t.second_noise.expect("two").relaxation_rate));
        let slow = fit.processes()[1];
        assert!((rate.1 / slow.rate_error - 1.0).abs() < 0.045, "{rate:?} {slow:?}");
    }
}
