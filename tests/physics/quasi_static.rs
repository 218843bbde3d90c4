//! The quasi-static scheme with damping compared with the event-driven scheme, which does not
//! assume that the temperature stands still during a slip.
//!
//! Unless a test says otherwise, the parameters are those of set (P) of the paper: m = K = w0 = 1,
//! beta a = 6, f_s - f_d = 0.2, so that zeta is alpha. Statistical tests have fixed seeds; each
//! states its null hypothesis, sample size and false-alarm rate.

use crate::common::{Keep, estimate, event_driven_summary, paper, summary_of, timeline};
use std::f64::consts::{PI, TAU};
use stickslip::model::*;
use stickslip::scheme::{
    DEFAULT_TOLERANCE, EventDrivenSimulation, QuasiStaticSimulation, Simulate as _, Timeline,
};
use stickslip::stats::{Statistic, Summary};

/// A bearing with this damping ratio. x0 is 5.9, because from 6 jumps of 0.4 would meet the
/// extremum of the forcing to the last digit.
fn damped(zeta: f64, w: f64) -> Problem {
    let mut model = paper(w, 0.0);
    model.oscillator.damping = zeta;
    model.initial_displacement = 5.9;
    model
}

/// The duration of a slip and the overshoot q: pi/w_d and e^{-pi zeta/sqrt(1 - zeta^2)}. At zeta =
/// 1.5 the duration is the settling time, where 1.1708 e^{-0.38197 r} = 1e-3.
fn swing(zeta: f64) -> (f64, f64) {
    if zeta < 1.0 {
        let root = (1.0 - zeta * zeta).sqrt();
        (PI / root, (-PI * zeta / root).exp())
    } else {
        assert_eq!(zeta, 1.5);
        (18.4976, 0.0)
    }
}

/// The completed slips of one path: their number, mean |jump| and mean duration.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slips {
    count: usize,
    jump: f64,
    duration: f64,
}

fn kept(model: &Problem, line: &Timeline, is_quasi_static: bool) -> Keep {
    let mut keep = Keep::lanes(1);
    let failed = if is_quasi_static {
        QuasiStaticSimulation::new(model, line, DEFAULT_TOLERANCE).simulate(1, &[0], &mut keep)
    } else {
        EventDrivenSimulation::new(model, line, DEFAULT_TOLERANCE).simulate(1, &[0], &mut keep)
    };
    assert!(failed.is_empty());
    keep
}

/// The slips in two periods of the forcing, event-driven and quasi-static.
fn slips(model: &Problem) -> [Slips; 2] {
    let end = 2.0 * TAU / model.temperature.harmonics[0].angular_frequency;
    [false, true].map(|is_quasi_static| {
        let events = kept(model, &timeline(end, end), is_quasi_static)
            .events
            .remove(0);
        let pairs: Vec<_> = events
            .windows(2)
            .filter(|pair| pair[1].kind == EventKind::StickEntered)
            .collect();
        let mean = |f: &dyn Fn(&[Event]) -> f64| {
            pairs.iter().map(|pair| f(pair)).sum::<f64>() / pairs.len() as f64
        };
        assert!(
            pairs
                .iter()
                .all(|pair| matches!(pair[0].kind, EventKind::SlipStarted(_))),
            "one sub-phase a slip"
        );
        Slips {
            count: pairs.len(),
            jump: mean(&|pair| (pair[1].displacement - pair[0].displacement).abs()),
            duration: mean(&|pair| pair[1].time - pair[0].time),
        }
    })
}

/// With a constant temperature nothing is approximated. x, x' and the events of both schemes agree
/// to the 1e-12 by which the force starts above f_s (2e-11 relative to f_s - f_d), for m and K
/// other than 1, in both directions and with any damping.
#[test]
fn at_constant_temperature_both_schemes_make_the_same_slip() {
    let (mass, stiffness, gap) = (0.5, 3.0, 0.2);
    let w0 = f64::sqrt(stiffness / mass);
    for (zeta, side) in [0.0, 0.05, 0.3, 0.9, 1.5]
        .into_iter()
        .flat_map(|zeta| [(zeta, 1.0), (zeta, -1.0)])
    {
        let mut model = damped(zeta, 1.0);
        model.oscillator = Oscillator {
            mass,
            stiffness,
            damping: zeta * mass * w0,
            drive: Drive::Dilatation(6.0),
        };
        model.temperature.harmonics.clear();
        model.initial_displacement = -side * 1.2 * (1.0 + 1e-12) / stiffness;
        let (lasts, overshoot) = swing(zeta);
        let lasts = lasts / w0;
        let line = timeline(
            if zeta < 1.0 {
                2.0 * lasts
            } else {
                lasts * (1.0 - 1e-4)
            },
            0.01,
        );
        let [exact, quasi] =
            [false, true].map(|is_quasi_static| kept(&model, &line, is_quasi_static));
        for (row, (a, b)) in exact.rows[0].iter().zip(&quasi.rows[0]).enumerate() {
            assert!(
                (a.1 - b.1).abs() < 1e-10 && (a.2 - b.2).abs() < 1e-10,
                "{zeta} {side} {row}: {a:?} {b:?}"
            );
            assert_eq!(a.4, b.4, "{zeta} {side} {row}");
        }
        assert_eq!(
            exact.events[0].len(),
            if zeta < 1.0 { 2 } else { 1 },
            "{zeta}: an overdamped slip has no end"
        );
        for keep in [&exact, &quasi] {
            let Some(stop) = keep.events[0].get(1) else {
                continue;
            };
            let jump = side * (1.0 + overshoot) * gap / stiffness;
            assert_eq!(stop.kind, EventKind::StickEntered);
            // A zero of x' that has decayed by the factor q is less sharp by that factor.
            assert!(
                (stop.time - lasts).abs() < 1e-10 / overshoot,
                "{zeta}: {} {lasts}",
                stop.time
            );
            assert!(
                (stop.displacement - model.initial_displacement - jump).abs() < 1e-10,
                "{zeta} {side}: {stop:?}"
            );
        }
    }
}

/// To first order in the speed r = K beta a w of the forcing, a slip moves further by the motion of
/// the equilibrium meanwhile, at most r T/K, and ends later by r (1 + q)/((f_s - f_d) w0^2 q). Both
/// effects are found: they have the right sign, are less than twice as large, and fall tenfold with
/// w (twelvefold at zeta = 0.9, where w = 1e-5 is half of the rate at which the body begins to
/// creep). A jump or a duration that was wrong by a factor of 2 would differ by 1.
#[test]
fn the_recursion_is_the_limit_of_slow_forcing() {
    println!(
        "Event-driven; quasi-static\n\n| zeta | w/w0 | slips | mean jump | mean duration |\n|---|---|---|---|---|"
    );
    for zeta in [0.0, 0.05, 0.3, 0.9] {
        let (lasts, overshoot) = swing(zeta);
        let released = (1.0 + overshoot) * 0.2;
        let errors = [1e-5, 1e-6].map(|w| {
            let [exact, quasi] = slips(&damped(zeta, w));
            let (jumps, durations) = ((exact.jump, quasi.jump), (exact.duration, quasi.duration));
            println!(
                "| {zeta} | {w:e} | {}; {} | {:.6}; {:.6} | {:.4}; {:.4} |",
                exact.count, quasi.count, jumps.0, jumps.1, durations.0, durations.1
            );
            assert!(
                (quasi.jump - released).abs() < 1e-12
                    && (quasi.duration / lasts - 1.0).abs() < 1e-8,
                "{quasi:?}"
            );
            assert_eq!(exact.count, quasi.count, "{zeta} {w}");
            let later = 6.0 * w * (1.0 + overshoot) / (0.2 * overshoot * lasts);
            let errors = [
                exact.jump / quasi.jump - 1.0,
                exact.duration / quasi.duration - 1.0,
            ];
            for (error, most) in errors.into_iter().zip([6.0 * w * lasts / released, later]) {
                assert!(
                    error > 0.0 && error < 2.0 * most,
                    "{zeta} {w}: {error}, to first order {most}"
                );
            }
            errors
        });
        for (fast, slow) in errors[0].into_iter().zip(errors[1]) {
            assert!(
                fast / slow > 9.0 && fast / slow < 13.0,
                "{zeta}: {fast} falls to {slow}"
            );
        }
    }
}

/// If the forcing moves the equilibrium faster than the body would swing back, r > (f_s - f_d) w0
/// e^{-zeta (pi + arccos zeta)/sqrt(1 - zeta^2)}, then x' has no zero and the body creeps. At 0.9
/// of that rate the two schemes still have the same number of slips, up to the tenth that longer
/// jumps cost. At 1.2 of it the event-driven scheme has lost four of five.
#[test]
fn near_critical_damping_the_body_creeps_under_fast_forcing() {
    println!(
        "Event-driven; quasi-static\n\n| zeta | creeps above w/w0 | slips at 0.9 of it | at 1.2 of it |\n|---|---|---|---|"
    );
    for zeta in [0.7f64, 0.8, 0.9] {
        let return_speed = (-zeta * (PI + zeta.acos()) / (1.0 - zeta * zeta).sqrt()).exp();
        let limit = 0.2 * return_speed / 6.0;
        let [below, above] = [0.9, 1.2].map(|part| slips(&damped(zeta, part * limit)));
        println!(
            "| {zeta} | {limit:.2e} | {}; {} | {}; {} |",
            below[0].count, below[1].count, above[0].count, above[1].count
        );
        assert!(
            below[0].count.abs_diff(below[1].count) <= below[1].count / 10,
            "{zeta}: {below:?}"
        );
        assert!(above[0].count < above[1].count / 5, "{zeta}: {above:?}");
    }
}

/// An overdamped body follows the temperature from one turning point to the next at a distance of
/// f_d, from 5 to -5 and back, however slow the forcing is, in three slips, the first of which
/// starts at 5.9. The recursion has some 200 slips instead.
#[test]
fn an_overdamped_body_creeps_however_slow_the_forcing() {
    for (zeta, w) in [1.0, 1.5]
        .into_iter()
        .flat_map(|zeta| [1e-3, 1e-4, 1e-5].map(|w| (zeta, w)))
    {
        let [exact, quasi] = slips(&damped(zeta, w));
        println!("{zeta} {w:e}: {exact:?}; {quasi:?}");
        assert_eq!(exact.count, 3, "{zeta} {w}");
        assert!(
            (exact.jump - (10.9 + 10.0 + 10.0) / 3.0).abs() < 0.1 * w.sqrt(),
            "{zeta} {w}: {exact:?}"
        );
        assert!(
            quasi.count > 190 && (quasi.jump - 0.2).abs() < 1e-12,
            "{zeta} {w}: {quasi:?}"
        );
    }
}

/// Statistical comparisons are made at 3.9 standard errors, which fail by chance once in 1e4.
const FALSE_ALARM: f64 = 3.9;

/// The forcing with a noise whose relaxation rate is proportional to its frequency: theta = 10 w,
/// and a standard deviation of the force of 0.3.
fn slow_noise(zeta: f64, w: f64) -> Problem {
    let mut model = damped(zeta, w);
    let theta = 10.0 * w;
    model.temperature.noises = vec![OrnsteinUhlenbeck {
        intensity: 0.05,
        relaxation_rate: theta,
        diffusion: (2.0 * theta).sqrt(),
        initial: InitialNoise::Stationary,
    }];
    model
}

/// The mean duration of a slip.
fn slip_duration(summary: &Summary, end: f64) -> f64 {
    (1.0 - estimate(summary, Statistic::StickingFraction).0) * end
        / estimate(summary, Statistic::SlipsPerPath).0
}

/// Null hypothesis: the mean |jump| and the mean number of sticks of both schemes agree to within
/// the share of f_s - f_d by which forcing and noise move the force during a slip, which the
/// warning `forcing-during-slip` states, and which falls like sqrt(w). Sample size: 400 paths on
/// either side, seeds 1 and 2. False-alarm rate: 1e-4 for each comparison, with 3.9 standard errors
/// added to the bound. Where the difference is significant, at zeta = 0.9 and 1.5 with 40 and more
/// standard errors, it falls by more than 2 when w falls by 10. Noise ends slips with any damping:
/// above the critical one after 0.7 to 1 of the settling time.
#[test]
fn under_slow_noise_the_recursion_is_the_limit_at_any_damping() {
    println!(
        "Event-driven; quasi-static\n\n| zeta | w/w0 | jump | sticks | slip lasts | moved |\n|---|---|---|---|---|---|"
    );
    for zeta in [0.0, 0.05, 0.3, 0.9, 1.5] {
        let (lasts, overshoot) = swing(zeta);
        let errors = [1e-5, 1e-6].map(|w| {
            let (model, end) = (slow_noise(zeta, w), 2.0 * TAU / w);
            let line = timeline(end, end);
            let scheme = QuasiStaticSimulation::new(&model, &line, DEFAULT_TOLERANCE);
            let exact = event_driven_summary(&model, &line, DEFAULT_TOLERANCE, 1, 400);
            let quasi = summary_of(&model, &line, 400, |numbers, observer| {
                scheme.simulate(2, numbers, observer)
            });
            let moved =
                (6.0 * w * lasts + 0.3 * (20.0 * w * lasts).sqrt()) / (0.2 * (1.0 + overshoot));
            let shown = |statistic, digits| {
                let [a, b] = [&exact, &quasi].map(|of| estimate(of, statistic));
                format!("{:.digits$} +- {:.digits$}; {:.digits$}", a.0, a.1, b.0)
            };
            let (jump, sticks) = (
                shown(Statistic::JumpAbsMean, 5),
                shown(Statistic::SticksPerPath, 1),
            );
            let (a, b) = (slip_duration(&exact, end), slip_duration(&quasi, end));
            println!(
                "| {zeta} | {w:e} | {jump} | {sticks} | {a:.1}; {b:.1} | {:.1} % |",
                100.0 * moved
            );
            for statistic in [Statistic::JumpAbsMean, Statistic::SticksPerPath] {
                let ((a, sa), (b, sb)) = (estimate(&exact, statistic), estimate(&quasi, statistic));
                let allowed = moved * b + FALSE_ALARM * sa.hypot(sb);
                assert!(
                    (a - b).abs() <= allowed,
                    "{zeta} {w} {statistic:?}: {a} +- {sa}, {b} +- {sb}"
                );
            }
            let ratio = a / b;
            let (least, most) = if zeta < 1.0 { (0.99, 1.15) } else { (0.7, 1.0) };
            assert!(
                ratio > least && ratio < most,
                "{zeta} {w}: slips last {ratio} times as long"
            );
            let (jump, error) = estimate(&exact, Statistic::JumpAbsMean);
            (
                (jump / (0.2 * (1.0 + overshoot)) - 1.0).abs(),
                FALSE_ALARM * error / jump,
            )
        });
        let [(fast, _), (slow, noise)] = errors;
        assert!(
            slow < (0.5 * fast).max(noise),
            "{zeta}: {fast} falls to {slow}"
        );
    }
}

/// A body outside the stick band swings from the b that it has, and then lies on the lattice of that
/// swing. The expected values are by hand: with m = K = beta = 1, f_s = 1 and f_d = 1/2, a slip
/// from b moves the body by 2 (|b| - 1/2), until |b| <= 1. So x goes from 0 to 5.6, 2.0 and 3.6 where
/// T = 3.3; then slips of length 1 follow T. From |b| = f_s for |b| the body came to 3 and stayed on
/// the lattice of whole numbers.
#[test]
fn a_start_outside_the_stick_band_swings_from_its_force() {
    let model = |x0: f64, temperature: Temperature| Problem {
        oscillator: Oscillator {
            mass: 1.0,
            stiffness: 1.0,
            damping: 0.0,
            drive: Drive::Dilatation(1.0),
        },
        friction: Friction {
            static_force: 1.0,
            dynamic_force: 0.5,
        },
        temperature,
        force: None,
        random: Vec::new(),
        initial_displacement: x0,
        initial_velocity: 0.0,
    };
    let wave = |amplitude: f64| Temperature {
        harmonics: vec![Harmonic {
            amplitude,
            angular_frequency: 1e-9,
            phase: 0.0,
        }],
        ..Temperature::default()
    };
    let series = |samples: &[(f64, f64)]| Temperature {
        series: Some(std::sync::Arc::new(
            Series::new(
                samples.iter().map(|at| at.0).collect(),
                samples.iter().map(|at| at.1).collect(),
            )
            .expect("ascending"),
        )),
        ..Temperature::default()
    };
    for (what, model, end, expected) in [
        ("at the crest", model(0.0, wave(3.3)), 1e3, 3.6),
        ("in the trough", model(0.0, wave(-3.3)), 1e3, -3.6),
        ("far above", model(7.0, wave(3.3)), 1e3, 2.6),
        ("just outside", model(0.0, wave(1.2)), 1e3, 1.4),
        ("just inside", model(0.0, wave(0.9)), 1e3, 0.0),
        ("after many periods", model(0.0, wave(3.3)), 1e12, 2.6),
        (
            "a series",
            model(
                0.0,
                series(&[(0.0, 3.3), (1e3, 3.3), (1e12, -3.0), (2e12, 3.0)]),
            ),
            2e12,
            2.6,
        ),
    ] {
        let line = timeline(end, end);
        let [exact, quasi] =
            [false, true].map(|is_quasi_static| kept(&model, &line, is_quasi_static));
        let last = |keep: &Keep| {
            keep.events[0]
                .last()
                .map_or(model.initial_displacement, |event| event.displacement)
        };
        assert!(
            (last(&quasi) - expected).abs() < 1e-6,
            "{what}: {} {expected}",
            last(&quasi)
        );
        assert!(
            (last(&exact) - expected).abs() < 1e-6,
            "{what}, event-driven: {} {expected}",
            last(&exact)
        );
        assert_eq!(exact.events[0].len(), quasi.events[0].len(), "{what}");
    }
}

/// A noise that starts stationary leaves most bodies outside the stick band at t = 0. In 40 units of
/// time it moves by 0.02, so that the displacement of a path is that of event-driven, which uses the
/// same random numbers, to this distance, unless the body leaves a second time in one scheme alone.
/// Of 64 paths with a fixed seed, 60 agree at least; from |b| = f_s for |b| some 20 agree.
#[test]
fn a_stationary_noise_starts_from_the_force_it_has() {
    let theta = 1e-6;
    let noise = OrnsteinUhlenbeck {
        intensity: 1.0,
        relaxation_rate: theta,
        diffusion: 3.0 * (2.0 * theta).sqrt(),
        initial: InitialNoise::Stationary,
    };
    let model = Problem {
        oscillator: Oscillator {
            mass: 1.0,
            stiffness: 1.0,
            damping: 0.0,
            drive: Drive::Dilatation(1.0),
        },
        friction: Friction {
            static_force: 1.0,
            dynamic_force: 0.5,
        },
        temperature: Temperature {
            noises: vec![noise],
            ..Temperature::default()
        },
        force: None,
        random: Vec::new(),
        initial_displacement: 0.0,
        initial_velocity: 0.0,
    };
    let line = timeline(40.0, 40.0);
    let numbers: Vec<u64> = (0..64).collect();
    let mut keeps = [Keep::lanes(64), Keep::lanes(64)];
    EventDrivenSimulation::new(&model, &line, DEFAULT_TOLERANCE).simulate(
        1,
        &numbers,
        &mut keeps[0],
    );
    QuasiStaticSimulation::new(&model, &line, DEFAULT_TOLERANCE).simulate(
        1,
        &numbers,
        &mut keeps[1],
    );
    let last = |keep: &Keep, lane: usize| {
        keep.events[lane]
            .last()
            .map_or(0.0, |event| event.displacement)
    };
    let differences: Vec<f64> = (0..64)
        .map(|lane| (last(&keeps[0], lane) - last(&keeps[1], lane)).abs())
        .collect();
    let agree = differences
        .iter()
        .filter(|difference| **difference < 0.1)
        .count();
    let moved = (0..64).filter(|lane| last(&keeps[1], *lane) != 0.0).count();
    assert!(
        moved > 40 && agree >= 60,
        "{agree} of 64 agree, {moved} moved: {differences:?}"
    );
}
