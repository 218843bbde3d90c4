//! `mc run`, `mc show` and `mc replay` as a user meets them: the command, its output, its files.

use crate::command::{self, Running};
use crate::reference;
use serde_json::Value;
use std::process::Output;
use std::time::Duration;
use stickslip::engine::Status;
use stickslip_files::store;
use tempfile::TempDir;

const RHO025: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/rho025.toml");

fn mc(folder: &TempDir, arguments: &[&str]) -> Output {
    command::mc(folder.path(), arguments)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON object and nothing else")
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

#[test]
fn a_run_prints_a_table_and_leaves_a_file_of_the_scenarios_name() {
    let here = folder();
    let output = mc(&here, &["run", RHO025, "--paths", "300"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    for expected in [
        "stick_duration_mean",
        "95 % from",
        "300 of 300 completed in",
        "rho025.h5",
    ] {
        assert!(table.contains(expected), "{expected} in\n{table}");
    }
    let stored = store::read(&here.path().join("rho025.h5")).expect("readable");
    assert_eq!(
        (stored.status, stored.completed_paths),
        (Status::Complete, 300)
    );
    assert!(!here.path().join("rho025.h5.partial").exists());

    let shown = text(&mc(&here, &["show", "rho025.h5"]).stdout);
    for line in table
        .lines()
        .filter(|line| line.contains("_mean") || line.contains("_sd"))
    {
        assert!(shown.contains(line), "{line} in\n{shown}");
    }
    let all = text(&mc(&here, &["show", "rho025.h5", "--all", "--notes"]).stdout);
    for expected in [
        "xoshiro256+",
        "[oscillator]",
        "still running",
        "friction_work_mean",
    ] {
        assert!(
            all.contains(expected) && !shown.contains(expected),
            "{expected} in\n{all}"
        );
    }

    let again = mc(&here, &["run", RHO025, "--paths", "300"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("--force"));
    assert!(
        mc(
            &here,
            &["run", RHO025, "--paths", "300", "--force", "--quiet"]
        )
        .status
        .success()
    );
}

#[test]
fn json_is_the_only_output_for_any_number_of_threads() {
    let here = folder();
    let run = |threads: &str| {
        let file = format!("{threads}.h5");
        json(&mc(
            &here,
            &[
                "run",
                RHO025,
                "--paths",
                "800",
                "--seed",
                "9",
                "--json",
                "--threads",
                threads,
                "-o",
                &file,
            ],
        ))
    };
    let one = run("1");
    for key in [
        "scenario",
        "scheme",
        "step",
        "seed",
        "paths",
        "completed_paths",
        "diverged_paths",
        "threads",
        "seconds",
        "ns_per_path_step",
        "us_per_path",
        "file",
    ] {
        assert!(one.get(key).is_some(), "{key} in {one}");
    }
    assert_eq!(
        (
            one["paths"].as_u64(),
            one["seed"].as_u64(),
            one["diverged_paths"].as_u64()
        ),
        (Some(800), Some(9), Some(0))
    );
    assert_eq!(
        one["statistics"].as_object().map(serde_json::Map::len),
        Some(21)
    );
    let mean = &one["statistics"]["stick_duration_mean"];
    let number = |key: &str| mean[key].as_f64().expect("a number");
    assert!(
        number("low") < number("estimate")
            && number("estimate") < number("high")
            && number("standard_error") > 0.0
    );
    assert!(
        number("bias_uncertainty") > 0.0 && (0.0..0.25).contains(&number("bias")),
        "{mean}"
    );
    let without = json(&mc(
        &here,
        &[
            "run",
            RHO025,
            "--paths",
            "800",
            "--seed",
            "9",
            "--json",
            "--no-bias",
            "-o",
            "no.h5",
        ],
    ));
    for key in ["bias", "bias_uncertainty", "bias_order"] {
        assert!(
            without["statistics"]["stick_duration_mean"][key].is_null(),
            "{key}"
        );
    }
    assert_eq!(
        without["statistics"]["stick_duration_mean"]["estimate"],
        mean["estimate"]
    );
    for threads in ["2", "3", "8"] {
        assert_eq!(
            run(threads)["statistics"],
            one["statistics"],
            "{threads} threads"
        );
    }
    let shown = json(&mc(&here, &["show", "3.h5", "--json"]));
    assert_eq!(shown["statistics"], one["statistics"]);
}

#[test]
fn a_run_reports_the_bias_of_the_step_or_why_not() {
    let here = folder();
    let run = |arguments: &[&str]| {
        mc(
            &here,
            &[&["run", RHO025, "--step", "0.02", "--force"], arguments].concat(),
        )
    };
    let reported = run(&["--paths", "10000"]);
    // The warning with the measured bias replaces the estimate before the run.
    let (out, err) = (text(&reported.stdout), text(&reported.stderr));
    assert!(
        out.contains("corrected") && out.contains("of the step"),
        "{out}"
    );
    assert!(
        out.contains("of the step exceeds") && !err.contains("roughly"),
        "{out}{err}"
    );
    // Without a table, it is a warning.
    let quiet = run(&["--paths", "10000", "--quiet"]);
    assert!(text(&quiet.stderr).contains("warning: bias of the step exceeds"));
    let shown = mc(&here, &["show", "rho025.h5"]);
    assert!(text(&shown.stdout).contains("of the step exceeds"));
    assert_eq!(
        text(&shown.stdout).lines().nth(3),
        out.lines().nth(3),
        "the same headings"
    );
    let few = run(&["--paths", "300"]);
    assert!(
        text(&few.stdout).contains("not estimated: at least 768 paths are needed"),
        "{}",
        text(&few.stdout)
    );
    assert!(text(&few.stderr).contains("roughly"));
    // 800 paths of 600 steps, with two rows, do not pay for 32 event-driven paths.
    let little = [
        "--paths",
        "800",
        "--step",
        "0.1",
        "--set",
        "time.output_step=60",
        "--scheme",
        "corrected-vi",
    ];
    let few = mc(&here, &[&["run", RHO025, "--force"], &little[..]].concat());
    assert!(
        text(&few.stdout).contains("not estimated: the error of corrected-vi"),
        "{}",
        text(&few.stdout)
    );
    let reported = run(&["--paths", "10000", "--scheme", "corrected-vi"]);
    assert!(
        text(&reported.stdout).contains("of the step"),
        "{}",
        text(&reported.stdout)
    );
    assert!(
        !text(&reported.stderr).contains("roughly"),
        "{}",
        text(&reported.stderr)
    );
    let unbroken = |printed: &[u8]| {
        text(printed)
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
    };
    let reasons = [
        (
            "event-driven",
            "not estimated: this scheme has no time step; its tolerance keeps the relative discretisation error of \
             every statistic that has a limit below 0.001",
        ),
        (
            "quasi-static",
            "not estimated: this scheme takes the forcing as constant during a slip",
        ),
    ];
    for (scheme, reason) in reasons {
        let silent = mc(
            &here,
            &[
                "run", RHO025, "--scheme", scheme, "--paths", "800", "--force",
            ],
        );
        assert!(
            unbroken(&silent.stdout).contains(reason),
            "{}",
            text(&silent.stdout)
        );
        let shown = mc(&here, &["show", "rho025.h5"]);
        assert!(
            unbroken(&shown.stdout).contains(reason),
            "{}",
            text(&shown.stdout)
        );
    }
    let without = run(&["--paths", "400", "--no-bias"]);
    assert!(text(&without.stderr).contains("roughly") && !text(&without.stdout).contains("bias"));
}

#[test]
fn what_does_not_exist_is_null_and_not_zero() {
    let here = folder();
    let scenario = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenarios/never-slips.toml"
    );
    let run = json(&mc(&here, &["run", scenario, "--paths", "4", "--json"]));
    assert!(run["statistics"]["stick_duration_mean"]["estimate"].is_null());
    assert_eq!(
        run["statistics"]["sticks_per_path"]["estimate"].as_f64(),
        Some(0.0)
    );
    assert_eq!(
        run["statistics"]["sticking_fraction"]["estimate"].as_f64(),
        Some(1.0)
    );
    assert_eq!(run["sticks"]["first_censored"].as_u64(), Some(4));
}

#[test]
fn the_stored_scenario_gives_the_same_results() {
    let here = folder();
    let first = json(&mc(
        &here,
        &[
            "run",
            RHO025,
            "--paths",
            "64",
            "--set",
            "friction.static=1.3",
            "--json",
            "-o",
            "a.h5",
        ],
    ));
    let stored = store::read(&here.path().join("a.h5")).expect("readable");
    std::fs::write(here.path().join("again.toml"), stored.header.scenario_text).expect("written");
    let second = json(&mc(&here, &["run", "again.toml", "--json"]));
    assert_eq!(first["statistics"], second["statistics"]);
}

#[test]
fn one_path_can_be_replayed_from_a_file() {
    let here = folder();
    let run = json(&mc(
        &here,
        &[
            "run",
            RHO025,
            "--paths",
            "20",
            "--set",
            "record.events=true",
            "--json",
            "-o",
            "all.h5",
        ],
    ));
    assert_eq!(run["completed_paths"].as_u64(), Some(20));
    let output = mc(&here, &["replay", "all.h5", "--path", "7"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(
        text(&output.stdout)
            .lines()
            .filter(|line| line.contains("stick"))
            .count()
            > 5
    );
    assert!(here.path().join("all-path-7.h5").exists());
    let refused = mc(&here, &["replay", "all.h5", "--path", "20"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("0 to 19"));
}

/// A limit on the size of files has the effect of a full disk, and every user can set it. At the
/// first page, and while rows are appended, the result is one error with the name of the file that
/// is left, and no file under the final name. The shell ignores the signal that comes with the
/// error, because it would end the process.
#[test]
fn a_file_size_limit_is_an_error_without_a_crash() {
    let here = folder();
    let run = format!(
        "run {RHO025} --paths 2000 --step 0.05 --quiet --force --set record.events=true -o run.h5"
    );
    assert!(
        command::shell(here.path(), &format!("exec \"$0\" {run}"))
            .status
            .success()
    );
    let bytes = std::fs::metadata(here.path().join("run.h5"))
        .expect("written")
        .len();
    std::fs::remove_file(here.path().join("run.h5")).expect("removed");
    // The limit is in blocks of 512 bytes. A shell that counts in blocks of 1024 bytes allows twice
    // as much.
    for blocks in [2, 16, bytes / 512 / 4, bytes / 512 / 2 - 8] {
        let output = command::shell(
            here.path(),
            &format!("trap '' XFSZ; ulimit -f {blocks} && exec \"$0\" {run}"),
        );
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{blocks} blocks: {said}");
        assert!(
            said.contains("run.h5.partial") && said.contains("File too large"),
            "{blocks} blocks: {said}"
        );
        assert!(!here.path().join("run.h5").exists());
    }
}

#[test]
fn diverged_paths_are_announced() {
    let here = folder();
    let scenario = "[oscillator]\nmass = 1\nstiffness = 1\ndilatation = 6\n[friction]\nstatic = 0.01\ndynamic = 0.01\n[temperature]\nharmonics = []\n[initial]\ndisplacement = 5\n[time]\nend = 4000\nstep = 0.02\noutput_step = 1000\n";
    std::fs::write(here.path().join("grows.toml"), scenario).expect("written");
    let output = mc(&here, &["run", "grows.toml", "--paths", "2", "--json"]);
    let printed: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(printed["diverged_paths"].as_u64(), Some(2));
    assert!(printed["statistics"]["displacement_end_mean"]["estimate"].is_null());
    // The run has failed and says what to do.
    assert_eq!(output.status.code(), Some(1));
    assert!(
        text(&output.stderr).contains("every path diverged")
            && text(&output.stderr).contains("smaller step")
    );
}

/// A file of others with the name of the folder in which results are made is not overwritten, even
/// with --force.
#[test]
fn a_leftover_is_not_lost_silently() {
    let here = folder();
    std::fs::write(here.path().join("rho025.h5.partial"), "of a sweep").expect("written");
    for force in [&[][..], &["--force"]] {
        let refused = mc(&here, &[&["run", RHO025, "--paths", "10"], force].concat());
        assert_eq!(refused.status.code(), Some(2), "{}", text(&refused.stderr));
        assert!(text(&refused.stderr).contains("rho025.h5.partial"));
    }
    assert_eq!(
        std::fs::read(here.path().join("rho025.h5.partial")).expect("there"),
        b"of a sweep"
    );
}

/// The kernel that is used is printed, and so is every derived number.
#[test]
fn verbose_says_which_kernel_runs() {
    let here = folder();
    let output = mc(&here, &["run", RHO025, "--paths", "10", "--verbose"]);
    let widest = stickslip::lanes::InstructionSet::detect().name();
    assert!(
        text(&output.stderr).contains(&format!("kernel: {widest} lanes")),
        "{}",
        text(&output.stderr)
    );
}

const SCHEMES: [(&str, bool); 4] = [
    ("discrete-vi", true),
    ("corrected-vi", true),
    ("event-driven", false),
    ("quasi-static", false),
];

#[test]
fn every_scheme_runs_and_its_file_reproduces_the_run() {
    for (scheme, has_step) in SCHEMES {
        let here = folder();
        let first = json(&mc(
            &here,
            &[
                "run", RHO025, "--scheme", scheme, "--paths", "300", "--json", "-o", "a.h5",
            ],
        ));
        assert_eq!(
            (first["scheme"].as_str(), first["completed_paths"].as_u64()),
            (Some(scheme), Some(300))
        );
        assert_eq!(first["diverged_paths"].as_u64(), Some(0), "{scheme}");
        assert_eq!(first["step"].as_f64(), has_step.then_some(0.01), "{scheme}");
        assert_eq!(first["ns_per_path_step"].is_number(), has_step, "{scheme}");
        assert!(
            first["us_per_path"].is_number()
                && first["statistics"]["sticks_per_path"]["estimate"].is_number()
        );
        let stored = store::read(&here.path().join("a.h5")).expect("readable");
        assert_eq!(
            (stored.header.scheme.as_str(), stored.header.step),
            (scheme, has_step.then_some(0.01))
        );
        std::fs::write(here.path().join("again.toml"), stored.header.scenario_text)
            .expect("written");
        let second = json(&mc(
            &here,
            &["run", "again.toml", "--json", "--threads", "1"],
        ));
        assert_eq!(first["statistics"], second["statistics"], "{scheme}");
        let shown = json(&mc(&here, &["show", "a.h5", "--json"]));
        assert_eq!(
            (&shown["step"], &shown["scheme"]),
            (&first["step"], &first["scheme"])
        );
    }
}

/// The mean stick duration at zero step is that of another program (tests/reference/noisy.c, known
/// to 4e-4). Null hypothesis: the mean of the event-driven scheme equals it. With a step of h =
/// 0.005 the corrected scheme is known to be 5.2 % below it, and the plain one 16 % above it; both
/// offsets are known to two per cent. False-alarm rate: 6e-5 for each scheme, at four standard
/// errors.
#[test]
fn mean_stick_durations_are_where_each_scheme_puts_them() {
    let here = folder();
    for (scheme, expected, known_to) in [
        ("event-driven", 1.0, 0.001),
        ("corrected-vi", 0.948, 0.02),
        ("discrete-vi", 1.16, 0.02),
    ] {
        let step = if scheme == "event-driven" {
            &[][..]
        } else {
            &["--step", "0.005"]
        };
        let run = [
            "run", RHO025, "--scheme", scheme, "--paths", "4000", "--json", "--force",
        ];
        let run = json(&mc(&here, &[&run, step].concat()));
        let mean = &run["statistics"]["stick_duration_mean"];
        let number = |key: &str| {
            mean[key].as_f64().expect("a number") / reference::limit("stick_duration_mean").0
        };
        let off = (number("estimate") - expected).abs();
        assert!(
            off < known_to + 4.0 * number("standard_error"),
            "{scheme}: {mean}"
        );
    }
}

/// The events of a replay are those of the path in the ensemble, bit for bit, for every scheme.
#[test]
fn a_replay_is_the_same_path_for_every_scheme() {
    for (scheme, _) in SCHEMES {
        let here = folder();
        let run = [
            "run",
            RHO025,
            "--scheme",
            scheme,
            "--paths",
            "20",
            "--set",
            "record.events=true",
            "-o",
            "all.h5",
        ];
        assert!(mc(&here, &run).status.success());
        assert!(
            mc(&here, &["replay", "all.h5", "--path", "7", "-o", "one.h5"])
                .status
                .success()
        );
        let read = |file: &str| {
            let file = hdf5::File::open(here.path().join(file)).expect("readable");
            let counts = file
                .dataset("event_count")
                .and_then(|d| d.read_raw::<u32>())
                .expect("counts");
            let number = |name: &str| {
                file.dataset(name)
                    .and_then(|d| d.read_raw::<f64>())
                    .expect("numbers")
            };
            (
                counts,
                [
                    number("event_time"),
                    number("event_displacement"),
                    number("event_force"),
                ],
            )
        };
        let ((counts, all), (one_count, one)) = (read("all.h5"), read("one.h5"));
        let first: usize = counts[..7].iter().map(|n| *n as usize).sum();
        let last = first + counts[7] as usize;
        assert!(last > first && one_count == [counts[7]], "{scheme}");
        for (all, one) in all.iter().zip(&one) {
            assert_eq!(all[first..last], one[..], "{scheme}");
        }
    }
}

/// The trajectory of a path of ten million steps has at most ten thousand rows, and the file can
/// still be read as a scenario.
#[test]
fn a_replay_of_a_very_long_path_is_kept_within_bounds() {
    let here = folder();
    let fine = [
        "run",
        RHO025,
        "--step",
        "1e-5",
        "--until",
        "100",
        "--paths",
        "1",
        "--set",
        "time.output_step=10",
    ];
    assert!(
        mc(&here, &[&fine[..], &["-o", "fine.h5"]].concat())
            .status
            .success()
    );
    let output = mc(&here, &["replay", "fine.h5", "--path", "0", "-o", "one.h5"]);
    assert!(
        text(&output.stderr).contains("one in 1250 of the 10000000 steps"),
        "{}",
        text(&output.stderr)
    );
    let stored = store::read(&here.path().join("one.h5")).expect("readable");
    assert_eq!(stored.header.time.len(), 8001);
    assert!(
        mc(&here, &["replay", "one.h5", "--path", "0", "-o", "two.h5"])
            .status
            .success()
    );
}

#[test]
fn the_viaduct_runs() {
    let here = folder();
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/viaduct.toml");
    let run = json(&mc(&here, &["run", scenario, "--paths", "20", "--json"]));
    assert_eq!(
        (
            run["completed_paths"].as_u64(),
            run["diverged_paths"].as_u64()
        ),
        (Some(20), Some(0))
    );
    let fraction = run["statistics"]["sticking_fraction"]["estimate"]
        .as_f64()
        .expect("a number");
    assert!(
        fraction > 0.9999 && fraction < 1.0,
        "slips of 0.07 s in 300 days: {fraction}"
    );
}

/// If f_s = f_d under noise, the resolution is printed before the run.
#[test]
fn verbose_and_warnings_name_the_resolution() {
    let here = folder();
    let equal = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenarios/equal-friction.toml"
    );
    let output = mc(
        &here,
        &[
            "run",
            equal,
            "--scheme",
            "event-driven",
            "--paths",
            "2",
            "--until",
            "3",
            "--verbose",
        ],
    );
    let said = text(&output.stderr);
    for part in [
        "shortest slip resolved",
        "warning: f_s and f_d are equal",
        "lanes, macro step by macro step",
    ] {
        assert!(said.contains(part), "{part}\n{said}");
    }
}

/// With f_s = f_d and noise the number of sticks depends on the resolution, which is therefore in
/// the JSON and in the file.
#[test]
fn the_resolution_is_reported_where_results_depend_on_it() {
    let here = folder();
    let scenario = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenarios/equal-friction.toml"
    );
    let equal = json(&mc(
        &here,
        &[
            "run",
            scenario,
            "--scheme",
            "event-driven",
            "--paths",
            "4",
            "--json",
        ],
    ));
    let resolution = equal["resolution"].as_f64().expect("a number");
    assert!(resolution > 0.0 && resolution < 1e-3, "{resolution}");
    let stored = store::read(&here.path().join("equal-friction.h5")).expect("readable");
    assert_eq!(stored.header.resolution, Some(resolution));
    let ordinary = json(&mc(
        &here,
        &[
            "run",
            RHO025,
            "--scheme",
            "event-driven",
            "--paths",
            "4",
            "--json",
        ],
    ));
    assert!(ordinary["resolution"].is_null());
}

/// A goal ends a run after the first block, from the fourth on, at which it is reached; this is the
/// same block for any number of threads.
#[test]
fn a_goal_ends_a_run_at_the_first_block_that_reaches_it() {
    let here = folder();
    let run = |more: &[&str]| {
        json(&mc(
            &here,
            &[
                &["run", RHO025, "--step", "0.02", "--json", "--force"],
                more,
            ]
            .concat(),
        ))
    };
    let error = |run: &Value| {
        run["statistics"]["stick_duration_mean"]["standard_error"]
            .as_f64()
            .expect("a number")
    };
    let relative = |run: &Value| {
        error(run)
            / run["statistics"]["stick_duration_mean"]["estimate"]
                .as_f64()
                .expect("a number")
    };
    let goal = ["--until", "stick_duration_mean < 0.5%"];
    let ended = run(&[&goal[..], &["--threads", "1"]].concat());
    let shared = run(&[&goal[..], &["--threads", "2"]].concat());
    assert_eq!(ended["statistics"], shared["statistics"]);
    let paths = ended["completed_paths"].as_u64().expect("a number");
    assert!(paths > 4 * 256 && paths.is_multiple_of(256), "{paths}");
    let reported = format!("stick_duration_mean < 0.5%, after block {}", paths / 256);
    assert_eq!(
        (&ended["status"], &ended["ended_by"]),
        (&Value::from("ended"), &Value::from(reported.as_str()))
    );
    assert!(relative(&ended) < 0.005);
    assert!(text(&mc(&here, &["show", "rho025.h5"]).stdout).contains(&reported));

    let before = run(&["--paths", &(paths - 256).to_string()]);
    assert!(relative(&before) >= 0.005, "{}", relative(&before));
    let same = run(&["--paths", &paths.to_string()]);
    assert_eq!(same["statistics"], ended["statistics"]);

    // With too few paths the message says so, with a number that is enough.
    let capped = mc(
        &here,
        &[
            &[
                "run", RHO025, "--step", "0.02", "--force", "--quiet", "--paths", "600",
            ],
            &goal[..],
        ]
        .concat(),
    );
    assert!(capped.status.success());
    let said = text(&capped.stderr);
    let enough = said
        .split("try --paths ")
        .nth(1)
        .and_then(|rest| rest.split_whitespace().next())
        .expect("a number");
    assert!(relative(&run(&["--paths", enough])) < 0.005 * 1.1, "{said}");
}

#[test]
fn an_unreachable_goal_ends_a_run_and_keeps_its_file() {
    let here = folder();
    let never = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenarios/never-slips.toml"
    );
    let short = ["--step", "0.02", "--set", "record.paths=false", "--force"];
    for (scenario, goal, reason) in [
        (RHO025, "drift_velocity < 1%", "zero within its error"),
        (
            never,
            "stick_duration_mean < 1%",
            "does not exist after 16 384 paths",
        ),
    ] {
        let output = mc(
            &here,
            &[
                &["run", scenario, "-o", "kept.h5", "--until", goal],
                &short[..],
            ]
            .concat(),
        );
        assert_eq!(output.status.code(), Some(1));
        assert!(
            text(&output.stderr).contains(reason),
            "{}",
            text(&output.stderr)
        );
        let stored = store::read(&here.path().join("kept.h5")).expect("readable");
        assert_eq!(
            (stored.status, stored.completed_paths),
            (Status::Ended, 16_384)
        );
    }
    for (goal, remedy) in [
        ("stick < 1%", "one of stick_duration_mean"),
        ("jump_mean < -1%", "such as --until"),
    ] {
        let output = mc(&here, &["run", RHO025, "--until", goal]);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains(goal) && text(&output.stderr).contains(remedy));
    }
    let output = mc(&here, &["check", RHO025, "--until", "jump_mean < 1%"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_time_limit_ends_a_run_at_a_reproducible_block() {
    let here = folder();
    let common = [
        "run",
        RHO025,
        "--json",
        "--force",
        "--no-bias",
        "--set",
        "record.paths=false",
    ];
    let limited = json(&mc(
        &here,
        &[&common[..], &["--paths", "100000000", "--max-time", "0.3s"]].concat(),
    ));
    assert_eq!(limited["status"], "ended");
    assert!(
        limited["ended_by"]
            .as_str()
            .expect("said")
            .starts_with("time limit, after block ")
    );
    let paths = limited["completed_paths"].to_string();
    let again = json(&mc(&here, &[&common[..], &["--paths", &paths]].concat()));
    assert_eq!(
        (&again["statistics"], &again["status"]),
        (&limited["statistics"], &Value::from("complete"))
    );
    let output = mc(&here, &["run", RHO025, "--max-time", "soon"]);
    assert_eq!(output.status.code(), Some(2));
}

/// The command prints its choice of scheme, step or tolerance, and number of paths as options; the
/// run with these options is the one it made. Null hypothesis: its relative root mean square error
/// is at most 2 %, compared with the value of `tests/reference/noisy.c` (known to 4e-4), so that four
/// times as much is exceeded with a probability of 6e-5. That many runs of a choice have the error
/// that was asked for is tested in the engine.
#[test]
fn accuracy_runs_what_it_prints_as_its_choice() {
    let here = folder();
    let asked = [
        "--accuracy",
        "2%",
        "--statistic",
        "stick_duration_mean",
        "--json",
    ];
    let output = mc(&here, &[&["run", RHO025], &asked[..]].concat());
    let said = text(&output.stderr);
    let chosen = said
        .split("chosen for a relative error of 2 % of stick_duration_mean:\n")
        .nth(1)
        .expect("it says so");
    let chosen: Vec<&str> = chosen
        .lines()
        .next()
        .expect("a line")
        .split_whitespace()
        .collect();
    assert!(
        chosen.contains(&"--scheme") && chosen.contains(&"--paths"),
        "{said}"
    );
    let truth = reference::limit("stick_duration_mean").0;
    let mean = |run: &Value| {
        run["statistics"]["stick_duration_mean"]["estimate"]
            .as_f64()
            .expect("a number")
    };
    let first = mean(&json(&output));
    let flags = ["--json", "--force", "--no-bias"];
    let again = mc(&here, &[&["run", RHO025], &chosen[..], &flags].concat());
    assert_eq!(first, mean(&json(&again)));
    let error = first / truth - 1.0;
    assert!(error.abs() < 0.08, "{}: {error}", chosen.join(" "));
}

/// The arguments are refused before any pilot run.
#[test]
fn an_accuracy_that_is_none_or_is_decided_twice_is_refused() {
    let here = folder();
    for (wrong, says) in [
        (&["--accuracy", "2"][..], "from 1e-6 to 0.5"),
        (&["--accuracy", "-1%"], "from 1e-6 to 0.5"),
        (&["--accuracy", "fine"], "from 1e-6 to 0.5"),
        (
            &["--accuracy", "1%", "--paths", "5"],
            "which --paths 5 also sets",
        ),
        (
            &["--accuracy", "1%", "--scheme", "event-driven"],
            "which --scheme event-driven also sets",
        ),
        (
            &["--accuracy", "1%", "--set", "time.step=0.01"],
            "which --set time.step=0.01 also sets",
        ),
        (
            &[
                "--accuracy",
                "1%",
                "--set",
                "scheme={kind=\"event-driven\"}",
            ],
            "also sets",
        ),
        (
            &["--accuracy", "1%", "--until", "jump_mean < 1%"],
            "both set the number of paths",
        ),
        (
            &["--accuracy", "1%", "--statistic", "sticks"],
            "one of stick_duration_mean",
        ),
        (&["--statistic", "jump_mean"], "--accuracy"),
        (&["--max-time", "-1"], "must be a positive duration"),
    ] {
        let output = mc(&here, &[&["run", RHO025], wrong].concat());
        let said = text(&output.stderr);
        assert_eq!(
            (output.status.code(), said.contains(says)),
            (Some(2), true),
            "{wrong:?}: {said}"
        );
    }
    assert!(!here.path().join("rho025.h5").exists());
}

/// Without noise the pilot run is quick, the ensemble is one path, and statistics that are zero or
/// absent are named.
#[test]
fn accuracy_without_noise_takes_a_single_path() {
    let here = folder();
    let shaw = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shaw.toml");
    let run = |more: &[&str]| {
        mc(
            &here,
            &[&["run", shaw, "--force", "--accuracy", "0.1%"], more].concat(),
        )
    };
    let all = run(&["--json"]);
    let said = text(&all.stderr);
    for part in [
        "of 15 statistics:",
        "--paths 1\n",
        "the scenario is deterministic",
        "no accuracy is guaranteed for",
        "displacement_end_sd",
    ] {
        assert!(said.contains(part), "{part} in\n{said}");
    }
    // The reference is from 40-digit arithmetic.
    let first = json(&all)["statistics"]["first_stick_duration_mean"]["estimate"]
        .as_f64()
        .expect("a number");
    assert!((first / 2.574_004_435_173_1 - 1.0).abs() <= 1e-3, "{first}");
    for (more, says) in [
        (
            &["--statistic", "displacement_end_sd"][..],
            "displacement_end_sd: exactly zero",
        ),
        (
            &["--statistic", "drift_velocity", "--until", "20"],
            "drift_velocity: does not exist in this scenario",
        ),
        (&["--until", "0"], "`time.end` = 0"),
    ] {
        let output = run(more);
        let said = text(&output.stderr);
        assert_eq!(
            (output.status.code(), said.contains(says)),
            (Some(2), true),
            "{more:?}: {said}"
        );
    }
    let quiet = run(&["--quiet", "--until", "130"]);
    assert_eq!(
        (text(&quiet.stderr), quiet.status.code()),
        (String::new(), Some(0))
    );
}

/// Ctrl-C during the pilot run leaves a message and no file.
#[test]
fn an_interrupted_pilot_runs_nothing() {
    let here = folder();
    let (code, _, said) = interrupted(&here, &["run", RHO025, "--accuracy", "1%"], 0);
    assert_eq!(code, Some(130));
    assert!(said.contains("nothing was written"), "{said}");
    assert_eq!(std::fs::read_dir(here.path()).expect("there").count(), 0);
}

/// Ctrl-C during a trade leaves a table of what was measured, in which the rest is named as not
/// run, and the files that were asked for.
#[test]
fn an_interrupted_trade_prints_what_it_has() {
    let here = folder();
    let (code, table, said) = interrupted(
        &here,
        &["trade", RHO025, "--budget", "10m", "-o", "trade.h5"],
        1,
    );
    assert_eq!(code, Some(130), "{said}");
    for part in [
        "RMSE 1 %",
        "not run discrete-vi: the measurement ended",
        "event-driven, tolerance",
    ] {
        assert!(table.contains(part), "{part} in\n{table}");
    }
    for file in ["trade.h5", "trade.svg", "trade.png"] {
        assert!(here.path().join(file).exists(), "{file}");
    }
}

/// Exit code, standard output and standard error of a command that is sent Ctrl-C so many seconds
/// after it handles it: a trade needs one to have something to draw. How long it then takes to end
/// depends on the machine. A command that does not end is killed by the limit that every command has
/// here, which is half of the ten minutes that the trade would measure.
fn interrupted(
    folder: &TempDir,
    arguments: &[&str],
    seconds: u64,
) -> (Option<i32>, String, String) {
    let mut running = Running::mc(folder.path(), arguments);
    running.until_it_answers();
    std::thread::sleep(Duration::from_secs(seconds));
    running.interrupt();
    let output = running.end();
    (
        output.status.code(),
        text(&output.stdout),
        text(&output.stderr),
    )
}

/// If a time limit ends a run before its goal, the run says so.
#[test]
fn a_goal_that_the_time_limit_cuts_off_is_told() {
    let here = folder();
    let goal = [
        "--until",
        "stick_duration_mean < 0.00001",
        "--max-time",
        "0.1s",
        "--step",
        "0.02",
    ];
    let output = mc(&here, &[&["run", RHO025], &goal[..]].concat());
    let (out, said) = (text(&output.stdout), text(&output.stderr));
    assert!(
        output.status.success() && out.contains("ended by time limit"),
        "{out}{said}"
    );
    assert!(
        said.contains("stick_duration_mean < 1e-5 was not reached after")
            && said.contains("try --paths"),
        "{said}"
    );
    // The heading has the number of paths that were simulated, not the largest possible one.
    assert!(!out.contains("1 000 000 000"), "{out}");
}
