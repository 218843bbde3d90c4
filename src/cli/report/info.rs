//! What is known about a run besides its statistics, and the speeds that follow from it.

use stick_slip::engine::{Part, Status};
use stick_slip::scenario::Units;

/// What is known about a run besides its summary.
#[derive(Clone, Debug)]
pub struct RunInfo {
    /// What the scenario is called: its file for a run, its title for a stored one.
    pub scenario: String,
    /// What the scenario asks.
    pub title: String,
    /// Name of the scheme.
    pub scheme: String,
    /// h, for time-stepping schemes.
    pub step: Option<f64>,
    /// The shortest slip the scheme resolves, where its results depend on that.
    pub resolution: Option<f64>,
    /// Seed of the ensemble.
    pub seed: u64,
    /// Paths asked for.
    pub paths: u64,
    /// Which part of them this is, if not all.
    pub part: Option<Part>,
    /// Whether they are antithetic pairs.
    pub antithetic: bool,
    /// Threads, if this process ran it.
    pub threads: Option<usize>,
    /// Wall-clock time, if known.
    pub seconds: Option<f64>,
    /// How much of it went into the bias of the step.
    pub bias_seconds: Option<f64>,
    /// Why the bias is not known, unless nobody asked.
    pub no_bias: Option<String>,
    /// Steps of one path, for time-stepping schemes.
    pub steps_per_path: Option<u64>,
    /// Where the results are.
    pub file: String,
    /// Whether every path was simulated.
    pub status: Status,
    /// What ended the run before its last path, if it was asked to end.
    pub ended_by: Option<String>,
    /// The resolved scenario, if it is at hand.
    pub scenario_text: Option<String>,
    /// Labels of the units.
    pub units: Units,
}

impl RunInfo {
    /// What became of a path that is in no statistic. A step can be unstable; a scheme without one
    /// gives up, where a path takes more work than it may or meets a number that is not finite.
    pub(super) fn loss(&self) -> &'static str {
        if self.step.is_some() { "diverged" } else { "given up" }
    }

    /// Wall-clock time of the ensemble itself.
    fn ensemble_seconds(&self) -> Option<f64> {
        Some(self.seconds? - self.bias_seconds?)
    }

    /// Wall-clock nanoseconds per step of one path, all threads together.
    pub(super) fn ns_per_path_step(&self, completed_paths: u64) -> Option<f64> {
        let path_steps = completed_paths as f64 * self.steps_per_path? as f64;
        (path_steps > 0.0).then_some(self.ensemble_seconds()? * 1e9 / path_steps)
    }

    /// Wall-clock microseconds per path, all threads together.
    pub(super) fn us_per_path(&self, completed_paths: u64) -> Option<f64> {
        (completed_paths > 0).then_some(self.ensemble_seconds()? * 1e6 / completed_paths as f64)
    }
}
