//! Forecasts of future years from measurements of 300 days, for a bearing whose true future is
//! known.

use crate::bridge::{BRIDGE, DAY, RED_CAMPAIGN, SOUND, WEATHER, question, record, twin_of};
use crate::loggers::{Logger, PLAIN, kept, kept_of};
use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;
use stickslip::noise::{Stream, Transition};
use stickslip_bearing::calibration::{Calibration, CalibrationMethod, MeasuredRecord, calibrate};
use stickslip_bearing::forecast::{Forecast, ForecastQuantity, ForecastQuestion, forecast};
use stickslip_bearing::weather::fit;

const PERIODS: [f64; 2] = [365.25 * DAY, DAY];
const ASKED: ForecastQuestion = ForecastQuestion {
    draws: 20,
    years: 10,
    seed: 3,
    level: 0.9,
    share: 0.9,
};

/// What a year of the true bearing comes to on average, and the standard error of it.
struct TrueYear {
    slips: (f64, f64),
    /// The largest force, in newtons.
    force: (f64, f64),
}

/// Mean and standard error of these values.
fn averaged(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values
        .iter()
        .map(|value| (value - mean).powi(2))
        .sum::<f64>()
        / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// The true bearing under the true weather, with friction multiplied by this share of the time, by a loop
/// that shares no code with the forecast. It is the recursion, sampled each half minute, with A reduced by
/// 0.5826 s sqrt(step), which corrects for crossings between samples (Broadie, Glasserman and Kou,
/// Mathematical Finance 7, 1997). Steel that lags is smooth between samples.
fn true_year(
    processes: [[f64; 2]; 2],
    lag: f64,
    share: impl Fn(f64) -> f64,
    years: usize,
) -> TrueYear {
    let step = 30.0;
    let process =
        |sd: f64, memory: f64| Transition::new(1.0 / memory, sd * (2.0 / memory).sqrt(), step);
    let [fast, slow] = processes.map(|[sd, days]| process(sd, days * DAY));
    let overlooked = if lag > 0.0 {
        0.0
    } else {
        0.5826 * fast.increment_sd.hypot(slow.increment_sd)
    };
    let motion = BRIDGE.response().motion;
    let mut random = Stream::new(77, 0);
    let [mut a, mut b] = processes.map(|[sd, _]| sd * random.normal());
    let mut xi = 12.4 + 9.0;
    let mut steel = xi;
    let (mut counts, mut forces) = (Vec::new(), Vec::new());
    let per_year = (365.25 * DAY / step) as usize;
    for year in 0..=years {
        let [mut slips, mut force] = [0.0, 0.0_f64];
        for i in 0..per_year {
            let day = (year * per_year + i) as f64 * step / DAY;
            (a, b) = (fast.next(a, random.normal()), slow.next(b, random.normal()));
            let t =
                12.4 + 9.0 * (TAU * day / 365.25).cos() + 4.1 * (TAU * day + 2.36).cos() + a + b;
            steel += (t - steel) / (lag / step + 0.5).max(1.0);
            let share = share(day * DAY);
            let reach = share * motion.reach - overlooked;
            let away = (steel - xi).abs();
            force = force.max((away + overlooked).min(share * motion.reach));
            if away > reach {
                let jump = share * motion.jump;
                let count = ((away - reach) / jump).ceil();
                xi += count * jump.copysign(steel - xi);
                slips += count;
            }
        }
        counts.push(slips);
        forces.push(BRIDGE.stiffness * BRIDGE.dilatation * force);
    }
    // The first year depends on the initial state, so it is left out.
    TrueYear {
        slips: averaged(&counts[1..]),
        force: averaged(&forces[1..]),
    }
}

/// Slips in a year with constant friction.
fn true_slips(processes: [[f64; 2]; 2], lag: f64, years: usize) -> (f64, f64) {
    true_year(processes, lag, |_| 1.0, years).slips
}

/// The forecast from a record, if there is one.
fn forecast_from(record: &MeasuredRecord, processes: usize, seed: u64) -> Option<Forecast> {
    let stop = AtomicBool::new(false);
    let found = calibrate(record, &question(CalibrationMethod::Slips), 1, &stop).ok()?;
    forecast_by(&found, processes, seed)
}

/// The forecast from a calibration, if there is one.
fn forecast_by(found: &Calibration, processes: usize, seed: u64) -> Option<Forecast> {
    let stop = AtomicBool::new(false);
    let [times, temperatures] = found.record.thermometer();
    let weather = fit(
        &times,
        &temperatures,
        &PERIODS,
        processes,
        found.record.averaged[0],
    )
    .ok()?;
    forecast(
        found,
        &weather,
        &ForecastQuestion { seed, ..ASKED },
        2,
        &stop,
    )
    .ok()?
}

fn forecast_of(seed: u64, processes: usize) -> Forecast {
    forecast_from(
        &record(&twin_of(&BRIDGE, &RED_CAMPAIGN, seed).0),
        processes,
        3,
    )
    .expect("a forecast")
}

/// Every draw of the parameters sees weather of its own, as the interval for a single year assumes.
/// Null hypothesis: what year k of one draw has in common with year k of another draw is chance, so
/// that the variance of the means over draws is that of the residuals (an analysis of variance).
/// Sample size: 10 years of 20 draws. False-alarm rate: the ratio of the two variances, an F with 9
/// and 171 degrees of freedom, exceeds 4.5 with a probability of 3e-5. If all draws saw the same
/// weather, it would be above 50.
#[test]
fn no_two_draws_see_the_same_weather() {
    let forecast = forecast_by(&SOUND[0].0, 2, 3).expect("a forecast");
    let (draws, years) = (20.0, 10.0);
    let slips =
        |draw: usize, year: usize| forecast.years[draw][year][ForecastQuantity::Slips as usize];
    let of_draw = |draw: usize| (0..10).map(|year| slips(draw, year)).sum::<f64>() / years;
    let of_year = |year: usize| (0..20).map(|draw| slips(draw, year)).sum::<f64>() / draws;
    let all = (0..10).map(of_year).sum::<f64>() / years;
    let between = draws
        * (0..10)
            .map(|year| (of_year(year) - all).powi(2))
            .sum::<f64>()
        / (years - 1.0);
    let left = |draw: usize, year: usize| {
        (slips(draw, year) - of_draw(draw) - of_year(year) + all).powi(2)
    };
    let within = (0..20)
        .flat_map(|draw| (0..10).map(move |year| left(draw, year)))
        .sum::<f64>();
    let ratio = between / (within / ((draws - 1.0) * (years - 1.0)));
    println!("{ratio:.2}");
    assert!(ratio < 4.5, "{ratio}");
}

/// Null hypothesis: the forecast number of slips in a year is right, and its intervals of 90 % hold
/// the truth. Sample size: 12 measurements (seeds 300 to 311). A forecast scatters by 7 % from one
/// measurement to another, so the mean of twelve by 2 %; over 40 others (`table`) it is
/// 1.1 +- 1.2 % above the truth. False-alarm rates: the mean is off by more than 8 % once in 100
/// times, and fewer than 8 of 12 intervals hold once in 300 times. With one process in the weather
/// instead of two, the forecast has a third more slips than the truth, for each of four
/// measurements, because it takes the slow weather for faster than it is.
#[test]
#[ignore = "a minute and a half; truth 198.7 +- 2.2, two processes 199.5, 11 of 12 held, one process 260.4"]
fn slip_forecasts_need_two_processes_to_cover_the_truth() {
    let (truth, error) = true_slips(WEATHER, 0.0, 60);
    let [mut sum, mut held, mut of_one] = [0.0; 3];
    for seed in 300..312 {
        let two = *forecast_of(seed, 2)
            .level(ForecastQuantity::Slips)
            .expect("slips");
        sum += two.expected / 12.0;
        let [low, high] = two.expected_interval;
        held += f64::from(u8::from((low..=high).contains(&truth)));
        if seed < 304 {
            of_one += forecast_of(seed, 1)
                .level(ForecastQuantity::Slips)
                .expect("slips")
                .expected
                / 4.0;
        }
        println!("{seed}: {:.0} [{low:.0}, {high:.0}]", two.expected);
    }
    println!(
        "truth {truth:.1} +- {error:.1}; two processes {sum:.1}, held {held} of 12; one process {of_one:.1}"
    );
    assert!((sum / truth - 1.0).abs() < 0.08, "{sum} for {truth}");
    assert!(held >= 8.0, "{held} of 12");
    assert!(of_one > 1.15 * truth, "one process {of_one}");
}

/// Forecasts from 20 records of each kind: what slips and path are off by on average, how many
/// intervals of 90 % hold the truth, and how wide they are.
#[test]
#[ignore = "minutes; prints a table"]
fn table() {
    let lagging = Logger {
        lag: 120.0,
        ..PLAIN
    };
    for (name, logger) in [
        ("every 10 minutes", PLAIN),
        (
            "displacement twice as often",
            Logger {
                every: [20, 10],
                ..PLAIN
            },
        ),
        (
            "every hour",
            Logger {
                every: [60; 2],
                ..PLAIN
            },
        ),
        (
            "every hour, weather of 2 h",
            Logger {
                every: [60; 2],
                memory: 2.0,
                ..PLAIN
            },
        ),
        ("steel 30 minutes behind", Logger { lag: 30.0, ..PLAIN }),
        ("steel 2 hours behind", lagging),
        (
            "the same, thermometer on the steel",
            Logger {
                is_on_steel: true,
                ..lagging
            },
        ),
    ] {
        let (slips, error) = true_slips(logger.processes(), 60.0 * logger.lag, 200);
        let motion = BRIDGE.response().motion;
        let truth = [slips, slips * BRIDGE.dilatation * motion.jump];
        let [mut off, mut held, mut width] = [[0.0; 2]; 3];
        let mut squares = 0.0;
        let mut refused = 0;
        let mut count = 0.0;
        for seed in 5000..5020 {
            let Some(forecast) = forecast_from(&kept(&logger, seed).0, 2, seed) else {
                refused += 1;
                continue;
            };
            count += 1.0;
            for (i, quantity) in [ForecastQuantity::Slips, ForecastQuantity::SlidingPath]
                .into_iter()
                .enumerate()
            {
                let level = forecast.level(quantity).expect("slips");
                let [low, high] = level.expected_interval;
                off[i] += level.expected / truth[i] - 1.0;
                held[i] += f64::from(u8::from((low..=high).contains(&truth[i])));
                width[i] += (high - low) / truth[i] / 2.0;
            }
            let level = forecast.level(ForecastQuantity::Slips).expect("slips");
            squares += (level.expected / truth[0] - 1.0).powi(2);
        }
        let [slips_off, path_off] = off.map(|off| 100.0 * off / count);
        let scatter = 100.0 * (squares / count - (off[0] / count).powi(2)).sqrt() / count.sqrt();
        println!(
            "| {name} | {slips:.1} +- {error:.1} | {slips_off:+.1} +- {scatter:.1} % | {} of {count} | {path_off:+.1} % | {} of {count} | +- {:.0} % | {refused} |",
            held[0],
            held[1],
            100.0 * width[0] / count
        );
    }
}

/// Forecasts from records whose friction is constant, varies with the season, and falls: what the largest
/// force and the slips of a year are off by, and how many intervals of 90 % hold the truth. After friction
/// has fallen, it stays.
#[test]
#[ignore = "minutes; prints a table"]
fn friction_that_changes() {
    let seeds: u64 = std::env::var("SEEDS").map_or(20, |seeds| seeds.parse().expect("a number"));
    let only = std::env::var("ONLY").unwrap_or_default();
    type Share = fn(f64) -> f64;
    let kinds: [(&str, Share, Share); 4] = [
        ("constant", |_| 1.0, |_| 1.0),
        (
            "varies by 10 % over the year",
            |time| season(0.1, time),
            |time| season(0.1, time),
        ),
        (
            "varies by 20 % over the year",
            |time| season(0.2, time),
            |time| season(0.2, time),
        ),
        (
            "falls by 20 %",
            |time| 1.0 - 0.2 * time / (300.0 * DAY),
            |_| 0.8,
        ),
    ];
    for (place, (name, share, later)) in kinds.into_iter().enumerate() {
        if !name.contains(&only) {
            continue;
        }
        let truth = true_year(WEATHER, 0.0, later, 60);
        let truths = [truth.force, truth.slips];
        let mut row = format!("| {name} |");
        let [mut off, mut held, mut width] = [[0.0; 2]; 3];
        let mut count = 0.0;
        for seed in (0..seeds).map(|seed| 7000 + 100 * place as u64 + seed) {
            let (record, _) = kept_of(&PLAIN, &BRIDGE, share, seed);
            let Some(forecast) = forecast_from(&record, 2, seed) else {
                println!("{name} {seed}: refused");
                continue;
            };
            count += 1.0;
            let both = [ForecastQuantity::Force, ForecastQuantity::Slips];
            for (i, (quantity, (truth, _))) in both.into_iter().zip(truths).enumerate() {
                let level = forecast.level(quantity).expect("a level");
                let [low, high] = level.expected_interval;
                println!(
                    "{name} {seed} {}: {:.4e} [{low:.4e}, {high:.4e}] for {truth:.4e}",
                    quantity.name(),
                    level.expected
                );
                off[i] += level.expected / truth - 1.0;
                held[i] += f64::from(u8::from((low..=high).contains(&truth)));
                width[i] += 0.5 * (high - low) / truth;
            }
        }
        for (i, (truth, error)) in truths.iter().enumerate() {
            let [off, width] = [off[i], width[i]].map(|sum| 100.0 * sum / count);
            row += &format!(
                " {truth:.4e}±{error:.1e} | {off:+.1} | {} of {count} | {width:.0} |",
                held[i]
            );
        }
        println!("{row}");
    }
}

/// Friction that is largest at the start of the year.
fn season(amplitude: f64, time: f64) -> f64 {
    1.0 + amplitude * (TAU * time / (365.25 * DAY)).cos()
}
