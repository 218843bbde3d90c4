//! Sweeps: points equal single runs, and differences have the errors of common noise.

use std::convert::Infallible;
use std::sync::atomic::{AtomicBool, Ordering};
use stickslip::config::Override;
use stickslip::engine::Run;
use stickslip::scenario::Scenario;
use stickslip::stats::{Estimate, Statistic};
use stickslip::study::sweep::{
    Design, Point, Seeds, Sweep, SweepAxis, SweepQuestion, SweepSimulation,
};

/// A shipped scenario with these keys set.
fn scenario(name: &str, set: &[&str]) -> Scenario {
    let overrides: Vec<Override> = set
        .iter()
        .map(|text| Override::set(text).expect("a key and a value"))
        .collect();
    let path = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Scenario::read(path.as_ref(), &overrides).expect("a sound scenario")
}

/// A sweep of a shipped scenario over some axes.
fn sweep(name: &str, set: &[&str], axes: &[&str], seeds: Seeds) -> Sweep {
    let axes = axes
        .iter()
        .map(|axis| SweepAxis::parse(axis, |_| None).expect("an axis"))
        .collect();
    let design = Design::of(axes, false).expect("a design");
    question(name, set, design, seeds)
}

fn question(name: &str, set: &[&str], design: Design, seeds: Seeds) -> Sweep {
    let point = |i: usize| {
        let own: Vec<String> = design
            .settings(i)
            .iter()
            .map(|s| format!("{}={}", s.key, s.value))
            .collect();
        scenario(
            name,
            &set.iter()
                .copied()
                .chain(own.iter().map(String::as_str))
                .collect::<Vec<_>>(),
        )
    };
    let points = (0..design.points()).map(point).collect();
    Sweep::new(SweepQuestion::new(
        scenario(name, set),
        design,
        points,
        seeds,
        true,
    ))
}

/// Simulates a sweep to its end on so many threads.
fn simulated(mut sweep: Sweep, threads: usize) -> Sweep {
    let stop = AtomicBool::new(false);
    let simulation = SweepSimulation {
        threads,
        stop: &stop,
        progress: &mut (),
        blocks: None,
    };
    simulation
        .run(&mut sweep, |_| Ok::<_, Infallible>(()))
        .expect("nobody fails");
    assert!(sweep.is_complete());
    sweep
}

fn bits(x: f64) -> u64 {
    // All NaNs count as equal.
    if x.is_nan() { 0 } else { x.to_bits() }
}

fn estimate_bits(e: &Estimate) -> Vec<u64> {
    let bias = e
        .bias
        .map_or([f64::NAN; 2], |bias| [bias.estimate, bias.uncertainty]);
    [
        e.estimate,
        e.standard_error,
        e.low,
        e.high,
        bias[0],
        bias[1],
    ]
    .map(bits)
    .to_vec()
}

/// The bits of a point, without its CPU time.
fn point_bits(point: &Point) -> Vec<u64> {
    let mut all: Vec<u64> = point.estimates.iter().flat_map(estimate_bits).collect();
    all.extend(point.without.iter().flatten().copied().map(bits));
    all.extend([point.completed_paths, point.diverged_paths]);
    all
}

fn sweep_bits(sweep: &Sweep) -> Vec<Vec<u64>> {
    sweep
        .points
        .iter()
        .map(|point| point_bits(point.as_ref().expect("done")))
        .collect()
}

const SHORT: [&str; 3] = ["time.end=20", "time.output_step=20", "ensemble.paths=800"];

#[test]
fn a_point_is_the_run_of_its_scenario_with_its_bias() {
    for scheme in [
        "discrete-vi",
        "corrected-vi",
        "event-driven",
        "quasi-static",
    ] {
        let kind = format!("scheme.kind={scheme}");
        let set = [&SHORT[..], &[&kind, "temperature.noise.intensity=0.5"]].concat();
        let sweep = simulated(
            sweep("rho025", &set, &["friction.static=1.2,1.4"], Seeds::Common),
            2,
        );
        for (scenario, point) in sweep.question.points.iter().zip(&sweep.points) {
            let run = Run::of(scenario).simulate().expect("it runs").summary;
            let point = point.as_ref().expect("done");
            for (run, point) in run.estimates.iter().zip(&point.estimates) {
                assert_eq!(
                    estimate_bits(run),
                    estimate_bits(point),
                    "{scheme}, {}",
                    run.statistic.name()
                );
            }
            assert_eq!(point.completed_paths, 800);
        }
    }
}

#[test]
fn no_bit_depends_on_threads_or_interruptions() {
    let axes = [
        "rho=temperature.noise.intensity=0,0.1,0.25",
        "friction.static=1.1,1.2",
    ];
    let sweep = || sweep("rho025", &SHORT, &axes, Seeds::Common);
    let whole = simulated(sweep(), 1);
    for threads in [2, 3, 8, 32] {
        assert_eq!(
            sweep_bits(&simulated(sweep(), threads)),
            sweep_bits(&whole),
            "{threads} threads"
        );
    }
    // The sweep is stopped after each point and continued by another process, which starts with the
    // points that are done.
    let mut parts = sweep();
    let mut stops = 0;
    while !parts.is_complete() {
        let stop = AtomicBool::new(false);
        let simulation = SweepSimulation {
            threads: 3,
            stop: &stop,
            progress: &mut (),
            blocks: None,
        };
        let tell = |_: &Sweep| {
            stop.store(true, Ordering::Relaxed);
            Ok::<_, Infallible>(())
        };
        simulation.run(&mut parts, tell).expect("nobody fails");
        stops += 1;
    }
    assert!(stops > 1);
    assert_eq!(sweep_bits(&parts), sweep_bits(&whole));
}

/// Null hypothesis: the error of a mean that follows from the groups equals the one that the run
/// reports from its independent units. The groups determine it to 13 % (31 degrees of freedom), of
/// which four are allowed. False-alarm rate: 6e-5 for each comparison. Groups that separated the
/// paths of pairs would be off by a factor of 2.6 for the displacement, for which antithetic noise
/// reduces the error most.
#[test]
fn groups_have_the_errors_of_a_run_also_for_pairs() {
    for antithetic in ["false", "true"] {
        let pairs = format!("ensemble.antithetic={antithetic}");
        let set = [&SHORT[..], &[&pairs]].concat();
        let sweep = simulated(
            sweep("rho025", &set, &["friction.static=1.2,1.4"], Seeds::Common),
            2,
        );
        for (scenario, point) in sweep
            .question
            .points
            .iter()
            .zip(sweep.points.iter().flatten())
        {
            let run = Run::of(scenario).simulate().expect("it runs").summary;
            for statistic in [
                Statistic::DisplacementEndMean,
                Statistic::SticksPerPath,
                Statistic::FrictionWorkMean,
            ] {
                let i = statistic.index();
                assert_eq!(
                    estimate_bits(run.estimate(statistic)),
                    estimate_bits(&point.estimates[i])
                );
                let values: Vec<f64> = point.without.iter().map(|values| values[i]).collect();
                let mean = values.iter().sum::<f64>() / 32.0;
                let error =
                    (31.0 / 32.0 * values.iter().map(|x| (x - mean).powi(2)).sum::<f64>()).sqrt();
                let ratio = error / point.estimates[i].standard_error;
                println!("{antithetic} {}: {ratio:.2}", statistic.name());
                assert!(
                    (0.48..1.52).contains(&ratio),
                    "{antithetic}, {}: {ratio}",
                    statistic.name()
                );
            }
        }
    }
}

#[test]
fn independent_points_have_seeds_of_their_own() {
    let sweep = sweep(
        "rho025",
        &SHORT,
        &["friction.static=1.2,1.3,1.4"],
        Seeds::Independent,
    );
    let seeds: Vec<u64> = sweep
        .question
        .points
        .iter()
        .map(|point| point.ensemble.seed)
        .collect();
    assert_eq!(seeds, [1, 2, 3]);
}

/// The statistics whose paired errors are compared with the scatter over many seeds: means, ratios,
/// a standard deviation, a slope, a median.
const HELD: [Statistic; 8] = [
    Statistic::StickDurationMean,
    Statistic::StickDurationMedian,
    Statistic::StickDurationSd,
    Statistic::SubPhasesMultipleShare,
    Statistic::SticksPerPath,
    Statistic::StickingFraction,
    Statistic::DisplacementEndSd,
    Statistic::JumpAbsMean,
];

/// The estimates of a number for many seeds, with the error, the interval and the gain of each.
#[derive(Default)]
struct Seen {
    estimates: Vec<f64>,
    errors: Vec<f64>,
    intervals: Vec<[f64; 2]>,
    gains: Vec<f64>,
    /// The number from points that have different seeds.
    independent: Vec<f64>,
}

impl Seen {
    /// The share of intervals that hold the mean over all seeds; and the mean square of the errors
    /// divided by the variance of the estimates.
    fn coverage_and_ratio(&self) -> (f64, f64) {
        let (n, (mean, variance)) = (
            self.estimates.len() as f64,
            mean_and_variance(&self.estimates),
        );
        let held = self
            .intervals
            .iter()
            .filter(|[low, high]| *low <= mean && mean <= *high)
            .count() as f64;
        (
            held / n,
            self.errors.iter().map(|e| e * e).sum::<f64>() / n / variance,
        )
    }

    /// The mean of the variances that the number is said to have if its points are independent.
    fn told_independent(&self) -> f64 {
        let told = self
            .gains
            .iter()
            .zip(&self.errors)
            .map(|(gain, error)| gain * error * error);
        told.sum::<f64>() / self.gains.len() as f64
    }

    /// Null hypothesis: intervals hold the truth, here the mean over all seeds, with 95 %, and the
    /// mean square of the reported errors is the variance of the estimates. Sample size: 500 seeds.
    /// Bounds: for the share, four binomial standard deviations, 3.9 %, and 1.5 % for the skewness
    /// of 320 paths; for the ratio, four times the 6.3 % to which 500 seeds determine it, and 10 %
    /// by which a jackknife overestimates the error of ratios. False-alarm rate: 6e-5 for each.
    /// With twice the error 99.99 % would hold, and the ratio would be 4; with half of it 68 %
    /// would hold.
    fn check(&self, what: &str) {
        let (coverage, ratio) = self.coverage_and_ratio();
        println!(
            "{what}: holds {:.1} %, error^2 over variance {ratio:.3}",
            100.0 * coverage
        );
        assert!((coverage - 0.95).abs() < 0.054, "{what}: {coverage}");
        assert!((0.75..1.35).contains(&ratio), "{what}: {ratio}");
    }

    /// Null hypothesis: the gain times the square of the error is the variance of the number from
    /// points that have different seeds. The seeds are the same 500, each point from another one.
    /// Bounds: those of the ratio above, for the same reasons.
    fn check_gain(&self, what: &str) {
        let ratio = self.told_independent() / mean_and_variance(&self.independent).1;
        println!("{what}: variance of independent points, told over seen {ratio:.3}");
        assert!((0.75..1.35).contains(&ratio), "{what}: {ratio}");
    }
}

fn mean_and_variance(x: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    (
        mean,
        x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0),
    )
}

#[test]
fn paired_intervals_hold_what_many_seeds_show() {
    let base = [
        "time.end=30",
        "time.output_step=30",
        "ensemble.paths=320",
        "scheme.kind=event-driven",
    ];
    let star = |seed: u64| {
        let seed = format!("ensemble.seed={}", 1000 + seed);
        let set = [&base[..], &[&seed]].concat();
        let key = ("temperature.noise.intensity".to_string(), 0.25);
        let star = Design::Star {
            keys: vec![key],
            relative_step: 0.05,
        };
        simulated(question("rho025", &set, star, Seeds::Common), 2)
    };
    let stars: Vec<Sweep> = (0..500).map(star).collect();
    let mut differences: Vec<Seen> = HELD.map(|_| Seen::default()).into();
    let mut elasticities: Vec<Seen> = HELD.map(|_| Seen::default()).into();
    let mut pooled: Vec<Vec<f64>> = HELD.map(|_| Vec::new()).into();
    for (seed, sweep) in stars.iter().enumerate() {
        // The centre from this seed, the point below it from the next one, and so on.
        let points = (0..3)
            .map(|i| stars[(seed + i) % stars.len()].points[i].clone())
            .collect();
        let apart = Sweep {
            points,
            ..sweep.clone()
        };
        for (i, statistic) in HELD.into_iter().enumerate() {
            let both = |sweep: &Sweep| {
                let elasticity = sweep.elasticity(0, statistic).expect("its points are done");
                [
                    elasticity,
                    as_line(sweep)
                        .difference(1, 0, statistic)
                        .expect("both are done"),
                ]
            };
            let seen = [&mut elasticities[i], &mut differences[i]];
            for (seen, (paired, apart)) in seen
                .into_iter()
                .zip(both(sweep).into_iter().zip(both(&apart)))
            {
                let m = paired.measurement;
                seen.estimates.push(m.estimate);
                seen.errors.push(m.standard_error);
                seen.intervals.push([m.low, m.high]);
                seen.gains.push(paired.gain);
                seen.independent.push(apart.measurement.estimate);
            }
            // Of both differences along the line together: the sum of the variances of independent
            // points over the sum of the variances.
            let line = as_line(sweep);
            let errors = [0, 1].map(|p| {
                line.difference(p, 0, statistic)
                    .expect("done")
                    .measurement
                    .standard_error
            });
            pooled[i].push(line.gain(0, statistic) * errors.iter().map(|e| e * e).sum::<f64>());
        }
    }
    for (i, statistic) in HELD.into_iter().enumerate() {
        for (seen, what) in [
            (&differences[i], "difference"),
            (&elasticities[i], "elasticity"),
        ] {
            seen.check(&format!("{what} of {}", statistic.name()));
            seen.check_gain(&format!("{what} of {}", statistic.name()));
        }
        // The two differences of the line have independent points of nearly the same variance.
        let ratio = mean_and_variance(&pooled[i]).0
            / (2.0 * mean_and_variance(&differences[i].independent).1);
        println!(
            "pooled gain of {}: told over seen {ratio:.3}",
            statistic.name()
        );
        assert!(
            (0.75..1.35).contains(&ratio),
            "{}: {ratio}",
            statistic.name()
        );
    }
}

/// The sweep of a star of one key as a line.
fn as_line(star: &Sweep) -> Sweep {
    Sweep {
        question: SweepQuestion {
            design: line(),
            ..star.question.clone()
        },
        ..star.clone()
    }
}

/// The points of a star of one key as a line: the centre, below it, above it.
fn line() -> Design {
    let axis = SweepAxis {
        name: "rho".into(),
        key: "rho".into(),
        values: vec![1.0, 2.0, 3.0].into(),
    };
    Design::of(vec![axis], false).expect("a line")
}
