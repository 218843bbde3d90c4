//! What is kept of single paths, on request.

use super::Totals;
use crate::model::{Event, EventKind, Sign};

/// What a run keeps besides the statistics of the ensemble.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// Scalars of every path.
    pub paths: bool,
    /// The event table of every path.
    pub events: bool,
    /// The first so many paths are kept on the output grid.
    pub trajectories: u64,
}

impl Record {
    /// Nothing.
    pub const NOTHING: Record = Record { paths: false, events: false, trajectories: 0 };
}

/// Scalars of each path, one entry a path, in order of the path numbers. A diverged path holds NaN
/// and zeros.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathColumns {
    /// x(t_end).
    pub displacement_end: Vec<f64>,
    /// max over [0, t_end] of |x|.
    pub max_displacement: Vec<f64>,
    /// D_0; NaN while it runs at t_end.
    pub first_stick_duration: Vec<f64>,
    /// Total static time, the first and the last stick included.
    pub stick_time: Vec<f64>,
    /// Integral of f_d |x'| dt.
    pub friction_work: Vec<f64>,
    /// Completed sticks, j >= 1.
    pub sticks: Vec<u32>,
    /// Completed dynamic phases.
    pub slips: Vec<u32>,
    /// Sub-phases of the completed dynamic phases: sum of k(j).
    pub sub_phases: Vec<u32>,
    /// Whether the path diverged.
    pub diverged: Vec<bool>,
}

/// Event tables of consecutive paths, one after the other (CF contiguous ragged arrays).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EventColumns {
    /// Number of events of each path.
    pub count: Vec<u32>,
    /// tau.
    pub time: Vec<f64>,
    /// x(tau).
    pub displacement: Vec<f64>,
    /// b at tau.
    pub force: Vec<f64>,
    /// Direction of the sub-phase that starts; 0 where a stick starts.
    pub sign: Vec<i8>,
    /// 0 stick entered, 1 slip started, 2 sub-phase boundary.
    pub kind: Vec<i8>,
}

impl EventColumns {
    /// Append the events of the next path.
    pub fn push_path(&mut self, events: &[Event]) {
        self.count.push(events.len() as u32);
        for event in events {
            let (kind, sign) = match event.kind {
                EventKind::StickEntered => (0, 0),
                EventKind::SlipStarted(sign) => (1, number(sign)),
                EventKind::SubPhaseBoundary(sign) => (2, number(sign)),
            };
            self.time.push(event.time);
            self.displacement.push(event.displacement);
            self.force.push(event.force);
            self.sign.push(sign);
            self.kind.push(kind);
        }
    }
}

fn number(sign: Sign) -> i8 {
    match sign {
        Sign::Negative => -1,
        Sign::Positive => 1,
    }
}

/// Paths kept on the output grid; each matrix is row-major with shape (paths, rows of the output
/// grid).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrajectoryRows {
    /// Path numbers, in order.
    pub path: Vec<u64>,
    /// x(t).
    pub displacement: Vec<f64>,
    /// x'(t).
    pub velocity: Vec<f64>,
    /// T(t).
    pub temperature: Vec<f64>,
    /// b(t), every force but friction.
    pub force: Vec<f64>,
    /// F(t), the friction force: b in a static phase, f_d in the direction of motion otherwise.
    pub friction: Vec<f64>,
    /// 1 where static.
    pub is_static: Vec<i8>,
}

/// What one block of paths leaves behind; self-contained, and mergeable with its neighbours.
#[derive(Clone, Debug)]
pub struct BlockResult {
    /// Number of the first path.
    pub first_path: u64,
    /// Number of paths, diverged ones included.
    pub paths: u64,
    /// Numbers of the diverged paths.
    pub diverged: Vec<u64>,
    /// The sums every statistic is computed from.
    pub totals: Totals,
    /// If asked for.
    pub path_columns: Option<PathColumns>,
    /// If asked for; a diverged path has no events.
    pub events: Option<EventColumns>,
    /// If asked for and if the block holds any of the first paths.
    pub trajectories: Option<TrajectoryRows>,
}
