//! `mc completions`: prints a completion script for a shell on standard output.

use crate::output::failure::{Failure, print_data};
use clap::CommandFactory as _;

/// Arguments of `mc completions`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/completions.txt"))]
pub struct Arguments {
    /// The shell
    shell: clap_complete::Shell,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let mut script = Vec::new();
        clap_complete::generate(
            self.shell,
            &mut crate::Arguments::command(),
            "mc",
            &mut script,
        );
        print_data(&String::from_utf8_lossy(&script))
    }
}
