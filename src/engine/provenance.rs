//! Provenance: the description of its origin in every file and data set.

use crate::ensemble::BLOCK_SIZE;
use crate::model::NamedSeries;
use crate::noise::GENERATOR;
use crate::scenario::{Scenario, SensorBearing};
use crate::stats::Units;
use std::fmt;
use std::sync::OnceLock;

/// Version of the program.
pub const PROGRAM_VERSION: &str = env!("CARGO_PKG_VERSION");

static COMMIT: OnceLock<&str> = OnceLock::new();

/// Set the commit from which this program was built, first and once. The library does not include
/// it, because it would have to be compiled again after each commit.
///
/// The command and the package for Python give the hash, or `unknown` outside a repository. If that
/// does not identify the sources, a fingerprint of them follows, as in `0123456789ab-dirty-` and 16
/// hexadecimal digits.
pub fn built_from(commit: &'static str) {
    COMMIT.get_or_init(|| commit);
}

/// Commit from which this program was built, or `unknown` if it was not set.
pub fn commit() -> &'static str {
    COMMIT.get().unwrap_or(&"unknown")
}

/// The program that computed a result, as far as it determines the bits.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Program {
    /// Version of the program.
    pub version: String,
    /// Commit from which the program was built.
    pub git_hash: String,
    /// Name of the random number generator and of the normal sampler.
    pub generator: String,
    /// Number of paths in a block.
    pub block_size: u64,
}

impl Program {
    /// This program.
    pub fn mine() -> Self {
        Program {
            version: PROGRAM_VERSION.to_string(),
            git_hash: commit().to_string(),
            generator: GENERATOR.to_string(),
            block_size: BLOCK_SIZE,
        }
    }

    /// A sentence about the program that wrote a file, whose numbers may therefore differ. None if
    /// it was this program.
    pub fn other(&self) -> Option<String> {
        let (
            Program {
                version, git_hash, ..
            },
            commit,
        ) = (self, commit());
        let is_own = version == PROGRAM_VERSION && git_hash == commit;
        (!is_own).then(|| {
            format!(
                "written by version {version} ({git_hash}); this is {PROGRAM_VERSION} ({commit})"
            )
        })
    }
}

impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Program {
            version,
            git_hash,
            generator,
            block_size,
        } = self;
        write!(
            f,
            "version {version} ({git_hash}), {generator}, blocks of {block_size}"
        )
    }
}

/// Everything needed to repeat a run, and to identify the program that made it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// The title of the scenario, one line.
    pub title: String,
    /// The resolved scenario as TOML: running it again gives the same data.
    pub scenario_text: String,
    /// Name of the scheme.
    pub scheme: String,
    /// The step h, for schemes with a time step.
    pub step: Option<f64>,
    /// The shortest slip that the scheme resolves, if the results depend on it.
    pub resolution: Option<f64>,
    /// Seed of the ensemble.
    pub seed: u64,
    /// Number of requested paths.
    pub paths: u64,
    /// Whether the paths are antithetic pairs: paths 2k and 2k + 1 see the same noise with opposite
    /// signs.
    pub antithetic: bool,
    /// The program that made the run.
    pub program: Program,
    /// Labels of the units; empty if the scenario is dimensionless.
    pub units: Units,
    /// Times of the output grid.
    pub time: Vec<f64>,
    /// The measured temperature and inputs of the scenario, each by its table.
    pub samples: Vec<NamedSeries>,
    /// The time stamp of the first sample of the temperature, as written to a file.
    pub series_start: Option<String>,
    /// The bearing at which a sensor observes the displacement of trajectories, as written to a
    /// file; none if the scenario names no bearing.
    pub bearing: Option<SensorBearing>,
}

impl Provenance {
    /// The provenance of all paths of a scenario, by this program.
    pub fn of(scenario: &Scenario) -> Self {
        Provenance {
            title: scenario.title.clone(),
            scenario_text: scenario.to_toml(),
            scheme: scenario.scheme.name().to_string(),
            step: scenario.scheme.step(),
            resolution: scenario
                .resolution()
                .map(|resolution| resolution.shortest_slip),
            seed: scenario.ensemble.seed,
            paths: scenario.ensemble.paths,
            antithetic: scenario.ensemble.antithetic,
            program: Program::mine(),
            units: scenario.units.clone(),
            time: scenario.timeline().output_times(),
            samples: scenario.samples(),
            series_start: scenario.series_start(),
            bearing: scenario.bearing,
        }
    }
}
