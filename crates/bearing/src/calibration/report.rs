//! The result of a calibration.

use super::bearing::Response;
use super::by_slips::BySlips;
use super::course::Course;
use super::lag::LagProfile;
use super::objective::FitObjective;
use super::quantity::{Quantity, Values, values};
use super::question::{CalibrationMethod, CalibrationQuestion};
use super::samples::{HOUR, MeasuredRecord};
use super::slips::Slip;
use super::starts::SearchStart;
use super::steel::Steel;
use super::zero::Zero;
use crate::linear::Matrix;
use crate::moments::mean;
use crate::warning::CalibrationWarning;
use statrs::distribution::{ContinuousCDF as _, Normal};

/// An estimate with its interval. Values that are not known are NaN.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParameterEstimate {
    /// The most likely value.
    pub estimate: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl ParameterEstimate {
    /// A value with an interval of this half width.
    fn around(estimate: f64, half: f64) -> Self {
        ParameterEstimate {
            estimate,
            low: estimate - half,
            high: estimate + half,
        }
    }

    /// A value that is known.
    fn exact(estimate: f64) -> Self {
        Self::around(estimate, 0.0)
    }

    /// Whether the interval contains a value.
    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// Factors of the standard deviations of the estimates by slips, with which intervals around the
/// paper's least-squares estimates contain the true values in 90 % of 150 synthetic records of the
/// paper's bridge.
///
/// Least squares determines A and G far better if friction is constant. It determines K, f_s and
/// f_d far worse, because it treats red noise as independent.
const WIDENING_ERR: Values = [
    2.85, 0.85, 3.2, 3.2, 2.55, 0.87, 3.4, 2.85, 0.45, 0.12, 0.95, 0.85,
];

/// A detected slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenSlip {
    /// The time in the middle between two samples, in seconds.
    pub time: f64,
    /// The temperature of the steel, in kelvin.
    pub temperature: f64,
    /// The jump of z - kappa beta T, with its sign.
    pub jump: f64,
    /// Whether it has the typical size; only such slips were fitted.
    pub is_usual: bool,
}

/// The difference between measurement and model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residuals {
    /// Root mean square of measurement minus model.
    pub rms: f64,
    /// Delays in hours, and the correlation of residuals with this delay.
    pub autocorrelation: Vec<(f64, f64)>,
}

/// The result of a calibration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calibration {
    /// The question.
    pub question: CalibrationQuestion,
    /// The record, with the sign for which displacements grow with temperature.
    pub record: MeasuredRecord,
    /// The temperature of the steel at each sample.
    pub steel: Vec<f64>,
    /// The variance that the temperature of the steel gains between samples, in K^2/s; 0 for linear
    /// interpolation.
    pub roughness: f64,
    /// How the zero of the sensor moves.
    pub zero: Zero,
    /// The resolution of the thermometer, in kelvin.
    pub resolution: f64,
    /// Whether displacements fell as the temperature rose, so that their sign was changed.
    pub is_mirrored: bool,
    /// How often the thermometer measured, in seconds, if it repeated its values, of which the record
    /// has the first ones.
    pub repeats: Option<f64>,
    /// The response from which the estimates are computed.
    pub response: Response,
    /// One estimate for each of [`Quantity::ALL`].
    pub estimates: [ParameterEstimate; Quantity::ALL.len()],
    /// The same by the least squares, from the best of its starts; `None` if not requested.
    pub least_squares: Option<[ParameterEstimate; Quantity::ALL.len()]>,
    /// Correlations of the errors of the estimates, one row for each quantity; empty if there are
    /// no slips.
    pub correlations: Vec<Values>,
    /// The slips in order of time.
    pub slips: Vec<SeenSlip>,
    /// The lag that was used, in seconds. Its interval is a single point if the lag was given.
    pub lag: ParameterEstimate,
    /// The likelihood as a function of the lag; `None` if there are no slips.
    pub lag_profile: Option<LagProfile>,
    /// The result of each start of the least squares.
    pub starts: Vec<SearchStart>,
    /// The reading z of the model at each sample.
    pub modelled: Vec<f64>,
    /// The difference between measurement and model.
    pub residuals: Residuals,
    /// The smallest and the largest A over a year or over the record, as shares of its mean, if
    /// friction changes.
    pub friction_range: Option<[ParameterEstimate; 2]>,
    /// How it changes; this and what follows, which a forecast needs, is not stored in files.
    pub(crate) course: Course,
    /// The covariance of the errors of [`Quantity::DRAWN`] and of the coefficients of that course.
    pub(crate) covariance: Matrix,
    /// The relative standard deviation of f_s from slip to slip, if it is clear.
    pub(crate) scatter: f64,
    /// Reasons to be careful with the result.
    pub warnings: Vec<CalibrationWarning>,
}

impl Calibration {
    /// The result for a record whose sign was not changed, without warnings.
    pub(super) fn new(
        question: &CalibrationQuestion,
        record: MeasuredRecord,
        steel: &Steel,
        by_slips: Option<&BySlips>,
        objective: &FitObjective,
        starts: Vec<SearchStart>,
    ) -> Calibration {
        let mut calibration = Calibration {
            question: question.clone(),
            steel: steel.record.temperatures.clone(),
            roughness: steel.roughness(),
            resolution: record.resolution(),
            lag: ParameterEstimate::exact(steel.lag),
            lag_profile: steel.profile.clone(),
            starts,
            record,
            ..Calibration::default()
        };
        calibration.estimate_all(by_slips, objective);
        if let Some(by_slips) = by_slips {
            calibration.add_slips(by_slips, steel.is_estimated);
        }
        let temperatures = &steel.record.temperatures;
        let Response { motion, sensor } = calibration.response;
        let samples = [&steel.record.times[..], &temperatures[..]];
        let positions = calibration
            .course
            .follow(&motion, steel.overlooked(), samples);
        let reading = |i: usize| {
            let moved = calibration.zero.at(steel.record.times[i]);
            sensor.reading(positions[i], temperatures[i]) + moved
        };
        calibration.modelled = (0..positions.len()).map(reading).collect();
        calibration.residuals = residuals(&calibration.record, &calibration.modelled);
        calibration
    }

    /// Set the estimates of the requested method.
    fn estimate_all(&mut self, by_slips: Option<&BySlips>, objective: &FitObjective) {
        let best = self.starts.iter().min_by(|a, b| a.err.total_cmp(&b.err));
        let best = best.map(|start| start.response);
        let motion = self.question.guess;
        let guess = Response {
            motion,
            sensor: objective.of(&motion).1,
        };
        let fitted = by_slips.map(|by_slips| by_slips.response);
        let wanted = fitted.filter(|_| self.question.method != CalibrationMethod::Err);
        self.response = wanted.or(best).or(fitted).unwrap_or(guess);
        let sides = normal_quantile(self.question.level);
        let unknown = [f64::NAN; Quantity::ALL.len()];
        let deviations = by_slips.map_or(unknown, |by_slips| by_slips.deviations);
        let with_intervals = |response: &Response, widening: &Values| {
            let at = values(response, self.question.shear_stiffness);
            std::array::from_fn(|i| {
                ParameterEstimate::around(at[i], sides * widening[i] * deviations[i])
            })
        };
        self.least_squares = best.map(|best| with_intervals(&best, &WIDENING_ERR));
        let of_response = with_intervals(&self.response, &[1.0; Quantity::ALL.len()]);
        self.estimates = match wanted {
            Some(_) => of_response,
            None => self.least_squares.unwrap_or(of_response),
        };
    }

    /// Add the results from the slips.
    fn add_slips(&mut self, by_slips: &BySlips, is_lag_estimated: bool) {
        let BySlips {
            zero,
            replicates,
            slips,
            ..
        } = by_slips;
        self.zero = zero.clone();
        self.correlations = replicates.correlations();
        let still = self.response.sensor.still;
        let seen = |slip: &Slip| SeenSlip {
            time: slip.time,
            temperature: slip.temperature,
            jump: slip.sign * slip.size(still),
            is_usual: slip.is_usual,
        };
        self.slips = slips.slips.iter().map(seen).collect();
        let motion = &self.response.motion;
        if by_slips.course.varies() {
            let at = by_slips.course.range(motion);
            let sides = normal_quantile(self.question.level);
            self.friction_range = Some(std::array::from_fn(|i| {
                let deviation = replicates.deviation_of(|shown| shown.range[i]);
                ParameterEstimate::around(at[i], sides * deviation)
            }));
        }
        self.course = by_slips.course;
        self.covariance = replicates.covariance(&Quantity::DRAWN);
        let scatter = slips.excess_scatter();
        if scatter > SCATTER {
            self.scatter = 0.5 * scatter * motion.jump / motion.reach;
        }
        if is_lag_estimated {
            let half = normal_quantile(self.question.level) * replicates.lag_deviation();
            self.lag = ParameterEstimate::around(self.lag.estimate, half);
            self.lag.low = self.lag.low.max(0.0);
        }
    }

    /// The standard error of the lag, in seconds; 0 if it was given or none was found.
    pub fn lag_error(&self) -> f64 {
        let error = 0.5 * (self.lag.high - self.lag.low) / normal_quantile(self.question.level);
        if error.is_finite() { error } else { 0.0 }
    }

    /// The estimate of a quantity.
    pub fn estimate(&self, quantity: Quantity) -> ParameterEstimate {
        self.estimates[quantity as usize]
    }

    /// The standard error of a quantity, from its interval; NaN if it has none.
    pub fn standard_error(&self, quantity: Quantity) -> f64 {
        let ParameterEstimate { low, high, .. } = self.estimate(quantity);
        0.5 * (high - low) / normal_quantile(self.question.level)
    }

    /// All quantities of the result of each start.
    pub fn start_values(&self) -> Vec<Values> {
        self.starts
            .iter()
            .map(|start| values(&start.response, self.question.shear_stiffness))
            .collect()
    }
}

/// The half-width of the central interval of a standard normal with this probability.
fn normal_quantile(level: f64) -> f64 {
    Normal::standard().inverse_cdf(0.5 + 0.5 * level)
}

/// Excess scatter of the sizes of slips above which f_s varies from slip to slip.
pub(super) const SCATTER: f64 = 0.2;

/// Delays of the autocorrelation, in hours.
const DELAYS: [f64; 14] = [
    0.0, 1.0, 2.0, 3.0, 6.0, 9.0, 12.0, 18.0, 24.0, 36.0, 48.0, 72.0, 96.0, 120.0,
];

fn residuals(record: &MeasuredRecord, modelled: &[f64]) -> Residuals {
    let samples = record.samples();
    let left: Vec<f64> = record
        .readings
        .iter()
        .zip(modelled)
        .map(|(z, model)| z - model)
        .collect();
    let seen: Vec<f64> = left
        .iter()
        .copied()
        .filter(|left| left.is_finite())
        .collect();
    let mean = mean(&seen);
    let variance = seen.iter().map(|left| (left - mean).powi(2)).sum::<f64>() / seen.len() as f64;
    let correlation = |hours: f64| {
        let products = samples
            .pairs(samples.intervals(hours * HOUR))
            .map(|[i, j]| (seen[j] - mean) * (seen[i] - mean));
        let [sum, count] = products.fold([0.0; 2], |[sum, count], product| {
            [sum + product, count + 1.0]
        });
        (hours, sum / count / variance)
    };
    let rms = (seen.iter().map(|left| left * left).sum::<f64>() / seen.len() as f64).sqrt();
    Residuals {
        rms,
        autocorrelation: DELAYS.map(correlation).to_vec(),
    }
}
