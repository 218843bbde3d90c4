//! Forces that are absorbed into the body and its temperature, against the same force as a
//! temperature, and against the code for any force.

use crate::common::Keep;
use stickslip::model::{NamedSeries, Series};
use stickslip::scenario::Scenario;
use stickslip::scheme::Simulate as _;

/// m = K = 1 with friction and damping.
const BODY: &str =
    "oscillator = { mass = 1, stiffness = 1, damping = 0.05, force_per_temperature = 2 }
    friction = { static = 1.2, dynamic = 1.0 }
    initial.displacement = 0.3
    time.end = 20\ntime.output_step = 0.4\n";

/// The noise of tests in which there is one.
const NOISE: &str = "temperature.noise = { intensity = 0.4, relaxation_rate = 1, diffusion = 1 }\n";

/// Samples with kinks, the last one after the end.
fn samples(name: &str) -> NamedSeries {
    let times = vec![0.0, 1.3, 2.1, 3.7, 4.4, 6.2, 9.1, 11.4, 14.3, 16.8, 21.0];
    let values = vec![0.0, 1.6, -0.4, -1.9, 1.1, 1.4, 1.2, -1.7, 2.1, -1.2, 0.9];
    NamedSeries {
        name: name.into(),
        series: Series::new(times, values).expect("a series").into(),
    }
}

/// The events and rows of four paths.
#[track_caller]
fn simulated(scheme: &str, lines: &str, measured: &[NamedSeries]) -> Keep {
    of_text(
        &format!("scheme.kind = \"{scheme}\"\n{BODY}{lines}"),
        measured,
    )
}

#[track_caller]
fn of_text(text: &str, measured: &[NamedSeries]) -> Keep {
    let scenario = Scenario::parse_measured("test", text, &[], measured)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut keep = Keep::lanes(4);
    let simulation = scenario
        .scheme
        .simulation(&scenario.model, &scenario.timeline());
    assert!(simulation.simulate(1, &[0, 1, 2, 3], &mut keep).is_empty());
    keep
}

/// The same events and rows within `bound`. What T of the second exceeds that of the first by is a
/// function of t.
#[track_caller]
fn assert_same(one: &Keep, two: &Keep, bound: f64, exceeds: impl Fn(f64) -> f64) {
    let far = |a: f64, b: f64| (a - b).abs() > bound;
    for (one, two) in one.events.iter().zip(&two.events) {
        assert!(one.len() > 4, "too few events: {}", one.len());
        assert_eq!(one.len(), two.len());
        for (a, b) in one.iter().zip(two) {
            let is_far =
                far(a.time, b.time) || far(a.displacement, b.displacement) || far(a.force, b.force);
            assert!(a.kind == b.kind && !is_far, "{a:?} {b:?}");
        }
    }
    for (a, b) in one.rows.iter().flatten().zip(two.rows.iter().flatten()) {
        let is_far = far(a.1, b.1) || far(a.2, b.2) || far(a.3 + exceeds(a.0), b.3);
        assert!(a.4 == b.4 && !is_far, "{a:?} {b:?}");
    }
}

/// The same harmonics and line in the force and in the temperature, which acts with a factor of 2,
/// under the same noise: each path is the same, and so is its temperature but for what was moved.
#[test]
fn a_force_of_harmonics_is_the_temperature_that_exerts_it() {
    let by_force = "force.expression = \"0.4 - 0.02*t + 2.4*sin(0.7*t + 0.3) - 3*cos(1.1*t)/2\"\n";
    let by_temperature = "temperature.offset = 0.2\ntemperature.trend = -0.01
        temperature.harmonics = [{ amplitude = 1.2, angular_frequency = 0.7, phase = -1.2707963267948966 },
            { amplitude = -0.75, angular_frequency = 1.1 }]\n";
    let moved = |t: f64| 0.2 - 0.01 * t + 1.2 * (0.7 * t + 0.3).sin() - 0.75 * (1.1 * t).cos();
    for noise in [NOISE, ""] {
        let run = |lines| simulated("event-driven", &format!("{noise}{lines}"), &[]);
        assert_same(&run(by_force), &run(by_temperature), 1e-9, moved);
    }
}

/// The same samples in the force and in the temperature, under the same noise.
#[test]
fn a_force_of_an_input_is_the_temperature_that_exerts_it() {
    let series = samples("").series;
    for noise in [NOISE, ""] {
        let run =
            |lines: &str, of| simulated("event-driven", &format!("{noise}{lines}"), &[samples(of)]);
        let by_force = run("force.expression = \"2*s\"", "input.s");
        let by_temperature = run("", "temperature.series");
        assert_same(&by_force, &by_temperature, 1e-9, |t| series.at(t));
    }
}

/// Without noise, the code for any force gives the same events: `abs(x)` keeps the second force from
/// being absorbed.
#[test]
fn what_is_absorbed_moves_the_body_as_any_force_does() {
    let force = "0.4 - 0.02*t + 2*sin(0.7*t + 0.3) - cos(1.1*t)/2 + 0.5*s - 0.2*xdot - 0.3*x";
    let harmonics = "temperature.harmonics = [{ amplitude = 0.5, angular_frequency = 0.45 }]\n";
    let run = |scheme, force: &str| {
        let lines = format!("{harmonics}force.expression = \"{force}\"");
        simulated(scheme, &lines, &[samples("input.s")])
    };
    let any = format!("{force} + 0*abs(x)");
    let absorbed = run("event-driven", force);
    assert_same(&absorbed, &run("event-driven", &any), 1e-9, |_| 0.0);
}

/// Under noise, the mean displacement over 4 000 paths of the code for any force agrees with that of
/// the absorbed one, path by path on other noise within steps: within 4 standard errors of their
/// difference (false alarms, 6e-5).
#[test]
fn what_is_absorbed_has_the_law_of_any_force_under_noise() {
    let mean = |force: &str| {
        let text = format!(
            "scheme.kind = \"event-driven\"\n{BODY}{NOISE}force.expression = \"{force}\"\n
             ensemble.paths = 4000"
        );
        let scenario =
            Scenario::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}"));
        let run = stickslip::engine::Run::of(&scenario)
            .without_bias()
            .simulate()
            .expect("a run");
        [
            stickslip::stats::Statistic::DisplacementEndMean,
            stickslip::stats::Statistic::SticksPerPath,
        ]
        .map(|statistic| run[statistic])
    };
    let (absorbed, any) = (
        mean("0.9*cos(0.7*t) + 0.3"),
        mean("0.9*cos(0.7*t) + 0.3 + 0*abs(x)"),
    );
    for (a, b) in absorbed.iter().zip(&any) {
        let error = a.standard_error.hypot(b.standard_error);
        assert!((a.estimate - b.estimate).abs() < 4.0 * error, "{a:?} {b:?}");
    }
}

/// A temperature that does not act keeps its values where the force is absorbed: v is random, and
/// the motion is that of the force alone.
#[test]
fn a_temperature_that_does_not_act_stays_as_it_is() {
    let lines = |more: &str| format!("{more}force.expression = \"3*cos(0.5*t)\"");
    let body = BODY.replace("force_per_temperature = 2", "force_per_temperature = 0");
    let run = |lines: &str| {
        of_text(
            &format!("scheme.kind = \"event-driven\"\n{body}{lines}"),
            &[],
        )
    };
    let (silent, noisy) = (run(&lines("")), run(&lines(NOISE)));
    assert_eq!(silent.events, noisy.events);
    assert!(silent.rows.iter().flatten().all(|row| row.3 == 0.0));
    let last = |path: usize| noisy.rows[path].last().expect("rows").3;
    assert!((1..4).all(|path| last(path) != last(0) && last(path).abs() < 2.0));
}

/// The discrete scheme adds a force of t alone to the forcing of all paths: the same as g of each
/// path, to rounding.
#[test]
fn the_discrete_scheme_takes_a_force_of_time_as_any_other() {
    for scheme in ["discrete-vi", "corrected-vi"] {
        let run = |force: &str| {
            let lines = format!("time.step = 0.01\n{NOISE}force.expression = \"{force}\"");
            simulated(scheme, &lines, &[])
        };
        let force = "2*exp(-t/9)*cos(0.7*t) + 0.1*t";
        let (of_time, any) = (run(force), run(&format!("{force} + 0*x")));
        assert_same(&of_time, &any, 1e-9, |_| 0.0);
    }
}
