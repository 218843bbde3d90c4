//! Situations that nobody intends, caused by a user of the command or by a machine that damages its
//! files. Each leads to one clear message, and no file is lost.

use crate::command::{self, Running, shell};
use crate::edit;
use rand_pcg::Pcg64Dxsm;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt as _;
use std::path::Path;
use std::process::Output;
use std::time::{Duration, Instant};
use tempfile::TempDir;

const RHO025: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/rho025.toml");
const EQUAL_FRICTION: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../scenarios/equal-friction.toml"
);

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn mc(folder: &TempDir, arguments: &[&str]) -> Output {
    command::mc(folder.path(), arguments)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Makes a small run, in `a.h5`.
fn run(here: &TempDir, more: &[&str]) {
    let output = mc(
        here,
        &[
            &[
                "run", RHO025, "--paths", "40", "--step", "0.05", "--quiet", "-o", "a.h5",
            ],
            more,
        ]
        .concat(),
    );
    assert!(output.status.success(), "{}", text(&output.stderr));
}

/// The command is refused with this exit code and these words, and leaves no new file.
#[track_caller]
fn assert_refused(here: &TempDir, arguments: &[&str], code: i32, words: &[&str]) {
    let before = names(here.path());
    let output = mc(here, arguments);
    let said = text(&output.stderr);
    assert_eq!(
        output.status.code(),
        Some(code),
        "mc {}: {said}",
        arguments.join(" ")
    );
    assert!(
        words.iter().all(|word| said.contains(word)),
        "mc {}: {said}",
        arguments.join(" ")
    );
    assert_eq!(names(here.path()), before, "mc {}", arguments.join(" "));
}

fn names(folder: &Path) -> Vec<std::ffi::OsString> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("read").file_name())
        .collect();
    names.sort();
    names
}

/// A block of this run takes minutes, while the limits are kept to a fraction of a second. The
/// bound allows for a machine that is slow by some seconds.
#[test]
fn a_time_limit_and_an_interrupt_do_not_wait_for_a_block() {
    let late = Duration::from_secs(8);
    let here = folder();
    let finest = [
        "run", RHO025, "--paths", "1000", "--step", "1e-6", "--quiet", "-o", "a.h5",
    ];
    let equal = [
        "run",
        EQUAL_FRICTION,
        "--scheme",
        "event-driven",
        "--tolerance",
        "1e-9",
        "--quiet",
        "-o",
        "a.h5",
    ];
    for scene in [&finest[..], &equal] {
        let start = Instant::now();
        assert_refused(
            &here,
            &[scene, &["--max-time", "2s"]].concat(),
            1,
            &[
                "time limit was reached before the first 256 paths",
                "--max-time",
            ],
        );
        assert!(
            start.elapsed() < Duration::from_secs(2) + late,
            "{:?}",
            start.elapsed()
        );
        let mut running = Running::mc(here.path(), scene);
        running.until_it_answers();
        let start = Instant::now();
        running.interrupt();
        let output = running.end();
        assert!(start.elapsed() < late, "{:?}", start.elapsed());
        assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
        assert!(
            text(&output.stderr).contains("nothing was written"),
            "{}",
            text(&output.stderr)
        );
        assert!(names(here.path()).is_empty());
    }
}

/// Forces of fine structure, under which a path takes minutes and may be given up. Whoever asks gets
/// an answer at once: `mc check`, a time limit, Ctrl-C and SIGTERM.
#[test]
fn a_force_of_fine_structure_keeps_nobody_waiting() {
    let late = Duration::from_secs(8);
    let here = folder();
    for (force, signal, code) in [
        ("sin(1e6*x)", "INT", 130),
        ("sign(sin(1e15*x))", "TERM", 143),
    ] {
        let force = format!("force.expression={force}");
        let scene = ["--scheme", "event-driven", "--set", &force];
        let start = Instant::now();
        let output = mc(&here, &[&["check", RHO025], &scene[..]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        println!("mc check: {:?}", start.elapsed());
        assert!(start.elapsed() < late, "{:?}", start.elapsed());
        let run = [&["run", RHO025], &scene[..], &["--quiet", "-o", "a.h5"]].concat();
        let start = Instant::now();
        let limited = [&run[..], &["--max-time", "1s"]].concat();
        assert_refused(
            &here,
            &limited,
            1,
            &[
                "time limit was reached before the first 256 paths",
                "--max-time",
            ],
        );
        assert!(
            start.elapsed() < Duration::from_secs(1) + late,
            "{:?}",
            start.elapsed()
        );
        let mut running = Running::mc(here.path(), &run);
        running.until_it_answers();
        std::thread::sleep(Duration::from_secs(1));
        let start = Instant::now();
        running.signal(signal);
        let output = running.end();
        println!("SIG{signal}: {:?}", start.elapsed());
        assert!(start.elapsed() < late, "{:?}", start.elapsed());
        assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
        assert!(names(here.path()).is_empty());
    }
}

#[test]
fn only_regular_files_are_replaced_and_never_an_input() {
    let here = folder();
    run(&here, &[]);
    fs::copy(RHO025, here.path().join("t.toml")).expect("copied");
    std::os::unix::fs::symlink("a.h5", here.path().join("link.h5")).expect("linked");
    assert!(shell(here.path(), "mkfifo pipe.h5").status.success());
    let is_input = ["is an input of this command"];
    assert_refused(
        &here,
        &["replay", "a.h5", "--path", "0", "-o", "a.h5", "--force"],
        2,
        &is_input,
    );
    assert_refused(
        &here,
        &[
            "replay",
            "a.h5",
            "--path",
            "0",
            "-o",
            "./link.h5",
            "--force",
        ],
        2,
        &is_input,
    );
    assert_refused(
        &here,
        &["trade", "t.toml", "-o", "t.toml", "--force"],
        2,
        &is_input,
    );
    assert_refused(
        &here,
        &["run", "t.toml", "-o", "t.toml", "--force"],
        2,
        &is_input,
    );
    assert_refused(
        &here,
        &[
            "sweep",
            "t.toml",
            "--vary",
            "friction.static=1.1,1.2",
            "-o",
            "t.toml",
            "--force",
        ],
        2,
        &is_input,
    );
    for name in ["pipe.h5", "/dev/null", "/dev/full"] {
        assert_refused(
            &here,
            &["run", "t.toml", "-o", name, "--force"],
            2,
            &["not a regular file"],
        );
    }
    assert_refused(
        &here,
        &["run", "t.toml", "-o", "-"],
        2,
        &["not to standard output"],
    );
    assert!(!here.path().join("-").exists());
    let name = OsStr::from_bytes(b"caf\xe9.h5");
    let mut command = assert_cmd::Command::cargo_bin("mc").expect("built");
    let output = command
        .current_dir(here.path())
        .args(["run", "t.toml", "-o"])
        .arg(name)
        .output()
        .expect("runs");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("not UTF-8"),
        "{}",
        text(&output.stderr)
    );
}

/// Opening a pipe that nobody reads or writes would block the program.
#[test]
fn a_pipe_in_the_way_holds_nobody_up() {
    let here = folder();
    let line = "for name in a.h5.partial a.h5.lock in.h5; do mkfifo $name; done";
    assert!(shell(here.path(), line).status.success());
    assert_refused(
        &here,
        &["run", RHO025, "-o", "a.h5", "--force"],
        1,
        &["a.h5.lock"],
    );
    fs::remove_file(here.path().join("a.h5.lock")).expect("removed");
    assert_refused(
        &here,
        &["run", RHO025, "-o", "a.h5", "--force"],
        2,
        &["a.h5.partial", "the name is taken"],
    );
    assert_refused(
        &here,
        &[
            "plot",
            RHO025,
            "-o",
            "a.h5.svg",
            "--set",
            "ensemble.paths=0",
        ],
        2,
        &[],
    );
    assert_refused(&here, &["show", "in.h5"], 2, &["in.h5"]);
    assert_refused(&here, &["resume", "a.h5"], 2, &["no unfinished run"]);
}

#[test]
fn a_limit_on_the_size_of_files_is_an_error_and_not_a_signal() {
    let here = folder();
    let run =
        format!("run {RHO025} --paths 20000 --step 0.05 --quiet --set record.events=true -o a.h5");
    let output = shell(here.path(), &format!("ulimit -f 700; exec \"$0\" {run}"));
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("File too large"),
        "{}",
        text(&output.stderr)
    );
    assert!(!here.path().join("a.h5").exists());
}

#[test]
fn too_little_memory_is_an_error_and_not_an_abort() {
    let here = folder();
    let run = format!(
        "run {RHO025} --paths 2000 --set time.output_step=0.01 --threads 64 --quiet -o a.h5"
    );
    let output = shell(
        here.path(),
        &format!("ulimit -v 1000000; exec \"$0\" {run}"),
    );
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("of memory") && text(&output.stderr).contains("--threads")
    );
}

/// Within a gigabyte of memory, everything that claims to be larger is refused because of its size.
/// The program does not abort, and reads no gigabytes.
#[test]
fn sizes_are_looked_at_before_memory_is_asked_for() {
    let here = folder();
    run(&here, &[]);
    let sparse = |name: &str, head: &[u8]| {
        fs::write(here.path().join(name), head).expect("room");
        let file = fs::File::options()
            .write(true)
            .open(here.path().join(name))
            .expect("there");
        file.set_len(3 << 30).expect("room");
    };
    sparse("large.toml", b"title = 'a scenario'\n");
    sparse("large.csv", b"time,temperature_degC\n0,1\n");
    sparse("large.h5", b"");
    fs::create_dir(here.path().join("run.h5.partial")).expect("room");
    sparse("run.h5.partial/state", b"");
    // A variable that takes no space in the file, but has more rows than any memory can hold.
    edited(&here, |file| {
        file.unlink("time").expect("there");
        file.new_dataset::<f64>()
            .chunk(1024)
            .shape(1_000_000_000_000_usize)
            .create("time")
            .expect("room");
    });
    let grid = "--paths 2000 --scheme event-driven --set time.output_step=0.01 --threads 4 --quiet -o b.h5";
    for (arguments, code, words) in [
        (
            format!("run {RHO025} --paths 1000000000000000000 -o b.h5"),
            2,
            "out of range",
        ),
        (
            format!("run {RHO025} --paths 1000000000000 -o b.h5"),
            1,
            "but only",
        ),
        (
            format!("run {RHO025} --scheme event-driven --set time.output_step=1e-12 -o b.h5"),
            2,
            "at most 100000 are supported",
        ),
        (
            format!("run {RHO025} {grid} --set record.trajectories=2000"),
            2,
            "of memory",
        ),
        ("run large.toml -o b.h5".into(), 2, "larger than 1 MiB"),
        ("fit-temperature large.csv".into(), 2, "larger than 1 GiB"),
        ("show large.h5".into(), 2, "not an HDF5 file"),
        ("show run.h5".into(), 1, "damaged"),
        ("show a.h5".into(), 1, "time is larger than the file"),
    ] {
        let output = shell(
            here.path(),
            &format!("ulimit -v 1000000; exec \"$0\" {arguments}"),
        );
        let said = text(&output.stderr);
        assert!(
            output.status.code() == Some(code) && said.contains(words),
            "mc {arguments}: {said}"
        );
        assert!(!here.path().join("b.h5.partial").exists(), "mc {arguments}");
    }
    let rows: String = (0..20_000_001).map(|_| "0,1\n").collect();
    fs::write(
        here.path().join("rows.csv"),
        format!("time,temperature_degC\n{rows}"),
    )
    .expect("room");
    assert_refused(
        &here,
        &["fit-temperature", "rows.csv"],
        2,
        &["more than 20000000 rows"],
    );
}

#[test]
fn a_long_run_is_announced() {
    let here = folder();
    let check = mc(
        &here,
        &["check", RHO025, "--step", "1e-4", "--paths", "1000000000"],
    );
    assert!(
        text(&check.stdout).contains("run time here, on "),
        "{}",
        text(&check.stdout)
    );
    let mut running = Running::mc(
        here.path(),
        &[
            "run",
            RHO025,
            "--step",
            "1e-4",
            "--paths",
            "1000000000",
            "--set",
            "record.paths=false",
        ],
    );
    running.until_it_answers();
    running.interrupt();
    assert!(text(&running.end().stderr).contains("this takes about"));
}

#[track_caller]
fn edited(here: &TempDir, change: impl FnOnce(&hdf5::File)) {
    edit::edited(&here.path().join("a.h5"), change);
}

fn set_text(file: &hdf5::File, name: &str, change: impl FnOnce(&str) -> String) {
    use std::str::FromStr as _;
    let attribute = file.attr(name).expect("an attribute");
    let text = attribute
        .read_scalar::<hdf5::types::VarLenUnicode>()
        .expect("text");
    let changed = hdf5::types::VarLenUnicode::from_str(&change(text.as_str())).expect("text");
    attribute.write_scalar(&changed).expect("written");
}

#[test]
fn a_replay_of_a_file_that_was_edited_is_refused() {
    for (from, to) in [
        ("static = 1.1", "static = 1.2"),
        ("step = 0.05", "step = 0.1"),
        ("seed = 1", "seed = 2"),
    ] {
        let here = folder();
        run(
            &here,
            &[
                "--set",
                "friction.static=1.1",
                "--set",
                "friction.dynamic=0.9",
            ],
        );
        assert!(
            mc(&here, &["replay", "a.h5", "--path", "7", "-o", "r.h5"])
                .status
                .success()
        );
        edited(&here, |file| {
            set_text(file, "scenario", |text| {
                assert!(text.contains(from), "{text}");
                text.replace(from, to)
            })
        });
        assert_refused(
            &here,
            &["replay", "a.h5", "--path", "7", "-o", "s.h5"],
            1,
            &["differs from the one in the file"],
        );
        // The file is reported as changed by every verb.
        let shown = mc(&here, &["show", "a.h5"]);
        assert!(
            text(&shown.stderr).contains("no checksum"),
            "{}",
            text(&shown.stderr)
        );
    }
    let here = folder();
    run(&here, &[]);
    edited(&here, |file| {
        set_text(file, "program_version", |_| "9.9".into())
    });
    let output = mc(&here, &["replay", "a.h5", "--path", "7", "-o", "r.h5"]);
    assert!(
        text(&output.stderr).contains("written by version 9.9"),
        "{}",
        text(&output.stderr)
    );
}

#[test]
fn a_file_without_what_a_table_needs_is_damaged() {
    for name in [
        "statistic",
        "estimate",
        "standard_error",
        "interval_low",
        "interval_high",
        "law_completed",
    ] {
        let here = folder();
        run(&here, &[]);
        edited(&here, |file| file.unlink(name).expect("there"));
        assert_refused(
            &here,
            &["show", "a.h5"],
            1,
            &["a.h5", "is missing; another program removed"],
        );
    }
    // A variable of another shape, and one of another type.
    for wrong in 0..2 {
        let here = folder();
        run(&here, &[]);
        edited(&here, |file| {
            file.unlink("estimate").expect("there");
            match wrong {
                0 => drop(
                    file.new_dataset::<f64>()
                        .shape(3)
                        .create("estimate")
                        .expect("made"),
                ),
                _ => drop(
                    file.new_dataset::<i32>()
                        .shape(21)
                        .create("estimate")
                        .expect("made"),
                ),
            }
        });
        assert_refused(
            &here,
            &["show", "a.h5"],
            1,
            &["estimate", "another program"],
        );
    }
    let here = folder();
    run(&here, &[]);
    edited(&here, |file| {
        file.unlink("displacement_mean").expect("there");
        // A petabyte of values that takes no space.
        let huge = file
            .new_dataset::<f64>()
            .chunk(1024)
            .shape(1_usize << 47)
            .create("displacement_mean");
        drop(huge.expect("made"));
    });
    assert_refused(
        &here,
        &["show", "a.h5"],
        1,
        &["shape of displacement_mean differs"],
    );
}

/// Every variable that a reader asks for is taken out of a file, one at a time. It is named, or the
/// file is one that may lack it. No verb panics.
#[test]
fn a_variable_that_is_missing_is_named_by_every_verb() {
    let here = folder();
    run(
        &here,
        &[
            "--set",
            "record.trajectories=2",
            "--set",
            "record.events=true",
            "--set",
            "statistics.after=5",
        ],
    );
    let whole = fs::read(here.path().join("a.h5")).expect("written");
    let names = hdf5::File::open(here.path().join("a.h5"))
        .and_then(|file| file.member_names())
        .expect("HDF5");
    let (mut named, mut lacking) = (0, Vec::new());
    for name in &names {
        fs::write(here.path().join("a.h5"), &whole).expect("written");
        edited(&here, |file| file.unlink(name).expect("there"));
        for verb in [
            &["show", "a.h5"][..],
            &["plot", "a.h5", "--force"],
            &["report", "a.h5", "--force"],
        ] {
            let output = mc(&here, verb);
            let said = text(&output.stderr);
            assert!(
                said.contains("a.h5 has no checksum"),
                "{name}, {verb:?}: {said}"
            );
            match output.status.code() {
                Some(0) => lacking.push(name.as_str()),
                Some(1) if said.contains(&format!("{name} is missing")) => named += 1,
                code => panic!("{name}, {verb:?}: {code:?} {said}"),
            }
        }
    }
    // Rows of single paths are read by other verbs, and corrected estimates follow from the others.
    let may_lack = [
        "path",
        "event",
        "trajectory",
        "estimate_corrected",
        "statistic_",
        "sub_phase",
        "period",
        "transient",
        "drift_velocity_limit",
        "law_long_name",
        "law_unit",
    ];
    let others = |name: &&&str| !may_lack.iter().any(|begin| name.starts_with(begin));
    assert_eq!(
        lacking.iter().filter(others).collect::<Vec<_>>(),
        Vec::<&&str>::new()
    );
    assert!(named >= 3 * 40, "{named}");
}

/// Every verb that reads a file says that another program has changed it.
#[test]
fn every_verb_says_that_a_file_has_no_checksum() {
    let here = folder();
    run(&here, &["--part", "1/1"]);
    fs::rename(here.path().join("a.h5"), here.path().join("part.h5")).expect("renamed");
    run(&here, &[]);
    let sweep = [
        "sweep",
        RHO025,
        "--vary",
        "friction.static=1.1,1.2",
        "--paths",
        "256",
        "--quiet",
        "-o",
        "sweep.h5",
    ];
    assert!(mc(&here, &sweep).status.success());
    for name in ["a.h5", "part.h5", "sweep.h5"] {
        let path = here.path().join(name);
        let mut bytes = fs::read(&path).expect("there");
        bytes.truncate(bytes.len() - 24);
        fs::write(&path, bytes).expect("written");
    }
    for verb in [
        &["show", "a.h5"][..],
        &["show", "a.h5", "part.h5"],
        &["show", "a.h5", "--format", "csv"],
        &["show", "a.h5", "--cite"],
        &["show", "a.h5", "--scenario"],
        &["show", "sweep.h5"],
        &["plot", "a.h5", "-o", "a.svg"],
        &["plot", "sweep.h5", "-o", "sweep.svg"],
        &["report", "a.h5"],
        &["replay", "a.h5", "--path", "3", "-o", "path.h5"],
        &["merge", "part.h5", "-o", "merged.h5", "--quiet"],
        &["verify", "a.h5", "--again"],
        &["verify", "sweep.h5", "--again"],
    ] {
        let output = mc(&here, verb);
        let said = text(&output.stderr);
        assert!(output.status.success(), "{verb:?}: {said}");
        let file = verb
            .iter()
            .find(|word| word.ends_with(".h5"))
            .expect("a file");
        assert_eq!(
            said.matches(&format!("{file} has no checksum")).count(),
            1,
            "{verb:?}: {said}"
        );
    }
}

/// 400 files with one bit inverted, all of which are refused because of their checksum, and 40
/// files that are cut short. Without the checksum, one in two hundred would end in a signal and one
/// in four hundred in a panic.
#[test]
fn flipped_bits_are_refused_before_anything_follows_them() {
    let here = folder();
    run(&here, &["--set", "record.trajectories=2"]);
    let whole = fs::read(here.path().join("a.h5")).expect("written");
    let mut rng = Pcg64Dxsm::seed_from_u64(3);
    let mut below = |end: usize| (rng.next_u64() % end as u64) as usize;
    let all = whole.len();
    let read = |bytes: &[u8]| {
        fs::write(here.path().join("b.h5"), bytes).expect("written");
        stickslip_files::store::read(&here.path().join("b.h5"))
    };
    assert_eq!(read(&whole).expect("whole").completed_paths, 40);
    // Every byte of the checksum at the end, and as many others.
    for i in 0..400 {
        let mut flipped = whole.clone();
        let at = if i < 24 { all - 1 - i } else { below(all) };
        flipped[at] ^= 1 << below(8);
        let error = read(&flipped).expect_err("refused").to_string();
        let is_named = error.contains("b.h5")
            && (error.contains("checksum") || error.contains("not an HDF5 file"));
        assert!(is_named && !error.contains('\n'), "{i}, byte {at}: {error}");
    }
    for _ in 0..40 {
        let error = read(&whole[..below(all)]).expect_err("refused").to_string();
        assert!(error.contains("b.h5") && !error.contains('\n'), "{error}");
    }
    // The command refuses such a file as well.
    let mut flipped = whole;
    flipped[5000] ^= 4;
    fs::write(here.path().join("b.h5"), flipped).expect("written");
    for verb in [
        &["show", "b.h5"][..],
        &["plot", "b.h5"],
        &["report", "b.h5"],
        &["replay", "b.h5", "--path", "1"],
    ] {
        assert_refused(&here, verb, 1, &["b.h5", "checksum"]);
    }
}

/// The checksum is that of the whole file, also where the file is read in several pieces.
#[test]
fn a_flipped_bit_is_found_anywhere_in_a_large_file() {
    let here = folder();
    run(
        &here,
        &[
            "--set",
            "record.trajectories=40",
            "--set",
            "time.output_step=0.05",
        ],
    );
    let mut bytes = fs::read(here.path().join("a.h5")).expect("written");
    let all = bytes.len();
    assert!(all > 5 << 19, "{all}");
    for place in 1..20 {
        let at = place * all / 20;
        bytes[at] ^= 1;
        fs::write(here.path().join("b.h5"), &bytes).expect("written");
        let error = stickslip_files::store::read(&here.path().join("b.h5"))
            .expect_err("refused")
            .to_string();
        assert!(
            error.contains("b.h5") && error.contains("checksum"),
            "byte {at}: {error}"
        );
        bytes[at] ^= 1;
    }
}

#[test]
fn nothing_reaches_the_terminal_that_moves_it() {
    let here = folder();
    run(&here, &[]);
    edited(&here, |file| {
        set_text(file, "title", |_| "\u{1b}[2Jtitle\u{202e}\u{7}".into())
    });
    let name = "odd\u{1b}[31m\u{202e}.toml";
    fs::write(
        here.path().join(name),
        format!("title = 1\n{} = 2\n", "x".repeat(800_000)),
    )
    .expect("written");
    for arguments in [
        &["show", "a.h5"][..],
        &["show", "a.h5", "--json"],
        &["check", name],
        &["run", name, "--bogus\u{1b}"],
        &["show", name],
    ] {
        let output = mc(&here, arguments);
        for stream in [&output.stdout, &output.stderr] {
            let said = text(stream);
            let is_safe = |c: char| !(c.is_control() && c != '\n' && c != '\t') && c != '\u{202e}';
            assert!(said.chars().all(is_safe), "{arguments:?}: {said:?}");
            assert!(said.lines().all(|line| line.len() < 5000), "{arguments:?}");
        }
    }
    assert!(text(&mc(&here, &["show", "a.h5"]).stdout).contains("\\u001b[2Jtitle\\u202e\\u0007"));
}

/// A sweep does not replace a file that has appeared under its name either.
#[test]
fn a_file_that_appears_during_a_sweep_is_not_replaced() {
    let here = folder();
    let sweep = [
        "sweep",
        RHO025,
        "--vary",
        "friction.static=1.1,1.2,1.3",
        "--paths",
        "20000",
        "--quiet",
        "-o",
        "s.h5",
    ];
    let mut running = Running::mc(here.path(), &sweep);
    running.until("a point is done", || {
        here.path().join("s.h5.partial/points.h5").exists()
    });
    fs::write(here.path().join("s.h5"), "by hand").expect("written");
    let output = running.end();
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("mc resume s.h5"),
        "{}",
        text(&output.stderr)
    );
    assert_eq!(
        fs::read(here.path().join("s.h5")).expect("there"),
        b"by hand"
    );
    fs::remove_file(here.path().join("s.h5")).expect("removed");
    assert!(mc(&here, &["resume", "s.h5", "--quiet"]).status.success());
}

#[test]
fn messages_name_unwritable_and_missing_folders() {
    let here = folder();
    assert_refused(
        &here,
        &["run", RHO025, "-o", "/proc/a.h5"],
        1,
        &["/proc/a.h5"],
    );
    assert_refused(&here, &["run", RHO025, "-o", "gone/a.h5"], 2, &["gone"]);
}
