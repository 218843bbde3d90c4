//! The gain from single precision and from cheaper normals in the discrete scheme, and their effect
//! on its statistics.
//!
//!     cargo run --release --example single_precision
//!
//! A prototype simulates `scenarios/rho025.toml` on plain arrays of `f32` or `f64`, which the
//! compiler vectorises. It prints ns for a path-step beside that of the crate's kernel; then the
//! changes if both precisions are given the same normals, path by path; then the changes from other
//! normals. It takes half a minute.

mod estimates;
mod kicks;
mod prototype;

use estimates::{estimates, standard_error};
use kicks::{Bytes, Inverse, Own};
use prototype::{Cascade, simulate};
use std::error::Error;
use std::hint::black_box;
use std::time::Instant as Clock;
use stick_slip::config::Override;
use stick_slip::model::{Event, Model};
use stick_slip::scenario::Scenario;
use stick_slip::scheme::{DiscreteSimulation, Instant, Observer, Simulate as _, Snapshot};

/// An observer that ignores everything, to measure the kernel alone.
struct Deaf;

impl Observer for Deaf {
    fn event(&mut self, lane: usize, event: Event) {
        black_box((lane, event));
    }
    fn snapshot(&mut self, _: Instant, snapshot: Snapshot<'_>) {
        black_box(snapshot.displacement);
    }
}

/// Prints ns for a path-step, the least of 40 rounds in which the programs take turns.
fn time(h: f64) -> Result<(), Box<dyn Error>> {
    const PATHS: u64 = 256;
    const STEPS: u64 = 12_000;
    let set = [Override::set(&format!("time.step={h}"))?, Override::set(&format!("time.end={}", h * STEPS as f64))?];
    let scenario = Scenario::read("scenarios/rho025.toml".as_ref(), &set)?;
    let (model, paths) = (&scenario.model, (0..PATHS).collect::<Vec<u64>>());
    let kernel = DiscreteSimulation::new(model, &scenario.timeline(), h);
    let programs: [(&str, &dyn Fn()); 6] = [
        ("kernel", &|| drop(black_box(kernel.simulate(1, &paths, &mut Deaf)))),
        ("f64, its normals", &|| drop(black_box(simulate::<f64, Own>(model, h, STEPS, 1, PATHS)))),
        ("f64, four bytes", &|| drop(black_box(simulate::<f64, Bytes>(model, h, STEPS, 1, PATHS)))),
        ("f32, its normals", &|| drop(black_box(simulate::<f32, Own>(model, h, STEPS, 1, PATHS)))),
        ("f32, inversion", &|| drop(black_box(simulate::<f32, Inverse>(model, h, STEPS, 1, PATHS)))),
        ("f32, four bytes", &|| drop(black_box(simulate::<f32, Bytes>(model, h, STEPS, 1, PATHS)))),
    ];
    let mut least = [f64::INFINITY; 6];
    for _ in 0..40 {
        for (least, (_, program)) in least.iter_mut().zip(&programs) {
            let start = Clock::now();
            program();
            *least = least.min(start.elapsed().as_secs_f64() * 1e9 / (PATHS * STEPS) as f64);
        }
    }
    println!("h = {h}");
    for (ns, (name, _)) in least.iter().zip(&programs) {
        println!("  {name:20} {ns:6.3} ns   kernel / this {:5.2}", least[0] / ns);
    }
    Ok(())
}

/// Compares both precisions on the same normals.
fn compare_precision(model: &Model, h: f64, end: f64, paths: u64) {
    let steps = (end / h).round() as u64;
    let double = simulate::<f64, Own>(model, h, steps, 1, paths);
    let single = simulate::<f32, Own>(model, h, steps, 1, paths);
    let differing = |read: fn(&Cascade) -> u64| double.iter().zip(&single).filter(|(d, s)| read(d) != read(s)).count();
    let (cascades, counts) = (differing(|c| c.signature), differing(|c| c.sticks));
    println!(
        "h = {h}, t_end = {end}, {paths} paths: {cascades} cascades differ, {counts} in the number of their sticks"
    );
    for (d, s) in estimates(h, end, &double).iter().zip(&estimates(h, end, &single)) {
        let change: Vec<f64> = d.parts.iter().zip(&s.parts).map(|(d, s)| s - d).collect();
        let (error, of_change) = (standard_error(&d.parts), standard_error(&change));
        println!(
            "  {:20} {:9.5} +- {error:.5}   f32 - f64 {:+.1e} +- {of_change:.1e}",
            d.name,
            d.value,
            s.value - d.value
        );
    }
}

/// Compares other normals with those of the crate. The paths are then different, so the ensembles
/// are independent.
fn compare_normals(model: &Model, h: f64, paths: u64) {
    let (end, steps) = (60.0, (60.0 / h).round() as u64);
    let own = estimates(h, end, &simulate::<f64, Own>(model, h, steps, 1, paths));
    println!("h = {h}, t_end = {end}, {paths} paths");
    for (name, others) in [
        ("f32, inversion", simulate::<f32, Inverse>(model, h, steps, 2, paths)),
        ("f64, four bytes", simulate::<f64, Bytes>(model, h, steps, 3, paths)),
    ] {
        for (own, other) in own.iter().zip(&estimates(h, end, &others)) {
            let error = standard_error(&own.parts).hypot(standard_error(&other.parts));
            println!("  {name}: {:20} {:9.5} {:+.5} +- {error:.5}", own.name, own.value, other.value - own.value);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    for h in [0.01, 0.001] {
        time(h)?;
    }
    let model = Scenario::read("scenarios/rho025.toml".as_ref(), &[])?.model;
    for (h, paths) in [(0.04, 8192), (0.01, 8192), (1e-3, 4096), (1e-4, 1024), (1e-5, 256), (1e-6, 32)] {
        compare_precision(&model, h, 60.0, paths);
    }
    compare_precision(&model, 0.01, 6000.0, 512);
    for (h, paths) in [(0.04, 131_072), (0.01, 65_536), (1e-3, 16_384)] {
        compare_normals(&model, h, paths);
    }
    Ok(())
}
