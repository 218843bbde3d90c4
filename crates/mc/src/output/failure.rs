//! The ways in which a verb can fail, and their exit codes.

use crate::output::numbers::wrapped;
use crate::output::safe;
use clap::builder::styling::{AnsiColor, Style};
use std::fmt::Display;
use std::io::{self, Write as _};
use std::os::unix::fs::MetadataExt as _;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicI32, Ordering};
use stickslip::config::{Diagnostic, ScenarioError, Unreadable};
use stickslip::scheme::CheckError;
use stickslip_files::store::{lock_path, partial_path};

/// The last signal that was received; SIGINT, which is that of Ctrl-C, if there was none.
static SIGNAL: AtomicI32 = AtomicI32::new(signal_hook::consts::SIGINT);

/// A signal was received that asks the process to end.
pub fn signalled(signal: i32) {
    SIGNAL.store(signal, Ordering::Relaxed);
}

/// The exit code of a process that is ended by the signal that was received: 130 for Ctrl-C, 143
/// for SIGTERM.
pub fn exit_code() -> u8 {
    128 + u8::try_from(SIGNAL.load(Ordering::Relaxed)).unwrap_or(0)
}

/// Why a verb failed. The message contains the remedy.
#[derive(Debug)]
pub enum Failure {
    /// The arguments are wrong, or contradict the scenario or the file of results that they refer
    /// to; nothing was started.
    Refused(String),
    /// The work began but did not finish.
    Run(String),
    /// The user stopped it; what was finished is in the file.
    Interrupted,
}

impl Failure {
    /// Wrong arguments, and what to write instead.
    pub fn usage(problem: impl Display, remedy: impl Display) -> Self {
        Failure::Refused(with_remedy(problem, remedy))
    }

    /// Work that did not finish, and what to do about it.
    pub fn run(problem: impl Display, remedy: impl Display) -> Self {
        Failure::Run(with_remedy(problem, remedy))
    }

    /// The same for a file, which the message names.
    pub fn run_of(file: &Path, problem: impl Display, remedy: impl Display) -> Self {
        Failure::run(format!("{}: {problem}", file.display()), remedy)
    }

    /// Standard output cannot be written to.
    pub fn unprinted(error: io::Error) -> Self {
        Failure::Run(format!("cannot write to standard output: {error}"))
    }

    /// Prints the failure on standard error and returns the exit code of the process.
    pub fn report(&self) -> ExitCode {
        let (code, problem) = match self {
            Failure::Refused(problem) => (2, problem),
            Failure::Run(problem) => (1, problem),
            Failure::Interrupted => return ExitCode::from(exit_code()),
        };
        // If standard error is closed, the message is lost.
        note(&format!("error: {problem}"));
        ExitCode::from(code)
    }
}

fn with_remedy(problem: impl Display, remedy: impl Display) -> String {
    format!("{problem}\n  fix: {remedy}")
}

impl From<ScenarioError> for Failure {
    fn from(error: ScenarioError) -> Self {
        Failure::Refused(match error {
            ScenarioError::Invalid(diagnostics) => diagnostics
                .iter()
                .map(Diagnostic::to_string)
                .collect::<Vec<_>>()
                .join("\nerror: "),
            ScenarioError::Unreadable { path, cause } => with_remedy(
                format!("cannot read {path}: {cause}"),
                readable(&path, &cause),
            ),
        })
    }
}

/// The remedy for a scenario that cannot be read, with the command that helps.
fn readable(path: &str, cause: &Unreadable) -> String {
    let remedy = cause.remedy();
    match cause {
        Unreadable::Results => format!(
            "`mc show {path}` shows the results in it, and `mc show {path} --scenario` prints their scenario"
        ),
        Unreadable::Missing(_) if path.ends_with(".h5") => {
            "give the path of an existing file".into()
        }
        Unreadable::Missing(Some(name)) => {
            format!("{remedy}; `mc init --from {name}` writes a copy of it")
        }
        Unreadable::Missing(None) | Unreadable::Directory => {
            format!("{remedy}; `mc init` writes one")
        }
        _ => remedy,
    }
}

impl From<CheckError> for Failure {
    fn from(check_error: CheckError) -> Self {
        Failure::Refused(check_error.to_string())
    }
}

/// Writes to standard output for people.
pub fn print(text: &str) -> Result<(), Failure> {
    print_as_it_is(&safe::text(text))
}

/// Writes to standard output for programs: nothing is cut.
pub fn print_data(text: &str) -> Result<(), Failure> {
    print_as_it_is(&safe::data(text))
}

/// In `mc ... | head` the reader closes the pipe when it has read enough. That is not a failure,
/// and the verb continues, because its other results do not depend on the reader.
fn print_as_it_is(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::unprinted(error)),
        _ => Ok(()),
    }
}

/// Writes a line to standard error. A failure to write it is ignored.
pub fn note(text: &str) {
    let text = safe::text(text);
    // A terminal gets colours unless NO_COLOR is set; elsewhere they are left out.
    let lines = text.split('\n').map(|line| {
        let marked = MARKS
            .iter()
            .find_map(|(mark, style)| Some((mark, style, line.strip_prefix(mark)?)));
        marked.map_or_else(
            || line.to_string(),
            |(mark, style, rest)| format!("{style}{mark}{style:#}{rest}"),
        )
    });
    drop(writeln!(
        anstream::stderr(),
        "{}",
        lines.collect::<Vec<_>>().join("\n")
    ));
}

/// Coloured words at the beginning of a line, in the style of the argument parser.
const MARKS: [(&str, Style); 3] = [
    ("error:", AnsiColor::Red.on_default().bold()),
    ("warning:", AnsiColor::Yellow.on_default().bold()),
    ("  fix:", AnsiColor::Green.on_default()),
];

/// Writes a warning to standard error, in lines that are no wider than the terminal.
pub fn warn(warning: impl Display) {
    note(wrapped(&format!("warning: {warning}"), "  ").trim_end());
}

/// Checks that a file may be written at `path`: its directory exists, and it replaces at most a
/// regular file, and only with `force`. Files among `inputs`, from which the results are computed,
/// are never replaced, neither by the file itself nor by the names used while it is written.
pub fn writable<P: AsRef<Path>>(
    path: &Path,
    force: bool,
    inputs: impl IntoIterator<Item = P>,
) -> Result<(), Failure> {
    let shown = path.display();
    let refuse = |problem: String| Err(Failure::usage(problem, "choose another file with -o"));
    if path == Path::new("-") {
        return refuse("results are written to a file, not to standard output".into());
    }
    if path.to_str().is_none() {
        return refuse(format!("{shown}: its name is not UTF-8"));
    }
    let taken = [path.to_owned(), partial_path(path), lock_path(path)];
    for input in inputs {
        if let Some(name) = taken.iter().find(|name| is_same(name, input.as_ref())) {
            let need = if name == path {
                String::new()
            } else {
                format!(", which mc needs to write {shown},")
            };
            return refuse(format!(
                "{}{need} is an input of this command",
                name.display()
            ));
        }
    }
    if path.is_dir() {
        return Err(Failure::usage(
            format!("{shown} is a directory"),
            "give the name of a file with -o",
        ));
    }
    let parent = path
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    if !parent.is_dir() {
        let problem = format!(
            "the directory {} of {shown} does not exist",
            parent.display()
        );
        return Err(Failure::usage(
            problem,
            "create it, or choose another place with -o",
        ));
    }
    // `symlink_metadata` also finds a dangling link. Writing through it would create a file at its
    // target.
    match path.symlink_metadata() {
        Ok(there) if !there.is_file() => refuse(format!(
            "{shown} is not a regular file and cannot be replaced"
        )),
        Ok(_) if !force => {
            let problem = format!("{shown} already exists");
            Err(Failure::usage(
                problem,
                "choose another name with -o FILE, or overwrite it with --force",
            ))
        }
        _ => Ok(()),
    }
}

/// Whether two names denote the same file, through any links.
fn is_same(one: &Path, other: &Path) -> bool {
    let of = |path: &Path| path.metadata().map(|there| (there.dev(), there.ino()));
    matches!((of(one), of(other)), (Ok(one), Ok(other)) if one == other)
}
