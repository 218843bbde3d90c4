//! The estimated bias of the step compared with values that are known without a step: from the
//! event-driven scheme, and from the exact cascade.

use crate::common::{estimate, event_driven_summary, paper, reference};
use std::sync::atomic::AtomicBool;
use stickslip::bias::{BiasPlan, Differences, NoBias, ReferenceRun};
use stickslip::engine::Run;
use stickslip::ensemble::Plan;
use stickslip::model::{Drive, InitialNoise, OrnsteinUhlenbeck, Problem};
use stickslip::scenario::Scenario;
use stickslip::scheme::{
    CorrectedVi, DEFAULT_TOLERANCE, DiscreteVi, EventDriven, Scheme, Simulate as _, Timeline,
};
use stickslip::stats::{Bias, Record, Statistic, Summary};

const STATISTICS: [Statistic; 5] = [
    Statistic::StickDurationMean,
    Statistic::SticksPerPath,
    Statistic::SubPhasesMean,
    Statistic::SubPhasesMultipleShare,
    Statistic::StickingFraction,
];

/// The values at zero step for rho = 0.25, forcing 1/4 and t_end = 60, with standard errors
/// (tests/reference/noisy.c).
fn truth(statistic: &Statistic) -> (f64, f64) {
    reference::limit(statistic.name())
}

/// The values of `discrete-vi` at a step, with standard errors: `mc run scenarios/rho025.toml
/// --seed 11 --step H --paths N`.
struct AtStep {
    h: f64,
    values: [(f64, f64); 5],
}

/// From 400 000 paths at h >= 0.005, 200 000 at 0.0025, and 150 000 at 0.001.
#[rustfmt::skip]
const AT_STEP: [AtStep; 6] = [
    AtStep { h: 0.04, values: [(0.640581, 0.00028), (11.7086, 0.0053), (1.4704, 0.00041), (0.293645, 0.0002), (0.143595, 7.1e-05)] },
    AtStep { h: 0.02, values: [(0.579362, 0.00025), (13.0938, 0.0059), (1.39346, 0.00035), (0.256654, 0.00018), (0.143538, 7e-05)] },
    AtStep { h: 0.01, values: [(0.538747, 0.00023), (14.1098, 0.0063), (1.35062, 0.00032), (0.23335, 0.00017), (0.142772, 6.9e-05)] },
    AtStep { h: 0.005, values: [(0.512158, 0.00021), (14.8133, 0.0067), (1.32804, 0.0003), (0.220407, 0.00016), (0.141808, 6.9e-05)] },
    AtStep { h: 0.0025, values: [(0.493337, 0.00029), (15.3471, 0.0098), (1.3146, 0.0004), (0.212515, 0.00022), (0.140988, 9.7e-05)] },
    AtStep { h: 0.001, values: [(0.476148, 0.00032), (15.8587, 0.012), (1.30339, 0.00045), (0.205501, 0.00025), (0.140213, 0.00011)] },
];

fn timeline(model: &Problem) -> Timeline {
    Timeline {
        end: 60.0,
        output_step: 60.0,
        period: model.temperature.period(),
        after: 0.0,
    }
}

fn plain(h: f64) -> Scheme {
    DiscreteVi { step: h }.into()
}

fn corrected(h: f64) -> Scheme {
    CorrectedVi { step: h }.into()
}

fn plan(h: f64, seed: u64, paths: u64) -> Differences {
    let model = paper(0.25, 0.25);
    Differences::new(plain(h), &model, &timeline(&model), seed, paths).expect("enough paths")
}

fn biases(plan: &Differences, threads: usize) -> Vec<(Statistic, Bias)> {
    plan.estimate(threads, &AtomicBool::new(false))
        .expect("none diverges")
}

fn of(biases: &[(Statistic, Bias)], statistic: Statistic) -> Bias {
    biases
        .iter()
        .find(|(s, _)| *s == statistic)
        .expect("it has a bias")
        .1
}

/// The number of statistics that exist in two forcing periods. There is no correlation from one
/// period to the next.
const EXISTING: usize = 20;

/// The biases that a run of the discrete scheme, corrected or not, reports with the rows of the
/// shipped scene, which are a part of its cost. No row is needed here, so none is simulated.
fn reported(
    model: &Problem,
    scheme: Scheme,
    seed: u64,
    paths: u64,
    threads: usize,
) -> Vec<(Statistic, Bias)> {
    let run = run(model, scheme, seed, paths, threads);
    let with_rows = Timeline {
        output_step: 0.5,
        ..timeline(model)
    };
    let plan = BiasPlan::new(scheme, model, &with_rows, seed, paths).expect("enough paths");
    plan.estimate(&run, threads, &AtomicBool::new(false))
        .expect("none diverges")
}

fn run(model: &Problem, scheme: Scheme, seed: u64, paths: u64, threads: usize) -> Summary {
    let simulation = scheme.simulation(model, &timeline(model));
    let record = Record::NOTHING;
    Plan {
        simulation,
        record,
        seed,
        paths,
        antithetic: false,
    }
    .run(threads)
}

/// The comparisons that fail, of thirty: the bias that is estimated at each step, multiplied by
/// each factor, against the value of the large run at that step less the truth.
fn misses<const N: usize>(
    biases: impl Fn(f64) -> Vec<(Statistic, Bias)>,
    factors: [f64; N],
) -> [Vec<String>; N] {
    let mut misses = [const { Vec::new() }; N];
    for AtStep { h, values } in &AT_STEP {
        let biases = biases(*h);
        for ((statistic, at_step), truth) in STATISTICS
            .iter()
            .zip(values)
            .map(|(s, value)| ((s, value), truth(s)))
        {
            let Bias {
                estimate,
                uncertainty,
                ..
            } = of(&biases, *statistic);
            let (bias, error) = (at_step.0 - truth.0, at_step.1.hypot(truth.1));
            let line = format!(
                "h = {h}, {}: {estimate} +- {uncertainty}, in truth {bias}",
                statistic.name()
            );
            println!("{line}");
            for (misses, factor) in misses.iter_mut().zip(factors) {
                if (factor * estimate - bias).abs() > uncertainty + 2.0 * error {
                    misses.push(line.clone());
                }
            }
        }
    }
    misses
}

/// The bias as `mc run` estimates it with 10 000 paths.
///
/// Null hypothesis: in each of thirty comparisons the error of the estimated bias is within its 95
/// % uncertainty, enlarged by the errors of the two numbers that it is compared with. The seed is
/// fixed. False-alarm rate, measured over 40 other seeds at five of the steps: 1.8 % of all
/// comparisons failed. An estimate of twice the size fails in most comparisons.
#[test]
fn the_reported_bias_is_within_its_uncertainty_of_the_truth() {
    let model = paper(0.25, 0.25);
    let [exact, double] = misses(|h| reported(&model, plain(h), 1, 10_000, 2), [1.0, 2.0]);
    assert_eq!(exact, Vec::<String>::new());
    assert!(double.len() > 20, "{}", double.len());
}

/// Both schemes at the step of the paper, with five statistics and 20 seeds. The values of
/// `corrected-vi` are those of `mc run scenarios/rho025.toml --scheme corrected-vi --step 0.01
/// --paths 400000 --seed 11`.
///
/// Null hypothesis: each of 200 biases is off by more than its uncertainty with a probability of at
/// most 5 %. Bound: 20 misses. False-alarm rate: if the biases were independent, 20 or more misses
/// would have a probability of 0.3 %. With half the uncertainty there are more.
#[test]
fn over_seeds_at_most_5_percent_of_biases_are_missed() {
    let model = paper(0.25, 0.25);
    let at_corrected = [
        (0.408292, 0.00017),
        (18.3392, 0.0086),
        (1.27634, 0.00024),
        (0.188304, 0.00014),
        (0.138548, 6.8e-05),
    ];
    let mut misses = [0, 0];
    for (scheme, values) in [
        (plain(0.01), AT_STEP[2].values),
        (corrected(0.01), at_corrected),
    ] {
        for seed in 1..=20 {
            let biases = reported(&model, scheme, seed, 10_000, 2);
            for ((statistic, at_step), truth) in STATISTICS
                .iter()
                .zip(values)
                .map(|(s, value)| ((s, value), truth(s)))
            {
                let Bias {
                    estimate,
                    uncertainty,
                    ..
                } = of(&biases, *statistic);
                let off = (estimate - (at_step.0 - truth.0)).abs() - 2.0 * at_step.1.hypot(truth.1);
                misses[0] += u32::from(off > uncertainty);
                misses[1] += u32::from(off > uncertainty / 2.0);
            }
        }
    }
    println!("{misses:?}");
    assert!(misses[0] <= 20 && misses[1] > 20, "{misses:?}");
}

/// The extrapolation itself: with up to 480 000 paths at three steps the sampling error is below a
/// tenth of most biases. The stated uncertainty was chosen such that this test passes, so the test
/// guards it against changes and does not prove it. An estimate of twice the size fails in most of
/// the thirty comparisons. One of half the size fails in fewer, because the stated uncertainty is
/// about that large.
#[test]
fn extrapolation_holds_and_an_error_of_a_factor_of_two_is_seen() {
    let paths = |h| if h < 0.002 { 120_000 } else { 480_000 };
    let [exact, double, half] = misses(|h| biases(&plan(h, 2, paths(h)), 2), [1.0, 2.0, 0.5]);
    assert_eq!(exact, Vec::<String>::new());
    assert!(
        double.len() > 20 && half.len() > 6,
        "{} {}",
        double.len(),
        half.len()
    );
}

/// f_s = 1.05 f_d. The values at zero step are those of `mc run scenarios/rho025.toml --set
/// friction.static=1.05 --scheme event-driven --paths 300000 --seed 77`; those at a step are means
/// over 40 runs of 10 000 paths, seeds 101 to 140. In one step of 0.0025 the noise moves the force
/// by 1.5 times f_s - f_d, in one of 0.02 by 4.2 times, so that the steps resolve only half of the
/// change.
///
/// Null hypothesis: as above, in six comparisons. False-alarm rate: none of the six failed for 18
/// other seeds. An uncertainty that did not grow with the step would be too small for the number of
/// sticks at 0.01 and 0.02, with each of these seeds.
#[test]
fn the_truth_is_within_where_frictions_are_close() {
    let mut model = paper(0.25, 0.25);
    model.friction.static_force = 1.05 * model.friction.dynamic_force;
    let mean = (
        Statistic::StickDurationMean,
        0.215064,
        [(0.02, 0.432892), (0.01, 0.375277), (0.0025, 0.295817)],
    );
    let sticks = (
        Statistic::SticksPerPath,
        33.9081,
        [(0.02, 16.3787), (0.01, 19.1942), (0.0025, 24.6207)],
    );
    for (statistic, truth, at_step) in [mean, sticks] {
        for (h, value) in at_step {
            let plan = Differences::new(plain(h), &model, &timeline(&model), 1, 10_000)
                .expect("enough paths");
            let Bias {
                estimate,
                uncertainty,
                ..
            } = of(&biases(&plan, 2), statistic);
            println!(
                "h = {h}, {}: {estimate} +- {uncertainty}, in truth {}",
                statistic.name(),
                value - truth
            );
            assert!(
                (estimate - (value - truth)).abs() < uncertainty,
                "{h} {}",
                statistic.name()
            );
        }
    }
}

/// Two biases that cannot be inferred from the differences D1 and D2 between the steps alone. With
/// theta = 5 the bias of sub-phases is proportional to h, and the plain extrapolation is twice the
/// truth. With close frictions, strong noise and damping the sticking fraction hardly changes from
/// step to step, because fewer and longer sticks compensate each other. The truth is obtained as
/// above; the second case is `scenarios/damped.toml` with damping 1, intensity 0.5 and f_s = 1.05.
///
/// Null hypothesis: each of 40 seeds is within its uncertainty with 95 %. False-alarm rate: more
/// than 6 misses have a probability of 0.3 %. With an uncertainty of 30 % of one term alone the
/// first case has 12 misses; without half a step for each stick the second has 32.
#[test]
fn the_truth_is_within_where_changes_with_the_step_mislead() {
    let mut short_memory = paper(0.25, 0.25);
    short_memory
        .temperature
        .noises
        .first_mut()
        .expect("it has noise")
        .relaxation_rate = 5.0;
    let mut damped = paper(0.25, 0.5);
    (damped.oscillator.damping, damped.friction.static_force) = (1.0, 1.05);
    for (model, h, statistic, (truth, error)) in [
        (
            short_memory,
            0.01,
            Statistic::SubPhasesMultipleShare,
            (0.01225, 1.3e-4),
        ),
        (
            damped,
            0.0025,
            Statistic::StickingFraction,
            (7.47e-4, 5.3e-5),
        ),
    ] {
        let is_missed = |seed: &u64| {
            let plan = Differences::new(plain(h), &model, &timeline(&model), *seed, 10_000)
                .expect("enough paths");
            let Bias {
                estimate,
                uncertainty,
                ..
            } = of(&biases(&plan, 2), statistic);
            (estimate - truth).abs() > uncertainty + 2.0 * error
        };
        let misses = (1..=40).filter(is_missed).count();
        assert!(misses <= 6, "{}: {misses} of 40", statistic.name());
    }
}

/// The bias of each statistic falls with the step as the order says that its extrapolation takes: 1
/// for the displacement, 1/2 for sticks. The change of a statistic from h to h/8 is seen on paths
/// with common noise, and compared with what the biases that are told at h and at h/8 say of it.
///
/// Null hypothesis: both are the same, up to what the extrapolation misses at h = 0.01. Sample
/// size: 10 000 paths at each step, which leave the ratio of the two uncertain by 1 to 5 %. Bounds:
/// 0.75 and 1.3; for five other seeds all ratios are between 0.87 and 1.15. Had a statistic of the
/// displacement the order 1/2, it would be 1.5 or more; had one of sticks the order 1, about half.
#[test]
fn each_bias_falls_with_the_step_as_its_order_says() {
    use Statistic::*;
    let h = 0.01;
    // Forcing frequency, x0 and t_end. In the second scene the body drifts from far away to the
    // place where the spring holds it; in the third its displacements from period to period are
    // correlated.
    let sticks: &[Statistic] = &[
        StickDurationMean,
        StickDurationSd,
        FirstStickDurationMean,
        SticksPerPath,
        SlipsPerPath,
    ];
    let displacement: &[Statistic] = &[
        DisplacementEndMean,
        DisplacementEndSd,
        DriftVelocity,
        DiffusionCoefficient,
        PeriodDisplacementMean,
        PeriodDisplacementSd,
        PhaseDisplacementSd,
        FrictionWorkMean,
        SlidingPathRate,
    ];
    for (frequency, x0, end, statistics) in [
        (0.25, 6.0, 100.8, sticks),
        (2.0, 20.0, 12.8, displacement),
        (1.5, 12.0, 19.2, &[PeriodDisplacementCorrelation]),
    ] {
        let model = Problem {
            initial_displacement: x0,
            ..paper(frequency, 0.25)
        };
        let timeline = Timeline {
            end,
            ..timeline(&model)
        };
        let seen_at = |h: f64, finer: usize| {
            let simulation = plain(h).simulation(&model, &timeline).fed_by_finer(finer);
            let record = Record::NOTHING;
            Plan {
                simulation,
                record,
                seed: 5,
                paths: 10_000,
                antithetic: false,
            }
            .run(2)
        };
        let told_at = |h| {
            biases(
                &Differences::new(plain(h), &model, &timeline, 6, 480_000).expect("enough paths"),
                2,
            )
        };
        let (seen, told) = (
            [seen_at(h, 8), seen_at(h / 8.0, 1)],
            [told_at(h), told_at(h / 8.0)],
        );
        for &statistic in statistics {
            let [coarse, fine] = seen.each_ref().map(|run| estimate(run, statistic).0);
            let [at_coarse, at_fine] = told.each_ref().map(|biases| of(biases, statistic).estimate);
            let ratio = (at_coarse - at_fine) / (coarse - fine);
            println!("{}: {ratio:.3}", statistic.name());
            assert!(
                (0.75..1.3).contains(&ratio),
                "{}: {ratio}",
                statistic.name()
            );
        }
    }
}

/// The uncertainty is small enough to be useful. With 10 000 paths at the step of the paper, in the
/// median of nine seeds, the bias of the mean stick duration is known to better than 11 % of
/// itself. The bias of x(t_end), whose paths hardly differ between h and 2h, is known to little
/// more than the standard error of the run, 0.016. The observed order is between 0.45 and 0.75.
#[test]
fn the_uncertainty_is_small_enough_to_be_useful() {
    let model = paper(0.25, 0.25);
    let all: Vec<Vec<(Statistic, Bias)>> = (0..9)
        .map(|seed| reported(&model, plain(0.01), seed, 10_000, 2))
        .collect();
    let median = |statistic: Statistic, what: &dyn Fn(&Bias) -> f64| {
        let mut values: Vec<f64> = all
            .iter()
            .map(|biases| what(&of(biases, statistic)))
            .collect();
        values.sort_by(f64::total_cmp);
        println!("{}: {values:?}", statistic.name());
        values[4]
    };
    assert!(
        median(Statistic::StickDurationMean, &|b| b.uncertainty
            / b.estimate)
            < 0.11
    );
    assert!(median(Statistic::DisplacementEndMean, &|b| b.uncertainty) < 0.02);
    let order = median(Statistic::StickDurationMean, &|b| {
        b.order.unwrap_or(f64::NAN)
    });
    assert!((0.45..0.75).contains(&order), "{order}");
}

/// Two kinds of sticks: with weak noise and nearly equal frictions sticks are either short or long,
/// and a step misses many of the short ones. The median at h = 0.01 is 1.55, that of long sticks.
/// At zero step it is 0.40 (`mc run scenarios/rho025.toml --scheme event-driven --paths 300000
/// --seed 77` with the values below). At 2h and 4h it is 1.65 and more, so no extrapolation from
/// the steps can find the short sticks. The truth is an interval, from 200 000 paths at the step
/// and 300 000 event-driven ones.
///
/// Null hypothesis: each of 20 seeds is within its uncertainty with 95 %. False-alarm rate: more
/// than 4 misses have a probability of 0.3 %. Extrapolation from h, 2h and 4h alone has 6 misses,
/// with most estimates near 0.2. For most seeds the number of reference paths leaves it open
/// whether the median is that of the short sticks. So the uncertainty must exceed a fifth of a
/// unit for at least 13 seeds (16 do; if it were half as large, 3 would).
#[test]
fn the_bias_of_a_median_that_jumps_is_covered() {
    let mut model = paper(0.25, 0.1);
    (model.oscillator.mass, model.oscillator.stiffness) = (0.3, 0.2);
    (model.oscillator.damping, model.oscillator.drive) = (0.5, Drive::Dilatation(20.0));
    (model.friction.static_force, model.initial_displacement) = (1.02, 20.0);
    let noise = model.temperature.noises.first_mut().expect("it has noise");
    (noise.relaxation_rate, noise.initial) = (0.5, InitialNoise::At(-1.0));
    let (low, high) = (1.156, 1.167);
    let covered_and_width = |seed: &u64| {
        let Bias {
            estimate,
            uncertainty,
            ..
        } = of(
            &reported(&model, plain(0.01), *seed, 10_000, 2),
            Statistic::StickDurationMedian,
        );
        println!("{estimate} +- {uncertainty}");
        (
            estimate - uncertainty <= high && estimate + uncertainty >= low,
            uncertainty,
        )
    };
    let all: Vec<(bool, f64)> = (1..=20)
        .collect::<Vec<u64>>()
        .iter()
        .map(covered_and_width)
        .collect();
    let misses = all.iter().filter(|(is_held, _)| !is_held).count();
    let wide = all
        .iter()
        .filter(|(_, uncertainty)| *uncertainty > 0.2)
        .count();
    assert!(misses <= 4 && wide >= 13, "{misses} misses, {wide} wide");
}

/// The reference run is left out where it costs more than the run allows (theta = 1e6, which needs
/// a macro step each 5e-7, 10^8 of them), where it resolves less than is needed (f_s and f_d almost
/// equal), and where its paths are too few. The bias is then estimated from the three steps.
#[test]
fn the_steps_give_the_bias_where_the_reference_run_cannot() {
    let referenced = |model: &Problem, h: f64, paths: u64| {
        let run = run(model, plain(h), 1, paths, 2);
        ReferenceRun::new(model, &timeline(model), h, 1, paths, 20).estimate(
            &run,
            2,
            &AtomicBool::new(false),
        )
    };
    let model = paper(0.25, 0.25);
    assert_eq!(
        referenced(&model, 0.01, 10_000).map(|biases| biases.len()),
        Some(EXISTING)
    );
    assert_eq!(referenced(&model, 0.04, 1000), None);
    let mut fast = model.clone();
    fast.temperature
        .noises
        .first_mut()
        .expect("it has noise")
        .relaxation_rate = 1e6;
    let mut close = model.clone();
    close.friction.static_force = 1.0 + 1e-9;
    let is_close = |model: &Problem| model.friction.static_force < 1.1;
    for model in [fast, close] {
        assert_eq!(referenced(&model, 0.01, 10_000), None);
        if is_close(&model) {
            // The gap is far below what a step resolves, so that the differences say nothing.
            let plan = BiasPlan::new(plain(0.01), &model, &timeline(&model), 1, 10_000)
                .expect("enough paths");
            let run = run(&model, plain(0.01), 1, 10_000, 2);
            assert_eq!(
                plan.estimate(&run, 2, &AtomicBool::new(false)),
                Err(NoBias::Uncertain)
            );
            continue;
        }
        let biases = reported(&model, plain(0.01), 1, 10_000, 2);
        // All but the median, which no step can place, and spreads that too few groups of these
        // paths decide.
        let uncertain = [
            Statistic::StickDurationMedian,
            Statistic::DisplacementEndSd,
            Statistic::DiffusionCoefficient,
            Statistic::PeriodDisplacementSd,
            Statistic::PhaseDisplacementSd,
            Statistic::PeriodDisplacementCorrelation,
        ];
        // Nor have counts that few paths differ in, and that the three steps leave as they are.
        let steps = Differences::new(plain(0.01), &model, &timeline(&model), 1, 10_000);
        let unchanged = self::biases(&steps.expect("enough paths"), 2);
        let unchanged = unchanged
            .iter()
            .filter(|(_, bias)| bias.uncertainty == 0.0)
            .map(|(of, _)| *of);
        let mut known: Vec<Statistic> = biases.iter().map(|(of, _)| *of).collect();
        known.extend(unchanged.filter(|of| !biases.iter().any(|(known, _)| known == of)));
        assert!(known.len() >= EXISTING - 5, "{known:?}");
        assert!(!known.contains(&Statistic::StickDurationMedian));
        for statistic in Statistic::ALL
            .iter()
            .take(EXISTING)
            .filter(|of| !uncertain.contains(of))
        {
            assert!(known.contains(statistic), "{}", statistic.name());
        }
        let plan = BiasPlan::new(corrected(0.01), &model, &timeline(&model), 1, 10_000)
            .expect("enough paths");
        let corrected = run(&model, corrected(0.01), 1, 10_000, 2);
        assert_eq!(
            plan.estimate(&corrected, 2, &AtomicBool::new(false)),
            Err(NoBias::Corrected)
        );
    }
}

/// The reference run has random numbers of its own. Otherwise the two ensembles would not be
/// independent, and the squares of their errors would not add up. In this scene v stays at its
/// random initial value, which determines the path: if the ensembles shared the seed, path k would
/// be the same in both, and the difference of the two means would be almost zero compared with its
/// error.
///
/// Null hypothesis: over 64 seeds the mean square of difference over error is a chi-square of 64
/// degrees of freedom divided by 64. False-alarm rate: it is below 0.4 with a probability of 1e-5.
/// It is above 2 if the errors are half as large as they should be. Both ensembles have the same
/// number of paths.
#[test]
fn paths_without_a_step_are_not_those_of_the_run() {
    let mut model = paper(0.25, 1.0);
    model.temperature.harmonics.clear();
    model.initial_displacement = 0.0;
    let (relaxation_rate, stationary_sd): (f64, f64) = (1e-9, 1.0);
    let diffusion = stationary_sd * (2.0 * relaxation_rate).sqrt();
    model.temperature.noises = vec![OrnsteinUhlenbeck {
        intensity: 1.0,
        relaxation_rate,
        diffusion,
        initial: InitialNoise::Stationary,
    }];
    let (end, h, paths) = (10.0, 1e-4, 128);
    let timeline = Timeline {
        end,
        output_step: end,
        period: None,
        after: 0.0,
    };
    let squares = (0..64).map(|seed| {
        let simulation = plain(h).simulation(&model, &timeline);
        let run = Plan {
            simulation,
            record: Record::NOTHING,
            seed,
            paths,
            antithetic: false,
        }
        .run(2);
        // The reference run may cost as much as the run, which is enough for as many paths.
        let reference = ReferenceRun::new(&model, &timeline, h, seed, paths, 1);
        let biases = reference
            .estimate(&run, 2, &AtomicBool::new(false))
            .expect("the budget is enough");
        let reported = of(&biases, Statistic::FrictionWorkMean);
        // With a little allowance for the tolerance.
        (reported.estimate / (reported.uncertainty / 1.96)).powi(2)
    });
    let mean_square = squares.sum::<f64>() / 64.0;
    println!("{mean_square}");
    assert!((0.4..2.0).contains(&mean_square), "{mean_square}");
}

/// The uncertainty of a bias is 1.96 times the standard deviation of the bias over seeds, on average
/// over all statistics: `corrected-vi` with 1500 paths, of which a tenth as many are reference paths.
///
/// Null hypothesis: the mean over statistics of the variance over 40 seeds, divided by that stated,
/// is 1. Bounds on its root: 0.85 and 1.1. It is 0.935 to 0.992 for six sets of 40 seeds, with a
/// standard deviation of 0.022, so that the false-alarm rate is below 1e-3. With the intervals of
/// both runs, widened for few paths, it is 0.78.
#[test]
fn a_bias_scatters_over_seeds_as_its_uncertainty_says() {
    let model = paper(0.25, 0.25);
    let all: Vec<Vec<(Statistic, Bias)>> = (1..=40)
        .map(|seed| reported(&model, corrected(0.01), seed, 1500, 2))
        .collect();
    let ratio = |(statistic, _): &(Statistic, Bias)| {
        let biases: Vec<Bias> = all
            .iter()
            .filter_map(|biases| biases.iter().find(|(of, _)| of == statistic))
            .map(|(_, bias)| *bias)
            .collect();
        let n = biases.len() as f64;
        let mean = biases.iter().map(|bias| bias.estimate).sum::<f64>() / n;
        let seen = biases
            .iter()
            .map(|bias| (bias.estimate - mean).powi(2))
            .sum::<f64>()
            / (n - 1.0);
        let stated = biases
            .iter()
            .map(|bias| (bias.uncertainty / 1.96).powi(2))
            .sum::<f64>()
            / n;
        println!("{}: {:.3}", statistic.name(), (seen / stated).sqrt());
        seen / stated
    };
    let ratios: Vec<f64> = all[0].iter().map(ratio).collect();
    let z = (ratios.iter().sum::<f64>() / ratios.len() as f64).sqrt();
    println!("{z}");
    assert!(ratios.len() == EXISTING && (0.85..1.1).contains(&z), "{z}");
}

/// Statistics whose bias follows from 32 paths at three steps, or from 60 reference paths. No
/// reference run of `duffing` is cheap enough. In the other scene fewer than 64 reference paths have
/// no interval for the standard deviation of sticks, so its error is that implied by the run.
#[test]
fn a_few_dozen_paths_measure_a_bias() {
    let duffing = Scenario::shipped("duffing").expect("shipped");
    let mut damped = Scenario::shipped("damped").expect("shipped");
    damped.model.oscillator.damping = 0.5;
    let noise = &mut damped.model.temperature.noises[0];
    (noise.relaxation_rate, noise.intensity) = (5.0, 0.6);
    for (scene, scheme, statistics) in [
        (
            duffing,
            plain(0.01),
            [Statistic::FirstStickDurationMean, Statistic::JumpMean],
        ),
        (
            damped,
            corrected(0.01),
            [Statistic::StickDurationSd, Statistic::StickDurationMean],
        ),
    ] {
        let scene = scene.with_scheme(scheme).expect("it fits");
        let run = Run::of(&scene).paths(2000).threads(2).simulate();
        let summary = run.expect("a run").summary;
        for statistic in statistics {
            let e = summary.estimate(statistic);
            println!("{}: {e:?}", statistic.name());
            assert!(e.bias.is_some(), "{e:?}");
        }
    }
}

/// Without noise: the bias of every statistic of Shaw's case compared with the exact cascade.
/// x(t_end), the smoothest statistic, must be right to 15 %.
#[test]
fn without_noise_the_bias_is_that_against_the_exact_cascade() {
    let model = paper(0.25, 0.0);
    let exact = event_driven_summary(&model, &timeline(&model), 1e-3, 1, 1);
    for h in [0.04, 0.02, 0.01, 0.005, 0.0025, 0.002, 0.001] {
        let plan = Differences::new(plain(h), &model, &timeline(&model), 1, 1)
            .expect("one path is enough");
        assert_eq!(plan.paths(), 1);
        let run = run(&model, plain(h), 1, 1, 1);
        let biases = biases(&plan, 1);
        assert_eq!(
            biases.len(),
            16,
            "all but the spreads over paths, and the correlation from period to period"
        );
        for (
            statistic,
            Bias {
                estimate: bias,
                uncertainty,
                ..
            },
        ) in biases
        {
            let truth = estimate(&run, statistic).0 - estimate(&exact, statistic).0;
            let rounding = 1e-12 * truth.abs().max(1.0);
            assert!(
                (bias - truth).abs() <= uncertainty + rounding,
                "{h} {}: {bias} {truth}",
                statistic.name()
            );
            if statistic == Statistic::DisplacementEndMean && h < 0.02 {
                assert!((bias / truth - 1.0).abs() < 0.15, "{h}: {bias} {truth}");
            }
        }
    }
}

/// The simulations at h, 2h and 4h end at one instant, the multiple of 4h nearest to t_end. So a
/// t_end that is h off such a multiple has the same bias as the multiple. If each simulation ended
/// at the instant of its own that is nearest, the motion between these instants would be taken for
/// a bias, in the slips that run at some of these times.
#[test]
fn the_three_steps_end_at_one_instant() {
    let (model, h) = (paper(0.25, 0.0), 0.01);
    let at = |end: f64| {
        let timeline = Timeline {
            end,
            output_step: end,
            period: None,
            after: 0.0,
        };
        let plan = Differences::new(plain(h), &model, &timeline, 1, 1).expect("one path is enough");
        [Statistic::DisplacementEndMean, Statistic::FrictionWorkMean]
            .map(|statistic| of(&biases(&plan, 1), statistic))
    };
    for k in 0..10 {
        let end = 40.0 + 2.0 * f64::from(k);
        assert_eq!([at(end - h), at(end + h)], [at(end), at(end)], "{end}");
    }
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let model = paper(0.25, 0.25);
    let plan = plan(0.05, 3, 30_000);
    assert_eq!(plan.paths(), 30_000 / 48 / 16 * 16);
    let one = reported(&model, plain(0.05), 3, 30_000, 1);
    assert_eq!(one.len(), EXISTING);
    for threads in [2, 7] {
        assert_eq!(reported(&model, plain(0.05), 3, 30_000, threads), one);
    }
}

#[test]
fn where_there_is_no_estimate_the_reason_is_given() {
    let (model, quiet) = (paper(0.25, 0.25), paper(0.25, 0.0));
    let try_with = |model: &Problem, h, paths| {
        Differences::new(plain(h), model, &timeline(model), 1, paths).map(|_| ())
    };
    assert_eq!(
        try_with(&model, 0.01, 767),
        Err(NoBias::FewPaths { needed: 768 })
    );
    assert_eq!(try_with(&model, 0.01, 768), Ok(()));
    assert_eq!(try_with(&model, 6.0, 1000), Err(NoBias::FewSteps));
    let mut equal = model.clone();
    equal.friction.dynamic_force = equal.friction.static_force;
    assert_eq!(try_with(&equal, 0.01, 1000), Err(NoBias::EqualFriction));
    let mut equal = quiet;
    equal.friction.dynamic_force = equal.friction.static_force;
    assert_eq!(try_with(&equal, 0.01, 1), Ok(()));

    for scheme in [plain(0.01), corrected(0.01)] {
        let plan = BiasPlan::new(scheme, &model, &timeline(&model), 1, 1000).expect("enough paths");
        let stopped = plan.estimate(&run(&model, scheme, 1, 1000, 2), 2, &AtomicBool::new(true));
        assert_eq!(stopped, Err(NoBias::Stopped));
    }
    // 4h = 0.8 is so long that an undamped slip of this size diverges.
    let long = Timeline {
        end: 1000.0,
        output_step: 1000.0,
        period: None,
        after: 0.0,
    };
    let plan = Differences::new(plain(0.2), &model, &long, 1, 1000).expect("enough paths");
    assert!(matches!(
        plan.estimate(1, &AtomicBool::new(false)),
        Err(NoBias::Diverged { paths: 32.. })
    ));
}

/// A noisy body under a force of its own, by `discrete-vi` at h = 0.01 with 4000 paths.
fn under_a_force(keys: &str) -> Scenario {
    let text = format!(
        "oscillator.mass = 1\noscillator.stiffness = 1\ninitial.displacement = 0\nensemble.paths = 4000\n\
         scheme.kind = \"discrete-vi\"\ntime.step = 0.01\ntime.output_step = 0.5\n{keys}"
    );
    Scenario::parse("under a force", &text, &[]).expect("a scenario")
}

/// Two stops, one of them stiff: at 2h and 4h their forces throw paths away. The bias is that against
/// 1500 event-driven paths.
///
/// Null: both are the same to within the uncertainty and two standard errors. False-alarm rate: 5 %,
/// for another seed. Without the reference run there is no bias, and of the number of sticks it is
/// most of the estimate.
#[test]
fn where_longer_steps_diverge_the_reference_run_gives_the_bias() {
    let scene = under_a_force(
        "oscillator.dilatation = 6\noscillator.damping = 0.3\nfriction = { static = 1.2, dynamic = 1.0 }\n\
         temperature.harmonics = [{ amplitude = 1.0, angular_frequency = 0.25 }]\n\
         temperature.noise.intensity = 0.25\ntime.end = 60\n\
         force.expression = \"-k*max(x - 1, 0) - l*min(x + 1, 0)\"\nparameters = { k = 200, l = 40 }\n",
    );
    let run = Run::of(&scene)
        .threads(2)
        .simulate()
        .expect("a run")
        .summary;
    let exact = scene
        .with_scheme(EventDriven {
            tolerance: DEFAULT_TOLERANCE,
        })
        .expect("it fits");
    let differences = Differences::new(scene.scheme, &scene.model, &scene.timeline(), 1, 4000)
        .expect("enough paths");
    let absence = differences
        .estimate(2, &AtomicBool::new(false))
        .expect_err("they diverge");
    assert!(matches!(absence, NoBias::Diverged { .. }), "{absence}");
    let exact = Run::of(&exact)
        .paths(1500)
        .threads(2)
        .simulate()
        .expect("a run")
        .summary;
    for statistic in [
        Statistic::SticksPerPath,
        Statistic::StickDurationMean,
        Statistic::JumpMean,
    ] {
        let (at_step, exact) = (run.estimate(statistic), exact.estimate(statistic));
        let bias = at_step.bias.expect("a reference run");
        let (off, error) = (
            at_step.estimate - exact.estimate,
            2.0 * at_step.standard_error.hypot(exact.standard_error),
        );
        println!(
            "{}: {bias:?}, beside event-driven paths {off} +- {error}",
            statistic.name()
        );
        assert!(
            (bias.estimate - off).abs() < bias.uncertainty + error,
            "{bias:?} {off} {error}"
        );
        assert!(
            statistic != Statistic::SticksPerPath || bias.estimate.abs() > 5.0 * bias.uncertainty,
            "{bias:?}"
        );
    }
}

/// The first stick ends in a pulse at t = 10 in most paths, and earlier in a few of a hundred, of which
/// the paths that measure the bias have two or three. The truth, 0.055, is the difference of 100 000
/// paths of `discrete-vi` and of `event-driven`, known to 0.009 at two standard errors.
///
/// Null: the bias of each of four seeds is within its uncertainty with a probability of 95 %, so that
/// two or more of the fixed seeds miss it with 1.4 %; none may. If the differences stand although the
/// early ends are in two or three of their groups, three of the four miss the truth.
#[test]
fn a_bias_from_rare_early_ends_is_as_uncertain() {
    let mut scene = under_a_force(
        "oscillator.force_per_temperature = 1\noscillator.damping = 0.03\nfriction = { static = 1.0, dynamic = 0.7 }\n\
         temperature.noise.intensity = 0.4\ntime.end = 20\nforce.expression = \"30*exp(-((t - 10)/0.05)^2)\"\n",
    );
    let mut known = 0;
    for seed in 11..=14 {
        scene.ensemble.seed = seed;
        let run = Run::of(&scene)
            .threads(2)
            .simulate()
            .expect("a run")
            .summary;
        let e = run.estimate(Statistic::FirstStickDurationMean);
        println!("{seed}: {e:?}");
        known += usize::from(e.bias.is_some());
        assert!(
            e.bias
                .is_none_or(|bias| (bias.estimate - 0.055).abs() < bias.uncertainty),
            "{e:?}"
        );
    }
    assert!(known > 1, "{known}");
}
