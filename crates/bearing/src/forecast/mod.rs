//! A forecast of future years for a bearing, from a calibration and a model of the weather.
//!
//! ```text
//! Calibration, WeatherFit
//!   -> draws        parameters of bearing and weather, from the distribution of their errors
//!     -> Year       for each, quasi-static motion under random weather: a year after a burn-in (year)
//!       -> Forecast each quantity with intervals for its mean and for a single year (summary)
//! ```
//!
//! The expected value is the mean over all years, which are scaled to the mean of years with the most
//! likely parameters.
//!
//! Crossings of the thresholds are those of the model in continuous time. A sampled temperature,
//! with a sample every ten minutes for example, misses slips between its samples.

mod draw;
mod question;
mod summary;
mod year;

use question::LIKELIEST;
pub use question::{ForecastError, ForecastQuestion};
pub use summary::{Forecast, ForecastLevel, ReturnLevel, Showed};
pub use year::{BURN_IN, ForecastQuantity, YEAR, Year};

use super::calibration::{
    Calibration, CalibrationMethod, CalibrationQuestion, MeasuredRecord, calibrate,
};
use super::weather::{PERIODS, WeatherFit, fit};
use draw::{BearingDraws, DrawnSteel};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use stickslip::ensemble::in_order;
use stickslip::noise::Stream;
use stickslip::scenario::BridgeScene;
use year::{SteelOfAYear, YearAndRecord, year};

/// Number of years of a task.
const TASK: u64 = 10;

/// A forecast, with its calibration and weather.
#[derive(Clone, Debug)]
pub struct BearingForecast {
    /// The calibration from the slips, because only that method gives errors of the parameters to
    /// draw from.
    pub calibration: Calibration,
    /// The model of the weather at the thermometer's own samples.
    pub weather: WeatherFit,
    /// The future years.
    pub forecast: Forecast,
}

impl BearingForecast {
    /// The forecast of a record, with at most this many processes in the weather. `None` if `stop`
    /// is raised before two draws are done. `begins` is called with a description of each stage.
    ///
    /// # Errors
    ///
    /// It fails if there is no calibration, no model of the weather, or no forecast from them.
    pub fn of(
        scene: &BridgeScene,
        record: &MeasuredRecord,
        question: &ForecastQuestion,
        processes: usize,
        threads: usize,
        stop: &AtomicBool,
        begins: &dyn Fn(&str),
    ) -> Result<Option<Self>, ForecastError> {
        begins("calibrating the bearing");
        let (method, level) = (CalibrationMethod::Slips, question.level);
        let asked = CalibrationQuestion {
            method,
            level,
            ..CalibrationQuestion::of(scene, record)
        };
        let calibration = calibrate(record, &asked, threads, stop)?;
        begins("fitting the weather");
        let [times, temperatures] = calibration.record.thermometer();
        let weather = fit(
            &times,
            &temperatures,
            &PERIODS,
            processes,
            calibration.record.averaged[0],
        )?;
        let years = (question.draws + LIKELIEST) * question.years;
        begins(&format!("simulating {years} years"));
        let forecast = forecast(&calibration, &weather, question, threads, stop)?;
        Ok(forecast.map(|forecast| BearingForecast {
            calibration,
            weather,
            forecast,
        }))
    }

    /// Warnings about the years: those of the calibration, of the weather and of the years, each
    /// with its name.
    pub fn warnings(&self) -> Vec<(String, String)> {
        let of_bearing = self
            .calibration
            .warnings
            .iter()
            .map(|warning| (warning.name().into(), warning.to_string()));
        of_bearing
            .chain(self.weather.named_warnings())
            .chain(self.forecast.warnings())
            .collect()
    }
}

/// Simulate years with parameters drawn from a calibration by slips and from a model of the
/// weather, in seconds and kelvin. If `stop` is raised, the forecast has fewer draws than
/// requested, and the result is `None` if there are fewer than two.
///
/// # Errors
///
/// It fails if most sampled parameter sets are unphysical, or if the record has far more or far
/// fewer slips than the same time in the forecast.
pub fn forecast(
    calibration: &Calibration,
    weather: &WeatherFit,
    question: &ForecastQuestion,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Option<Forecast>, ForecastError> {
    let bearings = BearingDraws::new(calibration);
    // Draw 0 has the most likely parameters. Every other draw has its own stream of random numbers,
    // separate from those of the years.
    let mut models = vec![(
        bearings.likeliest(),
        DrawnSteel::likeliest(calibration, weather),
    )];
    let mut redrawn = 0;
    for draw in 1..=question.draws {
        let mut random = Stream::new(question.seed ^ DRAW_SEED, draw);
        let (bearing, impossible) = bearings.draw(&mut random).ok_or(ForecastError::Unknown)?;
        redrawn += impossible;
        models.push((
            bearing,
            DrawnSteel::drawn(calibration, weather, &mut random),
        ));
    }
    if redrawn > question.draws {
        return Err(ForecastError::Unknown);
    }
    let showed = Showed::of(calibration);
    let tasks = question.years.div_ceil(TASK);
    let make = |task: u64| {
        let (draw, from) = (
            (task / tasks + 1).saturating_sub(LIKELIEST),
            task % tasks * TASK,
        );
        let (bearing, steel) = &models[draw as usize];
        let steel = SteelOfAYear::of(steel);
        let first = task / tasks * question.years;
        let one = |number: u64| {
            let mut random = Stream::new(question.seed, first + number);
            year(
                bearing,
                &steel,
                question.share,
                showed.duration,
                &mut random,
            )
        };
        let numbers =
            (from..question.years.min(from + TASK)).take_while(|_| !stop.load(Ordering::Relaxed));
        (draw, numbers.map(one).collect::<Vec<YearAndRecord>>())
    };
    let mut draws: Vec<Vec<YearAndRecord>> = Vec::new();
    let deliver = |(draw, years): (u64, Vec<YearAndRecord>)| {
        draws.resize_with(draw as usize + 1, Vec::new);
        draws[draw as usize].extend(years);
        Ok::<_, Infallible>(ControlFlow::Continue(()))
    };
    let Ok(_) = in_order(
        (LIKELIEST + question.draws) * tasks,
        threads,
        stop,
        make,
        deliver,
    );
    let knows_forces = calibration.question.shear_stiffness.is_some();
    Ok(
        Forecast::of(&draws, question, &showed, knows_forces)?.map(|forecast| Forecast {
            redrawn,
            ..forecast
        }),
    )
}

/// Turns the seed of the forecast into that of the draws of parameters.
const DRAW_SEED: u64 = 0xF0_4E_CA_57;
