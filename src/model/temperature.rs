//! The temperature that drives the oscillator: a straight line, a sum of harmonics, a measured
//! series, and one or two Ornstein-Uhlenbeck noises.

use super::Series;
use std::f64::consts::TAU;
use std::sync::Arc;

/// One harmonic of the temperature, a cos(w t + phi).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic {
    /// a, in units of temperature.
    pub amplitude: f64,
    /// w >= 0, in radians per unit of time.
    pub angular_frequency: f64,
    /// phi, in radians.
    pub phase: f64,
}

/// One noise of the temperature, rho v(t) with dv = -theta v dt + sigma dW.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrnsteinUhlenbeck {
    /// rho >= 0, the weight of v in T, in units of temperature (v is a pure number).
    pub intensity: f64,
    /// theta > 0, the relaxation rate, per unit of time.
    pub relaxation_rate: f64,
    /// sigma >= 0, the diffusion, per square root of a unit of time.
    pub diffusion: f64,
    /// The law of v(0).
    pub initial: InitialNoise,
}

/// The start of the noise, v(0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialNoise {
    /// v(0) has this value.
    At(f64),
    /// v(0) is drawn from the stationary law N(0, sigma^2 / (2 theta)).
    Stationary,
}

impl OrnsteinUhlenbeck {
    /// sigma / sqrt(2 theta), the stationary standard deviation of v.
    pub fn stationary_sd(&self) -> f64 {
        self.diffusion / (2.0 * self.relaxation_rate).sqrt()
    }

    /// Whether rho v(t) differs from path to path: rho sigma > 0. Without diffusion v relaxes from
    /// v(0), equally on all paths.
    pub fn is_random(&self) -> bool {
        self.intensity * self.diffusion > 0.0
    }

    /// Whether rho v(t) is zero at all times: rho = 0, or v stays at zero.
    pub fn is_silent(&self) -> bool {
        let starts_at_zero = matches!(
            self.initial,
            InitialNoise::Stationary | InitialNoise::At(0.0)
        );
        self.intensity == 0.0 || (self.diffusion == 0.0 && starts_at_zero)
    }
}

/// T(t) = offset + trend t + sum_i a_i cos(w_i t + phi_i) + S(t) + sum_j rho_j v_j(t).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Temperature {
    /// A constant, in units of temperature.
    pub offset: f64,
    /// The slope of a straight line, in units of temperature per time. Seen from a belt that moves
    /// at a constant speed, the support of the spring moves along such a line.
    pub trend: f64,
    /// The harmonics.
    pub harmonics: Vec<Harmonic>,
    /// S, the measured temperature, if there is one. Clones of a model share it.
    pub series: Option<Arc<Series>>,
    /// Whether v is zero at every sample of the series. The noise then describes what the
    /// temperature may have done between the samples, at which it is known.
    pub is_pinned: bool,
    /// The noises as they are given, independent of each other, two at most. Two noises allow for
    /// one correlation time of hours and one of days. A noise that is zero at all times is kept
    /// here, but not in [`Temperature::effective_noises`].
    pub noises: Vec<OrnsteinUhlenbeck>,
}

/// The largest number of cycles of the slowest harmonic in the search for the forcing period.
pub const MOST_CYCLES: u32 = 1000;

/// The largest relative distance from a whole number at which a number of cycles counts as whole.
/// It allows for the rounding of decimal fractions only.
const WHOLE: f64 = 1e-9;

impl Temperature {
    /// Whether T(t) differs from path to path, and with it the motion. If not, all paths are the
    /// same.
    pub fn is_random(&self) -> bool {
        self.effective_noises().any(|noise| noise.is_random())
    }

    /// The noises that are not zero at all times; only these are simulated. Without any, no random
    /// number is drawn.
    pub fn effective_noises(&self) -> impl Iterator<Item = OrnsteinUhlenbeck> {
        self.noises
            .iter()
            .copied()
            .filter(|noise| !noise.is_silent())
    }

    /// The first of [`Temperature::effective_noises`]. It is the only one unless
    /// [`Temperature::has_two_noises`].
    pub fn effective_noise(&self) -> Option<OrnsteinUhlenbeck> {
        self.effective_noises().next()
    }

    /// Whether two noises are simulated.
    pub fn has_two_noises(&self) -> bool {
        self.effective_noises().count() == 2
    }

    /// Whether there is nothing but a constant.
    pub(crate) fn is_constant(&self) -> bool {
        let is_still = self.trend == 0.0 && self.harmonics.is_empty();
        is_still && self.series.is_none() && self.noises.is_empty()
    }

    /// Whether there is a constant or a trend.
    pub fn has_line(&self) -> bool {
        self.offset != 0.0 || self.trend != 0.0
    }

    /// offset + trend t.
    pub fn line(&self, t: f64) -> f64 {
        self.offset + self.trend * t
    }

    /// The line and the series at time t, from their definition.
    pub fn measured(&self, t: f64) -> f64 {
        let line = self.line(t);
        self.series.as_ref().map_or(line, |series| {
            if self.has_line() {
                line + series.at(t)
            } else {
                series.at(t)
            }
        })
    }

    /// The line, the harmonics and the series at time t, from their definition.
    pub fn deterministic(&self, t: f64) -> f64 {
        let harmonics: f64 = self
            .harmonics
            .iter()
            .map(|h| h.amplitude * libm::cos(h.angular_frequency * t + h.phase))
            .sum();
        if self.has_line() || self.series.is_some() {
            harmonics + self.measured(t)
        } else {
            harmonics
        }
    }

    /// E T(t), from its definition: the line, the harmonics, the series, and the mean of each v,
    /// which relaxes from its start.
    pub fn mean(&self, t: f64) -> f64 {
        let relaxing = self.effective_noises().map(|noise| match noise.initial {
            InitialNoise::At(v) => noise.intensity * v * libm::exp(-noise.relaxation_rate * t),
            InitialNoise::Stationary => 0.0,
        });
        self.deterministic(t) + relaxing.sum::<f64>()
    }

    /// A bound of |T| up to `end`, where each noise is bounded by `sds` stationary standard
    /// deviations.
    pub fn bound(&self, sds: f64, end: f64) -> f64 {
        let harmonics: f64 = self
            .harmonics
            .iter()
            .map(|harmonic| harmonic.amplitude.abs())
            .sum();
        let noise = self.effective_noises().map(|noise| {
            let start = if let InitialNoise::At(v0) = noise.initial {
                v0.abs()
            } else {
                0.0
            };
            noise.intensity * (start + sds * noise.stationary_sd())
        });
        let line = self.offset.abs() + self.trend.abs() * end;
        line + harmonics
            + self.series.as_ref().map_or(0.0, |series| series.bound())
            + noise.sum::<f64>()
    }

    /// P, the forcing period: the shortest time after which every harmonic repeats itself.
    ///
    /// None if no harmonic changes with time, if there is a series (which does not repeat itself),
    /// or if the frequencies have no common measure. They have none if no number of cycles of the
    /// slowest harmonic, up to 1000, is a whole number of cycles of each of the others.
    pub fn period(&self) -> Option<f64> {
        if self.series.is_some() {
            return None;
        }
        let moving = self
            .harmonics
            .iter()
            .filter(|h| h.angular_frequency > 0.0 && h.amplitude != 0.0);
        let frequencies: Vec<f64> = moving.map(|h| h.angular_frequency).collect();
        let slowest = frequencies.iter().copied().reduce(f64::min)?;
        let is_whole = |cycles: f64| (cycles - cycles.round()).abs() <= WHOLE * cycles;
        let shared = (1..=MOST_CYCLES)
            .map(f64::from)
            .find(|n| frequencies.iter().all(|w| is_whole(n * (w / slowest))))?;
        Some(shared * (TAU / slowest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn period(harmonics: &[(f64, f64)]) -> Option<f64> {
        let harmonic = |&(amplitude, angular_frequency)| Harmonic {
            amplitude,
            angular_frequency,
            phase: 0.3,
        };
        Temperature {
            harmonics: harmonics.iter().map(harmonic).collect(),
            ..Temperature::default()
        }
        .period()
    }

    #[test]
    fn the_period_is_that_which_all_harmonics_share() {
        assert_eq!(period(&[(1.0, 0.25)]), Some(TAU / 0.25));
        // 0.25 and 0.6 have the common measure 0.05. A harmonic of frequency zero or of amplitude
        // zero does not count.
        let both =
            period(&[(1.0, 0.25), (0.2, 0.6), (3.0, 0.0), (0.0, 0.7)]).expect("5 and 12 cycles");
        assert!((both / (TAU / 0.05) - 1.0).abs() < 1e-12);
        assert_eq!(period(&[(0.2, 0.6), (1.0, 0.25)]), Some(both));
        assert_eq!(period(&[(1.0, 0.3), (1.0, 0.1)]), Some(TAU / 0.1));
        assert_eq!(
            period(&[(1.0, 0.25), (1.0, 0.25 * std::f64::consts::SQRT_2)]),
            None
        );
        assert_eq!((period(&[]), period(&[(1.0, 0.0)])), (None, None));
    }
}
