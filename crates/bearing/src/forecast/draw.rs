//! Random bearings, distributed according to a calibration.

use crate::calibration::{Calibration, Course, CourseShape, Motion, Quantity, Response, Sensor};
use crate::linear::{Matrix, cholesky, times};
use crate::weather::{Weather, WeatherFit};
use stickslip::noise::Stream;

/// The quantities that are drawn.
const DRAWN: [Quantity; 5] = Quantity::DRAWN;

/// A and G are at least this share of their estimates, because a very small A or G gives an
/// enormous number of slips.
const LEAST: f64 = 0.1;

/// A draw is repeated up to this many times until it is a possible bearing.
const REPEATS: u64 = 100;

/// A bearing, in kelvin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnBearing {
    /// Its motion at mean friction, from any start, and the reading of its sensor.
    pub response: Response,
    /// How its friction varies over the year.
    pub course: Course,
    /// The relative standard deviation of f_s from slip to slip.
    pub scatter: f64,
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
        let lag = drawn_lag(calibration, random);
        DrawnSteel {
            weather: weather.drawn(random),
            lag,
        }
    }
}

/// A random lag, in seconds, distributed according to its error.
fn drawn_lag(calibration: &Calibration, random: &mut Stream) -> f64 {
    let lag = calibration.lag.estimate + calibration.lag_error() * random.normal();
    lag.max(0.0)
}

/// The distribution of the parameters according to a calibration.
pub struct BearingDraws {
    estimates: [f64; DRAWN.len()],
    course: Course,
    scatter: f64,
    errors: Matrix,
    shear_stiffness: Option<f64>,
}

impl BearingDraws {
    /// A normal distribution with the standard errors and the correlations that the calibration
    /// found.
    pub fn new(calibration: &Calibration) -> Self {
        let estimates = DRAWN.map(|quantity| calibration.estimate(quantity).estimate);
        let covariance = &calibration.covariance;
        // A fixed quantity has no error. The matrix then has a row of zeros and no Cholesky factor,
        // so the correlations are left out.
        let errors = cholesky(covariance).unwrap_or_else(|| {
            let diagonal = |i: usize, j: usize| if i == j { covariance[i][i].sqrt() } else { 0.0 };
            (0..covariance.len())
                .map(|i| (0..covariance.len()).map(|j| diagonal(i, j)).collect())
                .collect()
        });
        BearingDraws {
            estimates,
            course: calibration.course,
            scatter: calibration.scatter,
            errors,
            shear_stiffness: calibration.question.shear_stiffness,
        }
    }

    /// The most likely bearing.
    pub fn likeliest(&self) -> DrawnBearing {
        self.at(&vec![0.0; self.errors.len()])
    }

    /// A random possible bearing, and the number of impossible ones drawn before it. `None` if many
    /// draws in a row were impossible.
    pub fn draw(&self, random: &mut Stream) -> Option<(DrawnBearing, u64)> {
        (0..REPEATS).find_map(|before| {
            let normals: Vec<f64> = self.errors.iter().map(|_| random.normal()).collect();
            let bearing = self.at(&normals);
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
        let coefficients = self.course.coefficients();
        let varied = coefficients.iter().zip(&errors[DRAWN.len()..]);
        let mut course = self
            .course
            .with(&varied.map(|(a, b)| a + b).collect::<Vec<_>>());
        let mut motion = Motion {
            reach,
            jump,
            start: 0.0,
        };
        match &mut course.shape {
            CourseShape::Constant => (),
            // A year counts from the first sample.
            CourseShape::Season(start) => *start = 0.0,
            // Whether a trend goes on is unknown; the years have the friction at its end.
            CourseShape::Trend([_, end]) => {
                let end = *end;
                motion = course.motion(&motion, end);
                course = Course::default();
            }
        }
        DrawnBearing {
            response: Response {
                motion,
                sensor: Sensor::sheared(offset, beta, kappa),
            },
            course,
            scatter: self.scatter,
            stiffness: self.shear_stiffness.map_or(1.0, |shear| kappa * shear),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::{CalibrationQuestion, ParameterEstimate};

    /// Null: a lag of 3600 s, whose 90 % interval is +-164.5 s, is drawn with a standard deviation of
    /// 100 s. Of 10^4 draws, the mean has a standard error of 1 s and the standard deviation one of
    /// 0.7 %; the bounds are four of these (false-alarm rate 1e-4).
    #[test]
    fn lags_are_drawn_with_their_error() {
        let half = 164.485_363;
        let calibration = Calibration {
            question: CalibrationQuestion {
                level: 0.9,
                ..CalibrationQuestion::default()
            },
            lag: ParameterEstimate {
                estimate: 3600.0,
                low: 3600.0 - half,
                high: 3600.0 + half,
            },
            ..Calibration::default()
        };
        let mut random = Stream::new(11, 0);
        let off: Vec<f64> = (0..10_000)
            .map(|_| drawn_lag(&calibration, &mut random) - 3600.0)
            .collect();
        let mean = off.iter().sum::<f64>() / 1e4;
        let sd = (off.iter().map(|off| off * off).sum::<f64>() / 1e4).sqrt();
        assert!(
            mean.abs() < 4.0 && (sd / 100.0 - 1.0).abs() < 0.028,
            "{mean} {sd}"
        );
    }

    /// What is known exactly is drawn as it is. K is that of the kappa of the same draw.
    #[test]
    fn a_drawn_bearing_agrees_with_itself() {
        let mut calibration = Calibration::default();
        calibration.question.level = 0.9;
        calibration.question.shear_stiffness = Some(2e9);
        for (quantity, estimate) in DRAWN.into_iter().zip([3e-4, 0.1, 0.0, 8.0, 1.5]) {
            calibration.estimates[quantity as usize].estimate = estimate;
        }
        calibration.covariance = vec![vec![0.0; DRAWN.len()]; DRAWN.len()];
        calibration.covariance[1][1] = 0.006_f64.powi(2);
        let draws = BearingDraws::new(&calibration);
        let mut random = Stream::new(3, 0);
        let mut kappas = Vec::new();
        for _ in 0..20 {
            let (bearing, _) = draws.draw(&mut random).expect("possible");
            let Response { motion, sensor } = bearing.response;
            assert_eq!([motion.reach, motion.jump], [8.0, 1.5]);
            let kappa = sensor.still / sensor.dilatation();
            assert!((bearing.stiffness / (2e9 * kappa) - 1.0).abs() < 1e-12);
            kappas.push(kappa);
        }
        assert!(kappas.iter().any(|kappa| (kappa - 0.1).abs() > 1e-3));
    }
}
