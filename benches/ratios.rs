//! Every speed that the documentation claims, in one run, and the ratios between them.
//!
//! `cargo bench --bench ratios` takes about three minutes on two cores. Absolute times depend on
//! the machine and on what else runs there; the documentation quotes the ratios at the end.

#[path = "common/mod.rs"]
mod common;

use common::{Deaf, END, STEP, STEPS, group, measured, scenario};
use criterion::{Criterion, Throughput};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::{Pcg64, rand_core::SeedableRng};
use std::path::Path;
use std::time::Duration;
use stickslip::engine::{Provenance, Run, Status};
use stickslip::ensemble::{BLOCK_SIZE, Plan};
use stickslip::lanes::{InstructionSet, LaneProgram, Lanes};
use stickslip::noise::LaneStreams;
use stickslip::scenario::Scenario;
use stickslip::scheme::{DiscreteSimulation, EventDriven, Simulate as _};
use stickslip::stats::{BlockResult, Totals};
use stickslip::sums::Merge as _;
use stickslip_files::store::{FileSink, Writer};

/// The straightforward loop: one path at a time, `rand_pcg` and the ziggurat of `rand_distr`,
/// forcing from a table, sticks counted and their durations summed. The parameters are those of set
/// (P) of the paper, with rho = 0.25 and forcing 1/4.
fn scalar_loop(h: f64, steps: usize, paths: u64, forcing: &[f64]) -> (f64, f64) {
    let (decay, increment_sd) = ((-h).exp(), ((1.0 - (-2.0 * h).exp()) / 2.0).sqrt());
    let (f_s, f_d) = (1.2, 1.0);
    let (mut sticks, mut duration) = (0.0, 0.0);
    for path in 0..paths {
        let mut rng = Pcg64::seed_from_u64(path);
        let (mut x, mut v, mut noise) = (6.0, 0.0f64, 0.0);
        let mut b: f64 = forcing[0] - x;
        let (mut is_static, mut entered) = (true, f64::NAN);
        for n in 0..steps {
            let s = v + h * b;
            let next_x = x + h * v;
            let next_v = if s.abs() <= h * f_s {
                0.0
            } else {
                s - (h * f_d).copysign(s)
            };
            let xi: f64 = StandardNormal.sample(&mut rng);
            noise = decay * noise + increment_sd * xi;
            b = forcing[n + 1] + 1.5 * noise - next_x;
            if is_static {
                if next_v != 0.0 {
                    is_static = false;
                    if entered >= 0.0 {
                        sticks += 1.0;
                        duration += n as f64 * h - entered;
                    }
                }
            } else if next_v == 0.0 && b.abs() <= f_s {
                is_static = true;
                entered = (n + 1) as f64 * h;
            }
            (x, v) = (next_x, next_v);
        }
    }
    (sticks, duration)
}

/// Draws 64 steps of 32 lanes, and adds them up.
struct Normals {
    streams: LaneStreams,
    sums: [f64; 8],
}

impl LaneProgram for Normals {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        for lane in (0..32).step_by(2 * L::WIDTH) {
            let mut normals = self.streams.take::<L, 2>(lane);
            let mut sums = [L::splat(0.0); 2];
            for _ in 0..64 {
                let [a, b] = normals.draw();
                sums = [sums[0].add(a), sums[1].add(b)];
            }
            sums[0].add(sums[1]).store(&mut self.sums);
            self.streams.put(lane, &normals);
        }
    }
}

fn normals(c: &mut Criterion) {
    let mut group = group(c, "normals", 32 * 64);
    for set in InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available())
    {
        let paths: Vec<u64> = (0..32).collect();
        let mut normals = Normals {
            streams: LaneStreams::new(1, &paths, 32),
            sums: [0.0; 8],
        };
        group.bench_function(set.name(), |b| b.iter(|| set.run(&mut normals)));
    }
    group.bench_function("rand_pcg and rand_distr", |b| {
        let mut rng = Pcg64::seed_from_u64(1);
        b.iter(|| {
            (0..32 * 64)
                .map(|_| -> f64 { StandardNormal.sample(&mut rng) })
                .sum::<f64>()
        })
    });
}

/// The time of a path-step of the bare kernel on a block of paths.
fn kernel(c: &mut Criterion) {
    let mut group = group(c, "kernel", BLOCK_SIZE * STEPS);
    let paths: Vec<u64> = (0..BLOCK_SIZE).collect();
    let mut bench = |name: &str, set: InstructionSet, scenario: &Scenario| {
        let step = scenario.scheme.step().expect("a time-stepping scheme");
        let simulation = DiscreteSimulation::new(&scenario.model, &scenario.timeline(), step)
            .with_instructions(set);
        group.bench_function(name, |b| {
            b.iter(|| simulation.simulate(1, &paths, &mut Deaf))
        });
    };
    let noisy = scenario("rho025", &[STEP, END]);
    for set in InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available())
    {
        bench(set.name(), set, &noisy);
    }
    bench(
        "plain",
        InstructionSet::detect(),
        &scenario("shaw", &[STEP, END]),
    );
    // A polynomial of eight operations.
    let forced = scenario(
        "rho025",
        &[
            STEP,
            END,
            "force.expression=0.01+x*(0.02-x*(0.003+x*(0.004+xdot*0.005)))",
        ],
    );
    for set in InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available())
    {
        bench(&format!("{} with a force", set.name()), set, &forced);
    }
    let forcing: Vec<f64> = (0..=STEPS)
        .map(|n| 6.0 * (0.25 * 0.001 * n as f64).cos())
        .collect();
    group.throughput(Throughput::Elements(16 * STEPS));
    group.bench_function("scalar loop", |b| {
        b.iter(|| scalar_loop(0.001, STEPS as usize, 16, &forcing))
    });
}

/// The time of a path of the event-driven scheme, with a force of one's own and without.
fn event_driven(c: &mut Criterion) {
    let mut group = group(c, "event-driven", BLOCK_SIZE);
    let paths: Vec<u64> = (0..BLOCK_SIZE).collect();
    for (name, set) in [
        ("linear", &[][..]),
        (
            "cubic spring",
            &["force.expression=-0.02*x^3", "initial.displacement=4"],
        ),
    ] {
        let scenario = scenario("rho025", set)
            .with_scheme(EventDriven { tolerance: 1e-3 })
            .expect("goes together");
        let simulation = scenario
            .scheme
            .simulation(&scenario.model, &scenario.timeline().without_rows());
        group.bench_function(name, |b| {
            b.iter(|| simulation.simulate(1, &paths, &mut Deaf))
        });
    }
}

/// The time of a path-step with everything that a run does except writing the file.
fn statistics(c: &mut Criterion) {
    let paths = BLOCK_SIZE;
    let mut group = group(c, "statistics", paths * STEPS);
    let plan = Plan {
        paths,
        ..scenario("rho025", &[STEP, END]).plan()
    };
    group.bench_function("default", |b| b.iter(|| plan.block(0)));
}

/// The time of a whole run of 10 000 paths with all default statistics, t_end = 60, h = 0.001,
/// including the file.
fn whole_run(c: &mut Criterion) {
    let scenario = scenario("rho025", &[STEP]);
    let mut group = group(c, "whole run", 10_000 * 60_000);
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(12));
    let folder = tempfile::tempdir().expect("a temporary folder");
    for threads in [1, 2] {
        let target = folder.path().join("run.h5");
        group.bench_function(format!("{threads} threads"), |b| {
            b.iter(|| run(&scenario, threads, &target))
        });
    }
}

/// The time of writing what a run hands to the store: the numbers of 10 000 paths, the statistics,
/// and closing the file.
fn writing(c: &mut Criterion) {
    let scenario = scenario("rho025", &[STEP]);
    let plan = Plan {
        paths: 10_000,
        ..common::scenario("rho025", &["time.step=0.05"]).plan()
    };
    let blocks: Vec<BlockResult> = (0..plan.blocks()).map(|k| plan.block(k)).collect();
    let mut totals = Totals::empty(plan.model(), plan.timeline(), &plan.record);
    blocks.iter().for_each(|block| totals.merge(&block.totals));
    let summary = totals.summary();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let target = folder.path().join("written.h5");
    let mut group = group(c, "writing", 10_000 * 60_000);
    group.bench_function("10000 paths", |b| {
        b.iter(|| {
            // A file that is there already is not written over. The first time, there is none.
            let _ = std::fs::remove_file(&target);
            let mut writer =
                Writer::create(&target, &Provenance::of(&scenario), &scenario.record, false)
                    .expect("writable");
            blocks
                .iter()
                .for_each(|block| writer.append(&block.rows).expect("room"));
            writer.finish(&summary, Status::Complete).expect("room");
        })
    });
}

fn run(scenario: &Scenario, threads: usize, target: &Path) {
    let mut file = FileSink::new(target, true);
    let outcome = Run::of(scenario)
        .threads(threads)
        .without_bias()
        .into_sink(&mut file)
        .simulate()
        .expect("room");
    assert_eq!(outcome.summary.completed_paths, scenario.ensemble.paths);
}

/// What a ratio must be.
enum Target {
    AtMost(f64),
    AtLeast(f64),
    Unbounded,
}

use Target::{AtLeast, AtMost, Unbounded};

impl Target {
    /// The target in words, and whether this ratio misses it.
    fn verdict(&self, ratio: f64) -> String {
        let (words, bound, is_missed) = match *self {
            AtMost(bound) => ("at most", bound, ratio > bound),
            AtLeast(bound) => ("at least", bound, ratio < bound),
            Unbounded => return String::new(),
        };
        let mark = if is_missed { ": MISSED" } else { "" };
        format!("{words} {bound}{mark}")
    }
}

/// The name of the processor, its family and model, and the number of cores.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let value = |key: &str| {
        let line = text
            .lines()
            .find(|line| line.split('\t').next() == Some(key));
        let value = line.and_then(|line| Some(line.split_once(": ")?.1));
        value.unwrap_or("unknown").to_string()
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let [name, family, model] = ["model name", "cpu family", "model"].map(value);
    let (set, lookup) = (
        InstructionSet::detect().name(),
        InstructionSet::lookup_name(),
    );
    format!("{name} (family {family}, model {model}), {cores} cores, {set}, {lookup}")
}

fn print_ratios() {
    let block = (BLOCK_SIZE * STEPS) as f64;
    let kernel = |name: &str| measured("kernel", name, block);
    let normal = |name: &str| measured("normals", name, 2048.0);
    let scalar = measured("kernel", "scalar loop", (16 * STEPS) as f64);
    let whole = |threads: u32| measured("whole run", &format!("{threads} threads"), 6e8);
    let lines: [(&str, Option<f64>, Option<f64>, Target); 12] = [
        (
            "kernel AVX-512 / its normals",
            kernel("AVX-512"),
            normal("AVX-512"),
            AtMost(1.6),
        ),
        (
            "scalar loop / kernel AVX-512",
            scalar,
            kernel("AVX-512"),
            AtLeast(7.0),
        ),
        (
            "scalar loop / kernel AVX2",
            scalar,
            kernel("AVX2"),
            AtLeast(3.5),
        ),
        (
            "scalar loop / whole run, 1 thread",
            scalar,
            whole(1),
            AtLeast(6.0),
        ),
        (
            "whole run, 1 thread / 2 threads",
            whole(1),
            whole(2),
            AtLeast(1.9),
        ),
        (
            "statistics / kernel",
            measured("statistics", "default", block),
            kernel(InstructionSet::detect().name()),
            AtMost(1.25),
        ),
        (
            "file / whole run, 1 thread",
            measured("writing", "10000 paths", 6e8),
            whole(1),
            AtMost(0.1),
        ),
        (
            "with a force / kernel AVX-512",
            kernel("AVX-512 with a force"),
            kernel("AVX-512"),
            AtMost(2.5),
        ),
        (
            "with a force / kernel AVX2",
            kernel("AVX2 with a force"),
            kernel("AVX2"),
            AtMost(2.5),
        ),
        (
            "event-driven, cubic spring / linear",
            measured("event-driven", "cubic spring", BLOCK_SIZE as f64),
            measured("event-driven", "linear", BLOCK_SIZE as f64),
            AtMost(4.0),
        ),
        (
            "no noise / noise",
            kernel("plain"),
            kernel(InstructionSet::detect().name()),
            Unbounded,
        ),
        (
            "normals: rand_distr / ours",
            normal("rand_pcg and rand_distr"),
            normal(InstructionSet::detect().name()),
            Unbounded,
        ),
    ];
    println!(
        "\n{}\n{:36} {:>9} {:>9} {:>7}  target",
        processor(),
        "ratio",
        "ns",
        "ns",
        "ratio"
    );
    for (name, a, b, target) in lines {
        match (a, b) {
            (Some(a), Some(b)) => {
                let (ratio, target) = (a / b, target.verdict(a / b));
                println!("{name:36} {a:9.3} {b:9.3} {ratio:7.2}  {target}");
            }
            _ => println!("{name:36} not measured here"),
        }
    }
}

fn main() {
    let mut c = Criterion::default()
        .configure_from_args()
        .warm_up_time(Duration::from_secs(1));
    normals(&mut c);
    kernel(&mut c);
    event_driven(&mut c);
    statistics(&mut c);
    whole_run(&mut c);
    writing(&mut c);
    c.final_summary();
    print_ratios();
}
