//! The cost of each feature, measured with and without it, and the kernel compared with loops that
//! were written without the features that a scene does not use.
//!
//! `cargo bench --bench features` takes about three minutes on two cores. Absolute times depend on
//! the machine and on what else runs there; the documentation quotes the last columns, which are
//! ratios within one run.

#[path = "../common/mod.rs"]
mod common;
mod stripped;

use common::{Deaf, END, STEP, STEPS, group, measured, scenario};
use criterion::Criterion;
use std::hint::black_box;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use stickslip::ensemble::{BLOCK_SIZE, Plan};
use stickslip::lanes::InstructionSet;
use stickslip::model::HarmonicClock;
use stickslip::scenario::Scenario;
use stickslip::scheme::{DiscreteSimulation, Simulate as _};
use stripped::{Scene, count_sticks};

/// Paths of the runs with and without an estimate of the bias: 48 times 16 groups of 14.
const WITH_BIAS: u64 = 48 * 16 * 14;

/// The time of a path-step of the bare kernel, for each scene.
fn scenes(c: &mut Criterion) {
    let mut group = group(c, "scene", BLOCK_SIZE * STEPS);
    let paths: Vec<u64> = (0..BLOCK_SIZE).collect();
    let mut bench = |name: &str, scenario: &Scenario| {
        let step = scenario.scheme.step().expect("a time-stepping scheme");
        let simulation = DiscreteSimulation::new(&scenario.model, &scenario.timeline(), step);
        group.bench_function(name, |b| {
            b.iter(|| simulation.simulate(1, &paths, &mut Deaf))
        });
    };
    let noisy = scenario("rho025", &[STEP, END]);
    let mut plain = noisy.clone();
    plain.model.temperature.noises.clear();
    let two_harmonics = |of: &Scenario| {
        let mut two = of.clone();
        two.model
            .temperature
            .harmonics
            .push(two.model.temperature.harmonics[0]);
        two
    };
    let damped = |of: &Scenario| {
        let mut damped = of.clone();
        damped.model.oscillator.damping = 0.1;
        damped
    };
    bench("plain", &plain);
    bench("noise", &noisy);
    bench("damping", &damped(&plain));
    bench("noise and damping", &damped(&noisy));
    bench("second harmonic", &two_harmonics(&plain));
    bench("noise and second harmonic", &two_harmonics(&noisy));
    if InstructionSet::Avx512.is_available() {
        let h = 0.001;
        let scene = Scene {
            h,
            mass: 1.0,
            stiffness: 1.0,
            static_force: 1.2,
            dynamic_force: 1.0,
            forcing: 6.0,
            noise: None,
        };
        let noisy = Scene {
            noise: Some((6.0 * 0.25, 1.0, 1.0)),
            ..scene
        };
        let clock = HarmonicClock::new(&plain.model.temperature.harmonics, h);
        for (name, scene) in [("never had noise", scene), ("never had damping", noisy)] {
            let count = || {
                count_sticks(
                    InstructionSet::Avx512,
                    black_box(scene),
                    &clock,
                    STEPS as usize,
                )
            };
            group.bench_function(name, |b| b.iter(count));
        }
    }
}

/// The time of a path-step with the statistics of a run, for each way of recording.
fn recordings(c: &mut Criterion) {
    let paths = BLOCK_SIZE;
    let mut group = group(c, "recording", paths * STEPS);
    let mut bench = |name: &str, set: &[&str]| {
        let plan = Plan {
            paths,
            ..scenario(
                "rho025",
                &[&[STEP, END, "record.paths=false"], set].concat(),
            )
            .plan()
        };
        group.bench_function(name, |b| b.iter(|| plan.block(0)));
    };
    bench("statistics", &[]);
    bench("per-path scalars", &["record.paths=true"]);
    bench("events", &["record.events=true"]);
    bench("trajectories", &["record.trajectories=256"]);
    bench("a row every 10 steps", &["time.output_step=0.01"]);
}

/// The time of a run with statistics only, and of the estimate of its bias.
fn bias(c: &mut Criterion) {
    let scenario = scenario(
        "rho025",
        &[STEP, END, &format!("ensemble.paths={WITH_BIAS}")],
    );
    let plan = scenario.plan();
    let bias = scenario.bias_plan(plan.paths).expect("enough paths");
    let mut group = group(c, "bias", WITH_BIAS * STEPS);
    group.measurement_time(Duration::from_secs(6));
    group.bench_function("off", |b| b.iter(|| plan.run(1)));
    group.bench_function("on", |b| {
        b.iter(|| bias.estimate(&plan.run(1), 1, &AtomicBool::new(false)))
    });
}

/// Paths of an event-driven run. They are enough to fill bins of its sketches.
const FREE: u64 = 16 * BLOCK_SIZE;

/// The time of a path of `rho025` with the event-driven scheme, up to t_end = 60.
fn event_driven(c: &mut Criterion) {
    let mut group = group(c, "event-driven", FREE);
    group.measurement_time(Duration::from_secs(6));
    let plan = |set: &[&str]| {
        let bare = ["scheme.kind=event-driven", "record.paths=false"];
        Plan {
            paths: FREE,
            ..scenario("rho025", &[&bare[..], set].concat()).plan()
        }
    };
    let seldom = plan(&["time.output_step=60"]);
    let paths: Vec<u64> = (0..FREE).collect();
    let alone = || {
        paths
            .chunks(BLOCK_SIZE as usize)
            .for_each(|paths| drop(seldom.simulation.simulate(1, paths, &mut Deaf)))
    };
    group.bench_function("alone", |b| b.iter(alone));
    let mut bench = |name: &str, set: &[&str]| {
        let plan = plan(set);
        group.bench_function(name, |b| b.iter(|| plan.run(1)));
    };
    bench("one row", &["time.output_step=60"]);
    bench("121 rows", &[]);
    bench("per-path scalars", &["record.paths=true"]);
    bench("events", &["record.events=true"]);
    for (name, set) in ON_REQUEST {
        bench(name, set);
    }
}

/// What is measured on request.
const ON_REQUEST: [(&str, &[&str]); 6] = [
    ("laws", &["record.laws=true"]),
    ("density", &["record.density=true"]),
    ("spectrum", &["record.spectrum=true"]),
    (
        "density and spectrum",
        &["record.density=true", "record.spectrum=true"],
    ),
    ("energy", &["record.energy=true"]),
    ("levels", &["statistics.levels=[12.0]"]),
];

fn print_prices() {
    let block = (BLOCK_SIZE * STEPS) as f64;
    let scene = |name: &str| measured("scene", name, block);
    let recording = |name: &str| measured("recording", name, block);
    let bias = |name: &str| measured("bias", name, (WITH_BIAS * STEPS) as f64);
    let lines = [
        ("noise", scene("plain"), scene("noise")),
        ("damping", scene("plain"), scene("damping")),
        (
            "damping, in noise",
            scene("noise"),
            scene("noise and damping"),
        ),
        ("second harmonic", scene("plain"), scene("second harmonic")),
        (
            "second harmonic, in noise",
            scene("noise"),
            scene("noise and second harmonic"),
        ),
        (
            "statistics, in noise",
            scene("noise"),
            recording("statistics"),
        ),
        (
            "per-path scalars",
            recording("statistics"),
            recording("per-path scalars"),
        ),
        ("events", recording("statistics"), recording("events")),
        (
            "256 trajectories",
            recording("statistics"),
            recording("trajectories"),
        ),
        (
            "a row every 10 steps",
            recording("statistics"),
            recording("a row every 10 steps"),
        ),
        ("bias estimate", bias("off"), bias("on")),
        (
            "a loop without noise / scene without",
            scene("never had noise"),
            scene("plain"),
        ),
        (
            "a loop without damping / scene without",
            scene("never had damping"),
            scene("noise"),
        ),
    ];
    print("feature (ns a path-step)", &lines);
    let path = |name: &str| measured("event-driven", name, FREE as f64).map(|ns| ns / 1000.0);
    let lines = [
        ("statistics with one row", path("alone"), path("one row")),
        ("121 rows", path("one row"), path("121 rows")),
        (
            "per-path scalars",
            path("121 rows"),
            path("per-path scalars"),
        ),
        ("events", path("121 rows"), path("events")),
    ];
    let on_request = ON_REQUEST.map(|(name, _)| (name, path("121 rows"), path(name)));
    print(
        "event-driven (us a path)",
        &[&lines[..], &on_request].concat(),
    );
}

fn print(what: &str, lines: &[(&str, Option<f64>, Option<f64>)]) {
    println!("\n{what:40} {:>8} {:>8} {:>7}", "off", "on", "on/off");
    for (name, off, on) in lines {
        match (off, on) {
            (Some(off), Some(on)) => println!("{name:40} {off:8.3} {on:8.3} {:7.3}", on / off),
            _ => println!("{name:40} not measured here"),
        }
    }
}

fn main() {
    let mut c = Criterion::default()
        .configure_from_args()
        .warm_up_time(Duration::from_secs(1));
    scenes(&mut c);
    recordings(&mut c);
    bias(&mut c);
    event_driven(&mut c);
    c.final_summary();
    print_prices();
}
