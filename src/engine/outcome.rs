//! The outcome of a run.

use super::{EndedBy, MissedGoal, Part};
use crate::bias::NoBias;
use crate::stats::{Estimate, Statistic, Summary, Units};
use std::ops::Index;

/// The status of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// All requested paths have been simulated.
    Complete,
    /// The run ended early at the end of a block, because its goals were reached, one of them
    /// cannot be reached, or its time was up.
    Ended,
    /// Every path of one part of the run has been simulated.
    Part,
    /// The run was stopped by the caller.
    Interrupted,
    /// The run is still going on, or was killed.
    Running,
}

impl Status {
    const ALL: [Status; 5] = [
        Status::Complete,
        Status::Ended,
        Status::Part,
        Status::Interrupted,
        Status::Running,
    ];

    /// The name in files and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Status::Complete => "complete",
            Status::Ended => "ended",
            Status::Part => "part",
            Status::Interrupted => "interrupted",
            Status::Running => "running",
        }
    }

    /// The status with this name.
    pub fn from_name(name: &str) -> Option<Status> {
        Status::ALL.into_iter().find(|status| status.name() == name)
    }
}

/// The cost of the estimate of the bias of the step, or why there is none. The biases themselves
/// are in the summary.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BiasReport {
    /// Wall-clock seconds that the estimate took.
    pub seconds: f64,
    /// Why there is no estimate; `None` if there is one, or if none was requested.
    pub absence: Option<NoBias>,
}

/// The outcome of a run.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Outcome {
    /// Every statistic with its interval, and with its bias if that is known.
    pub summary: Summary,
    /// Whether all paths were simulated.
    pub status: Status,
    /// The number of paths that the run would have without an early end; for a part, the number of
    /// all parts together.
    pub paths: u64,
    /// The part of the run that was simulated; `None` means the whole run.
    pub part: Option<Part>,
    /// What ended the run before its last path, if anything.
    pub ended_by: Option<EndedBy>,
    /// The goals that the run has not reached. Empty if the run was interrupted, or ended because a
    /// goal cannot be reached.
    pub missed: Vec<MissedGoal>,
    /// The estimate of the bias of the step.
    pub bias: BiasReport,
    /// Number of threads, those of all processes together.
    pub threads: usize,
    /// Wall-clock seconds, including those for the bias.
    pub seconds: f64,
    /// The labels of the units of its scenario.
    pub units: Units,
}

impl Outcome {
    /// Whether all simulated paths diverged or were given up, and there is at least one.
    pub fn is_all_lost(&self) -> bool {
        let lost = self.summary.diverged.len() as u64;
        lost > 0 && lost == self.summary.completed_paths
    }
}

impl Index<Statistic> for Outcome {
    type Output = Estimate;

    /// The estimate of a statistic; NaN where it was not requested or does not exist.
    fn index(&self, statistic: Statistic) -> &Estimate {
        self.summary.estimate(statistic)
    }
}
