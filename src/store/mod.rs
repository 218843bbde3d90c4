//! The ensemble on disk: HDF5 that netCDF-4 readers open as it is. The only home of HDF5.

/// Where the numbers of a file come from.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// What the scenario asks, in a line.
    pub title: String,
    /// The resolved scenario as TOML: running it again gives the same data.
    pub scenario_text: String,
    /// Name of the scheme.
    pub scheme: String,
    /// h, for time-stepping schemes.
    pub step: Option<f64>,
    /// Seed of the ensemble.
    pub seed: u64,
    /// Name of the random number generator and of the normal sampler.
    pub generator: String,
    /// Paths asked for.
    pub paths: u64,
    /// Paths in a block.
    pub block_size: u64,
    /// Version of the program.
    pub program_version: String,
    /// Commit the program was built from.
    pub git_hash: String,
    /// Unit labels of time, length, force and temperature; empty where dimensionless.
    pub units: [String; 4],
    /// Times of the output grid.
    pub time: Vec<f64>,
}

/// How far a run has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Every path asked for is in the file.
    Complete,
    /// Stopped early; the file holds `completed_paths` paths.
    Interrupted,
    /// Being written.
    Running,
}
