//! A run has the same bits in parts, in sessions, on any number of threads and in any lanes, and
//! its statistics are those of the rows of its paths.

use super::scene::{STEP, Scene, ask};
use crate::common::Keep;
use std::time::Duration;
use stickslip::engine::{Run, SoFar};
use stickslip::ensemble::{BLOCK_SIZE, Plan};
use stickslip::lanes::InstructionSet;
use stickslip::model::{Event, EventKind, Sign};
use stickslip::scenario::Scenario;
use stickslip::scheme::{DiscreteSimulation, Kind, Simulate as _};
use stickslip::stats::{BlockResult, PathColumns, Record, RunTotals, Statistic};

/// Two blocks, the second of which is not full.
const PATHS: u64 = 260;

const RECORD: Record = Record {
    paths: true,
    events: true,
    laws: true,
    ..Record::NOTHING
};

/// The scene in each scheme with noise, for a shorter time.
fn random(scene: &Scene) -> impl Iterator<Item = Scene> {
    let short = Scene {
        end: 2.4,
        after: if scene.after > 0.0 { 0.8137 } else { 0.0 },
        paths: PATHS,
        ..scene.clone()
    };
    let schemes = scene.is_random().then_some(short);
    schemes
        .into_iter()
        .flat_map(|scene| scene.in_each_scheme().collect::<Vec<_>>())
}

fn scenario(scene: &Scene) -> Scenario {
    Scenario {
        record: RECORD,
        ..scene.scenario()
    }
}

fn events_of(block: &BlockResult, lane: usize) -> (Vec<u64>, Vec<i8>) {
    let events = block.rows.events.as_ref().expect("kept");
    let first: u32 = events.count[..lane].iter().sum();
    let range = first as usize..(first + events.count[lane]) as usize;
    let bits = range
        .clone()
        .flat_map(|i| [events.time[i], events.displacement[i], events.force[i]].map(f64::to_bits));
    let kinds = range.clone().flat_map(|i| [events.kind[i], events.sign[i]]);
    (bits.collect(), kinds.collect())
}

/// The whole run is its parts, written and read and merged in another order; it is the run on
/// several threads and in two sessions, and its statistics are those of the rows of its paths; and each path is the path alone, whatever else is recorded
/// of it, on another output grid, and beyond a shorter end.
#[test]
fn a_run_has_the_same_bits_however_it_is_made() {
    ask(|scene| {
        for scene in random(scene) {
            let name = &scene.name;
            let scenario = scenario(&scene);
            let plan = scenario.plan();
            let blocks = [plan.block(0), plan.block(1)];
            let empty = || RunTotals::empty(plan.model(), plan.timeline(), &plan.record);
            let part = |k: usize| {
                let mut part = empty();
                part.push(k as u64, blocks[k].totals.clone()).expect("once");
                part
            };
            let mut merged = empty().read(&part(1).to_bytes()).expect("as written");
            merged.merge(part(0)).expect("apart");
            let text = |totals: &RunTotals| format!("{:?}", totals.totals().summary());
            let whole = Run::of(&scenario).threads(3).without_bias().simulate();
            let whole = format!("{:?}", whole.expect("no sink fails").summary);
            assert_eq!(text(&merged), whole, "{name}: merged");
            let so_far = SoFar {
                totals: part(0),
                spent: Duration::ZERO,
            };
            let resumed = Run::of(&scenario).threads(1).without_bias().go_on(so_far);
            let resumed = format!("{:?}", resumed.expect("no sink fails").summary);
            assert_eq!(resumed, whole, "{name}: resumed");
            assert_statistics(&scene, &merged, &blocks);
            for path in [0, 255, 257] {
                let (block, lane) = (&blocks[(path / BLOCK_SIZE) as usize], path % BLOCK_SIZE);
                let wanted = events_of(block, lane as usize);
                let alone = plan.replay(path);
                assert_eq!(events_of(&alone, 0), wanted, "{name}: path {path} alone");
                let row = |of: &BlockResult, lane: usize| {
                    let columns = of.rows.path_columns.as_ref().expect("kept");
                    [columns.displacement_end[lane], columns.friction_work[lane]].map(f64::to_bits)
                };
                assert_eq!(
                    row(&alone, 0),
                    row(block, lane as usize),
                    "{name}: path {path} alone"
                );
                assert_events_stay(&scene, &scenario, path, &wanted);
            }
        }
    });
}

/// The events of a path do not depend on what is recorded, on the output grid, or on the end.
///
/// Under noise, the macro steps of `event-driven` are cut at the peaks of a force or a load in t until
/// the end, so that its last macro steps before the end are not those of a longer run.
fn assert_events_stay(scene: &Scene, scenario: &Scenario, path: u64, wanted: &(Vec<u64>, Vec<i8>)) {
    let replayed = |scenario: &Scenario| events_of(&scenario.plan().replay(path), 0);
    let mut followed = scenario.clone();
    (followed.record.energy, followed.record.density) = (true, true);
    assert_eq!(
        replayed(&followed),
        *wanted,
        "path {path} with its energies"
    );
    let mut coarser = scenario.clone();
    coarser.time.output_step = if scenario.time.output_step > 1.0 {
        0.35
    } else {
        3.0
    };
    assert_eq!(replayed(&coarser), *wanted, "path {path} on another grid");
    let mut shorter = scenario.clone();
    shorter.time.end = 1.77;
    let (mut bits, mut kinds) = replayed(&shorter);
    let before = |bits: &[u64], time: f64| {
        let times = bits.chunks(3).map(|event| f64::from_bits(event[0]));
        times.take_while(|t| *t <= time).count()
    };
    let has_cuts = scene.is_general() && scene.scheme == Kind::EventDriven;
    let last = if has_cuts { 0.8 } else { 1.77 };
    let until = before(&wanted.0, last);
    let found = before(&bits, last);
    bits.truncate(3 * found);
    kinds.truncate(2 * found);
    // A step reports the end of a stick at its beginning, when it is known.
    let missing = until - kinds.len() / 2;
    assert!(
        missing <= usize::from(scenario.scheme.step().is_some()),
        "path {path}: {missing}"
    );
    assert_eq!(bits, wanted.0[..bits.len()], "path {path} to a shorter end");
    assert_eq!(
        kinds,
        wanted.1[..kinds.len()],
        "path {path} to a shorter end"
    );
}

/// Every instruction set gives the same bits.
#[test]
fn every_lane_has_the_same_bits() {
    ask(|scene| {
        for scheme in [Kind::DiscreteVi, Kind::CorrectedVi] {
            let scene = Scene {
                end: 4.0,
                ..scene.in_scheme(scheme).expect("suits")
            };
            let scenario = scene.scenario();
            // Whole groups of registers, single registers, and a part of a register.
            let paths: Vec<u64> = (0..45).collect();
            let kept = |set: InstructionSet| {
                let mut keep = Keep::lanes(paths.len());
                let make = match scheme {
                    Kind::CorrectedVi => DiscreteSimulation::corrected,
                    _ => DiscreteSimulation::new,
                };
                let simulation = make(&scenario.model, &scenario.timeline(), STEP);
                let lost = simulation
                    .with_instructions(set)
                    .simulate(scene.seed, &paths, &mut keep);
                assert!(lost.is_empty());
                keep
            };
            let portable = kept(InstructionSet::Portable);
            for set in InstructionSet::ALL
                .into_iter()
                .filter(|set| set.is_available())
            {
                assert!(kept(set) == portable, "{}: {}", scene.name, set.name());
            }
        }
    });
}

/// A phase of a path: its begin and end, whether it ended by then, and its sub-phases, none in a
/// stick.
struct Phase {
    begin: f64,
    end: f64,
    is_complete: bool,
    sub_phases: u32,
}

fn phases(events: &[Event], is_moving: bool, end: f64) -> Vec<Phase> {
    let phase = |begin: f64, sub_phases: u32| Phase {
        begin,
        end,
        is_complete: false,
        sub_phases,
    };
    let mut phases: Vec<Phase> = Vec::new();
    if !is_moving {
        phases.push(phase(0.0, 0));
    }
    for event in events {
        let last = phases.last_mut();
        if let EventKind::SubPhaseBoundary(_) = event.kind {
            last.expect("a slip").sub_phases += 1;
            continue;
        }
        if let Some(last) = last {
            (last.end, last.is_complete) = (event.time, true);
        }
        phases.push(phase(
            event.time,
            u32::from(event.kind != EventKind::StickEntered),
        ));
    }
    phases
}

/// What is recorded of a path follows from its events and from x at the end of the burn-in and of
/// the path: sticks and slips that begin after the burn-in, and times and ways from there on.
#[test]
fn the_row_of_a_path_follows_from_its_events() {
    ask(|scene| {
        for scene in random(scene) {
            let scenario = scenario(&scene);
            let Plan {
                simulation, seed, ..
            } = scenario.plan();
            let numbers = [0, 3, 4, 9];
            let mut timeline = scenario.timeline();
            timeline.output_step = if scene.after > 0.0 {
                scene.after
            } else {
                scene.end
            };
            let mut keep = Keep::lanes(4);
            assert!(simulation.simulate(seed, &numbers, &mut keep).is_empty());
            let mut ends = Keep::lanes(4);
            let at_ends = scenario.scheme.simulation(&scenario.model, &timeline);
            assert!(at_ends.simulate(seed, &numbers, &mut ends).is_empty());
            let plan = Plan {
                antithetic: false,
                ..scenario.plan()
            };
            for (lane, path) in numbers.into_iter().enumerate() {
                let name = format!("{}, path {path}", scene.name);
                let columns = plan.replay(path).rows.path_columns.expect("kept");
                let events = &keep.events[lane];
                assert_row(&scene, &name, events, &columns);
                if !scene.has_sides() {
                    // The first row is at t = 0, and that at the end of the burn-in is the second.
                    let from = usize::from(scene.after > 0.0);
                    let (start, x) = (ends.rows[lane][from].0, ends.rows[lane][from].1);
                    let later = events.iter().filter(|event| event.time > start);
                    let mut places = vec![x];
                    places.extend(later.map(|event| event.displacement));
                    places.push(columns.displacement_end[0]);
                    let way: f64 = places.windows(2).map(|two| (two[1] - two[0]).abs()).sum();
                    let work = scene.friction[0][1] * way;
                    assert!(
                        (columns.friction_work[0] - work).abs() < 1e-9,
                        "{name}: {work}"
                    );
                }
            }
        }
    });
}

fn assert_row(scene: &Scene, name: &str, events: &[Event], columns: &PathColumns) {
    let (after, end) = (scene.after, scene.end);
    let all = phases(events, scene.v0 != 0.0, end);
    let first = usize::from(scene.v0 == 0.0);
    let counted = |is_stick: bool| {
        let begun = all
            .iter()
            .skip(first)
            .filter(move |phase| phase.begin >= after);
        begun.filter(move |phase| phase.is_complete && (phase.sub_phases == 0) == is_stick)
    };
    assert_eq!(columns.sticks[0] as usize, counted(true).count(), "{name}");
    assert_eq!(columns.slips[0] as usize, counted(false).count(), "{name}");
    let sub_phases: u32 = counted(false).map(|phase| phase.sub_phases).sum();
    assert_eq!(columns.sub_phases[0], sub_phases, "{name}");
    let sticks = all.iter().filter(|phase| phase.sub_phases == 0);
    let time: f64 = sticks
        .map(|phase| (phase.end - phase.begin.max(after)).max(0.0))
        .sum();
    assert!(
        (columns.stick_time[0] - time).abs() < 1e-9,
        "{name}: {time}"
    );
    let first = all
        .first()
        .filter(|phase| scene.v0 == 0.0 && phase.is_complete);
    let duration = first.map_or(f64::NAN, |phase| phase.end - phase.begin);
    let found = columns.first_stick_duration[0];
    assert!(
        found == duration || (found.is_nan() && duration.is_nan()),
        "{name}: {found}"
    );
    let places = events.iter().map(|event| event.displacement);
    let farthest = places.chain([scene.x0, columns.displacement_end[0]]);
    let farthest = farthest.fold(0.0, |most: f64, x| most.max(x.abs()));
    assert!(
        (columns.max_displacement[0] - farthest).abs() < 1e-9,
        "{name}: {farthest}"
    );
}

/// Means over paths and over phases, and the errors of those over paths, are those of the rows of all
/// paths; the unit of the error is the path, or the pair of antithetic paths, of which the second has
/// the noise of the first with the other sign. The mean of T is that of its formula.
///
/// Null hypothesis of the last: the mean over all paths is within 5 standard errors of E T(t), which
/// a normal number misses once in 1.7 million; about 600 rows are compared. Noise that stands still
/// or a lost term of T is off by much more.
fn assert_statistics(scene: &Scene, totals: &RunTotals, blocks: &[BlockResult]) {
    let mut columns = vec![Vec::new(); 6];
    for block in blocks {
        let of = block.rows.path_columns.as_ref().expect("kept");
        columns[0].extend(&of.displacement_end);
        columns[1].extend(of.sticks.iter().map(|n| f64::from(*n)));
        columns[2].extend(of.slips.iter().map(|n| f64::from(*n)));
        columns[3].extend(&of.friction_work);
        columns[4].extend(of.stick_time.iter().map(|t| t / (scene.end - scene.after)));
        columns[5].extend(of.sub_phases.iter().map(|n| f64::from(*n)));
    }
    let summary = totals.totals().summary();
    let one = vec![1.0; PATHS as usize];
    let slips = columns[2].clone();
    for (statistic, column, over) in [
        (Statistic::DisplacementEndMean, 0, &one),
        (Statistic::SticksPerPath, 1, &one),
        (Statistic::SlipsPerPath, 2, &one),
        (Statistic::FrictionWorkMean, 3, &one),
        (Statistic::StickingFraction, 4, &one),
        (Statistic::SubPhasesMean, 5, &slips),
    ] {
        let [ratio, error] = ratio(&columns[column], over, scene.is_antithetic);
        let found = summary.estimate(statistic);
        let what = format!("{}: {}", scene.name, statistic.name());
        assert_close(&what, found.estimate, ratio);
        // With few phases there is no error, and that of a ratio is larger than to first order.
        let is_ratio = statistic == Statistic::SubPhasesMean;
        if found.standard_error.is_finite() && !is_ratio {
            assert_close(&what, found.standard_error, error);
        }
    }
    let bands = &summary.bands;
    let every = bands.time.len().div_ceil(5);
    for (row, t) in bands.time.iter().enumerate().step_by(every) {
        let temperature = &bands.temperature;
        let error = temperature.sd[row] / (PATHS as f64).sqrt();
        let off = (temperature.mean[row] - scene.mean_temperature(*t)).abs();
        assert!(
            off <= 5.0 * error + 1e-9,
            "{}: T({t}) is off by {off}",
            scene.name
        );
    }
}

#[track_caller]
fn assert_close(what: &str, found: f64, wanted: f64) {
    let are_none = found.is_nan() && !wanted.is_finite();
    assert!(
        are_none || (found - wanted).abs() <= 1e-9 * (wanted.abs() + 1e-3),
        "{what}: {found}, not {wanted}"
    );
}

/// The mean of some numbers of all paths over that of others, and its error by the delta method.
fn ratio(parts: &[f64], wholes: &[f64], is_paired: bool) -> [f64; 2] {
    let units = |of: &[f64]| -> Vec<f64> {
        of.chunks(if is_paired { 2 } else { 1 })
            .map(|unit| unit.iter().sum())
            .collect()
    };
    let (parts, wholes) = (units(parts), units(wholes));
    let (sum, whole): (f64, f64) = (parts.iter().sum(), wholes.iter().sum());
    let ratio = sum / whole;
    let squares: f64 = parts
        .iter()
        .zip(&wholes)
        .map(|(part, whole)| (part - ratio * whole).powi(2))
        .sum();
    let n = parts.len() as f64;
    [ratio, (squares * n / (n - 1.0)).sqrt() / whole]
}

/// Path 2k of a pair is path 2k without pairs, and the noise of path 2k + 1 is that of path 2k with
/// the other sign, at the ends of steps and of macro steps.
#[test]
fn the_second_path_of_a_pair_has_the_mirrored_noise() {
    ask(|scene| {
        for scene in random(scene) {
            let scene = Scene {
                is_antithetic: true,
                ..scene
            };
            let scenario = scenario(&scene);
            let paired = scenario.plan();
            let single = Plan {
                antithetic: false,
                ..scenario.plan()
            };
            let of = |plan: &Plan, path: u64| events_of(&plan.replay(path), 0);
            assert_eq!(of(&paired, 4), of(&single, 4), "{}", scene.name);
            if scene.scheme.has_step() {
                let mut keep = Keep::lanes(2);
                let numbers = stickslip::ensemble::drawn(&[4, 5], true);
                let lost = paired.simulation.simulate(paired.seed, &numbers, &mut keep);
                assert!(lost.is_empty());
                for (a, b) in keep.rows[0].iter().zip(&keep.rows[1]) {
                    let off = a.3 + b.3 - 2.0 * scene.mean_temperature(a.0);
                    assert!(off.abs() < 1e-6, "{}: {a:?} {b:?}", scene.name);
                }
            }
        }
    });
}

/// No slip starts against friction: the force that is to move the body exceeds the dynamic friction
/// of its direction, with any load, and the body moves in the direction of its slip.
#[test]
fn no_slip_starts_against_friction() {
    ask(|scene| {
        for scheme in [Kind::EventDriven, Kind::DiscreteVi, Kind::CorrectedVi] {
            let scene = scene.in_scheme(scheme).expect("suits");
            let kept = super::equivalents::keep(&scene, &[0, 1], STEP);
            for event in kept
                .events
                .iter()
                .flatten()
                .filter(|event| event.time > 0.0)
            {
                let EventKind::SlipStarted(sign) = event.kind else {
                    continue;
                };
                let e = if sign == Sign::Positive { 1.0 } else { -1.0 };
                let (x, t) = (event.displacement, event.time);
                // Events report the mean of g over both directions.
                let mean = 0.5 * (scene.own(1.0, x, 0.0, t) + scene.own(-1.0, x, 0.0, t));
                let b = event.force - mean + scene.own(e, x, 0.0, t);
                let friction = scene.friction[usize::from(e < 0.0)][1] * scene.load(e, x, 0.0, t);
                assert!(
                    e * b > friction * (1.0 - 1e-9),
                    "{}: {event:?}, {friction}",
                    scene.name
                );
            }
        }
    });
}
