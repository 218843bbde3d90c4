//! Two Ornstein-Uhlenbeck noises at once.
//!
//! n = n1 + n2, where each is a separate process dn_j = -theta_j n_j dt + s_j dW_j. The skeleton of
//! a path holds both values at the ends of every macro step, drawn exactly. Inside a macro step
//! only their sum matters. There the sum is approximated by one Ornstein-Uhlenbeck process between
//! the two known ends, with
//!
//! ```text
//! s^2 = s1^2 + s2^2,    theta^2 = (theta1^2 s1^2 + theta2^2 s2^2)/s^2
//! ```
//!
//! This is correct to second order in theta_j h. Between known ends n_j is a bridge with the mean
//! and the variance
//!
//! ```text
//! mean       straight line - theta_j^2 (straight line) t (h - t)/2 + ..
//! variance   s_j^2 t (h - t)/h (1 - theta_j^2 t (h - t)/3 + ..)
//! ```
//!
//! So the variance of the sum is that of one process with the theta above, up to the fourth power
//! of theta_j h. The mean of the sum is off by at most (theta_1^2 - theta^2) h^2/8 of n1, and
//! likewise of n2. The macro steps are so short that theta_j h <= 0.1 at the default tolerance,
//! which leaves an error of 0.13 % of n1 in the middle of a macro step.

use super::scene::one_noise;
use crate::model::OrnsteinUhlenbeck;
use crate::noise::{AddressedDraws, Transition};

/// Two noises, measured as forces.
#[derive(Clone, Copy, Debug)]
pub struct TwoNoises([OneNoise; 2]);

/// One Ornstein-Uhlenbeck noise, measured as a force.
#[derive(Clone, Copy, Debug)]
pub struct OneNoise {
    /// theta_j.
    pub relaxation_rate: f64,
    /// s_j.
    pub diffusion: f64,
    /// The law of n_j(0): its mean and standard deviation.
    pub initial: (f64, f64),
}

/// How many times shorter the macro steps are than with one noise.
const SHORTER: f64 = 5.0;

impl TwoNoises {
    /// Two noises, where `gain` is the force per unit of temperature.
    pub fn new(noises: [OrnsteinUhlenbeck; 2], gain: f64) -> Self {
        TwoNoises(noises.map(|noise| one_noise(&noise, gain)))
    }

    /// The single process that approximates their sum inside a macro step.
    pub fn inside(&self) -> OneNoise {
        let [a, b] = self.0;
        let diffusion = a.diffusion.hypot(b.diffusion);
        let rate = |noise: OneNoise| noise.relaxation_rate * (noise.diffusion / diffusion);
        let relaxation_rate = if diffusion > 0.0 {
            rate(a).hypot(rate(b))
        } else {
            self.fastest()
        };
        let initial = (a.initial.0 + b.initial.0, a.initial.1.hypot(b.initial.1));
        OneNoise {
            relaxation_rate,
            diffusion,
            initial,
        }
    }

    /// The rate that the length of a macro step must resolve, in the way in which it resolves theta
    /// of one noise: the larger theta_j, times `SHORTER`.
    pub fn rate(&self) -> f64 {
        SHORTER * self.fastest()
    }

    /// The transition of each noise over a macro step of this length.
    pub fn transitions(&self, length: f64) -> [Transition; 2] {
        self.0
            .map(|noise| Transition::new(noise.relaxation_rate, noise.diffusion, length))
    }

    /// Draws n1(0) and n2(0) of a path.
    pub fn draw(&self, path: AddressedDraws) -> [f64; 2] {
        let normals = path.for_start().normal_pair();
        [0, 1].map(|i| self.0[i].initial.0 + self.0[i].initial.1 * normals[i])
    }

    fn fastest(&self) -> f64 {
        self.0[0].relaxation_rate.max(self.0[1].relaxation_rate)
    }
}
