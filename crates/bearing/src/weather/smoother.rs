//! The temperature at any time, given all samples: its mean, and random draws.
//!
//! A Kalman filter runs forwards and the smoother of Bryson and Frazier backwards. A draw is a
//! simulated path of the weather, sampled like the record, plus the smoothed difference of the
//! samples (Durbin and Koopman, Biometrika 89, 2002).

use super::kalman::Shape;
use super::system::{
    Passage, STATES, Square, States, System, add, carried, dot, root, times, updated,
};
use std::collections::HashMap;
use stickslip::noise::Stream;

/// A time at which the temperature is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeatherNode {
    pub time: f64,
    /// The sample that ends here.
    pub sample: Option<f64>,
    /// Whether the averaging interval of the next sample begins here.
    pub opens: bool,
}

/// A step from one node to the next.
struct Step {
    carry: Square,
    /// Factor of the covariance that is gained.
    factor: Square,
    /// The covariance before the sample.
    covariance: Square,
    gain: States,
    /// The inverse variance of the innovation of a sample; 0 without one.
    weight: f64,
}

/// The weather at nodes, with everything that does not depend on the samples.
pub struct Smoother {
    steps: Vec<Step>,
    seen: States,
    /// The states in an instantaneous sample.
    instant: States,
    noise: f64,
}

impl Smoother {
    /// The weather of this shape, whose variances are those of temperatures.
    pub fn new(shape: &Shape, nodes: &[WeatherNode]) -> Self {
        let followers = [shape.smoothing];
        let system = System::new(&shape.processes, &followers, shape.window);
        let mut known: HashMap<(i64, bool), (Passage, Square)> = HashMap::new();
        let mut covariance = system.settled();
        let begin = Passage {
            carry: [[0.0; STATES]; STATES],
            gained: covariance,
        };
        let mut steps: Vec<Step> = Vec::with_capacity(nodes.len());
        for (k, node) in nodes.iter().enumerate() {
            let (passage, factor) = match k.checked_sub(1).map(|before| nodes[before]) {
                None => (begin, root(&covariance)),
                Some(before) => {
                    let h = node.time - before.time;
                    *known
                        .entry(((1e6 * h) as i64, before.opens))
                        .or_insert_with(|| {
                            let mut passage = system.flow(h);
                            if before.opens && shape.window > 0.0 {
                                passage
                                    .carry
                                    .iter_mut()
                                    .for_each(|row| row[system.states - 1] = 0.0);
                            }
                            (passage, root(&passage.gained))
                        })
                }
            };
            if k > 0 {
                covariance = add(&carried(&passage.carry, &covariance), &passage.gained);
            }
            let known = times(&covariance, &system.seen);
            let variance = dot(&known, &system.seen) + shape.white;
            let is_shown = node.sample.is_some() && variance > 0.0;
            let weight = if is_shown { 1.0 / variance } else { 0.0 };
            let gain = known.map(|known| weight * known);
            steps.push(Step {
                carry: passage.carry,
                factor,
                covariance,
                gain,
                weight,
            });
            covariance = updated(&covariance, &gain, &known);
        }
        let instant = System::new(&shape.processes, &followers, 0.0).seen;
        Smoother {
            steps,
            seen: system.seen,
            instant,
            noise: shape.white.sqrt(),
        }
    }

    /// A temperature at each node, drawn from its law given the samples.
    pub fn drawn(&self, nodes: &[WeatherNode], random: &mut Stream) -> Vec<f64> {
        let mut state = [0.0; STATES];
        let (mut made, mut left) = (
            Vec::with_capacity(nodes.len()),
            Vec::with_capacity(nodes.len()),
        );
        for (step, node) in self.steps.iter().zip(nodes) {
            let normals: States = std::array::from_fn(|_| random.normal());
            state = std::array::from_fn(|i| {
                dot(&step.carry[i], &state) + dot(&step.factor[i], &normals)
            });
            made.push(dot(&self.instant, &state));
            left.push(node.sample.map_or(0.0, |sample| {
                sample - dot(&self.seen, &state) - self.noise * random.normal()
            }));
        }
        self.smoothed(left.into_iter())
            .iter()
            .zip(made)
            .map(|(a, b)| a + b)
            .collect()
    }

    /// The mean of the temperature at each node, given these samples; a node without one takes any
    /// number.
    pub fn smoothed(&self, samples: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut state = [0.0; STATES];
        let mut tracks = Vec::with_capacity(self.steps.len());
        for (step, sample) in self.steps.iter().zip(samples) {
            let expected = times(&step.carry, &state);
            let innovation = sample - dot(&self.seen, &expected);
            state = std::array::from_fn(|i| expected[i] + step.gain[i] * innovation);
            tracks.push((expected, innovation));
        }
        let mut after = [0.0; STATES];
        let mut all = vec![0.0; tracks.len()];
        for (k, (step, (expected, innovation))) in self.steps.iter().zip(tracks).enumerate().rev() {
            let brought = step.weight * innovation - dot(&step.gain, &after);
            let adjoint: States = std::array::from_fn(|i| after[i] + self.seen[i] * brought);
            all[k] = (0..STATES)
                .map(|i| self.instant[i] * (expected[i] + dot(&step.covariance[i], &adjoint)))
                .sum();
            after =
                std::array::from_fn(|j| (0..STATES).map(|i| step.carry[i][j] * adjoint[i]).sum());
        }
        all
    }
}
