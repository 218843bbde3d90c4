//! Runs `mc` so that one of its changes of the disk kills it or fails (`tests/shim/kill.c`).
#![allow(dead_code, reason = "each test file uses its own part")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// What happens at a change of the disk.
#[derive(Clone, Copy, Debug)]
pub enum Fault {
    /// The process is killed; half of the bytes of a write have then reached the file.
    Kill,
    /// The change fails with this error, and all later ones succeed.
    Error(i32),
    /// A write writes half of its bytes; any other change succeeds.
    Short,
}

/// A command for `mc`, in which change number `at` of the disk goes wrong.
pub fn faulty(folder: &Path, arguments: &[&str], at: u64, fault: Fault) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("mc"));
    command
        .current_dir(folder)
        .args(arguments)
        .env("LD_PRELOAD", shim())
        .env("KILL_AT", at.to_string());
    match fault {
        Fault::Kill => &mut command,
        Fault::Error(number) => command.env("FAIL_ERRNO", number.to_string()),
        Fault::Short => command.env("FAIL_ERRNO", "0"),
    };
    command
}

/// Runs `mc` and kills it at change number `kill_at` of the disk. Returns its output, and the
/// changes of the disk that it made.
pub fn shimmed(folder: &Path, arguments: &[&str], kill_at: u64) -> (Output, Vec<String>) {
    traced(faulty(folder, arguments, kill_at, Fault::Kill), folder)
}

/// Runs `mc`, and lets change number `fail_at` of the disk fail with this error, and only that one.
/// Files that are created count as changes here.
pub fn failing(
    folder: &Path,
    arguments: &[&str],
    fail_at: u64,
    errno: i32,
) -> (Output, Vec<String>) {
    traced(
        faulty(folder, arguments, fail_at, Fault::Error(errno)),
        folder,
    )
}

/// The output of a command, and the changes of the disk that it made.
pub fn traced(mut command: Command, folder: &Path) -> (Output, Vec<String>) {
    let trace = folder.join("../trace");
    let _ = fs::remove_file(&trace);
    let output = command.env("KILL_TRACE", &trace).output().expect("runs");
    let trace = fs::read_to_string(&trace).unwrap_or_default();
    (output, trace.lines().map(str::to_string).collect())
}

/// A temporary folder and a folder within it, so that a trace lies beside it.
pub fn folders() -> (tempfile::TempDir, PathBuf) {
    let outer = tempfile::tempdir().expect("a folder");
    let inner = outer.path().join("here");
    fs::create_dir(&inner).expect("made");
    (outer, inner)
}

fn shim() -> &'static Path {
    static SHIM: LazyLock<PathBuf> = LazyLock::new(|| {
        let library =
            Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("kill-{}.so", std::process::id()));
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/shim/kill.c");
        let mut compiler = Command::new("cc");
        compiler
            .args(["-shared", "-fPIC", "-O1", "-o"])
            .arg(&library)
            .args([source, "-ldl"]);
        assert!(
            compiler.status().expect("a C compiler").success(),
            "{source} is not compiled"
        );
        library
    });
    &SHIM
}
