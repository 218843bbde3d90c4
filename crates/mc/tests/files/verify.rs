//! `mc verify`: a file is as it was written, and contains what its scenario gives. Every number
//! that was changed is named, even if the checksum was made to fit.

use crate::command::{self, RHO025, SCENE};
use crate::edit::edited;
use hdf5::types::VarLenUnicode;
use std::collections::BTreeSet;
use std::fs;
use std::process::Output;
use tempfile::TempDir;

const SHAW: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shaw.toml");
const BRIDGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/viaduct.toml");

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[track_caller]
fn made(more: &[&str]) -> TempDir {
    let here = tempfile::tempdir().expect("a folder");
    let output = command::mc(here.path(), &[more, &["-o", "a.h5"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    here
}

fn verify(here: &TempDir, more: &[&str]) -> Output {
    command::mc(here.path(), &[&["verify", "a.h5"], more].concat())
}

#[track_caller]
fn verified(here: &TempDir, more: &[&str]) -> serde_json::Value {
    let output = verify(here, &[more, &["--json"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// Changes a file as a careful forger would: with a checksum that fits, or without one.
fn forge(here: &TempDir, is_sealed: bool, change: impl FnOnce(&hdf5::File)) {
    let path = here.path().join("a.h5");
    edited(&path, change);
    let mut bytes = fs::read(&path).expect("there");
    if let Some(seal) = bytes.windows(8).rposition(|window| window == b"mc-seal\n") {
        bytes.truncate(seal);
    }
    if is_sealed {
        let mut seal = [b"mc-seal\n".as_slice(), &(bytes.len() as u64).to_le_bytes()].concat();
        seal.extend(crc32fast::hash(&bytes).to_le_bytes());
        seal.extend(crc32fast::hash(&seal).to_le_bytes());
        bytes.extend(seal);
    }
    fs::write(&path, bytes).expect("written");
}

fn add<T: hdf5::H5Type + Clone + std::ops::AddAssign>(
    file: &hdf5::File,
    name: &str,
    at: usize,
    more: T,
) {
    let dataset = file.dataset(name).expect("a variable");
    let mut values: Vec<T> = dataset.read_raw().expect("read");
    values[at] += more;
    dataset.write_raw(&values).expect("written");
}

#[test]
fn every_kind_of_run_is_what_its_scenario_gives() {
    let rho025 = ["run", RHO025, "--quiet", "--paths", "700"];
    let no_rows = [
        "--set",
        "record.paths=false",
        "--set",
        "record.events=false",
        "--set",
        "record.trajectories=0",
    ];
    let kinds: [Vec<&str>; 9] = [
        SCENE.to_vec(),
        [
            SCENE,
            &["--set", "ensemble.antithetic=true", "--no-bias"][..],
        ]
        .concat(),
        [SCENE, &no_rows].concat(),
        [
            &rho025[..3],
            &["--step", "0.05", "--until", "stick_duration_mean < 5%"],
        ]
        .concat(),
        [&rho025[..3], &["--paths", "100k", "--max-time", "300ms"]].concat(),
        [&rho025[..], &["--scheme", "event-driven"]].concat(),
        [&rho025[..], &["--scheme", "corrected-vi", "--step", "0.05"]].concat(),
        vec![
            "run",
            SHAW,
            "--quiet",
            "--paths",
            "700",
            "--scheme",
            "quasi-static",
        ],
        vec!["run", BRIDGE, "--quiet", "--paths", "300"],
    ];
    for arguments in kinds {
        let here = made(&arguments);
        let again = verified(&here, &["--again"]);
        for key in ["matches", "has_checksum", "same_program"] {
            assert_eq!(again[key], true, "{key}: {arguments:?}");
        }
    }
}

#[test]
fn without_again_only_the_checksum_is_compared() {
    let here = made(SCENE);
    let without = verified(&here, &[]);
    assert_eq!(without["has_checksum"], true);
    assert_eq!(
        (&without["matches"], &without["values_checked"]),
        (&serde_json::Value::Null, &0.into())
    );
    let says = |more: &[&str], parts: &[&str]| {
        let said = text(&verify(&here, more).stdout);
        let line = said.split_whitespace().collect::<Vec<_>>().join(" ");
        for part in parts {
            assert!(line.contains(part), "{part}: {said}");
        }
    };
    says(
        &[],
        &["checksum correct for its", "`mc verify a.h5 --again`"],
    );
    says(&["--again"], &["simulated 2 900 paths", "bit for bit"]);
}

#[test]
fn a_part_of_a_run_is_not_simulated_again() {
    let here = made(&[SCENE, &["--part", "2/3"]].concat());
    assert!(verify(&here, &[]).status.success());
    let output = verify(&here, &["--again"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("part 2/3") && said.contains("fix: merge the parts"));
}

/// A change of one value or of one attribute, in words.
struct Change {
    what: String,
    make: Box<dyn Fn(&hdf5::File)>,
}

/// One change of each variable, alternately of its first and of its last value, one of an attribute
/// of each variable, one of each attribute of the file, and things that are not in the file.
fn changes(file: &hdf5::File) -> Vec<Change> {
    let mut changes = Vec::new();
    let mut change =
        |what: String, make: Box<dyn Fn(&hdf5::File)>| changes.push(Change { what, make });
    for (i, name) in file.member_names().expect("names").into_iter().enumerate() {
        let variable = file.dataset(&name).expect("a variable");
        let attributes = variable.attr_names().expect("names");
        let of_library = ["CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"];
        let own: Vec<String> = attributes
            .into_iter()
            .filter(|name| !of_library.contains(&name.as_str()))
            .collect();
        if let Some(attribute) = own.get(i % own.len().max(1)).cloned() {
            let of = name.clone();
            let make = move |file: &hdf5::File| {
                alter_attribute(&file.dataset(&of).expect("a variable"), &attribute)
            };
            change(format!("an attribute of {name}"), Box::new(make));
        }
        change(
            format!("a value of {name}"),
            Box::new(move |file| alter(&file.dataset(&name).expect("there"), i % 2 == 0)),
        );
    }
    for name in file.attr_names().expect("names") {
        change(
            format!("attribute {name}"),
            Box::new(move |file| alter_attribute(file, &name)),
        );
    }
    change(
        "another attribute".into(),
        Box::new(|file| new_attribute(file, "scale_factor")),
    );
    let first = file.member_names().expect("names").remove(0);
    let scale = move |file: &hdf5::File| {
        new_attribute(&file.dataset(&first).expect("there"), "scale_factor")
    };
    change("another attribute of a variable".into(), Box::new(scale));
    let more = |file: &hdf5::File| drop(file.new_dataset::<f64>().create("more").expect("made"));
    change("another variable".into(), Box::new(more));
    changes
}

fn new_attribute(location: &hdf5::Location, name: &str) {
    location
        .new_attr::<f64>()
        .create(name)
        .and_then(|new| new.write_scalar(&2.0))
        .expect("written");
}

fn other_text(text: &VarLenUnicode) -> VarLenUnicode {
    format!("{text} ").parse().expect("a text")
}

/// The next number, or a number instead of none.
fn other_real(x: f64) -> f64 {
    if x.is_nan() {
        1.0
    } else {
        f64::from_bits(x.to_bits() + 1)
    }
}

fn alter_attribute(location: &hdf5::Location, name: &str) {
    let attribute = location.attr(name).expect("an attribute");
    let kind = attribute.dtype().expect("a type");
    match () {
        () if kind.is::<f64>() => {
            attribute.write_scalar(&other_real(attribute.read_scalar().expect("read")))
        }
        () if kind.is::<u64>() => {
            attribute.write_scalar(&(attribute.read_scalar::<u64>().expect("read") + 1))
        }
        () if kind.is::<i8>() => attribute.write_raw(
            &attribute
                .read_raw::<i8>()
                .expect("read")
                .iter()
                .map(|x| x + 1)
                .collect::<Vec<_>>(),
        ),
        () => attribute.write_scalar(&other_text(&attribute.read_scalar().expect("read"))),
    }
    .expect("written");
}

/// Changes the first or the last value of a variable.
fn alter(variable: &hdf5::Dataset, is_first: bool) {
    fn with<T: hdf5::H5Type + Clone>(
        variable: &hdf5::Dataset,
        is_first: bool,
        change: impl Fn(&T) -> T,
    ) {
        let mut values: Vec<T> = variable.read_raw().expect("read");
        let at = if is_first { 0 } else { values.len() - 1 };
        values[at] = change(&values[at]);
        variable.write_raw(&values).expect("written");
    }
    let kind = variable.dtype().expect("a type");
    match () {
        () if kind.is::<f64>() => with(variable, is_first, |x: &f64| other_real(*x)),
        () if kind.is::<u64>() => with(variable, is_first, |x: &u64| x + 1),
        () if kind.is::<u32>() => with(variable, is_first, |x: &u32| x + 1),
        () if kind.is::<i8>() => with(variable, is_first, |x: &i8| x + 1),
        () if kind.is::<u8>() => with(variable, is_first, |x: &u8| x ^ 1),
        () => with(variable, is_first, other_text),
    }
}

/// Makes each change in a file that was not tried before, with a checksum that fits, and returns
/// those that `mc verify` does not find. It finds nothing in the file without a change.
fn not_found(make: &[&str], tried: &mut BTreeSet<String>) -> Vec<String> {
    let here = made(make);
    let path = here.path().join("a.h5");
    let original = fs::read(&path).expect("there");
    let file = hdf5::File::open(&path).expect("HDF5");
    let changes = changes(&file);
    drop(file);
    let unchanged = verify(&here, &["--again"]);
    assert!(unchanged.status.success(), "{}", text(&unchanged.stderr));
    assert!(changes.len() > 60, "{}", changes.len());
    let mut missed = Vec::new();
    for Change { what, make } in changes {
        if !tried.insert(what.clone()) {
            continue;
        }
        fs::write(&path, &original).expect("written");
        forge(&here, true, make);
        let output = verify(&here, &["--again"]);
        match output.status.code() {
            Some(0) => missed.push(what),
            Some(1 | 2) => assert!(
                text(&output.stderr).contains("a.h5: "),
                "{what}: {}",
                text(&output.stderr)
            ),
            code => panic!("{what}: {code:?}"),
        }
    }
    missed
}

/// Of another program it is only said that it is one.
const OF_PROGRAM: [&str; 2] = ["attribute program_version", "attribute git_hash"];

fn sorted(names: &[&str]) -> Vec<String> {
    let mut names: Vec<String> = names.iter().map(|name| name.to_string()).collect();
    names.sort();
    names
}

#[track_caller]
fn all_but_these_are_found(make: &[&str], others: &[&str], tried: &mut BTreeSet<String>) {
    for name in OF_PROGRAM.iter().chain(others) {
        tried.remove(*name);
    }
    let mut missed = not_found(make, tried);
    missed.sort();
    assert_eq!(missed, sorted(&[&OF_PROGRAM[..], others].concat()));
}

/// The dimension `event` has a length, and no values that anybody reads.
#[test]
fn every_value_and_attribute_of_a_run_is_compared() {
    let tried = &mut BTreeSet::new();
    let scene = [
        "--set",
        "record.events=true",
        "--set",
        "record.trajectories=20",
        "--set",
        "time.output_step=20",
    ];
    all_but_these_are_found(
        &[
            &[
                "run",
                RHO025,
                "--quiet",
                "--paths",
                "300",
                "--scheme",
                "event-driven",
            ],
            &scene[..],
        ]
        .concat(),
        &["a value of event"],
        tried,
    );
    all_but_these_are_found(
        &[
            "run",
            RHO025,
            "--quiet",
            "--step",
            "0.1",
            "--paths",
            "300",
            "--set",
            "time.output_step=20",
        ],
        &[],
        tried,
    );
}

/// The series of a bridge are further variables. That a run ended at a goal, and how many paths it
/// might have taken, does not follow from its scenario.
#[test]
fn every_value_of_a_bridge_and_of_an_ended_run_is_compared() {
    let tried = &mut BTreeSet::new();
    let bridge = [
        "run",
        BRIDGE,
        "--quiet",
        "--paths",
        "3",
        "--set",
        "time.output_step=10000000",
    ];
    all_but_these_are_found(&bridge, &[], tried);
    let ended = [
        "run",
        RHO025,
        "--quiet",
        "--step",
        "0.1",
        "--until",
        "stick_duration_mean < 50%",
        "--no-bias",
    ];
    all_but_these_are_found(
        &[&ended[..], &["--set", "time.output_step=20"]].concat(),
        &["attribute ended_by", "attribute paths"],
        tried,
    );
}

/// How long a point took cannot be repeated. The last bit of f_s, the value of a point, changes no
/// path.
#[test]
fn every_value_and_attribute_of_a_sweep_is_compared() {
    let tried = &mut BTreeSet::new();
    let grid = [
        "sweep",
        RHO025,
        "--vary",
        "friction.static=1.1:1.2:2",
        "--paths",
        "300",
        "--step",
        "0.1",
        "--quiet",
    ];
    all_but_these_are_found(
        &grid,
        &["a value of f_s", "a value of point_seconds"],
        tried,
    );
    let star = [
        "sweep",
        RHO025,
        "--elasticity",
        "friction.static",
        "--paths",
        "300",
        "--step",
        "0.1",
        "--quiet",
    ];
    all_but_these_are_found(
        &star,
        &["a value of key_value", "a value of point_seconds"],
        tried,
    );
}

/// What was measured and asked is believed, unless the fit does not follow from it; the last bit of
/// one sample is too little. A blank behind the scenario is none of its values.
#[test]
fn every_value_and_attribute_of_a_calibration_is_compared() {
    let scene = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/bridge/bridge.toml"
    );
    let data = fs::read_to_string(scene.replace("bridge.toml", "twin.csv")).expect("there");
    let here = tempfile::tempdir().expect("a folder");
    let short = here.path().join("short.csv").display().to_string();
    fs::write(
        &short,
        data.lines()
            .take(3000)
            .map(|line| format!("{line}\n"))
            .collect::<String>(),
    )
    .expect("written");
    let missed = not_found(
        &[
            "calibrate",
            scene,
            &short,
            "--method",
            "both",
            "--starts",
            "2",
        ],
        &mut BTreeSet::new(),
    );
    let believed = [
        "attribute scenario",
        "attribute temperature_resolution",
        "a value of time",
        "a value of temperature",
        "a value of temperature_interpolated",
        "a value of displacement",
    ];
    assert!(
        missed
            .iter()
            .all(|what| OF_PROGRAM.contains(&what.as_str()) || believed.contains(&what.as_str())),
        "{missed:?}"
    );
}

/// Of a trade the measurements are believed as long as everything that follows from them fits.
#[test]
fn verify_compares_all_values_and_attributes_of_a_trade() {
    let missed = not_found(&["trade", RHO025, "--budget", "2s"], &mut BTreeSet::new());
    let believed = [
        "paths",
        "diverged",
        "seconds",
        "seconds_first",
        "change",
        "change_error",
    ];
    let believed = believed
        .map(|name| format!("rung_{name}"))
        .into_iter()
        .chain(["statistic_pairing".to_string()]);
    let believed: Vec<String> = believed.map(|name| format!("a value of {name}")).collect();
    assert!(
        missed
            .iter()
            .all(|what| OF_PROGRAM.contains(&what.as_str()) || believed.contains(what)),
        "{missed:?}"
    );
}

/// One value is changed in its last bits, in every table of a file, in its statistics, and in its
/// attributes.
#[test]
fn whatever_was_changed_is_named_although_the_checksum_fits() {
    type Change = fn(&hdf5::File);
    let changes: [(&str, Change, &[&str]); 8] = [
        (
            "path_stick_time",
            |file| add(file, "path_stick_time", 2899, 1e-9),
            &["path 2899:", "path_stick_time is "],
        ),
        (
            "path_sticks",
            |file| add(file, "path_sticks", 256, 1_u32),
            &["path 256:", "path_sticks is "],
        ),
        (
            "event_count",
            |file| add(file, "event_count", 1000, 1_u32),
            &["path 1000:", "event_count is "],
        ),
        (
            "event_force",
            |file| add(file, "event_force", 1, 1e-12),
            &["path 0: event_force, value 1 of the path"],
        ),
        (
            "trajectory_velocity",
            |file| add(file, "trajectory_velocity", 1299 * row(file) + 3, 1e-12),
            &["path 1299: trajectory_velocity, value 3 of the path"],
        ),
        (
            "estimate",
            |file| add(file, "estimate", 4, 1e-12),
            &["estimate, value 4, is "],
        ),
        (
            "interval_high",
            |file| add(file, "interval_high", 0, 1e-12),
            &["interval_high, value 0, is "],
        ),
        (
            "seed",
            |file| {
                file.attr("seed")
                    .and_then(|seed| seed.write_scalar(&2_u64))
                    .expect("written")
            },
            &["seed is 2 in the file, but 1 when"],
        ),
    ];
    for (name, change, named) in changes {
        let here = made(SCENE);
        forge(&here, true, change);
        let output = verify(&here, &["--again"]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{name}: {said}");
        assert!(
            named.iter().all(|named| said.contains(named)),
            "{name}: {said}"
        );
    }
    // The scenario itself is changed to one that does not give the rows.
    let here = made(SCENE);
    let edit = |file: &hdf5::File| {
        let attribute = file.attr("scenario").expect("there");
        let scenario: hdf5::types::VarLenUnicode = attribute.read_scalar().expect("read");
        let other = scenario.replace("static = 1.2 ", "static = 1.25 ");
        assert_ne!(scenario.as_str(), other);
        attribute
            .write_scalar(&other.parse::<hdf5::types::VarLenUnicode>().expect("text"))
            .expect("written");
    };
    forge(&here, true, edit);
    let output = verify(&here, &["--again"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("path "),
        "{}",
        text(&output.stderr)
    );
}

/// A scenario that was stored with a calibration asks for it, with what `--set` changed.
#[test]
fn a_calibration_is_compared_with_its_scenario() {
    let scene = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/bridge/bridge.toml"
    );
    let data = fs::read_to_string(scene.replace("bridge.toml", "twin.csv")).expect("there");
    let rows = tempfile::tempdir().expect("a folder");
    let short = rows.path().join("short.csv").display().to_string();
    fs::write(
        &short,
        data.lines()
            .take(3000)
            .map(|line| format!("{line}\n"))
            .collect::<String>(),
    )
    .expect("written");
    let make = [
        "calibrate",
        scene,
        &short,
        "--method",
        "slips",
        "--set",
        "friction.static=4.9e5",
    ];
    assert_eq!(verify(&made(&make), &["--again"]).status.code(), Some(0));
    let changes = [
        ("title = \"", "title = \"Another ", "title is"),
        ("static=4.9e5", "static=4.5e5", "guess"),
        ("mass", "[mass", ""),
    ];
    for (from, to, named) in changes {
        let here = made(&make);
        forge(&here, true, |file| {
            let attribute = file.attr("scenario").expect("there");
            let text: VarLenUnicode = attribute.read_scalar().expect("read");
            let other = text.replace(from, to);
            assert_ne!(text.as_str(), other);
            attribute
                .write_scalar(&other.parse::<VarLenUnicode>().expect("a text"))
                .expect("written");
        });
        let output = verify(&here, &["--again"]);
        let said = text(&output.stderr);
        assert!(
            !output.status.success() && said.contains(named),
            "{to}: {said}"
        );
    }
}

/// The number of values in a row of the trajectories.
fn row(file: &hdf5::File) -> usize {
    file.dataset("time").expect("there").size()
}

#[test]
fn changed_bytes_are_damage_and_foreign_files_are_not() {
    let here = made(SCENE);
    let path = here.path().join("a.h5");
    let mut bytes = fs::read(&path).expect("there");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, &bytes).expect("written");
    let output = verify(&here, &[]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("checksum"),
        "{}",
        text(&output.stderr)
    );
    fs::write(&path, "a text").expect("written");
    assert_eq!(verify(&here, &[]).status.code(), Some(2));
    assert_eq!(
        command::mc(here.path(), &["verify", "none.h5"])
            .status
            .code(),
        Some(2)
    );
}

#[test]
fn a_file_of_another_program_is_said_to_be_one() {
    let here = made(SCENE);
    forge(&here, true, |file| {
        let version: hdf5::types::VarLenUnicode = "9.9.9".parse().expect("text");
        file.attr("program_version")
            .and_then(|attribute| attribute.write_scalar(&version))
            .expect("written");
        add(file, "path_stick_time", 5, 1.0);
    });
    let output = verify(&here, &["--again"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("written by version 9.9.9") && said.contains("the program that wrote it"),
        "{said}"
    );
    let here = made(SCENE);
    forge(&here, false, |file| {
        file.attr("seed")
            .and_then(|seed| seed.write_scalar(&1_u64))
            .expect("written")
    });
    assert!(
        text(&verify(&here, &[]).stdout).contains("none: another program"),
        "another program drops the checksum"
    );
}
