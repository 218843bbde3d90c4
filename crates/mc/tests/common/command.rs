//! Runs `mc` as a child process that cannot outlive its test: a process that hangs is killed, and
//! the test fails with a message.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::{Duration, Instant};

/// The longest that a command may take. The slowest takes ten seconds on an idle machine, so a
/// command that takes longer than this is not merely slow but hangs.
pub const LONGEST: Duration = Duration::from_secs(300);

pub const RHO025: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/rho025.toml");

/// A run with rows of every kind, a last block that is not full, trajectories that end within a
/// part, and a bias of the step.
pub const SCENE: &[&str] = &[
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

/// The measurements of `examples/bridge`.
pub const TWIN: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/bridge/twin.csv"
);

/// The first 100 days of these measurements, in a file of this folder, for tests of what does not
/// depend on their length.
pub fn hundred_days(folder: &Path) -> &'static str {
    let text = std::fs::read_to_string(TWIN).expect("the twin");
    let lines = text.split_inclusive('\n').take(1 + 100 * 144);
    std::fs::write(folder.join("days.csv"), lines.collect::<String>()).expect("written");
    "days.csv"
}

/// How often a condition is checked.
const LOOK: Duration = Duration::from_millis(20);

/// The output of `mc` with these arguments in this folder.
#[track_caller]
pub fn mc(folder: &Path, arguments: &[&str]) -> Output {
    within(LONGEST, folder, arguments)
}

/// Like [`mc`], with another limit of the time.
#[track_caller]
pub fn within(limit: Duration, folder: &Path, arguments: &[&str]) -> Output {
    let mut command = assert_cmd::Command::cargo_bin("mc").expect("built");
    let output = command
        .current_dir(folder)
        .args(arguments)
        .timeout(limit)
        .output()
        .expect("runs");
    assert!(
        output.status.code().is_some(),
        "mc {} was killed ({}): it took more than {limit:?}, or crashed\n{}",
        arguments.join(" "),
        output.status,
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// The standard output of `mc`, which must succeed.
#[track_caller]
pub fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = mc(folder, arguments);
    assert_eq!(
        output.status.code(),
        Some(0),
        "mc {}: {}",
        arguments.join(" "),
        text(&output.stderr)
    );
    text(&output.stdout)
}

/// `mc` must fail with this exit code, and its message must contain each of these texts.
#[track_caller]
pub fn refused(folder: &Path, arguments: &[&str], code: i32, says: &[&str]) {
    let output = mc(folder, arguments);
    let said = text(&output.stderr);
    assert_eq!(
        output.status.code(),
        Some(code),
        "mc {}: {said}",
        arguments.join(" ")
    );
    for part in says {
        assert!(
            said.contains(part),
            "mc {}: {part}: {said}",
            arguments.join(" ")
        );
    }
}

/// The bytes as text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A text that is one JSON object.
pub fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).expect("one JSON object")
}

/// The output of a shell command in this folder, in which `$0` is `mc`.
#[track_caller]
pub fn shell(folder: &Path, line: &str) -> Output {
    let mut command = assert_cmd::Command::new("sh");
    let command = command
        .current_dir(folder)
        .args(["-c", line])
        .arg(assert_cmd::cargo::cargo_bin!("mc"));
    let output = command.timeout(LONGEST).output().expect("runs");
    assert!(
        output.status.code().is_some(),
        "{line} was killed ({}): it took more than {LONGEST:?}, or crashed",
        output.status
    );
    output
}

/// An `mc` that runs while the test goes on. It is killed at the end of the test, whether the test
/// passes or fails.
pub struct Running {
    child: Child,
    begun: Instant,
    shown: String,
    streams: [Option<JoinHandle<Vec<u8>>>; 2],
}

impl Running {
    /// Starts it.
    pub fn mc(folder: &Path, arguments: &[&str]) -> Self {
        Running::mc_into(Stdio::piped(), folder, arguments)
    }

    /// Starts it with its standard output connected to `out`.
    pub fn mc_into(out: Stdio, folder: &Path, arguments: &[&str]) -> Self {
        // A process keeps ignoring the signals that were ignored when it started, and the tests may
        // have been started in such a way. So the signals are reset.
        let mut command = Command::new("env");
        let command = command.arg("--default-signal=INT,TERM,HUP,USR1,USR2,XCPU");
        let command = command
            .arg(assert_cmd::cargo::cargo_bin!("mc"))
            .args(arguments);
        let command = command
            .current_dir(folder)
            .stdout(out)
            .stderr(Stdio::piped());
        let mut child = command.spawn().expect("starts");
        // The streams are read while it runs, because a full pipe would block it.
        let streams = [
            child.stdout.take().map(collect),
            child.stderr.take().map(collect),
        ];
        Running {
            child,
            begun: Instant::now(),
            shown: format!("mc {}", arguments.join(" ")),
            streams,
        }
    }

    /// Waits until a condition is true.
    #[track_caller]
    pub fn until(&mut self, what: &str, mut is_so: impl FnMut() -> bool) {
        while !is_so() {
            let ended = self.child.try_wait().expect("a child of this process");
            assert!(
                ended.is_none(),
                "{} ended with {ended:?} before {what}",
                self.shown
            );
            assert!(
                self.begun.elapsed() < LONGEST,
                "{}: not within {LONGEST:?}: {what}",
                self.shown
            );
            sleep(LOOK);
        }
    }

    /// Waits until it handles Ctrl-C. Before that, an interrupt would end it like any process.
    #[track_caller]
    pub fn until_it_answers(&mut self) {
        let status = format!("/proc/{}/status", self.child.id());
        self.until("it answers Ctrl-C", || {
            let text = std::fs::read_to_string(&status).unwrap_or_default();
            let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:"));
            let caught = caught.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok());
            // Bit n - 1 stands for signal n, and SIGINT is signal 2.
            caught.is_some_and(|bits| bits & 0b10 != 0)
        });
    }

    /// Sends Ctrl-C.
    pub fn interrupt(&self) {
        self.signal("INT");
    }

    /// Sends the signal with this name.
    pub fn signal(&self, name: &str) {
        let to = self.child.id().to_string();
        let sent = Command::new("kill")
            .args([&format!("-{name}"), &to])
            .status()
            .expect("kill");
        assert!(sent.success(), "{sent}");
    }

    /// Waits for its end.
    #[track_caller]
    pub fn end(mut self) -> Output {
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("a child of this process") {
                break status;
            }
            assert!(
                self.begun.elapsed() < LONGEST,
                "{} took more than {LONGEST:?}",
                self.shown
            );
            sleep(LOOK);
        };
        let [stdout, stderr] = self.streams.each_mut().map(|stream| {
            stream
                .take()
                .map_or_else(Vec::new, |thread| thread.join().expect("its pipe is read"))
        });
        Output {
            status,
            stdout,
            stderr,
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Mostly it has ended already, and there is nothing to kill.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn collect(mut stream: impl Read + Send + 'static) -> JoinHandle<Vec<u8>> {
    spawn(move || {
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes);
        bytes
    })
}
