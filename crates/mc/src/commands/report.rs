//! `mc report`: writes a file as one page for a browser, with its table, its warnings and its
//! pictures.

use crate::inputs::results;
use crate::kinds;
use crate::output::failure::{Failure, note, writable};
use std::path::PathBuf;
use stickslip_files::store;

/// Arguments of `mc report`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/report.txt"))]
pub struct Arguments {
    /// A file of results, of any kind
    file: PathBuf,
    /// Output file [default: NAME.html in the current directory]
    #[arg(short, long, value_name = "FILE.html")]
    output: Option<PathBuf>,
    /// Overwrite an earlier page
    #[arg(long)]
    force: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let output = self
            .output
            .clone()
            .unwrap_or_else(|| results::default_output(&self.file, ".html"));
        writable(&output, self.force, [self.file.as_path()])?;
        crate::arguments::extension::check_page(&output, &self.file)?;
        let page = kinds::read(&self.file)?.page(&self.file)?;
        store::write_whole(&output, page.as_bytes(), self.force)?;
        note(&format!("{}: {} kB", output.display(), page.len() / 1000));
        Ok(())
    }
}
