//! `mc calibrate` and `mc twin` as a person uses them: with measurements of one's own, where
//! something cannot be known, and where the input is refused.

use crate::command::{TWIN as DATA, done, hundred_days, json, refused};

const SCENARIO: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/bridge/bridge.toml"
);

/// The shipped measurements: the JSON has the seven parameters, the file holds the same numbers,
/// and it can be drawn.
#[test]
fn the_shipped_twin_is_calibrated_in_one_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let printed = done(
        path,
        &[
            "calibrate",
            SCENARIO,
            DATA,
            "--method",
            "both",
            "--json",
            "-o",
            "fit.h5",
            "-o",
            "fitted.toml",
        ],
    );
    let reported = json(&printed);
    let keys = [
        "bearing.offset",
        "friction.dynamic",
        "friction.gap",
        "friction.static",
        "initial.displacement",
        "oscillator.dilatation",
        "oscillator.stiffness",
    ];
    let parameters = reported["parameters"].as_object().expect("an object");
    assert_eq!(parameters.keys().collect::<Vec<_>>(), keys);
    for (key, estimate) in parameters {
        let [low, middle, high] =
            ["low", "estimate", "high"].map(|end| estimate[end].as_f64().expect("a number"));
        assert!(low < middle && middle < high, "{key}");
    }
    let stiffness = parameters["oscillator.stiffness"]["estimate"]
        .as_f64()
        .expect("a number");
    assert!((stiffness / 1.89e8 - 1.0).abs() < 0.05, "{stiffness}");
    assert_eq!(reported["starts"].as_array().map(Vec::len), Some(10));
    assert!(
        reported["slips"]
            .as_array()
            .is_some_and(|slips| slips.len() > 100)
    );
    // The result of each starting point is stored as its parameters, from which the other numbers
    // are computed again; they agree to the last bit but one.
    let shown = json(&done(path, &["show", "fit.h5", "--json"]));
    for key in [
        "parameters",
        "derived",
        "interval",
        "slips",
        "lag",
        "residuals",
        "warnings",
    ] {
        assert_eq!(shown[key], reported[key], "{key}");
    }
    assert_eq!(
        done(path, &["show", "fit.h5"]).lines().next(),
        Some("Viaduct bearing: 300 days, a sample every ten minutes")
    );
    // A table for programs has every digit; JSON is read to a unit in the last place.
    let csv = done(path, &["show", "fit.h5", "--format", "csv"]);
    let row = csv
        .lines()
        .find(|line| line.starts_with("fit.h5,oscillator.stiffness,K,"))
        .expect("a row");
    let there: f64 = row
        .split(',')
        .nth(3)
        .and_then(|cell| cell.parse().ok())
        .expect("a number");
    assert!((there / stiffness - 1.0).abs() < 1e-15, "{csv}");
    // The scenario with the estimates has them, and everything else of the scenario.
    let [fitted, scenario] = [path.join("fitted.toml").as_path(), SCENARIO.as_ref()]
        .map(|file| std::fs::read_to_string(file).expect("a scenario"));
    for (key, of) in [
        ("stiffness", "oscillator.stiffness"),
        ("static", "friction.static"),
    ] {
        let value = parameters[of]["estimate"].as_f64().expect("a number");
        assert!(
            fitted.contains(&format!("{key} = {value:.6e}\n")),
            "{fitted}"
        );
    }
    assert!(
        fitted.contains("2.0e9") && fitted.lines().count() <= scenario.lines().count() + 1,
        "{fitted}"
    );
    let data = hundred_days(path);
    done(path, &["calibrate", "fitted.toml", data, "--json"]);
    refused(
        path,
        &["show", "fit.h5", "--statistics", "jump_mean"],
        2,
        &["fit.h5 is a calibration"],
    );
    done(path, &["plot", "fit.h5", "-o", "page.svg"]);
    refused(
        path,
        &[
            "calibrate",
            SCENARIO,
            DATA,
            "--method",
            "slips",
            "-o",
            "fit.h5",
        ],
        2,
        &["--force"],
    );
    // The measured temperature of a scenario has its own times.
    for flag in [
        ["--duration", "10d"],
        ["--every", "1h"],
        ["--start", "2024-06-01"],
    ] {
        let twin = [&["twin", SCENARIO, "-o", "twin.csv"], &flag[..]].concat();
        refused(path, &twin, 2, &[flag[0], "has its own times", "fix: "]);
    }
}

/// Synthetic measurements are the same for the same seed and differ for another one. A calibration
/// finds their true parameters to within 10 %, which is five standard errors.
#[test]
fn a_twin_is_calibrated_to_its_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let twin = |name: &str, seed: &str| {
        let truth = ["friction.static=4.2e5", "friction.dynamic=3.6e5"];
        done(
            path,
            &[
                "twin", SCENARIO, "--set", truth[0], "--set", truth[1], "--seed", seed, "-o", name,
            ],
        );
        std::fs::read(path.join(name)).expect("written")
    };
    let [one, same, other] = [twin("a.csv", "4"), twin("b.csv", "4"), twin("c.csv", "5")];
    assert!(one == same && one != other);
    let reported = json(&done(
        path,
        &[
            "calibrate",
            SCENARIO,
            "a.csv",
            "--method",
            "slips",
            "--json",
        ],
    ));
    for (key, truth) in [
        ("friction.static", 4.2e5),
        ("friction.dynamic", 3.6e5),
        ("oscillator.stiffness", 1.8e8),
    ] {
        let found = reported["parameters"][key]["estimate"]
            .as_f64()
            .expect("a number");
        assert!((found / truth - 1.0).abs() < 0.1, "{key}: {found}");
    }
    // A parameter that is held has the value that was given, without an interval.
    let held =
        "oscillator.stiffness,friction.static,friction.dynamic,bearing.offset,initial.displacement";
    let reported = json(&done(
        path,
        &[
            "calibrate",
            SCENARIO,
            "a.csv",
            "--method",
            "slips",
            "--fit",
            held,
            "--json",
        ],
    ));
    let beta = &reported["parameters"]["oscillator.dilatation"];
    assert!(
        (beta["estimate"].as_f64().expect("a number") / 3.0e-4 - 1.0).abs() < 1e-6,
        "{beta}"
    );
}

#[test]
fn the_heading_lists_what_was_changed() {
    let folder = tempfile::tempdir().expect("a folder");
    let set = "friction.static=4.6e5";
    let changed = [
        "calibrate",
        SCENARIO,
        hundred_days(folder.path()),
        "--method",
        "slips",
        "--set",
        set,
    ];
    let printed = done(folder.path(), &changed);
    let heading = printed.lines().next().unwrap_or_default();
    assert!(
        heading.ends_with(" (changed: friction.static = 4.6e5)"),
        "{heading}"
    );
}

#[test]
fn without_the_shear_stiffness_forces_are_null() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = std::fs::read_to_string(SCENARIO)
        .expect("shipped")
        .replace("[bearing]\nstiffness = 2.0e9", "[bearing]");
    std::fs::write(folder.path().join("rigid.toml"), scenario).expect("written");
    let data = hundred_days(folder.path());
    let reported = json(&done(
        folder.path(),
        &[
            "calibrate",
            "rigid.toml",
            data,
            "--method",
            "slips",
            "--json",
        ],
    ));
    assert!(reported["parameters"]["friction.static"]["estimate"].is_null());
    assert!(reported["derived"]["static_way"]["estimate"].is_number());
    assert_eq!(reported["warnings"][0]["name"], "no_shear_stiffness");
    let bounded = [
        "calibrate",
        "rigid.toml",
        DATA,
        "--method=criterion",
        "--bounds=friction.static=4e5:6e5",
    ];
    refused(folder.path(), &bounded, 2, &["bearing.stiffness"]);
    let unused = [
        "calibrate",
        "rigid.toml",
        DATA,
        "--bounds=friction.static=4e5:6e5",
    ];
    refused(
        folder.path(),
        &unused,
        2,
        &["method = slips", "--method both"],
    );
}

#[test]
fn what_cannot_be_used_is_refused_in_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let write = |name: &str, text: &str| std::fs::write(path.join(name), text).expect("written");
    write(
        "short.csv",
        "time,temperature_degC,displacement_mm\n2020-01-01T00:00Z,1,2\n2020-01-01T01:00Z,2,2\n",
    );
    write(
        "unitless.csv",
        "time,temperature_degC,displacement\n2020-01-01T00:00Z,1,2\n2020-01-01T01:00Z,2,2\n",
    );
    write(
        "clockless.csv",
        "time,temperature_degC,displacement_mm\n0,1,2\n1,2,2\n",
    );
    for (data, more, code, word) in [
        ("absent.csv", &[][..], 2, "absent.csv"),
        ("short.csv", &[], 1, "at least 200"),
        ("unitless.csv", &[], 2, "unit"),
        ("clockless.csv", &[], 2, "no unit of time"),
        ("short.csv", &["--displacement", "gauge"], 2, "gauge"),
        (DATA, &["--lag", "soon"], 2, "15m"),
        (DATA, &["--method", "magic"], 2, "slips, criterion or both"),
        (DATA, &["--fit", "friction.gap"], 2, "friction.static"),
        (DATA, &["--bounds", "friction.static=6e5:4e5"], 2, "below"),
        (
            DATA,
            &["--fit", "friction.static"],
            2,
            "initial.displacement",
        ),
    ] {
        let arguments = [&["calibrate", SCENARIO, data], more].concat();
        refused(path, &arguments, code, &[word]);
    }
}

/// The shipped measurements with these cells of displacements, and two rows exchanged.
fn spoilt(folder: &std::path::Path, cell: impl Fn(usize) -> Option<&'static str>) {
    let text = std::fs::read_to_string(DATA).expect("the twin");
    let spoil = |(i, line): (usize, &str)| match cell(i) {
        Some(cell) => format!("{},{cell}", line.rsplit_once(',').expect("cells").0),
        None => line.to_string(),
    };
    let mut lines: Vec<String> = text.lines().enumerate().map(spoil).collect();
    lines.swap(100, 101);
    std::fs::write(folder.join("spoilt.csv"), lines.join("\n")).expect("written");
}

#[test]
fn repairs_are_in_the_json_the_file_and_the_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    spoilt(path, |i| (i == 200).then_some(""));
    let repairs = [
        "spoilt.csv: sorted 1 row out of order",
        "spoilt.csv: left out 1 cell without a value in `displacement_mm`",
    ];
    let calibrate = [
        "calibrate",
        SCENARIO,
        "spoilt.csv",
        "--json",
        "-o",
        "fit.h5",
    ];
    let reported = json(&done(path, &calibrate));
    assert_eq!(reported["repairs"], serde_json::json!(repairs));
    let shown = json(&done(path, &["show", "fit.h5", "--json"]));
    assert_eq!(shown["repairs"], reported["repairs"]);
    done(path, &["verify", "fit.h5"]);
    done(path, &["report", "fit.h5", "-o", "fit.html"]);
    let page = std::fs::read_to_string(path.join("fit.html")).expect("the page");
    let weather = ["fit-temperature", "spoilt.csv", "--json", "-o", "t.toml"];
    let weather = json(&done(path, &weather));
    assert_eq!(weather["repairs"], serde_json::json!(repairs[..1]));
    let part = std::fs::read_to_string(path.join("t.toml")).expect("the part");
    assert!(part.contains(repairs[0]), "{part}");
    for repair in repairs {
        // The page writes what is in backticks as code.
        let words = repair.split('`').next().unwrap_or(repair);
        assert!(page.contains(words), "{repair}");
    }
    let forecast = [
        "forecast",
        SCENARIO,
        "spoilt.csv",
        "--draws",
        "2",
        "--years",
        "2",
        "--json",
    ];
    let forecast = json(&done(path, &forecast));
    assert_eq!(forecast["attrs"]["repairs"], repairs.join("\n"));
}

/// A mark that hides the slips is what the remedy is about, not the length of the record.
#[test]
fn a_record_with_marks_is_refused_with_the_option_for_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    spoilt(path, |i| (i > 0 && i.is_multiple_of(977)).then_some("9999"));
    for command in ["calibrate", "forecast"] {
        let arguments = [command, SCENARIO, "spoilt.csv"];
        refused(
            path,
            &arguments,
            1,
            &["leave out its outliers with `--missing 9999`"],
        );
    }
    done(
        path,
        &["calibrate", SCENARIO, "spoilt.csv", "--missing", "9999"],
    );
}

/// Jumps that are not slips of a bearing are refused in one sentence, by a calibration and by a
/// forecast: a joint opens every morning, where a bearing would slip upwards.
#[test]
fn jumps_that_are_no_slips_are_refused_in_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let mut text = "time_h,temperature_degC,displacement_mm\n".to_string();
    let mut width = 0.0;
    for hour in 0..480 {
        let at = f64::from(hour);
        let temperature =
            20.0 + (5.0 + 2.0 * (at / 70.0).sin()) * (std::f64::consts::PI * at / 12.0).sin();
        match hour % 24 {
            4 => width -= 0.2 + 0.001 * (at % 7.0),
            16 => width += 0.2 + 0.001 * (at % 7.0),
            _ => (),
        }
        text += &format!(
            "{hour},{temperature:.2},{:.4}\n",
            0.01 * temperature + width + 1e-3 * (7.0 * at).sin()
        );
    }
    std::fs::write(path.join("joint.csv"), text).expect("written");
    let column = ["--set", "temperature.series.time=\"time_h\""];
    for verb in ["calibrate", "forecast"] {
        let arguments = [&[verb, SCENARIO, "joint.csv"], &column[..]].concat();
        refused(
            path,
            &arguments,
            1,
            &[
                "jumps that were found are not the slips of a bearing",
                "a crack that opens",
            ],
        );
    }
}
