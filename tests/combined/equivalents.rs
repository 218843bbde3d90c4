//! Two ways to write one scene give one motion: with a force g of no size, a load of 1, or the
//! temperature as a force; in a mirror, in other units, from a later start; in two parts of time.

use super::scene::{STEP, Scene, all, ask};
use super::views::Units;
use crate::common::Keep;
use stickslip::model::{Event, EventKind, Sign};
use stickslip::scheme::{Kind, Simulate as _, Timeline};
use stickslip::stats::{
    Densities, DensityCurve, PassageLevels, Record, RunTotals, Statistic, Summary,
};

/// The events and rows of these paths.
pub fn keep(scene: &Scene, paths: &[u64], output_step: f64) -> Keep {
    let scenario = scene.scenario();
    let timeline = Timeline {
        output_step,
        ..scenario.timeline()
    };
    let mut keep = Keep::lanes(paths.len());
    let simulation = scenario.scheme.simulation(&scenario.model, &timeline);
    let lost = simulation.simulate(scenario.ensemble.seed, paths, &mut keep);
    assert!(lost.is_empty(), "{}: no path diverges", scene.name);
    keep
}

pub fn events(scene: &Scene) -> Vec<Event> {
    keep(scene, &[0], scene.output_step).events.remove(0)
}

/// What is reported of these paths from a time on.
fn summary(scene: &Scene, after: f64) -> Summary {
    reported(scene, after, false)
}

fn reported(scene: &Scene, after: f64, density: bool) -> Summary {
    let mut scenario = scene.scenario();
    scenario.statistics.after = after;
    scenario.record = Record {
        laws: true,
        energy: true,
        density,
        levels: PassageLevels::of(&[1.0]),
        ..Record::NOTHING
    };
    // Not as a run, which would search for a cycle, too.
    let plan = scenario.plan();
    let mut totals = RunTotals::empty(plan.model(), plan.timeline(), &plan.record);
    totals.push(0, plan.block(0).totals).expect("once");
    totals.totals().summary()
}

fn values(summary: &Summary, of: &[Statistic]) -> Vec<f64> {
    of.iter()
        .map(|statistic| summary.estimate(*statistic).estimate)
        .collect()
}

const WORKS: [Statistic; 6] = [
    Statistic::FrictionWorkMean,
    Statistic::TemperatureWorkMean,
    Statistic::DampingWorkMean,
    Statistic::UserForceWorkMean,
    Statistic::StoredEnergyMean,
    Statistic::EnergyResidualMean,
];

/// The work of friction and of damping, and the largest speed, which do not depend on which force
/// is called what.
const OF_MOTION: [Statistic; 6] = [
    Statistic::FrictionWorkMean,
    Statistic::DampingWorkMean,
    Statistic::LargestSpeedMean,
    Statistic::LargestDisplacementMean,
    Statistic::DisplacementEndMean,
    Statistic::StickingFraction,
];

/// What a linear force does is in the works of g, or in those of spring and damping if it is part of
/// these; so is the energy that a step creates.
const CALLED_OTHERWISE: [Statistic; 5] = [
    Statistic::DampingWorkMean,
    Statistic::UserForceWorkMean,
    Statistic::StoredEnergyMean,
    Statistic::EnergyResidualMean,
    Statistic::EnergyResidualSd,
];

/// What depends on the way of the body. With a load it is summed step by step, and otherwise from
/// event to event. A turn of `corrected-vi` is one step late, when the body has come back by h |x'|.
const OF_WAYS: [Statistic; 4] = [
    Statistic::FrictionWorkMean,
    Statistic::SlidingPathRate,
    Statistic::EnergyResidualMean,
    Statistic::EnergyResidualSd,
];

/// Events of one kind after the other, each at one time, place and force within this share of 1.
#[track_caller]
pub fn assert_alike(name: &str, found: &[Event], wanted: &[Event], within: f64) {
    let kinds = |events: &[Event]| events.iter().map(|event| event.kind).collect::<Vec<_>>();
    assert_eq!(kinds(found), kinds(wanted), "{name}: {found:?}\n{wanted:?}");
    for (a, b) in found.iter().zip(wanted) {
        let offs = [
            a.time - b.time,
            a.displacement - b.displacement,
            a.force - b.force,
        ];
        let sizes = [b.time, b.displacement, b.force];
        for (off, size) in offs.iter().zip(sizes) {
            assert!(
                off.abs() <= within * (1.0 + size.abs()),
                "{name}: {a:?} {b:?}"
            );
        }
    }
}

/// Values within this share of 1 and of their own size; energies also of the work of friction.
#[track_caller]
fn assert_same_values(name: &str, of: &[Statistic], [a, b]: [&Summary; 2], within: f64) {
    let friction = b.estimate(Statistic::FrictionWorkMean).estimate.abs();
    for (statistic, (a, b)) in of.iter().zip(values(a, of).into_iter().zip(values(b, of))) {
        let is_energy = statistic.dimension() == Statistic::FrictionWorkMean.dimension();
        let size = 1.0 + b.abs() + if is_energy { friction } else { 0.0 };
        let are_same = (a.is_nan() && b.is_nan()) || (a - b).abs() <= within * size;
        assert!(are_same, "{name}: {} is {a:e} and {b:e}", statistic.name());
    }
}

/// Schemes that integrate any force. Under noise, the events of `event-driven` with a nonlinear
/// force are those of other random numbers, so that it is asked without noise.
fn under_any_force(scene: &Scene) -> impl Iterator<Item = Scene> {
    [Kind::EventDriven, Kind::DiscreteVi, Kind::CorrectedVi]
        .into_iter()
        .filter_map(move |kind| {
            let scene = if kind == Kind::EventDriven {
                &scene.without_noise()
            } else {
                scene
            };
            scene.with_constant_friction().in_scheme(kind)
        })
}

/// A force of no size and a load of 1 leave every event, work and speed where the linear force
/// leaves them, though another part of the program computes them. The schemes with a step give the
/// same bits, unless the linear force is then no part of the spring.
#[test]
fn a_force_of_no_size_and_a_load_of_one_change_nothing() {
    ask(|scene| {
        for plain in under_any_force(scene) {
            for more in [
                [Some("-1e-30*x^3".into()), None],
                [None, Some("(1 + 0*x)".into())],
            ] {
                let what = format!("{}, {more:?}", plain.name);
                let other = Scene {
                    more,
                    ..plain.clone()
                };
                let within = match plain.scheme.has_step() && other.is_linear() == plain.is_linear()
                {
                    true => 0.0,
                    false => 1e-9,
                };
                assert_alike(&what, &events(&other), &events(&plain), within);
                let both = [&summary(&other, plain.after), &summary(&plain, plain.after)];
                let is_joined = other.is_linear() != plain.is_linear();
                let is_of_ways = plain.scheme == Kind::CorrectedVi && what.contains("(1 + 0*x)");
                let of: Vec<Statistic> = Statistic::ALL
                    .into_iter()
                    .filter(|of| !(is_joined && CALLED_OTHERWISE.contains(of)))
                    .filter(|of| !(is_of_ways && OF_WAYS.contains(of)))
                    .collect();
                assert_same_values(&what, &of, both, within.max(1e-12));
            }
        }
    });
}

/// A temperature written out as a force moves the body as the temperature does: each harmonic with
/// its phase, the line, and the series, which becomes an input.
#[test]
fn the_temperature_written_as_a_force_moves_the_body_alike() {
    ask(|scene| {
        for plain in under_any_force(scene) {
            let mut terms = vec![format!("{:?} + {:?}*t", plain.offset, plain.trend)];
            terms.extend(
                plain
                    .harmonics
                    .iter()
                    .map(|[a, w, phase]| format!("{a:?}*cos({w:?}*t + {phase:?})")),
            );
            terms.extend(plain.series.iter().map(|_| "s".to_string()));
            let force = Scene {
                more: [
                    Some(format!("{:?}*({})", plain.gain(), terms.join(" + "))),
                    None,
                ],
                offset: 0.0,
                trend: 0.0,
                harmonics: Vec::new(),
                input: plain.series.clone(),
                series: None,
                ..plain.clone()
            };
            let name = &plain.name;
            assert_alike(name, &events(&force), &events(&plain), 1e-9);
            let both = [&summary(&force, plain.after), &summary(&plain, plain.after)];
            let same = |of: &&Statistic| {
                **of != Statistic::DampingWorkMean || force.is_linear() == plain.is_linear()
            };
            let of: Vec<Statistic> = OF_MOTION.iter().filter(same).copied().collect();
            assert_same_values(name, &of, both, 1e-9);
        }
    });
}

/// The energies of the schemes without a step balance.
#[test]
fn energies_balance_for_every_damping() {
    ask(|scene| {
        for scheme in [Kind::EventDriven, Kind::QuasiStatic] {
            for scene in [scene.clone(), scene.without_noise()] {
                let Some(scene) = scene.in_scheme(scheme) else {
                    continue;
                };
                let works = values(&summary(&scene, scene.after), &WORKS);
                let [friction, .., residual] = works[..] else {
                    panic!("six works");
                };
                // A body that stays where it is takes and gives nothing.
                let is_at_rest = friction == 0.0 && residual == 0.0;
                assert!(
                    is_at_rest || residual.abs() < 1e-9 * friction,
                    "{}: {works:?}",
                    scene.name
                );
            }
        }
    });
}

/// The time below an edge, as a share.
fn below(curve: &DensityCurve, edge: f64) -> f64 {
    let bins = curve.edges.windows(2).zip(&curve.density);
    bins.filter(|(pair, _)| pair[1] <= edge)
        .map(|(pair, density)| density * (pair[1] - pair[0]))
        .sum()
}

fn densities(summary: &Summary) -> &Densities {
    summary.densities.as_ref().expect("asked for")
}

/// What is counted from a time on and what is counted until then are together what is counted in the
/// whole time of the same path: works, times at rest and the times below every edge of a bin. A step
/// is counted or not as it is at the nearest of its multiples.
#[test]
fn totals_are_additive_over_time() {
    ask(|scene| {
        for scene in scene.in_each_scheme() {
            let Scene { name, end, .. } = &scene;
            let between = 5.1731;
            let nearest = match scene.scheme.has_step() {
                true => (between / STEP).round() * STEP,
                false => between,
            };
            let until = Scene {
                end: nearest,
                ..scene.clone()
            };
            let [whole, first] = [reported(&scene, 0.0, true), reported(&until, 0.0, true)];
            let second = reported(&scene, nearest, true);
            let lengths = [*end, nearest, end - nearest];
            let scale = values(&whole, &WORKS)
                .iter()
                .map(|work| work.abs())
                .sum::<f64>();
            let works = [&whole, &first, &second].map(|summary| values(summary, &WORKS));
            for (i, statistic) in WORKS.iter().enumerate() {
                let off = works[0][i] - works[1][i] - works[2][i];
                assert!(
                    off.abs() <= 1e-12 * scale,
                    "{name}: {} is off by {off:e} of {scale}",
                    statistic.name()
                );
            }
            let again = values(&summary(&scene, between), &WORKS);
            assert_eq!(again, works[2], "{name}: from {between}");
            let apart = |of: &dyn Fn(&Summary) -> f64| {
                let [whole, first, second] = [(&whole, 0), (&first, 1), (&second, 2)]
                    .map(|(summary, i)| of(summary) * lengths[i]);
                (whole - (first + second)).abs() / end
            };
            let sticking =
                |summary: &Summary| summary.estimate(Statistic::StickingFraction).estimate;
            let off = apart(&sticking);
            assert!(off < 1e-12, "{name}: the time at rest is off by {off:e}");
            let [rest, sticks] = [densities(&second).at_rest, sticking(&second)];
            assert!(
                (rest - sticks).abs() < 1e-9,
                "{name}: {rest} at rest, {sticks} in sticks"
            );
            let curves: [fn(&Summary) -> &DensityCurve; 2] = [
                |summary| &densities(summary).displacement,
                |summary| &densities(summary).velocity,
            ];
            for curve in curves {
                for edge in &curve(&whole).edges {
                    let off = apart(&|summary| below(curve(summary), *edge));
                    assert!(
                        off < 1e-9,
                        "{name}: the time below {edge} is off by {off:e}"
                    );
                }
            }
        }
    });
}

/// A scene, each with and without noise, in each scheme that suits it.
fn with_and_without_noise(scene: &Scene) -> Vec<Scene> {
    let without = scene.without_noise();
    let both = scene
        .is_random()
        .then_some(scene.clone())
        .into_iter()
        .chain([without]);
    both.flat_map(|scene| scene.in_each_scheme().collect::<Vec<_>>())
        .collect()
}

fn other(sign: Sign) -> Sign {
    if sign == Sign::Positive {
        Sign::Negative
    } else {
        Sign::Positive
    }
}

/// In a mirror every path is its mirror image, bit for bit; forces that are not linear are integrated
/// by formulas that are not symmetric in their rounding.
///
/// Under noise, c changes its sign instead of T. The schemes without a step are asked without noise,
/// because the random numbers that decide at which threshold a stick ends have no sign.
#[test]
fn a_mirrored_scene_has_the_mirrored_paths() {
    ask(|scene| {
        for scene in with_and_without_noise(scene) {
            if scene.is_random() && !scene.scheme.has_step() {
                continue;
            }
            let is_integrated = scene.is_general() && scene.scheme == Kind::EventDriven;
            let within = if is_integrated { 1e-12 } else { 0.0 };
            let mirrored = scene.mirrored();
            let paths = [0, 1, 2];
            let here = keep(&scene, &paths, scene.output_step);
            let there = keep(&mirrored, &paths, scene.output_step);
            let turned = |event: &Event| Event {
                kind: match event.kind {
                    EventKind::StickEntered => EventKind::StickEntered,
                    EventKind::SlipStarted(sign) => EventKind::SlipStarted(other(sign)),
                    EventKind::SubPhaseBoundary(sign) => EventKind::SubPhaseBoundary(other(sign)),
                },
                time: event.time,
                displacement: -event.displacement,
                force: -event.force,
            };
            for (a, b) in here.events.iter().zip(&there.events) {
                let b: Vec<Event> = b.iter().map(turned).collect();
                assert_alike(&scene.name, &b, a, within);
            }
            for (a, b) in here.rows.iter().flatten().zip(there.rows.iter().flatten()) {
                let offs = [a.0 - b.0, a.1 + b.1, a.2 + b.2];
                let is_near = offs.iter().all(|off| off.abs() <= 10.0 * within);
                assert!(is_near && a.4 == b.4, "{}: {a:?} {b:?}", scene.name);
            }
        }
    });
}

/// Units that are powers of two; that of time is one of four, so that the root of it is one of two.
const UNITS: [Units; 2] = [
    Units {
        mass: 8.0,
        length: 0.25,
        time: 4.0,
        temperature: 2.0,
    },
    Units {
        mass: 0.5,
        length: 1024.0,
        time: 1.0 / 64.0,
        temperature: 0.125,
    },
];

/// Macro steps have the lengths 1, 2, 2.5 and 5 times a power of ten.
const UNITS_OF_TEN: [Units; 1] = [Units {
    time: 10.0,
    ..UNITS[0]
}];

/// In other units every number is scaled: bit for bit without noise, and to rounding under noise.
#[test]
fn in_other_units_every_number_is_scaled() {
    ask(|scene| {
        for scene in with_and_without_noise(scene) {
            let has_macro_steps = scene.is_random() && !scene.scheme.has_step();
            let all: &[Units] = if has_macro_steps {
                &UNITS_OF_TEN
            } else {
                &UNITS
            };
            // Each scene is seen in one of them.
            let units = all[scene.seed as usize % all.len()];
            // The time of an event has rounding, within which white noise changes the force most.
            let within = match scene.is_random() {
                true if has_macro_steps && scene.white.is_some() => 1e-5,
                true if has_macro_steps => 1e-7,
                true => 1e-9,
                false => 0.0,
            };
            let scaled = scene.scaled(units);
            let paths: &[u64] = if scene.is_random() { &[0, 1, 2] } else { &[0] };
            let here = keep(&scene, paths, scene.output_step);
            let there = keep(&scaled, paths, scaled.output_step);
            for (a, b) in here.events.iter().zip(&there.events) {
                let back = |event: &Event| Event {
                    kind: event.kind,
                    time: event.time / units.time,
                    displacement: event.displacement / units.length,
                    force: event.force / units.force(),
                };
                let b: Vec<Event> = b.iter().map(back).collect();
                assert_alike(&scene.name, &b, a, within);
            }
            let works = [summary(&scene, scene.after), summary(&scaled, scaled.after)];
            let [a, b] = works.each_ref().map(|works| values(works, &WORKS[..5]));
            let energy = units.force() * units.length;
            for (a, b) in a.iter().zip(&b) {
                assert!(
                    (a - b / energy).abs() <= within.clamp(1e-12, 1e-9) * (1.0 + a.abs()),
                    "{}: {a} {}",
                    scene.name,
                    b / energy
                );
            }
        }
    });
}

/// The path without noise from a time in a slip or in a stick on, with the state of then and the
/// forcing that follows, is the rest of the path; so are its works.
#[test]
fn a_path_begun_later_is_the_rest_of_the_path() {
    ask(|scene| {
        for scene in scene.without_noise().in_each_scheme() {
            let found = events(&scene);
            for is_static in [false, true] {
                let Some(start) = middle_of_the_longest(&found, &scene, is_static) else {
                    continue;
                };
                let row = keep(&scene, &[0], start).rows[0][1];
                assert!(
                    row.0 == start && row.4 == is_static,
                    "{}: {row:?}",
                    scene.name
                );
                let later = scene.started_at(start, [row.1, row.2]);
                let rest: Vec<Event> = found
                    .iter()
                    .filter(|event| event.time > start)
                    .copied()
                    .collect();
                let again = events(&later);
                // A body that moves at the start slips from there on.
                let begun = usize::from(!is_static);
                let moved = |event: &Event| Event {
                    time: event.time + start,
                    ..*event
                };
                let again: Vec<Event> = again.iter().skip(begun).map(moved).collect();
                let name = format!("{} from {start}", scene.name);
                assert_alike(&name, &again, &rest, 1e-9);
                let both = [&summary(&later, 0.0), &summary(&scene, start)];
                assert_same_values(&name, &WORKS, both, 1e-9);
                assert_same_values(&name, &[Statistic::StickingFraction], both, 1e-9);
            }
        }
    });
}

/// The middle of the longest stick or sub-phase between two events, in whole steps; none in a slip
/// of a scheme that cannot begin in one.
fn middle_of_the_longest(events: &[Event], scene: &Scene, is_static: bool) -> Option<f64> {
    if scene.scheme == Kind::QuasiStatic && !is_static {
        return None;
    }
    let phases = events.windows(2).filter(|pair| {
        (pair[0].kind == EventKind::StickEntered) == is_static
            && pair[1].time - pair[0].time > 8.0 * STEP
    });
    let length = |pair: &&[Event]| pair[1].time - pair[0].time;
    let longest = phases.max_by(|a, b| length(a).total_cmp(&length(b)))?;
    let middle = 0.5 * (longest[0].time + longest[1].time);
    let step = scene.scheme.has_step().then_some(scene.step);
    Some(step.map_or(middle, |step| (middle / step).round() * step))
}

/// The scenes are worth asking: nearly all of them stick and slip, and turn at some time.
#[test]
fn nearly_all_scenes_stick_and_slip() {
    let mut count = [0; 3];
    for scene in all() {
        let found = events(&scene);
        let has = |kind: fn(&EventKind) -> bool| found.iter().any(|event| kind(&event.kind));
        for (i, is_there) in [
            has(|kind| *kind == EventKind::StickEntered),
            has(|kind| matches!(kind, EventKind::SlipStarted(_))),
            has(|kind| matches!(kind, EventKind::SubPhaseBoundary(_))),
        ]
        .into_iter()
        .enumerate()
        {
            count[i] += usize::from(is_there);
        }
        println!("{}: {} events", scene.name, found.len());
    }
    println!("{count:?} of {}", all().len());
    assert!(
        5 * count[0] > 4 * all().len() && 5 * count[1] > 4 * all().len(),
        "{count:?}"
    );
    assert!(2 * count[2] > all().len(), "{count:?}");
}
