//! Tests of the advice: limits of the step separate decay from growth, derived quantities agree
//! with closed forms, and each warning is given where it is due.

use super::*;
use crate::config::{Override, shipped};
use crate::model::Oscillator;
use crate::scenario::arbitrary::scenario;
use crate::scenario::{MAX_ROWS, Scenario};
use crate::scheme::{Kind, Stability};
use proptest::prelude::*;

const BASE: &str = include_str!("../../scenarios/rho025.toml");

fn base(overrides: &[&str]) -> Scenario {
    let overrides: Vec<Override> = overrides
        .iter()
        .map(|text| Override::set(text).unwrap())
        .collect();
    Scenario::parse("rho025.toml", BASE, &overrides).unwrap()
}

/// The largest resident set of `event-driven` with 20 001 rows on one thread, in MB.
#[test]
fn memory_is_estimated_as_it_was_measured() {
    for (paths, measured) in [(8, 74.0), (64, 146.0), (512, 378.0), (2048, 378.0)] {
        let set = [
            "scheme.kind=event-driven",
            "time.end=60",
            "time.output_step=0.003",
        ]
        .map(Override::set);
        let set = set.map(|set| set.expect("well formed"));
        let scenario = shipped("rho025")
            .expect("shipped")
            .parse(&set)
            .expect("sound");
        let ratio = scenario.run_bytes(paths, 1) / (1e6 * measured);
        assert!((0.95..1.5).contains(&ratio), "{paths}: {ratio}");
    }
}

#[test]
fn the_expected_amplitude_is_large_where_the_body_is_moved_far() {
    // Here A_c = 127, and v(0) = 1e5 moves the body by beta rho v(0). At w h = 2 pi + 8e-4 the
    // scheme takes a fast forcing for a slow one; at 0.9 pi it does not. With a step of 0.2, A_c is
    // 6.4: the relaxed start leaves no free oscillation, but the noise excites one.
    let grows = |set: &[&str]| {
        let warnings = base(set).warnings();
        warnings
            .iter()
            .any(|w| w.name() == "amplitude-above-critical")
    };
    let forcing =
        |w: f64| format!("temperature.harmonics=[{{ amplitude = 1e3, angular_frequency = {w} }}]");
    let quiet = ["temperature.noise.intensity=0", "initial.displacement=0"];
    assert!(grows(&[
        "temperature.noise.initial=1e5",
        "temperature.noise.relaxation_rate=1e-3"
    ]));
    assert!(grows(&[&forcing(628.4), quiet[0], quiet[1]]));
    assert!(!grows(&[&forcing(283.0), quiet[0], quiet[1]]));
    assert!(grows(&["time.step=0.2", "time.output_step=0.2"]));
}

#[test]
fn the_expected_amplitude_adds_forced_and_free_motion() {
    // Closed forms in units of 1 for the event-driven scheme, which has no step. The forcing 6
    // cos(t/4) gives an amplitude of 6/(1 - 1/16) = 6.4, and a largest velocity of 1.6. The start
    // is at x0 = 6, which is 0.4 off, or at x0 = -6, which is 12.4 off, or later at |b| = f_s =
    // 1.2.
    let expected = |set: &[&str]| {
        let set = [
            &["scheme.kind=event-driven", "temperature.noise.intensity=0"],
            set,
        ]
        .concat();
        base(&set).derived().expected_amplitude
    };
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    near(expected(&[]), 6.4 + 1.2f64.hypot(1.6));
    near(expected(&["initial.displacement=-6"]), 6.4 + 12.4);
    // v relaxes from -4 like e^{-2t}. The response is -6/(1 + 4) in x and 12/5 in x'. There is no
    // harmonic.
    let noise = [
        "temperature.noise.intensity=0.25",
        "temperature.noise.initial=-4",
        "temperature.noise.diffusion=0",
    ];
    let relaxing = [
        &noise[..],
        &[
            "temperature.noise.relaxation_rate=2",
            "temperature.harmonics=[]",
        ],
    ]
    .concat();
    near(
        expected(&[&["scheme.kind=event-driven"], &relaxing[..]].concat()),
        1.2 + 7.2f64.hypot(2.4),
    );
    // Nothing slips, so the body stays where it is. At resonance, after a time t, the amplitude has
    // grown by w0 t/2.
    near(expected(&["friction.static=1000"]), 6.0);
    assert!(expected(&["temperature.harmonics.0.angular_frequency=1"]) >= 6.0 * 30.0);
}

/// The size of (X, V) after many slip steps of a scheme, without forcing and friction.
fn size_after_slip(kind: Kind, oscillator: &Oscillator, h: f64) -> f64 {
    let (mut x, mut v) = (1.0f64, 0.0f64);
    for _ in 0..20_000 {
        let next = v + h / oscillator.mass * oscillator.force(0.0, x, v);
        x += h * if kind == Kind::CorrectedVi { next } else { v };
        v = next;
    }
    x.abs() + v.abs()
}

fn decays(oscillator: &Oscillator, h: f64) -> bool {
    size_after_slip(Kind::DiscreteVi, oscillator, h) < 1.0
}

#[test]
fn the_stability_limit_separates_bounded_from_unbounded() {
    let kind = Kind::CorrectedVi;
    for damping in [0.0, 0.1, 0.5, 1.0, 4.0] {
        let scenario = base(&[
            "scheme.kind=corrected-vi",
            &format!("oscillator.damping={damping}"),
        ]);
        let Some(Stability::NewVelocity {
            largest_step: limit,
        }) = scenario.derived().stability
        else {
            panic!()
        };
        assert!(
            size_after_slip(kind, &scenario.model.oscillator, 0.99 * limit) < 100.0,
            "{damping}: {limit}"
        );
        let beyond = size_after_slip(kind, &scenario.model.oscillator, 1.01 * limit);
        assert!(beyond > 1e6 || beyond.is_nan(), "{damping}: {limit}");
    }
}

#[test]
fn the_stability_limit_separates_decay_from_growth() {
    for damping in [0.1, 0.5, 0.999, 1.0, 1.5, 4.0] {
        let set = format!("oscillator.damping={damping}");
        let scenario = base(&[&set]);
        let limit = match scenario.derived().stability {
            Some(
                Stability::Underdamped { largest_step } | Stability::Overdamped { largest_step },
            ) => largest_step,
            undamped => panic!("{undamped:?}"),
        };
        assert!(
            decays(&scenario.model.oscillator, 0.99 * limit),
            "{damping}: {limit}"
        );
        assert!(
            !decays(&scenario.model.oscillator, 1.01 * limit),
            "{damping}: {limit}"
        );
    }
}

/// The amplitude after many half-cycles of the slip scheme with friction f_d and without forcing.
fn amplitude_after(start: f64, h: f64, f_d: f64, half_cycles: usize) -> f64 {
    let (mut x, mut v, mut turns) = (start, 0.0f64, 0);
    while turns < half_cycles {
        let s = v - h * x;
        let next = s - h * f_d * s.signum();
        x += h * v;
        turns += usize::from(v * next < 0.0);
        v = next;
    }
    x.abs()
}

#[test]
fn the_critical_amplitude_separates_decay_from_growth() {
    let scenario = base(&["time.step=0.01"]);
    let Some(Stability::Undamped {
        critical_amplitude: critical,
    }) = scenario.derived().stability
    else {
        panic!()
    };
    assert!((critical - 127.32).abs() < 0.01);
    assert!(amplitude_after(0.95 * critical, 0.01, 1.0, 20) < 0.95 * critical);
    assert!(amplitude_after(1.05 * critical, 0.01, 1.0, 20) > 1.05 * critical);
}

#[test]
fn derived_quantities_of_the_noisy_scene() {
    let derived = base(&[]).derived();
    assert_eq!(derived.natural_frequency, 1.0);
    assert_eq!(derived.frequency_ratios, [0.25]);
    assert!((derived.noise_force.unwrap() - 1.5 / 2f64.sqrt()).abs() < 1e-15);
    assert!((derived.stick_band_half_width.unwrap() - 0.8 * 2f64.sqrt()).abs() < 1e-15);
    assert!((derived.stick_band_time.unwrap() - 0.64).abs() < 1e-15);
    assert_eq!(
        (derived.whole_periods, derived.steps, derived.rows),
        (2.0, Some(6000), 121)
    );
    assert_eq!(derived.counted_periods, 1);
    assert_eq!(derived.path_steps, Some(6e7));
}

#[test]
fn warnings_say_what_the_scene_is_about() {
    let names = |set: &[&str]| {
        base(set)
            .warnings()
            .iter()
            .map(Warning::name)
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&["time.end=110"]), ["stick-exit-bias"]);
    assert_eq!(
        names(&["time.end=110", "friction.static=1"]),
        ["equal-friction"]
    );
    assert!(
        names(&["time.step=0.2", "time.output_step=0.2"]).contains(&"amplitude-above-critical")
    );
    assert!(names(&["time.step=0.25"]).contains(&"step-against-stick-band"));
    assert!(names(&["time.step=0.02"]).contains(&"micro-slips"));
    assert!(names(&["oscillator.damping=0.01", "time.step=0.02"]).contains(&"step-unstable"));
    assert!(!names(&["oscillator.damping=0.01", "time.step=0.01"]).contains(&"step-unstable"));
    assert!(names(&["temperature.noise.relaxation_rate=1000"]).contains(&"step-against-noise"));
    assert!(
        names(&["temperature.harmonics.0.angular_frequency=100"]).contains(&"step-against-forcing")
    );
    assert!(names(&["oscillator.stiffness=1e4"]).contains(&"step-against-oscillator"));
    assert_eq!(
        names(&["time.end=110", "temperature.noise.intensity=0"]),
        ["identical-paths"]
    );
    assert_eq!(
        names(&["time.end=110", "friction.static=1000"]),
        ["never-slips"]
    );
    assert!(names(&["oscillator.dilatation=0"]).contains(&"no-dilatation"));
    assert!(names(&["temperature.harmonics.0.angular_frequency=1e5"]).contains(&"many-periods"));
    assert!(names(&["ensemble.paths=100000000"]).contains(&"large-output"));
}

/// The wall is as stiff as K = 1e5, and w0 h = 3.16 there.
#[test]
fn a_force_that_the_step_cannot_follow_is_named_with_its_place() {
    let warnings = |kind: &str, step: &str, force: &str| {
        let (kind, force) = (
            format!("scheme.kind={kind}"),
            format!("force.expression={force}"),
        );
        let step = format!("time.step={step}");
        base(&[&kind, &force, &step, "time.end=110"]).warnings()
    };
    let says = |kind: &str, step: &str, force: &str, name: &str, text: &str| {
        let found = warnings(kind, step, force);
        let is_said = found
            .iter()
            .any(|w| w.name() == name && w.to_string().contains(text));
        assert!(is_said, "{kind} {step} {force}: {found:?}");
    };
    for kind in ["discrete-vi", "corrected-vi"] {
        says(
            kind,
            "0.01",
            "-1e5*max(x-3,0)",
            "step-unstable",
            "has the stiffness K = 100000 at x = 3.",
        );
        says(
            kind,
            "0.01",
            "-1e5*max(x-3,0)",
            "step-unstable",
            "exceeds the stability limit 0.00632 there",
        );
        says(
            kind,
            "0.01",
            "-500*xdot",
            "step-unstable",
            "the step 0.01 exceeds the stability limit",
        );
        says(
            kind,
            "0.01",
            "-500*xdot - x^3",
            "step-unstable",
            "acts like damping alpha = 250 at",
        );
    }
    let energy = "% to the body's energy in every half-cycle";
    says(
        "discrete-vi",
        "0.01",
        "-1e3*max(x-3,0)",
        "step-unstable",
        &format!("the explicit step 0.01 adds 170 {energy}"),
    );
    says(
        "discrete-vi",
        "0.01",
        "-20*max(x-3,0)",
        "step-unstable",
        &format!("the explicit step 0.01 adds 15.5 {energy}"),
    );
    says(
        "corrected-vi",
        "0.01",
        "-1e3*max(x-3,0)",
        "step-against-oscillator",
        "9.93 steps per half-cycle there",
    );
    for force in [
        "-0.01*x^3",
        "0.1*xdot - 0.05*x^2*xdot",
        "-10*max(x-3,0)",
        "sin(x)",
    ] {
        let found = warnings("discrete-vi", "0.01", force);
        assert!(
            found.iter().all(|w| !w.name().starts_with("step")),
            "{force}: {found:?}"
        );
    }
}

/// With f_d = 0.95 f_s: a load of 1.2 in forward slips alone, and loads that are continuous at rest, or
/// jump with the direction of the threshold, too.
#[test]
fn a_load_that_jumps_as_a_slip_begins_is_warned_about() {
    let warns = |load: &str| {
        let load = format!("friction.load='{load}'");
        let scenario = base(&["friction.static=1", "friction.dynamic=0.95", &load]);
        scenario
            .warnings()
            .iter()
            .any(|warning| warning.name() == "friction-jumps")
    };
    assert!(warns("1 + 0.2*sign(xdot)"));
    assert!(warns("1 - 0.2*sign(xdot)"));
    assert!(warns("1 + max(t - 50, 0)*abs(sign(xdot))"));
    for sound in [
        "1 + 0.2*direction",
        "1 + 0.03*sign(xdot)",
        "1 - 0.3*abs(sign(xdot))",
        "1 + 0.3*(1 - exp(-abs(xdot)/0.01))",
        "1.3 + cos(x)*cos(t)",
    ] {
        assert!(!warns(sound), "{sound}");
    }
}

#[test]
fn bodies_that_nothing_holds_run_away() {
    let runs_away = |set: &[&str]| {
        let set = [&["scheme.kind=event-driven", "time.end=110"], set].concat();
        base(&set)
            .warnings()
            .iter()
            .any(|warning| warning.name() == "runs-away")
    };
    assert!(runs_away(&["oscillator.damping=-1"]) && runs_away(&["oscillator.damping=-2"]));
    assert!(runs_away(&["force.expression=2*x"]) && runs_away(&["force.expression=x*t"]));
    assert!(runs_away(&["force.expression=0.3*xdot - 1e-9*x^3"]));
    assert!(!runs_away(&["force.expression=0.5*x"]) && !runs_away(&["force.expression=-x^3"]));
    assert!(!runs_away(&["force.expression=(0.3 - 0.05*x^2)*xdot"]));
}

#[test]
fn warnings_are_those_of_the_scheme() {
    let names = |kind: &str, set: &[&str]| {
        let scenario = base(&[&[&*format!("scheme.kind={kind}"), "time.end=110"], set].concat());
        scenario
            .warnings()
            .iter()
            .map(Warning::name)
            .collect::<Vec<_>>()
    };
    assert_eq!(names("corrected-vi", &[]), ["corrected-bias"]);
    assert!(names("corrected-vi", &["time.step=0.001"]).is_empty());
    assert!(names("event-driven", &[]).is_empty());
    assert_eq!(names("quasi-static", &[]), ["forcing-during-slip"]);
    assert_eq!(
        names("corrected-vi", &["friction.static=1"]),
        ["incomplete-correction", "equal-friction"]
    );
    assert_eq!(
        names("event-driven", &["friction.static=1"]),
        ["resolution"]
    );
    assert_eq!(
        names("quasi-static", &["friction.static=1"]),
        ["never-moves"]
    );
    assert!(
        names(
            "corrected-vi",
            &["oscillator.stiffness=1e4", "friction.static=1e5"]
        )
        .contains(&"step-against-oscillator")
    );
    assert!(
        names(
            "event-driven",
            &[
                "oscillator.stiffness=1e9",
                "temperature.noise.relaxation_rate=1e3"
            ]
        )
        .is_empty()
    );
    let slow = [
        "temperature.harmonics.0.angular_frequency=1e-4",
        "temperature.noise.intensity=0",
        "ensemble.paths=1",
    ];
    assert_eq!(names("quasi-static", &slow), ["few-periods"]);
    // The harmonics change the force by up to 6e-4 per unit of time. That is slower than the body
    // swings back at zeta = 0.3, which is by up to 0.05, and faster than at 0.9, by up to 1.2e-4,
    // and at 1.5, where it does not swing back. Noise that is as slow ends slips at any damping.
    let swings = |damping: &str| {
        names(
            "quasi-static",
            &[&slow[..], &[&*format!("oscillator.damping={damping}")]].concat(),
        )
    };
    assert_eq!(swings("0.3"), ["few-periods"]);
    assert_eq!(
        (swings("0.9"), swings("1.5")),
        (vec!["creep", "few-periods"], vec!["creep", "few-periods"])
    );
    let slow_noise = [
        "oscillator.damping=1.5",
        "temperature.harmonics.0.angular_frequency=1e-4",
        "temperature.noise.relaxation_rate=1e-3",
        "temperature.noise.diffusion=0.01",
    ];
    assert_eq!(
        names("quasi-static", &slow_noise),
        ["forcing-during-slip", "few-periods"]
    );
    let viaduct = |kind: &str| {
        let set = [Override::flag("--scheme", "scheme.kind", kind)];
        let viaduct = Scenario::parse("viaduct", shipped("viaduct").unwrap().text, &set).unwrap();
        viaduct
            .warnings()
            .iter()
            .map(Warning::name)
            .collect::<Vec<_>>()
    };
    // The period of days and years together is four years, and the run is 300 days long.
    assert_eq!(
        (viaduct("event-driven"), viaduct("quasi-static")),
        (vec!["few-periods"], vec!["few-periods"])
    );
}

/// The forcing period is 25.13, and the first one of a run is not counted.
#[test]
fn a_drift_takes_three_periods_beyond_the_burn_in() {
    let few = |set: &[&str]| {
        let warnings = base(set).warnings();
        let few = warnings
            .iter()
            .find(|warning| warning.name() == "few-periods")?;
        Some(few.to_string())
    };
    assert_eq!(few(&["time.end=101"]), None);
    assert_eq!(few(&["time.end=126", "statistics.after=50"]), None);
    for (set, says) in [
        (&["time.end=100"][..], "are estimated from 2 whole periods"),
        (
            &[],
            "are estimated from 1 whole period, without the first of the run",
        ),
        (&["time.end=50"], "no whole period is counted"),
        (
            &["time.end=125", "statistics.after=50"],
            "are estimated from 2 whole periods",
        ),
        (
            &["time.end=126", "statistics.after=51"],
            "`time.end` = 151 or more",
        ),
        (
            &["time.end=126", "statistics.after=101"],
            "no whole period is counted",
        ),
    ] {
        let text = few(set).unwrap_or_else(|| panic!("{set:?}"));
        assert!(text.contains(says), "{set:?}: {text}");
    }
}

proptest! {
    #[test]
    fn no_scenario_makes_the_check_panic(scenario in scenario()) {
        let derived = scenario.derived();
        prop_assert!(derived.natural_frequency >= 0.0 && derived.rows <= MAX_ROWS);
        for warning in scenario.warnings() {
            prop_assert!(!warning.to_string().contains("NaN"), "{}", warning);
        }
    }
}
