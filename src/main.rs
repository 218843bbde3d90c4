//! The command `mc`.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    stick_slip::engine::built_from(stick_slip_commit::commit!(""));
    cli::main()
}
