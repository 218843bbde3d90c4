//! A forecast of coming years for a bearing, from a calibration and a model of the weather.
//!
//! ```text
//! Calibration, WeatherFit
//!   -> draws        parameters of bearing and weather, from the distribution of their errors
//!     -> Year       paths of the quasi-static scheme for each: a year after a burn-in (year)
//!       -> Forecast each quantity with intervals for its mean and for a single year (summary)
//! ```
//!
//! The expected value is the mean over years with the most likely parameters. The mean over all
//! draws would be too high by some percent, because the number of slips grows faster than the
//! variance of the weather.
//!
//! Crossings of the thresholds are those of the model in continuous time. A sampled temperature,
//! with a sample every ten minutes for example, misses slips between its samples.

mod draw;
mod question;
mod summary;
mod year;

use question::LIKELIEST;
pub use question::{ForecastError, ForecastQuestion};
use summary::SimulatedDraw;
pub use summary::{Forecast, ForecastLevel, ReturnLevel};
pub use year::{ForecastQuantity, Year};

use super::calibration::Calibration;
use super::weather::WeatherFit;
use crate::ensemble::in_order;
use crate::noise::Stream;
use crate::scheme::{DEFAULT_TOLERANCE, QuasiStatic, Scheme, Simulate as _, Timeline};
use draw::BearingDraws;
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use year::YearObserver;

/// The time before a year is counted, in seconds. The body forgets its initial position once the
/// temperature has changed by more than 2 A in both directions, which takes days to weeks.
pub const BURN_IN: f64 = 90.0 * 86_400.0;

/// A year, in seconds.
pub const YEAR: f64 = 365.25 * 86_400.0;

/// Seconds between the times at which z and F are observed in addition to slips.
pub const OBSERVATION_STEP: f64 = 3600.0;

/// Number of years in a piece of work.
const PIECE: u64 = 10;

/// Simulate years with parameters drawn from a calibration by slips and from a model of the
/// weather, in seconds and kelvin. If `stop` is raised, the forecast has fewer draws than asked
/// for, and the result is `None` if it would have fewer than two.
///
/// # Errors
///
/// It fails if most of the parameters that the calibration leaves open are those of no bearing, or
/// if the scheme cannot simulate some of the drawn parameters. It also fails if years are
/// given up with so many of them that fewer than two draws are left, or if all years with the most
/// likely parameters are given up.
pub fn forecast(
    calibration: &Calibration,
    weather: &WeatherFit,
    question: &ForecastQuestion,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Option<Forecast>, ForecastError> {
    let bearings = BearingDraws::new(calibration);
    let timeline = Timeline { end: BURN_IN + YEAR, output_step: OBSERVATION_STEP, period: None, after: BURN_IN };
    let scheme = Scheme::from(QuasiStatic { tolerance: DEFAULT_TOLERANCE });
    // Draw 0 has the most likely parameters. Every other draw has a stream of random numbers of its
    // own, separate from those of the paths.
    let mut models = vec![(bearings.likeliest(), weather.temperature())];
    let mut redrawn = 0;
    for draw in 1..=question.draws {
        let mut random = Stream::new(question.seed ^ DRAW_SEED, draw);
        let (bearing, impossible) = bearings.draw(&mut random).ok_or(ForecastError::Unknown)?;
        redrawn += impossible;
        models.push((bearing, weather.drawn(&mut random)));
    }
    if redrawn > question.draws {
        return Err(ForecastError::Unknown);
    }
    let model = |draw: u64| {
        let (bearing, temperature) = &models[draw as usize];
        (*bearing, bearing.model(temperature.clone()))
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
        (draw, observer.years(&lost), lost.len() as u64)
    };
    let mut draws: Vec<SimulatedDraw> = Vec::new();
    let deliver = |(draw, years, given_up): (u64, Vec<Year>, u64)| {
        draws.resize_with(draw as usize + 1, SimulatedDraw::default);
        draws[draw as usize].years.extend(years);
        draws[draw as usize].given_up += given_up;
        Ok::<_, Infallible>(ControlFlow::Continue(()))
    };
    let Ok(_) = in_order((LIKELIEST + question.draws) * pieces, threads, stop, make, deliver);
    let knows_forces = calibration.question.shear_stiffness.is_some();
    Ok(Forecast::of(draws, question, knows_forces)?.map(|forecast| Forecast { redrawn, ..forecast }))
}

/// Turns the seed of the forecast into that of the draws of parameters.
const DRAW_SEED: u64 = 0xF0_4E_CA_57;
