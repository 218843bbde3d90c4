//! What a run keeps of single paths, on request.

use super::Totals;
use crate::model::{Event, EventKind, Sign};

/// What a run keeps besides the statistics of the ensemble.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// Whether scalars of every path are kept.
    pub paths: bool,
    /// Whether the events of every path are kept.
    pub events: bool,
    /// How many paths, from the first on, are kept on the output grid.
    pub trajectories: u64,
}

impl Record {
    /// Nothing is kept of single paths.
    pub const NOTHING: Record = Record { paths: false, events: false, trajectories: 0 };
}

/// Scalars of each path, one entry per path, in the order of the path numbers. A diverged path has
/// NaN and zeros.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathColumns {
    /// Displacement at the end, x(t_end).
    pub displacement_end: Vec<f64>,
    /// Largest |x| over [0, t_end].
    pub max_displacement: Vec<f64>,
    /// D_0; NaN if the first stick still runs at t_end.
    pub first_stick_duration: Vec<f64>,
    /// Static time within [after, t_end], the first and the last stick included.
    pub stick_time: Vec<f64>,
    /// Integral of f_d |x'| dt over [after, t_end].
    pub friction_work: Vec<f64>,
    /// Completed sticks, j >= 1, that began at `after` or later.
    pub sticks: Vec<u32>,
    /// Completed dynamic phases that began at `after` or later.
    pub slips: Vec<u32>,
    /// Sum of k(j) over these dynamic phases.
    pub sub_phases: Vec<u32>,
    /// Whether the path diverged.
    pub diverged: Vec<bool>,
}

/// Event tables of consecutive paths, one after the other (CF contiguous ragged arrays).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EventColumns {
    /// Number of events of each path.
    pub count: Vec<u32>,
    /// tau, the time of each event.
    pub time: Vec<f64>,
    /// Displacement x at each event.
    pub displacement: Vec<f64>,
    /// Force b at each event, the total of all forces except friction.
    pub force: Vec<f64>,
    /// Direction of the sub-phase that starts, -1 or 1; 0 where a stick starts.
    pub sign: Vec<i8>,
    /// Kind of each event: 0 stick entered, 1 slip started, 2 sub-phase boundary.
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

/// Paths on the output grid. Each matrix is row-major with shape (paths, rows of the output grid).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrajectoryRows {
    /// Path numbers, in order.
    pub path: Vec<u64>,
    /// Displacement x(t).
    pub displacement: Vec<f64>,
    /// Velocity x'(t).
    pub velocity: Vec<f64>,
    /// Temperature T(t).
    pub temperature: Vec<f64>,
    /// b(t), the total of all forces except friction.
    pub force: Vec<f64>,
    /// Friction force F(t): b in a static phase, f_d in the direction of motion otherwise.
    pub friction: Vec<f64>,
    /// 1 in a static phase, 0 otherwise.
    pub is_static: Vec<i8>,
}

/// The result of one block of paths. It depends on no other block, and can be merged with its
/// neighbours.
#[derive(Clone, Debug)]
pub struct BlockResult {
    /// Number of the first path.
    pub first_path: u64,
    /// Number of paths, diverged ones included.
    pub paths: u64,
    /// Numbers of the diverged paths.
    pub diverged: Vec<u64>,
    /// The sums and counts from which every statistic is computed.
    pub totals: Totals,
    /// Scalars of each path, if they are kept.
    pub path_columns: Option<PathColumns>,
    /// Events of each path, if they are kept. A diverged path has none.
    pub events: Option<EventColumns>,
    /// Paths on the output grid, if any are kept and the block has any of them.
    pub trajectories: Option<TrajectoryRows>,
}
