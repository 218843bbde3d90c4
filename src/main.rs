//! The command `mc`: parses the arguments, calls one verb, and exits with its exit code.

mod cli;

use clap::Parser as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    cli::once(|| match cli::Arguments::try_parse() {
        Ok(arguments) => {
            let done = arguments.call();
            cli::say_what_stays();
            done.map_or_else(|failure| failure.report(), |()| ExitCode::SUCCESS)
        }
        Err(answer) => cli::answer(&answer),
    })
}
