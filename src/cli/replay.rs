//! `mc replay`: one path of a stored ensemble alone, with its events and every step.

use super::failure::{Failure, writable};
use super::show;
use std::path::PathBuf;
use stick_slip::scenario::Scenario;

/// Arguments of `mc replay`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  mc replay rho025.h5 --path 4711 -o path-4711.h5")]
pub struct Replay {
    /// A file that `mc run` wrote
    file: PathBuf,
    /// Number of the path, from 0
    #[arg(long, value_name = "N")]
    path: u64,
    /// Where to write it [default: FILE-path-N.h5 in the current directory]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrite the file if it exists
    #[arg(long)]
    force: bool,
}

impl Replay {
    pub fn call(&self) -> Result<(), Failure> {
        let stored = show::read(&self.file)?;
        // Any path can be simulated, but one the ensemble does not have is more likely a slip of the pen.
        if self.path >= stored.header.paths {
            let problem = format!("--path {}: the ensemble has {} paths", self.path, stored.header.paths);
            let remedy = format!("give a number from 0 to {}", stored.header.paths.saturating_sub(1));
            return Err(Failure::usage(problem, remedy));
        }
        let scenario = Scenario::parse(&self.file.display().to_string(), &stored.header.scenario_text, &[])?;
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let output = self.output.clone().unwrap_or_else(|| format!("{stem}-path-{}.h5", self.path).into());
        writable(&output, self.force)?;
        replay(&scenario, self.path, &output)
    }
}

/// Simulate one path, keep its events and its state at every step, write them.
fn replay(scenario: &Scenario, path: u64, output: &std::path::Path) -> Result<(), Failure> {
    let _ = (scenario, path, output);
    Err(Failure::Run("the engine is not built".into()))
}
