//! What a verb can fail with, and the one place where failures become exit codes.

use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;
use stick_slip::config::ScenarioError;
use stick_slip::scheme::Misfit;

/// Why a verb did not do what it was asked to.
#[derive(Debug)]
pub enum Failure {
    /// The arguments are wrong; nothing was started.
    Usage {
        /// What is wrong.
        problem: String,
        /// What would be right.
        remedy: String,
    },
    /// The arguments do not go with the file of results or the scenario that they are about; the message
    /// says what to do.
    Refused(String),
    /// There is no scenario to work on.
    Scenario(ScenarioError),
    /// It was started and did not finish.
    Run(String),
    /// The user stopped it; what was finished is in the file.
    Interrupted,
    /// Standard output cannot be written to.
    Output(io::Error),
}

impl Failure {
    /// Wrong arguments, and what to write instead.
    pub fn usage(problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Failure::Usage { problem: problem.into(), remedy: remedy.into() }
    }

    /// Print to standard error; what the process exits with.
    pub fn report(&self) -> ExitCode {
        // Standard error may be closed as well: then there is nobody to tell.
        let say = |text: String| drop(writeln!(io::stderr(), "error: {text}"));
        match self {
            Failure::Usage { problem, remedy } => {
                say(format!("{problem}\n  fix: {remedy}"));
                ExitCode::from(2)
            }
            Failure::Refused(problem) => {
                say(problem.clone());
                ExitCode::from(2)
            }
            Failure::Scenario(error) => {
                say(error.to_string());
                ExitCode::from(2)
            }
            Failure::Run(problem) => {
                say(problem.clone());
                ExitCode::from(1)
            }
            Failure::Interrupted => ExitCode::from(130),
            // `mc ... | head`: the reader has seen enough.
            Failure::Output(error) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
            Failure::Output(error) => {
                say(format!("cannot write to standard output: {error}"));
                ExitCode::from(1)
            }
        }
    }
}

impl From<ScenarioError> for Failure {
    fn from(error: ScenarioError) -> Self {
        Failure::Scenario(error)
    }
}

impl From<Misfit> for Failure {
    fn from(misfit: Misfit) -> Self {
        Failure::Refused(misfit.to_string())
    }
}

/// Write to standard output; unlike `print!`, a closed pipe is a failure to return, not a panic.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(Failure::Output)
}

/// Write a line to standard error, where a closed pipe is nobody's concern.
pub fn note(text: &str) {
    drop(writeln!(io::stderr(), "{text}"));
}

/// A file may be written here: its directory exists, and nothing is lost that `--force` has not given up.
pub fn writable(path: &Path, force: bool) -> Result<(), Failure> {
    let shown = path.display();
    if path.is_dir() {
        return Err(Failure::usage(format!("{shown} is a directory"), "give the name of a file with -o"));
    }
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !parent.is_dir() {
        let problem = format!("there is no directory {} to write {shown} in", parent.display());
        return Err(Failure::usage(problem, "create it, or choose another place with -o"));
    }
    // A dangling link counts: writing would go wherever it points.
    if path.symlink_metadata().is_ok() && !force {
        let problem = format!("{shown} exists and would be overwritten");
        return Err(Failure::usage(problem, "choose another name with -o FILE, or overwrite it with --force"));
    }
    Ok(())
}
