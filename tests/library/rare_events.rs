//! How often the 95 % intervals of a run of few paths hold the truth where events are rare and come
//! in clusters: the forcing at resonance, with 0.2 to 0.5 sticks a path, most of them in a few
//! paths.
//!
//! `cargo test --release --test library rare_events:: -- --ignored --nocapture` prints the table.
//! Last result: 91.0 to 95.8 % for the mean stick, 91.4 to 97.6 % for the number of sticks.

use crate::common::paper;
use stickslip::ensemble::{BLOCK_SIZE, Plan};
use stickslip::model::Problem;
use stickslip::scheme::{DEFAULT_TOLERANCE, EventDriven, Scheme, Timeline};
use stickslip::stats::{Estimate, Record, Statistic, Totals};
use stickslip::sums::Merge as _;

/// A scene near the shipped one: its name, the frequency and the amplitude of the forcing, the
/// damping, the intensity of the noise, x0, f_s and the burn-in.
type Scene = (&'static str, [f64; 7]);

const SCENES: [Scene; 9] = [
    ("resonance", [1.0, 1.0, 0.0, 0.25, 6.0, 1.2, 0.0]),
    ("above it", [1.1, 1.0, 0.0, 0.25, 6.0, 1.2, 0.0]),
    ("clusters", [1.0, 0.6, 0.2, 0.4, 6.0, 1.2, 0.0]),
    ("strong noise", [1.0, 0.7, 0.1, 0.4, 6.0, 1.2, 0.0]),
    ("from rest", [1.0, 0.5, 0.0, 0.25, 0.0, 1.5, 0.0]),
    ("late 1", [1.0, 0.3, 0.05, 0.25, 6.0, 1.2, 20.0]),
    ("late 2", [1.0, 0.4, 0.15, 0.25, 6.0, 1.2, 20.0]),
    ("late 3", [1.0, 0.25, 0.0, 0.25, 6.0, 1.2, 20.0]),
    ("late 4", [1.0, 0.28, 0.03, 0.25, 6.0, 1.2, 20.0]),
];

fn plan(
    (
        _,
        [
            frequency,
            amplitude,
            damping,
            intensity,
            x0,
            static_force,
            after,
        ],
    ): Scene,
    seed: u64,
) -> Plan {
    let mut model: Problem = paper(frequency, intensity);
    model.temperature.harmonics[0].amplitude = amplitude;
    model.oscillator.damping = damping;
    model.initial_displacement = x0;
    model.friction.static_force = static_force;
    let timeline = Timeline {
        end: 60.0,
        output_step: 60.0,
        period: None,
        after,
    }
    .without_rows();
    let simulation = Scheme::from(EventDriven {
        tolerance: DEFAULT_TOLERANCE,
    })
    .simulation(&model, &timeline);
    Plan {
        simulation,
        record: Record::NOTHING,
        seed,
        paths: 1 << 40,
        antithetic: false,
    }
}

/// The totals of these paths, in blocks of that size.
fn totals(plan: &Plan, first: u64, paths: u64, block: u64) -> Totals {
    let mut totals = Totals::empty(plan.model(), plan.timeline(), &plan.record);
    for begin in (first..first + paths).step_by(block as usize) {
        totals.merge(&plan.piece(begin, block.min(first + paths - begin)).totals);
    }
    totals
}

const STATISTICS: [Statistic; 8] = [
    Statistic::StickDurationMean,
    Statistic::StickDurationSd,
    Statistic::SticksPerPath,
    Statistic::SlipsPerPath,
    Statistic::SubPhasesMean,
    Statistic::SubPhasesMultipleShare,
    Statistic::StickingFraction,
    Statistic::JumpAbsMean,
];

/// In these scenes, one slip in some hundreds has a jump of another size than all others, and the
/// mean depends on it. Most runs of 100 paths have no such slip and cannot know of it.
const UNSEEN: [&str; 3] = ["resonance", "above it", "strong noise"];

/// Null: every interval holds the truth, known from 100 000 paths, in at least 92 % of the 500 runs
/// that have an interval, for runs of 100 and of 300 paths. A cell fails if it is 3.5 standard
/// errors below, which happens by chance with a probability of 2e-4 each; with cells of fewer than
/// 100 runs left out, there are some 130.
///
/// The last result, of 250 runs beside 40 000 paths: 92.4 to 100 % at 100 paths and 89.6 to 100 % at
/// 300, and more than 94 % in most cells. What [`UNSEEN`] leaves out: 93.7, 91.6 and 18.6 % of the
/// runs of 100 paths that have an interval, which are 71 to 76 %; 96.1, 92.8 and 30.6 % at 300.
#[test]
#[ignore = "takes some minutes"]
fn intervals_of_rare_events_cover_92_percent() {
    const RUNS: u64 = 500;
    let mut worst: Vec<String> = Vec::new();
    for scene in SCENES {
        let exact = totals(&plan(scene, 77), 0, 100_000, BLOCK_SIZE);
        for paths in [100, 300] {
            let plan = plan(scene, paths);
            let runs: Vec<Vec<Estimate>> = (0..RUNS)
                .map(|run| {
                    let totals = totals(&plan, run * paths, paths, BLOCK_SIZE);
                    STATISTICS
                        .iter()
                        .map(|&statistic| totals.estimate(statistic))
                        .collect()
                })
                .collect();
            print!("{:12} {paths}", scene.0);
            for (i, statistic) in STATISTICS.into_iter().enumerate() {
                let truth = exact.estimate(statistic).estimate;
                let known: Vec<&Estimate> = runs
                    .iter()
                    .map(|run| &run[i])
                    .filter(|e| !e.low.is_nan())
                    .collect();
                let held = known
                    .iter()
                    .filter(|e| e.low <= truth && truth <= e.high)
                    .count() as f64;
                let (n, share) = (known.len() as f64, held / known.len() as f64);
                print!(
                    "  {} {:.1} ({:.0})",
                    statistic.name(),
                    100.0 * share,
                    100.0 * n / RUNS as f64
                );
                let may_miss = statistic == Statistic::JumpAbsMean && UNSEEN.contains(&scene.0);
                if n >= 100.0 && !may_miss && share < 0.92 - 3.5 * (0.92 * 0.08 / n).sqrt() {
                    worst.push(format!(
                        "{} {paths} {} {share:.3}",
                        scene.0,
                        statistic.name()
                    ));
                }
            }
            println!();
        }
    }
    assert!(worst.is_empty(), "{worst:#?}");
}
