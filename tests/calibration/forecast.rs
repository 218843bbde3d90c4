//! Forecasts of future years from measurements of 300 days, for a bearing whose true future is
//! known.

use crate::bridge::{BRIDGE, Campaign, DAY, RED_CAMPAIGN, WEATHER, question, record, twin_of, twin_under};
use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;
use stick_slip::bearing::calibration::{CalibrationMethod, MeasuredRecord, Motion, calibrate};
use stick_slip::bearing::forecast::{Forecast, ForecastQuantity, ForecastQuestion, forecast};
use stick_slip::bearing::weather::fit;
use stick_slip::noise::{Stream, Transition};

const PERIODS: [f64; 2] = [365.25 * DAY, DAY];
const ASKED: ForecastQuestion = ForecastQuestion { draws: 20, years: 10, seed: 3, level: 0.9, share: 0.9 };

/// Slips in a year of the true bearing under the true weather, by a loop that shares no code with
/// the forecast. It is the recursion, sampled each half minute, with A reduced by 0.5826 s
/// sqrt(step), which corrects for crossings between samples (Broadie, Glasserman and Kou,
/// Mathematical Finance 7, 1997). Returns mean and standard error over these years.
fn true_slips(processes: [[f64; 2]; 2], years: usize) -> (f64, f64) {
    let step = 30.0;
    let process = |sd: f64, memory: f64| Transition::new(1.0 / memory, sd * (2.0 / memory).sqrt(), step);
    let [fast, slow] = processes.map(|[sd, days]| process(sd, days * DAY));
    let overlooked = 0.5826 * fast.increment_sd.hypot(slow.increment_sd);
    let motion = BRIDGE.response().motion;
    let sampled = Motion { reach: motion.reach - overlooked, ..motion };
    let mut random = Stream::new(77, 0);
    let [mut a, mut b] = processes.map(|[sd, _]| sd * random.normal());
    let mut xi = 12.4 + 9.0;
    let mut counts = Vec::new();
    let per_year = (365.25 * DAY / step) as usize;
    for year in 0..=years {
        let mut slips = 0.0;
        for i in 0..per_year {
            let day = (year * per_year + i) as f64 * step / DAY;
            (a, b) = (fast.next(a, random.normal()), slow.next(b, random.normal()));
            let t = 12.4 + 9.0 * (TAU * day / 365.25).cos() + 4.1 * (TAU * day + 2.36).cos() + a + b;
            let next = sampled.next(xi, t);
            slips += ((next - xi) / motion.jump).abs().round();
            xi = next;
        }
        counts.push(slips);
    }
    // The first year depends on the initial state, so it is left out.
    let counts = &counts[1..];
    let mean = counts.iter().sum::<f64>() / counts.len() as f64;
    let variance = counts.iter().map(|n| (n - mean).powi(2)).sum::<f64>() / (counts.len() as f64 - 1.0);
    (mean, (variance / counts.len() as f64).sqrt())
}

/// The forecast from a record.
fn forecast_from(record: &MeasuredRecord, processes: usize, seed: u64) -> Forecast {
    let stop = AtomicBool::new(false);
    let found = calibrate(record, &question(CalibrationMethod::Slips), 1, &stop).expect("slips");
    let [times, temperatures] = found.record.thermometer();
    let weather = fit(&times, &temperatures, &PERIODS, processes, record.averaged[0]).expect("weather");
    forecast(&found, &weather, &ForecastQuestion { seed, ..ASKED }, 2, &stop).expect("sound").expect("not stopped")
}

fn forecast_of(seed: u64, processes: usize) -> Forecast {
    forecast_from(&record(&twin_of(&BRIDGE, &RED_CAMPAIGN, seed).0), processes, 3)
}

/// Every draw of the parameters sees weather of its own, as the interval for a single year assumes.
/// Null hypothesis: what year k of one draw has in common with year k of another draw is chance, so
/// that the variance of the means over draws is that of the residuals (an analysis of variance).
/// Sample size: 10 years of 20 draws. False-alarm rate: the ratio of the two variances, an F with 9
/// and 171 degrees of freedom, exceeds 4.5 with a probability of 3e-5. If all draws saw the same
/// weather, it would be above 50.
#[test]
fn no_two_draws_see_the_same_weather() {
    let forecast = forecast_of(300, 2);
    let (draws, years) = (20.0, 10.0);
    let slips = |draw: usize, year: usize| forecast.years[draw][year][ForecastQuantity::Slips as usize];
    let of_draw = |draw: usize| (0..10).map(|year| slips(draw, year)).sum::<f64>() / years;
    let of_year = |year: usize| (0..20).map(|draw| slips(draw, year)).sum::<f64>() / draws;
    let all = (0..10).map(of_year).sum::<f64>() / years;
    let between = draws * (0..10).map(|year| (of_year(year) - all).powi(2)).sum::<f64>() / (years - 1.0);
    let left = |draw: usize, year: usize| (slips(draw, year) - of_draw(draw) - of_year(year) + all).powi(2);
    let within = (0..20).flat_map(|draw| (0..10).map(move |year| left(draw, year))).sum::<f64>();
    let ratio = between / (within / ((draws - 1.0) * (years - 1.0)));
    println!("{ratio:.2}");
    assert!(ratio < 4.5, "{ratio}");
}

/// Null hypothesis: the forecast number of slips in a year is right, and its intervals of 90 % hold
/// the truth. Sample size: 12 measurements (seeds 300 to 311). A forecast scatters by 7 % from one
/// measurement to another, so the mean of twelve by 2 %; over 40 others (`table`) it is 1.1 +- 1.2 %
/// above the truth. False-alarm rates: the mean is off by more than 8 % once in 100 times, and fewer
/// than 8 of 12 intervals hold once in 300 times. With one process in the weather instead of two,
/// the forecast has a third more slips than the truth, for each of four measurements, because it
/// takes the slow weather for faster than it is.
#[test]
fn forecasts_of_slips_hold_the_truth_with_two_processes_and_not_with_one() {
    let (truth, error) = true_slips(WEATHER, 60);
    let [mut sum, mut held, mut of_one] = [0.0; 3];
    for seed in 300..312 {
        let two = *forecast_of(seed, 2).level(ForecastQuantity::Slips).expect("slips");
        sum += two.expected / 12.0;
        let [low, high] = two.expected_interval;
        held += f64::from(u8::from((low..=high).contains(&truth)));
        if seed < 304 {
            of_one += forecast_of(seed, 1).level(ForecastQuantity::Slips).expect("slips").expected / 4.0;
        }
        println!("{seed}: {:.0} [{low:.0}, {high:.0}]", two.expected);
    }
    println!("truth {truth:.1} +- {error:.1}; two processes {sum:.1}, held {held} of 12; one process {of_one:.1}");
    assert!((sum / truth - 1.0).abs() < 0.08, "{sum} for {truth}");
    assert!(held >= 8.0, "{held} of 12");
    assert!(of_one > 1.15 * truth, "one process {of_one}");
}

/// The thermometer shows every second sample of a record, and the sensor all of them.
fn mixed(record: &MeasuredRecord) -> MeasuredRecord {
    let second = |values: &[f64]| values.iter().step_by(2).copied().collect::<Vec<f64>>();
    let [times, temperatures] = [&record.times, &record.temperatures].map(|values| second(values));
    MeasuredRecord::of([&times, &temperatures], [&record.times, &record.readings])
}

/// Forecasts of 12 synthetic measurements of each kind: what they are off by on average, and how
/// many intervals of 90 % hold the truth.
#[test]
#[ignore = "minutes; prints a table"]
fn table() {
    let alone = [[2.2, 0.6], [0.0, 3.0]];
    let twice = Campaign { interval: 300.0, ..RED_CAMPAIGN };
    let kinds = [
        ("two processes", RED_CAMPAIGN, WEATHER, false),
        ("two processes, displacement twice as often", twice, WEATHER, true),
        ("one process", RED_CAMPAIGN, alone, false),
    ];
    for (name, campaign, processes, is_mixed) in kinds {
        let (truth, error) = true_slips(processes, 200);
        let [mut sum, mut square, mut held, mut year] = [0.0; 4];
        for seed in 5000..5012 {
            let whole = record(&twin_under(&BRIDGE, &campaign, processes, seed).0);
            let record = if is_mixed { mixed(&whole) } else { whole };
            let level = *forecast_from(&record, 2, seed).level(ForecastQuantity::Slips).expect("slips");
            let off = level.expected / truth - 1.0;
            sum += off;
            square += off * off;
            let [low, high] = level.expected_interval;
            held += f64::from(u8::from((low..=high).contains(&truth)));
            year += (high - low) / truth / 24.0;
        }
        let error_of_mean = (square / 12.0 - (sum / 12.0).powi(2)).sqrt() / 12f64.sqrt();
        println!(
            "| {name} | {truth:.1} +- {error:.1} | {:+.1} +- {:.1} % | {held} of 12 | +- {:.0} % |",
            100.0 * sum / 12.0,
            100.0 * error_of_mean,
            100.0 * year
        );
    }
}
