//! `mc man`: prints a manual page on standard output.

use crate::output::failure::{Failure, print_data};
use clap::CommandFactory as _;

/// Arguments of `mc man`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/man.txt"))]
pub struct Arguments {
    /// Command whose page to print [default: mc itself]
    command: Option<String>,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let mut all = crate::Arguments::command();
        all.build();
        let page = match &self.command {
            None => all,
            Some(name) => {
                let found = all
                    .get_subcommands()
                    .find(|verb| verb.get_name() == name && !verb.is_hide_set());
                let unknown = || {
                    Failure::usage(
                        format!("unknown command `{name}`"),
                        "`mc --help` lists them",
                    )
                };
                found.ok_or_else(unknown)?.clone()
            }
        };
        let mut text = Vec::new();
        clap_mangen::Man::new(page)
            .render(&mut text)
            .map_err(Failure::unprinted)?;
        print_data(&String::from_utf8_lossy(&text))
    }
}
