//! What a verb was asked to write is written, or the verb says that it is not: whoever reads what it
//! prints, whatever the disk, and whoever else works in the folder. And nothing that it reads is
//! written over.

use crate::command::{Running, mc, shell, text};
use std::fs;
use std::os::unix::fs::MetadataExt as _;
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

const BRIDGE: &str = include_str!("../../../../examples/bridge/bridge.toml");
const DATA: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/bridge/twin.csv"
);

/// A folder with a scenario of each kind, its measurements, and the files of a run and a sweep.
fn folder() -> TempDir {
    let here = tempfile::tempdir().expect("a folder");
    let bridge =
        BRIDGE.replace("\"twin.csv\"", "\"t.csv\"") + "\n[displacement.series]\nfile = \"x.csv\"\n";
    fs::write(here.path().join("bridge.toml"), bridge).expect("written");
    for name in ["t.csv", "x.csv", "twin.csv"] {
        fs::copy(DATA, here.path().join(name)).expect("copied");
    }
    fs::write(here.path().join("plain.toml"), BRIDGE).expect("written");
    let made = mc(
        here.path(),
        &[
            "run", "rho025", "--paths", "40", "--step", "0.05", "--quiet", "-o", "a.h5",
        ],
    );
    assert!(made.status.success(), "{}", text(&made.stderr));
    here
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> = entries
        .map(|entry| {
            entry
                .expect("read")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    names
}

fn said(output: &Output) -> String {
    text(&output.stdout) + &text(&output.stderr)
}

/// The verbs that write a file, and the names of what they write here.
const WRITING: [(&str, &[&str]); 9] = [
    ("run rho025 --paths 40 --step 0.05 -o out.h5", &["out.h5"]),
    (
        "sweep rho025 --vary friction.static=1.1,1.2 --paths 40 --step 0.05 -o out.h5",
        &["out.h5"],
    ),
    (
        "trade rho025 --budget 1 -o out.h5",
        &["out.h5", "out.svg", "out.png"],
    ),
    (
        "calibrate plain.toml twin.csv --method slips -o out.h5",
        &["out.h5"],
    ),
    (
        "forecast plain.toml twin.csv --draws 2 --years 2 -o out.csv -o out.html",
        &["out.csv", "out.html"],
    ),
    (
        "fit-temperature twin.csv --processes 1 --periods 1d -o out.toml",
        &["out.toml"],
    ),
    ("twin plain.toml -o out.csv", &["out.csv"]),
    ("replay a.h5 --path 0 -o out.h5", &["out.h5"]),
    ("merge one.h5 two.h5 -o out.h5", &["out.h5"]),
];

/// Nobody reads what is printed, or it cannot be printed: the files are written all the same. That
/// nobody reads is a success, as in `mc ... | head`; that it cannot be printed is none.
#[test]
fn what_was_asked_for_is_written_whoever_reads_what_is_printed() {
    for (verb, files) in WRITING {
        let here = folder();
        for (part, name) in [("1/2", "one.h5"), ("2/2", "two.h5")] {
            let part = [
                "run", "rho025", "--paths", "512", "--step", "0.1", "--quiet", "--part", part,
                "-o", name,
            ];
            assert!(!verb.starts_with("merge") || mc(here.path(), &part).status.success());
        }
        let before = names(here.path());
        let mut expected: Vec<String> = before
            .iter()
            .cloned()
            .chain(files.iter().map(|name| name.to_string()))
            .collect();
        expected.sort();
        for (to, code) in [("2>&1 | true", "0"), (">/dev/full", "1")] {
            let line = format!("{{ \"$0\" {verb}; echo $? >code; }} {to}");
            shell(here.path(), &line);
            let came = fs::read_to_string(here.path().join("code")).expect("written");
            fs::remove_file(here.path().join("code")).expect("removed");
            assert_eq!(came.trim(), code, "{line}");
            assert_eq!(names(here.path()), expected, "{line}");
            files.iter().for_each(|name| {
                assert!(
                    fs::metadata(here.path().join(name)).expect("there").len() > 0,
                    "{line}: {name}"
                );
                fs::remove_file(here.path().join(name)).expect("removed");
            });
        }
    }
}

/// A file that cannot be written is a failure, also where nobody reads what is printed of it.
#[test]
fn failed_writes_fail_even_if_the_output_is_read() {
    let here = folder();
    for (verb, _) in &WRITING[..8] {
        let line = format!("{{ (ulimit -f 1; \"$0\" {verb}); echo $? >code; }} | true");
        let err = text(&shell(here.path(), &line).stderr);
        assert_eq!(
            fs::read_to_string(here.path().join("code"))
                .expect("written")
                .trim(),
            "1",
            "{line}"
        );
        assert!(
            err.contains("error: ") && err.contains("File too large"),
            "{line}: {err}"
        );
        let left: Vec<String> = names(here.path())
            .into_iter()
            .filter(|name| name.starts_with("out"))
            .collect();
        assert!(
            left.iter().all(|name| name == "out.h5.partial"),
            "{line}: {left:?}"
        );
        if !left.is_empty() {
            // Only a run can be continued.
            assert!(verb.starts_with("run "), "{line}");
            fs::remove_dir_all(here.path().join("out.h5.partial")).expect("removed");
        }
    }
}

/// The same limit for the verbs that print nothing but where their file is.
#[test]
fn a_limit_on_the_size_of_files_is_a_message_and_leaves_nothing() {
    let here = folder();
    for verb in [
        "plot a.h5 -o out.svg",
        "plot a.h5 -o out.png",
        "report a.h5 -o out.html",
        "init -o out.toml",
    ] {
        let output = shell(here.path(), &format!("ulimit -f 1; \"$0\" {verb}"));
        assert_eq!(output.status.code(), Some(1), "{verb}: {}", said(&output));
        assert!(
            said(&output).contains("File too large"),
            "{verb}: {}",
            said(&output)
        );
        assert!(
            names(here.path())
                .iter()
                .all(|name| !name.starts_with("out")),
            "{verb}: {:?}",
            names(here.path())
        );
    }
    let output = shell(here.path(), "ulimit -f 1; \"$0\" show a.h5 >shown");
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(
        said(&output).contains("cannot write to standard output"),
        "{}",
        said(&output)
    );
}

/// The stack of the first thread is as small as the shell allows. Nothing is computed on it.
#[test]
fn a_small_stack_is_enough() {
    let here = folder();
    for verb in [
        "check rho025",
        "run rho025 --paths 40 --step 0.1 --quiet -o out.h5",
        "plot a.h5 -o out.svg",
        "--help",
    ] {
        let output = shell(here.path(), &format!("ulimit -s 256; \"$0\" {verb}"));
        assert_eq!(output.status.code(), Some(0), "{verb}: {}", said(&output));
    }
}

/// Every verb that reads a scenario, and every file that the scenario or an override names.
#[test]
fn no_file_that_a_scenario_names_is_written_over() {
    let here = folder();
    let at = |name: &str| here.path().join(name);
    let bytes = |name: &str| fs::read(at(name)).expect("there");
    let inputs = ["bridge.toml", "t.csv", "x.csv"];
    let before = inputs.map(bytes);
    let runs = "--paths 2 --set time.end=3600 --set time.output_step=3600";
    for verb in [
        format!("run bridge.toml {runs}"),
        format!("run bridge.toml {runs} --set displacement.series.file=twin.csv"),
        format!("sweep bridge.toml {runs} --vary friction.static=5.1e5,5.2e5"),
        "trade bridge.toml --budget 1".to_string(),
        "twin bridge.toml".to_string(),
        "calibrate bridge.toml".to_string(),
        "forecast bridge.toml --draws 2 --years 2".to_string(),
        "plot bridge.toml".to_string(),
    ] {
        for name in ["t.csv", "x.csv", "twin.csv"] {
            let is_named = if verb.contains("twin.csv") {
                name != "x.csv"
            } else {
                name != "twin.csv"
            };
            if !is_named {
                continue;
            }
            // A link under a name with the right ending leads to the same file.
            let ending = match verb.split(' ').next() {
                Some("forecast" | "twin") => "csv",
                Some("plot") => "svg",
                _ => "h5",
            };
            let link = at(&format!("link.{ending}"));
            fs::hard_link(at(name), &link).expect("linked");
            let output = shell(
                here.path(),
                &format!("\"$0\" {verb} -o link.{ending} --force"),
            );
            let shown = format!("{verb}, {name}: {}", said(&output));
            assert_eq!(output.status.code(), Some(2), "{shown}");
            assert!(
                said(&output).contains("is an input of this command"),
                "{shown}"
            );
            assert_eq!(
                fs::metadata(&link).expect("there").ino(),
                fs::metadata(at(name)).expect("there").ino()
            );
            fs::remove_file(link).expect("removed");
        }
    }
    assert!(inputs.map(bytes) == before);
}

/// Of several processes that make one page, one does, and the others say what is true: they have
/// written nothing.
#[test]
fn one_of_several_concurrent_reports_is_written() {
    let here = folder();
    let all: Vec<Running> = (0..6)
        .map(|_| Running::mc(here.path(), &["report", "a.h5", "-o", "r.html"]))
        .collect();
    let all: Vec<Output> = all.into_iter().map(Running::end).collect();
    assert_eq!(
        all.iter().filter(|output| output.status.success()).count(),
        1
    );
    for output in all.iter().filter(|output| !output.status.success()) {
        let said = said(output);
        let is_true = [
            "another process is writing this file",
            "nothing was written",
            "already exists",
        ];
        assert!(
            is_true.iter().any(|words| said.contains(words)) && !said.contains("r.html.partial"),
            "{said}"
        );
    }
    assert_eq!(
        names(here.path())
            .into_iter()
            .filter(|name| name.starts_with("r."))
            .collect::<Vec<_>>(),
        ["r.html"]
    );
}

/// The second of two files has a name that is taken while the first is made: neither is written, and
/// the same command can be given again.
#[test]
fn files_of_one_command_are_written_all_or_none() {
    let here = folder();
    let made = "forecast plain.toml twin.csv --draws 2 --years 2 -o out.csv -o out.html";
    fs::create_dir(here.path().join("out.html.partial")).expect("made");
    fs::write(here.path().join("out.html.partial/mine"), "mine").expect("written");
    let output = shell(here.path(), &format!("\"$0\" {made}"));
    assert!(!output.status.success(), "{}", said(&output));
    assert_eq!(
        names(here.path())
            .into_iter()
            .filter(|name| name.starts_with("out"))
            .collect::<Vec<_>>(),
        ["out.html.partial"]
    );
    fs::remove_dir_all(here.path().join("out.html.partial")).expect("removed");
    let output = shell(here.path(), &format!("\"$0\" {made}"));
    assert!(output.status.success(), "{}", said(&output));
}

/// The folder of a run is deleted while it runs: no path is safe any more, and the message says so.
#[test]
fn paths_are_lost_with_a_folder_deleted_during_a_run() {
    let here = folder();
    let mut running = Running::mc(
        here.path(),
        &[
            "run",
            "rho025",
            "--paths",
            "1000000",
            "--step",
            "0.02",
            "--json",
            "--set",
            "record.events=true",
            "-o",
            "b.h5",
        ],
    );
    let partial = here.path().join("b.h5.partial");
    running.until("a state is saved", || partial.join("state").exists());
    fs::remove_dir_all(&partial).expect("removed");
    let output = running.end();
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(printed.contains("\"file\": \"none\""), "{printed}");
    let said = said(&output);
    assert!(
        said.contains("moved, deleted or replaced") && !said.contains("are saved"),
        "{said}"
    );
}

/// A manual page is printed, for each command and for all, and no file is written.
#[test]
fn a_manual_page_is_printed() {
    let here = tempfile::tempdir().expect("a folder");
    for (verb, title) in [
        (&["man"][..], "mc"),
        (&["man", "run"], "mc-run"),
        (&["man", "fit-temperature"], "mc-fit-temperature"),
    ] {
        let output = mc(here.path(), verb);
        let page = text(&output.stdout);
        assert!(
            output.status.success() && page.contains(&format!(".TH {title} 1")),
            "{page}"
        );
    }
    let output = mc(here.path(), &["man", "rnu"]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(names(here.path()).is_empty());
}
