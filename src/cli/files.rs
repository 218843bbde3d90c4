//! Files of results as the verbs read them. Every verb says of a file without a checksum that it
//! has none, and none is brought down by it.
//!
//! HDF5 itself may crash, or loop for ever, while it reads a file that was changed on purpose. So a
//! file without a checksum is first read by a child process with limits, and only then by this one,
//! which makes the same calls.

use super::failure::{Failure, note};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};
use stick_slip::store::{self, FileKind, StoreError};

/// The memory that the child process may use besides the size of the file.
const MEMORY: u64 = 4 << 30;

/// The processor seconds that it may use besides those for reading the file.
const SECONDS: u64 = 20;

/// Bytes of a file that take at most a second to read.
const BYTES_A_SECOND: u64 = 50_000_000;

/// What one of the readers of the store reads from a file.
pub fn read<T>(path: &Path, reader: impl FnOnce(&Path) -> Result<T, StoreError>) -> Result<T, Failure> {
    look(path)?;
    reader(path).map_err(|error| explained(path, error))
}

/// The error of a reader. A file of another kind is named, and so is the likeliest reason why
/// something is missing from a file without a checksum.
pub fn explained(path: &Path, error: StoreError) -> Failure {
    let other = |what: &str, verbs: &str| {
        let problem = format!("{} is {what}, which is not what this verb reads", path.display());
        Failure::usage(problem, format!("{verbs} take it"))
    };
    match error {
        StoreError::Foreign { .. } => match store::kind(path) {
            Ok(Some(FileKind::Trade)) => other("a trade", "`mc show`, `mc plot`, `mc report` and `mc verify`"),
            Ok(Some(FileKind::Sweep)) => {
                other("a sweep", "`mc show`, `mc plot`, `mc report`, `mc resume` and `mc verify`")
            }
            Ok(Some(FileKind::Calibration)) => {
                other("a calibration", "`mc show`, `mc plot`, `mc report` and `mc verify`")
            }
            // A run that the readers of runs do not know lacks its version.
            Ok(Some(FileKind::Run) | None) | Err(_) => error.into(),
        },
        StoreError::Damaged { cause, .. } if matches!(store::is_sealed(path), Ok(false)) => {
            let problem = format!(
                "{}: {cause}; another program left it out or changed it, or the file was cut short",
                path.display()
            );
            Failure::run(problem, "save all variables with it, or take the file as mc wrote it")
        }
        error => error.into(),
    }
}

/// Says once of each file that it has no checksum, and has a child process read it first.
pub fn look(path: &Path) -> Result<(), Failure> {
    static SEEN: Mutex<BTreeMap<PathBuf, Result<(), String>>> = Mutex::new(BTreeMap::new());
    let mut seen = SEEN.lock().unwrap_or_else(PoisonError::into_inner);
    seen.entry(path.to_owned()).or_insert_with(|| look_anew(path)).clone().map_err(Failure::Run)
}

fn look_anew(path: &Path) -> Result<(), String> {
    // What cannot be read at all is reported by the reader that comes next.
    if !matches!(store::is_sealed(path), Ok(false)) {
        return Ok(());
    }
    note(&format!(
        "warning: {} has no checksum: another program changed it, or an earlier version of mc wrote it",
        path.display()
    ));
    let not_started = |error| unread(path, &format!("mc cannot start itself: {error}"));
    let program = std::env::current_exe().map_err(not_started)?;
    let mut child = Command::new(program);
    child.arg("look-through").arg("--").arg(path).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let status = child.status().map_err(not_started)?;
    // An exit code means that a reader said what is wrong, which the reader here will repeat.
    match status.code() {
        Some(_) => Ok(()),
        None => Err(unread(path, "HDF5 crashed or did not come to an end while reading it")),
    }
}

fn unread(path: &Path, cause: &str) -> String {
    let remedy = "take the file as mc wrote it, or run its scenario again";
    format!("{}: it has no checksum, and {cause}\n  fix: {remedy}", path.display())
}

/// Arguments of the child process.
#[derive(Debug, clap::Args)]
pub struct LookThrough {
    /// The file to be read
    file: PathBuf,
}

impl LookThrough {
    /// Reads the file within limits of time and memory.
    pub fn call(&self) -> Result<(), Failure> {
        let bytes = std::fs::metadata(&self.file).map_or(0, |there| there.len());
        limit(Resource::As, MEMORY.saturating_add(bytes.saturating_mul(4)));
        limit(Resource::Cpu, SECONDS + bytes / BYTES_A_SECOND);
        limit(Resource::Core, 0);
        Ok(store::look_through(&self.file)?)
    }
}

/// Lowers a limit of this process. Where the system does not have that limit, there is none.
fn limit(resource: Resource, most: u64) {
    let Rlimit { current, maximum } = getrlimit(resource);
    let lower = |old: Option<u64>| Some(old.map_or(most, |old| old.min(most)));
    let _ = setrlimit(resource, Rlimit { current: lower(current), maximum });
}
