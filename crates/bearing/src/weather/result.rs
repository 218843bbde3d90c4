//! A model of a measured temperature, with the errors of its parameters.

use crate::linear::{Matrix, times as product};
use crate::warning::named;
use std::f64::consts::TAU;
use stickslip::model::{Harmonic, InitialNoise, OrnsteinUhlenbeck, Temperature};
use stickslip::noise::Stream;

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
#[cfg_attr(test, derive(Default))]
pub struct WeatherFit {
    /// Number of samples.
    pub samples: usize,
    /// The time from the first sample to the last.
    pub duration: f64,
    /// The standard deviation of the white noise that the thermometer adds to every sample; 0 if
    /// the data show none.
    pub white: f64,
    /// Whether two processes were requested but the samples do not determine a second one.
    pub is_one_of_two: bool,
    /// The correlation time in seconds at which the slowest process is fixed, because the record is
    /// too short to determine a longer one.
    pub held_memory: Option<f64>,
    /// log L, the logarithm of the restricted likelihood.
    pub log_likelihood: f64,
    /// Whether the sum of the processes is smoothed.
    pub is_smoothed: bool,
    /// The same model fitted to every 2nd, 4th and 8th sample, each with that number.
    pub thinned: Vec<(usize, WeatherFit)>,
    /// The periods of the harmonics.
    pub(super) periods: Vec<f64>,
    /// a_0, b_1, c_1, b_2, ...
    pub(super) coefficients: Estimates,
    /// log theta_1, log sd_1, log theta_2, ..., the fastest process first, and log tau if their sum
    /// is smoothed.
    pub(super) logarithms: Estimates,
}

/// The parameters of a temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct Weather {
    /// The periodic part, with the mean as the first.
    pub harmonics: Vec<Harmonic>,
    /// theta and the variance of each process.
    pub processes: Vec<(f64, f64)>,
    /// tau, the time constant that smooths their sum; 0 for no smoothing.
    pub smoothing: f64,
}

/// Estimates with normal errors.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(test, derive(Default))]
pub(super) struct Estimates {
    pub values: Vec<f64>,
    /// The Cholesky factor of the covariance of the errors.
    pub factor: Matrix,
}

impl Estimates {
    fn covariance(&self, i: usize, j: usize) -> f64 {
        self.factor[i]
            .iter()
            .zip(&self.factor[j])
            .map(|(a, b)| a * b)
            .sum()
    }

    fn error(&self, i: usize) -> f64 {
        self.covariance(i, i).sqrt()
    }

    fn drawn(&self, random: &mut Stream) -> Vec<f64> {
        let normals: Vec<f64> = self.values.iter().map(|_| random.normal()).collect();
        self.values
            .iter()
            .zip(product(&self.factor, &normals))
            .map(|(value, error)| value + error)
            .collect()
    }
}

/// A change of the correlation time by more than this many standard errors is reported.
const MOVED: f64 = 3.0;

impl WeatherFit {
    /// Reasons to be careful with the fit, in sentences.
    pub fn warnings(&self) -> Vec<String> {
        self.named_warnings()
            .into_iter()
            .map(|(_, text)| text)
            .collect()
    }

    /// The same, each with its name.
    pub fn named_warnings(&self) -> Vec<(String, String)> {
        let one = self.is_one_of_two.then(|| {
            let text =
                "one noise process was fitted, because the samples do not determine a second one";
            named("one_process", text.to_string())
        });
        let held = self.held_memory.map(|memory| {
            let text = format!(
                "the record is too short to estimate the correlation time of the slow noise, \
                 which is kept near a tenth of the record, {:.3} h (within a factor of 2); \
                 measure the temperature for longer",
                memory / 3600.0
            );
            named("held_memory", text)
        });
        let smoothed = self.smoothing().map(|(tau, _)| {
            let text = format!(
                "the temperature is smoother than that of air, like that of steel or of a shaded \
                 box; it is modelled as air temperature smoothed with a time constant of {:.2} h",
                tau / 3600.0
            );
            named("smooth_temperature", text)
        });
        let varied = self.thinned.iter().find_map(|(every, other)| {
            let [here, there] = [self, other].map(|fit| fit.processes()[0]);
            let off = libm::log(there.relaxation_rate / here.relaxation_rate).abs();
            let hours = |process: Process| 1.0 / process.relaxation_rate / 3600.0;
            let ordinal = match every {
                2 => "2nd".to_string(),
                every => format!("{every}th"),
            };
            let text = || {
                format!(
                    "the correlation time of the fast noise is {:.3} h in all samples but {:.3} h \
                     in every {ordinal}, more than their errors explain: use a forecast with care",
                    hours(here),
                    hours(there)
                )
            };
            (off > MOVED * there.rate_error.hypot(here.rate_error))
                .then(|| named("memory_varies", text()))
        });
        [one, held, smoothed, varied]
            .into_iter()
            .flatten()
            .collect()
    }

    /// The time constant that smooths the weather, and the standard error of its logarithm.
    pub fn smoothing(&self) -> Option<(f64, f64)> {
        let last = self.logarithms.values.len() - 1;
        self.is_smoothed.then(|| {
            (
                libm::exp(self.logarithms.values[last]),
                self.logarithms.error(last),
            )
        })
    }

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
            let variance = along * along * v(cos, cos)
                + 2.0 * along * across * v(sin, cos)
                + across * across * v(sin, sin);
            Cycle {
                period: *period,
                amplitude,
                phase: libm::atan2(-b[sin], b[cos]),
                error: variance.sqrt(),
            }
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
        self.logarithms
            .values
            .chunks_exact(2)
            .enumerate()
            .map(of)
            .collect()
    }

    /// The most likely temperature in the form of a scenario, without smoothing. Its noise is
    /// stationary from t = 0 on, which is the first sample.
    pub fn temperature(&self) -> Temperature {
        let Weather {
            harmonics,
            processes,
            ..
        } = self.likeliest();
        let noises = processes.into_iter().map(|(rate, variance)| {
            // v has the standard deviation 1, so rho is the standard deviation of the temperature.
            let (intensity, diffusion) = (variance.sqrt(), (2.0 * rate).sqrt());
            OrnsteinUhlenbeck {
                intensity,
                relaxation_rate: rate,
                diffusion,
                initial: InitialNoise::Stationary,
            }
        });
        Temperature {
            harmonics,
            noises: noises.collect(),
            ..Temperature::default()
        }
    }

    /// The most likely weather.
    pub fn likeliest(&self) -> Weather {
        self.of(&self.coefficients.values, &self.logarithms.values)
    }

    /// Weather drawn from the distribution of the errors of its parameters.
    pub fn drawn(&self, random: &mut Stream) -> Weather {
        let coefficients = self.coefficients.drawn(random);
        let logarithms = self.logarithms.drawn(random);
        self.of(&coefficients, &logarithms)
    }

    fn of(&self, coefficients: &[f64], logarithms: &[f64]) -> Weather {
        let mut harmonics = vec![Harmonic {
            amplitude: coefficients[0],
            angular_frequency: 0.0,
            phase: 0.0,
        }];
        for (period, pair) in self.periods.iter().zip(coefficients[1..].chunks_exact(2)) {
            harmonics.push(Harmonic {
                amplitude: pair[0].hypot(pair[1]),
                angular_frequency: TAU / period,
                phase: libm::atan2(-pair[1], pair[0]),
            });
        }
        let (pairs, followers) =
            logarithms.split_at(logarithms.len() - usize::from(self.is_smoothed));
        let processes = pairs
            .chunks_exact(2)
            .map(|pair| (libm::exp(pair[0]), libm::exp(2.0 * pair[1])))
            .collect();
        Weather {
            harmonics,
            processes,
            smoothing: followers.first().map_or(0.0, |x| libm::exp(*x)),
        }
    }
}
