//! The question of a forecast, and why there may be none.

use crate::calibration::CalibrationError;
use crate::weather::{HarmonicError, WeatherError};

/// The question of a forecast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForecastQuestion {
    /// Number of draws of the parameters of bearing and weather.
    pub draws: u64,
    /// Number of years for each draw.
    pub years: u64,
    /// The seed, which determines all random numbers together with the numbers of draws and paths.
    pub seed: u64,
    /// The coverage probability of the intervals.
    pub level: f64,
    /// q: the time with |F| above this share of f_s is counted.
    pub share: f64,
}

/// The most likely parameters get this many times as many years as one draw.
pub(super) const LIKELIEST: u64 = 10;

/// Why there is no forecast.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ForecastError {
    /// The bearing cannot be calibrated.
    #[error(transparent)]
    Bearing(#[from] CalibrationError),
    /// There is no model of the weather.
    #[error(transparent)]
    Weather(#[from] WeatherError),
    /// Most of the sampled parameter sets are unphysical.
    #[error(
        "the record does not constrain the bearing: most sampled parameter sets are unphysical"
    )]
    Unknown,
    /// The record and the forecast of the same time differ too much.
    #[error(
        "the record shows {slips:.0} slips in {days:.0} days, a sliding path of {:.1} mm, but \
         99.8 % of the simulated records of the same days show between {:.0} and {:.0}: the model \
         does not describe this weather or this bearing, so no forecast is made",
        1e3 * path, range[0], range[1]
    )]
    NotTheRecord {
        /// Number of slips in the record.
        slips: f64,
        /// Their sum, in metres.
        path: f64,
        /// The days of the record.
        days: f64,
        /// The range of the number of slips in simulated records.
        range: [f64; 2],
    },
}

impl ForecastError {
    /// What to do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            ForecastError::Bearing(CalibrationError::NoSlips) => {
                "measure for longer, until the record has tens of slips"
            }
            ForecastError::Bearing(error) => error.remedy(),
            ForecastError::Weather(WeatherError::Harmonic(HarmonicError::Short(_))) => {
                "measure for at least half a year, because a forecast needs the seasons"
            }
            ForecastError::Weather(error) => error.remedy(),
            ForecastError::Unknown => "measure for longer, to constrain the parameters",
            ForecastError::NotTheRecord { .. } => {
                "use air temperatures measured in the shade, give `averaged` if the logger stores \
                 means, and inspect the residuals of the calibration"
            }
        }
    }
}
