//! What years to come do to a bearing: from a calibration and a model of the weather.
//!
//! ```text
//! Calibration, WeatherFit
//!   -> draws        parameters of bearing and weather, from the law of their errors
//!     -> Year       paths of the quasi-static scheme for each: a year after a burn-in (year)
//!       -> Forecast each quantity with two intervals: of what is expected, and of one year (summary)
//! ```
//!
//! What is expected is the mean of years with the likeliest parameters. The mean over all draws
//! would be too high by some percent: slips grow faster than in proportion with the variance of the
//! weather.
//!
//! Crossings of the thresholds are those of the model in continuous time. A weather that is
//! sampled, every ten minutes for example, overlooks the slips between its samples.

mod draw;
mod summary;
mod year;

pub use summary::{Forecast, Level, ReturnLevel};
pub use year::{Quantity, Year};

use super::calibration::Calibration;
use super::weather::WeatherFit;
use crate::ensemble::in_order;
use crate::noise::Stream;
use crate::scheme::{DEFAULT_TOLERANCE, Misfit, QuasiStatic, Scheme, Simulate as _, Timeline};
use draw::BearingDraws;
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use year::YearObserver;

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Question {
    /// How many draws of the parameters of bearing and weather.
    pub draws: u64,
    /// How many years for each of them.
    pub years: u64,
    /// With the numbers of the draws, decides all random numbers.
    pub seed: u64,
    /// The probability with which an interval is to hold what it is about.
    pub level: f64,
    /// q: the share of f_s above which time is counted.
    pub share: f64,
}

/// The time before a year is counted, in seconds: the body forgets where it was once the
/// temperature has swung by more than 2 A both ways, which takes days to weeks.
pub const BURN_IN: f64 = 90.0 * 86_400.0;

/// A year, in seconds.
pub const YEAR: f64 = 365.25 * 86_400.0;

/// How far apart the instants are at which z and F are looked at besides slips, in seconds.
pub const LOOKS: f64 = 3600.0;

/// So many times as many years have the likeliest parameters as those of one draw.
const LIKELIEST: u64 = 10;

/// How many years a piece of work has.
const PIECE: u64 = 10;

/// Simulate years with parameters drawn from a calibration by slips and from a model of the
/// weather, in seconds and kelvin. Fewer draws than were asked for are in it if `stop` was raised;
/// none if not even two are.
///
/// # Errors
///
/// Where the parameters are such that they cannot be simulated.
pub fn forecast(
    calibration: &Calibration,
    weather: &WeatherFit,
    question: &Question,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Option<Forecast>, Misfit> {
    let bearings = BearingDraws::new(calibration);
    let timeline = Timeline { end: BURN_IN + YEAR, output_step: LOOKS, period: None, after: BURN_IN };
    let scheme = Scheme::from(QuasiStatic { tolerance: DEFAULT_TOLERANCE });
    // The likeliest parameters first; then a stream for each draw, beside those of paths, which the
    // seed and their numbers decide.
    let model = |draw: u64| {
        if draw == 0 {
            let bearing = bearings.likeliest();
            return (bearing, bearing.model(weather.temperature()));
        }
        let mut random = Stream::new(question.seed ^ DRAWS, draw);
        let bearing = bearings.draw(&mut random);
        (bearing, bearing.model(weather.drawn(&mut random)))
    };
    for draw in 0..=question.draws {
        scheme.check(&model(draw).1, timeline.end)?;
    }
    let pieces = question.years.div_ceil(PIECE);
    let make = |piece: u64| {
        let (draw, from) = ((piece / pieces + 1).saturating_sub(LIKELIEST), piece % pieces * PIECE);
        let first = piece / pieces * question.years;
        let numbers: Vec<u64> = (from..question.years.min(from + PIECE)).map(|n| first + n).collect();
        let (bearing, model) = model(draw);
        let mut observer = YearObserver::new(bearing, question.share, numbers.len(), stop);
        let lost = scheme.simulation(&model, &timeline).simulate(question.seed, &numbers, &mut observer);
        (draw, observer.years(&lost))
    };
    let mut years: Vec<Vec<Year>> = Vec::new();
    let deliver = |(draw, some): (u64, Vec<Year>)| {
        years.resize_with(draw as usize + 1, Vec::new);
        years[draw as usize].extend(some);
        Ok::<_, Infallible>(ControlFlow::Continue(()))
    };
    let Ok(_) = in_order((LIKELIEST + question.draws) * pieces, threads, stop, make, deliver);
    // The last draw may have been given up.
    years.retain(|years| years.len() as u64 >= question.years);
    Ok(Forecast::of(years, question, calibration.question.shear_stiffness.is_some()))
}

/// Turns a seed into that of the draws of parameters.
const DRAWS: u64 = 0xF0_4E_CA_57;
