//! `mc` with scenarios that have a measured temperature: the formats of the file, the contents of
//! the results, and what is refused.

use crate::command::mc;
use serde_json::Value;
use std::f64::consts::PI;
use std::path::Path;
use std::process::Output;
use stickslip::config::shipped;

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[track_caller]
fn ok(output: &Output) -> String {
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// The command is refused: exit code 2, and one message with a remedy.
#[track_caller]
fn refused(folder: &Path, arguments: &[&str], says: &[&str]) {
    let output = mc(folder, arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    for part in says {
        assert!(message.contains(part), "{part}: {message}");
    }
    assert!(message.contains("fix: "), "{message}");
}

/// The scenario `bridge` in a folder of its own, with other samples.
fn bridge(csv: &str) -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(here.path().join("scene")).expect("made");
    std::fs::write(
        here.path().join("scene/bridge.toml"),
        shipped("bridge").expect("shipped").text,
    )
    .expect("written");
    std::fs::write(here.path().join("scene/bridge.csv"), csv).expect("written");
    here
}

/// Two days with a sample every ten minutes.
fn days() -> String {
    let mut csv = String::from("time,temperature_degC\n");
    for i in 0..=288 {
        let celsius = 12.0 + 14.0 * (i as f64 * std::f64::consts::TAU / 144.0).sin();
        csv += &format!(
            "2020-05-{:02}T{:02}:{:02}:00Z,{celsius:.3}\n",
            1 + i / 144,
            i % 144 / 6,
            i % 6 * 10
        );
    }
    csv
}

#[test]
fn results_say_everything_without_the_file_of_samples() {
    let here = bridge(&days());
    let here = here.path();
    ok(&mc(here, &["run", "scene/bridge.toml", "-o", "run.h5"]));
    let checked = ok(&mc(here, &["check", "scene/bridge.toml"]));
    // The printed scenario runs from the folder in which it was printed.
    std::fs::write(here.join("checked.toml"), &checked).expect("written");
    ok(&mc(here, &["run", "checked.toml", "-o", "checked.h5"]));
    let replayed = ok(&mc(
        here,
        &["replay", "run.h5", "--path", "0", "-o", "before.h5"],
    ));
    std::fs::remove_file(here.join("scene/bridge.csv")).expect("removed");
    refused(
        here,
        &["run", "scene/bridge.toml", "-o", "again.h5"],
        &["temperature.series.file", "scene/bridge.csv"],
    );
    assert!(ok(&mc(here, &["show", "run.h5"])).contains("slips_per_path"));
    let again = ok(&mc(
        here,
        &[
            "replay",
            "run.h5",
            "--path",
            "0",
            "-o",
            "before.h5",
            "--force",
        ],
    ));
    assert_eq!(again, replayed);
    ok(&mc(here, &["plot", "run.h5", "-o", "run.svg"]));
    ok(&mc(
        here,
        &[
            "plot", "run.h5", "--only", "path", "--until", "86400", "-o", "path.svg",
        ],
    ));
}

/// A user's file that has the name of a shipped scenario takes the samples beside it, two days of
/// them, and not the month that is built into the program. Without them it is refused.
#[test]
fn a_file_named_like_a_shipped_scenario_reads_its_samples() {
    let here = tempfile::tempdir().expect("a folder");
    let here = here.path();
    std::fs::write(
        here.join("bridge"),
        shipped("bridge").expect("shipped").text,
    )
    .expect("written");
    refused(
        here,
        &["check", "bridge"],
        &["temperature.series.file", "bridge.csv"],
    );
    std::fs::write(here.join("bridge.csv"), days()).expect("written");
    let checked = ok(&mc(here, &["check", "bridge"]));
    assert!(checked.contains("end = 172800.0"), "{checked}");
}

/// Parts contain their samples, so that they can be joined without the file of samples. So does an
/// unfinished run, which has the same state.
#[test]
fn parts_are_joined_without_the_file_of_samples() {
    let here = bridge(&days());
    let here = here.path();
    let run = [
        "run",
        "scene/bridge.toml",
        "--paths",
        "512",
        "--set",
        "temperature.noise={intensity=0.5, relaxation_rate=1e-4, pinned=true}",
    ];
    ok(&mc(here, &[&run[..], &["-o", "whole.h5"]].concat()));
    for part in ["1/2", "2/2"] {
        ok(&mc(
            here,
            &[
                &run[..],
                &["--part", part, "-o", &format!("part-{}.h5", &part[..1])],
            ]
            .concat(),
        ));
    }
    std::fs::remove_file(here.join("scene/bridge.csv")).expect("removed");
    ok(&mc(
        here,
        &["merge", "part-1.h5", "part-2.h5", "-o", "all.h5"],
    ));
    let [whole, all] = ["whole.h5", "all.h5"].map(|name| {
        let file = hdf5::File::open(here.join(name)).expect("opens");
        let numbers = |name: &str| {
            file.dataset(name)
                .expect("there")
                .read_raw::<f64>()
                .expect("numbers")
        };
        let bits = |name: &str| {
            numbers(name)
                .into_iter()
                .map(f64::to_bits)
                .collect::<Vec<_>>()
        };
        let start = file
            .dataset("series_time")
            .expect("there")
            .attr("start")
            .expect("a stamp");
        let start = start
            .read_scalar::<hdf5::types::VarLenUnicode>()
            .expect("text")
            .as_str()
            .to_string();
        (
            [
                "estimate",
                "temperature_sd",
                "series_time",
                "series_temperature",
            ]
            .map(bits),
            start,
        )
    });
    assert_eq!(whole, all);
    assert_eq!(whole.1, "2020-05-01T00:00:00Z");
}

#[test]
fn a_shipped_scenario_is_written_with_its_samples() {
    let here = tempfile::tempdir().expect("a folder");
    let here = here.path();
    ok(&mc(here, &["init", "--from", "bridge"]));
    ok(&mc(here, &["run", "bridge.toml", "-o", "bridge.h5"]));
    let before = std::fs::read(here.join("bridge.csv")).expect("written");
    assert!(before.len() > 100_000);
    let output = mc(here, &["init", "--from", "bridge", "-o", "other.toml"]);
    assert_eq!(
        output.status.code(),
        Some(2),
        "the samples are there already: {}",
        text(&output.stderr)
    );
    assert!(!here.join("other.toml").exists());
}

#[test]
fn what_does_not_go_with_a_series_is_refused() {
    let here = bridge(&days());
    let here = here.path();
    let check = |set: &[&str], says: &[&str]| {
        let sets = set.iter().flat_map(|set| ["--set", *set]);
        refused(
            here,
            &["check", "scene/bridge.toml"]
                .into_iter()
                .chain(sets)
                .collect::<Vec<_>>(),
            says,
        );
    };
    check(
        &["time.end=1e6"],
        &["`time.end` = 1000000.0", "beyond the last sample", "172800"],
    );
    check(
        &["temperature.series.value=temp"],
        &[
            "no column is called `temp`",
            "did you mean `temperature_degC`?",
        ],
    );
    check(
        &["temperature.series.time=when"],
        &["no column is called `when`", "`time`"],
    );
    check(
        &["temperature.series.max_gap=\"5min\""],
        &["bridge.csv:3", "for 10 min"],
    );
    check(
        &["temperature.series.max_gap=soon"],
        &[
            "`temperature.series.max_gap` = soon is not a duration",
            "6h",
        ],
    );
    check(
        &["temperature.series.hash=abc"],
        &["hash", "differ from those"],
    );
    check(
        &["temperature.series={}"],
        &["missing key `temperature.series.file`"],
    );
    check(
        &["temperature.series.colour=1"],
        &[
            "unknown key `colour`",
            "`temperature.series` takes file, time",
        ],
    );
    check(
        &["temperature.noise={intensity=1, pinned=true, initial=2}"],
        &["v is zero at the first sample", "set it to 0"],
    );
    check(
        &[
            "temperature.noise={intensity=1, pinned=true}",
            "scheme.kind=discrete-vi",
            "time.step=1",
        ],
        &["pinned", "quasi-static"],
    );
    check(
        &["units.time=h"],
        &["times in seconds", "`units.time` is \"h\""],
    );
    check(
        &["initial.displacement=balance"],
        &["did you mean \"balanced\"?"],
    );
    check(
        &["bearing.stiffness=0"],
        &["`bearing.stiffness` = 0 is out of range"],
    );
    let csv = days().replace("2020-05-01T12:00:00Z,12.000", "2020-05-01T12:00:00Z,warm");
    std::fs::write(here.join("scene/bridge.csv"), csv).expect("written");
    check(
        &[],
        &[
            "bridge.csv:74",
            "`temperature_degC` = \"warm\" is not a number",
        ],
    );
}

#[test]
fn repairs_and_noise_over_a_series_are_reported() {
    let lines: Vec<String> = days().lines().map(String::from).collect();
    let mut mended = vec![
        lines[0].clone(),
        lines[2].clone(),
        lines[1].clone(),
        lines[2].clone(),
    ];
    mended.extend_from_slice(&lines[3..]);
    mended[20] = mended[20].split(',').next().expect("a stamp").to_string() + ",";
    let here = bridge(&(mended.join("\n") + "\n"));
    let here = here.path();
    let warned = ok(&mc(here, &["check", "scene/bridge.toml", "--json"]));
    for part in [
        "repaired-series",
        "sorted 1 row",
        "left out 1 duplicate row",
        "left out 1 cell without a value in `temperature_degC`",
    ] {
        assert!(warned.contains(part), "{part}: {warned}");
    }
    assert!(!warned.contains("weather-twice"));
    let noisy = ok(&mc(
        here,
        &[
            "check",
            "scene/bridge.toml",
            "--json",
            "--set",
            "temperature.noise.intensity=0.1",
        ],
    ));
    assert!(noisy.contains("weather-twice"), "{noisy}");
    let many = ok(&mc(
        here,
        &[
            "check",
            "scene/bridge.toml",
            "--json",
            "--set",
            "time.output_step=4",
        ],
    ));
    assert!(
        many.contains("many-rows") && many.contains("43201"),
        "{many}"
    );
}

/// With x(0) = beta T(0) there is no force at the start. In a stick F is b, so that z = z0 + x +
/// b/K_BP.
#[test]
fn a_balanced_bearing_shows_its_offset_first() {
    let here = bridge(&days());
    let here = here.path();
    for scheme in ["quasi-static", "event-driven", "discrete-vi"] {
        let step = if scheme == "discrete-vi" {
            "time.step=0.01"
        } else {
            "scheme.tolerance=1e-3"
        };
        let set = [
            "--set",
            "initial.displacement=balanced",
            "--set",
            step,
            "--set",
            "time.end=7200",
        ];
        let run = [
            "run",
            "scene/bridge.toml",
            "--scheme",
            scheme,
            "-o",
            "b.h5",
            "--force",
        ];
        ok(&mc(here, &[&run[..], &set[..]].concat()));
        let file = hdf5::File::open(here.join("b.h5")).expect("opens");
        let rows = |name: &str| {
            file.dataset(name)
                .expect("there")
                .read_raw::<f64>()
                .expect("numbers")
        };
        let [z, x, force] = ["bearing_displacement", "displacement", "friction"]
            .map(|name| rows(&format!("trajectory_{name}")));
        assert!((x[0] - 3.06e-4 * 12.0).abs() < 1e-15, "{scheme}: {}", x[0]);
        assert!(force[0].abs() < 1e-6, "{scheme}: {}", force[0]);
        assert_eq!(z[0], -9.67e-3 + x[0], "{scheme}");
        for i in 0..z.len() {
            assert!(
                (z[i] + 9.67e-3 - x[i] - force[i] / 2.0e9).abs() < 1e-15,
                "{scheme} {i}"
            );
        }
        assert!(
            force.iter().any(|force| force.abs() > 1e4),
            "{scheme}: the temperature moves"
        );
        assert_eq!(rows("series_time").len(), 289);
    }
}

/// A scenario that is made in memory has the checks of one that is read.
#[test]
fn pinned_noise_without_a_series_is_refused_in_memory_as_well() {
    let text = stickslip::config::shipped("rho025").expect("shipped").text;
    let mut scenario = stickslip::scenario::Scenario::parse("rho025", text, &[]).expect("sound");
    scenario.model.temperature.is_pinned = true;
    let check_error = scenario.check().expect_err("there is nothing to pin to");
    assert!(
        check_error
            .sentence()
            .contains("`temperature.noise.pinned` = true, but there is no"),
        "{check_error:?}"
    );
}

/// Where an acceleration that is straight between these samples, `step` seconds apart, takes a block
/// that slides at a yield acceleration: by short steps, independent of the library.
pub fn slid(samples: &[f64], step: f64, threshold: f64) -> f64 {
    const PARTS: usize = 2000;
    let h = step / PARTS as f64;
    let (mut v, mut x) = (0.0f64, 0.0);
    for pair in samples.windows(2) {
        for k in 0..PARTS {
            let pull = pair[0] + (pair[1] - pair[0]) * (k as f64 + 0.5) / PARTS as f64;
            let friction = if v == 0.0 {
                pull.clamp(-threshold, threshold)
            } else {
                threshold.copysign(v)
            };
            let next = v + h * (pull - friction);
            // Friction stops the block, and does not turn it back.
            let next = if v * next < 0.0 { 0.0 } else { next };
            x += 0.5 * h * (v + next);
            v = next;
        }
    }
    x
}

/// A block that slides at 0.2 g under a quiet record with one pulse of 0.5 g for 0.08 s. Every value
/// of the record acts, and what stands out is said; only `outliers` takes the pulse away.
#[test]
fn a_pulse_in_a_quiet_record_is_kept() {
    const G: f64 = 9.81;
    let step = 0.02;
    let noise = |i: usize| 1e-4 * G * ((i * 7919 % 1000) as f64 / 500.0 - 1.0);
    let pulse = |i: usize| {
        if (250..=254).contains(&i) {
            0.5 * G * ((i - 250) as f64 * PI / 4.0).sin()
        } else {
            0.0
        }
    };
    let samples: Vec<f64> = (0..500)
        .map(|i| ((noise(i) + pulse(i)) * 1e6).round() / 1e6)
        .collect();
    let rows: String = samples
        .iter()
        .enumerate()
        .map(|(i, a)| format!("{:.2},{a:.6}\n", step * i as f64))
        .collect();
    let here = tempfile::tempdir().expect("a folder");
    let here = here.path();
    std::fs::write(here.join("quake.csv"), format!("time_s,acc\n{rows}")).expect("written");
    let scenario = format!(
        "[units]\ntime = \"s\"\n[oscillator]\nmass = 1\nstiffness = 0\nforce_per_temperature = 1\n[friction]\nstatic = {0}\n\
         dynamic = {0}\n[temperature.series]\nfile = \"quake.csv\"\nvalue = \"acc\"\n[initial]\ndisplacement = 0\n[scheme]\n\
         kind = \"event-driven\"\n",
        0.2 * G
    );
    std::fs::write(here.join("block.toml"), scenario).expect("written");
    let checked = ok(&mc(here, &["check", "block.toml", "--json"]));
    assert!(
        checked.contains("kept the outlier `acc` = ") && checked.contains("in line 254"),
        "{checked}"
    );
    let end = |set: &str| {
        ok(&mc(
            here,
            &[
                "run",
                "block.toml",
                "-o",
                "block.h5",
                "--force",
                "--paths",
                "1",
                "--set",
                set,
            ],
        ));
        let shown: Value =
            serde_json::from_str(&ok(&mc(here, &["show", "block.h5", "--json"]))).expect("JSON");
        shown["statistics"]["displacement_end_mean"]["estimate"]
            .as_f64()
            .expect("a number")
    };
    let (found, expected) = (
        end("temperature.series.unit=\"degC\""),
        slid(&samples, step, 0.2 * G),
    );
    assert!(
        (found - expected).abs() < 1e-7 && expected > 6e-3,
        "{found} {expected}"
    );
    assert_eq!(end("temperature.series.outliers=8"), 0.0);
}
