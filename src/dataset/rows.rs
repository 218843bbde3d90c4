//! Records of single paths: the tables along `path`, `event` and `trajectory`.

use super::layout;
use super::{Dataset, Element as _, Entry};
use crate::engine::Provenance;
use crate::scenario::SensorBearing;
use crate::stats::column::Columns as _;
use crate::stats::{BlockRows, EventColumns, PathColumns, Record, TrajectoryRows, Units};

/// The dimension along which the variables of a table grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowAxis {
    Path,
    Event,
    Trajectory,
}

impl RowAxis {
    pub const ALL: [RowAxis; 3] = [RowAxis::Path, RowAxis::Event, RowAxis::Trajectory];

    /// The name of the dimension.
    pub fn axis(self) -> &'static str {
        match self {
            RowAxis::Path => "path",
            RowAxis::Event => "event",
            RowAxis::Trajectory => "trajectory",
        }
    }

    /// The dimension along which a variable grows; none if it does not.
    pub fn of(entry: &Entry) -> Option<RowAxis> {
        let first = entry.axes.first()?;
        RowAxis::ALL.into_iter().find(|along| along.axis() == first)
    }
}

impl Dataset {
    /// The variables of single paths that a run will have, without rows.
    pub(super) fn without_rows(record: &Record, header: &Provenance) -> Dataset {
        let rows = BlockRows {
            path_columns: record.paths.then(PathColumns::default),
            events: record.events.then(EventColumns::default),
            trajectories: (record.trajectories > 0 && !header.time.is_empty())
                .then(TrajectoryRows::default),
            ..BlockRows::default()
        };
        Dataset::of_rows(&rows, &header.units, header.bearing)
    }

    /// The rows of some paths.
    pub fn of_rows(rows: &BlockRows, units: &Units, bearing: Option<SensorBearing>) -> Dataset {
        let BlockRows {
            first_path,
            paths,
            path_columns,
            events,
            trajectories,
        } = rows;
        let mut dataset = Dataset::new(units);
        if path_columns.is_some() || events.is_some() {
            dataset.begin(
                &layout::PATH,
                u64::values(&(*first_path..).take(*paths as usize).collect::<Vec<_>>()),
            );
        }
        let columns = path_columns.iter().flat_map(|columns| columns.columns());
        let columns = columns.chain(events.iter().flat_map(|columns| columns.columns()));
        let columns = columns.chain(trajectories.iter().flat_map(|columns| columns.columns()));
        columns.for_each(|(variable, values)| dataset.begin(variable, values));
        // The reading of a sensor is included only if there is a sensor.
        if let (Some(bearing), Some(trajectories)) = (bearing, trajectories) {
            let places = trajectories.displacement.iter().zip(&trajectories.friction);
            let shown: Vec<f64> = places
                .map(|(&x, &friction)| bearing.displacement(x, friction))
                .collect();
            dataset.begin(&layout::TRAJECTORY_BEARING, f64::values(&shown));
        }
        dataset
    }

    /// Add the rows of the next paths. Variables that are not there yet are created.
    pub(super) fn grow(&mut self, rows: Dataset) {
        for new in rows.entries {
            match self.entries.iter_mut().find(|entry| entry.name == new.name) {
                Some(entry) => entry.column.extend(new.column.values()),
                None => self.entries.push(new),
            }
        }
    }

    /// Add the rows of single paths from another part of the run. Fails if a variable is missing
    /// there or has another type.
    pub fn append_rows(&mut self, part: &Dataset) -> Result<(), String> {
        for entry in self
            .entries
            .iter_mut()
            .filter(|entry| RowAxis::of(entry).is_some())
        {
            let more = part
                .entry(&entry.name)
                .ok_or_else(|| format!("{} is missing", entry.name))?;
            let more = more.column.values();
            if more.kind() != entry.column.values().kind() {
                return Err(format!("{} has the wrong type", entry.name));
            }
            entry.column.extend(more);
        }
        Ok(())
    }
}
