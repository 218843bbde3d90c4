use super::super::{Noiseless, PathSegments as _};
use super::GeneralNoiseless;
use crate::lanes::Lanes;
use crate::model::tests::paper;
use crate::model::{
    Event, EventKind, Expression, Force, ForceLaw, Friction, Harmonic, InitialNoise, NamedSeries,
    OrnsteinUhlenbeck, Problem, Series, Sign,
};
use crate::scheme::{Instant, Observer, Snapshot, Timeline};
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;
use std::sync::Arc;

/// The events and the states (t, x, x', T, whether static) of one path.
#[derive(Clone, Debug, Default)]
struct OnePath {
    events: Vec<Event>,
    states: Vec<(f64, f64, f64, f64, bool)>,
}

impl Observer for OnePath {
    fn event(&mut self, lane: usize, event: Event) {
        if lane == 0 {
            self.events.push(event);
        }
    }

    fn snapshot(&mut self, _: Instant, s: Snapshot<'_>) {
        self.states.push((
            s.time,
            s.displacement[0],
            s.velocity[0],
            s.temperature[0],
            s.is_static[0],
        ));
    }
}

fn timeline(end: f64) -> Timeline {
    Timeline {
        end,
        output_step: 0.37,
        period: None,
        after: 0.0,
    }
}

/// A force as a function of numbers, and whether it depends on time.
struct Scalar<G>(G, bool);

impl<G> fmt::Debug for Scalar<G> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a force of numbers")
    }
}

impl<G: Fn(f64, f64, f64) -> f64 + Send + Sync> ForceLaw for Scalar<G> {
    fn value<L: Lanes>(&self, x: L, velocity: L, time: L) -> L {
        let (mut xs, mut vs, mut ts) = ([0.0; 8], [0.0; 8], [0.0; 8]);
        x.store(&mut xs);
        velocity.store(&mut vs);
        time.store(&mut ts);
        L::load(&std::array::from_fn::<f64, 8, _>(|i| {
            (self.0)(xs[i], vs[i], ts[i])
        }))
    }

    fn depends_on_time(&self) -> bool {
        self.1
    }
}

/// A force that does not depend on time.
fn constant_in_time(g: impl Fn(f64, f64) -> f64 + Send + Sync + 'static) -> Force {
    Force::new(Scalar(move |x, v, _| g(x, v), false))
}

fn nothing() -> Force {
    constant_in_time(|_, _| 0.0)
}

/// The force of this function of time alone.
fn of_time(g: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Force {
    Force::new(Scalar(move |_, _, t| g(t), true))
}

/// The scheme with this force.
fn general(model: &Problem, end: f64, force: Force) -> GeneralNoiseless {
    GeneralNoiseless::new(
        &Problem {
            force: Some(force),
            ..model.clone()
        },
        &timeline(end),
    )
}

fn path_at(cascade: &GeneralNoiseless) -> (OnePath, u64) {
    let mut path = OnePath::default();
    let simulated = cascade.simulate(2, &mut path);
    assert!(simulated.lost.is_empty(), "lost: {path:?}");
    (path, simulated.evaluations)
}

fn path(model: &Problem, end: f64, force: Force) -> OnePath {
    path_at(&general(model, end, force)).0
}

fn exact(model: &Problem, end: f64) -> OnePath {
    let mut path = OnePath::default();
    assert!(
        Noiseless::new(model, &timeline(end))
            .simulate(1, &mut path)
            .lost
            .is_empty()
    );
    path
}

/// The largest difference of two paths with equal phases: of events in time, x and b, and of states
/// in x, x' and T.
#[track_caller]
fn distance(found: &OnePath, wanted: &OnePath) -> f64 {
    let kinds = |path: &OnePath| {
        path.events
            .iter()
            .map(|event| event.kind)
            .collect::<Vec<_>>()
    };
    assert_eq!(
        kinds(found),
        kinds(wanted),
        "{:?}\n{:?}",
        found.events,
        wanted.events
    );
    let events = found.events.iter().zip(&wanted.events);
    let of_events = events.flat_map(|(a, b)| {
        [
            a.time - b.time,
            a.displacement - b.displacement,
            a.force - b.force,
        ]
    });
    assert_eq!(found.states.len(), wanted.states.len());
    let states = found.states.iter().zip(&wanted.states);
    let of_states = states.flat_map(|(a, b)| {
        assert!(a.0 == b.0 && a.4 == b.4, "{a:?} {b:?}");
        [a.1 - b.1, a.2 - b.2, a.3 - b.3]
    });
    of_events.chain(of_states).fold(0.0, |most: f64, off| {
        if off.is_nan() {
            f64::NAN
        } else {
            most.max(off.abs())
        }
    })
}

/// A scene without forcing.
fn unforced(x0: f64, static_force: f64, dynamic_force: f64) -> Problem {
    let mut model = paper(0.25, 0.0);
    model.temperature.harmonics.clear();
    model.friction = Friction {
        static_force,
        dynamic_force,
    };
    model.initial_displacement = x0;
    model
}

/// Scenes that have a closed form, with the end of each.
fn scenes() -> Vec<(String, Problem, f64)> {
    let mut scenes = Vec::new();
    for w in [0.25, 0.5, 1.0, 1.7] {
        for damping in [0.0, 0.125, 1.0, 3.0] {
            for end in [60.0, 200.0] {
                let mut model = paper(w, 0.0);
                model.oscillator.damping = damping;
                scenes.push((
                    format!("w = {w}, alpha = {damping}, t_end = {end}"),
                    model,
                    end,
                ));
            }
        }
    }
    let mut add = |name: &str, change: &dyn Fn(&mut Problem)| {
        let mut model = paper(0.25, 0.0);
        change(&mut model);
        scenes.push((name.to_owned(), model, 60.0));
    };
    add("equal thresholds", &|m| {
        m.friction = Friction {
            static_force: 1.0,
            dynamic_force: 1.0,
        }
    });
    add("nearly equal thresholds", &|m| {
        m.friction.static_force = 1.0 + 1e-10
    });
    add("no friction", &|m| {
        m.friction = Friction {
            static_force: 0.0,
            dynamic_force: 0.0,
        };
        m.initial_displacement = 5.0;
    });
    add("no dynamic friction", &|m| m.friction.dynamic_force = 0.0);
    add("strong damping", &|m| m.oscillator.damping = 5000.0);
    add("starts outside", &|m| m.initial_displacement = 12.0);
    add("a phase, a constant and a mean that relaxes", &|m| {
        m.temperature.harmonics[0].phase = 0.7;
        m.temperature.harmonics.push(Harmonic {
            amplitude: 0.3,
            angular_frequency: 0.0,
            phase: 0.4,
        });
        let initial = InitialNoise::At(0.8);
        m.temperature.noises = vec![OrnsteinUhlenbeck {
            intensity: 0.5,
            relaxation_rate: 0.3,
            diffusion: 0.0,
            initial,
        }];
    });
    add("measured", &|m| {
        let times: Vec<f64> = (0..=90).map(|i| 0.7 * f64::from(i)).collect();
        let values = times
            .iter()
            .map(|t| (0.25 * t).cos() + 0.1 * (7.0 * t).sin())
            .collect();
        m.temperature.harmonics.clear();
        m.temperature.series = Some(Arc::new(Series::new(times, values).expect("a series")));
    });
    scenes
}

#[test]
fn without_a_user_force_every_state_is_the_closed_form() {
    for (name, model, end) in scenes() {
        let wanted = exact(&model, end);
        let cascade = general(&model, end, nothing());
        let (found, evaluations) = path_at(&cascade);
        let off = distance(&found, &wanted);
        println!(
            "{name}: {} events, off by {off:e}, {evaluations} evaluations",
            wanted.events.len()
        );
        assert!(off < 1e-9 && wanted.events.len() >= 2, "{name}: {off:e}");
        // The same scene with a function of time that is zero, whose sticks are searched.
        let off = distance(&path(&model, end, of_time(|_| 0.0)), &wanted);
        println!("  searched: off by {off:e}");
        assert!(off < 1e-9, "{name}, searched: {off:e}");
    }
}

#[test]
fn a_path_of_the_paper_takes_few_evaluations() {
    for (name, g) in [
        ("nothing", nothing()),
        (
            "a stop",
            constant_in_time(|x, _| -20.0 * (x - 3.0).max(0.0)),
        ),
    ] {
        let (_, evaluations) = path_at(&general(&paper(0.25, 0.0), 60.0, g));
        println!("{name}: {evaluations} evaluations");
        assert!(evaluations < 100_000, "{name}: {evaluations}");
    }
}

/// The times and displacements are from the integral of the energy in 40-digit arithmetic.
#[test]
fn a_cubic_spring_stops_where_its_energy_is_spent() {
    let found = path(
        &unforced(3.0, 1.0, 1.0),
        2.0,
        constant_in_time(|x, _| -0.5 * x * x * x),
    );
    let [start, stop, ..] = found.events[..] else {
        panic!("{found:?}")
    };
    assert_eq!(
        (start.kind, start.time, start.force),
        (EventKind::SlipStarted(Sign::Negative), 0.0, -16.5)
    );
    assert_eq!(stop.kind, EventKind::SubPhaseBoundary(Sign::Positive));
    assert!((stop.time - 1.594_630_367_679_26).abs() < 1e-11, "{stop:?}");
    assert!(
        (stop.displacement + 2.594_562_116_631_153).abs() < 1e-11,
        "{stop:?}"
    );
}

/// v' = 2 - v^2/2, so that v = 2 tanh t and x = 2 ln cosh t.
#[test]
fn drag_limits_the_velocity() {
    let found = path(
        &unforced(0.0, 1.0, 1.0),
        4.0,
        constant_in_time(|x, v| 3.0 - 0.5 * v * v.abs() + x),
    );
    let (t, x, v, _, is_static) = *found.states.last().expect("a state");
    assert!(
        t == 4.0 && !is_static && found.events.len() == 1,
        "{found:?}"
    );
    assert!(
        (x - 6.614_376_451_625_901).abs() < 1e-11 && (v - 1.998_658_599_478_134).abs() < 1e-11,
        "{x} {v}"
    );
}

#[test]
fn a_stop_with_a_kink_does_not_depend_on_the_tolerance() {
    let at = |tolerance: f64| {
        let stop = constant_in_time(|x, _| -20.0 * (x - 3.0).max(0.0));
        let mut cascade = general(&paper(0.25, 0.0), 60.0, stop);
        cascade.tolerance = tolerance;
        path_at(&cascade).0
    };
    let usual = at(1e-13);
    assert!(usual.events.len() > 4, "{usual:?}");
    for (tolerance, most) in [(1e-11, 1e-8), (2e-13, 1e-10), (5e-14, 1e-10)] {
        let off = distance(&at(tolerance), &usual);
        println!("tolerance {tolerance:e}: {off:e}");
        assert!(off < most, "{tolerance:e}: {off:e}");
    }
}

/// A force -c x' is a damping alpha = c/2, whose closed form is known. It takes few evaluations, however
/// fast it settles the velocity. So does a force that is steep only near x' = 0.
#[test]
fn a_force_stiff_in_the_velocity_alone_takes_few_evaluations() {
    for c in [1e4, 1e5, 1e6, 1e7, 1e8] {
        let mut model = paper(0.25, 0.0);
        let force = constant_in_time(move |_, v| -c * v - 1e-30 * v * v * v);
        let (found, evaluations) = path_at(&general(&model, 6.0, force));
        model.oscillator.damping = 0.5 * c;
        let off = distance(&found, &exact(&model, 6.0));
        println!("{c:e}: off by {off:e}, {evaluations} evaluations");
        assert!(
            off < 1e-9 && evaluations < 30_000,
            "{c:e}: {off:e}, {evaluations}"
        );
    }
    for (name, force) in [
        ("tanh", constant_in_time(|_, v| (v / 1e-7).tanh())),
        ("-tanh", constant_in_time(|_, v| -0.1 * (v / 1e-7).tanh())),
    ] {
        let (_, evaluations) = path_at(&general(&paper(0.25, 0.0), 6.0, force));
        println!("{name}: {evaluations} evaluations");
        assert!(evaluations < 30_000, "{name}: {evaluations}");
    }
}

/// x'' = -x with a kink: a second spring of stiffness 3 beyond x = 1. Released at x = 2 without
/// friction, the body returns after two quarter periods on each side, with the energy of the start:
/// x = 1 is reached where 4 (x - 3/4) = 5 cos 2t, and x' = -sqrt(6) there.
#[test]
fn a_kink_is_crossed_at_its_place() {
    let found = path(
        &unforced(2.0, 0.0, 0.0),
        6.0,
        constant_in_time(|x, _| -3.0 * (x - 1.0).max(0.0)),
    );
    let beyond = 0.5 * 0.2f64.acos();
    let within = 6f64.sqrt().atan2(1.0);
    // From x = 1 on, x = cos r - sqrt(6) sin r, which stops where tan r = -sqrt(6).
    let stop = found.events[1];
    assert!(
        (stop.time - (beyond + PI - within)).abs() < 1e-11,
        "{stop:?}"
    );
    assert!((stop.displacement + 7f64.sqrt()).abs() < 1e-11, "{stop:?}");
    assert!(
        (found.events[2].time - 2.0 * stop.time).abs() < 1e-11,
        "{found:?}"
    );
    assert!(
        (found.events[2].displacement - 2.0).abs() < 1e-11,
        "{found:?}"
    );
}

/// x' = t (t - 1)^2 + lift t is the motion that a force of time gives to a body that nothing else
/// holds. It stops just before t = 1 for the smallest lift < 0, and not for lift > 0. From t = 1 on
/// the force exceeds f_s = 1/2 where 3 t^2 - 4 t + 1 + lift = 1/2.
#[test]
fn a_tiny_velocity_stops_the_body_according_to_its_sign() {
    for lift in [1e-10, -1e-10, 1e-6, -1e-6, 1e-3, -1e-3] {
        let g = Force::new(Scalar(
            move |x: f64, _: f64, t: f64| x + (t - 1.0) * (3.0 * t - 1.0) + lift,
            true,
        ));
        let found = path(&unforced(0.0, 0.5, 0.0), 3.0, g);
        assert_eq!(
            found.events.len(),
            if lift > 0.0 { 1 } else { 3 },
            "{lift}: {found:?}"
        );
        if lift < 0.0 {
            let exit = (2.0 + (4.0 - 3.0 * (0.5 + lift)).sqrt()) / 3.0;
            for (event, time) in found.events[1..].iter().zip([1.0 - (-lift).sqrt(), exit]) {
                assert!(
                    (event.time - time).abs() < 1e-10,
                    "{lift}: {event:?} {time}"
                );
            }
        } else {
            let v = found.states.last().expect("a state").2;
            assert!((v - 3.0 * (4.0 + lift)).abs() < 1e-11, "{lift}: {v}");
        }
    }
}

/// The body moves with x' = 100 sin t for a thousand half turns without friction, as an oscillator
/// that nothing holds.
#[test]
fn an_oscillation_keeps_its_amplitude() {
    let found = path(&unforced(100.0, 0.0, 0.0), 1000.0, nothing());
    assert_eq!(found.events.len(), 319);
    for (i, event) in found.events.iter().enumerate() {
        let x = if i % 2 == 0 { 100.0 } else { -100.0 };
        assert!((event.time - i as f64 * PI).abs() < 1e-9, "{event:?}");
        assert!((event.displacement - x).abs() < 1e-9, "{event:?}");
    }
}

#[test]
fn a_force_of_time_does_what_the_same_harmonic_does() {
    for w in [0.25, 0.5, 1.7] {
        let mut model = paper(w, 0.0);
        let found = path(&model, 100.0, of_time(|t| 0.8 * (3.0 * t).sin()));
        model.temperature.harmonics.push(Harmonic {
            amplitude: 0.8 / 6.0,
            angular_frequency: 3.0,
            phase: -FRAC_PI_2,
        });
        let mut wanted = exact(&model, 100.0);
        for (here, there) in wanted.states.iter_mut().zip(&found.states) {
            // The temperature lacks the second harmonic.
            here.3 = there.3;
        }
        let off = distance(&found, &wanted);
        println!("w = {w}: {} events, off by {off:e}", found.events.len());
        assert!(off < 1e-9 && found.events.len() > 8, "{w}: {off:e}");
    }
}

/// The body is held at x = -1.2 by b = 1.2 - 0.5 sin t, which begins on the threshold and exceeds
/// it from t = pi on.
#[test]
fn a_stick_on_the_threshold_lasts_while_the_force_moves_inwards() {
    let found = path(&unforced(-1.2, 1.2, 1.0), 4.0, of_time(|t| -0.5 * t.sin()));
    assert_eq!(found.events.len(), 1, "{found:?}");
    assert!(
        (found.events[0].time - PI).abs() < 1e-14 && found.events[0].force == 1.2,
        "{found:?}"
    );
    let outwards = path(&unforced(-1.2, 1.2, 1.0), 1.0, of_time(|t| 0.5 * t.sin()));
    assert!(outwards.events[0].time < 1e-7, "{outwards:?}");
}

/// b = 1.2 sin(1/(2 - t)) reaches f_s = 1.2 - h only near its maximum at 1/(2 - t) = pi/2, for a
/// time of order sqrt(h).
#[test]
fn a_short_excess_of_the_force_is_found() {
    for h in [1e-3, 1e-6, 1e-9] {
        let found = path(
            &unforced(0.0, 1.2 - h, 1.0),
            1.5,
            of_time(|t| 1.2 * (1.0 / (2.0 - t)).sin()),
        );
        let time = 2.0 - 1.0 / (1.0 - h / 1.2).asin();
        assert!(
            (found.events[0].time - time).abs() < 1e-10,
            "{h}: {found:?}"
        );
        let missed = path(
            &unforced(0.0, 1.2 + h, 1.0),
            1.5,
            of_time(|t| 1.2 * (1.0 / (2.0 - t)).sin()),
        );
        assert_eq!(missed.events, [], "{h}");
    }
}

#[test]
fn a_path_that_is_not_a_number_or_takes_too_long_is_lost() {
    let mut seen = OnePath::default();
    let from_one = of_time(|t| if t < 1.0 { 10.0 } else { f64::NAN });
    let mut cascade = general(&paper(0.25, 0.0), 3.0, from_one);
    assert_eq!(cascade.simulate(2, &mut seen).lost, [0, 1]);
    assert!(
        seen.states.len() == 10 && seen.states[9].1.is_nan() && !seen.states[1].1.is_nan(),
        "{seen:?}"
    );
    let explodes = constant_in_time(|x, _| x * x * x * x * x);
    assert_eq!(
        general(&paper(0.25, 0.0), 3.0, explodes)
            .simulate(1, &mut ())
            .lost,
        [0]
    );
    cascade = general(&paper(0.25, 0.0), 60.0, nothing());
    cascade.work_limit = 1000;
    let simulated = cascade.simulate(1, &mut ());
    assert_eq!((simulated.lost, simulated.evaluations), (vec![0], 1000));
}

#[test]
fn long_runs_keep_their_digits() {
    let line = Timeline {
        end: 1e5,
        output_step: 1e5,
        period: None,
        after: 0.0,
    };
    let model = paper(0.25, 0.0);
    let mut wanted = OnePath::default();
    Noiseless::new(&model, &line).simulate(1, &mut wanted);
    for (name, g) in [
        ("constant", nothing()),
        ("of time", of_time(|_| 0.0)),
        ("rounded", of_time(|t| 1e-30 * t.sin())),
    ] {
        let (found, evaluations) = path_at(&GeneralNoiseless::new(
            &Problem {
                force: Some(g),
                ..model.clone()
            },
            &line,
        ));
        let off = distance(&found, &wanted);
        println!("{name}: {off:e}, {evaluations} evaluations");
        assert!(off < 1e-9, "{name}: {off:e}");
    }
}

/// Without friction a stick ends at once. At t = 0, b = 6 cos t/4 - 6 is zero and about to fall.
#[test]
fn a_body_in_balance_without_friction_follows_the_force() {
    let mut model = paper(0.25, 0.0);
    model.friction = Friction {
        static_force: 0.0,
        dynamic_force: 0.0,
    };
    for g in [nothing(), of_time(|_| 0.0)] {
        let found = path(&model, 10.0, g);
        let (t, x, ..) = *found.states.last().expect("a state");
        // x'' + x = 6 cos t/4.
        let wanted = 6.4 * (0.25 * t).cos() - 0.4 * t.cos();
        assert!((x - wanted).abs() < 1e-6, "{x} {wanted}");
    }
}

/// A load and a force that change for microseconds move a body at rest in the same way at any time,
/// up to the rounding of the time, and take few evaluations.
#[test]
fn a_steep_pulse_has_the_same_effect_at_any_time() {
    for (width, fall, f_d, force) in [
        (3.572e-6, 1.0, 1.2, "30*a"),
        (3.367e-5, 0.7, 0.3, "30*a"),
        (1e-4, 0.9, 1.0, "30*a"),
        // The load alone changes, under a force that is less than friction.
        (3.572e-6, 1.0, 1.1, "1"),
        (1e-4, 0.9, 1.15, "1"),
    ] {
        let events = |at: f64| {
            let pulse = |expression: &str| {
                let times = vec![0.0, at - width, at, at + width, 2.0 * at];
                let series = Series::new(times, vec![0.0, 0.0, 1.0, 0.0, 0.0]).expect("a series");
                let input = NamedSeries {
                    name: "a".into(),
                    series: Arc::new(series),
                };
                Force::new(
                    Expression::with_inputs(expression, &[], &[input]).expect("an expression"),
                )
            };
            let mut model = unforced(0.0, 1.2, f_d);
            model.oscillator.damping = 0.3;
            let [load, own] =
                [format!("max(0, 1 - {fall}*a)"), force.into()].map(|text| pulse(&text));
            let both = Force::with_friction(
                [own.clone(), own],
                Some([load.clone(), load]),
                [model.friction; 2],
            );
            let (found, evaluations) = path_at(&general(&model, at + 1.0, both));
            println!(
                "{width} at {at}: {evaluations} evaluations, {:?}",
                found.events
            );
            assert!(evaluations < 200_000, "{evaluations}");
            found.events
        };
        let wanted = events(1.0);
        assert_eq!(wanted.len(), 2, "{wanted:?}");
        for at in [1e3, 1e4, 3e4] {
            let found = events(at);
            assert_eq!(found.len(), 2, "{found:?}");
            for (a, b) in found.iter().zip(&wanted) {
                let off = (a.time - at) - (b.time - 1.0);
                assert!(off.abs() < 1e-9 && a.kind == b.kind, "{a:?} {b:?}");
                assert!(
                    (a.displacement - b.displacement).abs() <= 1e-4 * b.displacement.abs(),
                    "{a:?} {b:?}"
                );
            }
        }
    }
}
