//! Bodies that move at t = 0 (`initial.velocity`): they slip at once, and their first stick is empty.

use super::measures::{body, run, scenario};
use stickslip::engine::Replay;
use stickslip::scenario::Scenario;
use stickslip::scheme::{CorrectedVi, DiscreteVi, EventDriven, Scheme};
use stickslip::stats::{Record, Statistic};

fn launched(spring: [f64; 2], friction: [f64; 2], end: f64, velocity: f64, more: &str) -> Scenario {
    let scheme = if more.contains("scheme") {
        ""
    } else {
        "scheme = { kind = \"event-driven\" }"
    };
    let text = body(
        spring,
        friction,
        [end, 0.0, end],
        &format!("{more}\n{scheme}"),
    );
    scenario(&text.replace(
        "initial = { displacement = 0 }",
        &format!("initial = {{ displacement = 0.25, velocity = {velocity:?} }}"),
    ))
}

/// Where and when the path comes to rest for the first time.
fn rest(scenario: &Scenario) -> [f64; 2] {
    let events = Replay::of(scenario, 0).block.rows.events.expect("kept");
    assert_eq!(
        (events.time[0], events.kind[0], events.displacement[0]),
        (0.0, 1, 0.25),
        "a slip from the start"
    );
    assert_eq!(
        f64::from(events.sign[0]),
        scenario.model.initial_velocity.signum()
    );
    [events.time[1], events.displacement[1]]
}

fn schemes(step: f64) -> [(Scheme, f64); 3] {
    [
        (EventDriven { tolerance: 1e-3 }.into(), 1e-11),
        (DiscreteVi { step }.into(), 1e2 * step),
        (CorrectedVi { step }.into(), 1e2 * step),
    ]
}

/// A block of mass 1 with mu g = 0.3 * 9.8 started with a velocity at 10 stops after v^2/(2 mu g) = 17.006803, at
/// t = v/(mu g). With a spring it stops where energy is spent, at x = -f_d/K + hypot(x0 + f_d/K,
/// v/w0) when started with a velocity forwards.
#[test]
fn a_moving_block_stops_where_its_energy_is_spent() {
    for (scheme, tolerated) in schemes(1e-4) {
        for sign in [1.0, -1.0] {
            let block = launched([0.0, 0.0], [2.94, 2.94], 5.0, 10.0 * sign, "")
                .with_scheme(scheme)
                .expect("suits");
            let [time, x] = rest(&block);
            let expected = [10.0 / 2.94, 0.25 + sign * 17.006_802_721_088_434];
            assert!(
                (time - expected[0]).abs() < tolerated && (x - expected[1]).abs() < tolerated,
                "{scheme}: {time} {x}"
            );
        }
        let spring = launched([4.0, 0.0], [1.5, 1.0], 5.0, 3.0, "")
            .with_scheme(scheme)
            .expect("suits");
        let [_, x] = rest(&spring);
        let expected = -0.25 + 0.5f64.hypot(1.5);
        assert!((x - expected).abs() < tolerated, "{scheme}: {x} {expected}");
    }
}

/// A body that moves at t = 0 has no first stick; one that a force sets in motion at t = 0 has one
/// that lasts zero.
#[test]
fn a_moving_body_has_no_first_stick() {
    for (scheme, _) in schemes(1e-2) {
        let block = launched([4.0, 0.0], [1.5, 1.0], 5.0, 3.0, "ensemble.paths = 4")
            .with_scheme(scheme)
            .expect("suits");
        let summary = run(&block);
        let first = summary.estimate(Statistic::FirstStickDurationMean);
        assert!(first.estimate.is_nan(), "{scheme}: {first:?}");
        assert_eq!(summary.absence(first), Some("no first stick ended"));
        assert_eq!(
            (
                summary.first_sticks.completed,
                summary.stick_durations.completed
            ),
            (0, 0),
            "{scheme}"
        );
        let pushed = launched([4.0, 0.0], [0.5, 0.4], 5.0, 0.0, "ensemble.paths = 4")
            .with_scheme(scheme)
            .expect("suits");
        assert!(
            run(&pushed)
                .estimate(Statistic::FirstStickDurationMean)
                .estimate
                <= 0.01,
            "{scheme}"
        );
    }
}

/// A force g that is zero sends the path through the integrator for any force, and one that is half
/// of the spring joins it; both leave the body where the closed form does, with damping too.
#[test]
fn a_moving_body_under_a_user_force_follows_the_closed_form() {
    let of = |spring: [f64; 2], more: &str| {
        let scene = launched(spring, [1.5, 1.0], 5.0, 3.0, more);
        rest(
            &scene
                .with_scheme(EventDriven { tolerance: 1e-3 })
                .expect("suits"),
        )
    };
    let exact = of([4.0, 0.3], "");
    for (spring, force) in [
        ([4.0, 0.3], "0*x^3"),
        ([2.0, 0.3], "-2*x + 0*x^3"),
        ([4.0, 0.0], "-0.6*xdot + 0*x^3"),
    ] {
        let found = of(spring, &format!("force.expression = \"{force}\""));
        assert!(
            (0..2).all(|i| (found[i] - exact[i]).abs() < 1e-10),
            "{force}: {found:?} {exact:?}"
        );
    }
}

/// Under noise, paths that go vectorised, alone and with the motion followed are the same, and the mean
/// of x(t_end) of a body without friction is that of the free oscillation, x0 cos t + v0 sin t, whatever
/// the noise. Null: within 4 standard errors, 1 in 16 000.
#[test]
fn a_moving_body_under_noise_swings_about_the_free_one() {
    let more =
        "temperature.noise = { intensity = 1, relaxation_rate = 1, diffusion = 1, initial = 0 }
         ensemble = { paths = 2000, seed = 4 }
         scheme = { kind = \"event-driven\" }";
    let scene = launched([1.0, 0.0], [0.0, 0.0], 2.0, 3.0, more);
    let end = *run(&scene).estimate(Statistic::DisplacementEndMean);
    let expected = 0.25 * 2.0f64.cos() + 3.0 * 2.0f64.sin();
    assert!(
        (end.estimate - expected).abs() < 4.0 * end.standard_error,
        "{end:?} {expected}"
    );

    let mut rough = launched([1.0, 0.1], [1.2, 1.0], 10.0, -3.0, more);
    let alone = |path: u64| {
        Replay::of(&rough, path)
            .block
            .rows
            .path_columns
            .expect("kept")
            .displacement_end[0]
    };
    let singly: Vec<f64> = (0..300).map(alone).collect();
    let mean = singly.iter().sum::<f64>() / 300.0;
    rough.ensemble.paths = 300;
    for energy in [false, true] {
        rough.record = Record {
            energy,
            ..Record::NOTHING
        };
        let found = run(&rough)
            .estimate(Statistic::DisplacementEndMean)
            .estimate;
        assert!((found - mean).abs() < 1e-12, "{found} {mean}");
    }
}
