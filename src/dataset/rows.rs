//! What is recorded of single paths: the tables along `path`, `event` and `trajectory`.

use super::Values;
use super::layout::{self, Variable};
use crate::engine::Provenance;
use crate::scenario::Bearing;
use crate::stats::{BlockResult, EventColumns, PathColumns, Record, TrajectoryRows};

/// What is recorded of consecutive paths.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// Number of the first path.
    pub first_path: u64,
    /// Number of paths, diverged ones included.
    pub paths: u64,
    /// Scalars of each path, if they are recorded.
    pub path_columns: Option<&'a PathColumns>,
    /// Events of each path, if they are recorded.
    pub events: Option<&'a EventColumns>,
    /// Paths on the output grid, if any are recorded and these paths include any of them.
    pub trajectories: Option<&'a TrajectoryRows>,
}

impl<'a> From<&'a BlockResult> for Rows<'a> {
    fn from(block: &'a BlockResult) -> Rows<'a> {
        Rows {
            first_path: block.first_path,
            paths: block.paths,
            path_columns: block.path_columns.as_ref(),
            events: block.events.as_ref(),
            trajectories: block.trajectories.as_ref(),
        }
    }
}

/// The dimension along which the variables of a table grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Along {
    Path,
    Event,
    Trajectory,
}

/// Some rows of the variables that grow along one dimension.
pub(crate) struct Table<'a> {
    pub along: Along,
    pub rows: usize,
    pub variables: &'a [(&'static Variable, Values<'a>)],
}

/// Pass the tables that a run will have to `show`, without rows.
pub(crate) fn empty_tables<E>(
    record: &Record,
    header: &Provenance,
    visit: impl FnMut(Table) -> Result<(), E>,
) -> Result<(), E> {
    let (columns, events, trajectories) = Default::default();
    let rows = Rows {
        first_path: 0,
        paths: 0,
        path_columns: record.paths.then_some(&columns),
        events: record.events.then_some(&events),
        trajectories: (record.trajectories > 0 && !header.time.is_empty()).then_some(&trajectories),
    };
    tables(&rows, header.bearing, visit)
}

/// Pass the tables of some paths to `show`.
pub(crate) fn tables<E>(
    rows: &Rows,
    bearing: Option<Bearing>,
    mut visit: impl FnMut(Table) -> Result<(), E>,
) -> Result<(), E> {
    let Rows { first_path, paths, path_columns, events, trajectories } = *rows;
    if path_columns.is_some() || events.is_some() {
        let numbers: Vec<u64> = (first_path..).take(paths as usize).collect();
        let diverged: Vec<i8> =
            path_columns.iter().flat_map(|columns| &columns.diverged).map(|&diverged| diverged.into()).collect();
        let variables = path_variables(&numbers, path_columns, &diverged, events);
        visit(Table { along: Along::Path, rows: numbers.len(), variables: &variables })?;
    }
    if let Some(events) = events {
        visit(Table { along: Along::Event, rows: events.time.len(), variables: &event_variables(events) })?;
    }
    if let Some(trajectories) = trajectories {
        let shown = bearing.map(|bearing| -> Vec<f64> {
            let places = trajectories.displacement.iter().zip(&trajectories.friction);
            places.map(|(&x, &friction)| bearing.displacement(x, friction)).collect()
        });
        let variables = trajectory_variables(trajectories, shown.as_deref());
        visit(Table { along: Along::Trajectory, rows: trajectories.path.len(), variables: &variables })?;
    }
    Ok(())
}

/// The variables along `path` with their values. Variables that are not recorded are left out.
fn path_variables<'a>(
    numbers: &'a [u64],
    columns: Option<&'a PathColumns>,
    diverged: &'a [i8],
    events: Option<&'a EventColumns>,
) -> Vec<(&'static Variable, Values<'a>)> {
    let mut variables: Vec<(&Variable, Values)> = vec![(&layout::PATH, Values::U64(numbers))];
    if let Some(columns) = columns {
        variables.extend([
            (&layout::PATH_DISPLACEMENT_END, Values::F64(&columns.displacement_end)),
            (&layout::PATH_MAX_DISPLACEMENT, Values::F64(&columns.max_displacement)),
            (&layout::PATH_FIRST_STICK_DURATION, Values::F64(&columns.first_stick_duration)),
            (&layout::PATH_STICK_TIME, Values::F64(&columns.stick_time)),
            (&layout::PATH_FRICTION_WORK, Values::F64(&columns.friction_work)),
            (&layout::PATH_STICKS, Values::U32(&columns.sticks)),
            (&layout::PATH_SLIPS, Values::U32(&columns.slips)),
            (&layout::PATH_SUB_PHASES, Values::U32(&columns.sub_phases)),
            (&layout::PATH_DIVERGED, Values::I8(diverged)),
        ]);
    }
    if let Some(events) = events {
        variables.push((&layout::EVENT_COUNT, Values::U32(&events.count)));
    }
    variables
}

/// The variables along `event` with their values.
fn event_variables(events: &EventColumns) -> [(&'static Variable, Values<'_>); 5] {
    [
        (&layout::EVENT_TIME, Values::F64(&events.time)),
        (&layout::EVENT_DISPLACEMENT, Values::F64(&events.displacement)),
        (&layout::EVENT_FORCE, Values::F64(&events.force)),
        (&layout::EVENT_SIGN, Values::I8(&events.sign)),
        (&layout::EVENT_KIND, Values::I8(&events.kind)),
    ]
}

/// The variables along `trajectory` with their values. What a sensor shows is included only if
/// there is a sensor.
fn trajectory_variables<'a>(
    rows: &'a TrajectoryRows,
    shown: Option<&'a [f64]>,
) -> Vec<(&'static Variable, Values<'a>)> {
    let mut variables: Vec<(&Variable, Values)> = vec![
        (&layout::TRAJECTORY, Values::U64(&rows.path)),
        (&layout::TRAJECTORY_DISPLACEMENT, Values::F64(&rows.displacement)),
        (&layout::TRAJECTORY_VELOCITY, Values::F64(&rows.velocity)),
        (&layout::TRAJECTORY_TEMPERATURE, Values::F64(&rows.temperature)),
        (&layout::TRAJECTORY_FORCE, Values::F64(&rows.force)),
        (&layout::TRAJECTORY_FRICTION, Values::F64(&rows.friction)),
        (&layout::TRAJECTORY_STATIC, Values::I8(&rows.is_static)),
    ];
    variables.extend(shown.map(|shown| (&layout::TRAJECTORY_BEARING, Values::F64(shown))));
    variables
}
