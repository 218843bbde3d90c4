//! Scenarios and measurements that several benchmarks use.

use criterion::{BenchmarkGroup, Criterion, Throughput, measurement::WallTime};
use std::hint::black_box;
use std::path::Path;
use std::time::Duration;
use stickslip::config::Override;
use stickslip::model::Event;
use stickslip::scenario::Scenario;
use stickslip::scheme::{Instant, Observer, Snapshot};

pub const STEP: &str = "time.step=0.001";
/// Long enough for the phases of the paths to mix, and short enough for many repetitions.
pub const END: &str = "time.end=12";
pub const STEPS: u64 = 12_000;

/// A scenario of the repository with these keys set.
pub fn scenario(name: &str, set: &[&str]) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenarios")
        .join(name)
        .with_extension("toml");
    let overrides: Vec<Override> = set
        .iter()
        .map(|s| Override::set(s).expect("well formed"))
        .collect();
    Scenario::read(&path, &overrides).expect("shipped")
}

/// An observer that ignores everything, to measure the kernel alone.
pub struct Deaf;

impl Observer for Deaf {
    fn event(&mut self, lane: usize, event: Event) {
        black_box((lane, event));
    }
    fn snapshot(&mut self, _: Instant, snapshot: Snapshot<'_>) {
        black_box(snapshot.displacement);
    }
}

pub fn group<'a>(c: &'a mut Criterion, name: &str, elements: u64) -> BenchmarkGroup<'a, WallTime> {
    let mut group = c.benchmark_group(name);
    group
        .throughput(Throughput::Elements(elements))
        .sample_size(20)
        .measurement_time(Duration::from_secs(3));
    group
}

/// Nanoseconds for each element, from the file that criterion has just written.
pub fn measured(group: &str, name: &str, elements: f64) -> Option<f64> {
    let folder = std::env::var("CARGO_TARGET_DIR").unwrap_or_else(|_| "target".into());
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(folder)
        .join("criterion")
        .join(group)
        .join(name);
    let text = std::fs::read_to_string(path.join("new/estimates.json")).ok()?;
    let (_, median) = text.split_once("\"median\":")?;
    let (_, point) = median.split_once("\"point_estimate\":")?;
    Some(point.split([',', '}']).next()?.parse::<f64>().ok()? / elements)
}
