//! Random functions of time that take the place of a measured input: their laws, without random
//! numbers.

use super::{Expression, NoSeries, OrnsteinUhlenbeck, Series};
use rand_core::Rng;
use std::f64::consts::PI;
use std::fmt::Debug;
use std::sync::Arc;

/// An input, or the temperature, that is drawn anew for every path.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomInput {
    /// The table that it stands for, such as `input.ag` or `temperature.series`. It selects the
    /// random numbers, so that another input does not change them.
    pub name: String,
    /// Its law.
    pub process: RandomProcess,
    /// The time between two samples of a process that has no times of its own; between them the
    /// input is a straight line.
    pub step: f64,
    /// A function of t alone with which samples are multiplied.
    pub envelope: Option<Expression>,
}

/// The law of a random input.
#[derive(Clone, Debug, PartialEq)]
pub enum RandomProcess {
    /// Two values, which the input leaves at the times of two Poisson processes.
    Telegraph {
        /// The two values. It begins at one of them, by their shares of the time.
        values: [f64; 2],
        /// The rate at which it leaves each of them, per time.
        rates: [f64; 2],
    },
    /// Pulses at the times of a Poisson process.
    Shot {
        /// Pulses per time.
        rate: f64,
        /// The law of the areas of pulses.
        size: PulseSize,
        /// The shape of a pulse.
        shape: PulseShape,
    },
    /// White noise through the filter of Kanai and Tajimi, a ground acceleration: -(2 zeta w y' + w^2 y),
    /// where y'' + 2 zeta w y' + w^2 y = sqrt(2 pi S0) xi(t). Its two-sided spectrum in angular
    /// frequency is S0 (1 + 4 zeta^2 r^2)/((1 - r^2)^2 + 4 zeta^2 r^2) with r = angular frequency/w.
    KanaiTajimi {
        /// w of the ground.
        angular_frequency: f64,
        /// zeta of the ground.
        damping_ratio: f64,
        /// S0.
        intensity: f64,
    },
    /// rho v(t) with dv = -theta v dt + sigma dW.
    OrnsteinUhlenbeck(OrnsteinUhlenbeck),
    /// A Gaussian process with a one-sided spectrum in cycles per time, whose integral is the variance.
    Spectrum(Arc<InputSpectrum>),
    /// Realisations of the caller.
    Own(OwnProcess),
}

/// The law of the area of a pulse, the integral over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PulseSize {
    /// All pulses have this area.
    Fixed(f64),
    /// An exponential law with this mean, which may be negative.
    Exponential(f64),
    /// A normal law with this mean and standard deviation.
    Normal(f64, f64),
}

/// The shape of a pulse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PulseShape {
    /// An impulse: x' jumps, whatever friction is.
    Kick,
    /// A constant for this time.
    Rectangle(f64),
    /// An exponential decay with this time constant.
    Decay(f64),
}

/// A one-sided spectrum: densities at frequencies in cycles per time.
#[derive(Clone, Debug, PartialEq)]
pub struct InputSpectrum {
    /// The file as the scenario names it.
    pub file: String,
    /// Increasing frequencies, not negative.
    pub frequencies: Vec<f64>,
    /// The densities there, not negative.
    pub densities: Vec<f64>,
}

/// Realisations of the caller: any type that implements [`InputProcess`].
#[derive(Clone, Debug)]
pub struct OwnProcess(pub Arc<dyn InputProcess>);

impl PartialEq for OwnProcess {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// A random function of time, drawn anew for each path.
pub trait InputProcess: Debug + Send + Sync {
    /// The samples of the function on one path, from t = 0 to `end` or later; between them it is a
    /// straight line. `random` is the same for this path in every scheme and on every thread.
    fn draw(&self, path: u64, random: &mut dyn Rng, end: f64) -> Series;

    /// Its name in messages.
    fn name(&self) -> &str {
        "own"
    }

    /// The number of paths that have a realisation, if it is limited.
    fn count(&self) -> Option<u64> {
        None
    }

    /// Whether paths take the same realisations again after the last.
    fn is_reused(&self) -> bool {
        false
    }
}

impl OwnProcess {
    /// The realisations of a run that is read from a file, which does not hold them.
    pub fn missing() -> Self {
        OwnProcess(Arc::new(Missing))
    }
}

/// No realisations: every path is lost.
#[derive(Debug)]
struct Missing;

impl InputProcess for Missing {
    fn draw(&self, _: u64, _: &mut dyn Rng, _: f64) -> Series {
        Series::unknown()
    }
}

/// Realisations that are given as samples at common times. Path n takes number n, and begins again
/// after the last.
#[derive(Debug)]
pub struct Realisations {
    times: Vec<f64>,
    /// The values, realisation after realisation.
    values: Vec<f64>,
    /// Whether they are reused, if they were read from a file.
    file: Option<bool>,
}

impl Realisations {
    /// The realisations with these values at these times, which increase from 0. Fails if a row of
    /// values is not as long as the times, or if there is none.
    pub fn new(times: Vec<f64>, values: Vec<f64>) -> Result<Self, NoSeries> {
        let is_whole = !values.is_empty() && values.len().is_multiple_of(times.len().max(1));
        let first = values
            .get(..times.len())
            .filter(|_| is_whole)
            .ok_or(NoSeries)?;
        Series::new(times.clone(), first.to_vec())?;
        match values.iter().all(|value| value.is_finite()) {
            true => Ok(Realisations {
                times,
                values,
                file: None,
            }),
            false => Err(NoSeries),
        }
    }

    /// The name of the process whose realisations are in the columns of a file.
    pub(crate) const OF_FILE: &str = "realisations";

    /// All of them as one series, as a file of results holds it: the number of times, the times,
    /// and all values, at 0, 1, 2 and so on.
    #[cfg(feature = "toml")]
    pub(crate) fn packed(&self) -> Result<Series, NoSeries> {
        let count = [self.times.len() as f64];
        let values = [&count[..], &self.times, &self.values].concat();
        Series::new((0..values.len()).map(|i| i as f64).collect(), values)
    }

    /// Those of a packed series, which are in a file.
    #[cfg(feature = "toml")]
    pub(crate) fn unpacked(packed: &Series, is_reused: bool) -> Result<Self, NoSeries> {
        let (count, rest) = packed.values().split_first().ok_or(NoSeries)?;
        let (times, values) = rest.split_at_checked(*count as usize).ok_or(NoSeries)?;
        let file = Some(is_reused);
        let all = Realisations::new(times.to_vec(), values.to_vec())?;
        Ok(Realisations { file, ..all })
    }
}

impl InputProcess for Realisations {
    fn draw(&self, path: u64, _: &mut dyn Rng, _: f64) -> Series {
        let count = (self.values.len() / self.times.len()) as u64;
        let from = (path % count) as usize * self.times.len();
        let values = self.values[from..from + self.times.len()].to_vec();
        Series::new(self.times.clone(), values).unwrap_or_else(|_| Series::unknown())
    }

    fn name(&self) -> &str {
        self.file.map_or("own", |_| Realisations::OF_FILE)
    }

    fn count(&self) -> Option<u64> {
        let is_limited = self.file == Some(false);
        is_limited.then(|| (self.values.len() / self.times.len()) as u64)
    }

    fn is_reused(&self) -> bool {
        self.file == Some(true)
    }
}

impl PulseSize {
    /// E J and E J^2.
    pub fn moments(self) -> [f64; 2] {
        match self {
            PulseSize::Fixed(size) => [size, size * size],
            PulseSize::Exponential(mean) => [mean, 2.0 * mean * mean],
            PulseSize::Normal(mean, sd) => [mean, mean * mean + sd * sd],
        }
    }
}

impl InputSpectrum {
    /// The frequencies, each with the variance that it stands for by the trapezoidal rule.
    pub fn variances(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        let at = |i: usize| self.frequencies[i.min(self.frequencies.len() - 1)];
        let width = move |i: usize| 0.5 * (at(i + 1) - at(i.saturating_sub(1)));
        let both = self.frequencies.iter().zip(&self.densities).enumerate();
        both.map(move |(i, (f, density))| (*f, density * width(i)))
    }

    /// The time after which a realisation repeats itself if the frequencies are evenly spaced.
    pub fn repeats_after(&self) -> f64 {
        let widths = self.frequencies.windows(2).map(|pair| pair[1] - pair[0]);
        1.0 / widths.fold(0.0, f64::max)
    }
}

/// The mean, the standard deviation and the correlation time of a process without its envelope; the
/// time is the integral of the normalised autocovariance, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessMoments {
    /// The mean.
    pub mean: f64,
    /// The standard deviation; infinite for kicks.
    pub sd: f64,
    /// The correlation time.
    pub time: f64,
}

impl RandomProcess {
    /// Its name in scenarios.
    pub fn name(&self) -> &str {
        match self {
            RandomProcess::Telegraph { .. } => "telegraph",
            RandomProcess::Shot { .. } => "shot",
            RandomProcess::KanaiTajimi { .. } => "kanai-tajimi",
            RandomProcess::OrnsteinUhlenbeck(_) => "ornstein-uhlenbeck",
            RandomProcess::Spectrum(_) => "spectrum",
            RandomProcess::Own(own) => own.0.name(),
        }
    }

    /// Whether it is sampled, and has no times of its own.
    pub fn is_sampled(&self) -> bool {
        let is_decay = |shape: &PulseShape| matches!(shape, PulseShape::Decay(_));
        match self {
            RandomProcess::Telegraph { .. } | RandomProcess::Own(_) => false,
            RandomProcess::Shot { shape, .. } => is_decay(shape),
            _ => true,
        }
    }

    /// Whether it consists of impulses.
    pub fn is_kicks(&self) -> bool {
        matches!(
            self,
            RandomProcess::Shot {
                shape: PulseShape::Kick,
                ..
            }
        )
    }

    /// Its moments in the stationary law; none for realisations of the caller.
    pub fn moments(&self) -> Option<ProcessMoments> {
        Some(match self {
            RandomProcess::Telegraph {
                values: [one, two],
                rates: [leave_one, leave_two],
            } => {
                let both = leave_one + leave_two;
                let [first, second] = [leave_two / both, leave_one / both];
                ProcessMoments {
                    mean: first * one + second * two,
                    sd: (first * second).sqrt() * (one - two).abs(),
                    time: 1.0 / both,
                }
            }
            // Campbell's theorem.
            RandomProcess::Shot { rate, size, shape } => {
                let [mean, square] = size.moments();
                let (sd, time) = match shape {
                    PulseShape::Kick => (f64::INFINITY, 0.0),
                    PulseShape::Rectangle(duration) => {
                        ((rate * square / duration).sqrt(), 0.5 * duration)
                    }
                    PulseShape::Decay(time) => ((0.5 * rate * square / time).sqrt(), *time),
                };
                ProcessMoments {
                    mean: rate * mean,
                    sd,
                    time,
                }
            }
            RandomProcess::KanaiTajimi {
                angular_frequency: w,
                damping_ratio: zeta,
                intensity,
            } => {
                let variance = PI * intensity * w * (1.0 + 4.0 * zeta * zeta) / (2.0 * zeta);
                ProcessMoments {
                    mean: 0.0,
                    sd: variance.sqrt(),
                    time: PI * intensity / variance,
                }
            }
            RandomProcess::OrnsteinUhlenbeck(noise) => ProcessMoments {
                mean: 0.0,
                sd: noise.intensity * noise.stationary_sd(),
                time: 1.0 / noise.relaxation_rate,
            },
            RandomProcess::Spectrum(spectrum) => {
                let variance: f64 = spectrum.variances().map(|(_, variance)| variance).sum();
                ProcessMoments {
                    mean: 0.0,
                    sd: variance.sqrt(),
                    time: 0.25 * spectrum.densities[0] / variance,
                }
            }
            RandomProcess::Own(_) => return None,
        })
    }

    /// The fastest rate at which it changes, which its samples must resolve; none where it has no
    /// samples.
    pub fn fastest_rate(&self) -> Option<f64> {
        match self {
            RandomProcess::KanaiTajimi {
                angular_frequency, ..
            } => Some(*angular_frequency),
            RandomProcess::OrnsteinUhlenbeck(noise) => Some(noise.relaxation_rate),
            RandomProcess::Spectrum(spectrum) => {
                let powers = || spectrum.variances().map(|(_, variance)| variance);
                let total: f64 = powers().sum();
                let mut sum = 0.0;
                let mut cumulated = spectrum.variances().map(|(f, variance)| {
                    sum += variance;
                    (f, sum)
                });
                // The frequency below which 99 % of the variance lies.
                let most = cumulated.find(|(_, sum)| *sum >= 0.99 * total);
                most.map(|(f, _)| 2.0 * PI * f)
            }
            RandomProcess::Shot {
                shape: PulseShape::Decay(time),
                ..
            } => Some(1.0 / time),
            _ => None,
        }
    }
}
