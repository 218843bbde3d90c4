//! What is asked of a forecast, and why there may be none.

use crate::scheme::Misfit;

/// What is asked of a forecast.
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
    /// The scheme cannot simulate some of the drawn parameters.
    #[error(transparent)]
    Misfit(#[from] Misfit),
    /// Most of the parameters that the calibration leaves open are those of no bearing.
    #[error(
        "the record tells too little of the bearing: most of the parameters that it leaves open are those of no bearing"
    )]
    Unknown,
    /// So many years were given up that no intervals can be computed.
    #[error("years were given up with {0} of {1} draws of the parameters, {GIVEN_UP}, so there are no intervals")]
    GivenUp(u64, u64),
}

impl ForecastError {
    /// What to do if too little is known.
    pub const REMEDY: &str = "measure for longer, so that the parameters are known better";
}

/// Why a year is given up.
pub(super) const GIVEN_UP: &str = "because they had more slips than can be simulated";
