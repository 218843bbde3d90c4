//! The result of a calibration.

use super::bearing::Response;
use super::lag::LagProfile;
use super::misfit::Misfit;
use super::quantity::{Quantity, Values, values};
use super::question::{Lag, Method, Question};
use super::samples::{HOUR, Record};
use super::slips::Evidence;
use super::spikes::Spikes;
use super::starts::Start;
use super::uncertainty::Replicates;
use super::warning::Warning;
use statrs::distribution::{ContinuousCDF as _, Normal};

/// A quantity, and where it is with the probability that was asked for. Missing is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The likeliest value.
    pub estimate: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Estimate {
    /// Whether the interval holds this.
    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// By how much the standard deviation of each quantity over the random weights is too small.
///
/// Blocks of three days are not quite independent, and few. So intervals are widened as much as it
/// took to hold the truth in 90 of 100 of 400 twins of the paper's bridge with red noise, which are
/// other twins than those that the tests judge by: `cargo test --release --test calibration
/// widening -- --ignored --nocapture` prints by how much more they would have to be.
const WIDENING: Values = [1.05, 1.22, 1.07, 1.06, 1.08, 1.23, 1.26, 1.05, 1.47, 1.17, 1.21, 1.22];

/// The same for the paper's least squares, around whose estimates the same law is laid: of 150 such
/// twins.
///
/// It knows A and G far better, if friction is always the same, and K, f_s and f_d far worse,
/// because it takes red noise for independent.
const WIDENING_ERR: Values = [2.85, 0.85, 3.2, 3.2, 2.55, 0.87, 3.4, 2.85, 0.45, 0.12, 0.95, 0.85];

/// A slip that was seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenSlip {
    /// In the middle between two samples, in seconds.
    pub time: f64,
    /// Of steel, in kelvin.
    pub temperature: f64,
    /// The jump of z - kappa beta T, with its sign.
    pub jump: f64,
    /// Whether it went as far as most; only those were fitted.
    pub is_usual: bool,
}

/// What the model leaves of the measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Residuals {
    /// The root of the mean square of measurement less model.
    pub rms: f64,
    /// Delays in hours, and the correlation of residuals so far apart.
    pub autocorrelation: Vec<(f64, f64)>,
}

/// A calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// What was asked.
    pub question: Question,
    /// The measurement without spikes, and with displacements that grow with temperature.
    pub record: Record,
    /// The temperature of steel, sample by sample.
    pub steel: Vec<f64>,
    /// What was taken out.
    pub spikes: Spikes,
    /// Whether the sensor counts the other way, so that its readings were taken with the other
    /// sign.
    pub is_mirrored: bool,
    /// The response that the estimates are of.
    pub response: Response,
    /// One for each of [`Quantity::ALL`].
    pub estimates: [Estimate; Quantity::ALL.len()],
    /// The same by the least squares, from the best of its starts.
    pub least_squares: Option<[Estimate; Quantity::ALL.len()]>,
    /// Correlations of the errors of estimates, one row for each quantity; none without slips.
    pub correlations: Vec<Values>,
    /// In order of time.
    pub slips: Vec<SeenSlip>,
    /// The lag that was used, in seconds; its interval is one point if it was given.
    pub lag: Estimate,
    /// How the likelihood depends on the lag; none without slips.
    pub lag_profile: Option<LagProfile>,
    /// What each start of the least squares found.
    pub starts: Vec<Start>,
    /// What z the model says, sample by sample.
    pub modelled: Vec<f64>,
    /// What it leaves.
    pub residuals: Residuals,
    /// What to beware of.
    pub warnings: Vec<Warning>,
}

/// All that a result is put together from.
pub(super) struct Parts<'a> {
    pub question: &'a Question,
    pub record: &'a Record,
    pub steel: &'a Record,
    pub spikes: Spikes,
    pub is_mirrored: bool,
    pub used: f64,
    pub profile: Option<LagProfile>,
    pub evidence: Option<&'a Evidence>,
    pub by_slips: Option<Response>,
    pub replicates: Option<Replicates>,
    pub deviations: Option<Values>,
    pub misfit: &'a Misfit,
    pub starts: Vec<Start>,
}

impl Calibration {
    pub(super) fn new(parts: Parts) -> Calibration {
        let best = parts.starts.iter().min_by(|a, b| a.err.total_cmp(&b.err)).map(|start| start.response);
        let motion = parts.question.guess;
        let guess = Response { motion, sensor: parts.misfit.of(&motion).1 };
        let by_slips = parts.by_slips.filter(|_| parts.question.method != Method::Err);
        let response = by_slips.or(best).or(parts.by_slips).unwrap_or(guess);
        let sides = normal_quantile(parts.question.level);
        let deviations = parts.deviations.unwrap_or([f64::NAN; Quantity::ALL.len()]);
        let with_intervals = |response: &Response, widening: &Values| {
            let at = values(response, parts.question.shear_stiffness);
            std::array::from_fn(|i| {
                let half = sides * widening[i] * deviations[i];
                Estimate { estimate: at[i], low: at[i] - half, high: at[i] + half }
            })
        };
        let least_squares = best.map(|best| with_intervals(&best, &WIDENING_ERR));
        let estimates = match by_slips {
            Some(fit) => with_intervals(&fit, &WIDENING),
            None => least_squares.unwrap_or_else(|| with_intervals(&response, &WIDENING)),
        };
        let half = match parts.question.lag {
            Lag::Auto if parts.used > 0.0 => {
                sides * parts.replicates.as_ref().map_or(f64::NAN, Replicates::lag_deviation)
            }
            _ => 0.0,
        };
        let lag = Estimate { estimate: parts.used, low: (parts.used - half).max(0.0), high: parts.used + half };
        let slips = parts.evidence.map_or_else(Vec::new, |evidence| {
            let seen = |slip: &super::slips::Slip| SeenSlip {
                time: slip.time,
                temperature: slip.temperature,
                jump: slip.sign * slip.size(response.sensor.still),
                is_usual: slip.is_usual,
            };
            evidence.slips.iter().map(seen).collect()
        });
        let positions = response.motion.follow(&parts.steel.temperatures);
        let reading = |(xi, t): (&f64, &f64)| response.sensor.reading(*xi, *t);
        let modelled: Vec<f64> = positions.iter().zip(&parts.steel.temperatures).map(reading).collect();
        let residuals = residuals(parts.record, &modelled);
        Calibration {
            question: parts.question.clone(),
            record: parts.record.clone(),
            steel: parts.steel.temperatures.clone(),
            spikes: parts.spikes,
            is_mirrored: parts.is_mirrored,
            response,
            estimates,
            least_squares,
            correlations: parts.replicates.as_ref().map_or_else(Vec::new, Replicates::correlations),
            slips,
            lag,
            lag_profile: parts.profile,
            starts: parts.starts,
            modelled,
            residuals,
            warnings: Vec::new(),
        }
    }

    /// The estimate of a quantity.
    pub fn estimate(&self, quantity: Quantity) -> Estimate {
        self.estimates[quantity as usize]
    }

    /// The standard error of a quantity: that of its interval. NaN where it has none.
    pub fn standard_error(&self, quantity: Quantity) -> f64 {
        let Estimate { low, high, .. } = self.estimate(quantity);
        0.5 * (high - low) / normal_quantile(self.question.level)
    }

    /// All quantities at each start.
    pub fn start_values(&self) -> Vec<Values> {
        self.starts.iter().map(|start| values(&start.response, self.question.shear_stiffness)).collect()
    }
}

/// How far to both sides a standard normal is with this probability.
fn normal_quantile(level: f64) -> f64 {
    Normal::standard().inverse_cdf(0.5 + 0.5 * level)
}

/// Delays of the autocorrelation, in hours.
const DELAYS: [f64; 14] = [0.0, 1.0, 2.0, 3.0, 6.0, 9.0, 12.0, 18.0, 24.0, 36.0, 48.0, 72.0, 96.0, 120.0];

fn residuals(record: &Record, modelled: &[f64]) -> Residuals {
    let samples = record.samples();
    let left: Vec<f64> = record.readings.iter().zip(modelled).map(|(z, model)| z - model).collect();
    let seen: Vec<f64> = left.iter().copied().filter(|left| left.is_finite()).collect();
    let mean = seen.iter().sum::<f64>() / seen.len() as f64;
    let variance = seen.iter().map(|left| (left - mean).powi(2)).sum::<f64>() / seen.len() as f64;
    let correlation = |hours: f64| {
        let step = (hours * HOUR / samples.interval()).round() as usize;
        let pairs = samples.stretches().flat_map(|stretch| stretch.start + step..stretch.end.max(stretch.start + step));
        let [sum, count] =
            pairs.fold([0.0; 2], |[sum, count], i| [sum + (seen[i] - mean) * (seen[i - step] - mean), count + 1.0]);
        (hours, sum / count / variance)
    };
    let rms = (seen.iter().map(|left| left * left).sum::<f64>() / seen.len() as f64).sqrt();
    Residuals { rms, autocorrelation: DELAYS.map(correlation).to_vec() }
}
