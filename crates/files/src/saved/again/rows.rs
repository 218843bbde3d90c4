//! A run against its scenario: [`Verification`] takes the place of the writer.

use super::{Against, Difference};
use crate::dataset::rows::RowAxis;
use crate::dataset::{
    Dataset, ElementType, Entry, Source, StoredRun, header, layout, read_or_empty, read_variable,
    run, summary,
};
use crate::saved::state::of_bytes;
use std::path::Path;
use stickslip::engine::{Asked, Part, Provenance, Status};
use stickslip::ensemble::BLOCK_SIZE;
use stickslip::stats::column::values_of;
use stickslip::stats::{BlockRows, EVENT_COUNT, Record, Summary};

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
        let paths = if ended_by.is_some() {
            stored.header.paths
        } else {
            own.paths
        };
        let all = Asked {
            part,
            ..Asked::paths(paths)
        }
        .own_paths();
        let (status, completed_paths) = match (&ended_by, part) {
            // It ended after a block that is not the last.
            (Some(_), _) => (
                Status::Ended,
                stored.completed_paths.min(all) / BLOCK_SIZE * BLOCK_SIZE,
            ),
            (None, _) if stored.status == Status::Interrupted && stored.completed_paths < all => (
                Status::Interrupted,
                stored.completed_paths / BLOCK_SIZE * BLOCK_SIZE,
            ),
            (None, Some(_)) => (Status::Part, all),
            (None, None) => (Status::Complete, all),
        };
        Expected {
            header: Provenance { paths, ..own },
            record,
            status,
            completed_paths,
            part,
            ended_by,
        }
    }
}

/// A run that is stored, while it is compared with a simulation of its scenario.
pub(super) struct Verification<'a> {
    pub against: Against<'a>,
    /// The number of the first path.
    origin: u64,
    header: &'a Provenance,
    /// The first path whose events are not counted yet, and the number of events before it.
    counted: (u64, usize),
}

impl<'a> Verification<'a> {
    /// Of a run with this header, whose first path is number `origin`.
    pub fn of(held: &'a dyn Source, origin: u64, header: &'a Provenance) -> Self {
        Verification {
            against: Against::of(held),
            origin,
            header,
            counted: (origin, 0),
        }
    }

    /// Compare everything but the rows: attributes, coordinates, lengths and statistics. `summary`
    /// holds the statistics that were computed again, or else those that are stored, whose derived
    /// values are then compared.
    pub fn rest(&mut self, expected: &Expected, summary: &Summary) -> Result<(), String> {
        let mut run = run::start(&expected.header, &expected.record);
        run::write_end(&mut run, summary, expected.status);
        run.set_attribute("completed_paths", expected.completed_paths);
        header::write_ended_by(&mut run, expected.ended_by.clone());
        header::write_part(&mut run, expected.part);
        if expected.part.is_some() {
            // Its values are compared below.
            run.write(
                &layout::PART_STATE,
                &read_or_empty::<u8>(self.against.held, &layout::PART_STATE)?,
            );
        }
        self.against.variables(&run)?;
        for entry in &run.entries {
            if let Some(along) = RowAxis::of(entry) {
                self.lengths(expected, along, entry)?;
            }
        }
        self.against.finish(&run)?;
        if self.against.difference.is_none() && expected.part.is_some() {
            self.part_state(expected)
        } else {
            Ok(())
        }
    }

    /// See that a variable has as many rows as there are paths or events, and compare its
    /// attributes.
    fn lengths(
        &mut self,
        expected: &Expected,
        along: RowAxis,
        entry: &Entry,
    ) -> Result<(), String> {
        let paths = expected.completed_paths;
        let rows = match along {
            RowAxis::Path => paths as usize,
            RowAxis::Trajectory => expected
                .record
                .trajectories
                .saturating_sub(self.origin)
                .min(paths) as usize,
            RowAxis::Event => self.events_before(self.origin + paths)?,
        };
        let held = self.against.held;
        let check = |against: &mut Against, name: &str, is_bare: bool| -> Result<(), String> {
            // Another program may have left out a dimension without a variable.
            let there = held.length(name)?.unwrap_or(if is_bare { rows } else { 0 });
            if there != rows && !(is_bare && there == 0 && held.is_laid_out_anew()) {
                against.differs(
                    name,
                    None,
                    (
                        None,
                        format!("one of {there} rows"),
                        format!("one of {rows}"),
                    ),
                );
            }
            Ok(())
        };
        if along == RowAxis::Event {
            self.against.exempt(&layout::EVENT);
            check(&mut self.against, layout::EVENT.name, true)?;
        }
        check(&mut self.against, &entry.name, false)?;
        self.against.described(entry)
    }

    /// The state from which a part is joined to the others must have the scenario and the
    /// statistics of the part.
    fn part_state(&mut self, expected: &Expected) -> Result<(), String> {
        let name = layout::PART_STATE.name;
        let bytes: Vec<u8> = read_variable(self.against.held, &layout::PART_STATE)?;
        let state = of_bytes(&bytes, Path::new(name)).map_err(|error| error.to_string())?;
        let mut derived = Dataset::new(&expected.header.units);
        summary::write(&mut derived, &state.so_far.totals.totals().summary());
        let mut against = Against::of(self.against.held);
        against.variables(&derived)?;
        if let Some(difference) = against.difference {
            let variable = format!("{} in {name}", difference.variable);
            self.against.difference.get_or_insert(Difference {
                variable,
                ..difference
            });
        }
        if state.header().scenario_text != expected.header.scenario_text {
            self.against.differs(
                name,
                None,
                (
                    None,
                    "another scenario".into(),
                    "the one in the file".into(),
                ),
            );
        }
        Ok(())
    }

    /// Compare the rows that are stored with those of a block that was simulated again. Blocks must
    /// be given in ascending order.
    pub fn block(&mut self, block: &BlockRows) -> Result<(), String> {
        let computed = Dataset::of_rows(block, &self.header.units, self.header.bearing);
        let first = (block.first_path - self.origin) as usize;
        let counts = block
            .events
            .as_ref()
            .map_or(&[][..], |events| &events.count);
        let first_event = if counts.is_empty() {
            0
        } else {
            self.events_before(block.first_path)?
        };
        let events = counts.iter().map(|&count| count as usize).sum::<usize>();
        self.counted = (block.first_path + block.paths, first_event + events);
        for entry in &computed.entries {
            let (shape, values) = (computed.shape(entry), entry.column.values());
            let width = shape[1..].iter().product::<usize>();
            let along = RowAxis::of(entry);
            let start = if along == Some(RowAxis::Event) {
                first_event
            } else {
                first
            };
            if self.against.difference.is_some() || values.is_empty() {
                continue;
            }
            self.against.values += values.len() as u64;
            let there =
                self.against
                    .held
                    .rows(&entry.name, values.kind(), &(start..start + shape[0]))?;
            let Some((at, stored, computed)) = there.values().first_difference(values) else {
                continue;
            };
            let (row, within) = (at.unwrap_or(0) / width, at.unwrap_or(0) % width);
            let (path, index) = if along == Some(RowAxis::Event) {
                path_of(counts, row)
            } else {
                (row, within)
            };
            let path = block.first_path + path as u64;
            self.against
                .differs(&entry.name, Some(path), (Some(index), stored, computed));
        }
        Ok(())
    }

    /// The number of events of all paths before this one, as it is stored.
    fn events_before(&self, path: u64) -> Result<usize, String> {
        let (mut next, mut events) = self.counted;
        while next < path {
            let some = next..path.min(next + PIECE);
            let rows = (some.start - self.origin) as usize..(some.end - self.origin) as usize;
            let counts = self
                .against
                .held
                .rows(EVENT_COUNT.name, ElementType::U32, &rows)?;
            events += values_of::<u32>(&EVENT_COUNT, counts)?
                .iter()
                .map(|&count| count as usize)
                .sum::<usize>();
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
