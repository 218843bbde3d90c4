//! Measured inputs of force and load, against an independent program, a closed form, and the same
//! force written out.

use crate::common::Keep;
use std::f64::consts::PI;
use stickslip::config::Override;
use stickslip::model::{Event, EventKind, NamedSeries, Series};
use stickslip::scenario::Scenario;
use stickslip::scheme::Simulate as _;

/// m = K = 1 and nothing else that moves the body.
const BODY: &str =
    "oscillator = { mass = 1, stiffness = 1, force_per_temperature = 1 }\ninitial.displacement = 0
                    scheme.kind = \"event-driven\"\ntime.output_step = 1\n";

fn input(name: &str, times: Vec<f64>, values: Vec<f64>) -> NamedSeries {
    NamedSeries {
        name: format!("input.{name}"),
        series: Series::new(times, values).expect("a series").into(),
    }
}

#[track_caller]
fn scenario(lines: &str, inputs: &[NamedSeries], set: &[Override]) -> Scenario {
    Scenario::parse_measured("test", &format!("{BODY}{lines}"), set, inputs)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn events(scenario: &Scenario) -> Vec<Event> {
    let mut keep = Keep::lanes(1);
    let simulation = scenario
        .scheme
        .simulation(&scenario.model, &scenario.timeline());
    assert_eq!(simulation.simulate(1, &[0], &mut keep), Vec::<usize>::new());
    keep.events.remove(0)
}

/// The coarse samples of tests/reference/load.py, with kinks of up to 8 in the slope.
fn coarse() -> NamedSeries {
    let times = vec![
        0.0, 1.3, 2.1, 3.7, 4.4, 6.2, 7.7, 9.1, 11.4, 12.0, 14.3, 16.8, 18.5, 20.0,
    ];
    let values = vec![
        0.0, 2.6, -0.4, -2.9, 1.1, 2.4, -1.8, 2.2, -2.7, 0.3, 3.1, -2.2, 1.9, -0.6,
    ];
    input("s", times, values)
}

/// Every event is that of a program that shares nothing with this one (tests/reference/load.py),
/// within 1e-9, with the input in the force and in the load.
#[test]
fn a_coarse_input_gives_every_event_of_an_independent_program() {
    for (name, lines) in [
        (
            "input in the force",
            "friction = { static = 1.2, dynamic = 1.0 }\nforce.expression = \"s\"",
        ),
        (
            "input in the load",
            "friction = { static = 1.2, dynamic = 1.0, load = \"1 + 0.25*s\" }
             temperature.harmonics = [{ amplitude = 3, angular_frequency = 0.5 }]",
        ),
    ] {
        let found = events(&scenario(
            &format!("{lines}\ntime.end = 20"),
            &[coarse()],
            &[],
        ));
        let rows = include_str!("../reference/load.csv")
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>());
        let wanted: Vec<Vec<&str>> = rows.filter(|row| row[0] == name).collect();
        assert_eq!(found.len(), wanted.len(), "{name}");
        for (event, row) in found.iter().zip(&wanted) {
            let kind = match event.kind {
                EventKind::StickEntered => "0",
                EventKind::SlipStarted(_) => "1",
                EventKind::SubPhaseBoundary(_) => "2",
            };
            let [t, x, b] = [2, 3, 4].map(|i| row[i].parse::<f64>().expect("a number"));
            let off = [event.time - t, event.displacement - x, event.force - b].map(f64::abs);
            assert!(
                kind == row[1] && off.iter().all(|off| *off < 1e-9),
                "{name}: {event:?}, off by {off:?}"
            );
        }
    }
}

/// An input in the force of a spring of the user's own and the same samples as a temperature, which
/// another part of the program solves in closed form: the same events, within 1e-10.
#[test]
fn an_input_acts_as_the_same_samples_of_a_temperature_do() {
    let friction = "friction = { static = 1.2, dynamic = 1.0 }\ntime.end = 20";
    let NamedSeries { series, .. } = coarse();
    let air = NamedSeries {
        name: "temperature.series".into(),
        series,
    };
    let by_input = events(&scenario(
        &format!("{friction}\nforce.expression = \"s\""),
        &[coarse()],
        &[],
    ));
    let by_series = events(&scenario(friction, &[air], &[]));
    assert_eq!(by_input.len(), by_series.len());
    for (a, b) in by_input.iter().zip(&by_series) {
        let off = (a.time - b.time)
            .abs()
            .max((a.displacement - b.displacement).abs());
        assert!(a.kind == b.kind && off < 1e-10, "{a:?} {b:?}");
    }
}

/// A body without a spring under a force of 3 from t = 1 to 2 and friction 1 moves at 2 in the end, and
/// slides 1 + 2: with two samples at one time, and with values that last, linear and in any force.
#[test]
fn an_input_that_jumps_is_exact() {
    let jumps = Series::with_jumps(
        vec![0.0, 1.0, 1.0, 2.0, 2.0, 9.0],
        vec![0.0, 0.0, 3.0, 3.0, 0.0, 0.0],
    );
    let held = Series::held(&[0.0, 1.0, 2.0, 9.0], &[0.0, 3.0, 0.0, 0.0]);
    for series in [jumps, held].map(|series| series.expect("a series")) {
        for force in ["s", "s + 0*abs(x)"] {
            let given = NamedSeries {
                name: "input.s".into(),
                series: series.clone().into(),
            };
            let lines = format!(
                "friction = {{ static = 1.2, dynamic = 1.0 }}\ntime.end = 8\nforce.expression = \"{force}\""
            );
            let text = format!("{BODY}{lines}").replace("stiffness = 1,", "stiffness = 0,");
            let scenario = Scenario::parse_measured("test", &text, &[], &[given])
                .unwrap_or_else(|error| panic!("{error}"));
            let events = events(&scenario);
            let times: Vec<f64> = events.iter().map(|event| event.time).collect();
            assert!(
                events.len() == 2
                    && (times[0] - 1.0).abs() < 1e-12
                    && (times[1] - 4.0).abs() < 1e-11,
                "{force}: {times:?}"
            );
            assert!(
                (events[1].displacement - 3.0).abs() < 1e-11,
                "{force}: {events:?}"
            );
        }
    }
}

/// 3 cos(0.5 t) sampled every 1e-3, whose lines are off by up to 1e-7, and written out: the same
/// events, within 1e-6, and under noise within 1e-5 of each other on the same path.
#[test]
fn a_finely_sampled_cosine_is_that_cosine() {
    let times: Vec<f64> = (0..=40_000).map(|i| f64::from(i) * 1e-3).collect();
    let values = times.iter().map(|t| 3.0 * (0.5 * t).cos()).collect();
    let sampled = [input("s", times, values)];
    let lines = |force: &str| {
        format!(
            "friction = {{ static = 1.2, dynamic = 1.0 }}\ntime.end = 40\nforce.expression = \"-0.02*x^3 + {force}\""
        )
    };
    let [by_input, written] = [
        scenario(&lines("s"), &sampled, &[]),
        scenario(&lines("3*cos(0.5*t)"), &[], &[]),
    ]
    .map(|one| events(&one));
    assert_eq!(by_input.len(), written.len());
    assert!(by_input.len() > 10);
    for (a, b) in by_input.iter().zip(&written) {
        let off = (a.time - b.time)
            .abs()
            .max((a.displacement - b.displacement).abs());
        assert!(a.kind == b.kind && off < 1e-6, "{a:?} {b:?}");
    }
}

/// A block on an incline, in the direction of whose slope the ground is shaken by a half sine of
/// amplitude A that lasts T = pi/w. It slides from A sin w t1 = a, with the yield acceleration a =
/// g (mu cos i - sin i), by Newmark's closed form: after the pulse at the speed v = (A/w)(1 + cos w
/// t1) - a (T - t1) over v^2/2a more.
#[test]
fn a_block_on_an_incline_slides_as_newmark_says() {
    let (g, mu, slope, strong, duration) = (9.80665, 0.6f64, 0.3f64, 5.0, 0.4);
    let (hold, pull) = (mu * slope.cos() * g, slope.sin() * g);
    let (a, w) = (hold - pull, PI / duration);
    let start = (a / strong).asin() / w;
    let v = strong / w * (1.0 + (w * start).cos()) - a * (duration - start);
    let during = strong / w * ((w * start).cos() * (duration - start) + (w * start).sin() / w)
        - a * (duration - start).powi(2) / 2.0;
    let wanted = during + v * v / (2.0 * a);
    let (stop, parts) = (duration + v / a, 4000);
    let mut times: Vec<f64> = (0..=parts)
        .map(|i| duration * f64::from(i) / f64::from(parts))
        .collect();
    let mut values: Vec<f64> = times.iter().map(|t| strong * (w * t).sin()).collect();
    times.push(3.0);
    values[parts as usize] = 0.0;
    values.push(0.0);
    let lines = format!(
        "oscillator.mass = 2\noscillator.stiffness = 0\nfriction = {{ static = {0:?}, dynamic = {0:?} }}
         force.expression = \"m*(pull - ag)\"\nparameters = {{ m = 2, pull = {pull:?} }}\ntime.end = 3",
        2.0 * hold
    );
    let values = values.into_iter().map(|value| -value).collect();
    let body = BODY.replace(
        "oscillator = { mass = 1, stiffness = 1, force_per_temperature = 1 }",
        "oscillator.dilatation = 0",
    );
    let inputs = [input("ag", times, values)];
    let scenario = Scenario::parse_measured("test", &format!("{body}{lines}"), &[], &inputs);
    let found = events(&scenario.unwrap_or_else(|error| panic!("{error}")));
    let [first, last] = &found[..] else {
        panic!("{found:?}")
    };
    let off = [
        first.time - start,
        last.time - stop,
        last.displacement - wanted,
    ]
    .map(f64::abs);
    println!("{wanted} off by {off:?}");
    assert!(
        wanted > 0.05 && off.iter().all(|off| *off < 1e-6),
        "{found:?} {start} {stop} {wanted}"
    );
}

/// A pulse of 2 ms in a minute of silence is not stepped over: a block that was started with a velocity at 2 on
/// friction 0.05 gets the impulse 1/2 at t = 10, and stops at t = 50 (momentum) and x = 57.4996
/// (energy, and the areas of the triangle); a block at rest leaves when the pulse passes f_s = 1,
/// 2e-6 after its start.
#[test]
fn a_pulse_between_distant_samples_is_not_stepped_over() {
    let (height, half, friction) = (500.0, 1e-3, 0.05);
    let pulse = [input(
        "ag",
        vec![0.0, 10.0, 10.0 + half, 10.0 + 2.0 * half, 60.0],
        vec![0.0, 0.0, height, 0.0, 0.0],
    )];
    let block = |lines: &str| {
        let body = BODY.replace("stiffness = 1", "stiffness = 0");
        let text = format!("{body}force.expression = \"ag\"\ntime.end = 60\n{lines}");
        events(
            &Scenario::parse_measured("test", &text, &[], &pulse)
                .unwrap_or_else(|error| panic!("{error}")),
        )
    };
    let moving = block("friction = { static = 0.05, dynamic = 0.05 }\ninitial.velocity = 2");
    let after = 2.0 - friction * (10.0 + 2.0 * half) + height * half;
    let x = 2.0 * (10.0 + 2.0 * half) - 0.5 * friction * (10.0 + 2.0 * half).powi(2)
        + height * half * half;
    let [time, place] = [
        10.0 + 2.0 * half + after / friction,
        x + 0.5 * after * after / friction,
    ];
    let stop = moving
        .iter()
        .find(|event| event.kind == EventKind::StickEntered && event.time > 0.0)
        .expect("stops");
    let off = [stop.time - time, stop.displacement - place].map(f64::abs);
    assert!(off.iter().all(|off| *off < 1e-8), "{stop:?} off by {off:?}");
    let rested = block("friction = { static = 1, dynamic = 1 }");
    let start = rested
        .iter()
        .find(|event| matches!(event.kind, EventKind::SlipStarted(_)))
        .expect("slips");
    assert!(
        (start.time - 10.0 - half / height).abs() < 1e-11,
        "{start:?}"
    );
}
