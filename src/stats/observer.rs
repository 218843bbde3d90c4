//! Watches one block of paths and leaves its totals, and what was asked to be kept of each path.

use super::path::{Censored, Completed, PathFold};
use super::periods::PeriodFold;
use super::{BlockResult, EventColumns, PathColumns, Record, Totals, TrajectoryRows};
use crate::model::{Event, Model};
use crate::scheme::{Instant, Observer, Snapshot, Timeline};

/// The observer of one block of paths.
pub struct BlockObserver {
    /// Number of the path in each lane.
    path_numbers: Vec<u64>,
    paths: Vec<PathFold>,
    /// f_d.
    dynamic_force: f64,
    /// Rows of the output grid.
    rows: usize,
    totals: Totals,
    periods: PeriodFold,
    keeps_paths: bool,
    /// Events of each lane, if they are kept.
    events: Option<Vec<Vec<Event>>>,
    /// How many of the first paths of the run are kept on the output grid, and those of them that are in this block.
    trajectories: (u64, Vec<Trajectory>),
}

/// One path on the output grid.
struct Trajectory {
    lane: usize,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    temperature: Vec<f64>,
    is_static: Vec<i8>,
}

impl Trajectory {
    fn unknown(lane: usize, rows: usize) -> Self {
        let nothing = vec![f64::NAN; rows];
        Trajectory {
            lane,
            displacement: nothing.clone(),
            velocity: nothing.clone(),
            temperature: nothing,
            is_static: vec![0; rows],
        }
    }
}

impl BlockObserver {
    /// An observer of these paths, in ascending order; lane i is path `paths[i]`. Each is at rest at x0, in its first
    /// static phase.
    pub fn new(model: &Model, timeline: &Timeline, record: &Record, paths: &[u64]) -> Self {
        let rows = timeline.rows();
        let kept = paths.iter().take_while(|&&path| path < record.trajectories).count();
        BlockObserver {
            path_numbers: paths.to_vec(),
            paths: vec![PathFold::starting_at(model.initial_displacement); paths.len()],
            dynamic_force: model.friction.dynamic_force,
            rows,
            totals: Totals::empty(model, timeline),
            periods: PeriodFold::new(timeline, model.initial_displacement, paths.len()),
            keeps_paths: record.paths,
            events: record.events.then(|| vec![Vec::new(); paths.len()]),
            trajectories: (record.trajectories, (0..kept).map(|lane| Trajectory::unknown(lane, rows)).collect()),
        }
    }

    /// What the block leaves behind. It holds `path_count` paths from number `first_path` on, of which `diverged` did not
    /// reach t_end and were not watched.
    pub fn finish(mut self, first_path: u64, path_count: u64, diverged: Vec<u64>) -> BlockResult {
        self.totals.periods = self.periods.finish();
        self.totals.end(&self.paths, self.dynamic_force, &diverged);
        let block = Block { first_path, path_count, rows: self.rows, path_numbers: &self.path_numbers };
        let (wanted, trajectories) = self.trajectories;
        BlockResult {
            first_path,
            paths: path_count,
            diverged,
            path_columns: self.keeps_paths.then(|| block.path_columns(&self.paths, self.dynamic_force)),
            events: self.events.map(|events| block.event_columns(&events)),
            trajectories: (first_path < wanted).then(|| block.trajectory_rows(wanted, &trajectories)),
            totals: self.totals,
        }
    }

    fn end(&mut self, snapshot: &Snapshot<'_>) {
        for (path, &displacement) in self.paths.iter_mut().zip(snapshot.displacement) {
            match path.end(snapshot.time, displacement) {
                Censored::FirstStick => self.totals.durations.first_censored(),
                Censored::Stick(so_far) => self.totals.durations.censored(so_far),
                Censored::Slip => self.totals.sub_phases.censored(),
            }
        }
    }
}

impl Observer for BlockObserver {
    #[inline]
    fn event(&mut self, lane: usize, event: Event) {
        match self.paths[lane].event(&event) {
            Some(Completed::FirstStick) => self.totals.durations.first_completed(),
            Some(Completed::Stick(duration)) => self.totals.durations.completed(self.path_numbers[lane], duration),
            Some(Completed::Slip(sub_phases)) => self.totals.sub_phases.completed(sub_phases),
            None => {}
        }
        if let Some(events) = &mut self.events {
            events[lane].push(event);
        }
    }

    fn snapshot(&mut self, instant: Instant, snapshot: Snapshot<'_>) {
        match instant {
            Instant::Output(row) => {
                self.totals.bands.fold(row, &snapshot);
                for kept in &mut self.trajectories.1 {
                    kept.displacement[row] = snapshot.displacement[kept.lane];
                    kept.velocity[row] = snapshot.velocity[kept.lane];
                    kept.temperature[row] = snapshot.temperature[kept.lane];
                    kept.is_static[row] = i8::from(snapshot.is_static[kept.lane]);
                }
            }
            Instant::Period(n) => self.periods.fold(n, snapshot.displacement),
            Instant::End => self.end(&snapshot),
        }
    }
}

/// Which paths a block holds, and which of them were watched.
struct Block<'a> {
    first_path: u64,
    path_count: u64,
    rows: usize,
    path_numbers: &'a [u64],
}

impl Block<'_> {
    /// The lane of every path of the block, in order; none for a diverged path.
    fn lanes(&self) -> impl Iterator<Item = (u64, Option<usize>)> {
        let mut watched = self.path_numbers.iter().enumerate().peekable();
        (self.first_path..self.first_path + self.path_count)
            .map(move |number| (number, watched.next_if(|(_, path)| **path == number).map(|(lane, _)| lane)))
    }

    fn path_columns(&self, paths: &[PathFold], dynamic_force: f64) -> PathColumns {
        let mut columns = PathColumns::default();
        for (_, lane) in self.lanes() {
            let path = lane.map(|lane| &paths[lane]);
            let number = |of: fn(&PathFold) -> f64| path.map_or(f64::NAN, of);
            let count = |of: fn(&PathFold) -> u32| path.map_or(0, of);
            columns.displacement_end.push(number(|p| p.displacement_end));
            columns.max_displacement.push(number(|p| p.max_displacement));
            columns.first_stick_duration.push(number(|p| p.first_duration.unwrap_or(f64::NAN)));
            columns.stick_time.push(number(|p| p.stick_time));
            columns.friction_work.push(dynamic_force * number(|p| p.travel));
            columns.sticks.push(count(|p| p.sticks));
            columns.slips.push(count(|p| p.slips));
            columns.sub_phases.push(count(|p| p.sub_phases));
            columns.diverged.push(path.is_none());
        }
        columns
    }

    fn event_columns(&self, events: &[Vec<Event>]) -> EventColumns {
        let mut columns = EventColumns::default();
        for (_, lane) in self.lanes() {
            columns.push_path(lane.map_or(&[], |lane| &events[lane]));
        }
        columns
    }

    /// The paths of the block with numbers below `wanted`.
    fn trajectory_rows(&self, wanted: u64, kept: &[Trajectory]) -> TrajectoryRows {
        let mut columns = TrajectoryRows::default();
        for (number, lane) in self.lanes().take_while(|&(number, _)| number < wanted) {
            let unknown;
            let trajectory = match lane {
                Some(lane) => &kept[lane],
                None => {
                    unknown = Trajectory::unknown(0, self.rows);
                    &unknown
                }
            };
            columns.path.push(number);
            columns.displacement.extend_from_slice(&trajectory.displacement);
            columns.velocity.extend_from_slice(&trajectory.velocity);
            columns.temperature.extend_from_slice(&trajectory.temperature);
            columns.is_static.extend_from_slice(&trajectory.is_static);
        }
        columns
    }
}
