//! Tests of the reader: every shipped scenario is valid, every mistake is located, and every text
//! that is written reads back.

use super::synonyms::suggestion;
use super::*;
use crate::advice::Warning;
use crate::model::{
    Drive, Friction, Harmonic, InitialNoise, OrnsteinUhlenbeck, Oscillator, Problem, Temperature,
};
use crate::scenario::arbitrary::scenario;
use crate::scenario::{Ensemble, MAX_PERIODS, MAX_ROWS, Time, Units};
use crate::scheme::{CorrectedVi, DEFAULT_TOLERANCE, DiscreteVi, EventDriven, Kind};
use crate::stats::Record;
use proptest::prelude::*;

const BASE: &str = include_str!("../../scenarios/rho025.toml");

fn base(overrides: &[&str]) -> Result<Scenario, ScenarioError> {
    let overrides: Vec<Override> = overrides
        .iter()
        .map(|text| Override::set(text))
        .collect::<Result<_, _>>()?;
    Scenario::parse("rho025.toml", BASE, &overrides)
}

fn diagnostic(result: Result<Scenario, ScenarioError>) -> Diagnostic {
    match result {
        Err(ScenarioError::Invalid(diagnostics)) if diagnostics.len() == 1 => {
            diagnostics[0].clone()
        }
        other => panic!("expected a diagnostic, got {other:?}"),
    }
}

#[test]
fn every_file_of_the_folder_is_shipped_and_sound() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut files: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    files.sort();
    let mut names = SHIPPED.map(|scenario| scenario.name.to_string());
    names.sort();
    assert_eq!(files, names);
    for shipped @ Shipped { name, text, .. } in SHIPPED {
        let scenario = shipped.parse(&[]).unwrap_or_else(|e| panic!("{name}: {e}"));
        let file = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        assert_eq!(
            Scenario::parse(&file, &scenario.to_toml(), &[]).unwrap(),
            scenario,
            "{name}"
        );
        assert!(
            text.starts_with("# ") && text.contains("Bensoussan"),
            "{name} says what it asks and where it is from"
        );
    }
}

#[test]
fn the_paper_scenes_hold_its_parameters() {
    for (name, w, rho) in [
        ("shaw", 0.25, 0.0),
        ("shaw-as-printed", 0.5, 0.0),
        ("rho025", 0.25, 0.25),
        ("rho025-as-printed", 0.5, 0.25),
    ] {
        let Scenario {
            model,
            time,
            scheme,
            ..
        } = Scenario::parse(name, shipped(name).unwrap().text, &[]).unwrap();
        let oscillator = Oscillator {
            mass: 1.0,
            stiffness: 1.0,
            damping: 0.0,
            drive: Drive::Dilatation(6.0),
        };
        let friction = Friction {
            static_force: 1.2,
            dynamic_force: 1.0,
        };
        let noise = OrnsteinUhlenbeck {
            intensity: rho,
            relaxation_rate: 1.0,
            diffusion: 1.0,
            initial: InitialNoise::At(0.0),
        };
        let harmonics = vec![Harmonic {
            amplitude: 1.0,
            angular_frequency: w,
            phase: 0.0,
        }];
        let noises = (rho != 0.0).then_some(noise).into_iter().collect();
        let temperature = Temperature {
            harmonics,
            noises,
            ..Temperature::default()
        };
        let [initial_displacement, initial_velocity] = [6.0, 0.0];
        let paper = Problem {
            oscillator,
            friction,
            temperature,
            force: None,
            random: Vec::new(),
            initial_displacement,
            initial_velocity,
        };
        assert_eq!(model, paper, "{name}");
        assert_eq!(
            (time.end, scheme.step(), time.output_step),
            (60.0, Some(0.01), 0.5),
            "{name}"
        );
    }
}

#[test]
fn defaults_are_those_of_the_documentation() {
    let minimal = "[oscillator]\nmass = 1\nstiffness = 1\ndilatation = 6\n[friction]\nstatic = 1.2\ndynamic = 1\n\
                   [temperature.noise]\nintensity = 0.25\n[initial]\ndisplacement = 6\n[time]\nend = 60\nstep = 0.01\n";
    let scenario = Scenario::parse("here/minimal.toml", minimal, &[]).unwrap();
    assert_eq!(scenario.title, "minimal");
    assert_eq!(scenario.model.oscillator.damping, 0.0);
    let noise = OrnsteinUhlenbeck {
        intensity: 0.25,
        relaxation_rate: 1.0,
        diffusion: 1.0,
        initial: InitialNoise::At(0.0),
    };
    assert_eq!(
        scenario.model.temperature,
        Temperature {
            noises: vec![noise],
            ..Temperature::default()
        }
    );
    assert_eq!(scenario.time.output_step, 0.5);
    assert_eq!(scenario.scheme, DiscreteVi { step: 0.01 }.into());
    assert_eq!(
        scenario.ensemble,
        Ensemble {
            paths: 10_000,
            seed: 1,
            antithetic: false
        }
    );
    assert_eq!(
        scenario.record,
        Record {
            paths: true,
            ..Record::NOTHING
        }
    );
    assert_eq!(scenario.units, Units::default());
}

#[test]
fn the_default_grid_has_about_120_rows_and_ends_at_the_end() {
    for (end, step) in [
        ("60", "0.01"),
        ("1", "0.001"),
        ("50", "0.01"),
        ("36", "0.1"),
        ("7", "0.01"),
        ("1e7", "1e-3"),
    ] {
        let text = BASE
            .replace("end = 60.0 ", &format!("end = {end} "))
            .replace("step = 0.01 ", &format!("step = {step} "));
        let text: String = text
            .lines()
            .filter(|line| !line.starts_with("output_step"))
            .fold(String::new(), |t, l| t + l + "\n");
        let scenario = Scenario::parse("x", &text, &[]).unwrap();
        let rows = scenario.timeline().rows();
        assert!((61..=241).contains(&rows), "{end} {step}: {rows}");
        let last = *scenario.timeline().output_times().last().unwrap();
        assert!(
            (last - scenario.time.end).abs() < 1e-9 * scenario.time.end,
            "{end} {step}: {last}"
        );
    }
}

#[test]
fn an_override_reaches_every_kind_of_key() {
    let scenario = base(&[
        "friction.static=1.3",
        "temperature.harmonics.0.amplitude=2",
        "temperature.harmonics.1={amplitude=0.5, angular_frequency=3}",
        "temperature.noise.initial=stationary",
        "title=a few words",
        "record.events=true",
        "ensemble.seed=18446744073709551615",
        "units.time=s",
    ])
    .unwrap();
    assert_eq!(scenario.model.friction.static_force, 1.3);
    assert_eq!(scenario.model.temperature.harmonics[0].amplitude, 2.0);
    assert_eq!(
        scenario.model.temperature.harmonics[1].angular_frequency,
        3.0
    );
    assert_eq!(
        scenario.model.temperature.noises[0].initial,
        InitialNoise::Stationary
    );
    assert_eq!(
        (scenario.title.as_str(), scenario.record.events),
        ("a few words", true)
    );
    assert_eq!(
        (scenario.ensemble.seed, scenario.units.time.as_str()),
        (u64::MAX, "s")
    );
}

#[test]
fn the_title_lists_what_overrides_change() {
    let title = |text: &str, set: &[&str]| {
        let set: Vec<Override> = set
            .iter()
            .map(|text| Override::set(text).unwrap())
            .collect();
        Scenario::parse("rho025", text, &set).unwrap()
    };
    let text = shipped("rho025").unwrap().text;
    let first = title(
        text,
        &[
            "friction.static=1.3",
            "ensemble.paths=10",
            "record.events=true",
        ],
    );
    assert_eq!(
        first.title,
        format!(
            "{} (changed: friction.static = 1.3)",
            title(text, &[]).title
        )
    );
    let read_again = first.to_toml();
    assert_eq!(title(&read_again, &[]), first);
    let second = title(&read_again, &["temperature.harmonics.0.amplitude=2"]).title;
    assert!(
        second
            .ends_with(" (changed: friction.static = 1.3, temperature.harmonics.0.amplitude = 2)"),
        "{second}"
    );
    assert_eq!(
        title(text, &["friction.static=1.3", "title=mine"]).title,
        "mine"
    );
    // Another file is another force; how it is read is not.
    let change = |text: String| Override::set(&text).unwrap().change_of_physics();
    for key in ["input.ag", "temperature.series"] {
        for layout in ["column=a", "value=a", "unit=g", "zone=UTC", "skip=1"] {
            assert_eq!(change(format!("{key}.{layout}")), None);
        }
        assert!(change(format!("{key}.file=a.csv")).is_some());
    }
}

/// A time may be a duration in a scenario in seconds, and only there.
#[test]
fn a_duration_is_a_time_if_the_unit_is_the_second() {
    let set = [
        "time.end=1min 1s",
        "statistics.after=500ms",
        "time.step=10ms",
    ];
    let in_seconds = [&["units.time=s"], &set[..]].concat();
    let scenario = base(&in_seconds).unwrap();
    let times = (scenario.time.end, scenario.statistics.after);
    assert_eq!((times, scenario.scheme.step()), ((61.0, 0.5), Some(0.01)));
    for (unit, key) in [
        ("units.time=h", "time.end=1h"),
        ("units.time=s", "oscillator.mass=1h"),
    ] {
        let diagnostic = diagnostic(base(&[unit, key]));
        assert!(diagnostic.problem.contains("is a string"), "{diagnostic}");
        let is_time = diagnostic
            .remedy
            .contains("if `units.time` = \"s\", a duration");
        assert_eq!(is_time, key.starts_with("time"), "{diagnostic}");
    }
}

#[test]
fn the_last_override_wins() {
    assert_eq!(
        base(&["time.end=30", "time.end=40"]).unwrap().time.end,
        40.0
    );
}

#[test]
fn a_fault_names_line_column_key_and_value() {
    let text = BASE.replace("mass = 1.0", "mass = -1.5");
    let line = text
        .lines()
        .position(|line| line.starts_with("mass"))
        .unwrap()
        + 1;
    let diagnostic = diagnostic(Scenario::parse("rho025.toml", &text, &[]));
    assert_eq!((diagnostic.line, diagnostic.column), (Some(line), Some(8)));
    assert_eq!(
        (diagnostic.key.as_deref(), diagnostic.value.as_deref()),
        (Some("oscillator.mass"), Some("-1.5"))
    );
    let message = diagnostic.to_string();
    assert!(
        message.starts_with(&format!(
            "rho025.toml:{line}:8: `oscillator.mass` = -1.5 is out of range"
        )),
        "{message}"
    );
    assert!(
        message.contains("mass = -1.5 ") && message.contains("^^^^\n") && message.contains("fix: "),
        "{message}"
    );
}

#[test]
fn a_fault_in_an_override_names_the_override() {
    let diagnostic = diagnostic(base(&["oscillator.mass=-1"]));
    assert_eq!(diagnostic.origin, "oscillator.mass=-1");
    assert_eq!(
        (diagnostic.line, diagnostic.value.as_deref()),
        (None, Some("-1"))
    );
    let step = [Override::flag("--step", "time.step", "0.007")];
    let text = Scenario::parse("x", BASE, &step).unwrap_err().to_string();
    assert!(text.starts_with("--step 0.007: "), "{text}");
    assert!(
        text.contains("the nearest ends are 59.997 or 60.004"),
        "{text}"
    );
}

#[test]
fn the_nearest_values_of_a_message_are_accepted() {
    for (end, step) in [
        (60.0, 0.007),
        (1.0, 0.3),
        (0.005, 0.01),
        (1e6, 0.9),
        (1.0, 3.0),
    ] {
        let diagnostic = diagnostic(base(&[
            &format!("time.end={end}"),
            &format!("time.step={step}"),
        ]));
        let (steps, ends) = diagnostic.remedy.split_once("; ").unwrap();
        let values = |part: &str| {
            let list = part.rsplit_once(" are ").unwrap().1;
            list.split(" or ")
                .map(|value| value.parse::<f64>().unwrap())
                .collect::<Vec<_>>()
        };
        let sound = |end: f64, step: f64| {
            let set = [
                format!("time.end={end:?}"),
                format!("time.step={step:?}"),
                format!("time.output_step={step:?}"),
            ];
            match base(&set.each_ref().map(String::as_str)) {
                Ok(_) => true,
                // A fine step may make too many rows of the output grid, which is not tested here.
                Err(e) => e.to_string().contains("rows"),
            }
        };
        assert!(
            values(steps).iter().all(|step| sound(end, *step)),
            "{diagnostic}"
        );
        assert!(
            values(ends).iter().all(|end| sound(*end, step)),
            "{diagnostic}"
        );
    }
}

#[test]
fn unknown_keys_come_with_the_key_that_was_meant() {
    for (table, wrong, meant) in [
        ("temperature.harmonics", "frequncy", "angular_frequency"),
        ("temperature.harmonics", "omega", "angular_frequency"),
        ("oscillator", "stifness", "stiffness"),
        ("oscillator", "alpha", "damping"),
        ("oscillator", "static", "friction.static"),
        ("friction", "f_s", "static"),
        ("friction", "mass", "oscillator.mass"),
        ("", "fricton", "friction"),
        ("", "rho", "temperature.noise.intensity"),
        ("time", "dt", "step"),
        ("input", "dt", "step"),
        ("input", "path", "file"),
        ("input", "scale", "force.expression"),
        ("temperature.harmonics", "period", "angular_frequency"),
        ("statistics", "perod", "period"),
        ("", "period", "statistics.period"),
        ("time", "outputstep", "output_step"),
        ("record", "trajectory", "trajectories"),
        ("units", "lenght", "length"),
    ] {
        assert_eq!(
            suggestion(table, wrong).map(|(key, _)| key).as_deref(),
            Some(meant),
            "{table}.{wrong}"
        );
    }
    assert_eq!(suggestion("time", "zzz"), None);
}

/// The errors of a text with several mistakes, each as `line key`.
fn diagnostics(text: &str, overrides: &[&str]) -> Vec<String> {
    let overrides: Vec<Override> = overrides
        .iter()
        .map(|text| Override::set(text).unwrap())
        .collect();
    let Err(ScenarioError::Invalid(diagnostics)) = Scenario::parse("x", text, &overrides) else {
        panic!("is refused")
    };
    let shown = |diagnostic: &Diagnostic| {
        let key = diagnostic.key.clone().unwrap_or_else(|| {
            diagnostic
                .problem
                .split('`')
                .nth(1)
                .unwrap_or_default()
                .to_string()
        });
        format!(
            "{} {key}",
            diagnostic
                .line
                .map_or("-".to_string(), |line| line.to_string())
        )
    };
    diagnostics.iter().map(shown).collect()
}

#[test]
fn all_mistakes_are_told_at_once_in_the_order_of_the_file() {
    let text = BASE
        .replace("[initial]", "[intial]")
        .replace("[friction]", "[fricton]");
    let line = |of: &str| 1 + text.lines().position(|line| line.starts_with(of)).unwrap();
    let expected = [
        format!("{} fricton", line("[fricton]")),
        format!("{} intial", line("[intial]")),
    ];
    assert_eq!(
        diagnostics(&text, &[]),
        expected,
        "a misspelt table is no missing key as well"
    );

    let mut text = BASE.to_string();
    for (right, wrong) in [
        ("mass = 1.0", "mass = -1.0"),
        ("dilatation = 6.0", "dilation = 6.0"),
        ("static = 1.2", "static = \"strong\""),
        ("dynamic = 1.0", "# dynamic"),
        ("amplitude = 1.0", "amplitude = nan"),
        ("initial = 0.0", "initial = \"stationery\""),
        ("end = 60.0", "end = -1"),
        ("paths = 10000", "paths = 0"),
        ("seed = 1", "seed = 1\nantithetic = 2"),
    ] {
        assert!(text.contains(right), "{right}");
        text = text.replace(right, wrong);
    }
    let keys: Vec<String> = diagnostics(&text, &["record.events=perhaps", "scheme.kind=exact"]);
    let keys: Vec<&str> = keys
        .iter()
        .map(|shown| shown.split_once(' ').unwrap().1)
        .collect();
    let expected = [
        "oscillator.mass",
        "dilation",
        "friction.dynamic",
        "friction.static",
        "temperature.harmonics.0.amplitude",
        "temperature.noise.initial",
        "time.end",
        "ensemble.paths",
        "ensemble.antithetic",
        "scheme.kind",
        "record.events",
    ];
    assert_eq!(keys, expected);
}

#[test]
fn all_values_that_do_not_go_together_are_told_at_once() {
    let text = BASE
        .replace("dynamic = 1.0", "dynamic = 2.0")
        .replace("paths = 10000", "paths = 11\nantithetic = true");
    let text = text.replace("step = 0.01 ", "step = 0.007 ");
    let keys: Vec<String> = diagnostics(&text, &["statistics.after=100"]);
    let keys: Vec<&str> = keys
        .iter()
        .map(|shown| shown.split_once(' ').unwrap().1)
        .collect();
    assert_eq!(
        keys,
        [
            "friction.dynamic",
            "time.step",
            "ensemble.paths",
            "statistics.after"
        ]
    );
    // Whether f_d <= f_s holds is not checked if f_s is not a number.
    let text = text.replace("static = 1.2", "static = true");
    assert_eq!(diagnostics(&text, &["statistics.after=100"]).len(), 1);
}

#[test]
fn counts_are_read_as_people_write_them() {
    let paths = |text: &str| {
        base(&[&format!("ensemble.paths={text}")]).map(|scenario| scenario.ensemble.paths)
    };
    for (text, count) in [
        ("1e5", 100_000),
        ("1_000_000", 1_000_000),
        ("10k", 10_000),
        ("2.5M", 2_500_000),
        ("1G", 1_000_000_000),
    ] {
        assert_eq!(paths(text).ok(), Some(count), "{text}");
        let file = BASE.replace("paths = 10000", &format!("paths = \"{text}\""));
        assert_eq!(
            Scenario::parse("x", &file, &[])
                .map(|scenario| scenario.ensemble.paths)
                .ok(),
            Some(count),
            "{text}"
        );
    }
    for text in ["1.5", "10m", "k", "1e-3", "0.0001k", "-1k", "1e300"] {
        assert!(paths(text).is_err(), "{text}");
    }
}

/// Following the remedy for an amplitude outside of a harmonic gives a valid scenario.
#[test]
fn the_remedy_for_a_harmonic_in_the_wrong_place_works() {
    let text = BASE.replace(
        "harmonics = [{ amplitude = 1.0, angular_frequency = 0.25 }]",
        "amplitude = 1.0",
    );
    let Err(ScenarioError::Invalid(diagnostics)) = Scenario::parse("x", &text, &[]) else {
        panic!("is refused")
    };
    let remedy = diagnostics[0]
        .remedy
        .split('`')
        .nth(1)
        .expect("something to write");
    assert_eq!(
        Scenario::parse("x", &text.replace("amplitude = 1.0", remedy), &[])
            .map(|s| s.model)
            .ok(),
        base(&[]).map(|s| s.model).ok()
    );
}

#[test]
fn numbers_that_are_not_finite_are_refused_everywhere() {
    for key in [
        "oscillator.mass",
        "oscillator.stiffness",
        "oscillator.damping",
        "oscillator.dilatation",
        "friction.static",
        "friction.dynamic",
        "temperature.harmonics.0.amplitude",
        "temperature.harmonics.0.angular_frequency",
        "temperature.harmonics.0.phase",
        "temperature.noise.intensity",
        "temperature.noise.relaxation_rate",
        "temperature.noise.diffusion",
        "temperature.noise.initial",
        "initial.displacement",
        "time.end",
        "time.step",
        "time.output_step",
    ] {
        let values = ["nan", "-nan", "inf", "-inf", "1e999"];
        // A body that never slides has an infinite threshold.
        for value in values
            .into_iter()
            .filter(|value| (key, *value) != ("friction.static", "inf"))
        {
            let diagnostic = diagnostic(base(&[&format!("{key}={value}")]));
            assert_eq!(
                diagnostic.key.as_deref(),
                Some(key),
                "{key}={value}: {diagnostic}"
            );
            assert!(
                diagnostic.problem.starts_with("is not "),
                "{key}={value}: {diagnostic}"
            );
        }
    }
}

#[test]
fn values_beyond_double_precision_are_refused() {
    for (set, reason) in [
        (
            &["oscillator.mass=1e-300", "oscillator.stiffness=1e90"][..],
            "K/m = inf",
        ),
        (
            &["oscillator.mass=1e90", "oscillator.stiffness=1e-300"],
            "K/m = 0e0",
        ),
        (&["oscillator.dilatation=1e308"], "must not exceed 1e100"),
        (&["oscillator.dilatation=5e99"], "reach 4"),
        (
            &["oscillator.mass=1e-10", "oscillator.damping=1e95"],
            "alpha/m",
        ),
        (
            &[
                "temperature.noise.relaxation_rate=1e-320",
                "temperature.noise.diffusion=1e90",
            ],
            "sigma / sqrt(2 theta)",
        ),
        (
            &["friction.static=1e-310", "friction.dynamic=0"],
            "threshold",
        ),
        (
            &[
                "temperature.noise.diffusion=1e-300",
                "temperature.noise.initial=1",
            ],
            "too little to resolve",
        ),
        (
            &["temperature.noise.diffusion=1e-307"],
            "too little to resolve",
        ),
        (
            &[
                "scheme.kind=event-driven",
                "friction.static=1e-150",
                "friction.dynamic=0",
            ],
            "is negligible compared with the noise",
        ),
        (
            &[
                "scheme.kind=quasi-static",
                "friction.static=1e-300",
                "friction.dynamic=0",
            ],
            "is negligible compared with the noise",
        ),
        (&["time.end=1e18"], "2^53"),
        (&["time.step=1e-320"], "2^53"),
        (&["time.output_step=0.01", "time.end=1000"], "100001 rows"),
        (&["ensemble.paths=0"], "from 1 to"),
        (&["ensemble.paths=1099511627777"], "from 1 to"),
        (&["ensemble.seed=18446744073709551616"], "from 0 to"),
        (
            &["ensemble.paths=99999999999999999999999999999999999999999"],
            "from 1 to",
        ),
        (&["ensemble.paths=0xffffffffffffffffffff"], "from 1 to"),
    ] {
        let diagnostic = diagnostic(base(set));
        assert!(diagnostic.problem.contains(reason), "{set:?}: {diagnostic}");
    }
}

/// Nobody wrote the stiffness and the damping that a linear force leaves.
#[test]
fn a_force_that_cannot_be_used_is_named() {
    let quasi_static = "scheme.kind=quasi-static";
    for (set, problem) in [
        (
            &["force.expression=-1e300*x^3"][..],
            "\"-1e300*x^3\" has the size 2.16e302 at x = 6.0 (x0)",
        ),
        (
            &["force.expression=1/(t-30)"],
            "\"1/(t-30)\" is infinite at x = 6.0 (x0), xdot = 0, t = 30.0",
        ),
        (
            &[quasi_static, "force.expression=0.2*xdot"],
            "\"0.2*xdot\" is linear, and makes the damping alpha -0.1",
        ),
        (
            &[quasi_static, "force.expression=1*x"],
            "\"1*x\" is linear, and makes the stiffness K 0.0",
        ),
    ] {
        let diagnostic = diagnostic(base(set));
        assert_eq!(
            diagnostic.key.as_deref(),
            Some("force.expression"),
            "{set:?}: {diagnostic}"
        );
        assert!(
            diagnostic
                .problem
                .starts_with(&format!("`force.expression` = {problem}")),
            "{set:?}: {diagnostic}"
        );
    }
    let number = format!("{BASE}\n[force]\nexpression = 3");
    assert!(
        diagnostic(Scenario::parse("a", &number, &[]))
            .problem
            .contains("must be a string")
    );
    let text = format!("{BASE}\n[force]\nexpression = 'k*x'\n[parameters]\nk = 1");
    let diagnostic = diagnostic(Scenario::parse(
        "a",
        &text,
        &[Override::set("force.expression=-x^3").unwrap()],
    ));
    assert!(
        diagnostic.remedy.contains("all with `parameters = {}`"),
        "{diagnostic}"
    );
}

#[test]
fn faults_of_a_force_are_marked_where_they_are() {
    let marked = |force: &str| {
        let diagnostic = diagnostic(Scenario::parse("a", &format!("{BASE}\n{force}"), &[]));
        let excerpt = diagnostic.excerpt.unwrap_or_default();
        let text = |line: &str| {
            line.split_once('|')
                .map_or("", |(_, text)| text)
                .to_string()
        };
        excerpt.lines().skip(1).map(text).collect::<Vec<_>>()
    };
    let of = |expression: &str| marked(&format!("[force]\nexpression = {expression}"));
    assert_eq!(
        of("\"\"\"\n-x^3\n\t- 2*vel\n\"\"\""),
        [" \t- 2*vel", " \t    ^^^"]
    );
    assert_eq!(of("'''-x^3\n  - 2*vel'''"), ["   - 2*vel'''", "       ^^^"]);
    assert_eq!(of("\"\""), [" expression = \"\"", "              ^^"]);
    let parameters = "[force]\nexpression = '-x^3'\n[parameters]\nk = 1\n'k-3' = 2";
    assert_eq!(marked(parameters), [" 'k-3' = 2", " ^^^^^"]);
    let lines = format!("{BASE}\n[force]\nexpression = '''\n-x^3\n\t- 0.1*xdot\n'''\n");
    let scenario = Scenario::parse("a", &lines, &[]).unwrap();
    let force = scenario
        .model
        .force
        .as_ref()
        .and_then(|force| force.expression())
        .unwrap();
    assert_eq!(force.text(), "-x^3  - 0.1*xdot");
    assert_eq!(
        Scenario::parse("a", &scenario.to_toml(), &[]).unwrap(),
        scenario
    );
}

/// The same values are rejected in memory as in a file, since the checks do not depend on files.
#[test]
fn data_are_refused_for_the_same_reasons_as_a_file() {
    type Change = fn(&mut Scenario);
    fn slow_and_endless(s: &mut Scenario) {
        s.scheme = Kind::EventDriven.with(1e-3);
        s.model.temperature.harmonics[0].angular_frequency = 1e-90;
        s.time.end = 1e101;
    }
    let changes: [(Change, &str, &str); 8] = [
        (
            |s| s.model.friction.dynamic_force = 2.0,
            "friction.dynamic",
            "must not exceed `friction.static`",
        ),
        (
            |s| s.model.oscillator.mass = 1e-310,
            "oscillator.stiffness",
            "K/m = inf",
        ),
        (
            |s| s.model.oscillator.damping = 1e101,
            "oscillator.damping",
            "alpha/m",
        ),
        (
            |s| s.model.oscillator.drive = Drive::Dilatation(5e99),
            "oscillator.dilatation",
            "reach 4",
        ),
        (|s| s.time.end = 1e101, "time.step", "2^53"),
        (slow_and_endless, "time.end", "lets |x| grow"),
        (
            |s| s.time.output_step = 0.007,
            "time.output_step",
            "is not a whole number of steps",
        ),
        (
            |s| {
                s.time = Time {
                    end: 1000.0,
                    output_step: 0.01,
                }
            },
            "time.output_step",
            "100001 rows",
        ),
    ];
    let sound = base(&[]).unwrap();
    assert_eq!(sound.check(), Ok(()));
    for (change, key, reason) in changes {
        let mut changed = sound.clone();
        change(&mut changed);
        let check_error = changed.check().unwrap_err();
        assert!(
            check_error.about[0].0 == key && check_error.problem.contains(reason),
            "{check_error}"
        );
    }
}

#[test]
fn extremes_that_can_be_computed_with_are_accepted() {
    for set in [
        &["time.end=0"][..],
        &["time.end=0.01", "ensemble.paths=1"],
        &["time.end=-0.0"],
        &["friction.static=0", "friction.dynamic=0"],
        &["friction.static=1e300"],
        &[
            "scheme.kind=event-driven",
            "friction.static=0",
            "friction.dynamic=0",
        ],
        &[
            "scheme.kind=event-driven",
            "friction.static=1e-90",
            "friction.dynamic=0",
        ],
        &[
            "scheme.kind=event-driven",
            "friction.static=1e-300",
            "friction.dynamic=0",
            "temperature.noise.intensity=0",
        ],
        &["scheme.kind=event-driven", "friction.static=1e300"],
        &["oscillator.stiffness=1e9"],
        &["oscillator.dilatation=0"],
        &["temperature.noise.relaxation_rate=1e6"],
        &["temperature.noise.intensity=1e6"],
        &["temperature.harmonics=[]"],
        &["time.step=1e-9", "time.end=1e6", "time.output_step=1000"],
        &["ensemble.paths=1099511627776"],
    ] {
        let scenario = base(set).unwrap_or_else(|e| panic!("{set:?}: {e}"));
        assert!(scenario.time.end.is_sign_positive());
        // The calls below must not panic for any scenario.
        assert!(
            scenario.timeline().rows() <= MAX_ROWS && scenario.timeline().periods() <= MAX_PERIODS
        );
        for warning in scenario.warnings() {
            assert!(!warning.to_string().contains("NaN"), "{warning}");
        }
    }
}

#[test]
fn a_noise_that_is_always_zero_moves_nothing_and_is_kept() {
    let plain = BASE[..BASE.find("[temperature.noise]").unwrap()].to_string()
        + &BASE[BASE.find("[initial]").unwrap()..];
    let without = Scenario::parse("x", &plain, &[]).unwrap();
    assert_eq!(without.model.temperature.noises, []);
    let kept = [
        "temperature.noise.relaxation_rate=3.5",
        "temperature.noise.diffusion=0.75",
    ];
    for set in [
        &[
            "temperature.noise.intensity=0",
            kept[0],
            kept[1],
            "temperature.noise.initial=2",
        ][..],
        &["temperature.noise.diffusion=0", kept[0]],
        &[
            "temperature.noise.diffusion=0",
            "temperature.noise.initial=stationary",
        ],
    ] {
        let scenario = base(set).unwrap();
        let temperature = &scenario.model.temperature;
        assert!(
            !temperature.noises.is_empty() && temperature.effective_noise().is_none(),
            "{set:?}"
        );
        let text = scenario.to_toml();
        assert_eq!(
            Scenario::parse("x", &text, &[]).unwrap(),
            scenario,
            "{text}"
        );
        assert!(text.contains("[temperature.noise]\n"), "{text}");
        // The paths and the warnings are those of the scenario without the table.
        let totals = |scenario: &Scenario| {
            scenario
                .plan()
                .block(0)
                .totals
                .summary()
                .estimates
                .map(|e| e.estimate)
        };
        assert_eq!(
            totals(&scenario).map(f64::to_bits),
            totals(&without).map(f64::to_bits),
            "{set:?}"
        );
        assert_eq!(scenario.derived(), without.derived(), "{set:?}");
        assert_eq!(scenario.warnings(), without.warnings(), "{set:?}");
    }
    let kept = base(&["temperature.noise.intensity=0", kept[0], kept[1]])
        .unwrap()
        .to_toml();
    for line in [
        "intensity = 0.0 ",
        "relaxation_rate = 3.5 ",
        "diffusion = 0.75 ",
    ] {
        assert!(kept.contains(line), "{kept}");
    }
    let decaying = base(&[
        "temperature.noise.diffusion=0",
        "temperature.noise.initial=2",
    ])
    .unwrap();
    assert_eq!(
        decaying
            .model
            .temperature
            .effective_noise()
            .unwrap()
            .initial,
        InitialNoise::At(2.0)
    );
}

#[test]
fn a_file_that_is_no_scenario_is_refused_with_a_way_on() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    for (path, says) in [
        (folder.path().join("absent.toml"), "no such file"),
        (folder.path().join("shaw.toml"), "`shaw`, which is shipped"),
        (folder.path().to_path_buf(), "directory"),
        (write("result.h5", b"\x89HDF\r\n\x1a\n123"), "an HDF5 file"),
        (
            write("latin1.toml", b"title = 'a'\n# caf\xe9\n"),
            "line 2 is not UTF-8",
        ),
        (write("large.toml", &vec![b'#'; (1 << 20) + 1]), "1 MiB"),
    ] {
        let message = Scenario::read(&path, &[]).unwrap_err().to_string();
        assert!(
            message.contains(says) && message.contains("fix: "),
            "{message}"
        );
    }
}

#[test]
fn the_name_of_a_shipped_scenario_stands_for_its_file() {
    let named = |name: &str| {
        Scenario::read(
            Path::new(name),
            &[Override::set("ensemble.seed=7").unwrap()],
        )
    };
    let parsed = shipped("bridge")
        .unwrap()
        .parse(&[Override::set("ensemble.seed=7").unwrap()])
        .unwrap();
    assert_eq!(named("bridge").unwrap(), parsed);
    for (name, says) in [
        ("rho25", "`rho025`, which is shipped"),
        ("nowhere/rho025", "`rho025`, which is shipped"),
        ("xyz", "give the path of a scenario, a TOML file"),
    ] {
        let message = named(name).unwrap_err().to_string();
        assert!(message.contains(says), "{message}");
    }
}

#[test]
fn the_caret_stands_under_the_value() {
    let text = "# \u{e9}\r\n[oscillator]\r\n\tmass = \"\u{e9}\u{e9}\"\r\n";
    let Err(ScenarioError::Invalid(diagnostics)) = Scenario::parse("x", text, &[]) else {
        panic!("is refused")
    };
    let diagnostic = diagnostics
        .into_iter()
        .find(|diagnostic| diagnostic.key.is_some())
        .expect("the mass");
    assert_eq!((diagnostic.line, diagnostic.column), (Some(3), Some(9)));
    assert_eq!(
        diagnostic.excerpt.unwrap(),
        "  |\n3 | \tmass = \"\u{e9}\u{e9}\"\n  | \t       ^^^^"
    );
}

#[test]
fn a_burn_in_is_zero_or_ends_before_the_run() {
    let with = |set: &str| {
        Scenario::parse(
            "x",
            shipped("rho025").unwrap().text,
            &[Override::set(set).unwrap()],
        )
    };
    assert_eq!(Scenario::shipped("rho025").unwrap().statistics.after, 0.0);
    let later = with("statistics.after=25.5").unwrap();
    assert_eq!(
        (later.statistics.after, later.timeline().after),
        (25.5, 25.5)
    );
    assert_eq!(
        Scenario::parse("again", &later.to_toml(), &[]).unwrap(),
        later
    );
    assert_eq!(
        with("statistics.after=-0.0")
            .unwrap()
            .statistics
            .after
            .to_bits(),
        0
    );
    for (set, says) in [
        (
            "statistics.after=60",
            "`statistics.after` = 60.0 leaves nothing to count before `time.end` = 60.0",
        ),
        ("statistics.after=-1", "0 or above"),
        ("statistics.after=inf", "is not finite"),
        ("statistics.after=nan", "is not a number"),
        ("statistics.until=1", "`statistics` takes after"),
        ("burn_in=1", "did you mean `statistics.after`?"),
    ] {
        let message = with(set).unwrap_err().to_string();
        assert!(
            message.contains(says) && message.contains("fix: "),
            "{set}: {message}"
        );
    }
    // A run of duration 0 may have a burn-in of 0.
    let none = [
        Override::set("time.end=0").unwrap(),
        Override::set("statistics.after=0").unwrap(),
    ];
    assert!(Scenario::parse("x", shipped("rho025").unwrap().text, &none).is_ok());
}

#[test]
fn every_scheme_is_chosen_by_name() {
    for name in [
        "discrete-vi",
        "corrected-vi",
        "event-driven",
        "quasi-static",
    ] {
        assert!(
            Kind::from_name(name).is_some_and(|kind| kind.name() == name),
            "{name}"
        );
    }
    for &kind in Kind::ALL {
        let scenario = base(&[&format!("scheme.kind={}", kind.name())]).unwrap();
        assert_eq!(
            scenario.scheme,
            kind.with(if kind.has_step() {
                0.01
            } else {
                DEFAULT_TOLERANCE
            })
        );
        assert_eq!(
            scenario.scheme.step().is_some(),
            kind.has_step(),
            "a step in the file is not used"
        );
        assert_eq!(scenario.scheme.step().map(|_| 6000), scenario.steps());
        assert_eq!(scenario.scheme.tolerance().is_none(), kind.has_step());
    }
    let set = ["scheme.kind=event-driven", "scheme.tolerance=1e-4"];
    assert_eq!(
        base(&set).unwrap().scheme,
        EventDriven { tolerance: 1e-4 }.into()
    );
    assert_eq!(DEFAULT_TOLERANCE, 1e-3, "as in docs/event-driven.md");
}

/// Changing the scheme in memory and on the command line gives the same error in the same words, or
/// else the same scenario.
#[test]
fn another_scheme_is_refused_as_the_reader_refuses_it() {
    let mut refused = 0;
    for set in [
        &["scheme.kind=discrete-vi"][..],
        &[
            "scheme.kind=discrete-vi",
            "friction.static=1e-150",
            "friction.dynamic=0",
        ],
        &[
            "scheme.kind=event-driven",
            "friction.static=0",
            "friction.dynamic=0",
        ],
        &[
            "scheme.kind=event-driven",
            "temperature.noise.diffusion=1e-307",
        ],
        &[
            "scheme.kind=event-driven",
            "temperature.noise.diffusion=1e-300",
            "temperature.noise.initial=1",
        ],
        &[
            "scheme.kind=event-driven",
            "temperature.noise.intensity=0",
            "friction.static=1e-310",
            "friction.dynamic=0",
        ],
        &["scheme.kind=quasi-static", "time.output_step=0.7"],
        &[
            "scheme.kind=quasi-static",
            "time.end=59.995",
            "time.output_step=59.995",
        ],
    ] {
        let scenario = base(set).unwrap();
        for &kind in Kind::ALL {
            let (flag, key, parameters) = match kind.has_step() {
                true => ("--step", "time.step", [0.01, 0.007, 1.0, 1e-15]),
                false => ("--tolerance", "scheme.tolerance", [1e-2, 1e-3, 1e-4, 1e-5]),
            };
            for parameter in parameters {
                let flags = [
                    Override::flag("--scheme", "scheme.kind", kind.name()),
                    Override::flag(flag, key, &format!("{parameter:?}")),
                ];
                let read = Scenario::parse(&scenario.title, &scenario.to_toml(), &flags);
                match (read, scenario.with_scheme(kind.with(parameter))) {
                    (Ok(read), Ok(changed)) => assert_eq!(read, changed),
                    (Err(refusal @ ScenarioError::Invalid(_)), Err(check_error)) => {
                        let words = refusal.to_string();
                        assert!(
                            words.contains(&check_error.sentence())
                                && words.contains(&check_error.remedy),
                            "{words} {check_error}"
                        );
                        refused += 1;
                    }
                    (read, changed) => panic!("{set:?} {kind:?} {parameter}: {read:?} {changed:?}"),
                }
            }
        }
    }
    assert!(refused > 30, "{refused}");
}

#[test]
fn a_scheme_takes_only_what_it_has_a_use_for() {
    for (set, key, says) in [
        (
            &["scheme.kind=event-drivn"][..],
            "scheme.kind",
            "did you mean \"event-driven\"?",
        ),
        (
            &["scheme.kind=corrected"],
            "scheme.kind",
            "did you mean \"corrected-vi\"?",
        ),
        (
            &["scheme.tolerance=1e-3"],
            "scheme.tolerance",
            "discrete-vi",
        ),
        (
            &["scheme.kind=corrected-vi", "scheme.tolerance=1e-3"],
            "scheme.tolerance",
            "corrected-vi",
        ),
        (
            &["scheme.kind=event-driven", "scheme.tolerance=0"],
            "scheme.tolerance",
            "from 1e-9 to 0.1",
        ),
        (
            &["scheme.kind=quasi-static", "scheme.tolerance=0.2"],
            "scheme.tolerance",
            "from 1e-9 to 0.1",
        ),
        (
            &["scheme.kind=quasi-static", "scheme.tolerance=nan"],
            "scheme.tolerance",
            "not a number",
        ),
        (
            &["scheme.kind=event-driven", "time.step=0.01"],
            "time.step",
            "has no time step",
        ),
        (
            &["scheme.kind=event-driven", "time.step=nan"],
            "time.step",
            "not a number",
        ),
        (
            &["scheme.kind=event-driven", "time.output_step=0.0001"],
            "time.output_step",
            "600001 rows",
        ),
    ] {
        let diagnostic = diagnostic(base(set));
        assert_eq!(
            diagnostic.key.as_deref(),
            Some(key),
            "{set:?}: {diagnostic}"
        );
        assert!(diagnostic.problem.contains(says), "{set:?}: {diagnostic}");
    }
    // The settings in the file for its own scheme are ignored if the command line chooses another
    // scheme.
    let text = base(&["scheme.kind=event-driven"]).unwrap().to_toml();
    let set = |kind: &str| {
        [
            Override::flag("--scheme", "scheme.kind", kind),
            Override::flag("--step", "time.step", "0.01"),
        ]
    };
    assert_eq!(
        Scenario::parse("x", &text, &set("corrected-vi"))
            .unwrap()
            .scheme,
        CorrectedVi { step: 0.01 }.into()
    );
}

#[test]
fn a_grid_without_steps_needs_no_whole_multiples() {
    let stepless = |set: &[&str]| {
        base(&[&["scheme.kind=event-driven"], set].concat()).map(|scenario| scenario.time)
    };
    let time = stepless(&["time.end=59.995", "time.output_step=0.7"]).unwrap();
    assert_eq!(
        time,
        Time {
            end: 59.995,
            output_step: 0.7
        }
    );
    let text: String = BASE
        .lines()
        .filter(|line| !line.starts_with("output_step"))
        .fold(String::new(), |t, l| t + l + "\n");
    for (end, spacing) in [
        ("60", 0.5),
        ("59.995", 59.995 / 120.0),
        ("0", 1.0),
        ("5e-324", 1.0),
    ] {
        let set = [
            Override::set("scheme.kind=quasi-static").unwrap(),
            Override::flag("--until", "time.end", end),
        ];
        let scenario = Scenario::parse("x", &text, &set).unwrap();
        assert_eq!(scenario.time.output_step, spacing, "{end}");
        assert!(scenario.timeline().rows() <= 121);
    }
}

#[test]
fn the_corrected_scheme_is_refused_where_its_shift_is_not_small() {
    // The shift is 0.5826 * 6 * 0.25 sqrt(h). It is f_s/2 = 0.6 at h = 0.4714 and f_s/5 = 0.24 at h
    // = 0.0754.
    let corrected = |step: &str| base(&["scheme.kind=corrected-vi", step, "time.output_step=60"]);
    for step in ["time.step=0.48", "time.step=1"] {
        let diagnostic = diagnostic(corrected(step));
        assert_eq!(diagnostic.key.as_deref(), Some("time.step"));
        for part in ["shift", "f_s", "friction.static", "`time.step` below 0.471"] {
            assert!(
                diagnostic.to_string().contains(part),
                "{part}: {diagnostic}"
            );
        }
    }
    let names = |step| {
        corrected(step)
            .unwrap()
            .warnings()
            .iter()
            .map(Warning::name)
            .collect::<Vec<_>>()
    };
    assert!(names("time.step=0.08").contains(&"large-shift"));
    assert!(!names("time.step=0.075").contains(&"large-shift"));
    // The shift is f_s - f_d = 0.2 at h = 0.05237.
    assert!(names("time.step=0.06").contains(&"incomplete-correction"));
    assert!(!names("time.step=0.05").contains(&"incomplete-correction"));
    let frictionless = diagnostic(base(&[
        "scheme.kind=corrected-vi",
        "friction.static=0",
        "friction.dynamic=0",
    ]));
    assert!(
        frictionless.remedy.contains("discrete-vi"),
        "{frictionless}"
    );
    let quiet = [
        "scheme.kind=corrected-vi",
        "friction.static=0",
        "friction.dynamic=0",
        "temperature.noise.intensity=0",
    ];
    assert!(base(&quiet).is_ok());
}

proptest! {
    #[test]
    fn a_resolved_scenario_reads_back_as_itself(scenario in scenario()) {
        let text = scenario.to_toml();
        let again = Scenario::parse("again", &text, &[]);
        prop_assert!(again.is_ok(), "{}\n{text}", again.unwrap_err());
        prop_assert_eq!(again.unwrap(), scenario);
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in "[\\[\\]{}=.,\"'#a-z0-9 \n-]{0,80}", set in "[a-z0-9.={}\\[\\]-]{0,20}") {
        let overrides: Vec<Override> = Override::set(&set).into_iter().collect();
        if let Err(e) = Scenario::parse("x", &text, &overrides) {
            prop_assert!(e.to_string().contains("fix: "));
        }
        if let Err(e) = Scenario::parse("x", BASE, &overrides) {
            prop_assert!(e.to_string().contains("fix: "));
        }
    }
}

#[test]
fn a_parameter_is_a_key_and_a_number_may_begin_with_a_point() {
    let text = shipped("duffing").unwrap().text;
    let with = |sets: &[&str]| {
        let sets: Vec<Override> = sets.iter().map(|set| Override::set(set).unwrap()).collect();
        Scenario::parse("x", text, &sets).unwrap()
    };
    let [short, long] = [with(&["k3=.5"]), with(&["parameters.k3=0.5"])];
    assert_eq!(
        Scenario {
            title: long.title.clone(),
            ..short.clone()
        },
        long
    );
    assert!(
        short.title.ends_with(" (changed: k3 = .5)"),
        "{}",
        short.title
    );
    assert_eq!(with(&["k3=-.5"]).number_at("k3"), Some(-0.5));
    assert!(Scenario::parse("x", text, &[Override::set("nothing=.5").unwrap()]).is_err());
}

/// The memory 1/theta of a noise in place of white noise is the tolerance as a share of the
/// shortest memory of the body: here c^2 D/f_d^2 = 2.25, sqrt(m/K) = 2, and m/(2 alpha) = 1.
#[test]
fn white_noise_is_as_fast_as_the_tolerance_asks() {
    let body = "initial.displacement = 0\ntime = { end = 60, step = 0.01 }\nfriction = { static = 1, dynamic = 1 }\n\
                oscillator = { mass = 4, stiffness = 1, damping = 2, force_per_temperature = 3 }\n";
    let read = |noise: &str, set: &[&str]| {
        let set: Vec<Override> = set
            .iter()
            .map(|text| Override::set(text).unwrap())
            .collect();
        Scenario::parse(
            "white",
            &format!("{body}temperature.noise = {{ kind = \"white\", {noise} }}"),
            &set,
        )
    };
    let event_driven = "scheme.kind=event-driven";
    for (tolerance, theta) in [(1e-3, 1e3), (1e-2, 1e2)] {
        let set = [event_driven, &format!("scheme.tolerance={tolerance}")];
        let scenario = read("strength = 0.25", &set).unwrap();
        let noise = scenario.model.temperature.noises[0];
        assert!(
            (noise.relaxation_rate / theta - 1.0).abs() < 1e-12,
            "{noise:?}"
        );
        // The integral of the covariance of rho v is rho^2 sigma^2/theta^2 = 2 D.
        let twice = (noise.intensity * noise.diffusion / noise.relaxation_rate).powi(2);
        assert!((twice - 0.5).abs() < 1e-12);
        assert_eq!(
            Scenario::parse("white", &scenario.to_toml(), &[]).unwrap(),
            scenario
        );
    }
    for (noise, set, says) in [
        ("strength = 1", "friction.static=1.1", "would never act"),
        (
            "strength = 1",
            "scheme.kind=corrected-vi",
            "has no tolerance",
        ),
        (
            "strength = 1, intensity = 1",
            "time.end=9",
            "has no meaning for white noise",
        ),
        (
            "relaxation_rate = 1",
            "time.end=9",
            "missing key `temperature.noise.strength`",
        ),
    ] {
        let message = read(noise, &[event_driven, set]).unwrap_err().to_string();
        assert!(
            message.contains(says) && message.contains("fix: "),
            "{set}: {message}"
        );
    }
    let theta = |set| {
        read("strength = 1, relaxation_rate = 7", &[set]).map(|s| s.model.temperature.noises[0])
    };
    assert_eq!(theta(event_driven).unwrap().relaxation_rate, 7.0);
}

/// Where only a user-defined force brakes the body, nothing says how fast it forgets its
/// velocity.
#[test]
fn white_noise_asks_for_its_rate_where_only_a_force_brakes() {
    let text = "oscillator = { mass = 1, stiffness = 0, force_per_temperature = 1 }\ninitial.displacement = 0\n\
                friction = { static = 0, dynamic = 0 }\ntime.end = 45\nscheme.kind = \"event-driven\"\n\
                force.expression = \"-xdot*abs(xdot)\"\n";
    let read = |noise: &str| {
        Scenario::parse(
            "white",
            &format!("{text}temperature.noise = {{ kind = \"white\", strength = 1{noise} }}"),
            &[],
        )
    };
    let message = read("").unwrap_err().to_string();
    assert!(
        message.contains("velocity relaxation time of the body is unknown")
            && message.contains("give the noise a `relaxation_rate`")
    );
    let noise = read(", relaxation_rate = 200").unwrap();
    assert_eq!(
        noise
            .written
            .white_noise
            .and_then(|white| white.share(&noise.model)),
        None
    );
}

/// Parameters are of the whole scenario: a number may name one where there is no expression, force and
/// load know the same, and the old tables of each are refused with what to do.
#[test]
fn parameters_have_one_scope() {
    let text = format!(
        "{}\n[parameters]\nf = 1.0\nk3 = 0.02",
        BASE.replace("dynamic = 1.0", "dynamic = \"f\"")
    );
    let unused = diagnostic(Scenario::parse("a", &text, &[]));
    assert!(
        unused.problem.starts_with("`parameters.k3` is not used"),
        "{unused}"
    );
    let with = |sets: &[&str]| {
        let sets: Vec<Override> = sets.iter().map(|set| Override::set(set).unwrap()).collect();
        Scenario::parse("a", &text, &sets)
    };
    let load = with(&["friction.load=1 + k3*x^2"]).unwrap();
    assert_eq!(load.model.friction.dynamic_force, 1.0);
    for sets in [
        &["initial.velocity=k3"][..],
        &["friction.load=f + k3*x^2", "force.expression=-k3*x^3"],
    ] {
        let scenario = with(sets).unwrap();
        assert_eq!(
            Scenario::parse("a", &scenario.to_toml(), &[]).unwrap(),
            scenario
        );
        assert_eq!(scenario.number_at("k3"), Some(0.02));
    }
    assert_eq!(
        with(&["force.expression=-k3*x^3", "f=0.5"])
            .unwrap()
            .model
            .friction
            .dynamic_force,
        0.5
    );
    let named = diagnostic(Scenario::parse("a", &text.replace("k3", "'k 3'"), &[]));
    assert!(
        named.problem.contains("cannot be the name of a parameter"),
        "{named}"
    );
    for (set, key) in [
        ("f=\"k3\"", "parameters.f"),
        ("statistics.levels=[\"f\"]", "statistics.levels"),
    ] {
        let Err(ScenarioError::Invalid(found)) = with(&[set]) else {
            panic!("{set} is accepted");
        };
        let is_said = |one: &Diagnostic| {
            one.key.as_deref() == Some(key)
                && one
                    .problem
                    .starts_with("is a string; it must be a finite number")
                && one
                    .remedy
                    .contains("the name of a parameter is not allowed")
        };
        // No number that names the parameter is reported as well.
        let is_other = |one: &Diagnostic| one.problem.contains("neither a number nor a parameter");
        assert!(
            found.iter().any(is_said) && !found.iter().any(is_other),
            "{found:?}"
        );
    }
    // The tables beside the expressions are the same scope.
    let split = |of_force: &str, of_load: &str| {
        let text = format!(
            "{BASE}\n[force]\nexpression = \"-k3*x^3 - c*x^5\"\nparameters = {{ {of_force} }}\n"
        );
        let sets = [
            format!("friction.parameters={{ {of_load} }}"),
            "friction.load=1 + c*x^2".to_string(),
        ];
        let sets: Vec<Override> = sets.iter().map(|set| Override::set(set).unwrap()).collect();
        Scenario::parse("a", &text, &sets)
    };
    let scenario = split("k3 = 0.02, c = 0.1", "c = 0.1").unwrap();
    assert_eq!(scenario.written.parameters.len(), 2);
    assert_eq!(scenario.number_at("force.parameters.k3"), Some(0.02));
    let twice = diagnostic(split("k3 = 0.02, c = 0.1", "c = 0.2"));
    assert!(
        twice
            .key
            .as_deref()
            .is_some_and(|key| key.contains("parameters")),
        "{twice}"
    );
}

/// Every other word leads to an option or a key that exists, and no word is listed twice.
#[test]
fn every_synonym_leads_to_a_name() {
    let options = [
        "paths",
        "seed",
        "scheme",
        "tolerance",
        "step",
        "until",
        "zone",
    ];
    let options = [&options[..], &["threads", "from", "output", "json", "only"]].concat();
    let known = keys();
    let mut words = Vec::new();
    for (name, synonyms, _) in super::synonyms::ROWS {
        let plain = name.replace(".harmonics.", ".harmonics.0.");
        let is_key = known.iter().any(|known| known.key == plain);
        assert!(is_key || options.contains(&name), "{name}");
        for word in synonyms.iter().copied() {
            assert!(!words.contains(&word), "{word}");
            words.push(word);
            let meant = option_meant(word, &options).map(str::to_string);
            assert!(
                meant.or(key_meant(word).map(|(key, _)| key)).is_some(),
                "{word}"
            );
        }
    }
    // Nothing is meant by a word that is only a little like an option that does harm.
    for word in ["cores", "format", "formula"] {
        assert_eq!(option_meant(word, &["force"]), None, "{word}");
    }
    assert_eq!(option_meant("forse", &["force"]), Some("force"));
}
