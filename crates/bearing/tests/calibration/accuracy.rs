//! The accuracy of estimates, and how often their intervals hold the truth.

use crate::bridge::{
    BRIDGE, Between, Campaign, RED_CAMPAIGN, SOUND, ask, bias, by_slips, covered, question, record,
    rmse, twin_of,
};
use stickslip_bearing::calibration::{
    Calibration, CalibrationMethod, FitObjective, MeasuredRecord, Motion, Quantity, Values, values,
};

const PARAMETERS: &[Quantity] = Quantity::ALL.split_at(Quantity::PARAMETERS).0;

/// Null hypothesis: the root mean square error of K, f_s and f_d is 1.8, 1.6 and 1.6 %, and that of
/// beta is 1.0 %, as measured over 400 other synthetic measurements with red noise; and intervals
/// of 90 % hold the truth. Sample size: 24 (seeds 100 to 123). Limits: 3 % and 1.5 % for the
/// errors, which 24 errors exceed by chance less than once in a thousand sets of seeds, since their
/// root mean square scatters by 15 %. At least 17 of 24 intervals must hold for each of seven
/// parameters; 16 or fewer hold by chance once in 400 sets for each parameter. At least 80 % of all
/// intervals together must hold. With intervals of half the width nearly every second set would
/// fail.
#[test]
fn intervals_cover_with_red_noise() {
    intervals_cover(&SOUND, Between::Weather);
}

/// The same for steel that is straight between samples.
#[test]
#[ignore = "half a minute; rmse 2.0, 1.4 and 1.4 % of K, f_s and f_d, 20 to 22 of 24 held"]
fn intervals_cover_where_temperature_is_straight() {
    let between = Between::Lines;
    let campaign = Campaign {
        between,
        ..RED_CAMPAIGN
    };
    intervals_cover(&by_slips(&campaign, 100..124), between);
}

fn intervals_cover(all: &[(Calibration, Values)], between: Between) {
    for quantity in PARAMETERS {
        println!(
            "{:22} rmse {:.2} %, held {} of 24",
            quantity.key(),
            100.0 * rmse(all, *quantity),
            covered(all, *quantity)
        );
    }
    for quantity in [Quantity::Stiffness, Quantity::Static, Quantity::Dynamic] {
        assert!(rmse(all, quantity) < 0.03, "{quantity:?}");
    }
    assert!(rmse(all, Quantity::Dilatation) < 0.015);
    for quantity in PARAMETERS {
        assert!(covered(all, *quantity) >= 17, "{quantity:?}");
    }
    let moves = |fit: &Calibration| {
        if fit.roughness > 0.0 {
            Between::Weather
        } else {
            Between::Lines
        }
    };
    assert!(all.iter().all(|(fit, _)| moves(fit) == between));
    let held: usize = PARAMETERS
        .iter()
        .map(|quantity| covered(all, *quantity))
        .sum();
    assert!(held >= 24 * 7 * 80 / 100, "{held} of {}", 24 * 7);
}

/// The long version: 200 synthetic measurements with red noise (seeds 1000 to 1199), of which
/// intervals of 90 % hold the truth in 85 to 95 % for each parameter. It takes a minute.
#[test]
#[ignore = "a minute"]
fn intervals_hold_what_they_promise() {
    for between in [Between::Weather, Between::Lines] {
        let all = by_slips(
            &Campaign {
                between,
                ..RED_CAMPAIGN
            },
            1000..1200,
        );
        let moved = all
            .iter()
            .filter(|(fit, _)| !fit.zero.steps.is_empty() || fit.zero.drift != 0.0)
            .count();
        println!("{between:?}, {moved} zeros seem to move");
        assert!(moved <= 4, "{moved}");
        for quantity in Quantity::ALL {
            let [off, share] = [
                100.0 * bias(&all, quantity),
                0.5 * covered(&all, quantity) as f64,
            ];
            println!(
                "{:22} {share:.1} % of 200, {off:.2} % too high",
                quantity.key()
            );
        }
        for quantity in PARAMETERS {
            assert!(
                (170..=190).contains(&covered(&all, *quantity)),
                "{quantity:?}"
            );
        }
    }
}

/// On three synthetic measurements with red noise, ten starting points of the least squares end
/// within 0.1 % of err of each other, at A and G within 1 % of the truth, and below the err of the
/// true parameters. That A and G are right shows that the global minimum was found; the error of K
/// is that which red noise causes.
#[test]
fn starts_of_the_least_squares_agree() {
    for seed in 300..303 {
        let (twin, truth) = twin_of(
            &BRIDGE,
            &Campaign {
                between: Between::Lines,
                ..RED_CAMPAIGN
            },
            seed,
        );
        let fit = ask(&record(&twin), &question(CalibrationMethod::Both));
        assert_eq!(fit.starts.len(), 10);
        let best = fit
            .starts
            .iter()
            .map(|start| start.err)
            .fold(f64::INFINITY, f64::min);
        for start in &fit.starts {
            assert!(
                start.err < 1.001 * best,
                "seed {seed}: {} and {best}",
                start.err
            );
            let found = values(&start.response, Some(2.0e9));
            for quantity in [Quantity::Reach, Quantity::Jump] {
                let off = found[quantity as usize] / truth[quantity as usize] - 1.0;
                assert!(off.abs() < 0.01, "seed {seed}, {quantity:?}: {off}");
            }
        }
        let objective = FitObjective::new(&record(&twin), 0.0);
        let motion = Motion {
            reach: truth[Quantity::Reach as usize],
            jump: truth[Quantity::Jump as usize],
            start: truth[Quantity::Displacement as usize] / BRIDGE.dilatation,
        };
        assert!(
            best <= objective.of(&motion).0 / objective.duration() * 1.0001,
            "seed {seed}"
        );
    }
}

/// CPU seconds that this process has used.
fn cpu() -> f64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Prints the CPU time of an evaluation of err, and of ten starting points; nothing is tested.
#[test]
#[ignore = "prints times"]
fn times() {
    let (twin, truth) = twin_of(&BRIDGE, &RED_CAMPAIGN, 1);
    let objective = FitObjective::new(&record(&twin), 0.0);
    let start = truth[Quantity::Displacement as usize] / BRIDGE.dilatation;
    let seconds = |reach: f64, jump: f64| {
        let begin = cpu();
        let sum: f64 = (0..300)
            .map(|i| {
                objective
                    .of(&Motion {
                        reach,
                        jump,
                        start: start + 1e-4 * f64::from(i),
                    })
                    .0
            })
            .sum();
        assert!(sum > 0.0);
        (cpu() - begin) / 300.0
    };
    for (reach, jump) in [
        (8.11, 1.63),
        (4.0, 0.4),
        (2.0, 0.1),
        (0.5, 0.01),
        (8.11, 0.0),
    ] {
        println!(
            "A {reach}, G {jump}: {:.1} us for {} samples",
            1e6 * seconds(reach, jump),
            twin.times.len()
        );
    }
    for method in [CalibrationMethod::Slips, CalibrationMethod::Both] {
        let begin = cpu();
        let fit = ask(&record(&twin), &question(method));
        println!(
            "{method:?}, {} starts: {:.2} s",
            fit.starts.len(),
            cpu() - begin
        );
    }
}

/// The synthetic measurements of `examples/bridge`, which another program made: at least five of
/// the seven intervals of 90 % hold the truth that `examples/bridge/README.md` states, every truth
/// is within twice its interval, and at least 110 of the 112 slips are found. Fewer than five
/// intervals hold by chance for one in 40 such measurements; this one is fixed, and six hold.
#[test]
fn the_twin_of_another_program_is_fitted() {
    let text = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/bridge/twin.csv"
    ))
    .expect("the example");
    let cell = |line: &str, column: usize| {
        line.split(',')
            .nth(column)
            .and_then(|cell| cell.parse::<f64>().ok())
    };
    let lines: Vec<&str> = text.lines().skip(1).collect();
    let record = MeasuredRecord {
        times: (0..lines.len()).map(|i| 600.0 * i as f64).collect(),
        temperatures: lines
            .iter()
            .map(|line| cell(line, 1).expect("a number"))
            .collect(),
        readings: lines
            .iter()
            .map(|line| 1e-3 * cell(line, 2).expect("a number"))
            .collect(),
        ..MeasuredRecord::default()
    };
    let fit = ask(&record, &question(CalibrationMethod::Both));
    let truth = [
        1.89e8,
        3.06e-4,
        4.69e5,
        4.22e5,
        4.70e4,
        -9.67e-3,
        3.821_051_6e-3,
    ];
    let mut held = 0;
    for (quantity, truth) in PARAMETERS.iter().zip(truth) {
        let estimate = fit.estimate(*quantity);
        println!(
            "{:22} {truth:.4e} in {:.4e} to {:.4e}",
            quantity.key(),
            estimate.low,
            estimate.high
        );
        held += usize::from(estimate.holds(truth));
        let off = (estimate.estimate - truth).abs();
        assert!(
            off < estimate.high - estimate.low,
            "{quantity:?}: {truth} far from {estimate:?}"
        );
    }
    assert!(held >= 5, "{held} of 7");
    assert!(
        (110..=112).contains(&fit.slips.len()),
        "{}",
        fit.slips.len()
    );
}

/// A record of 18 days has some 14 slips, and one of 90 days more than 20.
#[test]
fn few_slips_are_said() {
    for (days, is_said) in [(18.0, true), (90.0, false)] {
        let (fit, _) = &by_slips(
            &Campaign {
                days,
                ..RED_CAMPAIGN
            },
            3120..3121,
        )[0];
        assert_eq!(
            crate::bridge::warns(fit, "few_slips"),
            is_said,
            "{}: {:?}",
            fit.slips.len(),
            fit.warnings
        );
    }
}

/// How often intervals of 90 % hold the truth where slips are few. From 14 to 17 slips, of 18
/// intervals of f_s 14 held, of f_d 12 and of their difference 13; from 18 to 23, of 43 40, 39, 41.
#[test]
#[ignore = "a minute and a half; prints a table"]
fn few_slips() {
    let mut all = by_slips(
        &Campaign {
            days: 40.0,
            ..RED_CAMPAIGN
        },
        3000..3120,
    );
    all.extend(by_slips(
        &Campaign {
            days: 90.0,
            ..RED_CAMPAIGN
        },
        3120..3240,
    ));
    for range in [6..10, 10..14, 14..18, 18..24, 24..40] {
        let some: Vec<_> = all
            .iter()
            .filter(|(fit, _)| range.contains(&fit.slips.len()))
            .collect();
        let held = |quantity: Quantity| {
            let holds = |(fit, truth): &&&(Calibration, Values)| {
                let estimate = fit.estimate(quantity);
                (estimate.low..=estimate.high).contains(&truth[quantity as usize])
            };
            some.iter().filter(holds).count()
        };
        let [f_s, f_d, gap] = [Quantity::Static, Quantity::Dynamic, Quantity::Gap].map(held);
        println!(
            "{range:?} slips: of {} intervals {f_s}, {f_d} and {gap} hold",
            some.len()
        );
    }
}
