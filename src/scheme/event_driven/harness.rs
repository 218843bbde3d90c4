//! What the unit tests of the noisy scheme share.

use super::scene::Scene;
use super::stick::{StickState, StickSteps};
use super::work::Work;
use crate::model::{Complex, Model, Sign};
use crate::noise::Stream;

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
