//! A run that is cut into parts and joined again gives the same file as the whole run, byte for
//! byte. Parts that do not belong together are refused by name.

use crate::command::{self, RHO025, SCENE};
use crate::edit::edited;
use std::fs;
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

fn mc(folder: &TempDir, arguments: &[&str]) -> Output {
    command::mc(folder.path(), arguments)
}

#[track_caller]
fn done(folder: &TempDir, arguments: &[&str]) {
    let output = mc(folder, arguments);
    assert!(
        output.status.success(),
        "mc {}: {}",
        arguments.join(" "),
        text(&output.stderr)
    );
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn run(more: &[&'static str]) -> Vec<&'static str> {
    [SCENE, more].concat()
}

/// Makes all parts of a run, in files p1.h5, p2.h5 and so on.
fn parts(here: &TempDir, scene: &[&str], of: usize) -> Vec<String> {
    let make = |number: usize| {
        let (part, file) = (format!("{number}/{of}"), format!("p{number}.h5"));
        done(here, &[scene, &["--part", &part, "-o", &file]].concat());
        file
    };
    (1..=of).map(make).collect()
}

fn merged(here: &TempDir, files: &[String]) -> Output {
    let mut arguments = vec!["merge"];
    arguments.extend(files.iter().map(String::as_str));
    arguments.extend(["-o", "all.h5", "--quiet", "--force"]);
    mc(here, &arguments)
}

#[test]
fn parts_in_any_number_and_order_come_to_the_file_of_the_run() {
    for more in [
        &[][..],
        &["--scheme", "event-driven", "--set", "record.paths=false"],
        &["--set", "ensemble.antithetic=true"],
    ] {
        let here = folder();
        let scene: Vec<&str> = SCENE
            .iter()
            .copied()
            .filter(|word| more.is_empty() || !["--step", "0.05"].contains(word))
            .collect();
        let scene = [&scene, more].concat();
        done(&here, &[&scene[..], &["-o", "whole.h5"]].concat());
        let whole = fs::read(here.path().join("whole.h5")).expect("written");
        for of in [1, 2, 5, 12] {
            let mut files = parts(&here, &scene, of);
            files.rotate_left(of / 2);
            files.swap(0, of - 1);
            let output = merged(&here, &files);
            assert!(output.status.success(), "{}", text(&output.stderr));
            let all = fs::read(here.path().join("all.h5")).expect("written");
            assert!(all == whole, "{of} parts, {more:?}");
            files
                .iter()
                .for_each(|file| fs::remove_file(here.path().join(file)).expect("there"));
        }
    }
}

#[test]
fn parts_merge_without_records_of_single_paths() {
    let here = folder();
    let scene = [
        SCENE,
        &[
            "--set",
            "record.paths=false",
            "--set",
            "record.events=false",
            "--set",
            "record.trajectories=0",
        ],
    ]
    .concat();
    done(&here, &[&scene[..], &["-o", "whole.h5"]].concat());
    let files = parts(&here, &scene, 3);
    assert!(merged(&here, &files).status.success());
    assert!(
        fs::read(here.path().join("whole.h5")).unwrap()
            == fs::read(here.path().join("all.h5")).unwrap()
    );
}

#[test]
fn a_part_can_be_shown_and_continued() {
    let here = folder();
    let long = [
        "run", RHO025, "--step", "0.01", "--paths", "120000", "--quiet",
    ];
    let part = [&long[..], &["--part", "2/2", "-o", "p2.h5"]].concat();
    let mut running = command::Running::mc(here.path(), &part);
    running.until("it is saved", || {
        here.path().join("p2.h5.partial/state").exists()
    });
    running.signal("TERM");
    assert_eq!(running.end().status.code(), Some(143));
    done(
        &here,
        &[&long[..], &["--part", "1/2", "-o", "p1.h5"]].concat(),
    );
    let unfinished = merged(&here, &["p1.h5".into(), "p2.h5".into()]);
    assert_eq!(unfinished.status.code(), Some(2));
    assert!(
        text(&unfinished.stderr).contains("mc resume p2.h5"),
        "{}",
        text(&unfinished.stderr)
    );
    assert!(text(&mc(&here, &["show", "p2.h5"]).stdout).contains("stick_duration_mean"));
    done(&here, &["resume", "p2.h5", "--quiet"]);
    let shown = text(&mc(&here, &["show", "p2.h5"]).stdout);
    assert!(
        shown.contains("60 096 of 120 000 completed: part 2/2"),
        "{shown}"
    );
    assert!(
        merged(&here, &["p1.h5".into(), "p2.h5".into()])
            .status
            .success()
    );
    done(&here, &[&long[..], &["-o", "whole.h5"]].concat());
    assert!(
        fs::read(here.path().join("whole.h5")).unwrap()
            == fs::read(here.path().join("all.h5")).unwrap()
    );
}

#[test]
fn parts_that_do_not_go_together_are_named() {
    let here = folder();
    let files = parts(&here, SCENE, 4);
    done(
        &here,
        &run(&["--seed", "9", "--part", "2/4", "-o", "foreign.h5"]),
    );
    done(&here, &run(&["--part", "2/3", "-o", "cut.h5"]));
    done(&here, &run(&["-o", "whole.h5"]));
    fs::copy(here.path().join("p2.h5"), here.path().join("again.h5")).expect("copied");
    fs::write(here.path().join("text.h5"), "not HDF5").expect("written");
    let with = |second: &str| -> Vec<String> {
        files
            .iter()
            .map(|file| {
                if file == "p2.h5" {
                    second.to_string()
                } else {
                    file.clone()
                }
            })
            .collect()
    };
    let more = |file: &str| [&files[..], &[file.to_string()]].concat();
    for (given, named) in [
        (files[..2].to_vec(), vec!["part 3/4, 4/4"]),
        (more("again.h5"), vec!["p2.h5", "again.h5", "2/4"]),
        (
            with("foreign.h5"),
            vec!["foreign.h5", "seed = 9", "seed = 1"],
        ),
        (with("cut.h5"), vec!["cut.h5", "one of 3 parts, not 4"]),
        (with("whole.h5"), vec!["whole.h5", "complete"]),
        (with("text.h5"), vec!["text.h5", "not an HDF5 file"]),
        (with("nothing.h5"), vec!["nothing.h5", "No such file"]),
    ] {
        let output = merged(&here, &given);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{given:?}: {said}");
        assert!(
            named.iter().all(|name| said.contains(name)),
            "{named:?}: {said}"
        );
        assert!(!here.path().join("all.h5").exists());
    }
    // A part is an input of the merge, so it is not overwritten, even with `--force`.
    let output = mc(
        &here,
        &[
            "merge", "p1.h5", "p2.h5", "p3.h5", "p4.h5", "-o", "p4.h5", "--force",
        ],
    );
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
}

/// A number that was changed in the rows of a part is noticed, although the HDF5 file is valid.
#[test]
fn rows_of_a_part_that_were_changed_are_not_joined() {
    let here = folder();
    let files = parts(&here, SCENE, 2);
    edited(&here.path().join("p2.h5"), |file| {
        let rows = file.dataset("path_stick_time").expect("recorded");
        let mut values: Vec<f64> = rows.read_raw().expect("read");
        values[700] += 1e-9;
        rows.write_raw(&values).expect("written");
    });
    let output = merged(&here, &files);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("p2.h5")
            && text(&output.stderr).contains("differ from those that were written")
    );
    assert!(!here.path().join("all.h5").exists());
}

#[test]
fn options_of_the_whole_run_are_refused_for_a_part() {
    let here = folder();
    let cases = [
        (
            vec!["--until", "stick_duration_mean < 1%"],
            "all parts together",
        ),
        (vec!["--accuracy", "1%"], "make its own choice"),
        (vec!["--max-time", "1h"], "cannot be merged"),
    ];
    for (flags, reason) in cases {
        let output = mc(
            &here,
            &[&["run", RHO025, "--part", "1/2"], flags.as_slice()].concat(),
        );
        assert_eq!(output.status.code(), Some(2), "{flags:?}");
        assert!(
            text(&output.stderr).contains(reason),
            "{flags:?}: {}",
            text(&output.stderr)
        );
    }
    let output = mc(&here, &["run", RHO025, "--paths", "1000", "--part", "1/5"]);
    assert!(
        text(&output.stderr).contains("at most 4 parts"),
        "{}",
        text(&output.stderr)
    );
    for wrong in ["0/4", "5/4", "3", "a/b"] {
        assert_eq!(
            mc(&here, &["run", RHO025, "--part", wrong]).status.code(),
            Some(2),
            "{wrong}"
        );
    }
}

/// A folder with the command as `mc` and the scenario, and the shell code of docs/long-runs.md that
/// begins like this.
fn of_the_page(beginning: &str) -> (TempDir, String) {
    let page =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/long-runs.md"))
            .expect("a page");
    let code = page
        .split("```sh\n")
        .find(|piece| piece.starts_with(beginning))
        .and_then(|piece| piece.split("```").next());
    let here = folder();
    fs::write(
        here.path().join("mc"),
        format!(
            "#!/bin/sh\nexec '{}' \"$@\"\n",
            assert_cmd::cargo::cargo_bin!("mc").display()
        ),
    )
    .expect("written");
    fs::copy(RHO025, here.path().join("rho025.toml")).expect("copied");
    (here, code.expect("code").to_string())
}

/// The job array of the documentation, with a substitute for the scheduler: a loop that sets the
/// variable that Slurm sets. One task is killed and continued as the page says.
#[test]
fn the_job_array_of_the_documentation_runs() {
    let (here, script) = of_the_page("#!/bin/sh\n");
    fs::write(
        here.path().join("array.sh"),
        script.replace("--paths 100000000", "--paths 5000"),
    )
    .expect("written");
    let line = "chmod +x mc; PATH=$PWD:$PATH; export PATH
        task() { SLURM_ARRAY_TASK_ID=$1 SLURM_ARRAY_TASK_COUNT=16 SLURM_CPUS_PER_TASK=1 sh array.sh; }
        for i in $(seq 1 16); do task $i || exit 1; done
        rm part-07.h5; task 7 || exit 1  # a task that failed is submitted again
        task 3 || exit 1                 # and one that had not is done at once
        mc merge part-*.h5 -o all.h5 --quiet && mc run rho025.toml --paths 5000 -o whole.h5 --quiet && cmp all.h5 whole.h5";
    let output = command::shell(here.path(), line);
    assert!(
        output.status.success(),
        "{}{}",
        text(&output.stdout),
        text(&output.stderr)
    );
}

/// The line for xargs comes to the file of the run.
#[test]
fn the_line_for_xargs_in_the_documentation_runs() {
    let (here, line) = of_the_page("seq ");
    let line = format!(
        "chmod +x mc; PATH=$PWD:$PATH; export PATH
        {} || exit 1
        mc merge part-*.h5 -o all.h5 --quiet && mc run rho025.toml --paths 5000 -o whole.h5 --quiet && cmp all.h5 whole.h5",
        line.trim().replace("--paths 1000000", "--paths 5000")
    );
    let output = command::shell(here.path(), &line);
    assert!(
        output.status.success(),
        "{}{}",
        text(&output.stdout),
        text(&output.stderr)
    );
}
