//! `mc verify`: a file is as it was written, and contains what its scenario gives. Every number
//! that was changed is named, even if the checksum was made to fit.

#[path = "common/command.rs"]
mod command;

use std::fs;
use std::process::Output;
use tempfile::TempDir;

const RHO025: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/rho025.toml");
const SHAW: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/shaw.toml");
const BRIDGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/viaduct.toml");

/// A run with rows of every kind, whose last block is not full.
const SCENE: &[&str] = &[
    "run",
    RHO025,
    "--step",
    "0.05",
    "--paths",
    "2900",
    "--quiet",
    "--set",
    "record.events=true",
    "--set",
    "record.trajectories=1300",
    "--set",
    "time.output_step=5",
];

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
    let [path, other] = ["a.h5", "other.h5"].map(|name| here.path().join(name));
    // The change is made in another file, because a process that another test has just started may
    // still hold the lock of this one.
    fs::rename(&path, &other).expect("renamed");
    let file = hdf5::File::open_rw(&other).expect("HDF5");
    change(&file);
    drop(file);
    let mut bytes = fs::read(&other).expect("there");
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

fn add<T: hdf5::H5Type + Clone + std::ops::AddAssign>(file: &hdf5::File, name: &str, at: usize, more: T) {
    let dataset = file.dataset(name).expect("a variable");
    let mut values: Vec<T> = dataset.read_raw().expect("read");
    values[at] += more;
    dataset.write_raw(&values).expect("written");
}

#[test]
fn every_kind_of_file_is_what_its_scenario_comes_to() {
    let kinds: [(&[&str], u64); 9] = [
        (SCENE, 12),
        (&[SCENE, &["--part", "2/3"]].concat(), 4),
        (&[SCENE, &["--set", "ensemble.antithetic=true", "--no-bias"]].concat(), 12),
        (&[SCENE, &["--set", "record.paths=false", "--set", "record.trajectories=0"]].concat(), 12),
        (&["run", RHO025, "--quiet", "--step", "0.05", "--until", "stick_duration_mean < 5%"], 4),
        (&["run", RHO025, "--quiet", "--paths", "700", "--scheme", "event-driven"], 3),
        (&["run", RHO025, "--quiet", "--paths", "700", "--scheme", "corrected-vi", "--step", "0.05"], 3),
        (&["run", SHAW, "--quiet", "--paths", "700", "--scheme", "quasi-static"], 3),
        (&["run", BRIDGE, "--quiet", "--paths", "300"], 2),
    ];
    for (arguments, blocks) in kinds {
        let here = made(arguments);
        let all = verified(&here, &["--blocks", "all"]);
        assert_eq!((&all["matches"], &all["statistics_checked"]), (&true.into(), &true.into()), "{arguments:?}");
        assert_eq!((&all["blocks"], &all["paths_checked"]), (&blocks.into(), &all["paths"]), "{arguments:?}");
        assert_eq!((&all["has_checksum"], &all["same_program"]), (&true.into(), &true.into()), "{arguments:?}");
        let some = verified(&here, &["--blocks", "2"]);
        assert_eq!(some["blocks_checked"].as_array().map(Vec::len), Some(2), "{arguments:?}");
        assert_eq!(some["statistics_checked"], serde_json::json!(blocks == 2), "{arguments:?}");
    }
}

#[test]
fn the_report_says_how_much_was_checked() {
    let here = made(SCENE);
    let said = text(&verify(&here, &["--blocks", "3"]).stdout);
    assert!(said.contains("simulated    3 of 12 blocks"), "{said}");
    assert!(said.contains("not compared statistics and intervals"), "{said}");
    let said = text(&verify(&here, &["--blocks", "all"]).stdout);
    assert!(said.contains("simulated    12 of 12 blocks, 2 900 of 2 900 paths: all"), "{said}");
    assert!(said.contains("every statistic") && said.contains("bit for bit"), "{said}");
    // Without rows of single paths there is nothing that a block could be compared with.
    let none = ["--set", "record.paths=false", "--set", "record.events=false", "--set", "record.trajectories=0"];
    let here = made(&[SCENE, &none].concat());
    let said = text(&verify(&here, &[]).stdout);
    assert!(said.contains("simulated    nothing: the file keeps no rows"), "{said}");
    let all = verified(&here, &["--blocks", "all"]);
    assert_eq!((&all["statistics_checked"], &all["paths_checked"]), (&true.into(), &2900.into()));
}

/// One value is changed in its last bits, in every table of a file, in its statistics, and in its
/// attributes.
#[test]
fn whatever_was_changed_is_named_although_the_checksum_fits() {
    type Change = fn(&hdf5::File);
    let changes: [(&str, Change, &[&str]); 8] = [
        ("path_stick_time", |file| add(file, "path_stick_time", 2899, 1e-9), &["path 2899:", "path_stick_time is "]),
        ("path_sticks", |file| add(file, "path_sticks", 256, 1_u32), &["path 256:", "path_sticks is "]),
        ("event_count", |file| add(file, "event_count", 1000, 1_u32), &["path 1000:", "event_count is "]),
        ("event_force", |file| add(file, "event_force", 1, 1e-12), &["path 0: event_force, value 1 of the path"]),
        (
            "trajectory_velocity",
            |file| add(file, "trajectory_velocity", 1299 * row(file) + 3, 1e-12),
            &["path 1299: trajectory_velocity, value 3 of the path"],
        ),
        ("estimate", |file| add(file, "estimate", 4, 1e-12), &["estimate, value 4, is "]),
        ("interval_high", |file| add(file, "interval_high", 0, 1e-12), &["interval_high, value 0, is "]),
        (
            "seed",
            |file| file.attr("seed").and_then(|seed| seed.write_scalar(&2_u64)).expect("written"),
            &["seed, value 0, is 2 in the file, and 1 when"],
        ),
    ];
    for (name, change, named) in changes {
        let here = made(SCENE);
        forge(&here, true, change);
        let output = verify(&here, &["--blocks", "all"]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{name}: {said}");
        assert!(named.iter().all(|named| said.contains(named)), "{name}: {said}");
    }
    // The scenario itself is changed to one that does not give the rows.
    let here = made(SCENE);
    let edit = |file: &hdf5::File| {
        let attribute = file.attr("scenario").expect("there");
        let scenario: hdf5::types::VarLenUnicode = attribute.read_scalar().expect("read");
        let other = scenario.replace("static = 1.2 ", "static = 1.25 ");
        assert_ne!(scenario.as_str(), other);
        attribute.write_scalar(&other.parse::<hdf5::types::VarLenUnicode>().expect("text")).expect("written");
    };
    forge(&here, true, edit);
    let output = verify(&here, &["--blocks", "1"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("path "), "{}", text(&output.stderr));
}

/// The number of values in a row of the trajectories.
fn row(file: &hdf5::File) -> usize {
    file.dataset("time").expect("there").size()
}

#[test]
fn bytes_that_were_changed_are_damage_and_other_files_are_told_apart() {
    let here = made(SCENE);
    let path = here.path().join("a.h5");
    let mut bytes = fs::read(&path).expect("there");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, &bytes).expect("written");
    let output = verify(&here, &[]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("checksum"), "{}", text(&output.stderr));
    fs::write(&path, "a text").expect("written");
    assert_eq!(verify(&here, &[]).status.code(), Some(2));
    assert_eq!(command::mc(here.path(), &["verify", "none.h5"]).status.code(), Some(2));
    let here = made(&["sweep", RHO025, "--vary", "friction.static=1.1:1.2:2", "--paths", "300", "--quiet"]);
    let said = text(&verify(&here, &[]).stdout);
    assert!(said.contains("is right") && said.contains("nothing: a trade, a sweep"), "{said}");
}

#[test]
fn a_file_of_another_program_is_said_to_be_one() {
    let here = made(SCENE);
    forge(&here, true, |file| {
        let version: hdf5::types::VarLenUnicode = "9.9.9".parse().expect("text");
        file.attr("program_version").and_then(|attribute| attribute.write_scalar(&version)).expect("written");
        add(file, "path_stick_time", 5, 1.0);
    });
    let output = verify(&here, &["--blocks", "all"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("written by mc 9.9.9") && said.contains("the program that wrote it"), "{said}");
    let here = made(SCENE);
    forge(&here, false, |file| file.attr("seed").and_then(|seed| seed.write_scalar(&1_u64)).expect("written"));
    assert!(text(&verify(&here, &[]).stdout).contains("checksum     none"), "another program drops the seal");
}
