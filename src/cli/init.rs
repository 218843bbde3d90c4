//! `mc init`: a shipped scenario, comments and all, to start from.

use super::failure::{Failure, note, print_data, writable};
use std::path::{Path, PathBuf};
use stick_slip::config::{SHIPPED, shipped};
use stick_slip::store;

const EXAMPLES: &str = "\
Examples:
  mc init                             rho025.toml here
  mc init --from shaw -o mine.toml
  mc init --from damped -o -          to standard output";

/// Arguments of `mc init`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Init {
    /// Which shipped scenario
    #[arg(long, value_name = "NAME", default_value = "rho025",
          value_parser = clap::builder::PossibleValuesParser::new(SHIPPED.map(|scenario| scenario.name)))]
    from: String,
    /// Where to write it; `-` is standard output [default: NAME.toml]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrite the file if it exists
    #[arg(long)]
    force: bool,
}

impl Init {
    pub fn call(&self) -> Result<(), Failure> {
        let scenario = shipped(&self.from).ok_or_else(|| {
            let names = SHIPPED.map(|scenario| scenario.name).join(", ");
            Failure::usage(format!("there is no shipped scenario `{}`", self.from), format!("choose one of {names}"))
        })?;
        let output = self.output.clone().unwrap_or_else(|| format!("{}.toml", scenario.name).into());
        if output == Path::new("-") {
            return print_data(scenario.text);
        }
        // What the scenario names lies beside it.
        let beside = scenario.data.iter().map(|(name, text)| (output.with_file_name(name), *text));
        let files: Vec<(PathBuf, &str)> = std::iter::once((output.clone(), scenario.text)).chain(beside).collect();
        for (path, _) in &files {
            writable(path, self.force, [])?;
        }
        for (path, text) in &files {
            store::write_whole(path, text.as_bytes(), self.force)?;
        }
        for (path, _) in &files[1..] {
            note(&format!("wrote {}", path.display()));
        }
        note(&format!("wrote {0}; next: mc check {0}", output.display()));
        Ok(())
    }
}
