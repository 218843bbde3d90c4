//! Files of somebody else: what `mc` reads, and what it has not made, is not replaced, removed,
//! overwritten or waited for, whatever its name.

use crate::command::{done, mc, refused, shell, text};
use crate::shim::{failing, folders, shimmed};
use std::fs;
use std::os::unix::fs::{PermissionsExt as _, symlink};
use std::path::Path;
use tempfile::TempDir;

const RHO025: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/rho025.toml");

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// The arguments of a small run to this file.
fn run<'a>(output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    run_of("300", output, more)
}

fn run_of<'a>(paths: &'a str, output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let run = [
        "run", RHO025, "--paths", paths, "--step", "0.05", "--quiet", "-o", output,
    ];
    [&run[..], more].concat()
}

/// The names and the contents of all files, in folders as well.
fn everything(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let (path, name) = (entry.path(), entry.file_name().display().to_string());
        match entry.file_type().expect("known") {
            kind if kind.is_dir() => all.extend(everything(&path)),
            kind if kind.is_file() => all.push((name, fs::read(&path).expect("read"))),
            _ => all.push((name, Vec::new())),
        }
    }
    all.sort();
    all
}

/// The command is refused with these words, and changes nothing.
#[track_caller]
fn refused_untouched(here: &Path, arguments: &[&str], says: &[&str]) {
    let before = everything(here);
    let output = mc(here, arguments);
    let said = text(&output.stderr);
    assert!(
        matches!(output.status.code(), Some(1 | 2)),
        "mc {}: {said}",
        arguments.join(" ")
    );
    assert!(
        says.iter().all(|part| said.contains(part)),
        "mc {}: {said}",
        arguments.join(" ")
    );
    assert_eq!(everything(here), before, "mc {}", arguments.join(" "));
}

#[test]
fn a_measured_series_that_a_scenario_reads_is_not_overwritten() {
    let folder = folder();
    let here = folder.path();
    done(here, &["init", "--from", "bridge", "-o", "bridge.toml"]);
    let series: Vec<String> = everything(here).into_iter().map(|(name, _)| name).collect();
    let series = series
        .iter()
        .find(|name| name.ends_with(".csv"))
        .expect("the bridge has a measured temperature");
    let is_input = ["is an input of this command"];
    let vary = ["--vary", "friction.static=1e6,2e6"];
    refused_untouched(
        here,
        &["run", "bridge.toml", "-o", series, "--force"],
        &is_input,
    );
    refused_untouched(
        here,
        &[
            &["sweep", "bridge.toml"],
            &vary[..],
            &["-o", series, "--force"],
        ]
        .concat(),
        &is_input,
    );
    refused_untouched(
        here,
        &["trade", "bridge.toml", "-o", series, "--force"],
        &is_input,
    );
    refused_untouched(
        here,
        &["twin", "bridge.toml", "-o", series, "--force"],
        &is_input,
    );
    let named = format!("temperature.series.file={series}.svg");
    fs::copy(here.join(series), here.join(format!("{series}.svg"))).expect("copied");
    let picture = format!("{series}.svg");
    refused_untouched(
        here,
        &[
            "plot",
            "bridge.toml",
            "--set",
            &named,
            "-o",
            &picture,
            "--force",
        ],
        &is_input,
    );
    // A name that is taken for a moment, while the file is made.
    for ending in [".lock", ".partial"] {
        let taken = format!("a.h5{ending}");
        fs::copy(here.join(series), here.join(&taken)).expect("copied");
        let set = format!("temperature.series.file={taken}");
        refused_untouched(
            here,
            &["run", "bridge.toml", "--set", &set, "-o", "a.h5", "--force"],
            &[&taken, is_input[0]],
        );
        fs::remove_file(here.join(&taken)).expect("removed");
    }
}

#[test]
fn a_lock_of_another_program_stays() {
    let folder = folder();
    let here = folder.path();
    for name in ["Cargo", "a.h5"] {
        fs::write(
            here.join(format!("{name}.lock")),
            "[[package]]\nname = \"mine\"\n",
        )
        .expect("written");
        let lock = format!("{name}.lock");
        refused_untouched(
            here,
            &run(name, &["--force"]),
            &[&lock, "the name is taken"],
        );
    }
    refused_untouched(here, &["resume", "a.h5"], &["a.h5"]);
    // What a killed process has left is taken over: a lock with its mark, or with a part of it.
    done(here, &run("b.h5", &[]));
    for left in ["", "made by mc", "made by mc, which removes it\n"] {
        fs::write(here.join("b.h5.lock"), left).expect("written");
        done(here, &run("b.h5", &["--force"]));
        assert!(!here.join("b.h5.lock").exists(), "{left}");
    }
}

#[test]
fn foreign_partial_files_and_folders_are_kept() {
    let folder = folder();
    let here = folder.path();
    let partial = here.join("a.h5.partial");
    // A folder with the names of ours, but without the mark.
    fs::create_dir(&partial).expect("made");
    for name in ["state", "rows", "results.h5", "thesis.tex"] {
        fs::write(partial.join(name), "mine").expect("written");
    }
    refused_untouched(
        here,
        &run("a.h5", &["--force"]),
        &["a.h5.partial", "the name is taken"],
    );
    refused_untouched(
        here,
        &[
            "sweep",
            RHO025,
            "--vary",
            "friction.static=1.2,1.3",
            "-o",
            "a.h5",
            "--force",
        ],
        &["the name is taken"],
    );
    refused_untouched(here, &["resume", "a.h5", "--force"], &["no unfinished run"]);
    // A folder of ours that holds something of somebody else.
    fs::write(partial.join("made-by-mc"), "").expect("written");
    refused_untouched(
        here,
        &run("a.h5", &["--force"]),
        &["a.h5.partial/thesis.tex", "the name is taken"],
    );
    fs::remove_dir_all(&partial).expect("removed");
    for text in ["", "mine"] {
        fs::write(&partial, text).expect("written");
        refused_untouched(
            here,
            &run("a.h5", &["--force"]),
            &["a.h5.partial", "the name is taken"],
        );
    }
    fs::remove_file(&partial).expect("removed");
    // A link leads to a place of somebody else, even to an empty one.
    fs::create_dir(here.join("elsewhere")).expect("made");
    symlink("elsewhere", &partial).expect("linked");
    refused_untouched(
        here,
        &run("a.h5", &["--force"]),
        &["a.h5.partial", "the name is taken"],
    );
}

/// Links and pipes under the names of the files in the folder of a run are neither followed nor
/// waited for.
#[test]
fn links_and_pipes_among_the_files_of_a_run_are_refused() {
    let folder = folder();
    let here = folder.path();
    fs::write(here.join("precious"), "mine").expect("written");
    for name in ["state.new", "rows", "state", "results.h5", "results.link"] {
        for kind in ["link", "pipe"] {
            let (_outer, there) = folders();
            let begun = shimmed(&there, &run_of("20000", "a.h5", &[]), 40).0;
            assert_eq!(
                begun.status.code(),
                None,
                "it is killed: {}",
                text(&begun.stderr)
            );
            let partial = there.join("a.h5.partial");
            let path = partial.join(name);
            let _ = fs::remove_file(&path);
            match kind {
                "link" => symlink(here.join("precious"), &path).expect("linked"),
                _ => assert!(shell(&partial, &format!("mkfifo {name}")).status.success()),
            }
            for command in [
                &["resume", "a.h5", "--quiet"][..],
                &run("a.h5", &["--force"]),
            ] {
                let output = mc(&there, command);
                let said = text(&output.stderr);
                assert!(
                    output.status.success() || said.contains(name) || said.contains("a.h5.partial"),
                    "{name}: {said}"
                );
            }
            assert_eq!(
                fs::read(here.join("precious")).expect("there"),
                b"mine",
                "{name}"
            );
        }
    }
}

#[test]
fn a_file_that_others_may_not_read_stays_so() {
    let folder = folder();
    let here = folder.path();
    let mode = |name: &str| {
        fs::metadata(here.join(name))
            .expect("there")
            .permissions()
            .mode()
            & 0o777
    };
    let close = |name: &str| {
        fs::set_permissions(here.join(name), fs::Permissions::from_mode(0o600)).expect("closed")
    };
    let sweep = [
        "sweep",
        RHO025,
        "--vary",
        "friction.static=1.2,1.3",
        "--paths=256",
        "--quiet",
        "-o",
        "s.h5",
    ];
    for command in [
        &run("a.h5", &[])[..],
        &sweep,
        &["plot", "a.h5", "-o", "p.svg"],
        &["report", "a.h5", "-o", "r.html"],
    ] {
        let output = command.last().expect("a name");
        done(here, command);
        assert_ne!(
            mode(output),
            0o600,
            "a new file has the permissions that are usual here"
        );
        close(output);
        let forced = [command, &["--seed", "2", "--force"]].concat();
        let forced = if ["plot", "report"].contains(&command[0]) {
            [command, &["--force"]].concat()
        } else {
            forced
        };
        done(here, &forced);
        assert_eq!(mode(output), 0o600, "{}", forced.join(" "));
    }
}

/// What does not come back as a run, a sweep or another file of ours is not "finished".
#[test]
fn mc_resume_calls_nothing_finished_that_is_not_whole() {
    let folder = folder();
    let here = folder.path();
    done(here, &run("part.h5", &["--part", "1/2"]));
    done(here, &["resume", "part.h5"]);
    let whole = fs::read(here.join("part.h5")).expect("there");
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 4;
    for (bytes, code) in [
        (&[][..], 2),
        (b"text", 2),
        (&whole[..whole.len() / 2], 1),
        (&flipped, 1),
    ] {
        fs::write(here.join("a.h5"), bytes).expect("written");
        refused(here, &["resume", "a.h5"], code, &["a.h5"]);
        assert_eq!(fs::read(here.join("a.h5")).expect("there"), bytes);
    }
    let other = hdf5::File::create(here.join("new.h5")).expect("created");
    other.new_attr::<u64>().create("mine").expect("written");
    drop(other);
    // A process that another test starts meanwhile may hold the lock of the file that was created.
    fs::copy(here.join("new.h5"), here.join("other.h5")).expect("copied");
    refused(here, &["resume", "other.h5"], 2, &["other.h5"]);
    fs::create_dir(here.join("folder")).expect("made");
    refused(here, &["resume", "folder"], 2, &["folder"]);
    refused(here, &["resume", "folder/"], 2, &["folder"]);
}

/// An equal part is an equal file, however long it took and on however many threads.
#[test]
fn a_part_is_the_same_bytes_each_time() {
    let folder = folder();
    let here = folder.path();
    let part = |name: &'static str, threads: &'static str| {
        let rows = [
            "--set",
            "record.events=true",
            "--part",
            "2/3",
            "--threads",
            threads,
        ];
        done(here, &run_of("1500", name, &rows));
        fs::read(here.join(name)).expect("written")
    };
    let first = part("a.h5", "1");
    assert!(part("b.h5", "1") == first && part("c.h5", "2") == first);
}

/// The removal of a lock or of the folder fails. The file is there, and the command says what
/// stays.
#[test]
fn what_could_not_be_removed_is_said() {
    let (_outer, here) = folders();
    let (_, trace) = failing(&here, &run("a.h5", &[]), 0, 5);
    let (mut said, mut silent) = (0, Vec::new());
    for line in trace
        .iter()
        .filter(|line| line.contains(" unlink ") || line.contains(" rmdir "))
    {
        let number: u64 = line
            .split(' ')
            .next()
            .and_then(|number| number.parse().ok())
            .expect("a number");
        let (_outer, here) = folders();
        let (output, _) = failing(&here, &run("a.h5", &[]), number, 5);
        let (is_left, message) = (
            fs::read_dir(&here).expect("a folder").count() > 1,
            text(&output.stderr),
        );
        if output.status.success() && is_left {
            said += u32::from(message.contains("warning") && message.contains("remove it by hand"));
            silent.extend((!message.contains("remove it by hand")).then(|| line.clone()));
        }
    }
    assert!(said >= 1 && silent.is_empty(), "{said} {silent:?}");
}

#[test]
fn help_that_cannot_be_written_is_a_failure() {
    let folder = folder();
    for arguments in [
        "--help",
        "--version",
        "run --help",
        "check scenarios/rho025.toml",
    ] {
        let line = format!(
            "cd {}/../..; \"$0\" {arguments} > /dev/full",
            env!("CARGO_MANIFEST_DIR")
        );
        let output = shell(folder.path(), &line);
        assert_eq!(
            output.status.code(),
            Some(1),
            "{arguments}: {}",
            text(&output.stderr)
        );
        assert!(
            text(&output.stderr).contains("cannot write to standard output"),
            "{}",
            text(&output.stderr)
        );
    }
}

#[test]
fn a_long_or_binary_line_is_shown_in_part_and_as_characters() {
    let folder = folder();
    let here = folder.path();
    let long = format!(
        "title = \"{}\" 7 \"{}\"\n",
        "x".repeat(200_000),
        "y".repeat(200_000)
    );
    for text_of_file in [
        long.clone(),
        "\0".repeat(400_000),
        format!("{} = 1\n", "k".repeat(400_000)),
    ] {
        fs::write(here.join("a.toml"), &text_of_file).expect("written");
        let output = mc(here, &["check", "a.toml"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(output.stderr.len() < 2000, "{} bytes", output.stderr.len());
        assert!(!output.stderr.contains(&0), "a NUL");
        // Whoever reads the message in the library gets no more of it.
        let error =
            stickslip::scenario::Scenario::parse("a.toml", &text_of_file, &[]).expect_err("wrong");
        let message = error.to_string();
        assert!(
            message.len() < 2000 && !message.contains('\0'),
            "{} bytes",
            message.len()
        );
    }
    // The caret is under the place.
    fs::write(here.join("a.toml"), long).expect("written");
    let said = text(&mc(here, &["check", "a.toml"]).stderr);
    let lines: Vec<&str> = said.lines().collect();
    let caret = lines
        .iter()
        .position(|line| line.trim_end().ends_with('^'))
        .expect("a caret");
    let place = lines[caret]
        .chars()
        .position(|c| c == '^')
        .expect("a caret");
    assert_eq!(lines[caret - 1].chars().nth(place), Some('7'), "{said}");
}

/// A block of these paths takes minutes.
#[test]
fn a_time_limit_before_the_first_block_says_how_long_that_takes() {
    let folder = folder();
    let long = [
        "run",
        RHO025,
        "--paths",
        "1000",
        "--step",
        "1e-6",
        "--quiet",
        "-o",
        "a.h5",
        "--max-time",
        "1s",
    ];
    refused(
        folder.path(),
        &long,
        1,
        &[
            "first 256 paths",
            "which take about",
            "--max-time",
            "nothing was written",
        ],
    );
    assert!(everything(folder.path()).is_empty());
}
