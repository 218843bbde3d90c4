//! Helpers that the unit tests of the laws, and of scalar paths, share.

use super::first_stop::{KnownStep, SlipVelocity};
use crate::model::tests::paper;
use crate::model::{Drive, Problem};
use crate::noise::AddressedDraws;

/// A stick in which the noise is the only force, b = n: K = beta = rho = sigma = 1, x0 = 0, with
/// this relaxation rate.
pub fn noise_alone(static_force: f64, relaxation_rate: f64) -> Problem {
    let mut model = paper(0.25, 1.0);
    model.oscillator.drive = Drive::Dilatation(1.0);
    model.temperature.harmonics.clear();
    model.friction.static_force = static_force;
    model.initial_displacement = 0.0;
    for noise in &mut model.temperature.noises {
        noise.relaxation_rate = relaxation_rate;
    }
    model
}

/// The mean of independent values and its standard error.
pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// A slip step of length h whose end is drawn from the law of a twice integrated Brownian motion.
/// For c = 1, (a, V, x) has the covariance h, h^2/2, h^3/6; ., h^3/3, h^4/8; ., ., h^5/20, of which
/// the code has the Cholesky factor.
pub fn free_step(start: SlipVelocity, h: f64, c: f64, draws: &mut AddressedDraws) -> KnownStep {
    let (one, two, three) = (draws.normal(), draws.normal(), draws.normal());
    let (
        root,
        SlipVelocity {
            velocity,
            acceleration,
        },
    ) = (c * h.sqrt(), start);
    let end = SlipVelocity {
        velocity: velocity + h * acceleration + root * h * (0.5 * one + two / (2.0 * 3f64.sqrt())),
        acceleration: acceleration + root * one,
    };
    let noise = one / 6.0 + two / (4.0 * 3f64.sqrt()) + three / (12.0 * 5f64.sqrt());
    let travel = h * (velocity + 0.5 * h * acceleration) + root * h * h * noise;
    KnownStep {
        start,
        end,
        travel,
        length: h,
        root_length: h.sqrt(),
    }
}
