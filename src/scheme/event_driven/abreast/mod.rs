//! Paths abreast: all paths of a block cross a cell together, in lanes.
//!
//! ```text
//! sweep    draws n at the end of the cell, and takes every path there as if it had no event
//! queues   treat the lanes that may have an event: a stick that may be left, a slip that may stop
//! alone    the few lanes that meet a rare case cross the cell again, one by one
//! ```
//!
//! A lane does the same as [`super::cell_loop::cross`], with the same random numbers and the same
//! rounding, so a path has the same bits abreast and alone. Therefore rare cases (the end of a
//! bisection, noise that is too feeble for the quintic, a start on a threshold) need not be treated
//! in lanes: such a lane crosses the cell again alone.
//!
//! This is for scenes in which a slip takes one step per cell. Where the body oscillates much
//! faster than forcing and noise change, paths are simulated one by one.

mod jobs;
mod slip;
mod stick;
mod sweep;
#[cfg(test)]
mod tests;

use super::cell_loop::{self, Cascade, Inside, LOST, Path, Paths};
use super::cells::Cell;
use super::corridor::Pending;
use super::noisy::{Noisy, Scratch};
use super::slip_transition::HarmonicResponse;
use super::watch::{Nobody, StickEnd, StickPiece, Watch as _};
use super::work::{Simulated, Work};
use crate::lanes::{InstructionSet, LaneProgram, Lanes, ROW, Table};
use crate::model::{Event, Phase, Sign};
use crate::noise::{AddressedDraws, cells};
use crate::scheme::Observer;
use crate::scheme::columns::Columns;
use jobs::{Jobs, Task};

/// The paths of a block.
pub struct Abreast<'a> {
    noisy: &'a Noisy,
    instructions: InstructionSet,
    normals: &'static Table,
    count: usize,
    /// The states at the start of the cell, and at its end.
    now: States,
    next: States,
    draws: Vec<AddressedDraws>,
    /// The keys of the random numbers of each path ([`AddressedDraws::keys`]).
    keys: [Vec<u64>; 3],
    /// Evaluations of each path until now, and until the start of the cell.
    spent: Vec<u64>,
    spent_before: Vec<u64>,
    is_lost: Vec<bool>,
    jobs: Jobs,
    /// The events in the cell, with their lanes.
    events: Vec<(u32, Event)>,
    /// The lanes that cross the cell again, alone.
    odd: Vec<u32>,
    /// The number of flagged lanes in all cells so far, and how many of them crossed the cell again
    /// alone.
    flagged: usize,
    turned_odd: usize,
    scratch: (Scratch, Pending),
}

/// The states of the paths at the border of two cells, one entry per lane.
#[derive(Clone)]
struct States {
    x: Vec<f64>,
    /// x', zero in a stick.
    v: Vec<f64>,
    n: Vec<f64>,
    /// b.
    force: Vec<f64>,
    /// The direction of the slip; zero in a stick.
    eps: Vec<f64>,
}

/// Where more than one in `MOST_ODD` flagged lanes has to cross the cell again, all paths are
/// simulated alone.
const MOST_ODD: usize = 4;

/// The number of flagged lanes after which the decision for `MOST_ODD` is made.
const FLAGGED: usize = 512;

impl<'a> Abreast<'a> {
    /// The paths with these numbers, at t = 0.
    pub fn new(noisy: &'a Noisy, instructions: InstructionSet, seed: u64, paths: &[u64]) -> Self {
        let count = paths.len();
        let lanes = count.next_multiple_of(ROW);
        let zeros = vec![0.0; lanes + ROW];
        let states = States { x: zeros.clone(), v: zeros.clone(), n: zeros.clone(), force: zeros.clone(), eps: zeros };
        let mut all = Abreast {
            noisy,
            instructions,
            normals: cells(),
            count,
            now: states.clone(),
            next: states,
            draws: Vec::with_capacity(count),
            keys: [vec![0; lanes], vec![0; lanes], vec![0; lanes]],
            spent: vec![0; lanes + ROW],
            spent_before: vec![0; lanes + ROW],
            is_lost: vec![false; count],
            jobs: Jobs::new(lanes),
            events: Vec::new(),
            odd: Vec::new(),
            flagged: 0,
            turned_odd: 0,
            scratch: (noisy.scratch(), Pending::new()),
        };
        for (lane, &number) in paths.iter().enumerate() {
            let path = cell_loop::start(noisy, seed, number);
            all.draws.push(path.draws);
            for (keys, key) in all.keys.iter_mut().zip(path.draws.keys()) {
                keys[lane] = key;
            }
            all.put(lane, &path);
            std::mem::swap(&mut all.now, &mut all.next);
            all.put(lane, &path);
        }
        all
    }

    /// The path of a lane at the start of the cell, with its evaluations so far.
    fn path(&self, states: &States, lane: usize, spent: u64) -> Path<f64> {
        let eps = states.eps[lane];
        let mut work = Work::new(self.noisy.work_limit());
        work.spend_all(spent);
        Path {
            after: 0.0,
            displacement: states.x[lane],
            noise: states.n[lane],
            second_noise: 0.0,
            force: states.force[lane],
            phase: if eps == 0.0 { Phase::Static } else { Phase::Slip(Sign::of(eps)) },
            motion: states.v[lane],
            draws: self.draws[lane],
            work,
            is_lost: false,
        }
    }

    /// Sets the state of a lane at the end of the cell.
    fn put(&mut self, lane: usize, path: &Path<f64>) {
        let (eps, v) = match path.phase {
            Phase::Static => (0.0, 0.0),
            Phase::Slip(direction) => (direction.value(), path.motion),
        };
        let next = &mut self.next;
        (next.x[lane], next.v[lane], next.n[lane]) = (path.displacement, v, path.noise);
        (next.force[lane], next.eps[lane]) = (path.force, eps);
        self.spent[lane] = self.noisy.work_limit() - path.work.left();
        self.is_lost[lane] = path.is_lost;
    }

    /// Gives up the paths that have spent all their evaluations.
    fn give_up(&mut self) {
        let limit = self.noisy.work_limit();
        for (is_lost, &spent) in self.is_lost.iter_mut().zip(&self.spent) {
            *is_lost |= spent > limit;
        }
    }

    /// Takes a lane across the cell alone.
    #[inline(always)]
    fn cross_alone(&mut self, lane: usize, cell: &Cell) {
        let mut path = self.path(&self.now, lane, self.spent_before[lane]);
        let emit = |event| self.events.push((lane as u32, event));
        let crossed = cell_loop::cross(self.noisy, cell, &mut path, &mut self.scratch, &mut Nobody, emit);
        path.is_lost = crossed.is_err();
        self.put(lane, &path);
    }
}

/// A crossing of one cell by all paths, in lanes of one kind.
struct Crossing<'p, 'a, L: Lanes> {
    paths: &'p mut Abreast<'a>,
    cell: &'p Cell,
    /// Buffer for the responses of a step to the harmonics.
    responses: Vec<HarmonicResponse<L>>,
}

/// A crossing of a cell in lanes, for any instruction set.
struct InLanes<'p, 'a> {
    paths: &'p mut Abreast<'a>,
    cell: &'p Cell,
    /// Whether there are stops inside: then the lanes in which something may happen are left in
    /// `odd`.
    is_watched: bool,
}

impl LaneProgram for InLanes<'_, '_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let responses = vec![HarmonicResponse::none(); self.cell.terms.len()];
        let mut crossing = Crossing::<L> { paths: self.paths, cell: self.cell, responses };
        crossing.run(self.is_watched);
    }
}

/// A look at the stops inside a cell, one path after the other. The lanes that are not in `odd`
/// have crossed the cell, and nothing has happened to them.
struct Watched<'p, 'a> {
    paths: &'p mut Abreast<'a>,
    cell: &'p Cell,
    inside: &'p mut Inside,
}

impl LaneProgram for Watched<'_, '_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let Watched { paths, cell, inside } = self;
        let mut is_odd = vec![false; paths.count];
        paths.odd.drain(..).for_each(|lane| is_odd[lane as usize] = true);
        for (lane, &is_odd) in is_odd.iter().enumerate() {
            if paths.is_lost[lane] {
                continue;
            }
            let mut from = paths.path(&paths.now, lane, paths.spent_before[lane]);
            if is_odd {
                inside.cross(lane, paths.noisy, cell, &mut from, &mut paths.scratch);
                paths.put(lane, &from);
                continue;
            }
            let to = paths.path(&paths.next, lane, paths.spent[lane]);
            let mut watch = inside.watch(lane, from.draws, cell);
            match from.phase {
                Phase::Static => watch.look(paths.noisy.scene(), || StickPiece {
                    after: (0.0, cell.length),
                    noise: (from.noise, to.noise),
                    force: (from.force, to.force),
                    displacement: from.displacement,
                    kind: StickEnd::Clear,
                }),
                Phase::Slip(direction) => {
                    let ends = [&from, &to];
                    paths.noisy.look_at_whole_step(cell, ends, direction, &paths.scratch.0, &mut watch);
                }
            }
        }
    }
}

impl<L: Lanes> Crossing<'_, '_, L> {
    #[inline(always)]
    fn run(&mut self, is_watched: bool) {
        self.paths.spent_before.copy_from_slice(&self.paths.spent);
        self.paths.jobs.clear();
        if self.paths.turned_odd * MOST_ODD > self.paths.flagged && self.paths.flagged > FLAGGED {
            let Abreast { odd, is_lost, .. } = &mut *self.paths;
            odd.extend((0..).zip(is_lost.iter()).filter(|(_, is_lost)| !**is_lost).map(|(lane, _)| lane));
        } else {
            self.sweep();
            if is_watched {
                let Abreast { odd, jobs, .. } = &mut *self.paths;
                odd.extend_from_slice(&jobs.flagged);
            } else {
                self.work_off();
            }
        }
        if !is_watched {
            while let Some(lane) = self.paths.odd.pop() {
                self.paths.cross_alone(lane as usize, self.cell);
            }
        }
    }

    /// Works on the flagged lanes until all queues are empty.
    #[inline(always)]
    fn work_off(&mut self) {
        self.paths.flagged += self.paths.jobs.flagged.len();
        while let Some(task) = self.paths.jobs.longest::<L>() {
            while let Some((rows, lanes)) = self.paths.jobs.next::<L>() {
                match task {
                    Task::Halve => self.halve(&rows, lanes),
                    Task::Decide => self.decide(&rows, lanes),
                    Task::StickOn => self.stick_on(&rows, lanes),
                    Task::Begin => self.begin(&rows, lanes),
                    Task::Bisect => self.bisect(&rows, lanes),
                    Task::SlipOn => self.slip_on(&rows, lanes),
                    Task::Stop => self.stop(&rows, lanes),
                }
            }
        }
        let Abreast { odd, events, turned_odd, jobs, spent, .. } = &mut *self.paths;
        for &lane in &jobs.flagged {
            spent[lane as usize] += jobs.spent(lane as usize);
        }
        *turned_odd += odd.len();
        if !odd.is_empty() {
            events.retain(|(lane, _)| !odd.contains(lane));
        }
    }
}

impl Paths for Abreast<'_> {
    type Cascade = Noisy;

    fn cascade(&self) -> &Noisy {
        self.noisy
    }

    fn cross(&mut self, cells: &[Cell], observer: &mut dyn Observer) {
        let instructions = self.instructions;
        for cell in cells {
            if observer.is_stopped() {
                return;
            }
            instructions.run(&mut InLanes { paths: self, cell, is_watched: false });
            std::mem::swap(&mut self.now, &mut self.next);
            for (lane, event) in self.events.drain(..) {
                observer.event(lane as usize, event);
            }
        }
        self.give_up();
    }

    fn cross_watched(&mut self, cell: &Cell, inside: &mut Inside) {
        let instructions = self.instructions;
        instructions.run(&mut InLanes { paths: self, cell, is_watched: true });
        instructions.run(&mut Watched { paths: self, cell, inside });
        std::mem::swap(&mut self.now, &mut self.next);
        self.give_up();
    }

    fn look(&self, passed: &Cell, columns: &mut Columns) {
        let per_temperature = self.noisy.scene().force_per_temperature;
        let now = &self.now;
        for lane in 0..self.count {
            let temperature = (passed.last.value + now.n[lane]) / per_temperature;
            let seen = (now.x[lane], now.v[lane], temperature, now.eps[lane] == 0.0);
            columns.set(lane, if self.is_lost[lane] { LOST } else { seen });
        }
    }

    fn are_lost(&self) -> bool {
        self.is_lost.iter().all(|&is_lost| is_lost)
    }

    fn simulated(&self) -> Simulated {
        let lost = self.is_lost.iter().enumerate().filter(|&(_, &is_lost)| is_lost).map(|(lane, _)| lane);
        let limit = self.noisy.work_limit();
        Simulated {
            lost: lost.collect(),
            evaluations: self.spent[..self.count].iter().map(|&spent| spent.min(limit)).sum(),
        }
    }
}
