//! A change of the disk that fails once, while all later ones succeed: the command reports an
//! error, or has written what it writes otherwise. The next command finishes in either case.
//!
//! `tests/shim/kill.c` lets one write, sync, rename, link, removal or creation fail, with an error
//! of a disk (no space, a quota, an error of the device), with an interruption, or as a short
//! write.

use crate::command::{self, text};
use crate::shim::{Fault, faulty, folders, traced};
use std::fs;
use std::path::Path;

const RHO025: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/rho025.toml");
const SHAW: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shaw.toml");
const BRIDGE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/bridge/bridge.toml"
);
const TWIN: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/bridge/twin.csv"
);

const FAULTS: [Fault; 5] = [
    Fault::Error(rustix::io::Errno::NOSPC.raw_os_error()),
    Fault::Error(rustix::io::Errno::IO.raw_os_error()),
    Fault::Error(rustix::io::Errno::DQUOT.raw_os_error()),
    Fault::Error(rustix::io::Errno::INTR.raw_os_error()),
    Fault::Short,
];

const RUN: &[&str] = &[
    "run",
    RHO025,
    "--paths",
    "700",
    "--step",
    "0.1",
    "--quiet",
    "--set",
    "record.events=true",
    "--set",
    "time.output_step=10",
];

/// A command that writes one file.
struct Writes {
    /// Commands that make its input.
    before: Vec<Vec<&'static str>>,
    arguments: Vec<&'static str>,
    output: &'static str,
    /// Whether two files of equal commands are equal; they are not where times are measured.
    is_repeatable: bool,
}

fn writes(
    before: &[&[&'static str]],
    arguments: &[&[&'static str]],
    output: &'static str,
) -> Writes {
    let before = before.iter().map(|arguments| arguments.to_vec()).collect();
    Writes {
        before,
        arguments: arguments.concat(),
        output,
        is_repeatable: true,
    }
}

/// A command for each kind of file.
fn commands() -> Vec<Writes> {
    let part =
        |number: &'static str, name: &'static str| [RUN, &["--part", number, "-o", name]].concat();
    let (first, second) = (part("1/2", "1.h5"), part("2/2", "2.h5"));
    let run = [RUN, &["-o", "a.h5"]].concat();
    let sweep: &[&str] = &[
        "sweep",
        RHO025,
        "--vary",
        "friction.static=1.1,1.2",
        "--paths",
        "300",
        "--step",
        "0.1",
        "--quiet",
    ];
    let trade: &[&str] = &["trade", SHAW, "--budget", "1s", "-o", "t.h5"];
    vec![
        writes(&[], &[RUN, &["-o", "a.h5"]], "a.h5"),
        writes(&[], &[RUN, &["--part", "2/2", "-o", "a.h5"]], "a.h5"),
        writes(
            &[&first, &second],
            &[&["merge", "1.h5", "2.h5", "-o", "a.h5"]],
            "a.h5",
        ),
        writes(
            &[&run],
            &[&["replay", "a.h5", "--path", "3", "-o", "r.h5"]],
            "r.h5",
        ),
        Writes {
            is_repeatable: false,
            ..writes(&[], &[sweep, &["-o", "s.h5"]], "s.h5")
        },
        Writes {
            is_repeatable: false,
            ..writes(&[], &[trade], "t.h5")
        },
        writes(
            &[],
            &[&["calibrate", BRIDGE, TWIN, "--method", "slips", "-o", "c.h5"]],
            "c.h5",
        ),
        writes(&[&run], &[&["plot", "a.h5", "-o", "p.svg"]], "p.svg"),
        writes(&[&run], &[&["report", "a.h5", "-o", "p.html"]], "p.html"),
        writes(&[], &[&["twin", BRIDGE, "-o", "twin.csv"]], "twin.csv"),
    ]
}

/// How many changes a command makes, and what became of faults: errors and right files.
#[derive(Debug, Default)]
struct Counts {
    changes: u64,
    errors: u64,
    right: u64,
}

impl Writes {
    /// Lets every change of the disk whose number leaves `first` when it is divided by `stride`
    /// fail with each of these faults, and sees what becomes of it.
    fn survive(&self, first: u64, stride: u64, faults: &[Fault]) -> Counts {
        let (_keep, prepared) = folders();
        for arguments in &self.before {
            command::done(&prepared, arguments);
        }
        let undisturbed = copy(&prepared);
        let (output, trace) = traced(
            faulty(&undisturbed.1, &self.arguments, 0, Fault::Short),
            &undisturbed.1,
        );
        assert!(output.status.success(), "{}", text(&output.stderr));
        let file = fs::read(undisturbed.1.join(self.output)).expect("written");
        let mut counts = Counts {
            changes: trace.len() as u64,
            ..Counts::default()
        };
        for (at, fault) in (first..=counts.changes + 2)
            .step_by(stride as usize)
            .flat_map(|at| faults.iter().map(move |f| (at, f)))
        {
            let (_keep, here) = copy(&prepared);
            let output = faulty(&here, &self.arguments, at, *fault)
                .output()
                .expect("runs");
            let what = format!("{:?}, change {at}, {fault:?}", self.arguments);
            let said = text(&output.stderr);
            match output.status.code() {
                Some(0) => {
                    self.assert_right(&here, &file, &what);
                    counts.right += 1;
                }
                Some(1 | 2) => {
                    assert!(said.contains("error: "), "{what}: {said}");
                    counts.errors += 1;
                }
                code => panic!("{what}: {code:?}, {}: {said}", output.status),
            }
            // Under its name there is no file, or the whole one.
            if here.join(self.output).exists() {
                self.assert_right(&here, &file, &what);
            }
            let is_there = here.join(self.output).exists();
            let partial = format!("{}.partial", self.output);
            let resume: &[&str] = &["resume", self.output, "--quiet"];
            let can_resume = here.join(partial).join("state").exists();
            let next = if can_resume { resume } else { &self.arguments };
            let again = command::mc(&here, next);
            // A command refuses to overwrite what is whole already.
            assert!(
                again.status.success() || is_there,
                "{what}, then {next:?}: {said}{}",
                text(&again.stderr)
            );
            self.assert_right(&here, &file, &what);
        }
        counts
    }

    fn assert_right(&self, here: &Path, file: &[u8], what: &str) {
        let found = fs::read(here.join(self.output)).unwrap_or_default();
        if self.is_repeatable {
            assert!(found == file, "{what}: another file");
        } else {
            let output = command::mc(here, &["verify", self.output, "--again"]);
            assert!(output.status.success(), "{what}: {}", text(&output.stderr));
        }
    }
}

/// A copy of a folder, within a temporary one.
fn copy(from: &Path) -> (tempfile::TempDir, std::path::PathBuf) {
    let (outer, here) = folders();
    for entry in fs::read_dir(from).expect("a folder") {
        let entry = entry.expect("read");
        fs::copy(entry.path(), here.join(entry.file_name())).expect("copied");
    }
    (outer, here)
}

/// One change of seventy-two, each with another fault.
#[test]
fn one_failed_disk_write_is_an_error_or_harmless() {
    for (i, command) in commands().iter().enumerate() {
        // The faults meet different changes.
        let places = [0, 72, 144, 216, 288].map(|place| 1 + (i as u64 * 7 + place) % 360);
        let counts = places
            .into_iter()
            .zip(FAULTS)
            .map(|(first, fault)| command.survive(first, 360, &[fault]));
        let counts: Vec<Counts> = counts.collect();
        let all = counts
            .iter()
            .fold(0, |sum, counts| sum + counts.errors + counts.right);
        assert!(
            all >= counts[0].changes / 72,
            "{:?}: {counts:?}",
            command.arguments
        );
    }
}

/// Every change with every fault. In the last run of 2 740 faults in runs, parts and merges, 1 541
/// were errors and 1 199 left the right file; the other commands were not run to the end.
#[test]
#[ignore = "half an hour"]
fn any_single_failed_disk_write_is_an_error_or_harmless() {
    for command in commands() {
        let counts = command.survive(1, 1, &FAULTS);
        println!("{} {}: {counts:?}", command.arguments[0], command.output);
    }
}
