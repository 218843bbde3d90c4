//! Bearings as a calibration allows them.

use crate::model::{Friction, Model, Oscillator, Temperature};
use crate::noise::Stream;
use crate::study::calibration::{Calibration, Quantity, Sensor};
use crate::study::linear::{Matrix, cholesky, times};

/// What decides motion and reading; K, f_s and f_d follow, and x(0) is forgotten.
const DRAWN: [Quantity; 5] = [Quantity::Dilatation, Quantity::Shear, Quantity::Offset, Quantity::Reach, Quantity::Jump];

/// G is at least this share of its estimate: less makes slips without number.
const LEAST_JUMP: f64 = 0.1;

/// How long a slip lasts, in seconds: beside the weather, no time.
const SLIP: f64 = 0.1;

/// A bearing in kelvin, and how a sensor sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnBearing {
    /// A.
    pub reach: f64,
    /// G.
    pub jump: f64,
    /// z0 and the two slopes.
    pub sensor: Sensor,
    /// K; 1 where it is not known.
    pub stiffness: f64,
}

impl DrawnBearing {
    /// beta.
    pub fn dilatation(&self) -> f64 {
        self.sensor.moving + self.sensor.still
    }

    /// The quasi-static model of it.
    pub fn model(&self, temperature: Temperature) -> Model {
        let slope = self.stiffness * self.dilatation();
        let static_force = self.reach * slope;
        let rate = std::f64::consts::PI / SLIP;
        Model {
            oscillator: Oscillator {
                mass: self.stiffness / (rate * rate),
                stiffness: self.stiffness,
                damping: 0.0,
                dilatation: self.dilatation(),
            },
            friction: Friction { static_force, dynamic_force: static_force - 0.5 * self.jump * slope },
            initial_displacement: self.dilatation() * temperature.deterministic(0.0),
            temperature,
        }
    }
}

/// The law of the errors of a calibration.
pub struct BearingDraws {
    estimates: [f64; DRAWN.len()],
    errors: Matrix,
    shear_stiffness: Option<f64>,
}

impl BearingDraws {
    /// Normal, with the widths of the intervals and the correlations that the calibration found.
    pub fn new(calibration: &Calibration) -> Self {
        let estimates = DRAWN.map(|quantity| calibration.estimate(quantity).estimate);
        let sds = DRAWN.map(|quantity| calibration.standard_error(quantity));
        let correlation = |i: usize, j: usize| match i == j {
            true => 1.0,
            false => calibration.correlations[DRAWN[i] as usize][DRAWN[j] as usize],
        };
        let covariance: Matrix = (0..DRAWN.len())
            .map(|i| (0..DRAWN.len()).map(|j| finite(sds[i] * sds[j] * correlation(i, j))).collect())
            .collect();
        // What was held has no error, and a matrix with a row of zeros no factor.
        let errors = cholesky(&covariance).unwrap_or_else(|| {
            let diagonal = |i: usize, j: usize| if i == j { finite(sds[i]) } else { 0.0 };
            (0..DRAWN.len()).map(|i| (0..DRAWN.len()).map(|j| diagonal(i, j)).collect()).collect()
        });
        BearingDraws { estimates, errors, shear_stiffness: calibration.question.shear_stiffness }
    }

    /// The likeliest bearing.
    pub fn likeliest(&self) -> DrawnBearing {
        self.at(&[0.0; DRAWN.len()])
    }

    /// One bearing of many.
    pub fn draw(&self, random: &mut Stream) -> DrawnBearing {
        self.at(&DRAWN.map(|_| random.normal()))
    }

    /// So many standard errors away from the likeliest one, in directions that are independent.
    fn at(&self, normals: &[f64]) -> DrawnBearing {
        let errors = times(&self.errors, normals);
        let [beta, kappa, offset, reach, jump] = std::array::from_fn(|i| self.estimates[i] + errors[i]);
        let jump = jump.clamp(LEAST_JUMP * self.estimates[4], 2.0 * reach);
        DrawnBearing {
            reach,
            jump,
            sensor: Sensor { offset, moving: (1.0 - kappa) * beta, still: kappa * beta },
            stiffness: self.shear_stiffness.map_or(1.0, |shear| kappa * shear),
        }
    }
}

fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { 0.0 }
}
