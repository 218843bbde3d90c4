//! Ensembles: agreement with another program, the same bits however the work is distributed, and
//! paths that diverge.

use crate::common::{estimate, paper, reference};
use ndarray::Array1;
use ndarray_stats::Quantile1dExt;
use ndarray_stats::interpolate::Linear;
use noisy_float::types::{N64, n64};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use stickslip::ensemble::{BLOCK_SIZE, Plan};
use stickslip::model::*;
use stickslip::scheme::{DiscreteVi, EventDriven, Scheme, Simulate as _, Timeline};
use stickslip::stats::{
    Band, BlockResult, QUANTILE_LEVELS, Record, Statistic, Totals, TrajectoryRows,
};
use stickslip::sums::Merge as _;

fn plan(model: Problem, end: f64, h: f64, paths: u64) -> Plan {
    let timeline = Timeline {
        end,
        output_step: end / 10.0,
        period: model.temperature.period(),
        after: 0.0,
    };
    plan_on(&model, &timeline, h, paths)
}

fn plan_on(model: &Problem, timeline: &Timeline, h: f64, paths: u64) -> Plan {
    let simulation = Scheme::from(DiscreteVi { step: h }).simulation(model, timeline);
    Plan {
        simulation,
        record: Record {
            paths: true,
            events: true,
            trajectories: 3,
            ..Record::NOTHING
        },
        seed: 1,
        paths,
        antithetic: false,
    }
}

/// The scheme at three steps compared with another program that shares no code with this one
/// (tests/reference/noisy.c). Null hypothesis: both draw from the same law. The bound is 4 combined
/// standard errors in each of 27 comparisons. False-alarm rate: below 2e-3. The standard errors are
/// below 1 % of each value, so a bias of 4 % in any of them would be found.
#[test]
fn the_noisy_ensemble_has_the_schemes_own_values_at_three_steps() {
    use Statistic::*;
    for (h, paths) in [(0.02, 40_000), (0.01, 40_000), (0.001, 10_000)] {
        let summary = plan(paper(0.25, 0.25), 60.0, h, paths).run(2);
        assert!(summary.diverged.is_empty());
        for statistic in [
            StickDurationMean,
            FirstStickDurationMean,
            SticksPerPath,
            SlipsPerPath,
            SubPhasesMean,
            SubPhasesMultipleShare,
            StickingFraction,
            DisplacementEndMean,
            JumpAbsMean,
        ] {
            let (ours, our_error) = estimate(&summary, statistic);
            let (value, error) = reference::at_step(h, statistic.name());
            let is_so = (ours - value).abs() < 4.0 * our_error.hypot(error);
            assert!(
                is_so,
                "{h}, {}: {ours} +- {our_error}, not {value} +- {error}",
                statistic.name()
            );
            assert!(
                our_error < 0.01 * value.abs(),
                "{}: {our_error} is too coarse a test",
                statistic.name()
            );
        }
    }
}

/// The quantile sketch compared with the quantiles of all paths, sorted. It is right to within the
/// width of its bins, which is 1/256 of the distance from the centre plus a little. Where many
/// paths have exactly the same value (x' = 0 while static), the quantile is that value.
#[test]
fn bands_hold_the_quantiles_of_the_paths() {
    let mut plan = plan(paper(0.25, 0.25), 60.0, 0.01, 3000);
    plan.record.trajectories = plan.paths;
    let blocks = blocks(&plan, 2);
    let mut totals = Totals::empty(plan.model(), plan.timeline(), &plan.record);
    blocks.iter().for_each(|block| totals.merge(&block.totals));
    let bands = totals.summary().bands;
    let rows = plan.timeline().rows();
    for (band, centre, column) in [
        (
            &bands.displacement,
            6.0,
            (|t| &t.displacement) as fn(&TrajectoryRows) -> &Vec<f64>,
        ),
        (&bands.velocity, 0.0, |t| &t.velocity),
        (&bands.temperature, 0.0, |t| &t.temperature),
    ] {
        for row in 0..rows {
            let values = blocks
                .iter()
                .filter_map(|b| b.rows.trajectories.as_ref())
                .flat_map(|t| column(t).iter().skip(row).step_by(rows));
            let mut values: Array1<N64> = values.map(|&v| n64(v)).collect();
            assert_eq!(values.len(), 3000);
            for (level, sketched) in QUANTILE_LEVELS.iter().zip(bands_column(band, row)) {
                let exact = values
                    .quantile_mut(n64(*level), &Linear)
                    .expect("not empty")
                    .raw();
                let width = ((exact - centre).abs() + 0.1) / 256.0;
                // In the tails neighbouring order statistics may lie apart; at 5 % and 95 % the
                // 3000 paths are dense.
                assert!(
                    (sketched - exact).abs() <= 1.5 * width + 0.02,
                    "row {row}, {level}: {sketched} {exact}"
                );
                if exact == centre {
                    assert_eq!(sketched, exact, "an atom is exact");
                }
            }
        }
    }
}

fn bands_column(band: &Band, row: usize) -> Vec<f64> {
    band.quantiles.column(row).to_vec()
}

fn blocks(plan: &Plan, threads: usize) -> Vec<BlockResult> {
    let mut blocks = Vec::new();
    let delivered = plan.run_into(threads, &AtomicBool::new(false), |block| {
        blocks.push(block);
        Ok::<_, Infallible>(ControlFlow::Continue(()))
    });
    assert_eq!(delivered, Ok(plan.paths));
    blocks
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let plan = plan(paper(0.25, 0.25), 30.0, 0.01, 5 * BLOCK_SIZE + 17);
    let alone = blocks(&plan, 1);
    let summed = |blocks: &[BlockResult]| {
        let mut totals = Totals::empty(plan.model(), plan.timeline(), &plan.record);
        blocks.iter().for_each(|block| totals.merge(&block.totals));
        totals
    };
    for threads in [2, 3, 8] {
        let shared = blocks(&plan, threads);
        assert!(summed(&shared) == summed(&alone), "{threads} threads");
        for (a, b) in alone.iter().zip(&shared) {
            assert!(a.rows == b.rows);
        }
    }
}

#[test]
fn a_replayed_path_is_the_path_of_the_ensemble() {
    let plan = plan(paper(0.25, 0.25), 30.0, 0.01, 2 * BLOCK_SIZE);
    let all = blocks(&plan, 2);
    let path = 300u64;
    let alone = plan.replay(path);
    let (block, lane) = (&all[1], (path - BLOCK_SIZE) as usize);
    let (ours, theirs) = (
        alone.rows.events.expect("kept"),
        block.rows.events.as_ref().expect("kept"),
    );
    let before: u32 = theirs.count[..lane].iter().sum();
    let range = before as usize..(before + theirs.count[lane]) as usize;
    assert!(
        ours.time == theirs.time[range.clone()] && ours.displacement == theirs.displacement[range]
    );
    let columns = block.rows.path_columns.as_ref().expect("kept");
    assert_eq!(
        alone.rows.path_columns.expect("kept").displacement_end,
        [columns.displacement_end[lane]]
    );
}

/// When a run is stopped from outside, blocks ahead of the oldest unfinished one are finished: at
/// most eight for each thread.
const AHEAD: u64 = 8;

#[test]
fn a_stopped_run_delivers_a_prefix_and_a_failed_one_its_error() {
    let plan = plan(paper(0.25, 0.0), 5.0, 0.01, 60 * BLOCK_SIZE);
    for threads in [1, 3] {
        let (stop, mut seen) = (AtomicBool::new(false), Vec::new());
        let delivered = plan.run_into(threads, &stop, |block| {
            seen.push(block.rows.first_path);
            stop.store(seen.len() >= 4, Ordering::Relaxed);
            Ok::<_, Infallible>(ControlFlow::Continue(()))
        });
        let in_order: Vec<u64> = (0..seen.len() as u64).map(|k| k * BLOCK_SIZE).collect();
        assert_eq!(seen, in_order);
        assert_eq!(delivered, Ok(seen.len() as u64 * BLOCK_SIZE));
        let most = 3 + if threads == 1 {
            1
        } else {
            threads as u64 * AHEAD
        };
        assert!(
            (4..=most).contains(&(seen.len() as u64)),
            "the blocks in work are finished, no more: {}",
            seen.len()
        );

        let mut count = 0;
        let failed = plan.run_into(threads, &AtomicBool::new(false), |_| {
            count += 1;
            if count == 3 {
                Err("disk full")
            } else {
                Ok(ControlFlow::Continue(()))
            }
        });
        assert_eq!((failed, count), (Err("disk full"), 3));
    }
}

#[test]
fn a_run_ends_with_the_block_that_its_consumer_calls_the_last() {
    let plan = plan(paper(0.25, 0.0), 5.0, 0.01, 40 * BLOCK_SIZE);
    for threads in [1, 2, 7] {
        let mut seen = 0;
        let delivered = plan.run_into(threads, &AtomicBool::new(false), |_| {
            seen += 1;
            Ok::<_, Infallible>(if seen == 5 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            })
        });
        assert_eq!(
            (delivered, seen),
            (Ok(5 * BLOCK_SIZE), 5),
            "{threads} threads"
        );
    }
}

/// One thread takes several blocks of event-driven paths across each macro step together. Each
/// block has the same bits as when it is simulated alone, including the short last block and blocks
/// in which a path is given up.
#[test]
fn blocks_in_flight_together_are_the_blocks_alone() {
    let model = paper(0.25, 0.25);
    let timeline = Timeline {
        end: 30.0,
        output_step: 3.0,
        period: model.temperature.period(),
        after: 0.0,
    };
    let scheme = Scheme::from(EventDriven { tolerance: 1e-3 });
    let simulation = scheme.simulation(&model, &timeline).with_work_limit(340);
    assert!(simulation.vectorised_paths() as u64 >= 2 * BLOCK_SIZE);
    let record = Record {
        paths: true,
        events: true,
        trajectories: 3,
        ..Record::NOTHING
    };
    let paths = 17 * BLOCK_SIZE + 40;
    let plan = Plan {
        simulation,
        record,
        seed: 1,
        paths,
        antithetic: false,
    };
    let together = blocks(&plan, 1);
    let is_whole = |block: &BlockResult| block.diverged.is_empty();
    let whole = together.iter().filter(|block| is_whole(block)).count();
    assert!(
        (4..15).contains(&whole),
        "{whole} of 18 blocks lose no path"
    );
    for (index, block) in together.iter().enumerate() {
        let alone = plan.block(index as u64);
        assert_eq!(
            (block.rows.first_path, block.rows.paths),
            (alone.rows.first_path, alone.rows.paths)
        );
        assert_eq!(block.diverged, alone.diverged);
        assert_eq!(block.rows.events, alone.rows.events);
        let bits = |block: &BlockResult| {
            format!("{:?} {:?}", block.rows.path_columns, block.totals.summary())
        };
        assert_eq!(bits(block), bits(&alone), "block {index}");
    }
}

/// Above the critical amplitude the explicit scheme diverges. With a stationary start of a strong,
/// slow noise some paths are above it and some below. Those above are counted, listed and in no
/// statistic.
#[test]
fn diverged_paths_are_counted_listed_and_kept_out() {
    let mut model = paper(0.25, 0.0);
    model.friction = Friction {
        static_force: 0.01,
        dynamic_force: 0.01,
    };
    model.temperature = Temperature {
        noises: vec![OrnsteinUhlenbeck {
            intensity: 1.0,
            relaxation_rate: 1e-9,
            diffusion: 1e-5,
            initial: InitialNoise::Stationary,
        }],
        ..Temperature::default()
    };
    model.initial_displacement = 0.0;
    // The amplitude of a path is 6 |v(0)|, where v(0) has the standard deviation 0.2236. The
    // critical amplitude at h = 0.02 is 0.637, so about half of the paths are above it.
    let timeline = Timeline {
        end: 3000.0,
        output_step: 300.0,
        period: None,
        after: 0.0,
    };
    let plan = plan_on(&model, &timeline, 0.02, 2 * BLOCK_SIZE);
    let all = blocks(&plan, 2);
    let mut totals = Totals::empty(plan.model(), plan.timeline(), &plan.record);
    all.iter().for_each(|block| totals.merge(&block.totals));
    let summary = totals.summary();
    let diverged = summary.diverged.len();
    assert!((100..460).contains(&diverged), "{diverged} of 512");
    assert_eq!(summary.completed_paths, 512);
    assert!(summary.diverged.is_sorted());
    let columns: BTreeMap<u64, (f64, i8)> = all
        .iter()
        .flat_map(|block| {
            let columns = block.rows.path_columns.as_ref().expect("kept");
            (block.rows.first_path..).zip(
                columns
                    .displacement_end
                    .iter()
                    .copied()
                    .zip(columns.diverged.iter().copied()),
            )
        })
        .collect();
    for (path, (x, lost)) in &columns {
        assert_eq!(*lost == 1, summary.diverged.binary_search(path).is_ok());
        assert_eq!(*lost == 1, x.is_nan());
    }
    let kept: Vec<f64> = columns.values().filter(|c| c.1 == 0).map(|c| c.0).collect();
    let mean = kept.iter().sum::<f64>() / kept.len() as f64;
    let (ours, _) = estimate(&summary, Statistic::DisplacementEndMean);
    assert!(
        (ours - mean).abs() < 1e-12 && ours.abs() < 1.0,
        "{ours} {mean}"
    );
}

/// The numbers that the scene alone decides, from few paths: without f_d there is no friction work,
/// and with |b(0)| = 2.4 > f_s the first stick lasts zero and no path is static at t = 0. Twenty
/// random paths that agree by chance would have an interval without an upper end. The temperature
/// of a pair has the mean of the harmonics, up to rounding, and T(0) is given.
#[test]
fn what_the_scene_alone_decides_has_an_interval_of_width_zero() {
    let mut model = paper(0.25, 0.25);
    model.friction.dynamic_force = 0.0;
    model.initial_displacement = 3.6;
    for (scheme, antithetic) in [
        (Scheme::from(DiscreteVi { step: 0.02 }), false),
        (Scheme::from(DiscreteVi { step: 0.02 }), true),
        (Scheme::from(EventDriven { tolerance: 1e-3 }), false),
    ] {
        let timeline = Timeline {
            end: 20.0,
            output_step: 5.0,
            period: None,
            after: 0.0,
        };
        let record = Record::NOTHING;
        let simulation = scheme.simulation(&model, &timeline);
        let summary = Plan {
            simulation,
            record,
            seed: 1,
            paths: 20,
            antithetic,
        }
        .run(2);
        for statistic in [
            Statistic::FrictionWorkMean,
            Statistic::FirstStickDurationMean,
        ] {
            let e = summary.estimate(statistic);
            assert_eq!(
                [e.estimate, e.low, e.high],
                [0.0; 3],
                "{}",
                statistic.name()
            );
        }
        assert_eq!(
            (
                summary.first_sticks.completed,
                summary.first_sticks.censored
            ),
            (20, 0)
        );
        let ends = &summary.bands.static_probability_ends;
        assert_eq!([ends.low[0], ends.high[0]], [0.0; 2]);
        assert!(ends.high[1] > 0.1, "{ends:?}");
        let x = &summary.bands.displacement;
        assert!(
            x.quantile_ends.low[0] == 3.6 && x.quantile_ends.high[0] == 3.6,
            "{:?}",
            x.quantile_ends
        );
        let mean = &summary.bands.temperature.mean_ends;
        let is_bounded = mean.low.iter().chain(&mean.high).all(|end| end.is_finite());
        assert!(
            is_bounded && (mean.high[1] - mean.low[1] < 1e-9) == antithetic,
            "{mean:?}"
        );
    }
}
