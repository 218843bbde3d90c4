//! Everything a report states about a run other than its statistics, and the speeds that follow
//! from it.

use stickslip::engine::{Part, Provenance, Status};
use stickslip::scenario::Period;

/// Everything a report states about a run other than its statistics.
#[derive(Clone, Debug)]
pub struct RunInfo {
    /// The name of the scenario: its file for a new run, its title for a stored one.
    pub scenario: String,
    /// Where the numbers come from.
    pub provenance: Provenance,
    /// Which part of the paths this is, if not all of them.
    pub part: Option<Part>,
    /// The number of threads, if this process simulated the run.
    pub threads: Option<usize>,
    /// Wall-clock time in seconds, if known.
    pub seconds: Option<f64>,
    /// How much of that time the estimate of the bias of the step took.
    pub bias_seconds: Option<f64>,
    /// Why the bias is not known; none if it was not requested.
    pub no_bias: Option<String>,
    /// The period at whose ends x is compared, if the scenario is known.
    pub period: Option<Period>,
    /// Whether no spring pulls the body back, so that its displacement is what people ask for.
    pub is_free: bool,
    /// The number of steps of one path, if this process simulated the run with a time-stepping scheme.
    pub steps_per_path: Option<u64>,
    /// The file that holds the results.
    pub file: String,
    /// Whether every path was simulated.
    pub status: Status,
    /// What ended the run before its last path; none if it did not end early.
    pub ended_by: Option<String>,
}

impl RunInfo {
    /// The name shown when there is no file: it was deleted in the meantime, or never written.
    pub const NO_FILE: &str = "none";

    /// Why a path is excluded from the statistics. A path diverges if the step is unstable. A
    /// scheme without a step gives up a path that takes more work than allowed or meets a number
    /// that is not finite.
    pub(super) fn loss(&self) -> &'static str {
        if self.provenance.step.is_some() {
            "diverged"
        } else {
            "given up"
        }
    }

    /// Wall-clock time of the simulation without the estimate of the bias.
    fn ensemble_seconds(&self) -> Option<f64> {
        Some(self.seconds? - self.bias_seconds?)
    }

    /// Wall-clock nanoseconds for one step of one path, with all threads together.
    pub(super) fn ns_per_path_step(&self, completed_paths: u64) -> Option<f64> {
        let path_steps = completed_paths as f64 * self.steps_per_path? as f64;
        (path_steps > 0.0).then_some(self.ensemble_seconds()? * 1e9 / path_steps)
    }

    /// Wall-clock microseconds for one path, with all threads together.
    pub(super) fn us_per_path(&self, completed_paths: u64) -> Option<f64> {
        (completed_paths > 0).then_some(self.ensemble_seconds()? * 1e6 / completed_paths as f64)
    }
}
