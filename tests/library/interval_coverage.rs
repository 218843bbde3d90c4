//! How often the 95 % intervals of runs of 10, 40 and 200 paths hold the truth, and how wide they are.
//!
//! `cargo test --release --test library interval_coverage:: -- --ignored --nocapture` prints the table;
//! docs/statistics.md has the lowest numbers of the last one.

use stickslip::ensemble::{BLOCK_SIZE, Plan};
use stickslip::scenario::Scenario;
use stickslip::scheme::{DEFAULT_TOLERANCE, EventDriven};
use stickslip::stats::{Record, Summary, Totals};
use stickslip::sums::Merge as _;

/// A shipped scene with everything that has an interval, on a coarse output grid.
fn plan(name: &str, output_step: f64, record: Record) -> Plan {
    let mut scenario = Scenario::shipped(name).expect("a shipped scene");
    scenario = scenario
        .with_scheme(EventDriven {
            tolerance: DEFAULT_TOLERANCE,
        })
        .expect("it fits");
    (
        scenario.time.output_step,
        scenario.ensemble.seed,
        scenario.record,
    ) = (output_step, 4242, record);
    scenario.plan()
}

/// The summary of these paths, in blocks.
fn summary(plan: &Plan, first: u64, paths: u64) -> Summary {
    let mut totals = Totals::empty(plan.model(), plan.timeline(), &plan.record);
    for begin in (first..first + paths).step_by(BLOCK_SIZE as usize) {
        totals.merge(
            &plan
                .piece(begin, BLOCK_SIZE.min(first + paths - begin))
                .totals,
        );
    }
    totals.summary()
}

/// A number with the ends of its interval.
type Row = (String, f64, [f64; 2]);

/// Every statistic, and autocovariances of x and x'.
fn rows(summary: &Summary) -> Vec<Row> {
    let spectrum = summary.spectrum.as_ref().expect("it is asked for");
    let curves = [
        ("x", &spectrum.displacement),
        ("velocity", &spectrum.velocity),
    ];
    let lags = curves
        .into_iter()
        .flat_map(|(name, curve)| [0, 1, 4].map(|lag| (name, curve, lag)));
    let lag = |(name, curve, lag): (&str, &stickslip::stats::Fluctuations, usize)| {
        (
            format!("autocovariance of {name}, lag {lag}"),
            curve.autocovariance[lag],
            curve.autocovariance_ends.at(lag),
        )
    };
    let statistics = summary
        .reported()
        .map(|e| (e.statistic.name().to_string(), e.estimate, [e.low, e.high]));
    statistics.chain(lags.map(lag)).collect()
}

/// Of these runs, the share that has an interval, the share of those that holds the truth, and the median
/// width.
fn coverage(runs: &[Vec<Row>], row: usize, truth: f64) -> [f64; 3] {
    let ends: Vec<[f64; 2]> = runs
        .iter()
        .map(|run| run[row].2)
        .filter(|ends| !ends[0].is_nan())
        .collect();
    let held = ends
        .iter()
        .filter(|[low, high]| *low <= truth && truth <= *high)
        .count() as f64;
    let mut widths: Vec<f64> = ends.iter().map(|[low, high]| high - low).collect();
    widths.sort_by(f64::total_cmp);
    let n = ends.len() as f64;
    [
        n / runs.len() as f64,
        held / n,
        widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN),
    ]
}

/// `incline`, `belt` and `rho025`: the truth from 100 000 paths, and 1000, 500 and 400 runs of 10, 40 and
/// 200 paths. It prints the share of the intervals that hold the truth, that of the runs that have one,
/// and the median width.
///
/// Null: 95 %. A cell of 400 or more intervals fails below 90 %, which is 4.6 standard errors; what
/// phases depend on that few paths have is left out (docs/statistics.md).
#[test]
#[ignore = "a measurement of two minutes"]
fn intervals_of_few_paths_hold_the_truth_or_are_absent() {
    let record = Record {
        laws: true,
        energy: true,
        spectrum: true,
        ..Record::NOTHING
    };
    let mut worst = Vec::new();
    for (name, output_step) in [("incline", 5.0), ("belt", 5.0), ("rho025", 2.0)] {
        let plan = plan(name, output_step, record);
        let exact = rows(&summary(&plan, 1 << 40, 100_000));
        for (paths, number) in [(10, 1000), (40, 500), (200, 400)] {
            let run = |i: u64| rows(&summary(&plan, (paths << 24) + i * paths, paths));
            let runs: Vec<Vec<Row>> = (0..number).map(run).collect();
            for (row, (what, truth, _)) in exact.iter().enumerate() {
                let [present, held, width] = coverage(&runs, row, *truth);
                println!(
                    "{name} {paths:3} {what:34} {:5.1} % of {:5.1} %, {width:.3e}",
                    100.0 * held,
                    100.0 * present
                );
                let is_of_phases = ["slip", "stick", "jump", "recurrence"]
                    .iter()
                    .any(|of| what.contains(of));
                let is_known = present * number as f64 >= 400.0 && !what.contains("residual");
                if is_known && held < 0.9 && !(name == "belt" && is_of_phases && paths < 200) {
                    worst.push(format!("{name} {paths} {what}: {held}"));
                }
            }
        }
    }
    assert_eq!(worst, Vec::<String>::new());
}

/// The diffusion coefficient and the autocovariance of a body on an incline, whose influences are long
/// tailed and skewed, from 600 runs of ten paths. The truth is that of the test above.
///
/// Null: 92 % of the intervals hold it, as in the table of docs/validation.md. The share of 600 is then
/// above 88.5 % with a false-alarm rate of 8e-4 each. With the intervals of Student's t, it is 82 and
/// 80 %.
#[test]
fn intervals_of_ten_skewed_paths_hold_the_truth() {
    let plan = plan(
        "incline",
        5.0,
        Record {
            spectrum: true,
            ..Record::NOTHING
        },
    );
    let runs: Vec<Vec<Row>> = (0..600)
        .map(|i| rows(&summary(&plan, 10 * i, 10)))
        .collect();
    for (what, truth) in [
        ("diffusion_coefficient", 0.057_268),
        ("autocovariance of x, lag 0", 12.171),
    ] {
        let row = runs[0].iter().position(|row| row.0 == what).expect("a row");
        let [present, held, _] = coverage(&runs, row, truth);
        println!("{what}: {held} of {present}");
        assert!(held > 0.885 && present > 0.9, "{what}: {held} of {present}");
    }
}
