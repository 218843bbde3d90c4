//! Causes that the estimates do not assume are named: friction that changes, a temperature of another
//! place, two bearings, a sensor at the end of its range or with a coarse resolution. None is named
//! where it is not.

use crate::bridge::{
    BRIDGE, Bearing, Campaign, DAY, RED_CAMPAIGN, SOUND, WEATHER, ask, question, twin_of, warns,
    weather,
};
use std::f64::consts::TAU;
use stickslip::noise::{Stream, Transition};
use stickslip_bearing::calibration::{
    Calibration, CalibrationError, CalibrationMethod, Imperfections, MeasuredRecord, Quantity,
    calibrate,
};

/// A record of a sample every ten minutes with 30 um of white noise. The bearing is followed minute by
/// minute; its friction is multiplied by this share of the time.
fn kept(bearing: &Bearing, share: impl Fn(f64) -> f64) -> MeasuredRecord {
    let campaign = Campaign {
        interval: 60.0,
        imperfections: Imperfections::NONE,
        ..RED_CAMPAIGN
    };
    let air = weather(31, &campaign, WEATHER);
    let response = bearing.response();
    let mut random = Stream::new(31, 55);
    let (mut record, mut xi) = (MeasuredRecord::default(), air.temperatures[0]);
    for (i, (time, temperature)) in air.times.iter().zip(&air.temperatures).enumerate() {
        let [reach, jump] =
            [response.motion.reach, response.motion.jump].map(|of| share(*time) * of);
        while (temperature - xi).abs() > reach {
            xi += jump.copysign(temperature - xi);
        }
        if i % 10 == 0 {
            record.times.push(*time);
            record.temperatures.push(*temperature);
            record
                .readings
                .push(response.sensor.reading(xi, *temperature) + 30e-6 * random.normal());
        }
    }
    record
}

fn fit(record: &MeasuredRecord) -> Calibration {
    ask(record, &question(CalibrationMethod::Slips))
}

const CAUSES: [&str; 4] = [
    "friction_changes",
    "temperature_elsewhere",
    "saturated",
    "lag_beyond",
];

/// The causes that are named.
fn named(fit: &Calibration) -> Vec<&'static str> {
    CAUSES.into_iter().filter(|name| warns(fit, name)).collect()
}

/// Sound records, one of them with red noise and one whose f_s scatters from slip to slip.
#[test]
fn no_cause_is_named_in_sound_records() {
    assert_eq!(named(&fit(&kept(&BRIDGE, |_| 1.0))), [""; 0]);
    assert_eq!(named(&SOUND[0].0), [""; 0]);
    let imperfections = Imperfections {
        scatter: 0.05,
        white: 30e-6,
        ..Imperfections::NONE
    };
    let campaign = Campaign {
        imperfections,
        ..RED_CAMPAIGN
    };
    let (twin, _) = twin_of(&BRIDGE, &campaign, 32);
    assert_eq!(named(&fit(&crate::bridge::record(&twin))), [""; 0]);
}

/// Friction that varies by 15 % over the year to either side, and such that falls by 30 %: A is within 4 % of
/// the mean over the year or the record, and the smallest and the largest A are within 4 % of A.
#[test]
fn friction_that_changes_has_a_range() {
    let over_the_year = |time: f64| 1.0 + 0.15 * (TAU * time / (365.25 * DAY)).sin();
    let falls = |time: f64| 1.0 - 0.3 * time / (300.0 * DAY);
    for (found, truth) in [
        (fit(&kept(&BRIDGE, over_the_year)), [0.85, 1.0, 1.15]),
        (fit(&kept(&BRIDGE, falls)), [0.7, 0.85, 1.0]),
    ] {
        assert_eq!(named(&found), ["friction_changes"]);
        let reach = found.estimate(Quantity::Reach).estimate / BRIDGE.response().motion.reach;
        let [low, high] = found.friction_range.expect("a range");
        let all = [reach * low.estimate, reach, reach * high.estimate];
        println!("{all:.3?} for {truth:?}");
        assert!(
            all.iter()
                .zip(truth)
                .all(|(found, truth)| (found - truth).abs() < 0.04),
            "{all:?} {truth:?}"
        );
    }
}

/// A thermometer at another place differs by 1 K for three hours.
#[test]
fn a_temperature_of_another_place_is_named() {
    let sound = kept(&BRIDGE, |_| 1.0);
    let mut random = Stream::new(33, 1);
    let passing = Transition::new(1.0 / 10_800.0, (2.0_f64 / 10_800.0).sqrt(), 600.0);
    let mut off = random.normal();
    let mut elsewhere = |t: &f64| {
        off = passing.next(off, random.normal());
        t + off
    };
    let temperatures = sound.temperatures.iter().map(&mut elsewhere).collect();
    assert_eq!(
        named(&fit(&MeasuredRecord {
            temperatures,
            ..sound
        })),
        ["temperature_elsewhere"]
    );
}

/// Two bearings as one, with slips of 0.15 and 0.41 mm in the mean of their displacements, or slips that
/// are hardly different: slips do not explain the way, or the model does not follow, or the record is
/// refused.
#[test]
fn two_bearings_as_one_are_not_taken_for_one() {
    let of = |f_s: f64, f_d: f64| kept(&Bearing { f_s, f_d, ..BRIDGE }, |_| 1.0);
    for (one, other) in [
        ((5e5, 4.5e5), (3e5, 2.4e5)),
        ((5e5, 4.5e5), (3e5, 2.7e5)),
        ((6e5, 4.5e5), (2e5, 1.7e5)),
    ] {
        let [one, other] = [one, other].map(|(f_s, f_d)| of(f_s, f_d));
        let readings = one
            .readings
            .iter()
            .zip(&other.readings)
            .map(|(a, b)| 0.5 * (a + b))
            .collect();
        let both = MeasuredRecord { readings, ..one };
        if let Ok(found) = calibrate(
            &both,
            &question(CalibrationMethod::Slips),
            2,
            &Default::default(),
        ) {
            let warned = ["poor_fit", "gap_not_identified"]
                .into_iter()
                .filter(|name| warns(&found, name));
            assert!(warned.count() > 0, "{:?}", found.warnings);
        }
    }
}

/// A sensor that shows nothing above what 95 % of its readings are below, and one that shows steps of
/// 0.2 and 0.5 mm where slips are of 0.43 mm. One with steps of 0.05 mm is fine enough.
#[test]
fn a_sensor_at_its_end_or_too_coarse_is_named() {
    let sound = kept(&BRIDGE, |_| 1.0);
    let shown = |show: &dyn Fn(f64) -> f64| {
        let readings = sound.readings.iter().map(|z| show(*z)).collect();
        MeasuredRecord {
            readings,
            ..sound.clone()
        }
    };
    let mut sorted = sound.readings.clone();
    sorted.sort_by(f64::total_cmp);
    let end = sorted[95 * sorted.len() / 100];
    assert!(named(&fit(&shown(&|z| z.min(end)))).contains(&"saturated"));
    let in_steps = |step: f64| shown(&|z: f64| (z / step).round() * step);
    assert_eq!(named(&fit(&in_steps(5e-5))), [""; 0]);
    for step in [2e-4, 5e-4] {
        let refused = calibrate(
            &in_steps(step),
            &question(CalibrationMethod::Slips),
            1,
            &Default::default(),
        );
        assert!(
            matches!(refused.map(|_| ()), Err(CalibrationError::Coarse { .. })),
            "{step}"
        );
    }
}

/// Steel that is six hours behind the air, as concrete is, under a bearing that slips often enough.
#[test]
fn a_lag_of_six_hours_is_found() {
    let bearing = Bearing {
        f_s: 2.3e5,
        f_d: 2.0e5,
        ..BRIDGE
    };
    let imperfections = Imperfections {
        lag: 21_600.0,
        white: 30e-6,
        ..Imperfections::NONE
    };
    let (twin, truth) = twin_of(
        &bearing,
        &Campaign {
            imperfections,
            ..RED_CAMPAIGN
        },
        34,
    );
    let found = fit(&crate::bridge::record(&twin));
    println!("{:?}", found.lag);
    assert!(
        (found.lag.estimate / 21_600.0 - 1.0).abs() < 0.04,
        "{:?}",
        found.lag
    );
    let off = found.estimate(Quantity::Static).estimate / truth[Quantity::Static as usize] - 1.0;
    assert!(off.abs() < 0.02, "{off}");
}
