//! Runs `mc` with `tests/shim/kill.c` in front of the C library, which kills it at a chosen change of
//! the disk, or lets this change fail.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// Runs `mc` and kills it at change number `kill_at` of the disk. Returns its output, and the
/// changes of the disk that it made.
pub fn shimmed(folder: &Path, arguments: &[&str], kill_at: u64) -> (Output, Vec<String>) {
    at_change(folder, arguments, kill_at, None)
}

/// Runs `mc`, and lets change number `fail_at` of the disk fail with this error, and only that one.
/// Files that are created count as changes here.
pub fn failing(folder: &Path, arguments: &[&str], fail_at: u64, errno: i32) -> (Output, Vec<String>) {
    at_change(folder, arguments, fail_at, Some(errno))
}

fn at_change(folder: &Path, arguments: &[&str], number: u64, errno: Option<i32>) -> (Output, Vec<String>) {
    let trace = folder.join("../trace");
    let _ = fs::remove_file(&trace);
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("mc"));
    let command = command.current_dir(folder).args(arguments).env("LD_PRELOAD", library()).env("KILL_TRACE", &trace);
    errno.map(|errno| command.env("FAIL_ERRNO", errno.to_string()));
    let output = command.env("KILL_AT", number.to_string()).output().expect("runs");
    let trace = fs::read_to_string(&trace).unwrap_or_default();
    (output, trace.lines().map(str::to_string).collect())
}

fn library() -> &'static Path {
    static SHIM: LazyLock<PathBuf> = LazyLock::new(|| {
        let library = Path::new(env!("CARGO_TARGET_TMPDIR")).join("kill.so");
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/shim/kill.c");
        let mut compiler = Command::new("cc");
        compiler.args(["-shared", "-fPIC", "-O1", "-o"]).arg(&library).args([source, "-ldl"]);
        assert!(compiler.status().expect("a C compiler").success(), "{source} is not compiled");
        library
    });
    &SHIM
}

/// A temporary folder and a folder within it.
pub fn folders() -> (tempfile::TempDir, PathBuf) {
    let outer = tempfile::tempdir().expect("a folder");
    let inner = outer.path().join("here");
    fs::create_dir(&inner).expect("made");
    (outer, inner)
}
