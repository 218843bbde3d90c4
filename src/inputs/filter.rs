//! White noise through an oscillator: its exact transition over a step.

use crate::model::ImpulseResponse;
use crate::noise::Stream;
use std::f64::consts::PI;

/// y'' + 2 zeta w y' + w^2 y = sqrt(2 pi S0) xi(t), at every step.
pub(super) struct GroundFilter {
    /// The stationary standard deviations of y and y'.
    sds: [f64; 2],
    /// y and y' after a step, from y and y' before it.
    matrix: [[f64; 2]; 2],
    /// The factor L of the covariance L L' of what the noise adds in a step: its entries 11, 21 and
    /// 22.
    factor: [f64; 3],
}

impl GroundFilter {
    pub fn new(w: f64, zeta: f64, intensity: f64, step: f64) -> Self {
        let gamma = zeta * w;
        let response = ImpulseResponse::new(gamma, w);
        let (s, slope) = (response.impulse(step), response.impulse_slope(step));
        let matrix = [[slope + 2.0 * gamma * s, s], [-w * w * s, slope]];
        let variance = PI * intensity / (2.0 * gamma);
        let variances = [variance / (w * w), variance];
        // The law is stationary, so the noise adds P - M P M'.
        let added = |i: usize, j: usize| {
            let stationary = if i == j { variances[i] } else { 0.0 };
            let kept = (0..2).map(|k| matrix[i][k] * variances[k] * matrix[j][k]);
            stationary - kept.sum::<f64>()
        };
        let first = added(0, 0).max(0.0).sqrt();
        let second = if first > 0.0 {
            added(1, 0) / first
        } else {
            0.0
        };
        let third = (added(1, 1) - second * second).max(0.0).sqrt();
        GroundFilter {
            sds: variances.map(f64::sqrt),
            matrix,
            factor: [first, second, third],
        }
    }

    /// y and y' in the stationary law.
    pub fn start(&mut self, stream: &mut Stream) -> [f64; 2] {
        self.sds.map(|sd| sd * stream.normal())
    }

    /// y and y' a step later.
    pub fn next(&mut self, [y, v]: [f64; 2], stream: &mut Stream) -> [f64; 2] {
        let [one, two] = [stream.normal(), stream.normal()];
        let [first, second, third] = self.factor;
        let [of_y, of_v] = self.matrix;
        [
            of_y[0] * y + of_y[1] * v + first * one,
            of_v[0] * y + of_v[1] * v + (second * one + third * two),
        ]
    }
}
