//! How to cite a run: what a reader needs to repeat it, and the paper of its model.

use sha2::{Digest as _, Sha256};
use stick_slip::numbers::short;
use stick_slip::store::Stored;

/// The paper that the model and the scheme `discrete-vi` are from.
const PAPER: &str = "A. Bensoussan, A. Brouste, F. B. Cartiaux, C. Mathey, L. Mertz, Mathematical formulation of a \
                     dynamical system with dry friction subjected to external forces.";

/// Two sentences for a paper: the run, and the source of its model.
///
/// The hash is that of the resolved scenario that the file holds, so two runs with the same version,
/// hash and number of paths have the same data.
pub fn citation(stored: &Stored) -> [String; 2] {
    let header = &stored.header;
    let step = header.step.map(|step| format!(", step {}", short(step))).unwrap_or_default();
    let paths = match stored.completed_paths == header.paths {
        true => header.paths.to_string(),
        false => format!("{} of {}", stored.completed_paths, header.paths),
    };
    let program = format!(
        "stick-slip (mc) {} ({}), scenario \"{}\" (SHA-256 {}), scheme {}{step}, seed {}, {paths} paths.",
        header.program_version,
        header.git_hash,
        header.title,
        hash(&header.scenario_text),
        header.scheme,
        header.seed,
    );
    [program, format!("The model and the scheme: {PAPER}")]
}

/// The first 16 digits of the SHA-256 of a text.
fn hash(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The start of the hash of "abc" in FIPS 180-4.
    #[test]
    fn the_hash_is_that_of_sha256sum() {
        assert_eq!(hash("abc"), "ba7816bf8f01cfea");
    }
}
