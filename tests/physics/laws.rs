//! Quantiles of the laws of phases, however many paths there are and over however many decades the
//! law extends, against the sorted values of the same run.

use super::measures::run;
use stickslip::dataset::{Column, Dataset, Recorder};
use stickslip::engine::Run;
use stickslip::scenario::Scenario;
use stickslip::scheme::{CorrectedVi, EventDriven, Scheme};
use stickslip::stats::{Distribution, PassageLevels, PhaseLaw, QUANTILE_LEVELS, Record, Summary};

/// The values of every law from the events of a run, in the order of the laws below.
fn values(dataset: &Dataset) -> [Vec<f64>; 6] {
    let of = |name: &str| &dataset.entry(name).expect("recorded").column;
    let (Column::F64(time), Column::F64(x)) = (of("event_time"), of("event_displacement")) else {
        panic!()
    };
    let (Column::I8(kind), Column::U32(count)) = (of("event_kind"), of("event_count")) else {
        panic!()
    };
    let mut laws: [Vec<f64>; 6] = Default::default();
    let mut first = 0;
    for events in count {
        let (mut stick, mut slip): (Option<f64>, Option<(f64, f64)>) = (None, None);
        for i in first..first + *events as usize {
            match kind[i] {
                0 => {
                    let (start, from) = slip.expect("a slip before");
                    let jump = x[i] - from;
                    laws[1].push(time[i] - start);
                    laws[2].push(jump.abs());
                    if jump != 0.0 {
                        laws[if jump > 0.0 { 3 } else { 4 }].push(jump.abs());
                    }
                    stick = Some(time[i]);
                }
                1 => {
                    laws[0].extend(stick.map(|since| time[i] - since));
                    laws[5].extend(slip.map(|(since, _)| time[i] - since));
                    slip = Some((time[i], x[i]));
                }
                _ => {}
            }
        }
        first += *events as usize;
    }
    laws.iter_mut()
        .for_each(|law| law.sort_unstable_by(f64::total_cmp));
    laws
}

fn measured(static_force: f64, scheme: Scheme, paths: u64) -> (Summary, [Vec<f64>; 6]) {
    let mut scene = Scenario::shipped("rho025").expect("shipped");
    scene.model.friction.static_force = static_force;
    let mut scene = scene.with_scheme(scheme).expect("suits");
    scene.ensemble.paths = paths;
    scene.record = Record {
        laws: true,
        events: true,
        levels: PassageLevels::NONE,
        ..Record::NOTHING
    };
    let mut recorder = Recorder::default();
    let summary = Run::of(&scene)
        .without_bias()
        .into_sink(&mut recorder)
        .simulate()
        .expect("no sink fails")
        .summary;
    (summary, values(&recorder.into_dataset()))
}

fn law(summary: &Summary, law: PhaseLaw) -> &Distribution {
    summary.law(law).expect("asked for")
}

/// Close to f_s = f_d the laws extend over many decades, and most of their values are tiny: bins of
/// equal width put the median of 4000 paths 4 times as high as that of 60. A quantile is the sorted
/// value of its rank to a tenth of its own standard error (a quarter of its interval, which is that
/// of the ranks), or to the half of a per cent of a bin of 256 an octave. Bins twice as wide as a
/// quantile's error would be off by several of them.
#[test]
fn more_paths_do_not_spoil_quantiles_over_decades() {
    for static_force in [1.0, 1.05, 1.1, 1.2] {
        for paths in [50, 500, 2000] {
            let (summary, values) =
                measured(static_force, EventDriven { tolerance: 1e-3 }.into(), paths);
            for (name, sorted) in PhaseLaw::ALL.into_iter().zip(&values) {
                let found = law(&summary, name);
                assert_eq!(found.completed, sorted.len() as u64, "{}", name.name());
                for (i, p) in QUANTILE_LEVELS.into_iter().enumerate() {
                    let rank = p * (sorted.len() - 1) as f64;
                    let [below, above] =
                        [rank.floor(), rank.ceil()].map(|rank| sorted[rank as usize]);
                    let exact = below + (above - below) * rank.fract();
                    let ends = found.quantile_ends.at(i);
                    let error = if ends[0] > 0.0 && ends[1].is_finite() {
                        (ends[1] - ends[0]) / 4.0
                    } else {
                        0.0
                    };
                    let off = (found.quantiles[i] - exact).abs();
                    assert!(
                        off <= (0.1 * error).max(0.005 * exact),
                        "f_s = {static_force}, {paths} paths, {}, {p}: {} for {exact} +- {error}",
                        name.name(),
                        found.quantiles[i]
                    );
                }
            }
        }
    }
}

/// Durations of a scheme with a step are whole steps, and their quantiles the smallest number of steps
/// that a share p does not exceed, to the step up to 1024 of them.
#[test]
fn quantiles_of_whole_steps_are_exact() {
    let h = 0.01;
    for (static_force, paths) in [(1.05, 2000), (1.2, 50), (1.2, 500)] {
        let (summary, values) = measured(static_force, CorrectedVi { step: h }.into(), paths);
        for (name, sorted) in PhaseLaw::ALL
            .into_iter()
            .zip(&values)
            .filter(|(law, _)| matches!(law, PhaseLaw::Stick | PhaseLaw::Slip))
        {
            for (i, p) in QUANTILE_LEVELS.into_iter().enumerate() {
                let rank = (p * sorted.len() as f64 * (1.0 - 1e-15)).ceil().max(1.0) as usize;
                let steps = |time: f64| (time / h).round();
                let (found, exact) = (
                    steps(law(&summary, name).quantiles[i]),
                    steps(sorted[rank - 1]),
                );
                let tolerated = if exact <= 1024.0 { 0.0 } else { 2.0 };
                assert!(
                    (found - exact).abs() <= tolerated,
                    "{paths}, {}, {p}: {found} {exact}",
                    name.name()
                );
            }
        }
    }
}

/// The median that bins of equal width spoiled: 4.6e-4 +- 0.6e-4 at f_s = 1.1 from few
/// paths and from many.
#[test]
fn the_median_jump_of_many_paths_is_that_of_few() {
    let medians = [60, 2000].map(|paths| {
        let mut scene = Scenario::shipped("rho025").expect("shipped");
        scene.model.friction.static_force = 1.1;
        let mut scene = scene
            .with_scheme(EventDriven { tolerance: 1e-3 })
            .expect("suits");
        (scene.ensemble.paths, scene.record) = (
            paths,
            Record {
                laws: true,
                ..Record::NOTHING
            },
        );
        run(&scene)
            .estimate(stickslip::stats::Statistic::JumpAbsMedian)
            .estimate
    });
    println!("{medians:?}");
    assert!(
        medians
            .iter()
            .all(|median| (3.4e-4..5.8e-4).contains(median)),
        "{medians:?}"
    );
}
