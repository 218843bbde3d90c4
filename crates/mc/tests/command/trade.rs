//! The predictions of `mc trade` compared with closed forms, with the values of another
//! event-driven program, and with actual runs.

use crate::command::mc;
use crate::reference;
use std::path::Path;
use std::sync::LazyLock;
use std::time::Duration;
use stickslip::model::{InitialNoise, Problem};
use stickslip::scenario::Scenario;
use stickslip::scheme::{DiscreteVi, EventDriven, Kind, Scheme};
use stickslip::stats::Statistic;
use stickslip::study::trade::{
    Choice, Cost, Limits, Number, Pairing, PlannedCost, Refusal, SettingGrid, Standing, Trade,
    TradeSetting, measure,
};

fn shipped(name: &str) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenarios")
        .join(name)
        .with_extension("toml");
    Scenario::read(&path, &[]).expect("a shipped scenario")
}

const TWO_THREADS: usize = 2;

/// A pilot run of a few seconds on the noisy scene of the paper. The costs are fixed, so that no
/// choice depends on the machine: 1.2 ns for a step, 30 us for an event-driven path.
static PILOT: LazyLock<Trade> = LazyLock::new(|| {
    let scenario = shipped("rho025");
    let planned = PlannedCost {
        steps: 7,
        coupled_paths: 2560,
        free_paths: vec![1024, 8192, 1024, 16_384],
        timing: 0.0,
    };
    let mut trade = measure(
        &scenario,
        &SettingGrid::of(&scenario),
        &planned,
        TWO_THREADS,
        Limits::default(),
    )
    .expect("measured");
    for setting in &mut trade.settings {
        let seconds = setting.scheme.step().map_or(30e-6, |h| 1.2e-9 * 60.0 / h);
        setting.cost = Cost {
            first: seconds,
            each: seconds,
        };
    }
    trade
});

use Statistic::{StickDurationMean, StickingFraction, SticksPerPath, SubPhasesMean};

/// The value of another program, and its standard error (tests/reference/noisy.c, with relative
/// errors below 6e-4).
fn truth(statistic: Statistic) -> (f64, f64) {
    reference::limit(statistic.name())
}

/// The relative root mean square error of a statistic over `runs` runs of a choice.
fn rmse(choice: &Choice, statistic: Statistic, runs: u64) -> f64 {
    let (truth, _) = truth(statistic);
    let mut scenario = shipped("rho025")
        .with_scheme(choice.scheme)
        .expect("a scheme that `mc run` takes");
    scenario.time.output_step = scenario.time.end;
    scenario.record.paths = false;
    scenario.ensemble.paths = choice.paths;
    let square = |seed: u64| {
        scenario.ensemble.seed = 1000 + seed;
        let summary = scenario.plan().run(TWO_THREADS);
        (summary.estimate(statistic).estimate / truth - 1.0).powi(2)
    };
    ((0..runs).map(square).sum::<f64>() / runs as f64).sqrt()
}

/// A choice has the predicted error. Null hypothesis: the root mean square error is at most
/// `target`, and at least sqrt(target^2 - U^2), which is what remains if the true bias, of which
/// the choice knows only an upper bound U, is zero. Sample size: M = `runs` runs, from which the
/// error is known to a relative 1/sqrt(2M) (a chi-square of M degrees of freedom). Bounds: four
/// times this, and 3 % for the error of the variance in the pilot run. False-alarm rate: below
/// 1e-4. Half or twice the paths change the error by a factor of 1.41, which 100 runs find with
/// bounds of 0.31.
#[track_caller]
fn has_the_predicted_error(choice: &Choice, statistic: Statistic, target: f64, runs: u64) {
    let ratio = rmse(choice, statistic, runs) / target;
    let play = 4.0 / (2.0 * runs as f64).sqrt() + 0.03;
    let least = (1.0 - (choice.bias / target).powi(2)).sqrt();
    println!(
        "{} to {target}: {} --paths {}: found/promised = {ratio:.3}, between {:.3} and {:.3}",
        statistic.name(),
        choice.scheme,
        choice.paths,
        least * (1.0 - play),
        1.0 + play
    );
    assert!(ratio < 1.0 + play, "{ratio} {choice:?}");
    assert!(ratio > least * (1.0 - play), "{ratio} {choice:?}");
}

#[test]
fn the_recommended_run_has_the_error_it_was_recommended_for() {
    // The mean duration is that of the same test of `--accuracy` in the engine.
    let choice = PILOT.best(None, &[SticksPerPath], 0.01).expect("a choice");
    assert!(
        matches!(choice.scheme, Scheme::EventDriven(_)),
        "{choice:?}"
    );
    has_the_predicted_error(&choice, SticksPerPath, 0.01, 100);
}

/// This prediction depends on the bias, which for the discrete VI follows from the law, at a step
/// that the pilot run did not simulate.
#[test]
#[ignore = "a minute; errors 0.770 and 1.000 of the predicted ones"]
fn the_best_run_of_a_scheme_with_a_step_has_the_predicted_error() {
    let discrete = PILOT
        .best(Some(Kind::DiscreteVi), &[StickDurationMean], 0.05)
        .expect("a choice");
    assert!(
        !discrete.is_measured && discrete.bias > 0.02,
        "{discrete:?}"
    );
    has_the_predicted_error(&discrete, StickDurationMean, 0.05, 200);
    let corrected = PILOT
        .best(Some(Kind::CorrectedVi), &[StickDurationMean], 0.02)
        .expect("a choice");
    has_the_predicted_error(&corrected, StickDurationMean, 0.02, 200);
}

/// With several statistics each is within the target, and the most demanding one determines the
/// number of paths.
#[test]
#[ignore = "half a minute; error 1.102 of the predicted one"]
fn a_run_for_several_statistics_suits_the_most_demanding() {
    let all = [
        StickDurationMean,
        SticksPerPath,
        StickingFraction,
        SubPhasesMean,
    ];
    let together = PILOT
        .best(Some(Kind::EventDriven), &all, 0.01)
        .expect("a choice");
    let alone = all.map(|statistic| {
        PILOT
            .best(Some(Kind::EventDriven), &[statistic], 0.01)
            .expect("a choice")
    });
    let most = alone
        .iter()
        .max_by_key(|choice| choice.paths)
        .expect("four");
    assert!(
        together.paths >= most.paths && together.decisive == StickingFraction,
        "{together:?} {alone:?}"
    );
    has_the_predicted_error(&together, StickingFraction, 0.01, 100);
}

/// In theory the order is 1/2 for the discrete VI, and 1 for the corrected one. The first must be
/// found to 0.08. The second must be above 0.9, and at most 2 within two of its errors. Measured
/// errors of the fits: below 0.05 and 0.3. The pilot run has a fixed seed.
#[test]
fn the_ladder_sees_the_orders() {
    let order = |scheme| PILOT.law(scheme, StickDurationMean).expect("a law").order;
    let (plain, corrected) = (order(Kind::DiscreteVi), order(Kind::CorrectedVi));
    println!("{plain:?} {corrected:?}");
    assert!(
        (plain.value - 0.5).abs() < 0.08 && plain.error < 0.08,
        "{plain:?}"
    );
    assert!(
        corrected.value - 2.0 * corrected.error < 2.0 && corrected.value > 0.9,
        "{corrected:?}"
    );
}

/// Null hypothesis: the biases at the steps of the pilot run are those relative to the value of the
/// other program. The bound is four standard errors of the two references; the error of the setting
/// itself cancels. False-alarm rate: 6e-5 for each statistic, since the biases of all settings share
/// the reference.
#[test]
fn biases_are_those_against_another_program() {
    for statistic in [
        StickDurationMean,
        SticksPerPath,
        StickingFraction,
        SubPhasesMean,
    ] {
        let (truth, known_to) = truth(statistic);
        for setting in &PILOT.settings {
            let (bias, reference) = (
                PILOT.bias(setting, statistic),
                PILOT.settings[PILOT.reference].estimate(statistic),
            );
            let expected = setting.estimate(statistic).value - truth;
            let allowed = 4.0 * reference.error.hypot(known_to);
            assert!(
                (bias.value - expected).abs() < allowed,
                "{} {bias:?} {expected}",
                setting.scheme
            );
        }
    }
}

/// Everything except the costs is the same for any number of threads.
#[test]
fn a_measurement_is_reproducible() {
    let scenario = shipped("damped");
    let planned = PlannedCost {
        steps: 3,
        coupled_paths: 400,
        free_paths: vec![300, 300, 0, 300],
        timing: 0.0,
    };
    let run = |threads| {
        measure(
            &scenario,
            &SettingGrid::of(&scenario),
            &planned,
            threads,
            Limits::default(),
        )
        .expect("measured")
    };
    let (one, three) = (run(1), run(3));
    assert_eq!(one.settings.len(), 9);
    for (a, b) in one.settings.iter().zip(&three.settings) {
        // Compared as text, in which a number that does not exist equals itself.
        let (a, b) = (
            (a.scheme, a.paths, &a.estimates, &a.changes),
            (b.scheme, b.paths, &b.estimates, &b.changes),
        );
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }
}

/// Synthetic settings with value 1, variance v per path, bias C h^p and cost a/h, and an exact
/// reference of cost 1 s.
fn synthetic(c: f64, p: f64, v: f64, a: f64) -> Trade {
    const PATHS: u64 = 1 << 54; // so many that errors vanish
    let estimates = |value: f64| {
        vec![
            Number {
                value,
                error: (v / PATHS as f64).sqrt()
            };
            Statistic::ALL.len()
        ]
    };
    let setting = |scheme: Scheme, seconds, value: f64, changes| {
        let cost = Cost {
            first: 0.0,
            each: seconds,
        };
        TradeSetting {
            scheme,
            paths: PATHS,
            diverged: 0,
            cost,
            estimates: estimates(value),
            changes,
        }
    };
    let bias = |h: f64| c * h.powf(p);
    let steps: Vec<f64> = (0..9).map(|k| 0.1 * 0.5f64.powi(k)).collect();
    let mut settings: Vec<TradeSetting> = Vec::new();
    for (k, &h) in steps.iter().enumerate() {
        let change = Number {
            value: bias(h) - bias(h / 2.0),
            error: 1e-9,
        };
        let changes = if k + 1 < steps.len() {
            vec![change; Statistic::ALL.len()]
        } else {
            Vec::new()
        };
        settings.push(setting(
            DiscreteVi { step: h }.into(),
            a / h,
            1.0 + bias(h),
            changes,
        ));
    }
    settings.push(setting(
        EventDriven { tolerance: 1e-5 }.into(),
        1.0,
        1.0,
        Vec::new(),
    ));
    let reference = settings.len() - 1;
    let (left_out, pairing) = (Vec::new(), Pairing::Unknown);
    Trade {
        settings,
        reference,
        left_out,
        pairing,
        is_random: true,
        has_limitless_phases: false,
    }
}

/// Antithetic pairs with a seventh of the variance are chosen, with a seventh of the paths, rounded
/// up to whole pairs. If one of two statistics would need more paths, or if little is gained, paths
/// stay independent. The number of paths for the reference without bias is N = v/eps^2 with v =
/// 300, eps = 0.01.
#[test]
fn antithetic_pairs_are_chosen_where_they_pay() {
    let mut trade = synthetic(0.8, 0.5, 300.0, 1e-6);
    let [gains, little, loses] = [
        Statistic::DisplacementEndMean,
        Statistic::SticksPerPath,
        Statistic::StickDurationMean,
    ];
    let mut ratios = vec![1.0; Statistic::ALL.len()];
    for (statistic, ratio) in [(gains, 1.0 / 7.0), (little, 0.9), (loses, 1.6)] {
        ratios[Statistic::ALL
            .iter()
            .position(|s| *s == statistic)
            .expect("it is one")] = ratio;
    }
    let chosen = |trade: &Trade, asked: &[Statistic]| {
        let choice = trade
            .best(Some(Kind::EventDriven), asked, 0.01)
            .expect("a choice");
        (choice.is_antithetic, choice.paths)
    };
    let room = 0.01f64.powi(2) - 1e-5f64.powi(2);
    let (all, seventh) = ((300.0 / room).ceil() as u64, 300.0 / 7.0 / room);
    assert_eq!(chosen(&trade, &[gains]), (false, all));
    trade.pairing = Pairing::Measured(ratios);
    assert_eq!(
        chosen(&trade, &[gains]),
        (true, (seventh / 2.0).ceil() as u64 * 2)
    );
    for asked in [&[little][..], &[loses], &[gains, loses], &[gains, little]] {
        assert_eq!(chosen(&trade, asked), (false, all), "{asked:?}");
    }
    trade.pairing = Pairing::Asked;
    assert_eq!(chosen(&trade, &[loses]), (true, all.next_multiple_of(2)));
}

/// With bias C h^p, cost a/h and variance v per path, the cost N a/h = a v/(h (eps^2 - C^2 h^2p))
/// is least where C h^p = eps/sqrt(2p + 1). The nearest steps of the grid cost at most 13 % (p =
/// 1/2) or 19 % (p = 1) more. Beyond the grid the law has an error, which counts as bias: 40 %.
#[test]
fn the_cheapest_step_is_that_of_the_closed_form() {
    let (c, v, a) = (0.8, 300.0, 1e-6);
    for (p, within, beyond) in [(0.5, 0.13, 0.4), (1.0, 0.19, 0.4)] {
        let trade = synthetic(c, p, v, a);
        let least = |eps: f64| {
            let h = (eps / (c * (2.0 * p + 1.0).sqrt())).powf(1.0 / p);
            a * v / (h * (eps * eps - (c * h.powf(p)).powi(2)))
        };
        let finest = c * (0.1f64 / 256.0).powf(p) * (2.0 * p + 1.0).sqrt();
        for i in 0..20 {
            let eps = finest * 1.5 * 1.1f64.powi(i);
            let choice = trade
                .best(Some(Kind::DiscreteVi), &[Statistic::SticksPerPath], eps)
                .expect("a choice");
            let excess = choice.seconds / least(eps) - 1.0;
            assert!(
                choice.is_measured && (-1e-3..within + 1e-2).contains(&excess),
                "{eps} {excess} {choice:?}"
            );
        }
        let eps = finest / 10.0;
        let choice = trade
            .best(Some(Kind::DiscreteVi), &[Statistic::SticksPerPath], eps)
            .expect("a choice");
        let excess = choice.seconds / least(eps) - 1.0;
        assert!(
            !choice.is_measured && (0.0..beyond).contains(&excess),
            "{excess} {choice:?}"
        );
        // The reference costs 1 s for a path, and N = v/(eps^2 - 1e-10) = 300/(1e-4 (1 - 1e-6)).
        let exact = trade
            .best(Some(Kind::EventDriven), &[Statistic::SticksPerPath], 0.01)
            .expect("a choice");
        assert_eq!(exact.paths, 3_000_004);
    }
}

/// Without randomness every path is the same, so the choice is one path, and its error is the bias.
/// `exact` is the duration of the first stick.
#[track_caller]
fn one_path_is_the_answer(scenario: &Scenario, exact: f64) -> Trade {
    let mut grid = SettingGrid::of(scenario);
    let is_event_driven = |scheme: &&Scheme| matches!(scheme, Scheme::EventDriven(_));
    assert_eq!(
        grid.free.iter().filter(is_event_driven).count(),
        1,
        "one tolerance is as good as another"
    );
    let planned = PlannedCost {
        steps: 9,
        coupled_paths: 20,
        free_paths: vec![2; grid.free.len()],
        timing: 1e-3,
    };
    let trade = measure(scenario, &grid, &planned, 1, Limits::default()).expect("measured");
    let budgeted =
        PlannedCost::within(scenario, &mut grid, Duration::from_secs(10), 1).expect("it fits");
    assert_eq!(
        (budgeted.coupled_paths, budgeted.free_paths),
        (planned.coupled_paths, planned.free_paths)
    );
    let first = Statistic::FirstStickDurationMean;
    assert!((trade.settings[trade.reference].estimate(first).value - exact).abs() < 1e-12);
    for (scheme, target) in [
        (Kind::DiscreteVi, 0.01),
        (Kind::DiscreteVi, 0.001),
        (Kind::CorrectedVi, 0.001),
        (Kind::EventDriven, 1e-9),
    ] {
        let choice = trade
            .best(Some(scheme), &[first], target)
            .expect("a choice");
        assert_eq!(choice.paths, 1);
        let run = scenario
            .with_scheme(choice.scheme)
            .expect("runs")
            .plan()
            .run(1);
        let found = run.estimate(first).estimate;
        assert!((found / exact - 1.0).abs() <= target, "{found} {choice:?}");
    }
    trade
}

/// The exact first stick lasts 2.574004435 (40-digit arithmetic).
#[test]
fn without_noise_one_path_is_the_answer() {
    let trade = one_path_is_the_answer(&shipped("shaw"), 2.574_004_435_173_1);
    let order = trade
        .law(Kind::DiscreteVi, Statistic::DisplacementEndMean)
        .expect("a law")
        .order;
    assert!((order.value - 1.0).abs() < 0.1, "{order:?}");
    assert_eq!(trade.standing(Statistic::DisplacementEndSd), Standing::Zero);
}

/// v relaxes from v(0) = 2 without diffusion: b = 3 (e^{-t} - 1) reaches -1.2 at t = -ln 0.6.
#[test]
fn one_path_is_the_answer_where_the_noise_does_not_diffuse() {
    let mut scenario = shipped("rho025");
    let Problem {
        temperature,
        initial_displacement,
        ..
    } = &mut scenario.model;
    temperature.harmonics.clear();
    for noise in &mut temperature.noises {
        (noise.diffusion, noise.initial) = (0.0, InitialNoise::At(2.0));
    }
    *initial_displacement = 3.0;
    one_path_is_the_answer(&scenario, -0.6f64.ln());
}

#[test]
fn statistics_without_an_answer_have_a_reason() {
    let small = |name: &str, tolerances: usize| {
        let scenario = shipped(name);
        let planned = PlannedCost {
            steps: 2,
            coupled_paths: 40,
            free_paths: vec![64; tolerances],
            timing: 0.0,
        };
        measure(
            &scenario,
            &SettingGrid::of(&scenario),
            &planned,
            TWO_THREADS,
            Limits::default(),
        )
        .expect("measured")
    };
    let equal = small("equal-friction", 3);
    assert_eq!(
        equal.standing(Statistic::StickDurationMean),
        Standing::NoLimit
    );
    assert!(matches!(
        equal.standing(Statistic::StickingFraction),
        Standing::Value(_)
    ));
    let refused = equal.best(
        None,
        &[Statistic::StickingFraction, Statistic::SticksPerPath],
        0.5,
    );
    assert_eq!(refused, Err(Refusal::NoAnswer(Statistic::SticksPerPath)));
    let never = small("never-slips", 4);
    assert_eq!(
        never.standing(Statistic::StickDurationMean),
        Standing::Absent
    );
    assert_eq!(never.standing(Statistic::SticksPerPath), Standing::Zero);
    assert!(
        never
            .best(None, &[Statistic::StickingFraction], 1e-4)
            .is_ok()
    );
    let drift = PILOT.standing(Statistic::DriftVelocity);
    assert!(matches!(drift, Standing::Deviation(_)), "{drift:?}");
    assert_eq!(
        PILOT.best(Some(Kind::QuasiStatic), &[Statistic::SticksPerPath], 0.1),
        Err(Refusal::NotRun)
    );
    // 5120 paths do not determine the bias at the finest step well enough for an accuracy of 1e-6.
    let refused = PILOT.best(Some(Kind::EventDriven), &[Statistic::SticksPerPath], 1e-6);
    assert!(matches!(refused, Err(Refusal::Bias { .. })), "{refused:?}");
}

const RHO025: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/rho025.toml");

#[test]
fn the_command_refuses_before_it_measures() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("old.png"), "mine").expect("written");
    for (arguments, says) in [
        (vec!["--budget", "soon"], "60s"),
        (vec!["--budget", "0"], "one second"),
        (vec!["--statistic", "stick_duration"], "stick_duration_mean"),
        (vec!["-o", "old.h5"], "old.png already exists"),
        (
            vec!["-o", "picture.svg"],
            "picture.svg has the extension of a picture",
        ),
        (vec!["-o", "absent/trade.h5"], "the directory absent"),
        (vec!["--set", "time.end=0"], "`time.end` = 0"),
        (vec!["--force"], "--output"),
    ] {
        let output = mc(folder.path(), &[vec!["trade", RHO025], arguments].concat());
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(
            (output.status.code(), error.contains(says)),
            (Some(2), true),
            "{says}: {error}"
        );
    }
    assert_eq!(
        std::fs::read_to_string(folder.path().join("old.png")).expect("kept"),
        "mine"
    );
}

#[test]
fn the_command_leaves_a_table_a_file_and_two_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = mc(
        folder.path(),
        &["trade", RHO025, "--budget", "3s", "-o", "trade.h5"],
    );
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    let json = mc(folder.path(), &["show", "trade.h5", "--json"]).stdout;
    let json: serde_json::Value = serde_json::from_slice(&json).expect("one JSON object");
    let values =
        |kind: &str, name: &str| json[kind][name]["data"].as_array().expect("a list").clone();
    let place = |kind: &str, name: &str, of: serde_json::Value| {
        values(kind, name).iter().position(|x| *x == of)
    };
    let statistic =
        place("coords", "statistic", "stick_duration_mean".into()).expect("a statistic");
    let target = place("coords", "target", 0.01.into()).expect("a target");
    assert_ne!(values("data_vars", "winner")[statistic][target], "none");

    let file = hdf5::File::open(folder.path().join("trade.h5")).expect("HDF5");
    let shape = |name: &str| file.dataset(name).expect(name).shape();
    let settings = values("coords", "rung").len();
    assert_eq!(shape("rung_bias"), [settings, Statistic::ALL.len()]);
    assert_eq!(shape("predicted_seconds"), [3, Statistic::ALL.len(), 4]);
    let biases: Vec<f64> = file
        .dataset("rung_bias")
        .and_then(|d| d.read_raw())
        .expect("numbers");
    // The parser of JSON that is used here may be off by the last digit.
    let shown = values("data_vars", "rung_bias")[0][0]
        .as_f64()
        .expect("a number");
    assert!(
        (biases[0] - shown).abs() <= 2.0 * f64::EPSILON * shown.abs(),
        "{} {shown}",
        biases[0]
    );

    // The file prints all that was measured, or what is asked of it, in every format.
    let shown = |more: &[&str]| {
        let output = mc(folder.path(), &[&["show", "trade.h5"], more].concat());
        assert_eq!(
            output.status.code(),
            Some(0),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        String::from_utf8(output.stdout).expect("UTF-8")
    };
    assert!(shown(&["--all"]).contains("RMSE 0.01 %"));
    let csv = shown(&[
        "--statistics",
        "sticks_per_path,drift_velocity",
        "--format",
        "csv",
    ]);
    let names: Vec<&str> = csv
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').nth(1))
        .collect();
    assert_eq!(
        names,
        [["sticks_per_path"; 4], ["drift_velocity"; 4]].concat()
    );

    let png = std::fs::read(folder.path().join("trade.png")).expect("a PNG");
    assert!(png.starts_with(b"\x89PNG"));
    let svg = std::fs::read_to_string(folder.path().join("trade.svg")).expect("an SVG");
    for part in [
        "discrete-vi",
        "corrected-vi",
        "event-driven",
        "CPU time on one thread",
        "mean stick duration",
    ] {
        assert!(svg.contains(part), "{part}");
    }
    // A command to be pasted is in one line, however long it is.
    let is_narrow = |line: &str| line.contains("mc run") || line.chars().count() <= 120;
    assert!(table.lines().all(is_narrow), "{table}");
    assert!(
        table.contains("RMSE 0.01 %") && table.contains("mc run"),
        "{table}"
    );
}
