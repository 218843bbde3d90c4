//! The most likely parameters of the weather, and their errors.

use super::periods::{HarmonicError, check_harmonics};
use super::result::WeatherFit;
use super::search::{Peak, ProcessSearch};
use crate::unsound::{SEE_SENSOR, Unsound};

/// Why a temperature has no model.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WeatherError {
    /// The record has too few samples.
    #[error("need at least {LEAST} samples to fit the temperature model, got {0}")]
    TooShort(usize),
    /// The samples do not resolve one of the harmonics.
    #[error(transparent)]
    Harmonic(#[from] HarmonicError),
    /// The temperature cannot be used.
    #[error(transparent)]
    Unsound(#[from] Unsound),
    /// The samples have no variation to fit.
    #[error(
        "no process explains these samples: the temperature may be constant or purely periodic"
    )]
    NoProcess,
}

impl WeatherError {
    /// What the user can do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            WeatherError::TooShort(_) => "measure for longer",
            WeatherError::Harmonic(error) => error.remedy(),
            WeatherError::Unsound(error) => error.remedy(),
            WeatherError::NoProcess => SEE_SENSOR,
        }
    }
}

/// Fewest samples of a record.
const LEAST: usize = 100;

/// A second process is used if it raises twice the log-likelihood by more than this. By chance its
/// two parameters gain this much in one of 20 records (chi^2 with two degrees of freedom).
const SECOND: f64 = 6.0;

/// The thinned records with which a fit is compared: one in this many samples.
const THINNED: [usize; 3] = [2, 4, 8];

/// Fit harmonics of these periods and at most this many processes, one or two, to samples at
/// ascending times, by the largest restricted likelihood. Each sample is a mean over `window`
/// seconds around its time, or instantaneous if that is 0. A second process that the samples do not
/// distinguish from the first is left out, and so is a smoothing time constant. A process whose
/// correlation time is not short compared with the record is fixed at the longest correlation time
/// that the record can resolve.
///
/// The same model is fitted to every 2nd, 4th and 8th sample as well: if it is correct, all of them
/// give the same numbers.
///
/// # Errors
///
/// If the record is too short, a number in it is too large, all temperatures are equal, a period is
/// named twice, or the samples do not determine the processes.
pub fn fit(
    times: &[f64],
    temperatures: &[f64],
    periods: &[f64],
    processes: usize,
    window: f64,
) -> Result<WeatherFit, WeatherError> {
    let n = times.len();
    if n < LEAST {
        return Err(WeatherError::TooShort(n));
    }
    Unsound::absurd("temperature", times, temperatures)?;
    Unsound::constant("temperature", temperatures)?;
    check_harmonics(times, periods)?;
    let samples = [times, temperatures];
    let search = |processes: usize, smooths: bool| {
        ProcessSearch::new(samples, periods, processes, smooths, window)
    };
    // The time constant is one more parameter, for which twice the log-likelihood has to gain log n
    // (Schwarz, Annals of Statistics 6, 1978).
    let price = libm::log(n as f64);
    let deviance = |smooths: bool| {
        let lowest = |n: usize| {
            search(n, smooths)
                .rough(None, 0.0)
                .map_or(f64::INFINITY, |found| found.deviance)
        };
        (1..=processes).map(lowest).fold(f64::INFINITY, f64::min)
    };
    let may_be_smoothed = deviance(true) < deviance(false) - price;
    let plain = most_likely(search, processes, false);
    let least = plain
        .as_ref()
        .map_or(f64::INFINITY, |(_, peak, _)| peak.deviance);
    let smoothed = may_be_smoothed
        .then(|| most_likely(search, processes, true))
        .flatten();
    let smoothed = smoothed.filter(|(_, peak, _)| peak.deviance < least - price);
    let (search, peak, fit) = smoothed.or(plain).ok_or(WeatherError::NoProcess)?;
    let of = |every: usize| {
        let [times, temperatures] =
            samples.map(|all| all.iter().copied().step_by(every).collect::<Vec<f64>>());
        // Samples farther apart than the correlation time do not determine it.
        let is_dense = every as f64 * fit.duration * fit.processes()[0].relaxation_rate < n as f64;
        if times.len() < LEAST || check_harmonics(&times, periods).is_err() || !is_dense {
            return None;
        }
        let thinned = search.of([&times, &temperatures]);
        Some((every, thinned.weather(&thinned.near(&peak)?)?))
    };
    Ok(WeatherFit {
        thinned: THINNED.into_iter().filter_map(of).collect(),
        ..fit
    })
}

/// One process or two, as far as the samples determine them.
fn most_likely<'a>(
    search: impl Fn(usize, bool) -> ProcessSearch<'a>,
    processes: usize,
    smooths: bool,
) -> Option<(ProcessSearch<'a>, Peak, WeatherFit)> {
    let one = search(1, smooths);
    let best_of_one = one.best();
    if processes > 1 {
        let two = search(2, smooths);
        if let Some(found) = two.best() {
            let is_used = best_of_one
                .as_ref()
                .is_none_or(|one| one.deviance - found.deviance > SECOND);
            if is_used && let Some(fit) = two.weather(&found) {
                return Some((two, found, fit));
            }
        }
    }
    let found = best_of_one?;
    let fit = one.weather(&found)?;
    Some((
        one,
        found,
        WeatherFit {
            is_one_of_two: processes > 1,
            ..fit
        },
    ))
}

#[cfg(test)]
mod tests {
    use super::super::result::Weather;
    use super::*;
    use crate::calibration::Air;
    use std::f64::consts::TAU;
    use stickslip::model::{Harmonic, InitialNoise, OrnsteinUhlenbeck, Temperature};
    use stickslip::noise::Stream;

    const DAY: f64 = 86_400.0;
    const PERIODS: [f64; 2] = [365.25 * DAY, DAY];

    fn noise(sd: f64, memory: f64) -> OrnsteinUhlenbeck {
        let rate = 1.0 / memory;
        OrnsteinUhlenbeck {
            intensity: sd,
            relaxation_rate: rate,
            diffusion: (2.0 * rate).sqrt(),
            initial: InitialNoise::Stationary,
        }
    }

    /// A mean of 12 degrees, a yearly harmonic of amplitude 8 and a daily one of 4, and weather of
    /// 3.5 K with 3 days and of 0.7 K with 2 hours.
    pub(super) fn truth() -> Temperature {
        let harmonic = |amplitude: f64, period: f64, phase: f64| Harmonic {
            amplitude,
            angular_frequency: if period > 0.0 { TAU / period } else { 0.0 },
            phase,
        };
        Temperature {
            harmonics: vec![
                harmonic(12.0, 0.0, 0.0),
                harmonic(8.0, PERIODS[0], 0.4),
                harmonic(4.0, PERIODS[1], -2.0),
            ],
            noises: vec![noise(0.7, 7200.0), noise(3.5, 3.0 * DAY)],
            ..Temperature::default()
        }
    }

    /// 40 records of 300 days, with a sample every hour. Null: each parameter's error divided by
    /// its standard error is standard normal. The mean square over 40 records then has an sd of
    /// 0.22. By chance it exceeds 1.9 once in 20 000 times and is below 0.35 once in 10 000. A
    /// factor of 2 in a standard error makes it 4 or 0.25. There are seven such numbers.
    #[test]
    #[ignore = "half a minute; mean squares 1.41, 1.16, 0.82, 1.19, 1.27, 1.26 and 1.19"]
    fn parameters_are_off_by_as_much_as_their_errors_say() {
        let truth = truth();
        let expected = [12.0, 8.0, 4.0, 0.7, 3.5, 1.0 / 7200.0, 1.0 / (3.0 * DAY)];
        let mut squares = [0.0; 7];
        let records = 40;
        for seed in 0..records {
            let [times, temperatures] = Air::drawn(&truth, 7200, 3600.0, seed).samples();
            let fit = fit(&times, &temperatures, &PERIODS, 2, 0.0).expect("a fit");
            let (mean, cycles, processes) = (fit.mean(), fit.cycles(), fit.processes());
            let [fast, slow] = [processes[0], processes[1]];
            let relative =
                |value: f64, expected: f64, error: f64| libm::log(value / expected) / error;
            let z = [
                (mean.0 - expected[0]) / mean.1,
                (cycles[0].amplitude - expected[1]) / cycles[0].error,
                (cycles[1].amplitude - expected[2]) / cycles[1].error,
                relative(fast.sd, expected[3], fast.sd_error),
                relative(slow.sd, expected[4], slow.sd_error),
                relative(fast.relaxation_rate, expected[5], fast.rate_error),
                relative(slow.relaxation_rate, expected[6], slow.rate_error),
            ];
            squares
                .iter_mut()
                .zip(z)
                .for_each(|(sum, z)| *sum += z * z / records as f64);
            assert!(
                fit.white < 0.25,
                "{} K of white noise where there is none",
                fit.white
            );
            assert_eq!(fit.warnings(), [""; 0], "{seed}: {processes:?}");
        }
        println!("mean squares of mean, year, day, sd, sd, theta, theta: {squares:.2?}");
        assert!(
            squares.iter().all(|mean| (0.35..1.9).contains(mean)),
            "{squares:?}"
        );
    }

    /// A thermometer that shows multiples of half a degree adds 0.144 K to every sample. Without a
    /// white part, the fast process would have to explain it, with a correlation time of minutes.
    /// There are four records of 140 days without a yearly harmonic; |z| exceeds 4 by chance once
    /// in 16 000 times.
    #[test]
    fn a_coarse_thermometer_differs_from_weather() {
        let mut truth = truth();
        truth.harmonics.remove(1);
        for seed in 100..104 {
            let [times, temperatures] = Air::drawn(&truth, 20_000, 600.0, seed).samples();
            let shown: Vec<f64> = temperatures
                .iter()
                .map(|t| 2.0 * t)
                .map(|t| t.round() / 2.0)
                .collect();
            let fit = fit(&times, &shown, &[DAY], 2, 0.0).expect("a fit");
            let fast = fit.processes()[0];
            println!("white {:.3}, fast {fast:?}", fit.white);
            assert!(
                (fit.white / (0.5 / 12f64.sqrt()) - 1.0).abs() < 0.1,
                "{}",
                fit.white
            );
            let z = [
                libm::log(fast.relaxation_rate * 7200.0) / fast.rate_error,
                libm::log(fast.sd / 0.7) / fast.sd_error,
            ];
            assert!(z.iter().all(|z| z.abs() < 4.0), "{z:?} {fast:?}");
        }
    }

    /// A thermometer with a noise of 0.1 K, in 40 records of 300 days. Null: intervals of 90 % hold
    /// the rate of the fast process, and its estimates are right on average. Fewer than 30 of 40
    /// hold once in 700 times; the mean of the logarithms is off by more than four of its standard
    /// errors once in 16 000 times. Without the noise in the model, the rate would be a tenth too
    /// high.
    #[test]
    #[ignore = "half a minute; 33 of 40 hold, off by -0.095 +- 0.038"]
    fn the_noise_of_a_thermometer_is_carried_with_its_error() {
        let (mut held, mut sum, mut square, records) = (0, 0.0, 0.0, 40);
        for seed in 200..200 + records {
            let [times, mut temperatures] = Air::drawn(&truth(), 7200, 3600.0, seed).samples();
            let mut random = Stream::new(seed, 5);
            temperatures
                .iter_mut()
                .for_each(|t| *t += 0.1 * random.normal());
            let fast = fit(&times, &temperatures, &PERIODS, 2, 0.0)
                .expect("a fit")
                .processes()[0];
            let off = libm::log(fast.relaxation_rate * 7200.0);
            held += u32::from(off.abs() < 1.645 * fast.rate_error);
            sum += off;
            square += off * off;
        }
        let n = records as f64;
        let (mean, error) = (sum / n, (square / n).sqrt() / n.sqrt());
        println!("{held} of {records} hold, off by {mean:.3} +- {error:.3}");
        assert!(
            held >= 30 && mean.abs() < 4.0 * error,
            "{held}, {mean} +- {error}"
        );
    }

    /// A month does not determine a memory of weeks, such as that of the season, which is part of these
    /// thirty records of a month. No process gets a standard deviation of more than three times
    /// what the weather has, nor a memory of more than a tenth of the record, and what was held or
    /// left out is said.
    #[test]
    fn a_month_gives_weather_that_can_be() {
        let mut said = 0;
        for seed in 300..330 {
            let [times, temperatures] = Air::drawn(&truth(), 720, 3600.0, seed).samples();
            let fit = fit(&times, &temperatures, &[DAY], 2, 0.0).expect("a fit");
            for process in fit.processes() {
                assert!(
                    process.sd < 12.0 && process.relaxation_rate * fit.duration > 9.99,
                    "{seed}: {process:?}"
                );
                assert!(process.sd_error < 0.7, "{seed}: {process:?}");
            }
            assert_eq!(
                fit.held_memory.is_some() || fit.is_one_of_two,
                !fit.warnings().is_empty()
            );
            said += u32::from(!fit.warnings().is_empty());
        }
        println!("{said} of 30 say what was held or left out");
        assert!(said > 0);
    }

    /// 4000 draws of the mean and of the logarithm of a rate scatter as their standard errors say.
    /// Four standard errors of a standard deviation are 4.5 %.
    #[test]
    fn draws_have_the_errors_of_the_fit() {
        let [times, temperatures] = Air::drawn(&truth(), 7200, 3600.0, 7).samples();
        let fit = fit(&times, &temperatures, &PERIODS, 2, 0.0).expect("a fit");
        let mut random = Stream::new(1, 1);
        let draws: Vec<Weather> = (0..4000).map(|_| fit.drawn(&mut random)).collect();
        let spread = |of: &dyn Fn(&Weather) -> f64| {
            let values: Vec<f64> = draws.iter().map(of).collect();
            let mean = values.iter().sum::<f64>() / 4000.0;
            (
                mean,
                (values
                    .iter()
                    .map(|value| (value - mean).powi(2))
                    .sum::<f64>()
                    / 4000.0)
                    .sqrt(),
            )
        };
        let mean = spread(&|t| t.harmonics[0].amplitude);
        let fitted = fit.mean();
        assert!(
            (mean.1 / fitted.1 - 1.0).abs() < 0.045 && (mean.0 - fitted.0).abs() < 0.07 * fitted.1
        );
        let rate = spread(&|t| libm::log(t.processes[1].0));
        let slow = fit.processes()[1];
        assert!(
            (rate.1 / slow.rate_error - 1.0).abs() < 0.045,
            "{rate:?} {slow:?}"
        );
    }
}
