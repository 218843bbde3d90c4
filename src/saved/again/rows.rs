//! A run against its scenario: [`Verification`] takes the place of the writer.

use super::{Against, Difference, Held, ReadError};
use crate::dataset::header;
use crate::dataset::layout::{self, Variable};
use crate::dataset::rows::{self, RowAxis, RowTable};
use crate::dataset::{ColumnView, Destination as _, ElementType, Rows, StoredRun, read_variable, run, summary};
use crate::engine::{Asked, Part, Provenance, Status};
use crate::ensemble::BLOCK_SIZE;
use crate::saved::state::of_bytes;
use crate::scenario::SensorBearing;
use crate::stats::column::{FirstDifference, values_of};
use crate::stats::{BlockResult, EVENT_COUNT, Record, Summary};
use std::ops::Range;
use std::path::Path;

/// Number of rows that are read at a time.
const PIECE: u64 = 65_536;

/// What a run must say of itself, given its scenario.
#[derive(Clone, Debug)]
pub(super) struct Expected {
    /// Where its numbers come from.
    pub header: Provenance,
    /// What it records of single paths.
    pub record: Record,
    /// How the run ended.
    pub status: Status,
    /// Number of paths.
    pub completed_paths: u64,
    /// Which part of a run it is, if it is one.
    pub part: Option<Part>,
    /// What ended the run before its last path. This is a fact that a scenario does not tell.
    pub ended_by: Option<String>,
}

impl Expected {
    /// What this run must say if its scenario has this provenance. The number of paths is that of
    /// the scenario, except in a run that ended at a goal.
    pub fn of(stored: &StoredRun, own: Provenance, record: Record) -> Expected {
        let (part, ended_by) = (stored.part, stored.ended_by.clone());
        let paths = if ended_by.is_some() { stored.header.paths } else { own.paths };
        let all = Asked { part, ..Asked::paths(paths) }.own_paths();
        let (status, completed_paths) = match (&ended_by, part) {
            // It ended after a block that is not the last.
            (Some(_), _) => (Status::Ended, stored.completed_paths.min(all) / BLOCK_SIZE * BLOCK_SIZE),
            (None, _) if stored.status == Status::Interrupted && stored.completed_paths < all => {
                (Status::Interrupted, stored.completed_paths / BLOCK_SIZE * BLOCK_SIZE)
            }
            (None, Some(_)) => (Status::Part, all),
            (None, None) => (Status::Complete, all),
        };
        Expected { header: Provenance { paths, ..own }, record, status, completed_paths, part, ended_by }
    }
}

/// A run that is stored, while it is compared with a simulation of its scenario.
#[derive(Debug)]
pub(super) struct Verification<'a, H> {
    against: Against<'a, H>,
    /// The number of the first path.
    origin: u64,
    bearing: Option<SensorBearing>,
    /// The first path whose events are not counted yet, and the number of events before it.
    counted: (u64, usize),
}

impl<'a, H: Held> Verification<'a, H> {
    /// Of a run with this header, whose first path is number `origin`.
    pub fn of(held: &'a H, origin: u64, header: &Provenance) -> Self {
        let against = Against::of(held, header.units.clone());
        Verification { against, origin, bearing: header.bearing, counted: (origin, 0) }
    }

    /// Number of values and texts that were compared so far.
    pub fn values(&self) -> u64 {
        self.against.values()
    }

    /// The first difference that was found, if any.
    pub fn difference(&self) -> Option<&Difference> {
        self.against.difference()
    }

    /// Compare the rows that are stored with those of a block that was simulated again. Blocks must
    /// be given in ascending order.
    pub fn block(&mut self, block: &BlockResult) -> Result<(), ReadError<H>> {
        rows::tables(&Rows::from(block), self.bearing, |table| self.table(block, &table))
    }

    /// Compare everything but the rows: attributes, coordinates, lengths and statistics. `summary`
    /// holds the statistics that were computed again, or else those that are stored, whose derived
    /// values are then compared.
    pub fn rest(&mut self, expected: &Expected, summary: &Summary) -> Result<(), ReadError<H>> {
        let Expected { header, record, status, completed_paths, part, ended_by } = expected;
        let against = &mut self.against;
        run::write_start(against, header)?;
        run::write_end(against, summary, *status)?;
        against.set_attribute("completed_paths", *completed_paths)?;
        if let Some(reason) = ended_by {
            header::write_ended_by(against, reason)?;
        }
        if let Some(part) = part {
            header::write_part(against, *part)?;
            against.describe(&layout::PART_STATE, ElementType::U8)?;
        }
        rows::empty_tables(record, header, |table| self.lengths(expected, &table))?;
        self.against.finish()?;
        if self.difference().is_none() && part.is_some() { self.part_state(expected) } else { Ok(()) }
    }

    /// See that a table has as many rows as there are paths or events, and compare the attributes
    /// of its variables.
    fn lengths(&mut self, expected: &Expected, table: &RowTable) -> Result<(), ReadError<H>> {
        let paths = expected.completed_paths;
        let rows = match table.along {
            RowAxis::Path => paths as usize,
            RowAxis::Trajectory => expected.record.trajectories.saturating_sub(self.origin).min(paths) as usize,
            RowAxis::Event => {
                let rows = self.events_before(self.origin + paths)?;
                self.bare(&layout::EVENT, rows)?;
                rows
            }
        };
        for (variable, values) in table.variables {
            let there = self.against.held.length(variable.name)?.unwrap_or(0);
            if rows == 0 && there == 0 {
                continue;
            }
            self.against.describe(variable, values.kind())?;
            if there != rows {
                let (stored, computed) = (format!("one of {there} rows"), format!("one of {rows}"));
                self.differs(variable.name, None, (None, stored, computed));
            }
        }
        Ok(())
    }

    /// A dimension without a variable has this length and no values.
    fn bare(&mut self, dimension: &Variable, rows: usize) -> Result<(), ReadError<H>> {
        self.against.describe(dimension, ElementType::U32)?;
        if let Some(found) = self.against.held.bare_difference(dimension.name, rows)? {
            self.differs(dimension.name, None, found);
        }
        Ok(())
    }

    /// The state from which a part is joined to the others must have the scenario and the
    /// statistics of the part.
    fn part_state(&mut self, expected: &Expected) -> Result<(), ReadError<H>> {
        let bytes: Vec<u8> = read_variable(self.against.held, &layout::PART_STATE)?;
        let state = of_bytes(&bytes, Path::new(layout::PART_STATE.name)).map_err(|error| error.to_string())?;
        let mut derived = Against::of(self.against.held, expected.header.units.clone());
        summary::write(&mut derived, &state.so_far.totals.totals().summary())?;
        if let Some(difference) = derived.difference() {
            let variable = format!("{} in {}", difference.variable, layout::PART_STATE.name);
            self.against.differ(Difference { variable, ..difference.clone() });
        }
        let text = |header: &Provenance| header.scenario_text.clone();
        if text(&state.header()) != text(&expected.header) {
            let (stored, computed) = ("another scenario".into(), "that of the file".into());
            self.differs(layout::PART_STATE.name, None, (None, stored, computed));
        }
        Ok(())
    }

    fn differs(&mut self, variable: &str, path: Option<u64>, (index, stored, computed): FirstDifference) {
        self.against.differ(Difference { variable: variable.to_owned(), path, index, stored, computed });
    }

    /// Compare the rows of a block along one dimension.
    fn table(&mut self, block: &BlockResult, table: &RowTable) -> Result<(), ReadError<H>> {
        if self.difference().is_some() {
            return Ok(());
        }
        let first = (block.first_path - self.origin) as usize;
        let counts = block.events.as_ref().map_or(&[][..], |events| &events.count);
        let rows = match table.along {
            RowAxis::Path | RowAxis::Trajectory => first..first + table.rows,
            RowAxis::Event => {
                let start = self.events_before(block.first_path)?;
                self.counted = (block.first_path + block.paths, start + table.rows);
                start..start + table.rows
            }
        };
        for (variable, values) in table.variables {
            let Some((at, stored, computed)) = self.held(variable, *values, &rows)? else { continue };
            let (width, at) = (values.len() / table.rows, at.unwrap_or(0));
            let (row, within) = (at / width, at % width);
            let (path, index) = match table.along {
                RowAxis::Path | RowAxis::Trajectory => (row, within),
                RowAxis::Event => path_of(counts, row),
            };
            self.differs(variable.name, Some(block.first_path + path as u64), (Some(index), stored, computed));
            return Ok(());
        }
        Ok(())
    }

    /// Compare some rows of a variable; returns the first difference.
    fn held(
        &mut self,
        variable: &Variable,
        values: ColumnView,
        rows: &Range<usize>,
    ) -> Result<Option<FirstDifference>, ReadError<H>> {
        if rows.is_empty() {
            return Ok(None);
        }
        self.against.count(values.len());
        Ok(self.against.held.rows(variable, values.kind(), rows)?.values().first_difference(values))
    }

    /// The number of events of all paths before this one, as it is stored.
    fn events_before(&mut self, path: u64) -> Result<usize, ReadError<H>> {
        let (mut next, mut events) = self.counted;
        while next < path {
            let some = next..path.min(next + PIECE);
            let rows = (some.start - self.origin) as usize..(some.end - self.origin) as usize;
            let counts: Vec<u32> =
                values_of(&EVENT_COUNT, self.against.held.rows(&EVENT_COUNT, ElementType::U32, &rows)?)?;
            events += counts.iter().map(|&count| count as usize).sum::<usize>();
            next = some.end;
        }
        Ok(events)
    }
}

/// The path, counted from the first of the block, and the event of that path that a row of events
/// belongs to.
fn path_of(counts: &[u32], row: usize) -> (usize, usize) {
    let mut left = row;
    for (path, &count) in counts.iter().enumerate() {
        match left.checked_sub(count as usize) {
            Some(rest) => left = rest,
            None => return (path, left),
        }
    }
    (counts.len(), left)
}
