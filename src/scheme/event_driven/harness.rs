//! What the unit tests of the noisy scheme share.

use super::scene::Scene;
use super::stick::{StickState, StickSteps};
use super::work::Work;
use crate::model::{Complex, Friction, Harmonic, InitialNoise, Model, Noise, Oscillator, Sign, Temperature};
use crate::noise::Stream;

/// The paper's parameters with forcing frequency 1/4 and noise of this intensity, v(0) = 0.
pub fn paper_scene(rho: f64) -> Model {
    Model {
        oscillator: Oscillator { mass: 1.0, stiffness: 1.0, damping: 0.0, dilatation: 6.0 },
        friction: Friction { static_force: 1.2, dynamic_force: 1.0 },
        temperature: Temperature {
            harmonics: vec![Harmonic { amplitude: 1.0, angular_frequency: 0.25, phase: 0.0 }],
            noise: Some(Noise { intensity: rho, relaxation_rate: 1.0, diffusion: 1.0, initial: InitialNoise::At(0.0) }),
        },
        initial_displacement: 6.0,
    }
}

/// Time and side of the first exit from stick, path by path, started at n = `noise`.
pub fn exits(model: &Model, noise: f64, kappa: f64, horizon: f64, seed: u64, paths: u64) -> Vec<(f64, Sign)> {
    let scene = Scene::new(model);
    let steps = StickSteps::new(&scene, kappa, horizon);
    let mut terms = vec![Complex::ZERO; scene.harmonics.len()];
    (0..paths)
        .map(|path| {
            scene.set_terms(0.0, &mut terms);
            let spring_force = model.oscillator.stiffness * model.initial_displacement;
            let mut state = StickState { time: 0.0, spring_force, noise, terms: &mut terms };
            match steps.advance(&scene, &mut state, horizon, &mut Stream::new(seed, path), &mut Work::new(1_000_000)) {
                Ok(Some(force)) => (state.time, Sign::of(force)),
                outcome => panic!("no exit before {horizon}: {outcome:?}"),
            }
        })
        .collect()
}

/// Mean of independent values and its standard error.
pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}
