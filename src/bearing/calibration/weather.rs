//! Sampling a temperature that a scenario describes.

use crate::model::Temperature;
use crate::noise::{Stream, Transition};

/// Times and temperatures of `count` samples, `every` seconds apart: the harmonics plus one path of
/// the noise, which is stationary from the first sample on.
pub fn drawn(temperature: &Temperature, count: usize, every: f64, seed: u64) -> [Vec<f64>; 2] {
    let times: Vec<f64> = (0..count).map(|i| i as f64 * every).collect();
    let mut temperatures: Vec<f64> = times.iter().map(|t| temperature.deterministic(*t)).collect();
    // These streams are not used by the imperfections of a synthetic record.
    for (noise, stream) in temperature.noises().zip([u64::MAX, u64::MAX - 1]) {
        let mut random = Stream::new(seed, stream);
        let transition = Transition::new(noise.relaxation_rate, noise.diffusion, every);
        let mut v = noise.stationary_sd() * random.normal();
        for temperature in &mut temperatures {
            *temperature += noise.intensity * v;
            v = transition.next(v, random.normal());
        }
    }
    [times, temperatures]
}
