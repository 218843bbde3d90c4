//! What a run came to.

use super::{EndedBy, MissedGoal, Part};
use crate::bias::NoBias;
use crate::stats::Summary;

/// How far a run has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Every path that was asked for has been simulated.
    Complete,
    /// It ended at the end of a block as it was asked to: its goals are reached or its time is up.
    Ended,
    /// Every path of one part of the run has been simulated.
    Part,
    /// It was stopped from outside.
    Interrupted,
    /// It is still going, or was killed.
    Running,
}

impl Status {
    const ALL: [Status; 5] = [Status::Complete, Status::Ended, Status::Part, Status::Interrupted, Status::Running];

    /// The word in files and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Status::Complete => "complete",
            Status::Ended => "ended",
            Status::Part => "part",
            Status::Interrupted => "interrupted",
            Status::Running => "running",
        }
    }

    /// The status of this name.
    pub fn from_name(name: &str) -> Option<Status> {
        Status::ALL.into_iter().find(|status| status.name() == name)
    }
}

/// What became of the estimate of the bias of the step. The biases themselves are in the summary.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BiasReport {
    /// Wall-clock seconds that it took.
    pub seconds: f64,
    /// Why there is none; `None` where there is one, or nobody asked.
    pub absence: Option<NoBias>,
}

/// What a run came to. `T` is what a user's own statistic came to.
#[derive(Clone, Debug)]
pub struct Outcome<T = ()> {
    /// Every statistic with its interval and, where known, its bias.
    pub summary: Summary,
    /// Whether all paths were simulated.
    pub status: Status,
    /// Most paths that the run could have come to.
    pub paths: u64,
    /// Which part of the run it is, if not all of it.
    pub part: Option<Part>,
    /// What ended it before its last path.
    pub ended_by: Option<EndedBy>,
    /// Goals that it has missed, unless it was interrupted.
    pub missed: Vec<MissedGoal>,
    /// The bias of the step.
    pub bias: BiasReport,
    /// Threads that it ran on.
    pub threads: usize,
    /// Wall-clock seconds, those for the bias included.
    pub seconds: f64,
    /// A user's own statistic.
    pub tally: T,
}

impl<T> Outcome<T> {
    /// Whether paths were simulated, and every one of them diverged or had to be given up.
    pub fn is_all_lost(&self) -> bool {
        let lost = self.summary.diverged.len() as u64;
        lost > 0 && lost == self.summary.completed_paths
    }

    /// Wall-clock seconds of the ensemble itself, the bias left out.
    pub fn ensemble_seconds(&self) -> f64 {
        self.seconds - self.bias.seconds
    }

    /// The same with what a user's own statistic came to.
    pub(super) fn with_tally<U>(self, tally: U) -> Outcome<U> {
        let Outcome { summary, status, paths, part, ended_by, missed, bias, threads, seconds, tally: _ } = self;
        Outcome { summary, status, paths, part, ended_by, missed, bias, threads, seconds, tally }
    }
}
