//! `examples/multilevel`: its estimates compared with the event-driven scheme, which has no step.

#[path = "../../examples/multilevel/method.rs"]
mod method;

use crate::common::{estimate, event_driven_summary, paper};
use method::{Multilevel, Outcome};
use std::sync::atomic::AtomicBool;
use stickslip::model::{Friction, InitialNoise, OrnsteinUhlenbeck};
use stickslip::scheme::Timeline;
use stickslip::stats::Statistic;

const END: f64 = 20.0;
const PATHS: u64 = 100_000;

fn run(statistic: Statistic, target: f64, seed: u64, threads: usize) -> Outcome {
    let multilevel = Multilevel::new(&paper(0.25, 0.25), END, statistic, seed)
        .expect("a mean over paths, with noise");
    multilevel
        .run(target, threads, &AtomicBool::new(false))
        .expect("converges")
}

/// Null hypothesis: the errors that a run reports are right. It reports a standard error and a
/// bound of the bias of the finest step, whose squares add up to that of the target. Sample size:
/// 200 seeds, for each of two statistics:
///
/// - The estimates scatter about their mean by the standard error. The mean square in units of the
///   standard error is a chi-square of 199 degrees of freedom divided by 199, which is within 1 -+
///   0.4 except for a false-alarm rate of 1e-4. A standard error of half or twice the size gives 4
///   or 1/4.
/// - Their mean differs from that of 100 000 event-driven paths by at most the reported bias and
///   four standard errors of the two means (false-alarm rate 6e-5). A level that is left out, or a
///   pair on different noise, shifts the mean by the difference of two steps.
/// - The reported errors reach the target. They exceed it by at most 2 %, because the number of
///   paths is chosen before the variance is known finally, and are not much smaller, except that
///   paths come in whole blocks, four of them on each level at least.
/// - Hence the mean square error is between 0.6 times 0.85^2 and 1.4 times 1.02^2 of the square of
///   the target, plus the error of the reference.
#[test]
fn the_error_is_the_one_asked_for() {
    const RUNS: f64 = 200.0;
    let timeline = Timeline {
        end: END,
        output_step: END,
        period: None,
        after: 0.0,
    };
    let exact = event_driven_summary(&paper(0.25, 0.25), &timeline, 1e-3, 77, PATHS);
    for (statistic, share) in [
        (Statistic::DisplacementEndMean, 0.5),
        (Statistic::FrictionWorkMean, 0.3),
    ] {
        let (truth, truth_error) = estimate(&exact, statistic);
        // The target is a share of the standard deviation per path over 32, which needs some
        // thousand paths on the coarsest level.
        let target = share * truth_error * (PATHS as f64 / 1000.0).sqrt();
        let outcomes: Vec<Outcome> = (0..RUNS as u64)
            .map(|seed| run(statistic, target, seed, 2))
            .collect();
        let mean = |of: &dyn Fn(&Outcome) -> f64| outcomes.iter().map(of).sum::<f64>() / RUNS;
        let (centre, bias) = (mean(&|o| o.estimate), mean(&|o| o.bias));
        let scatter =
            mean(&|o| ((o.estimate - centre) / o.standard_error).powi(2)) * RUNS / (RUNS - 1.0);
        let known_to = (mean(&|o| o.standard_error.powi(2)) / RUNS)
            .sqrt()
            .hypot(truth_error);
        let reported = mean(&|o| o.standard_error.powi(2) + o.bias.powi(2)).sqrt() / target;
        println!(
            "{}: scatter {scatter:.3}; off by {:.2e}, told {bias:.2e}, known to {known_to:.1e}; {reported:.3} of the target",
            statistic.name(),
            centre - truth
        );
        assert!(
            (0.6..1.4).contains(&scatter),
            "{}: {scatter}",
            statistic.name()
        );
        assert!(
            (centre - truth).abs() < bias + 4.0 * known_to,
            "{}: {centre} {truth}",
            statistic.name()
        );
        assert!(
            (0.85..1.02).contains(&reported),
            "{}: {reported}",
            statistic.name()
        );
        // The step after the last halves a bias of order 1, so that it is what the last halving has
        // changed, or half of what the one before has. No less is reported than the larger one.
        for Outcome { bias, levels, .. } in &outcomes {
            let [.., before, last] = &levels[..] else {
                panic!("{levels:?}")
            };
            let least = last.mean.abs().max(before.mean.abs() / 2.0);
            assert!(
                *bias >= least * (1.0 - 1e-12),
                "{}: {bias}, {levels:?}",
                statistic.name()
            );
        }
        let scaled =
            mean(&|o| (o.estimate - truth).powi(2)) / (target.powi(2) + truth_error.powi(2));
        assert!(
            (0.43..1.5).contains(&scaled),
            "{}: {scaled}",
            statistic.name()
        );
    }
}

/// A difference of two levels has strong order 1, so its variance falls by about 4 from each level
/// to the next.
#[test]
fn the_variance_of_a_difference_falls_by_four_a_level() {
    let outcome = run(Statistic::DisplacementEndMean, 0.01, 1, 2);
    assert!(outcome.levels.len() >= 3);
    for pair in outcome.levels[1..].windows(2) {
        let ratio = pair[0].variance / pair[1].variance;
        assert!((2.5..6.5).contains(&ratio), "{ratio} {:?}", outcome.levels);
    }
    // Most of the paths are on the coarsest level.
    assert!(
        outcome
            .levels
            .windows(2)
            .all(|pair| pair[0].paths >= pair[1].paths)
    );
}

/// Levels are independent; otherwise their variances would not add up. With almost no friction and
/// v constant at v(0), x(t_end) is on every level v(0) times a number that depends on the step. The
/// mean of a level then is the mean of v(0) over its paths times another number, so two levels that
/// shared paths would have means of correlation 1 or -1. Null hypothesis: the means are
/// uncorrelated. Sample size: 400 seeds, so that a sample correlation has a standard deviation of
/// 0.05. False-alarm rate: below 3e-4 for three pairs of levels at 4 standard deviations.
#[test]
fn levels_share_no_path() {
    let mut model = paper(0.25, 1.0);
    model.temperature.harmonics.clear();
    model.friction = Friction {
        static_force: 1e-6,
        dynamic_force: 1e-6,
    };
    model.initial_displacement = 0.0;
    let (relaxation_rate, stationary_sd): (f64, f64) = (1e-9, 1.0);
    let diffusion = stationary_sd * (2.0 * relaxation_rate).sqrt();
    model.temperature.noises = vec![OrnsteinUhlenbeck {
        intensity: 1.0,
        relaxation_rate,
        diffusion,
        initial: InitialNoise::Stationary,
    }];
    let means: Vec<[f64; 3]> = (0..400)
        .map(|seed| {
            let run = Multilevel::new(&model, 10.0, Statistic::DisplacementEndMean, seed)
                .expect("a mean over paths, with noise");
            // The target is so easy that the run consists of the first blocks of the first three
            // levels.
            let outcome = run.run(1e6, 2, &AtomicBool::new(false)).expect("converges");
            assert_eq!(outcome.levels.len(), 3);
            [0, 1, 2].map(|l| outcome.levels[l].mean / outcome.levels[l].variance.sqrt())
        })
        .collect();
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let sum = |f: &dyn Fn(&[f64; 3]) -> f64| means.iter().map(f).sum::<f64>();
        let correlation =
            sum(&|m| m[a] * m[b]) / (sum(&|m| m[a] * m[a]) * sum(&|m| m[b] * m[b])).sqrt();
        println!("levels {a} and {b}: {correlation:.3}");
        assert!(correlation.abs() < 0.2, "levels {a} and {b}: {correlation}");
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let one = run(Statistic::FrictionWorkMean, 0.1, 3, 1);
    assert_eq!(one, run(Statistic::FrictionWorkMean, 0.1, 3, 3));
}

#[test]
fn only_means_of_random_scenes_are_accepted() {
    assert!(Multilevel::new(&paper(0.25, 0.25), END, Statistic::StickDurationMean, 1).is_none());
    assert!(Multilevel::new(&paper(0.25, 0.0), END, Statistic::DisplacementEndMean, 1).is_none());
    assert!(Multilevel::new(&paper(0.25, 0.25), 0.0, Statistic::DisplacementEndMean, 1).is_none());
}
