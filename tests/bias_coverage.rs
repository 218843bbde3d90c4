//! How often what a run says of its bias is off by more than it says, on scenes that no rule was made for.

mod common;

use common::paper;
use rand_distr::{Distribution as _, Uniform};
use rand_pcg::Pcg64Dxsm;
use rand_pcg::rand_core::SeedableRng as _;
use std::sync::atomic::AtomicBool;
use stick_slip::bias::BiasPlan;
use stick_slip::ensemble::Plan;
use stick_slip::model::{Harmonic, InitialNoise, Model};
use stick_slip::scheme::{CorrectedVi, DEFAULT_TOLERANCE, DiscreteVi, EventDriven, Scheme, Timeline};
use stick_slip::stats::{Estimate, Record, Statistic, Summary};

const STEPS: [f64; 3] = [0.02, 0.01, 0.005];
const PATHS: [u64; 2] = [10_000, 2000];
const SEEDS: u64 = 20;
const TRUTH_AT_STEP: u64 = 200_000;
const TRUTH: u64 = 300_000;

fn timeline(model: &Model) -> Timeline {
    Timeline { end: 60.0, output_step: 60.0, period: model.temperature.period() }
}

fn run(model: &Model, scheme: Scheme, seed: u64, paths: u64) -> Summary {
    let simulation = scheme.simulation(model, &timeline(model));
    Plan { simulation, record: Record::NOTHING, seed, paths }.run(2)
}

/// Nearly equal frictions and light noise: sticks are either short or long, and longer steps miss the short ones.
fn two_humps() -> Model {
    let mut model = paper(0.25, 0.1);
    let (o, noise) = (&mut model.oscillator, model.temperature.noise.as_mut().expect("noise"));
    (o.mass, o.stiffness, o.damping, o.dilatation) = (0.3, 0.2, 0.5, 20.0);
    (noise.relaxation_rate, noise.initial) = (0.5, InitialNoise::At(-1.0));
    model.friction.static_force = 1.02;
    model.initial_displacement = 20.0;
    model
}

fn scenes() -> Vec<(String, Model)> {
    let mut scenes = vec![("rho025".to_string(), paper(0.25, 0.25)), ("two humps".to_string(), two_humps())];
    let mut wider = two_humps();
    wider.friction.static_force = 1.05;
    wider.temperature.noise.as_mut().expect("noise").intensity = 0.15;
    scenes.push(("two humps, wider gap".to_string(), wider));
    let mut rng = Pcg64Dxsm::seed_from_u64(2026);
    for i in 1..=6 {
        let mut draw = |low: f64, high: f64| Uniform::new(low, high).expect("low < high").sample(&mut rng);
        let mut model = paper(0.25, 0.25);
        let o = &mut model.oscillator;
        (o.mass, o.stiffness) = (draw(-1.0, 1.0).exp2(), draw(-1.0, 1.0).exp2());
        (o.damping, o.dilatation) = (draw(-0.5, 0.5).max(0.0), draw(3.0, 12.0));
        model.friction.static_force = 1.0 + draw(-5.0, -1.3).exp2();
        let noise = model.temperature.noise.as_mut().expect("noise");
        (noise.intensity, noise.relaxation_rate) = (draw(-3.5, -0.5).exp2(), draw(-1.0, 2.0).exp2());
        model.temperature.harmonics = vec![Harmonic { amplitude: 1.0, angular_frequency: draw(0.15, 0.8), phase: draw(0.0, 6.0) }];
        model.initial_displacement = draw(-6.0, 6.0);
        scenes.push((format!("drawn {i}"), model));
    }
    scenes
}

/// The ends of what is known of a number: two standard errors, and those of the interval where it is a median.
fn ends(e: &Estimate) -> (f64, f64) {
    match e.statistic {
        Statistic::StickDurationMedian => (e.low, e.high),
        _ => (e.estimate - 2.0 * e.standard_error, e.estimate + 2.0 * e.standard_error),
    }
}

#[test]
#[ignore = "a measurement of some minutes"]
fn over_scenes_and_seeds() {
    for (name, model) in scenes() {
        let exact = run(&model, EventDriven { tolerance: DEFAULT_TOLERANCE }.into(), 77, TRUTH);
        for h in STEPS {
            for scheme in [Scheme::from(DiscreteVi { step: h }), CorrectedVi { step: h }.into()] {
                let at_step = run(&model, scheme, 999, TRUTH_AT_STEP);
                for paths in PATHS {
                    for seed in 201..201 + SEEDS {
                        let summary = run(&model, scheme, seed, paths);
                        let plan = BiasPlan::new(scheme, &model, &timeline(&model), seed, paths).expect("enough paths");
                        let biases = plan.estimate(&summary, 2, &AtomicBool::new(false)).unwrap_or_default();
                        for statistic in Statistic::ALL {
                            let of = |e: &Summary| ends(e.estimate(statistic));
                            let ((a, b), (c, d)) = (of(&at_step), of(&exact));
                            let told = biases.iter().find(|(s, _)| *s == statistic);
                            let (e, u) = told.map_or((f64::NAN, f64::NAN), |t| (t.1.estimate, t.1.uncertainty));
                            let est = summary.estimate(statistic);
                            println!("CSV;{name};{h};{:?};{paths};{seed};{};{};{};{};{e};{u};{};{};{}", scheme.discretisation(), statistic.name(), est.estimate, est.low, est.high, (c+d)/2.0, a-d, b-c);
                        }
                    }
                }
            }
        }
    }
}
