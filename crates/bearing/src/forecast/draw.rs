//! Random bearings, distributed according to a calibration.

use crate::calibration::{Calibration, Motion, Quantity, Response, Sensor};
use crate::linear::{Matrix, cholesky, times};
use crate::weather::{Weather, WeatherFit};
use stickslip::noise::Stream;

/// The quantities that determine motion and reading. K, f_s and f_d follow from them, and x(0) is
/// forgotten in the burn-in.
const DRAWN: [Quantity; 5] = [
    Quantity::Dilatation,
    Quantity::Shear,
    Quantity::Offset,
    Quantity::Reach,
    Quantity::Jump,
];

/// A and G are at least this share of their estimates, because a very small A or G gives an
/// enormous number of slips.
const LEAST: f64 = 0.1;

/// A draw is repeated up to this many times until it is a possible bearing.
const REPEATS: u64 = 100;

/// A bearing, in kelvin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnBearing {
    /// Its motion, from any start, and the reading of its sensor.
    pub response: Response,
    /// K; 1 if it is not known.
    pub stiffness: f64,
}

/// The weather, and the lag of the steel behind the thermometer.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnSteel {
    pub weather: Weather,
    /// The lag, in seconds.
    pub lag: f64,
}

impl DrawnSteel {
    /// The most likely one.
    pub fn likeliest(calibration: &Calibration, weather: &WeatherFit) -> Self {
        DrawnSteel {
            weather: weather.likeliest(),
            lag: calibration.lag.estimate,
        }
    }

    /// A random one, distributed according to the errors.
    pub fn drawn(calibration: &Calibration, weather: &WeatherFit, random: &mut Stream) -> Self {
        let lag = calibration.lag.estimate + calibration.lag_error() * random.normal();
        DrawnSteel {
            weather: weather.drawn(random),
            lag: lag.max(0.0),
        }
    }
}

/// The distribution of the parameters according to a calibration.
pub struct BearingDraws {
    estimates: [f64; DRAWN.len()],
    errors: Matrix,
    shear_stiffness: Option<f64>,
    /// A in the record relative to its mean, if friction changes.
    range: Option<[f64; 2]>,
}

impl BearingDraws {
    /// A normal distribution with the standard errors and the correlations that the calibration
    /// found.
    pub fn new(calibration: &Calibration) -> Self {
        let estimates = DRAWN.map(|quantity| calibration.estimate(quantity).estimate);
        let sds = DRAWN.map(|quantity| calibration.standard_error(quantity));
        let correlation = |i: usize, j: usize| match i == j {
            true => 1.0,
            false => calibration.correlations[DRAWN[i] as usize][DRAWN[j] as usize],
        };
        let covariance: Matrix = (0..DRAWN.len())
            .map(|i| {
                (0..DRAWN.len())
                    .map(|j| finite(sds[i] * sds[j] * correlation(i, j)))
                    .collect()
            })
            .collect();
        // A fixed quantity has no error. The matrix then has a row of zeros and no Cholesky factor,
        // so the correlations are left out.
        let errors = cholesky(&covariance).unwrap_or_else(|| {
            let diagonal = |i: usize, j: usize| if i == j { finite(sds[i]) } else { 0.0 };
            (0..DRAWN.len())
                .map(|i| (0..DRAWN.len()).map(|j| diagonal(i, j)).collect())
                .collect()
        });
        let (shear_stiffness, range) = (
            calibration.question.shear_stiffness,
            calibration.friction_range,
        );
        BearingDraws {
            estimates,
            errors,
            shear_stiffness,
            range,
        }
    }

    /// The most likely bearing.
    pub fn likeliest(&self) -> DrawnBearing {
        self.at(&[0.0; DRAWN.len()])
    }

    /// A random possible bearing, and the number of impossible ones drawn before it. `None` if many
    /// draws in a row were impossible.
    pub fn draw(&self, random: &mut Stream) -> Option<(DrawnBearing, u64)> {
        (0..REPEATS).find_map(|before| {
            let mut bearing = self.at(&DRAWN.map(|_| random.normal()));
            if let Some([low, high]) = self.range {
                // Changing friction is drawn from any day of the record.
                let share = low + (high - low) * random.uniform();
                let Motion { reach, jump, .. } = &mut bearing.response.motion;
                (*reach, *jump) = (share * *reach, share * *jump);
            }
            self.is_possible(&bearing).then_some((bearing, before))
        })
    }

    fn is_possible(&self, bearing: &DrawnBearing) -> bool {
        let Motion { reach, jump, .. } = bearing.response.motion;
        let is_usual = reach >= LEAST * self.estimates[3] && jump >= LEAST * self.estimates[4];
        is_usual && bearing.response.impossible(self.shear_stiffness).is_none()
    }

    /// The bearing whose independent standardised errors are these.
    fn at(&self, normals: &[f64]) -> DrawnBearing {
        let errors = times(&self.errors, normals);
        let [beta, kappa, offset, reach, jump] =
            std::array::from_fn(|i| self.estimates[i] + errors[i]);
        DrawnBearing {
            response: Response {
                motion: Motion {
                    reach,
                    jump,
                    start: 0.0,
                },
                sensor: Sensor::sheared(offset, beta, kappa),
            },
            stiffness: self.shear_stiffness.map_or(1.0, |shear| kappa * shear),
        }
    }
}

fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { 0.0 }
}
