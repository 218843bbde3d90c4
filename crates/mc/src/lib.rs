//! The command line: one file for each verb, which parses its arguments, calls the library, and
//! prints.

/// The verbs and the functions that they call, from one list.
macro_rules! verbs {
    ($($(#[$about:meta])* $Verb:ident($($module:ident)::+),)+) => {
        #[derive(Debug, clap::Subcommand)]
        #[allow(clippy::large_enum_variant, reason = "there is one, for the whole run")]
        pub enum Verb {
            $($(#[$about])* $Verb($($module::)+Arguments),)+
        }

        impl Verb {
            pub fn call(&self) -> Result<(), Failure> {
                match self {
                    $(Verb::$Verb(verb) => verb.call(),)+
                }
            }
        }
    };
}

mod arguments;
mod bearing;
mod commands;
mod inputs;
mod kinds;
mod output;
mod report;
mod session;

// What most verbs use.
use crate::arguments::threads::Threads;
use crate::kinds::{Kind, RUN, SWEEP, TRADE};
use crate::output::failure::{Failure, note, print, print_data, warn, writable};
use crate::session::interrupt::stop_on_signals;

use clap::Parser as _;
use std::io::{self, IsTerminal as _};
use std::process::ExitCode;
use stickslip::engine::{PROGRAM_VERSION, commit};
use stickslip::ensemble::guarded;
use stickslip::stats::Statistic;
use stickslip_files::store;

/// Version and commit, as `--version` shows them.
fn version() -> String {
    format!("{PROGRAM_VERSION} ({})", commit())
}

/// Monte Carlo simulation of a body with dry friction, driven by deterministic and random forces.
#[derive(Debug, clap::Parser)]
#[command(name = "mc", version = version(), after_help = include_str!("commands/help/mc.txt"), arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

/// Every kind of result. This list and the verbs below are the only places that mention bearings.
const KINDS: [&Kind; 4] = [&RUN, &TRADE, &SWEEP, &bearing::CALIBRATION];

verbs! {
    /// Simulate an ensemble of paths and write its statistics
    Run(commands::run),
    /// Continue an interrupted run or sweep
    Resume(commands::resume),
    /// Join the parts of a run
    Merge(commands::merge),
    /// Validate a scenario; print it in full, with derived quantities and warnings
    Check(commands::check),
    /// Print the results in a file
    Show(commands::show),
    /// Draw results as SVG, PNG or PDF
    Plot(commands::plot),
    /// Write an HTML report: table, warnings and pictures
    Report(commands::report),
    /// Simulate one path of a stored ensemble again, with its events and trajectory
    Replay(commands::replay),
    /// Check that a file is intact and reproducible from its scenario and seed
    Verify(commands::verify),
    /// Measure the cost of accuracy: every scheme at several settings, and the cheapest for a
    /// target
    Trade(commands::trade),
    /// Compute statistics as functions of keys of the scenario, with precise differences, or
    /// elasticities
    Sweep(commands::sweep),
    #[command(flatten)]
    Bearing(bearing),
    /// Write a commented scenario to start from
    Init(commands::init),
    /// Print a completion script for a shell
    Completions(commands::completions),
    /// Print a manual page for `man`
    Man(commands::man),
}

/// Starts the thread that does the work.
pub fn main() -> ExitCode {
    stickslip::engine::built_from(env!("STICKSLIP_COMMIT"));
    session::interrupt::refuse_large_files();
    // The stack of the first thread may be small: `ulimit -s` limits it.
    let answering = std::thread::Builder::new()
        .stack_size(STACK)
        .spawn(answered);
    answering.map_or_else(
        |_| answered(),
        |thread| thread.join().unwrap_or(ExitCode::FAILURE),
    )
}

/// Stack size of the thread that does the work in bytes, the usual size for a first thread.
const STACK: usize = 8 << 20;

/// Parses the arguments, calls one verb, and returns its exit code.
fn answered() -> ExitCode {
    match Arguments::try_parse() {
        Ok(arguments) => {
            let done = guarded(|| arguments.verb.call()).unwrap_or_else(|flaw| Err(flaw.into()));
            // Files that could not be removed after the work.
            store::take_leftovers()
                .iter()
                .for_each(|line| note(&format!("warning: {line}")));
            done.map_or_else(|failure| failure.report(), |()| ExitCode::SUCCESS)
        }
        Err(answer) => self::answer(&answer),
    }
}

/// Prints the answer of the argument parser: help, the version, or an error. Arguments are shown
/// with unsafe characters escaped.
fn answer(answer: &clap::Error) -> ExitCode {
    if let Some(failure) = arguments::mistakes::answered(answer) {
        return failure.report();
    }
    let plain = answer.to_string();
    if !answer.use_stderr() {
        // Help and version were requested. On a terminal they are coloured.
        let printed = match io::stdout().is_terminal() {
            true => answer.print().map_err(Failure::unprinted),
            false => print(&plain),
        };
        return printed.map_or_else(|failure| failure.report(), |()| ExitCode::SUCCESS);
    }
    // Escaping would destroy the colours, so the text is escaped, without colours, only if it
    // contains something unsafe for a terminal.
    if output::safe::text(&plain) == plain {
        let _ = answer.print();
    } else {
        note(plain.trim_end());
    }
    ExitCode::from(u8::try_from(answer.exit_code()).unwrap_or(2))
}

/// The number of threads that this process can run in parallel.
fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The names of all statistics, to choose from.
fn statistic_names() -> String {
    Statistic::ALL.map(Statistic::name).join(", ")
}
