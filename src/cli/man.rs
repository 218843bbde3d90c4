//! `mc man`: writes a manual page for each command.

use super::failure::Failure;
use clap::CommandFactory as _;
use std::path::PathBuf;

/// Arguments of `mc man`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  mc man ~/.local/share/man/man1 && man mc-run")]
pub struct Man {
    /// The folder for the pages; it is created if it does not exist
    folder: PathBuf,
}

impl Man {
    pub fn call(&self) -> Result<(), Failure> {
        std::fs::create_dir_all(&self.folder)
            .and_then(|()| clap_mangen::generate_to(super::Arguments::command(), &self.folder))
            .map_err(|e| Failure::Run(format!("{}: cannot write manual pages: {e}", self.folder.display())))
    }
}
