//! Helpers that the unit tests of the noisy scheme share.

use super::cell_loop::Path;
use super::cells::{Cell, cell_length};
use super::corridor::{Corridor, Pending};
use super::ladder::Ladder;
use super::scene::Scene;
use super::watch::Nobody;
use super::work::Work;
use crate::model::{Model, Sign};
use crate::noise::{AddressedDraws, Transition};

/// The time and the side of the first exit from the initial stick of each path, started at n =
/// `noise`.
pub fn exits(model: &Model, noise: f64, kappa: f64, horizon: f64, seed: u64, paths: u64) -> Vec<(f64, Sign)> {
    let scene = Scene::new(model);
    let corridor = Corridor::new(&scene, kappa);
    let rates = scene.harmonics.iter().map(|h| h.angular_frequency);
    let length = cell_length(0.5 / rates.fold(scene.relaxation_rate, f64::max), f64::INFINITY);
    let transition = Transition::new(scene.relaxation_rate, scene.diffusion, length);
    let spring_force = scene.oscillator.stiffness * scene.initial_displacement;
    let ladder = Ladder::even(length);
    let (mut cell, mut pending) = (Cell::new(&scene, &ladder, 0), Pending::new());
    (0..paths)
        .map(|number| {
            let draws = AddressedDraws::new(seed, number);
            let mut path = Path::<()>::new(&scene, noise, draws, Work::new(1_000_000));
            for index in 0..(horizon / length).ceil() as u64 {
                cell.move_to(&scene, &ladder, index);
                let end_noise = transition.next(path.noise, draws.at(index, 0).normal());
                path.draws = draws.at(index, 2);
                path.force = cell.first.value - spring_force + path.noise;
                let exit = corridor.exit(&scene, &cell, &mut path, end_noise, &mut pending, &mut Nobody);
                match exit.expect("bounded work") {
                    Some((after, sign)) => return (cell.start + after, sign),
                    None => path.noise = end_noise,
                }
            }
            panic!("no exit before {horizon}")
        })
        .collect()
}

/// The mean of independent values and its standard error.
pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}
