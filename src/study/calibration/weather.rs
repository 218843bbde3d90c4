//! A temperature that a scenario describes, sample by sample.

use crate::model::Temperature;
use crate::noise::{Stream, Transition};

/// So many samples, so many seconds apart, of the harmonics and a path of the noise, which is
/// stationary from the beginning.
pub fn drawn(temperature: &Temperature, count: usize, every: f64, seed: u64) -> [Vec<f64>; 2] {
    let times: Vec<f64> = (0..count).map(|i| i as f64 * every).collect();
    let mut temperatures: Vec<f64> = times.iter().map(|t| temperature.deterministic(*t)).collect();
    // No path of a twin's flaws draws from these streams.
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
