//! A measured temperature as forcing, scheme by scheme, compared with what it was not derived from:
//! closed forms, an integration of the equation of motion in this file, plain loops, and scenes
//! without a series.

use crate::common::{Keep, paper, timeline};
use std::f64::consts::PI;
use std::sync::Arc;
use stickslip::model::*;
use stickslip::scenario::Scenario;
use stickslip::scheme::*;

const TOLERANCE: f64 = 1e-3;

/// The model with this series instead of its harmonics.
fn measured(mut model: Problem, times: Vec<f64>, values: Vec<f64>) -> Problem {
    model.temperature.harmonics.clear();
    model.temperature.series = Some(Arc::new(Series::new(times, values).expect("a series")));
    model
}

/// The model with T(t) given by n + 1 samples that are `step` apart.
fn sampled(model: Problem, n: usize, step: f64, temperature: impl Fn(f64) -> f64) -> Problem {
    let times: Vec<f64> = (0..=n).map(|i| i as f64 * step).collect();
    let values = times.iter().map(|&t| temperature(t)).collect();
    measured(model, times, values)
}

fn events(simulation: &impl Simulate) -> Vec<Event> {
    let mut keep = Keep::lanes(1);
    assert!(simulation.simulate(1, &[0], &mut keep).is_empty(), "lost");
    keep.events.remove(0)
}

#[track_caller]
fn assert_alike(found: &[Event], wanted: &[Event], within: f64) {
    assert_eq!(found.len(), wanted.len(), "{found:?}\n{wanted:?}");
    for (a, b) in found.iter().zip(wanted) {
        let off = (a.time - b.time)
            .abs()
            .max((a.displacement - b.displacement).abs())
            .max((a.force - b.force).abs());
        assert!(a.kind == b.kind && off <= within, "{a:?} {b:?}");
    }
}

/// A cosine given by samples. Straight lines between the samples are below it by at most w^2 d^2/8,
/// which is 8e-9 for d = 1e-3. Each step of the discrete scheme is at a sample.
#[test]
fn a_finely_sampled_cosine_does_what_the_harmonic_does() {
    for damping in [0.0, 0.1] {
        let mut model = paper(0.25, 0.0);
        model.oscillator.damping = damping;
        let fine = sampled(model.clone(), 30_000, 1e-3, |t| (0.25 * t).cos());
        let line = timeline(30.0, 0.5);
        let event_driven =
            |model: &Problem| events(&EventDrivenSimulation::new(model, &line, TOLERANCE));
        let quasi_static =
            |model: &Problem| events(&QuasiStaticSimulation::new(model, &line, TOLERANCE));
        let wanted = event_driven(&model);
        assert!(wanted.len() >= 4, "{wanted:?}");
        assert_alike(&event_driven(&fine), &wanted, 3e-7);
        assert_alike(&quasi_static(&fine), &quasi_static(&model), 3e-7);
        let coarse = sampled(model.clone(), 3_000, 1e-2, |t| (0.25 * t).cos());
        for is_corrected in [false, true] {
            let discrete = |model: &Problem| match is_corrected {
                false => events(&DiscreteSimulation::new(model, &line, 0.01)),
                true => events(&DiscreteSimulation::corrected(model, &line, 0.01)),
            };
            assert_alike(&discrete(&coarse), &discrete(&model), 1e-9);
        }
    }
}

/// T = t/2 given by two samples. From x = 0 the body leaves at K beta t/2 = f_s, t = 0.4. A time r
/// later, y'' + y = 0.2 + 3 r, so that y' = 0.2 sin r + 3 (1 - cos r) and y = 0.2 (1 - cos r) + 3
/// (r - sin r), and y' = 0 at r = 2 pi - 2 atan(0.2/3).
#[test]
fn a_ramp_ends_sticks_and_slips_where_a_hand_finds_it() {
    let mut model = paper(0.25, 0.0);
    model.initial_displacement = 0.0;
    let ramp = measured(model.clone(), vec![0.0, 40.0], vec![0.0, 20.0]);
    let line = timeline(40.0, 1.0);
    let found = events(&EventDrivenSimulation::new(&ramp, &line, TOLERANCE));
    let end = 2.0 * PI - 2.0 * (0.2f64 / 3.0).atan();
    let way = 0.2 * (1.0 - end.cos()) + 3.0 * (end - end.sin());
    assert!(
        (found[0].time - 0.4).abs() < 1e-15 && found[0].displacement == 0.0,
        "{:?}",
        found[0]
    );
    assert!(
        (found[1].time - 0.4 - end).abs() < 1e-13 && (found[1].displacement - way).abs() < 1e-12,
        "{:?}",
        found[1]
    );
    // A further sample on a straight line changes nothing, wherever it is: in a stick, in a slip,
    // or almost at an event.
    let times = vec![
        0.0,
        0.1,
        0.4,
        0.4 + 1e-9,
        1.7,
        5.0,
        found[1].time,
        found[1].time + 1e-12,
        9.0,
        22.5,
        40.0,
    ];
    let values = times.iter().map(|t| 0.5 * t).collect();
    let cut = measured(model, times, values);
    assert_alike(
        &events(&EventDrivenSimulation::new(&cut, &line, TOLERANCE)),
        &found,
        1e-10,
    );
    let quasi_static =
        |model: &Problem| events(&QuasiStaticSimulation::new(model, &line, TOLERANCE));
    assert_alike(&quasi_static(&cut), &quasi_static(&ramp), 1e-10);
}

/// A series of zeros added to a scene with noise changes no bit: it draws no random number, and its
/// cells end where those of the scene do.
#[test]
fn a_series_of_zeros_changes_no_bit() {
    let plain = paper(0.25, 0.25);
    let mut zero = plain.clone();
    zero.temperature.series = Some(Arc::new(
        Series::new(vec![0.0, 30.0, 60.0], vec![0.0; 3]).expect("a series"),
    ));
    let line = timeline(60.0, 0.5);
    let paths: Vec<u64> = (0..16).collect();
    fn kept(simulation: &impl Simulate, paths: &[u64]) -> Keep {
        let mut keep = Keep::lanes(paths.len());
        assert!(simulation.simulate(5, paths, &mut keep).is_empty());
        keep
    }
    let both = [&plain, &zero];
    let [a, b] =
        both.map(|model| kept(&EventDrivenSimulation::new(model, &line, TOLERANCE), &paths));
    assert_eq!(a, b);
    let [a, b] =
        both.map(|model| kept(&QuasiStaticSimulation::new(model, &line, TOLERANCE), &paths));
    assert_eq!(a, b);
    let [a, b] = both.map(|model| kept(&DiscreteSimulation::new(model, &line, 0.01), &paths));
    assert_eq!(a, b);
}

/// Pinned noise: zero at the samples and, between them, a bridge of the Ornstein-Uhlenbeck process.
/// The stick band is so narrow that it is left now and then.
///
/// Null hypothesis: the noise in T, which is T less the series, has mean 0 and is uncorrelated
/// across a sample. At a time s after a sample, where samples are d = 1.5 apart, its variance is
/// sinh(theta s) sinh(theta (d - s)) rho^2 sigma^2/(theta sinh(theta d)). Slips depend on the
/// noise, and the noise does not depend on slips. Sample size: 40 000 paths, whose variances are
/// known to 0.7 %. False-alarm rate: 2e-4 for all 28 comparisons together, at 4.5 standard errors.
/// Free noise would have twice the variance in the middle and more at the end.
#[test]
fn pinned_noise_is_a_bridge_from_sample_to_sample() {
    let mut model = measured(paper(0.25, 0.25), vec![0.0, 1.5, 3.0], vec![1.0, 1.1, 0.7]);
    model.temperature.is_pinned = true;
    let (line, paths) = (timeline(3.0, 0.1), 40_000u64);
    let numbers: Vec<u64> = (0..paths).collect();
    for is_quasi_static in [false, true] {
        let mut keep = Keep::lanes(paths as usize);
        let lost = match is_quasi_static {
            true => QuasiStaticSimulation::new(&model, &line, TOLERANCE)
                .simulate(3, &numbers, &mut keep),
            false => EventDrivenSimulation::new(&model, &line, TOLERANCE)
                .simulate(3, &numbers, &mut keep),
        };
        assert!(lost.is_empty());
        assert!(
            keep.events
                .iter()
                .filter(|events| !events.is_empty())
                .count()
                > 1000,
            "some slip"
        );
        let noise = |row: usize| -> Vec<f64> {
            keep.rows
                .iter()
                .map(|rows| rows[row].3 - model.temperature.deterministic(rows[row].0))
                .collect()
        };
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let n = (paths as f64).sqrt();
        for row in 0..=30 {
            let s = 0.1 * (row % 15) as f64;
            let values = noise(row);
            let variance = 0.0625 * s.sinh() * (1.5 - s).sinh() / 1.5f64.sinh();
            if row % 15 == 0 {
                assert!(values.iter().all(|value| value.abs() < 1e-12), "{row}");
                continue;
            }
            let squares: Vec<f64> = values.iter().map(|value| value * value).collect();
            let off = (mean(&squares) / variance - 1.0) * n / 2f64.sqrt();
            assert!(
                off.abs() < 4.5,
                "{is_quasi_static} {row}: {off} standard errors"
            );
            let off = mean(&values) / variance.sqrt() * n;
            assert!(off.abs() < 4.5, "{is_quasi_static} {row}: mean {off}");
        }
        let across: Vec<f64> = noise(8).iter().zip(noise(22)).map(|(a, b)| a * b).collect();
        let variance = 0.0625 * 0.8f64.sinh() * 0.7f64.sinh() / 1.5f64.sinh();
        assert!((mean(&across) / variance * n).abs() < 4.5);
    }
}

/// The recursion of the bridge: n = ceil((|T - xi| - A)/G) jumps of G between two samples, whatever
/// T does between them. A slip of the scheme lasts 0.07 s and samples are 600 s apart. So there are
/// as many slips between the same samples, and they end at the same place.
#[test]
fn slips_of_a_bridge_are_those_of_the_recursion_between_samples() {
    let scenario = Scenario::shipped("bridge").expect("sound");
    let (model, series) = (
        &scenario.model,
        scenario
            .model
            .temperature
            .series
            .as_ref()
            .expect("a series"),
    );
    let (k, beta) = (
        model.oscillator.stiffness,
        model.oscillator.rest_position(1.0),
    );
    let a = model.friction.static_force / (k * beta);
    let g = 2.0 * (model.friction.static_force - model.friction.dynamic_force) / (k * beta);
    let mut xi = model.initial_displacement / beta;
    let mut wanted = Vec::new();
    for (i, t) in series.values().iter().enumerate() {
        let jumps = (((t - xi).abs() - a) / g).ceil().max(0.0);
        xi += (t - xi).signum() * jumps * g;
        wanted.extend((0..jumps as usize).map(|_| i - 1));
    }
    let found = events(&QuasiStaticSimulation::new(
        model,
        &scenario.timeline(),
        TOLERANCE,
    ));
    let slips: Vec<&Event> = found
        .iter()
        .filter(|event| matches!(event.kind, EventKind::SlipStarted(_)))
        .collect();
    let pieces: Vec<usize> = slips.iter().map(|event| series.piece(event.time)).collect();
    assert_eq!(pieces, wanted);
    // The synthetic bridge has 27 slips in this month.
    assert_eq!(wanted.len(), 27);
    let end = found
        .iter()
        .rev()
        .find(|event| event.kind == EventKind::StickEntered)
        .expect("a stick")
        .displacement;
    assert!((end - beta * xi).abs() < 1e-13, "{end} {}", beta * xi);
    // The exits are where the straight line of T meets a threshold, up to rounding.
    for slip in &slips {
        let b = k * (beta * series.at(slip.time) - slip.displacement);
        assert!(
            (b.abs() - model.friction.static_force).abs() < 1e-6 * model.friction.static_force,
            "{slip:?} {b}"
        );
    }
    // The event-driven scheme, which does not assume that T stands still during a slip, has slips
    // between the same samples.
    let exact = events(&EventDrivenSimulation::new(
        model,
        &scenario.timeline(),
        TOLERANCE,
    ));
    let slips = exact
        .iter()
        .filter(|event| matches!(event.kind, EventKind::SlipStarted(_)));
    assert_eq!(
        slips
            .map(|event| series.piece(event.time))
            .collect::<Vec<_>>(),
        wanted
    );
}
