//! `mc sweep` as a person uses it: interrupted and continued, refused with a reason, read back.

use crate::command::{Running, mc};
use crate::edit::edited;
use crate::shim::{failing, folders, shimmed};
use hdf5::File;
use hdf5::types::VarLenUnicode;
use std::fs;
use std::path::Path;
use std::process::Output;

const SCENARIO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/rho025.toml");

/// A sweep of six points with 1024 short paths each.
const SMALL: [&str; 9] = [
    "sweep",
    SCENARIO,
    "--vary",
    "rho=temperature.noise.intensity=0.1:0.6:6",
    "--until",
    "20",
    "--set",
    "time.output_step=20",
    "--paths=1024",
];

fn sweep(folder: &Path, more: &[&str]) -> Output {
    mc(folder, &[&SMALL[..], more].concat())
}

fn err(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn out(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[track_caller]
fn done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", err(output));
}

/// The bits of all numbers that equal sweeps have in common, which are all but the CPU times.
fn numbers(path: &Path) -> Vec<(String, Vec<u64>)> {
    let file = File::open(path).expect("an HDF5 file");
    let names = file
        .member_names()
        .expect("a root group")
        .into_iter()
        .filter(|name| name != "point_seconds");
    let bits = |name: String| {
        let dataset = file.dataset(&name).expect("a variable");
        // All NaNs count as equal.
        let bits = |x: &f64| if x.is_nan() { 0 } else { x.to_bits() };
        let values = dataset
            .read_raw::<f64>()
            .map(|values| values.iter().map(bits).collect());
        (name, values.unwrap_or_default())
    };
    names.map(bits).collect()
}

fn text(path: &Path, attribute: &str) -> String {
    let file = File::open(path).expect("an HDF5 file");
    file.attr(attribute)
        .and_then(|a| a.read_scalar::<VarLenUnicode>())
        .expect(attribute)
        .as_str()
        .to_string()
}

fn completed_points(path: &Path) -> u64 {
    File::open(path)
        .and_then(|file| file.attr("completed_points")?.read_scalar())
        .unwrap_or(0)
}

#[test]
fn an_interrupted_and_killed_sweep_resumes_identically() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    // The sweep takes a second, 1.2e9 steps, so that it can be interrupted.
    let long = [
        &SMALL[..],
        &[
            "--step",
            "0.0001",
            "-o",
            "parts.h5",
            "--threads",
            "2",
            "--no-bias",
        ],
    ]
    .concat();
    let partial = here.join("parts.h5.partial/points.h5");
    let mut first = Running::mc(here, &long);
    first.until_it_answers();
    first.until("a point is done", || completed_points(&partial) > 0);
    first.interrupt();
    let output = first.end();
    assert_eq!(output.status.code(), Some(130), "{}", err(&output));
    assert!(
        err(&output).contains("run the same command again"),
        "{}",
        err(&output)
    );
    let after_interrupt = completed_points(&partial);
    assert!((1..6).contains(&after_interrupt) && !here.join("parts.h5").exists());
    assert_eq!(text(&partial, "status"), "running");

    let mut second = Running::mc(here, &long);
    second.until("another point is done", || {
        completed_points(&partial) > after_interrupt
    });
    drop(second); // kill -9
    let after_kill = completed_points(&partial);
    assert!(
        after_kill > after_interrupt,
        "what a killed process leaves is a whole file"
    );

    let output = mc(here, &long);
    done(&output);
    assert!(
        err(&output).contains(&format!("continuing: {after_kill} of 6 points")),
        "{}",
        err(&output)
    );
    assert_eq!(text(&here.join("parts.h5"), "status"), "complete");
    assert!(!here.join("parts.h5.partial").exists() && !here.join("parts.h5.lock").exists());
    let uninterrupted = [
        &long[..SMALL.len() + 2],
        &["-o", "once.h5", "--no-bias", "--threads", "3"],
    ]
    .concat();
    done(&mc(here, &uninterrupted));
    assert_eq!(
        numbers(&here.join("parts.h5")),
        numbers(&here.join("once.h5"))
    );
}

#[test]
fn a_finished_sweep_is_kept_and_a_different_one_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    done(&sweep(here, &["-o", "s.h5"]));
    let written = std::fs::read(here.join("s.h5")).expect("a file");
    let again = sweep(here, &["-o", "s.h5"]);
    done(&again);
    assert!(
        err(&again).contains("already contains this sweep")
            && out(&again).contains("stick_duration_mean")
    );
    let cases: [(&[&str], &str); 5] = [
        (
            &["--set", "friction.static=1.3"],
            "`static = 1.2`, but this sweep has `static = 1.3`",
        ),
        (
            &["--vary", "friction.static=1.2,1.3"],
            "f_s = friction.static at [1.2, 1.3]",
        ),
        (
            &["--independent"],
            "`common seeds`, but this sweep has `independent seeds`",
        ),
        (&["--no-bias"], "leaves out the bias"),
        (
            &["--seed", "7"],
            "`seed = 1`, but this sweep has `seed = 7`",
        ),
    ];
    for (more, said) in cases {
        let refused = sweep(here, &[more, &["-o", "s.h5"]].concat());
        assert_eq!(refused.status.code(), Some(2), "{more:?}");
        assert!(
            err(&refused).contains(said) && err(&refused).contains("--force"),
            "{more:?}: {}",
            err(&refused)
        );
    }
    assert_eq!(
        std::fs::read(here.join("s.h5")).expect("a file"),
        written,
        "no refused sweep touches it"
    );
    done(&sweep(here, &["-o", "s.h5", "--seed", "7", "--force"]));
    // A file of another kind.
    std::fs::write(here.join("note.txt"), "mine").expect("room");
    let refused = sweep(here, &["-o", "note.txt"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(err(&refused).contains("HDF5"), "{}", err(&refused));
    assert_eq!(
        std::fs::read_to_string(here.join("note.txt")).expect("it is there"),
        "mine"
    );
}

/// A sweep of two points, each of one block.
const TINY: [&str; 10] = [
    "sweep",
    SCENARIO,
    "--vary",
    "rho=temperature.noise.intensity=0.1:0.2:2",
    "--paths=256",
    "--step",
    "0.05",
    "--quiet",
    "-o",
    "s.h5",
];

fn tiny(more: &[&'static str]) -> Vec<&'static str> {
    [&TINY[..], more].concat()
}

/// The sweep is finished with the numbers of an undisturbed one, and nothing is beside its file.
#[track_caller]
fn assert_finished(here: &Path, expected: &[(String, Vec<u64>)], what: &str) {
    assert_eq!(numbers(&here.join("s.h5")), expected, "{what}");
    let left: Vec<_> = fs::read_dir(here)
        .expect("a folder")
        .map(|entry| entry.expect("read").file_name())
        .collect();
    assert_eq!(left, ["s.h5"], "{what}");
}

/// Makes what an interrupted sweep leaves, with all of its points, from its file.
fn leave(here: &Path, name: &str) {
    let partial = here.join(format!("{name}.partial"));
    fs::create_dir(&partial).expect("made");
    fs::write(partial.join("made-by-mc"), "").expect("written");
    fs::rename(here.join(name), partial.join("points.h5")).expect("renamed");
}

fn undisturbed() -> Vec<(String, Vec<u64>)> {
    let here = tempfile::tempdir().expect("a folder");
    done(&mc(here.path(), &TINY));
    numbers(&here.path().join("s.h5"))
}

/// A sweep is killed at every change of the disk that it makes. The same command, or `mc resume`
/// where there is something to continue, finishes it. Every third change is tried.
#[test]
fn a_sweep_killed_at_any_write_resumes_identically() {
    let expected = undisturbed();
    let mut kills = 0;
    for kill_at in (1..).step_by(3) {
        let (_outer, here) = folders();
        let (output, _) = shimmed(&here, &TINY, kill_at);
        if output.status.success() {
            break;
        }
        assert_eq!(output.status.code(), None, "{}", err(&output));
        kills += 1;
        let is_saved = here.join("s.h5.partial/points.h5").exists() || here.join("s.h5").exists();
        let again = match is_saved && kills % 2 == 0 {
            true => mc(&here, &["resume", "s.h5", "--quiet"]),
            false => mc(&here, &TINY),
        };
        assert_eq!(
            again.status.code(),
            Some(0),
            "killed at {kill_at}: {}",
            err(&again)
        );
        assert_finished(&here, &expected, &format!("killed at {kill_at}"));
    }
    assert!(kills > 15, "{kills}");
}

/// The renames, links and removals of a sweep fail, one in each try. Either it succeeds, or it says
/// what failed; the command that it advises then finishes it. A link that fails is no failure of
/// the sweep, because the file is renamed instead.
#[test]
fn a_sweep_recovers_as_advised_if_a_link_or_removal_fails() {
    let expected = undisturbed();
    let (_outer, here) = folders();
    let (_, trace) = failing(&here, &TINY, 0, 5);
    let is_name = |line: &&String| {
        ["rename", "link", "unlink"]
            .iter()
            .any(|what| line.contains(&format!(" {what} ")))
    };
    let names: Vec<u64> = trace
        .iter()
        .filter(is_name)
        .filter_map(|line| line.split(' ').next()?.parse().ok())
        .collect();
    assert!(names.len() >= 6, "{trace:?}");
    for number in names {
        let (_outer, here) = folders();
        let (output, _) = failing(&here, &TINY, number, 5);
        if !output.status.success() {
            assert_eq!(output.status.code(), Some(1), "{number}: {}", err(&output));
            let advises_resume = err(&output).contains("mc resume s.h5");
            let again = if advises_resume && here.join("s.h5.partial/points.h5").exists() {
                mc(&here, &["resume", "s.h5", "--quiet"])
            } else {
                mc(&here, &TINY)
            };
            assert_eq!(
                again.status.code(),
                Some(0),
                "{number}: {}{}",
                err(&output),
                err(&again)
            );
            assert_finished(&here, &expected, &format!("failed at {number}"));
        } else {
            assert_eq!(numbers(&here.join("s.h5")), expected, "{number}");
            let is_alone = fs::read_dir(&here).expect("a folder").count() == 1;
            assert!(
                is_alone || err(&output).contains("cannot remove"),
                "{number}: {}",
                err(&output)
            );
        }
    }
}

#[test]
fn force_replaces_leftovers_by_the_printed_numbers() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    done(&mc(here, &tiny(&["--seed", "2"])));
    let expected = numbers(&here.join("s.h5"));
    // All points of the sweep are known, and its file is still that of an older sweep.
    leave(here, "s.h5");
    done(&mc(
        here,
        &[&TINY[..8], &["--seed", "3", "-o", "old.h5"]].concat(),
    ));
    fs::rename(here.join("old.h5"), here.join("s.h5")).expect("renamed");
    let refused = mc(here, &tiny(&["--seed", "2"]));
    assert_eq!(refused.status.code(), Some(2), "{}", err(&refused));
    done(&mc(here, &tiny(&["--seed", "2", "--force"])));
    assert_finished(here, &expected, "with --force");
}

#[test]
fn mc_resume_continues_a_sweep_and_says_what_it_does_not_do() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    done(&mc(here, &TINY));
    let expected = numbers(&here.join("s.h5"));
    leave(here, "s.h5");
    let refused = mc(here, &["resume", "s.h5", "--end"]);
    assert_eq!(refused.status.code(), Some(2), "{}", err(&refused));
    assert!(err(&refused).contains("is a sweep"), "{}", err(&refused));
    fs::write(here.join("s.h5"), "by hand").expect("written");
    let refused = mc(here, &["resume", "s.h5"]);
    assert_eq!(refused.status.code(), Some(1), "{}", err(&refused));
    assert!(err(&refused).contains("appeared"), "{}", err(&refused));
    fs::remove_file(here.join("s.h5")).expect("removed");
    let resumed = mc(here, &["resume", "s.h5.partial"]);
    done(&resumed);
    assert!(
        out(&resumed).contains("stick_duration_mean"),
        "{}",
        out(&resumed)
    );
    assert_finished(here, &expected, "resumed");
    // What is finished is not simulated again.
    let again = mc(here, &["resume", "s.h5"]);
    done(&again);
    assert!(err(&again).contains("is finished"), "{}", err(&again));
}

/// A program that changes a file drops its checksum. Its points are not continued and get no
/// new checksum, neither those of a finished sweep nor those of one that is not.
#[test]
fn a_sweep_that_another_program_has_changed_is_refused() {
    for name in ["s.h5", "s.h5.partial/points.h5"] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let here = folder.path();
        done(&mc(here, &TINY));
        if name != "s.h5" {
            leave(here, "s.h5");
        }
        edited(&here.join(name), |file| {
            let estimate = file.dataset("estimate").expect("there");
            let mut values = estimate.read_raw::<f64>().expect("read");
            values[0] = 7.0;
            estimate.write_raw(&values).expect("written");
        });
        let changed = fs::read(here.join(name)).expect("there");
        let commands: &[&[&str]] = if name == "s.h5" {
            &[&TINY]
        } else {
            &[&TINY, &["resume", "s.h5"]]
        };
        for command in commands {
            let refused = mc(here, command);
            assert_eq!(refused.status.code(), Some(2), "{name}: {}", err(&refused));
            assert!(
                err(&refused).contains("no checksum") && err(&refused).contains(name),
                "{}",
                err(&refused)
            );
        }
        assert_eq!(fs::read(here.join(name)).expect("there"), changed, "{name}");
    }
}

#[test]
fn two_processes_do_not_write_one_sweep() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    let long = [
        &SMALL[..],
        &["--step", "0.00005", "-o", "s.h5", "--no-bias"],
    ]
    .concat();
    let mut first = Running::mc(here, &long);
    first.until("it has its name", || here.join("s.h5.lock").exists());
    let second = mc(here, &long);
    assert_eq!(second.status.code(), Some(2));
    assert!(
        err(&second).contains("another process is writing this file"),
        "{}",
        err(&second)
    );
}

#[test]
fn a_mistake_is_shown_with_its_place_and_a_remedy() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let vary = |expressions: &[&str]| {
        let flags: Vec<&str> = expressions.iter().flat_map(|e| ["--vary", e]).collect();
        mc(
            folder.path(),
            &[&["sweep", SCENARIO], flags.as_slice(), &["--dry-run"]].concat(),
        )
    };
    let cases: [(&[&str], &str); 7] = [
        (
            &["rho=temperature.noise.intensity=0:1:x"],
            "\n                                      ^\n",
        ),
        (
            &["temperature.noise.intensty=0:1:3"],
            "did you mean `intensity`",
        ),
        (
            &["friction.static=1.2,0.8"],
            "--vary friction.static=1.2,0.8, at 0.8",
        ),
        (
            &["friction.static=1.2", "f_s=friction.dynamic=1"],
            "called `f_s`",
        ),
        (
            &["friction.static=1.2,1.3", "x=friction.static=1"],
            "`friction.static` is varied twice",
        ),
        (&["estimate=friction.static=1.2"], "the name is reserved"),
        (
            &["friction.static=1:2:1000", "friction.dynamic=0:1:1000"],
            "1000000 points",
        ),
    ];
    for (expressions, said) in cases {
        let refused = vary(expressions);
        assert_eq!(
            refused.status.code(),
            Some(2),
            "{expressions:?}: {}",
            out(&refused)
        );
        assert!(
            err(&refused).contains(said) && err(&refused).contains("fix: "),
            "{expressions:?}: {}",
            err(&refused)
        );
    }
    let zip = mc(
        folder.path(),
        &[
            "sweep",
            SCENARIO,
            "--zip",
            "--vary",
            "friction.static=1.2,1.3",
            "--vary",
            "friction.dynamic=1",
        ],
    );
    assert!(
        err(&zip).contains("`f_s` has 2 values and `f_d` has 1"),
        "{}",
        err(&zip)
    );
    for (keys, said) in [
        (
            "friction.sttic",
            "--elasticity friction.sttic, tried at 1: unknown key `sttic`; did you mean `static`?",
        ),
        ("oscillator.damping", "no relative change"),
        ("friction.static,friction.static", "twice"),
        ("scheme.kind", "fix: "),
    ] {
        let refused = mc(folder.path(), &["sweep", SCENARIO, "--elasticity", keys]);
        assert_eq!(refused.status.code(), Some(2), "{keys}");
        assert!(err(&refused).contains(said), "{keys}: {}", err(&refused));
    }
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("a folder").count(),
        0,
        "nothing is left"
    );
}

#[test]
fn a_dry_run_says_points_paths_time_and_disk_and_writes_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = sweep(
        folder.path(),
        &[
            "--vary",
            "friction.static=log:1.2:2.4:3",
            "--dry-run",
            "-o",
            "s.h5",
        ],
    );
    done(&output);
    let text = out(&output);
    assert!(text.contains("points  18 (6 x 3: rho, f_s)"), "{text}");
    assert!(
        text.contains("1 024 paths at each point, 18 432 in all"),
        "{text}"
    );
    assert!(
        text.contains("time    about") && text.contains("disk    about"),
        "{text}"
    );
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("a folder").count(),
        0
    );
    // The announced size is that of the file, to within a fifth.
    done(&sweep(
        folder.path(),
        &[
            "--vary",
            "friction.static=log:1.2:2.4:3",
            "-o",
            "s.h5",
            "--no-bias",
        ],
    ));
    let size = std::fs::metadata(folder.path().join("s.h5"))
        .expect("a file")
        .len() as f64;
    let said = stickslip_files::store::sweep_bytes(&{
        use stickslip::study::sweep::{Design, SweepAxis};
        let axes = ["a=a=1:6:6", "b=b=1:3:3"]
            .map(|axis| SweepAxis::parse(axis, |_| None).expect("an axis"));
        Design::of(axes.into(), false).expect("a grid")
    });
    assert!(
        (0.8..1.25).contains(&(said as f64 / size)),
        "{said} said, {size} taken"
    );
}

/// A point of the file, read by the names of its axes, has the numbers that `mc run` gives there.
#[test]
fn a_point_of_the_file_is_the_run_that_mc_run_makes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    done(&sweep(
        here,
        &["--vary", "friction.static=1.2,1.4", "-o", "s.h5"],
    ));
    let shorter = [
        "--until",
        "20",
        "--set",
        "time.output_step=20",
        "--paths=1024",
    ];
    let point = [
        "--set",
        "temperature.noise.intensity=0.3",
        "--set",
        "friction.static=1.4",
        "-o",
        "run.h5",
    ];
    done(&mc(
        here,
        &[&["run", SCENARIO], &shorter[..], &point].concat(),
    ));
    let (sweep, run) = (
        File::open(here.join("s.h5")).unwrap(),
        File::open(here.join("run.h5")).unwrap(),
    );
    let rho = sweep.dataset("rho").unwrap().read_raw::<f64>().unwrap();
    assert_eq!(rho, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
    for name in [
        "estimate",
        "standard_error",
        "interval_low",
        "interval_high",
        "bias",
        "bias_uncertainty",
    ] {
        let of_sweep = sweep
            .dataset(name)
            .unwrap()
            .read::<f64, ndarray::Ix3>()
            .unwrap();
        let of_run = run.dataset(name).unwrap().read_raw::<f64>().unwrap();
        for (s, value) in of_run.iter().enumerate() {
            let there = of_sweep[[2, 1, s]];
            assert!(
                there.to_bits() == value.to_bits() || (there.is_nan() && value.is_nan()),
                "{name} {s}"
            );
        }
    }
}

#[test]
fn show_repeats_a_sweep_and_csv_has_a_line_per_statistic() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    let printed = sweep(here, &["-o", "s.h5", "--threads", "1"]);
    let shown = mc(here, &["show", "s.h5"]);
    done(&shown);
    assert_eq!(out(&shown), out(&printed));
    assert_eq!(
        out(&mc(here, &["show", "s.h5", "--json"])),
        out(&sweep(here, &["-o", "s.h5", "--json"]))
    );
    done(&mc(
        here,
        &["run", SCENARIO, "--paths", "300", "-o", "run.h5"],
    ));
    let csv = out(&mc(here, &["show", "s.h5", "run.h5", "--format", "csv"]));
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 1 + 21 * 7);
    assert!(
        lines[0].starts_with("file,temperature.noise.intensity,statistic,estimate,standard_error,"),
        "{}",
        lines[0]
    );
    assert!(
        lines[1].starts_with("s.h5,0.1,stick_duration_mean,") && lines[127].starts_with("run.h5,,"),
        "{csv}"
    );
    let refused = mc(here, &["show", "s.h5", "run.h5"]);
    assert_eq!(refused.status.code(), Some(2), "{}", out(&refused));
}

/// Two equal scenes with different seeds must not differ by more than 1.96 combined errors. This
/// fails by chance for one pair of seeds in twenty; with these seeds it holds.
#[test]
fn show_puts_several_runs_beside_each_other() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    for (name, seed, rho) in [
        ("a.h5", "1", "0.25"),
        ("b.h5", "2", "0.25"),
        ("c.h5", "1", "0.5"),
    ] {
        let set = format!("temperature.noise.intensity={rho}");
        done(&mc(
            here,
            &[
                "run", SCENARIO, "--paths", "2000", "--seed", seed, "--set", &set, "-o", name,
            ],
        ));
    }
    let table = out(&mc(here, &["show", "a.h5", "b.h5", "c.h5"]));
    let row = table
        .lines()
        .find(|line| line.starts_with("sticking_fraction"))
        .expect("a row");
    let cells: Vec<&str> = row.split_whitespace().skip(1).collect();
    assert_eq!(
        (
            cells.len(),
            cells.iter().filter(|cell| **cell == "*").count()
        ),
        (11, 1),
        "{table}"
    );
    let legend = table.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(legend.contains("a and c have the same seed"), "{table}");
}

/// A block on a level floor that slides at mu g = 0.2 g, and records of one rectangular pulse of
/// 0.4 s: `name` with this acceleration in g, and this time of the last sample.
fn pulses(here: &Path, records: &[(&str, f64, f64)]) {
    let block = "oscillator = { mass = 1000, stiffness = 0, dilatation = 0 }
friction = { static = 1961.33, dynamic = 1961.33 }
force.expression = \"-m*ag\"
parameters = { m = 1000 }
input.ag = { file = \"a.csv\", unit = \"g\" }
initial.displacement = 0
scheme.kind = \"event-driven\"
ensemble.paths = 1
";
    fs::write(here.join("block.toml"), block).expect("room");
    for (name, pulse, end) in records {
        let text = format!("time_s,ag\n0,{pulse}\n0.4,{pulse}\n0.4000001,0\n{end},0\n");
        fs::write(here.join(name), text).expect("room");
    }
}

const OF_SLIP: [&str; 2] = ["--statistic", "displacement_end_mean"];

/// The slip of a rectangular pulse of the acceleration A and the duration T at the yield
/// acceleration a (Newmark, 1965): A T^2 (A/a - 1)/2.
fn newmark(pulse: f64) -> f64 {
    pulse * 9.80665 * 0.4 * 0.4 * (pulse / 0.2 - 1.0) / 2.0
}

fn slips(path: &Path) -> Vec<f64> {
    let file = File::open(path).expect("an HDF5 file");
    let names = file.dataset("statistic").expect("statistics");
    let names = names.read_raw::<VarLenUnicode>().expect("names");
    let at = names.iter().position(|name| name.as_str() == OF_SLIP[1]);
    let estimates = file.dataset("estimate").expect("estimates");
    let estimates = estimates.read_2d::<f64>().expect("two dimensions");
    estimates.column(at.expect("the statistic")).to_vec()
}

#[test]
fn each_record_of_a_sweep_has_its_own_slip_and_end() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    pulses(
        here,
        &[
            ("a.csv", 0.5, 3.0),
            ("b.csv", 0.3, 2.0),
            ("c.csv", 0.1, 4.0),
        ],
    );
    let vary = ["--vary", "record=input.ag.file=a.csv,b.csv,c.csv"];
    let swept = mc(
        here,
        &[&["sweep", "block.toml", "-o", "s.h5"][..], &vary, &OF_SLIP].concat(),
    );
    done(&swept);
    let table = out(&swept);
    let rows = table.lines().filter(|line| line.contains(".csv "));
    assert_eq!(rows.count(), 3, "{table}");
    let found = slips(&here.join("s.h5"));
    for (slip, pulse) in found.iter().zip([0.5, 0.3]) {
        assert!(
            (slip + newmark(pulse)).abs() < 1e-6,
            "{slip} {}",
            newmark(pulse)
        );
    }
    assert_eq!(found[2], 0.0, "the pulse is weaker than friction");
    let ends =
        File::open(here.join("s.h5")).and_then(|file| file.dataset("point_end")?.read_raw::<f64>());
    assert_eq!(ends.expect("ends"), [3.0, 2.0, 4.0]);

    // The file is complete: its records are not needed any more.
    let before = [here.join("a.csv"), here.join("b.csv"), here.join("c.csv")];
    before
        .iter()
        .for_each(|path| fs::remove_file(path).expect("a file"));
    let again = mc(here, &["verify", "s.h5", "--again"]);
    done(&again);
    assert!(
        out(&again).contains("identical, bit for bit"),
        "{}",
        out(&again)
    );
    done(&mc(
        here,
        &["plot", "s.h5", OF_SLIP[0], OF_SLIP[1], "-o", "s.svg"],
    ));
    let svg = fs::read_to_string(here.join("s.svg")).expect("a picture");
    assert!(svg.contains("<svg"));
    let csv = out(&mc(here, &["show", "s.h5", "--format", "csv"]));
    assert!(
        csv.contains("s.h5,b.csv,displacement_end_mean,-0.1176"),
        "{csv}"
    );
    let json = out(&mc(here, &["show", "s.h5", "--json"]));
    assert!(json.contains("\"a.csv\""), "{json}");
}

#[test]
fn a_sweep_over_records_goes_on_only_with_the_same_samples() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    pulses(here, &[("a.csv", 0.5, 3.0), ("b.csv", 0.3, 2.0)]);
    let vary = [
        "sweep",
        "block.toml",
        "--vary",
        "input.ag.file=a.csv,b.csv",
        "-o",
        "s.h5",
    ];
    done(&mc(here, &vary));
    // What an interrupted sweep leaves behind is continued.
    leave(here, "s.h5");
    let again = mc(here, &vary);
    done(&again);
    assert!(
        err(&again).contains("continuing: 2 of 2 points"),
        "{}",
        err(&again)
    );
    pulses(here, &[("b.csv", 0.35, 2.0)]);
    let refused = mc(here, &vary);
    assert_eq!(refused.status.code(), Some(2), "{}", err(&refused));
    assert!(
        err(&refused).contains("`input.ag.file=b.csv with hash"),
        "{}",
        err(&refused)
    );
}

#[test]
fn records_zip_with_numbers_and_are_checked_first() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let here = folder.path();
    pulses(here, &[("a.csv", 0.5, 3.0), ("b.csv", 0.3, 2.0)]);
    let zipped = [
        "--zip",
        "--vary",
        "mu=friction.dynamic=1961.33,980.665",
        "-o",
        "s.h5",
    ];
    let vary = ["sweep", "block.toml", "--vary", "input.ag.file=a.csv,b.csv"];
    done(&mc(here, &[&vary[..], &zipped].concat()));
    // At f_d = m g/10, b slides as at the yield acceleration 0.1 g, once 0.2 g has set it in motion.
    let weaker = 0.3 * 9.80665 * 0.16 * (0.3 / 0.1 - 1.0) / 2.0;
    let found = slips(&here.join("s.h5"));
    assert!(
        (found[0] + newmark(0.5)).abs() < 1e-6 && (found[1] + weaker).abs() < 1e-6,
        "{found:?}"
    );

    let refused = |more: &[&str], said: &[&str]| {
        let refused = mc(
            here,
            &[&["sweep", "block.toml", "-o", "t.h5"], more].concat(),
        );
        assert_eq!(refused.status.code(), Some(2), "{}", err(&refused));
        for said in said {
            assert!(err(&refused).contains(said), "{said}: {}", err(&refused));
        }
        assert!(!here.join("t.h5").exists() && !here.join("t.h5.partial").exists());
    };
    let missing = ["c.csv", "`input.ag.file`", "No such file", "fix: "];
    refused(&["--vary", "input.ag.file=a.csv,c.csv"], &missing);
    let short = [
        "beyond the last sample of the input `ag` (b.csv), at 2.0",
        "fix: ",
    ];
    refused(
        &["--vary", "input.ag.file=a.csv,b.csv", "--until", "2.5"],
        &short,
    );
    refused(&["--vary", "input.ag.file=a.csv,a.csv"], &["listed twice"]);
}
