//! Noise that is too weak to change the motion but is part of the recorded temperature.
//!
//! With K beta = 0, or with noise below the rounding of the other forces, the motion is that of the
//! scene without diffusion. The temperature T still fluctuates, because v = E v + u. E v relaxes
//! from v(0) and is computed with the motion. u is an Ornstein-Uhlenbeck process that starts at 0
//! or in its stationary law. Its exact transition from one instant to the next is added to the T of
//! every snapshot.

use crate::model::{InitialNoise, OrnsteinUhlenbeck, Problem};
use crate::noise::{Stream, Transition};

/// What adds the fluctuations of each of these paths to T at the next instant.
pub fn unfelt_noise(
    model: &Problem,
    seed: u64,
    paths: &[u64],
) -> impl FnMut(f64, &[f64], &mut Vec<f64>) + use<> {
    let noise = model
        .temperature
        .effective_noise()
        .filter(OrnsteinUhlenbeck::is_random);
    let start = |noise| {
        paths
            .iter()
            .map(|&path| Lane::start(noise, Stream::new(seed, path)))
            .collect()
    };
    let mut lanes: Vec<Lane> = noise.as_ref().map_or(Vec::new(), start);
    let mut last = 0.0;
    move |time, mean, temperature| {
        let Some(noise) = noise else {
            return temperature.extend_from_slice(mean);
        };
        if time > last {
            let step = Transition::new(noise.relaxation_rate, noise.diffusion, time - last);
            for lane in &mut lanes {
                lane.fluctuation = step.next(lane.fluctuation, lane.draws.normal());
            }
            last = time;
        }
        let fluctuating = mean.iter().zip(&lanes);
        temperature
            .extend(fluctuating.map(|(mean, lane)| mean + noise.intensity * lane.fluctuation));
    }
}

/// u and the random numbers of one path.
struct Lane {
    fluctuation: f64,
    draws: Stream,
}

impl Lane {
    fn start(noise: &OrnsteinUhlenbeck, mut draws: Stream) -> Self {
        let fluctuation = match noise.initial {
            InitialNoise::At(_) => 0.0,
            InitialNoise::Stationary => noise.stationary_sd() * draws.normal(),
        };
        Lane { fluctuation, draws }
    }
}
