//! Limits of a calibration: what cannot be known, and what is refused.

use crate::bridge::{
    BRIDGE, Bearing, Campaign, RED_CAMPAIGN, SOUND, ask, question, record, twin_of, warns,
};
use stickslip::noise::Stream;
use stickslip_bearing::Unsound;
use stickslip_bearing::calibration::{
    Calibration, CalibrationError, CalibrationMethod, CalibrationQuestion, MeasuredRecord,
    Quantity, Values, calibrate,
};
use stickslip_bearing::forecast::{ForecastError, ForecastQuantity, ForecastQuestion, forecast};
use stickslip_bearing::weather;

/// Without K_BP the data determine beta, f_s/K and f_d/K, but no force. This holds for a rigid
/// bearing, and for a sheared one whose K_BP is not given.
#[test]
fn without_the_shear_stiffness_there_are_no_forces() {
    for shear_stiffness in [f64::INFINITY, 2.0e9] {
        let bearing = Bearing {
            shear_stiffness,
            ..BRIDGE
        };
        let (twin, truth) = twin_of(&bearing, &RED_CAMPAIGN, 42);
        let fit = ask(
            &record(&twin),
            &CalibrationQuestion {
                shear_stiffness: None,
                ..question(CalibrationMethod::Slips)
            },
        );
        assert!(warns(&fit, "no_shear_stiffness"));
        for quantity in Quantity::ALL {
            let estimate = fit.estimate(quantity);
            assert_eq!(
                estimate.estimate.is_nan(),
                quantity.needs_shear_stiffness(),
                "{quantity:?}"
            );
        }
        for quantity in [
            Quantity::Dilatation,
            Quantity::StaticWay,
            Quantity::DynamicWay,
        ] {
            let off = fit.estimate(quantity).estimate / truth[quantity as usize] - 1.0;
            assert!(off.abs() < 0.04, "{quantity:?}: {off}");
        }
    }
}

/// A bearing with f_s = f_d slides without slips, and noise larger than its motion makes some of
/// the motion look like slips. The fit warns about it and still determines f_d/K to 5 %. It does
/// not warn for bearings that slip.
#[test]
fn sliding_without_slips_is_said() {
    let said = |fit: &Calibration, truth: &Values| {
        let off = fit.estimate(Quantity::DynamicWay).estimate
            / truth[Quantity::DynamicWay as usize]
            - 1.0;
        assert!(off.abs() < 0.05, "{off}");
        warns(fit, "gap_not_identified")
    };
    let sliding = Bearing {
        f_d: BRIDGE.f_s,
        ..BRIDGE
    };
    let (twin, truth) = twin_of(&sliding, &RED_CAMPAIGN, 43);
    let fit = ask(&record(&twin), &question(CalibrationMethod::Slips));
    assert!(said(&fit, &truth));
    assert!(SOUND.iter().take(4).all(|(fit, truth)| !said(fit, truth)));
}

#[test]
fn no_record_is_refused() {
    let flat = |n: usize, z: fn(usize) -> f64, t: fn(usize) -> f64| MeasuredRecord {
        times: (0..n).map(|i| 600.0 * i as f64).collect(),
        temperatures: (0..n).map(t).collect(),
        readings: (0..n).map(z).collect(),
        ..MeasuredRecord::default()
    };
    let ask = |record: MeasuredRecord| {
        calibrate(
            &record,
            &question(CalibrationMethod::Both),
            1,
            &Default::default(),
        )
        .map(|_| ())
    };
    let wave = |i: usize| (0.1 * i as f64).sin();
    assert_eq!(
        ask(flat(20, wave, wave)).unwrap_err(),
        CalibrationError::TooShort(20)
    );
    assert_eq!(
        ask(flat(0, wave, wave)).unwrap_err(),
        CalibrationError::TooShort(0)
    );
    assert_eq!(
        ask(flat(2000, wave, |_| 20.0)).unwrap_err(),
        CalibrationError::from(Unsound::Constant("temperature"))
    );
    assert_eq!(
        ask(flat(2000, |_| 0.0, wave)).unwrap_err(),
        CalibrationError::from(Unsound::Constant("displacement"))
    );
    // If the body never slips, z follows T, and nothing else can be determined.
    let still = CalibrationQuestion {
        starts: 1,
        ..question(CalibrationMethod::Both)
    };
    let none = calibrate(&flat(2000, wave, wave), &still, 1, &Default::default())
        .map(|_| ())
        .unwrap_err();
    assert!(
        matches!(
            none,
            CalibrationError::NoBearing {
                quantity: Quantity::Shear,
                ..
            }
        ),
        "{none:?}"
    );
}

/// A bearing without friction follows the temperature by beta, which the refusal states. A gauge with
/// 0.3 mm of play hides how z follows T during sticks, and with it friction.
#[test]
fn a_free_bearing_and_a_gauge_with_play_are_refused() {
    let record = record(&twin_of(&BRIDGE, &RED_CAMPAIGN, 44).0);
    let refused = |readings: Vec<f64>| {
        let record = MeasuredRecord {
            readings,
            ..record.clone()
        };
        let asked = question(CalibrationMethod::Slips);
        let refused = calibrate(&record, &asked, 1, &Default::default()).map(|_| ());
        refused.expect_err("no friction")
    };
    let mut random = Stream::new(44, 1);
    let free = record
        .temperatures
        .iter()
        .map(|t| 3e-4 * t + 30e-6 * random.normal());
    let error = refused(free.collect());
    assert!(
        matches!(error, CalibrationError::MovesFreely(slope) if (slope / 3e-4 - 1.0).abs() < 0.01),
        "{error:?}"
    );
    let mut shown = record.readings[0];
    let played = |z: &f64| {
        shown = shown.clamp(z - 0.15e-3, z + 0.15e-3);
        shown
    };
    let error = refused(record.readings.iter().map(played).collect());
    println!("{error}");
    assert!(
        matches!(
            error,
            CalibrationError::NoFriction { .. } | CalibrationError::NotSlips { .. }
        ),
        "{error:?}"
    );
}

/// A joint that opens by 0.2 mm at four o'clock and closes at sixteen, hour after hour, under a
/// daily cycle of 3 to 7 K and a slower one.
fn joint(hours: usize, opens: f64) -> MeasuredRecord {
    let mut state: u64 = 12_345;
    let mut uniform = || {
        state = (1_103_515_245 * state + 12_345) % (1 << 31);
        state as f64 / f64::from(1_u32 << 31) - 0.5
    };
    let mut record = MeasuredRecord::default();
    let mut width = 0.0;
    for hour in 0..hours {
        let pi = std::f64::consts::PI;
        let at = hour as f64;
        let daily = (5.0 + 2.0 * (at / 70.0).sin()) * (pi * at / 12.0).sin();
        let temperature = 20.0 + daily + 4.0 * (pi * at / 120.0).sin() + 0.2 * uniform();
        match hour % 24 {
            4 => width -= opens * (1.0 + 0.05 * uniform()),
            16 => width += opens * (1.0 + 0.05 * uniform()),
            _ => (),
        }
        record.times.push(3600.0 * at);
        record
            .temperatures
            .push((100.0 * temperature).round() / 100.0);
        record
            .readings
            .push(1e-3 * (0.01 * temperature + width + 0.002 * uniform()));
    }
    record
}

/// The jumps of a joint come as it warms and go down, where a bearing slips upwards. They would give
/// a negative A, so the fit is refused whatever is asked, at once.
#[test]
fn jumps_that_are_no_slips_are_refused() {
    for hours in [480, 4800] {
        for method in [
            CalibrationMethod::Slips,
            CalibrationMethod::Err,
            CalibrationMethod::Both,
        ] {
            let begin = std::time::Instant::now();
            let refused = calibrate(
                &joint(hours, 0.2),
                &question(method),
                1,
                &Default::default(),
            )
            .map(|_| ());
            let error = refused.expect_err("no bearing");
            assert!(
                matches!(error, CalibrationError::NotSlips { jumps: 38.., .. }),
                "{error:?}"
            );
            assert!(
                error.to_string().contains("a bearing has A > 0.05 K"),
                "{error}"
            );
            assert!(begin.elapsed().as_secs() < 5, "{:?}", begin.elapsed());
        }
    }
}

/// Records of eighteen days hold a dozen slips. Whatever is found from such a record is that of a
/// possible bearing, no end of an interval of a count or a length is below zero, and where too
/// little is known, that is said.
#[test]
fn a_dozen_slips_make_a_wide_forecast_or_none() {
    let asked = ForecastQuestion {
        draws: 10,
        years: 2,
        seed: 1,
        level: 0.9,
        share: 0.9,
    };
    let stop = Default::default();
    let (mut found, mut refused) = (0, 0);
    for seed in 0..12 {
        let record = record(
            &twin_of(
                &BRIDGE,
                &Campaign {
                    days: 25.0,
                    ..RED_CAMPAIGN
                },
                40 + seed,
            )
            .0,
        );
        let calibration = match calibrate(&record, &question(CalibrationMethod::Slips), 2, &stop) {
            Ok(calibration) => calibration,
            Err(
                CalibrationError::NotSlips { .. }
                | CalibrationError::Undetermined { .. }
                | CalibrationError::NoSlips,
            ) => {
                refused += 1;
                continue;
            }
            Err(error) => panic!("seed {seed}: {error}"),
        };
        assert_eq!(calibration.response.impossible(Some(2.0e9)), None);
        let weather = weather::fit(&record.times, &record.temperatures, &[86_400.0], 1, 0.0)
            .expect("weather");
        match forecast(&calibration, &weather, &asked, 2, &stop) {
            Ok(forecast) => {
                let forecast = forecast.expect("not stopped");
                for level in forecast.levels {
                    let ends = [level.expected_interval, level.year_interval].concat();
                    assert!(
                        ends.iter().all(|end| *end >= 0.0),
                        "seed {seed}, {:?}: {ends:?}",
                        level.quantity
                    );
                    assert!(
                        level.quantity != ForecastQuantity::Loaded
                            || ends.iter().all(|end| *end <= 1.0)
                    );
                }
                found += 1;
            }
            Err(ForecastError::Unknown | ForecastError::NotTheRecord { .. }) => refused += 1,
            Err(error) => panic!("seed {seed}: {error}"),
        }
    }
    println!("{found} forecasts, {refused} refused");
    assert!(found >= 4, "{found} forecasts, {refused} refused");
}
