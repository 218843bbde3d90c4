//! A temperature that a scenario describes, sample by sample.

use crate::model::Temperature;
use crate::noise::{Stream, Transition};

/// So many samples, so many seconds apart, of the harmonics and a path of the noise, which is stationary from the beginning.
pub fn drawn(temperature: &Temperature, count: usize, every: f64, seed: u64) -> [Vec<f64>; 2] {
    let times: Vec<f64> = (0..count).map(|i| i as f64 * every).collect();
    let mut temperatures: Vec<f64> = times.iter().map(|t| temperature.deterministic(*t)).collect();
    if let Some(noise) = temperature.effective_noise() {
        // No path of a twin's flaws draws from this stream.
        let mut random = Stream::new(seed, u64::MAX);
        let transition = Transition::new(noise.relaxation_rate, noise.diffusion, every);
        let mut v = noise.stationary_sd() * random.normal();
        for temperature in &mut temperatures {
            *temperature += noise.intensity * v;
            v = transition.next(v, random.normal());
        }
    }
    [times, temperatures]
}
