//! `mc` as a child process that cannot outlive its test: one that hangs is killed, and the test
//! fails and says so.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::{Duration, Instant};

/// The longest that a command may take. The slowest of them takes ten seconds on a machine of its
/// own, so one that is not over by then waits for something that does not come, and not for its
/// share of a processor.
pub const LONGEST: Duration = Duration::from_secs(300);

/// How often a condition is looked at.
const LOOK: Duration = Duration::from_millis(20);

/// What `mc` says to these arguments in this folder.
#[track_caller]
pub fn mc(folder: &Path, arguments: &[&str]) -> Output {
    within(LONGEST, folder, arguments)
}

/// The same with a limit of its own.
#[track_caller]
pub fn within(limit: Duration, folder: &Path, arguments: &[&str]) -> Output {
    let mut command = assert_cmd::Command::cargo_bin("mc").expect("built");
    let output = command.current_dir(folder).args(arguments).timeout(limit).output().expect("runs");
    assert!(
        output.status.code().is_some(),
        "mc {} was killed ({}): it took more than {limit:?}, or crashed\n{}",
        arguments.join(" "),
        output.status,
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// What `mc` prints when it succeeds.
#[track_caller]
pub fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = mc(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "mc {}: {}", arguments.join(" "), text(&output.stderr));
    text(&output.stdout)
}

/// `mc` refuses with this exit code, and says all of these.
#[track_caller]
pub fn refused(folder: &Path, arguments: &[&str], code: i32, says: &[&str]) {
    let output = mc(folder, arguments);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "mc {}: {said}", arguments.join(" "));
    for part in says {
        assert!(said.contains(part), "mc {}: {part}: {said}", arguments.join(" "));
    }
}

/// What was printed.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// What was printed as one JSON object.
pub fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).expect("one JSON object")
}

/// What a shell says to a line in this folder, `$0` of which is `mc`.
#[track_caller]
pub fn shell(folder: &Path, line: &str) -> Output {
    let mut command = assert_cmd::Command::new("sh");
    let command = command.current_dir(folder).args(["-c", line]).arg(assert_cmd::cargo::cargo_bin!("mc"));
    let output = command.timeout(LONGEST).output().expect("runs");
    assert!(
        output.status.code().is_some(),
        "{line} was killed ({}): it took more than {LONGEST:?}, or crashed",
        output.status
    );
    output
}

/// `mc` while the test goes on. It is killed when the test is over, whatever the test came to.
pub struct Running {
    child: Child,
    begun: Instant,
    shown: String,
    streams: [Option<JoinHandle<Vec<u8>>>; 2],
}

impl Running {
    /// Start it.
    pub fn mc(folder: &Path, arguments: &[&str]) -> Self {
        Running::mc_into(Stdio::piped(), folder, arguments)
    }

    /// The same with its standard output led somewhere.
    pub fn mc_into(out: Stdio, folder: &Path, arguments: &[&str]) -> Self {
        // A signal that was ignored when it starts stays ignored, and a test may be started so.
        let mut command = Command::new("env");
        let command = command.arg("--default-signal=INT,TERM,HUP,USR1,USR2,XCPU");
        let command = command.arg(assert_cmd::cargo::cargo_bin!("mc")).args(arguments);
        let command = command.current_dir(folder).stdout(out).stderr(Stdio::piped());
        let mut child = command.spawn().expect("starts");
        // Read while it runs: a pipe that nobody empties would hold it up.
        let streams = [child.stdout.take().map(collect), child.stderr.take().map(collect)];
        Running { child, begun: Instant::now(), shown: format!("mc {}", arguments.join(" ")), streams }
    }

    /// Wait until something is so.
    #[track_caller]
    pub fn until(&mut self, what: &str, mut is_so: impl FnMut() -> bool) {
        while !is_so() {
            let ended = self.child.try_wait().expect("a child of this process");
            assert!(ended.is_none(), "{} ended with {ended:?} before {what}", self.shown);
            assert!(self.begun.elapsed() < LONGEST, "{}: not within {LONGEST:?}: {what}", self.shown);
            sleep(LOOK);
        }
    }

    /// Wait until it answers Ctrl-C: until then an interrupt ends it as it ends any process.
    #[track_caller]
    pub fn until_it_answers(&mut self) {
        let status = format!("/proc/{}/status", self.child.id());
        self.until("it answers Ctrl-C", || {
            let text = std::fs::read_to_string(&status).unwrap_or_default();
            let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:"));
            let caught = caught.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok());
            // Bit n - 1 is signal n, and SIGINT is 2.
            caught.is_some_and(|bits| bits & 0b10 != 0)
        });
    }

    /// Send it Ctrl-C.
    pub fn interrupt(&self) {
        self.signal("INT");
    }

    /// Send it a signal of this name.
    pub fn signal(&self, name: &str) {
        let to = self.child.id().to_string();
        let sent = Command::new("kill").args([&format!("-{name}"), &to]).status().expect("kill");
        assert!(sent.success(), "{sent}");
    }

    /// Wait for its end.
    #[track_caller]
    pub fn end(mut self) -> Output {
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("a child of this process") {
                break status;
            }
            assert!(self.begun.elapsed() < LONGEST, "{} took more than {LONGEST:?}", self.shown);
            sleep(LOOK);
        };
        let [stdout, stderr] = self
            .streams
            .each_mut()
            .map(|stream| stream.take().map_or_else(Vec::new, |thread| thread.join().expect("its pipe is read")));
        Output { status, stdout, stderr }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It has ended already, mostly; then there is nothing to kill.
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
