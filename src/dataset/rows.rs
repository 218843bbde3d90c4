//! What is recorded of single paths: the tables along `path`, `event` and `trajectory`.

use super::ColumnView;
use super::layout::{self, Variable};
use crate::engine::Provenance;
use crate::scenario::SensorBearing;
use crate::stats::column::Columns as _;
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
pub(crate) enum RowAxis {
    Path,
    Event,
    Trajectory,
}

impl RowAxis {
    /// The name of the dimension.
    pub(crate) fn axis(self) -> &'static str {
        match self {
            RowAxis::Path => "path",
            RowAxis::Event => "event",
            RowAxis::Trajectory => "trajectory",
        }
    }
}

/// Some rows of the variables that grow along one dimension.
pub(crate) struct RowTable<'a> {
    pub along: RowAxis,
    pub rows: usize,
    pub variables: &'a [(&'static Variable, ColumnView<'a>)],
}

/// Pass the tables that a run will have to `visit`, without rows.
pub(crate) fn empty_tables<E>(
    record: &Record,
    header: &Provenance,
    visit: impl FnMut(RowTable) -> Result<(), E>,
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

/// Pass the tables of some paths to `visit`.
pub(crate) fn tables<E>(
    rows: &Rows,
    bearing: Option<SensorBearing>,
    mut visit: impl FnMut(RowTable) -> Result<(), E>,
) -> Result<(), E> {
    let Rows { first_path, paths, path_columns, events, trajectories } = *rows;
    let (mut numbers, mut shown) = (Vec::new(), Vec::new());
    let mut variables: Vec<(&'static Variable, ColumnView)> = Vec::new();
    if path_columns.is_some() || events.is_some() {
        numbers.extend((first_path..).take(paths as usize));
        variables.push((&layout::PATH, (&numbers).into()));
    }
    variables.extend(path_columns.iter().flat_map(|columns| columns.columns()));
    variables.extend(events.iter().flat_map(|columns| columns.columns()));
    variables.extend(trajectories.iter().flat_map(|columns| columns.columns()));
    // What a sensor shows is included only if there is a sensor.
    if let (Some(bearing), Some(trajectories)) = (bearing, trajectories) {
        let places = trajectories.displacement.iter().zip(&trajectories.friction);
        shown.extend(places.map(|(&x, &friction)| bearing.displacement(x, friction)));
        variables.push((&layout::TRAJECTORY_BEARING, (&shown).into()));
    }
    for along in [RowAxis::Path, RowAxis::Event, RowAxis::Trajectory] {
        let of_table = variables.iter().filter(|(variable, _)| variable.axes[0] == along.axis());
        let variables: Vec<_> = of_table.copied().collect();
        if let Some((_, first)) = variables.first() {
            visit(RowTable { along, rows: first.len(), variables: &variables })?;
        }
    }
    Ok(())
}
