//! Records of single paths, on request.

use super::Totals;
use super::column::{
    Column, ColumnView, Columns, Element, ElementType, Unit, Variable, columns, values_of, variable,
};
use crate::model::{Event, EventKind, Sign};

columns! {
    /// Scalars of each path, one entry per path, in the order of the path numbers. A diverged path
    /// has NaN and zeros.
    PathColumns {}
    /// The scalars of a path.
    PathRow {
        /// Displacement at the end, x(t_end).
        displacement_end: f64 =
            variable("path_displacement_end", &["path"], Unit::LENGTH, "displacement at the end");
        /// Largest |x| over [0, t_end].
        max_displacement: f64 =
            variable("path_max_displacement", &["path"], Unit::LENGTH, "largest absolute displacement");
        /// D_0; NaN if the first stick still runs at t_end.
        first_stick_duration: f64 = variable("path_first_stick_duration", &["path"], Unit::TIME,
            "duration of the first stick, missing if it is still running at the end");
        /// Static time within [after, t_end], the first and the last stick included.
        stick_time: f64 = variable("path_stick_time", &["path"], Unit::TIME, "total time in static phases");
        /// Integral of f_d |x'| dt over [after, t_end].
        friction_work: f64 =
            variable("path_friction_work", &["path"], Unit::WORK, "work done against dynamic friction");
        /// Completed sticks, j >= 1, that began at `after` or later.
        sticks: u32 = variable("path_sticks", &["path"], Unit::ONE, "completed sticks, without the first");
        /// Completed dynamic phases that began at `after` or later.
        slips: u32 = variable("path_slips", &["path"], Unit::ONE, "completed dynamic phases");
        /// Sum of k(j) over these dynamic phases.
        sub_phases: u32 =
            variable("path_sub_phases", &["path"], Unit::ONE, "sub-phases of the completed dynamic phases");
        /// 1 if the path diverged or was given up, 0 otherwise.
        diverged: i8 = variable("path_diverged", &["path"], Unit::None, "whether the path diverged or was given up")
            .flags(&[0, 1], &[("flag_meanings", "finite diverged")]);
    }
}

/// The number of events of each path.
pub const EVENT_COUNT: Variable = variable(
    "event_count",
    &["path"],
    Unit::ONE,
    "number of events of the path",
)
.with(&[("sample_dimension", "event")]);

columns! {
    /// Event tables of consecutive paths, one after the other (CF contiguous ragged arrays).
    EventColumns {
        /// Number of events of each path.
        count: u32 = EVENT_COUNT;
    }
    /// An event.
    EventRow {
        /// tau, the time of each event.
        time: f64 = variable("event_time", &["event"], Unit::TIME, "time of the event");
        /// Displacement x at each event.
        displacement: f64 = variable("event_displacement", &["event"], Unit::LENGTH, "displacement at the event");
        /// Force b at each event, the total of all forces except friction.
        force: f64 =
            variable("event_force", &["event"], Unit::FORCE, "total force without friction (b) at the event");
        /// Direction of the sub-phase that starts, -1 or 1; 0 where a stick starts.
        sign: i8 = variable("event_sign", &["event"], Unit::None, "direction of the sub-phase that starts")
            .flags(&[-1, 0, 1], &[("flag_meanings", "negative none positive")]);
        /// Kind of each event: 0 stick entered, 1 slip started, 2 sub-phase boundary.
        kind: i8 = variable("event_kind", &["event"], Unit::None, "kind of the event")
            .flags(&[0, 1, 2], &[("flag_meanings", "stick_entered slip_started sub_phase_boundary")]);
    }
}

impl EventColumns {
    /// Append the events of the next path.
    pub fn push_path(&mut self, events: &[Event]) {
        self.count.push(events.len() as u32);
        for &Event {
            time,
            displacement,
            force,
            kind,
        } in events
        {
            let (kind, sign) = match kind {
                EventKind::StickEntered => (0, 0),
                EventKind::SlipStarted(sign) => (1, number(sign)),
                EventKind::SubPhaseBoundary(sign) => (2, number(sign)),
            };
            self.push(EventRow {
                time,
                displacement,
                force,
                sign,
                kind,
            });
        }
    }
}

fn number(sign: Sign) -> i8 {
    match sign {
        Sign::Negative => -1,
        Sign::Positive => 1,
    }
}

/// The axes of the records of a path on the output grid.
pub const ON_THE_GRID: &[&str] = &["trajectory", "time"];

columns! {
    /// Paths on the output grid. Each matrix is row-major with shape (paths, rows of the output
    /// grid).
    TrajectoryRows {
        /// Path numbers, in order.
        path: u64 = variable("trajectory", &["trajectory"], Unit::ONE, "path number");
    }
    /// A path at one time of the output grid.
    TrajectoryRow {
        /// Displacement x(t).
        displacement: f64 = variable("trajectory_displacement", ON_THE_GRID, Unit::LENGTH, "displacement");
        /// Velocity x'(t).
        velocity: f64 = variable("trajectory_velocity", ON_THE_GRID, Unit::VELOCITY, "velocity");
        /// Temperature T(t).
        temperature: f64 = variable("trajectory_temperature", ON_THE_GRID, Unit::TEMPERATURE, "temperature");
        /// b(t), the total of all forces except friction.
        force: f64 = variable("trajectory_force", ON_THE_GRID, Unit::FORCE, "total force without friction (b)");
        /// Friction force F(t): b in a static phase, f_d in the direction of motion otherwise.
        friction: f64 = variable("trajectory_friction", ON_THE_GRID, Unit::FORCE, "friction force (F)");
        /// 1 in a static phase, 0 otherwise.
        is_static: i8 =
            variable("trajectory_static", ON_THE_GRID, Unit::None, "whether the path is in a static phase")
                .flags(&[0, 1], &[("flag_meanings", "dynamic static")]);
    }
}

/// The records of consecutive paths.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockRows {
    /// Number of the first path.
    pub first_path: u64,
    /// Number of paths, diverged ones included.
    pub paths: u64,
    /// Scalars of each path, if they are kept.
    pub path_columns: Option<PathColumns>,
    /// Events of each path, if they are kept. A diverged path has none.
    pub events: Option<EventColumns>,
    /// Paths on the output grid, if any are kept and these paths include any of them.
    pub trajectories: Option<TrajectoryRows>,
}

/// The result of one block of paths. It depends on no other block, and can be merged with its
/// neighbours.
#[derive(Clone, Debug)]
pub struct BlockResult {
    /// The numbers of these paths, and the records of each.
    pub rows: BlockRows,
    /// Numbers of the diverged paths.
    pub diverged: Vec<u64>,
    /// The sums and counts from which every statistic is computed.
    pub totals: Totals,
}
