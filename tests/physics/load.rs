//! Friction with a load, and friction and forces with a direction, against an independent program,
//! a closed form, and one scheme against another.

use crate::common::{Keep, timeline};
use std::sync::atomic::AtomicBool;
use stickslip::engine::Run;
use stickslip::model::{Event, EventKind, Sign};
use stickslip::scenario::Scenario;
use stickslip::scheme::{CorrectedVi, DiscreteVi, EventDriven, Scheme, Simulate as _};
use stickslip::stats::Statistic;

/// The scenes of load.csv.
const SCENES: [(&str, &str); 6] = [
    (
        "load in time",
        "friction = { static = 1.2, dynamic = 1.0, load = \"1 + 0.3*cos(0.7*t)\" }
         temperature.harmonics = [{ amplitude = 3, angular_frequency = 0.5 }]",
    ),
    (
        "belt with patches",
        "friction = { static = 1.2, dynamic = 1.0, load = \"1 + 0.3*sin(2*x)\" }
         temperature.trend = 0.3",
    ),
    (
        "asymmetric foot",
        "friction = { static = { forward = 1.2, backward = 1.4 }, dynamic = { forward = 1.0, backward = 1.1 } }
         temperature.harmonics = [{ amplitude = 3, angular_frequency = 0.5 }]",
    ),
    (
        "pendulum",
        "oscillator.stiffness = 0
         friction = { static = 0.5, dynamic = 0.4, load = \"g*cos(x) + l*xdot^2\" }
         force.expression = \"-g*sin(x)\"
         parameters = { g = 1, l = 1 }
         temperature.harmonics = [{ amplitude = 0.7, angular_frequency = 0.5 }]
         initial.displacement = 0.3",
    ),
    (
        "clutch",
        "oscillator.damping = 0.1
         friction.static = 1.0
         friction.dynamic = 0.8
         friction.load = \"(1 + a*direction)*(1 - 0.3*tanh(xdot^2))*(1 + 0.5*tanh(t - 20))\"
         parameters = { a = 0.2 }
         temperature.harmonics = [{ amplitude = 2, angular_frequency = 0.5 }]
         initial.displacement = 0.5",
    ),
    (
        "direction in the force",
        "friction = { static = 1.0, dynamic = 0.8 }
         force.expression = \"-0.3*direction*(1 + 0.5*sin(t))\"
         temperature.harmonics = [{ amplitude = 3, angular_frequency = 0.5 }]",
    ),
];

/// m = K = 1, and the lines of a scene instead of these where they have the same key.
#[track_caller]
fn scenario(lines: &str, more: &str) -> Scenario {
    let base = "oscillator.mass = 1\noscillator.stiffness = 1\noscillator.force_per_temperature = 1
                initial.displacement = 0\ntime.end = 60\ntime.output_step = 1\nscheme.kind = \"event-driven\"";
    let key = |line: &str| line.split('=').next().unwrap_or("").trim().to_string();
    let own: Vec<String> = lines.lines().chain(more.lines()).map(key).collect();
    let rest: Vec<&str> = base
        .lines()
        .filter(|line| !own.contains(&key(line)))
        .collect();
    let text = format!("{lines}\n{more}\n{}", rest.join("\n"));
    Scenario::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn scene(name: &str, more: &str) -> Scenario {
    scenario(
        SCENES
            .iter()
            .find(|(other, _)| *other == name)
            .expect("a scene")
            .1,
        more,
    )
}

fn events(scenario: &Scenario) -> Vec<Event> {
    let mut keep = Keep::lanes(1);
    let simulation = scenario
        .scheme
        .simulation(&scenario.model, &scenario.timeline());
    assert_eq!(simulation.simulate(1, &[0], &mut keep), Vec::<usize>::new());
    keep.events.remove(0)
}

/// The cascade of an independent program.
fn reference(name: &str) -> Vec<(u8, [f64; 3])> {
    let rows = include_str!("../reference/load.csv")
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect::<Vec<_>>());
    let rows = rows.filter(|row| row[0] == name);
    rows.map(|row| {
        (
            row[1].parse().unwrap(),
            [2, 3, 4].map(|i| row[i].parse().unwrap()),
        )
    })
    .collect()
}

fn kind(event: &Event) -> u8 {
    match event.kind {
        EventKind::StickEntered => 0,
        EventKind::SlipStarted(_) => 1,
        EventKind::SubPhaseBoundary(_) => 2,
    }
}

/// Without noise every event is that of a program that shares nothing with this one
/// (tests/reference/load.py), within 1e-9. A slip start that used f_d for f_s, or a load of the
/// other direction, would be off by 0.1.
#[test]
fn without_noise_every_event_is_that_of_an_independent_program() {
    for (name, _) in SCENES {
        let (found, wanted) = (events(&scene(name, "")), reference(name));
        println!("{name}: {} events", found.len());
        let kinds: Vec<u8> = found.iter().map(kind).collect();
        assert_eq!(
            kinds,
            wanted.iter().map(|row| row.0).collect::<Vec<_>>(),
            "{name}"
        );
        for (event, (_, [t, x, b])) in found.iter().zip(&wanted) {
            let off = [event.time - t, event.displacement - x, event.force - b].map(f64::abs);
            assert!(
                off.iter().all(|off| *off < 1e-9),
                "{name}: {event:?}, off by {off:?}"
            );
        }
    }
}

/// A body started with a velocity at v0 on a plane where f_d grows like 1 + c x stops where its energy is spent,
/// f_d (x + c x^2/2) = m v0^2/2, and that is the work of friction, in every scheme.
#[test]
fn a_body_on_growing_friction_stops_where_energy_is_spent() {
    let (v0, f_d, c): (f64, f64, f64) = (10.0, 2.94, 0.1);
    let lines = "oscillator.stiffness = 0\ninitial.velocity = 10\ntime.end = 10\nensemble.paths = 1
         friction = { static = 2.94, dynamic = 2.94, load = \"1 + c*x\" }
         parameters = { c = 0.1 }";
    let distance = (-1.0 + (1.0 + c * v0 * v0 / f_d).sqrt()) / c;
    let energy = "record.energy = true";
    let measure = |scheme: Scheme| {
        let scenario = scenario(lines, energy)
            .with_scheme(scheme)
            .expect("a scheme");
        let summary = Run::of(&scenario)
            .without_bias()
            .simulate()
            .expect("no sink")
            .summary;
        let value = |statistic| summary.estimate(statistic).estimate;
        (
            value(Statistic::DisplacementEndMean),
            value(Statistic::FrictionWorkMean),
            value(Statistic::EnergyResidualMean),
        )
    };
    let (x, work, residual) = measure(EventDriven { tolerance: 1e-3 }.into());
    assert!(
        (x - distance).abs() < 1e-10 && (work - 50.0).abs() < 1e-9 && residual.abs() < 1e-9,
        "{x} {work} {residual}"
    );
    for with in [
        |step| Scheme::from(DiscreteVi { step }),
        |step| Scheme::from(CorrectedVi { step }),
    ] {
        let [coarse, fine] = [2e-3, 1e-3].map(|h| measure(with(h)));
        let (x, work) = (2.0 * fine.0 - coarse.0, 2.0 * fine.1 - coarse.1);
        println!("{x} {distance}, {work}");
        assert!(
            (x - distance).abs() < 1e-3 && (work - 50.0).abs() < 1e-2,
            "{x} {distance}, {work}"
        );
    }
}

/// A threshold that moves like f_s L(t) is, while the other one is out of reach, that of the force
/// -f_s (L(t) - 1) under a constant f_s. The first sticks of 300 paths end at the same times within
/// 1e-9, on either side: the same random numbers decide.
#[test]
fn a_moving_threshold_is_an_equivalent_force() {
    for side in [1.0, -1.0] {
        let noise = format!(
            "temperature.noise.intensity = 0.05\ninitial.displacement = {}\ntime.end = 20",
            -1.05 * side
        );
        let load = "friction = { static = 1.2, dynamic = 1.0, load = \"1 + 0.1*sin(3*t)\" }";
        let force = format!(
            "friction = {{ static = 1.2, dynamic = 1.0 }}\nforce.expression = \"{}*0.12*sin(3*t) + 0*abs(x)\"",
            -side
        );
        let first = |lines: &str| {
            let scenario = scenario(lines, &noise);
            let paths: Vec<u64> = (0..300).collect();
            let mut keep = Keep::lanes(paths.len());
            scenario
                .scheme
                .simulation(&scenario.model, &timeline(20.0, 20.0))
                .simulate(7, &paths, &mut keep);
            keep.events
                .iter()
                .filter_map(|events| events.first().copied())
                .collect::<Vec<_>>()
        };
        let (loaded, forced) = (first(load), first(&force));
        assert!(
            loaded.len() == forced.len() && loaded.len() > 200,
            "{}",
            loaded.len()
        );
        for (a, b) in loaded.iter().zip(&forced) {
            assert!(
                (a.time - b.time).abs() < 1e-9 && a.kind == b.kind,
                "{a:?} {b:?}"
            );
        }
    }
}

const QUICK: &str = "friction.static = 1.2\nfriction.dynamic = 1.0
                     temperature.harmonics = [{ amplitude = 3, angular_frequency = 0.5 }]";

/// A body that never slides one way, because the threshold there is as far as this, stays where it
/// is under a force that just reaches the other threshold, at once and in every scheme with a
/// direction; and under noise it is where it would be with any other threshold out of reach.
#[test]
fn a_threshold_out_of_reach_takes_no_digits_off_the_other_one() {
    let scene = |far: &str, sign: f64, more: &str| {
        let sides = if sign > 0.0 {
            ["0.82", far]
        } else {
            [far, "0.82"]
        };
        let lines = format!(
            "oscillator.stiffness = 0\nfriction.static = {{ forward = {}, backward = {} }}\nfriction.dynamic = 0.5
             force.expression = \"{sign:?}*0.82*sin(t)\"\nensemble.paths = 1",
            sides[0], sides[1]
        );
        scenario(&lines, more)
    };
    let noise = "temperature.noise.intensity = 0.3\ntime.end = 20";
    for sign in [1.0, -1.0] {
        let wanted = events(&scene("30", sign, noise));
        assert!(
            wanted.len() > 4 && wanted.iter().all(|event| event.kind != far_slip(sign)),
            "{wanted:?}"
        );
        for far in ["820", "1e4", "1e9", "inf"] {
            for scheme in [
                Scheme::from(EventDriven { tolerance: 1e-3 }),
                DiscreteVi { step: 0.01 }.into(),
                CorrectedVi { step: 0.01 }.into(),
            ] {
                let found = events(
                    &scene(far, sign, "")
                        .with_scheme(scheme)
                        .expect("goes together"),
                );
                assert_eq!(found, [], "{far} {scheme}");
            }
            let found = events(&scene(far, sign, noise));
            assert_eq!(found.len(), wanted.len(), "{far}");
            for (a, b) in found.iter().zip(&wanted) {
                assert!(
                    (a.time - b.time).abs() < 1e-9 && a.kind == b.kind,
                    "{far}: {a:?} {b:?}"
                );
            }
        }
    }
    let held = events(&scenario(
        "friction = { static = inf, dynamic = 1.0 }\ntemperature.trend = 10",
        "",
    ));
    assert_eq!(held, []);
}

/// The start of a slip towards the far threshold.
fn far_slip(sign: f64) -> EventKind {
    EventKind::SlipStarted(if sign > 0.0 {
        Sign::Negative
    } else {
        Sign::Positive
    })
}

/// A path that meets a load below 0 is given up in every scheme, and one that only comes close is
/// not. The load vanishes at x = -1, which is where the path was followed to.
#[test]
fn a_path_that_meets_a_negative_load_is_diverged() {
    for noise in ["", "temperature.noise.intensity = 0.01"] {
        for scheme in [
            Scheme::from(EventDriven { tolerance: 1e-3 }),
            DiscreteVi { step: 0.01 }.into(),
        ] {
            let lost = |least: &str| {
                let load = format!(
                    "friction = {{ static = 0.4, dynamic = 0.2, load = \"1 + a*x\" }}
                     parameters = {{ a = {least} }}
                     oscillator.stiffness = 0\ntemperature.offset = -1\ntime.end = 2\n{noise}"
                );
                let scenario = scenario(&load, "")
                    .with_scheme(scheme)
                    .expect("goes together");
                if let Some(given_up) = scenario.plan().why_lost(0, &AtomicBool::new(false)) {
                    println!("{given_up}");
                    assert!(
                        (-1.02..-0.9).contains(&given_up.displacement),
                        "{noise}: {given_up}"
                    );
                }
                let simulation = scenario
                    .scheme
                    .simulation(&scenario.model, &scenario.timeline());
                simulation.simulate(1, &[0, 1, 2], &mut ())
            };
            // By t = 2 the body comes to about x = -1.8.
            assert_eq!(lost("1"), [0, 1, 2], "{noise} {scheme}");
            assert_eq!(lost("0.1"), Vec::<usize>::new(), "{noise} {scheme}");
        }
    }
}

/// What cannot be meant is refused with its key, and a resolved scenario reads back as the same.
#[test]
fn a_load_is_refused_with_its_reason_or_written_as_it_was_read() {
    let never = "friction = { static = { forward = 1, backward = inf }, dynamic = 1 }";
    let never_at_all = "friction = { static = inf, dynamic = 1 }";
    for lines in SCENES
        .iter()
        .map(|(_, lines)| *lines)
        .chain([never, never_at_all])
    {
        let read = scenario(lines, "");
        let again = Scenario::parse("again", &read.to_toml(), &[])
            .unwrap_or_else(|error| panic!("{lines}: {error}"));
        assert_eq!(again.to_toml(), read.to_toml(), "{lines}");
        assert_eq!(again.model, read.model, "{lines}");
        assert_eq!(
            again.to_toml().contains("inf"),
            lines.contains("inf"),
            "{lines}"
        );
    }
    let base = "oscillator = { mass = 1, stiffness = 1, force_per_temperature = 1 }\ninitial.displacement = 0
                time.end = 1\nscheme.kind = \"event-driven\"\n";
    for (lines, words) in [
        (
            "friction = { static = 1.2, dynamic = 1.0, load = \"1 + q\" }",
            "unknown name `q`",
        ),
        (
            "friction = { static = 1.2, dynamic = 1.0, load = \"1\" }\nparameters = { q = 1 }",
            "`parameters.q` is not used",
        ),
        (
            "friction = { static = 1.2, dynamic = { forward = 1.0, backward = 1.3 } }",
            "`friction.dynamic` = 1.3 must not exceed",
        ),
        (
            "friction = { static = { forward = 1.2 }, dynamic = 1.0 }",
            "missing key `friction.static.backward`",
        ),
        (
            "friction = { static = { forward = 2, backward = 2, left = 2 }, dynamic = 1.0 }",
            "unknown key `left`",
        ),
        (
            "friction = { static = 1.2, dynamic = 1.0, load = 3 }",
            "`friction.load`",
        ),
        (
            "friction = { static = inf, dynamic = inf }",
            "`friction.dynamic` = inf is not finite",
        ),
        (
            "friction = { static = -inf, dynamic = 0 }",
            "`friction.static` = -inf is not finite",
        ),
        (
            "friction = { static = 1.2, dynamic = 1.0 }\nforce.expression = \"-(x - T)^3\"",
            "k3*(V*t - x)^3",
        ),
    ] {
        let error = Scenario::parse("test", &format!("{lines}\n{base}"), &[])
            .expect_err(lines)
            .to_string();
        assert!(
            error.contains(words) && error.contains("fix:"),
            "{lines}: {error}"
        );
    }
    let load = scene("load in time", "");
    let refused = load
        .with_scheme(stickslip::scheme::Kind::QuasiStatic.with(1e-3))
        .expect_err("a load")
        .to_string();
    assert!(
        refused.contains("load") && refused.contains("event-driven"),
        "{refused}"
    );
}

/// A load that oscillates 1000 times as fast as the body is seen in sticks: discrete-vi at h = 2e-6
/// has 173 sticks of the mean 0.0226791.
#[test]
fn what_oscillates_quickly_is_not_stepped_over() {
    let alone = scenario(
        QUICK,
        "friction.load = \"1 + 0.3*cos(1e3*t)\"\nensemble.paths = 1",
    );
    let summary = Run::of(&alone).simulate().expect("a run").summary;
    let [sticks, mean] = [Statistic::SticksPerPath, Statistic::StickDurationMean]
        .map(|which| summary.estimate(which).estimate);
    assert!(
        sticks == 173.0 && (mean / 0.0226791 - 1.0).abs() < 1e-3,
        "{sticks} {mean}"
    );
}

/// A load that falls for 5 ms in a minute, and a force that pushes for as long, move a body that
/// holds the rest of the time as far as the fourth-order Runge-Kutta rule with steps of 2e-7 says,
/// and all noisy paths within 1 % of that. Steps that pass the pulse by leave it where it is.
#[test]
fn a_short_pulse_is_not_stepped_over() {
    const BELL: &str = "exp(-((t - 20.3)/0.005)^2)";
    let bell = |t: f64| (-((t - 20.3) / 0.005).powi(2)).exp();
    let cases = [
        ("friction.load = \"1 - 0.95*", [-0.95, 0.0]),
        ("force.expression = \"8*", [0.0, 8.0]),
    ];
    for (line, [of_load, of_force]) in cases {
        let line = format!("{line}{BELL}\"");
        let load_and_force = |t: f64| [1.0 + of_load * bell(t), of_force * bell(t)];
        let (h, mut t, mut x, mut v) = (2e-7, 20.25, 0.0, 0.0);
        let a = |t: f64, x: f64| {
            let [load, force] = load_and_force(t);
            0.7 - x + force - load
        };
        while 0.7 + load_and_force(t)[1] < 1.2 * load_and_force(t)[0] {
            t += h;
        }
        while v >= 0.0 {
            let k1 = [v, a(t, x)];
            let k2 = [v + 0.5 * h * k1[1], a(t + 0.5 * h, x + 0.5 * h * k1[0])];
            let k3 = [v + 0.5 * h * k2[1], a(t + 0.5 * h, x + 0.5 * h * k2[0])];
            let k4 = [v + h * k3[1], a(t + h, x + h * k3[0])];
            let step = |i: usize| h * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0;
            (t, x, v) = (t + h, x + step(0), v + step(1));
        }
        for (noise, allowed) in [
            ("ensemble.paths = 1", 1e-5),
            ("temperature.noise.intensity = 1e-3", 1e-2),
        ] {
            let pushed = scenario(
                "friction.static = 1.2\nfriction.dynamic = 1.0\ntemperature.offset = 0.7",
                &format!(
                    "{line}\n{noise}\n{}",
                    if noise.contains("paths") {
                        ""
                    } else {
                        "ensemble.paths = 64"
                    }
                ),
            );
            let summary = Run::of(&pushed)
                .without_bias()
                .simulate()
                .expect("a run")
                .summary;
            let found = summary.estimate(Statistic::DisplacementEndMean).estimate;
            println!("{line}, {noise}: {found:e} {x:e}");
            assert!(
                (found / x - 1.0).abs() < allowed,
                "{line}, {noise}: {found:e} {x:e}"
            );
        }
    }
}

/// Friction that falls with the speed of sliding is one law, whether it is written as a load, or as
/// a force that gives back what friction has lost: each path has the same events, and the friction
/// of the load takes the work of the constant friction less what the force gives back. The
/// parameters are those of the load, of the force, and of the numbers. Without its load, friction
/// would take 25 % more.
#[test]
fn a_load_takes_the_work_of_the_force_that_stands_for_it() {
    let more =
        "friction.static = 1.3\nfriction.dynamic = \"f_d\"\ntemperature.trend = \"V\"\noscillator.damping = 0.025
                temperature.noise.intensity = 0.3\nensemble.paths = 40\nrecord.energy = true\nrecord.events = true
                statistics.after = 10.1\nparameters = { f_d = 1.1, mu = 0.3, vs = 0.2, V = 0.5 }";
    let force = "force.expression = \"mu*(1 - exp(-direction*xdot/vs))*direction + 0*V\"";
    let load = "friction.load = \"1 - mu/f_d*(1 - exp(-direction*xdot/vs))\"";
    let [as_force, as_load] = [force, load].map(|line| scenario(line, more));
    for (a, b) in events(&as_force).iter().zip(&events(&as_load)) {
        assert!(
            a.kind == b.kind && (a.time - b.time).abs() < 1e-9,
            "{a:?} {b:?}"
        );
    }
    let summaries = [&as_force, &as_load].map(|scene| {
        Run::of(scene)
            .without_bias()
            .simulate()
            .expect("a run")
            .summary
    });
    let [
        [friction, given, damping, left],
        [loaded, nothing, same, residual],
    ] = summaries.each_ref().map(|of| {
        [
            Statistic::FrictionWorkMean,
            Statistic::UserForceWorkMean,
            Statistic::DampingWorkMean,
            Statistic::EnergyResidualMean,
        ]
        .map(|statistic| of.estimate(statistic).estimate)
    });
    println!("{friction} - {given} = {loaded}");
    assert!(
        (friction - given - loaded).abs() < 1e-9 * friction && given > 0.25 * loaded,
        "{friction} {given} {loaded}"
    );
    assert!(
        nothing == 0.0 && (damping - same).abs() < 1e-9 && (residual - left).abs() < 1e-9,
        "{nothing}"
    );
    // The energy is not asked for, and the work is the same.
    let alone = scenario(load, &more.replace("record.energy = true", ""));
    let alone = Run::of(&alone)
        .without_bias()
        .simulate()
        .expect("a run")
        .summary;
    assert_eq!(alone.estimate(Statistic::FrictionWorkMean).estimate, loaded);
}
