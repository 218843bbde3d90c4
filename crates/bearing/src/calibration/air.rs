//! The air temperature of a synthetic record.

use super::roughness::shown_roughness;
use stickslip::model::Temperature;
use stickslip::noise::{Stream, Transition};

/// The air temperature: known at some times, of which the thermometer shows some, and rough between
/// them.
#[derive(Clone, Debug, PartialEq)]
pub struct Air {
    /// Times, in seconds.
    pub times: Vec<f64>,
    /// Temperatures, in kelvin or degrees Celsius.
    pub temperatures: Vec<f64>,
    /// The thermometer shows one in this many of them, starting with the first.
    pub stride: usize,
    /// The variance that the temperature gains between these times, in K^2/s; 0 for linear
    /// interpolation.
    pub roughness: f64,
}

/// The longest time between temperatures that are drawn exactly, in seconds.
const LONGEST: f64 = 600.0;

/// The same as a fraction of the shortest correlation time of the noise. Within this time, an
/// Ornstein-Uhlenbeck process is a Brownian motion to within a percent.
const SHARE: f64 = 0.1;

/// The maximum number of temperatures drawn.
const MOST: usize = 30_000_000;

impl Air {
    /// The temperature that a scenario describes, for `count` samples `every` seconds apart: the
    /// harmonics plus one path of the noise, stationary from the first sample on. Between samples
    /// it varies like the noise.
    pub fn drawn(temperature: &Temperature, count: usize, every: f64, seed: u64) -> Self {
        let fastest = temperature
            .effective_noises()
            .map(|noise| noise.relaxation_rate)
            .fold(0.0, f64::max);
        let parts = (every / LONGEST.min(SHARE / fastest)).ceil().max(1.0);
        let stride = (parts as usize).min(MOST / count.max(1)).max(1);
        let step = every / stride as f64;
        let all = count.saturating_sub(1) * stride + 1;
        let times: Vec<f64> = (0..all)
            .map(|i| (i / stride) as f64 * every + (i % stride) as f64 * step)
            .collect();
        let mut temperatures: Vec<f64> = times
            .iter()
            .map(|t| temperature.deterministic(*t))
            .collect();
        let mut roughness = 0.0;
        // These streams are not used by the imperfections of a synthetic record.
        for (noise, stream) in temperature.effective_noises().zip([u64::MAX, u64::MAX - 1]) {
            let mut random = Stream::new(seed, stream);
            let transition = Transition::new(noise.relaxation_rate, noise.diffusion, step);
            let mut v = noise.stationary_sd() * random.normal();
            for temperature in &mut temperatures {
                *temperature += noise.intensity * v;
                v = transition.next(v, random.normal());
            }
            roughness += (noise.intensity * noise.diffusion).powi(2);
        }
        Air {
            times,
            temperatures,
            stride,
            roughness,
        }
    }

    /// A measured temperature, which varies between samples as it does from one to the next.
    pub fn measured(times: Vec<f64>, temperatures: Vec<f64>) -> Self {
        let roughness = shown_roughness(&times, &temperatures);
        Air {
            times,
            temperatures,
            stride: 1,
            roughness,
        }
    }

    /// A temperature interpolated linearly from one sample to the next.
    pub fn straight(times: Vec<f64>, temperatures: Vec<f64>) -> Self {
        Air {
            times,
            temperatures,
            stride: 1,
            roughness: 0.0,
        }
    }

    /// The samples of the thermometer: times and temperatures.
    pub fn samples(&self) -> [Vec<f64>; 2] {
        [&self.times, &self.temperatures]
            .map(|values| values.iter().step_by(self.stride).copied().collect())
    }
}
