//! The corrected discrete VI has order 1 where the plain scheme has order 1/2. The values are
//! compared with those of another program.

use crate::common::{Keep, paper, reference};
use std::sync::LazyLock;
use stickslip::ensemble::Plan;
use stickslip::model::{Drive, EventKind, Friction, Problem};
use stickslip::scheme::{
    CorrectedVi, DiscreteSimulation, DiscreteVi, Scheme, Simulate as _, Timeline, corrected_exit,
    monitoring_shift,
};
use stickslip::stats::{Record, Statistic};

/// The statistics of [`FOUR`] in the noisy scene of the paper.
fn run(h: f64, paths: u64, corrected: bool) -> Vec<(f64, f64)> {
    estimates(paper(0.25, 0.25), h, paths, corrected, &FOUR)
}

fn estimates(
    model: Problem,
    h: f64,
    paths: u64,
    corrected: bool,
    statistics: &[Statistic],
) -> Vec<(f64, f64)> {
    let timeline = Timeline {
        end: 60.0,
        output_step: 60.0,
        period: None,
        after: 0.0,
    };
    let scheme: Scheme = if corrected {
        CorrectedVi { step: h }.into()
    } else {
        DiscreteVi { step: h }.into()
    };
    let simulation = scheme.simulation(&model, &timeline);
    let record = Record::NOTHING;
    let summary = Plan {
        simulation,
        record,
        seed: 5,
        paths,
        antithetic: false,
    }
    .run(2);
    let estimate = |s: &Statistic| {
        (
            summary.estimate(*s).estimate,
            summary.estimate(*s).standard_error,
        )
    };
    statistics.iter().map(estimate).collect()
}

/// The value at zero step (tests/reference/noisy.c, with relative standard errors below 6e-4).
fn truth(statistic: Statistic) -> f64 {
    reference::limit(statistic.name()).0
}

const FOUR: [Statistic; 4] = [
    Statistic::StickDurationMean,
    Statistic::SticksPerPath,
    Statistic::SubPhasesMean,
    Statistic::StickingFraction,
];

/// The corrected scheme at h = 0.00125, which two tests look at.
static FINE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| run(0.00125, 40_000, true));

/// log2 of the ratio of two relative errors, and its standard error by the delta method.
fn order(coarse: (f64, f64), fine: (f64, f64), truth: f64) -> (f64, f64) {
    let (a, b) = (coarse.0 / truth - 1.0, fine.0 / truth - 1.0);
    let (sa, sb) = (coarse.1 / truth / a, fine.1 / truth / b);
    ((a / b).abs().log2(), sa.hypot(sb) / std::f64::consts::LN_2)
}

/// Null hypothesis: from h = 0.005 to 0.00125 the error of the mean stick duration falls at least
/// like h^0.9 with the correction (measured: 1.4), and like h^0.3 to h^0.6 without it (measured:
/// 0.45; theory: 1/2). Sample size: 40 000 paths with it and 10 000 without, so that the standard
/// error of an order is below 0.15. False-alarm rate: below 1e-2, since the bounds are at least 3
/// standard errors away. A correction by half the shift, or one that is also applied where a slip
/// ends, fails.
#[test]
fn the_correction_makes_order_one_of_one_half() {
    let coarse = run(0.005, 40_000, true)[0];
    let (slope, se) = order(coarse, FINE[0], truth(Statistic::StickDurationMean));
    assert!(
        slope / 2.0 > 0.9,
        "corrected: order {} +- {}",
        slope / 2.0,
        se / 2.0
    );
    let [coarse, fine] = [0.005, 0.00125].map(|h| run(h, 10_000, false)[0]);
    let (slope, se) = order(coarse, fine, truth(Statistic::StickDurationMean));
    assert!(
        (0.3..0.6).contains(&(slope / 2.0)),
        "plain: order {} +- {}",
        slope / 2.0,
        se / 2.0
    );
}

/// At h = 0.00125 four statistics of the corrected scheme are within 1 % of the truth, while those
/// of the plain scheme are off by 8 %, 7 %, 1.8 % and 1.2 %. 40 000 paths, with standard errors of
/// 0.05 to 0.15 %.
#[test]
fn at_a_fine_step_one_percent_is_left() {
    for ((value, se), truth) in FINE.iter().zip(FOUR.map(truth)) {
        assert!(
            (value / truth - 1.0).abs() < 0.007 + 3.0 * se / truth,
            "{value} +- {se} against {truth}"
        );
    }
}

/// The noisy scene with f_s = 1 + `gap` and f_d = 1.
fn with_gap(gap: f64) -> Problem {
    Problem {
        friction: Friction {
            static_force: 1.0 + gap,
            dynamic_force: 1.0,
        },
        ..paper(0.25, 0.25)
    }
}

/// Friction never accelerates the body: a slip starts in the direction of b, at |b| >= f_d, and
/// moves in that direction in its first step. The shift is 0.155 at h = 1/32. If the exit threshold
/// were f_s less the whole shift, some slips of the first two scenes would start against b.
#[test]
fn no_slip_starts_against_the_force() {
    for gap in [0.0, 0.05, 0.2] {
        let (model, h) = (with_gap(gap), 1.0 / 32.0);
        let shift = monitoring_shift(&model, h);
        assert_eq!(
            corrected_exit(&model, h),
            if gap < shift { 1.0 } else { 1.0 + gap - shift }
        );
        let timeline = Timeline {
            end: 60.0,
            output_step: h,
            period: None,
            after: 0.0,
        };
        let mut keep = Keep::lanes(64);
        DiscreteSimulation::corrected(&model, &timeline, h).simulate(
            5,
            &(0..64).collect::<Vec<_>>(),
            &mut keep,
        );
        let mut slips = 0;
        for (events, rows) in keep.events.iter().zip(&keep.rows) {
            for event in events {
                let EventKind::SlipStarted(sign) = event.kind else {
                    continue;
                };
                let Some(next) = rows.get((event.time / h).round() as usize + 1) else {
                    continue;
                };
                let b = sign.value() * event.force;
                assert!(
                    b >= corrected_exit(&model, h) && sign.value() * next.2 > 0.0,
                    "{gap}: {event:?} {next:?}"
                );
                slips += 1;
            }
        }
        assert!(slips > 500, "{slips}");
    }
}

/// The shift depends on the size of beta and not on its sign.
#[test]
fn the_shift_does_not_know_the_sign_of_the_dilatation() {
    let model = paper(0.25, 0.25);
    let mut shrinking = model.clone();
    shrinking.oscillator.drive = Drive::Dilatation(-model.oscillator.rest_position(1.0));
    let shift = monitoring_shift(&model, 0.01);
    assert!(
        (shift - 0.087_389_573_690).abs() < 1e-11,
        "0.582597 K beta rho sigma sqrt(h) = {shift}"
    );
    assert_eq!(monitoring_shift(&shrinking, 0.01), shift);
    assert_eq!(
        corrected_exit(&shrinking, 0.01),
        model.friction.static_force - shift
    );
}

/// The effect on the sticking fraction at f_s = f_d. Null hypothesis: at h = 1/32 it is within 4 %
/// of 0.13013 (measured: -1.5 %; the reference, from `mc trade scenarios/equal-friction.toml`, is
/// known to 0.5 %). Sample size: 20 000 paths, with a standard error of 0.23 %. False-alarm rate:
/// below 1e-4. With the threshold lowered by the whole shift, the fraction is 11.6 % too small.
#[test]
fn the_sticking_fraction_at_equal_friction_is_the_limit() {
    let (value, se) = estimates(
        with_gap(0.0),
        1.0 / 32.0,
        20_000,
        true,
        &[Statistic::StickingFraction],
    )[0];
    assert!((value / 0.13013 - 1.0).abs() < 0.04, "{value} +- {se}");
}

/// Without noise nothing crosses a threshold between steps, so the shift is zero, and the scheme is
/// the semi-implicit step. It adds no energy: an oscillation above the critical amplitude of the
/// plain scheme comes to rest.
#[test]
fn the_semi_implicit_step_does_not_grow() {
    let mut model = paper(0.25, 0.0);
    model.temperature.harmonics.clear();
    model.friction = Friction {
        static_force: 0.01,
        dynamic_force: 0.01,
    };
    model.initial_displacement = 1.4; // A_c = 4 f_d / (pi w0 h K) = 1.27 at h = 0.01
    let timeline = Timeline {
        end: 5000.0,
        output_step: 5000.0,
        period: None,
        after: 0.0,
    };
    let mut keep = Keep::lanes(1);
    let lost = DiscreteSimulation::corrected(&model, &timeline, 0.01).simulate(1, &[0], &mut keep);
    assert!(
        lost.is_empty() && keep.rows[0][1].1.abs() <= 0.011,
        "{:?}",
        keep.rows
    );
}
