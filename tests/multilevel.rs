//! Multilevel means against the event-driven scheme, which has no step.

mod common;

use common::{estimate, event_driven_summary, paper};
use std::sync::atomic::AtomicBool;
use stick_slip::scheme::Timeline;
use stick_slip::stats::Statistic;
use stick_slip::study::multilevel::{Multilevel, Outcome};

const END: f64 = 20.0;
const PATHS: u64 = 100_000;

fn run(statistic: Statistic, target: f64, seed: u64, threads: usize) -> Outcome {
    let multilevel = Multilevel::new(&paper(0.25, 0.25), END, statistic, seed).expect("a mean over paths, with noise");
    multilevel.run(target, threads, &AtomicBool::new(false)).expect("converges")
}

/// Null: the root mean square of 40 errors is at most the target (half of its square is allowed for the bias, which is mostly much
/// less), and not below 0.4 of it. The mean of 40 chi^2_1 is within 1 -+ 0.75 with a false-alarm rate of 1e-3. The truth is from 100 000
/// event-driven paths; its own error is added. A level left out, a pair on different noise, or weights off by 2 fail.
#[test]
fn the_error_is_the_one_asked_for() {
    let timeline = Timeline { end: END, output_step: END, period: None };
    let exact = event_driven_summary(&paper(0.25, 0.25), &timeline, 1e-3, 77, PATHS);
    for (statistic, share) in [(Statistic::DisplacementEndMean, 0.5), (Statistic::FrictionWorkMean, 0.3)] {
        let (truth, error) = estimate(&exact, statistic);
        // a share of the spread of a path over 32: some thousand paths on the coarsest level
        let target = share * error * (PATHS as f64 / 1000.0).sqrt();
        let errors = (0..40).map(|seed| run(statistic, target, seed, 2).estimate - truth);
        let mean_square = errors.map(|e| e * e).sum::<f64>() / 40.0;
        let scaled = mean_square / (target.powi(2) + error.powi(2));
        assert!((0.16..1.75).contains(&scaled), "{}: {scaled}", statistic.name());
    }
}

/// A difference is of strong order 1, so its variance falls by about 4 a level, whatever the level.
#[test]
fn the_variance_of_a_difference_falls_by_four_a_level() {
    let outcome = run(Statistic::DisplacementEndMean, 0.01, 1, 2);
    assert!(outcome.levels.len() >= 3);
    for pair in outcome.levels[1..].windows(2) {
        let ratio = pair[0].variance / pair[1].variance;
        assert!((2.5..6.5).contains(&ratio), "{ratio} {:?}", outcome.levels);
    }
    // most of the paths are on the coarsest level
    assert!(outcome.levels.windows(2).all(|pair| pair[0].paths >= pair[1].paths));
}

#[test]
fn threads_do_not_change_a_bit() {
    let one = run(Statistic::FrictionWorkMean, 0.1, 3, 1);
    assert_eq!(one, run(Statistic::FrictionWorkMean, 0.1, 3, 3));
}

#[test]
fn what_is_no_mean_over_paths_or_has_no_noise_is_not_for_it() {
    assert!(Multilevel::new(&paper(0.25, 0.25), END, Statistic::StickDurationMean, 1).is_none());
    assert!(Multilevel::new(&paper(0.25, 0.0), END, Statistic::DisplacementEndMean, 1).is_none());
    assert!(Multilevel::new(&paper(0.25, 0.25), 0.0, Statistic::DisplacementEndMean, 1).is_none());
}
