//! How to cite a run: what a reader needs to repeat it, and the paper of its model.

use crate::output::document::sha256;
use crate::output::numbers::{counted, grouped};
use stickslip::model::PAPER;
use stickslip_files::store::Stored;
use stickslip_text::numbers::short;

/// The number of digits of the hash of the scenario that are printed: enough to distinguish
/// scenarios.
const DIGITS: usize = 16;

/// Two sentences for a paper: the run, and the source of its model.
///
/// The hash is that of the resolved scenario in the file, so two runs with the same version, hash
/// and number of paths have the same data.
pub fn citation(stored: &Stored) -> [String; 2] {
    let header = &stored.header;
    let step = header
        .step
        .map(|step| format!(", step {}", short(step)))
        .unwrap_or_default();
    let paths = match stored.completed_paths == header.paths {
        true => counted(header.paths, "path"),
        false => format!(
            "{} of {}",
            grouped(stored.completed_paths),
            counted(header.paths, "path")
        ),
    };
    let program = format!(
        "stick-slip (mc) {} ({}), scenario \"{}\" (SHA-256 {}), scheme {}{step}, seed {}, {paths}.",
        header.program.version,
        header.program.git_hash,
        header.title,
        &sha256(&header.scenario_text)[..DIGITS],
        header.scheme,
        header.seed,
    );
    [program, format!("Model and scheme: {PAPER}")]
}
