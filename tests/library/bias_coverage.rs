//! How often the bias that a run estimates is off by more than its uncertainty, in scenes that the
//! rules of the estimate were not made for.
//!
//! `cargo test --release --test library bias_coverage:: -- --ignored --nocapture` prints the table.
//! Last result, with five seeds and a fifth of the paths of the truth: 1.9 % of all estimates are off
//! by more, at most 4.0 % of any statistic and 4.8 % in any scene.

use crate::common::paper;
use rand_distr::{Distribution as _, Uniform};
use rand_pcg::Pcg64Dxsm;
use rand_pcg::rand_core::SeedableRng as _;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use stickslip::bias::BiasPlan;
use stickslip::ensemble::Plan;
use stickslip::model::{Drive, Harmonic, InitialNoise, Problem};
use stickslip::scheme::{
    CorrectedVi, DEFAULT_TOLERANCE, DiscreteVi, EventDriven, Scheme, Timeline,
};
use stickslip::stats::{Bias, Estimate, Record, Statistic, Summary};

const STEPS: [f64; 3] = [0.02, 0.01, 0.005];
const PATHS: [u64; 2] = [10_000, 2000];
const SEEDS: std::ops::RangeInclusive<u64> = 201..=220;

fn run(model: &Problem, scheme: Scheme, seed: u64, paths: u64) -> Summary {
    let timeline = Timeline {
        end: 60.0,
        output_step: 60.0,
        period: model.temperature.period(),
        after: 0.0,
    };
    Plan {
        simulation: scheme.simulation(model, &timeline),
        record: Record::NOTHING,
        seed,
        paths,
        antithetic: false,
    }
    .run(2)
}

/// The biases that a run with the rows of the shipped scene reports.
fn reported(model: &Problem, scheme: Scheme, seed: u64, paths: u64) -> Vec<(Statistic, Bias)> {
    let timeline = Timeline {
        end: 60.0,
        output_step: 0.5,
        period: model.temperature.period(),
        after: 0.0,
    };
    let plan = BiasPlan::new(scheme, model, &timeline, seed, paths).expect("enough paths");
    plan.estimate(&run(model, scheme, seed, paths), 2, &AtomicBool::new(false))
        .unwrap_or_default()
}

/// Weak noise and nearly equal frictions: sticks are either short or long, and a step misses many
/// of the short ones. At h = 0.01 most of the sticks that are seen are long, and their median is
/// 1.55. At zero step most are short, and the median is 0.40.
fn two_humps(static_force: f64, intensity: f64) -> Problem {
    let mut model = paper(0.25, intensity);
    let oscillator = &mut model.oscillator;
    (oscillator.mass, oscillator.stiffness) = (0.3, 0.2);
    (oscillator.damping, oscillator.drive) = (0.5, Drive::Dilatation(20.0));
    let noise = model.temperature.noises.first_mut().expect("it has noise");
    (noise.relaxation_rate, noise.initial) = (0.5, InitialNoise::At(-1.0));
    (model.friction.static_force, model.initial_displacement) = (static_force, 20.0);
    model
}

/// The shipped scene, two scenes with two kinds of sticks, and six scenes drawn at random around
/// the shipped one.
fn scenes() -> Vec<(String, Problem)> {
    let mut scenes = vec![
        ("rho025".to_string(), paper(0.25, 0.25)),
        ("two humps".to_string(), two_humps(1.02, 0.1)),
        ("two humps, wider gap".to_string(), two_humps(1.05, 0.15)),
    ];
    let mut rng = Pcg64Dxsm::seed_from_u64(2026);
    for i in 1..=6 {
        let mut draw = |low: f64, high: f64| {
            Uniform::new(low, high)
                .expect("low < high")
                .sample(&mut rng)
        };
        let mut model = paper(0.25, 0.25);
        let oscillator = &mut model.oscillator;
        (oscillator.mass, oscillator.stiffness) = (draw(-1.0, 1.0).exp2(), draw(-1.0, 1.0).exp2());
        (oscillator.damping, oscillator.drive) =
            (draw(-0.5, 0.5).max(0.0), Drive::Dilatation(draw(3.0, 12.0)));
        model.friction.static_force = 1.0 + draw(-5.0, -1.3).exp2();
        let noise = model.temperature.noises.first_mut().expect("it has noise");
        (noise.intensity, noise.relaxation_rate) =
            (draw(-3.5, -0.5).exp2(), draw(-1.0, 2.0).exp2());
        let (angular_frequency, phase) = (draw(0.15, 0.8), draw(0.0, 6.0));
        model.temperature.harmonics = vec![Harmonic {
            amplitude: 1.0,
            angular_frequency,
            phase,
        }];
        model.initial_displacement = draw(-6.0, 6.0);
        scenes.push((format!("drawn {i}"), model));
    }
    scenes
}

/// The range in which the true number lies, from a large run: two standard errors to either side,
/// or the interval of a median.
fn ends(e: &Estimate) -> (f64, f64) {
    match e.statistic {
        Statistic::StickDurationMedian => (e.low, e.high),
        _ => (
            e.estimate - 2.0 * e.standard_error,
            e.estimate + 2.0 * e.standard_error,
        ),
    }
}

/// With fewer estimates than this, a share of 5 % can hardly be distinguished from one of 3 %.
const FEWEST: usize = 100;

/// The number of misses, and the number of estimates.
type Count = (usize, usize);

/// Nine scenes at three steps, both schemes, 10 000 and 2000 paths, 20 seeds. The truth is that of
/// 200 000 paths at the step less that of 300 000 event-driven paths, each with its error.
///
/// Null hypothesis: an estimate is off by more than its uncertainty with a probability of at most 5
/// %. For each statistic and setting, the misses must be below the mean of that binomial
/// distribution plus 3.7 of its standard deviations, e.g. 19 of 180. False-alarm rate: 1e-4 for
/// each of 250 settings, so one false alarm in 40 runs. With half the uncertainty 30 % are missed,
/// 54 of 180. All estimates together must have at most 4 %, because some uncertainties are
/// conservative.
#[test]
#[ignore = "a measurement of some minutes"]
fn no_statistic_is_missed_more_often_than_stated() {
    let mut counts: BTreeMap<(String, usize), Count> = BTreeMap::new();
    for (name, model) in scenes() {
        let exact = run(
            &model,
            EventDriven {
                tolerance: DEFAULT_TOLERANCE,
            }
            .into(),
            77,
            300_000,
        );
        for h in STEPS {
            let schemes = [
                ("discrete", DiscreteVi { step: h }.into()),
                ("corrected", CorrectedVi { step: h }.into()),
            ];
            for (scheme_name, scheme) in schemes {
                let at_step = run(&model, scheme, 999, 200_000);
                for paths in PATHS {
                    let setting = format!("{scheme_name} {h} {paths}");
                    let all: Vec<_> = SEEDS
                        .map(|seed| reported(&model, scheme, seed, paths))
                        .collect();
                    for statistic in Statistic::asked_by(&Record::NOTHING) {
                        let ((a, b), (c, d)) = (
                            ends(at_step.estimate(statistic)),
                            ends(exact.estimate(statistic)),
                        );
                        let (low, high) = (a - d, b - c);
                        let biases: Vec<Bias> = all
                            .iter()
                            .flatten()
                            .filter(|(of, _)| *of == statistic)
                            .map(|b| b.1)
                            .collect();
                        let is_missed = |b: &&Bias| {
                            b.estimate - b.uncertainty > high + 1e-12
                                || b.estimate + b.uncertainty < low - 1e-12
                        };
                        let missed = biases.iter().filter(is_missed).count();
                        let count = counts
                            .entry((setting.clone(), statistic.index()))
                            .or_default();
                        *count = (count.0 + missed, count.1 + biases.len());
                        let mut reach: Vec<f64> = biases.iter().map(|b| b.uncertainty).collect();
                        reach.sort_by(f64::total_cmp);
                        let (reach, reported) = (reach.get(reach.len() / 2), biases.len());
                        println!(
                            "{name}; {setting}; {}; {missed}/{reported}; {low:.4} to {high:.4} +- {reach:.4?}",
                            statistic.name()
                        );
                    }
                }
            }
        }
    }
    let settings: Vec<&String> = counts
        .keys()
        .filter(|key| key.1 == 0)
        .map(|key| &key.0)
        .collect();
    println!(
        "| statistic | {} |",
        settings
            .iter()
            .map(|s| s.as_str())
            .collect::<Vec<_>>()
            .join(" | ")
    );
    let mut too_many = Vec::new();
    for statistic in Statistic::asked_by(&Record::NOTHING) {
        let cell = |setting: &&String| {
            let (missed, reported) = counts[&((*setting).clone(), statistic.index())];
            let mean = reported as f64 / 20.0;
            if reported >= FEWEST && missed as f64 > mean + 3.7 * (0.95 * mean).sqrt() {
                too_many.push(format!(
                    "{}, {setting}: {missed} of {reported}",
                    statistic.name()
                ));
            }
            format!("{missed}/{reported}")
        };
        println!(
            "| `{}` | {} |",
            statistic.name(),
            settings.iter().map(cell).collect::<Vec<_>>().join(" | ")
        );
    }
    assert_eq!(too_many, Vec::<String>::new());
    let (missed, reported) = counts
        .values()
        .fold((0, 0), |sum, count| (sum.0 + count.0, sum.1 + count.1));
    assert!(25 * missed <= reported, "{missed} of {reported}");
}
