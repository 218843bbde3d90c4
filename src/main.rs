//! The command `mc`: parses the arguments, calls one verb, and exits with its exit code.

mod cli;

use clap::Parser as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    cli::once(|| match cli::Arguments::try_parse() {
        Ok(arguments) => match arguments.call() {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => failure.report(),
        },
        Err(answer) => cli::answer(&answer),
    })
}
