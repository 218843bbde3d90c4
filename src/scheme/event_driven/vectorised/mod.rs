//! Paths vectorised: all paths that are simulated together cross a macro step together, in lanes.
//!
//! ```text
//! sweep    draws n at the end of the macro step, and takes every path there as if it had no event
//! queues   treat the lanes that may have an event: a stick that may be left, a slip that may stop
//! observe  draws the states at output times inside the macro step, in the pieces that hold them
//! scalar   the few lanes that meet a rare case cross the macro step again, path by path
//! ```
//!
//! A lane does the same as [`super::scalar::cross`], with the same random numbers and the same
//! rounding, so a path has the same bits vectorised and scalar. Therefore rare cases (the end of a
//! bisection, noise that is too feeble for the quintic, a start on a threshold) need not be treated
//! in lanes: such a lane crosses the macro step again in scalar form.
//!
//! Under a user-defined force, sticks are treated in lanes if it does not depend on t, and steps of
//! slips where it is resolved.
//!
//! Where the body oscillates much faster than forcing and noise change, a slip takes many steps per
//! macro step. Then only sticks are treated in lanes, and a lane with a slip crosses the macro step
//! in scalar form.

mod crossing;
mod forced;
mod jobs;
mod observe;
mod records;
mod shared_step;
mod slip;
mod states;
mod stick;
mod sweep;
#[cfg(test)]
mod tests;

use super::law::MacroStep;
use super::macro_step_loop::{Inside, PathSet, SharedObserver};
use super::noisy::Noisy;
use super::scalar::{self, Cascade, NullObserver, Path, PendingNodes, SlipBuffers};
use super::work::{Simulated, Unresolved, WorkLeft};
use crate::lanes::{InstructionSet, LaneProgram, Lanes, LookupTable, ROW, Row};
use crate::model::{Event, Phase, Sign};
use crate::noise::{AddressedDraws, cells};
use crate::scheme::columns::{LOST, StateColumns};
use jobs::{Jobs, Queue};
use records::Records;
use states::{Border, Phases, rows_from};
use std::collections::BTreeMap;

/// Paths that are simulated together.
pub struct Vectorised<'a> {
    noisy: &'a Noisy,
    instructions: InstructionSet,
    normals: &'static LookupTable,
    count: usize,
    /// The [`states::Border`] of each lane at the start of the macro step, and at its end.
    now: Vec<Row>,
    next: Vec<Row>,
    phases: Phases,
    /// The lanes that slip, and those that stick, at the start of the macro step.
    slips: Queue,
    sticks: Queue,
    draws: Vec<AddressedDraws>,
    /// Evaluations of each path until now, and until the start of the macro step.
    spent: Vec<u64>,
    spent_before: Vec<u64>,
    /// The lanes whose paths have been given up, and why.
    lost: BTreeMap<usize, Unresolved>,
    jobs: Jobs,
    /// The pieces in which the paths are observed.
    records: Records,
    /// n and b of each lane at the start of the slip step that began last inside the macro step, or,
    /// under g, with it; and the constant for g in this step.
    begun: [Vec<f64>; 3],
    /// The events in the macro step, with their lanes.
    events: Vec<(u32, Event)>,
    /// The lanes that cross the macro step again in scalar form.
    fallback: Vec<u32>,
    /// The number of lanes that have crossed a macro step together, and how many of them crossed it
    /// again in scalar form.
    swept: usize,
    fell_back: usize,
    scratch: (SlipBuffers, PendingNodes),
    is_stopped: &'a dyn Fn() -> bool,
}

impl<'a> Vectorised<'a> {
    /// The paths with these numbers, at t = 0. They are crossed until `is_stopped`.
    pub fn new(
        noisy: &'a Noisy,
        instructions: InstructionSet,
        seed: u64,
        paths: &[u64],
        is_stopped: &'a dyn Fn() -> bool,
    ) -> Self {
        let count = paths.len();
        let lanes = count.next_multiple_of(ROW);
        let states = vec![Row([0.0; ROW]); lanes + ROW];
        let mut all = Vectorised {
            noisy,
            instructions,
            normals: cells(),
            count,
            now: states.clone(),
            next: states,
            phases: Phases::new(count),
            slips: Queue::new(lanes),
            sticks: Queue::new(lanes),
            draws: Vec::with_capacity(count),
            spent: vec![0; lanes + ROW],
            spent_before: vec![0; lanes + ROW],
            lost: BTreeMap::new(),
            jobs: Jobs::new(lanes),
            records: Records::default(),
            begun: std::array::from_fn(|_| vec![0.0; lanes + ROW]),
            events: Vec::new(),
            fallback: Vec::new(),
            swept: 0,
            fell_back: 0,
            scratch: (noisy.scratch(), PendingNodes::new()),
            is_stopped,
        };
        for (lane, &number) in paths.iter().enumerate() {
            let path = scalar::start(noisy, seed, number, is_stopped);
            all.draws.push(path.draws);
            all.put(lane, &path);
            std::mem::swap(&mut all.now, &mut all.next);
            all.put(lane, &path);
        }
        all
    }

    /// The path of a lane at the start of the macro step.
    fn path(&self, lane: usize) -> Path<'a, f64> {
        let [displacement, motion, noise, force, eps, ..] = self.now[lane].0;
        let left = self
            .noisy
            .propagation
            .work_limit
            .saturating_sub(self.spent_before[lane]);
        Path {
            after: 0.0,
            displacement,
            noise,
            second_noise: 0.0,
            force,
            phase: if eps == 0.0 {
                Phase::Static
            } else {
                Phase::Slip(Sign::of(eps))
            },
            motion,
            draws: self.draws[lane],
            work: WorkLeft::watched(left, self.is_stopped),
            lost: None,
        }
    }

    /// Sets the state of a lane at the end of the macro step.
    fn put(&mut self, lane: usize, path: &Path<f64>) {
        let (eps, v) = match path.phase {
            Phase::Static => (0.0, 0.0),
            Phase::Slip(direction) => (direction.value(), path.motion),
        };
        let [origin, key, flip] = path.draws.keys().map(f64::from_bits);
        self.next[lane] = Row([
            path.displacement,
            v,
            path.noise,
            path.force,
            eps,
            origin,
            key,
            flip,
        ]);
        self.phases.set(lane, eps != 0.0);
        self.spent[lane] = self.noisy.propagation.work_limit - path.work.left();
        if let Some(why) = path.lost {
            self.give_up(lane, why);
        }
    }

    /// Gives up the path of a lane.
    fn give_up(&mut self, lane: usize, why: Unresolved) {
        self.phases.leave_out(lane);
        self.lost.entry(lane).or_insert(why);
    }

    /// Gives up the paths that have spent all their evaluations.
    #[inline(always)]
    fn limit_work(&mut self) {
        let limit = self.noisy.propagation.work_limit;
        let mut is_over = false;
        for &spent in &self.spent {
            is_over |= spent > limit;
        }
        if is_over {
            for lane in 0..self.count {
                if self.spent[lane] > limit {
                    self.give_up(lane, Unresolved::TooLong);
                }
            }
        }
    }

    /// Takes a lane across the macro step in scalar form.
    #[inline(always)]
    fn cross_scalar(&mut self, lane: usize, macro_step: &MacroStep, inside: Option<&mut Inside>) {
        let mut path = self.path(lane);
        if let Some(inside) = inside {
            inside.cross(lane, self.noisy, macro_step, &mut path, &mut self.scratch);
        } else {
            let emit = |event| self.events.push((lane as u32, event));
            let crossed = scalar::cross(
                self.noisy,
                macro_step,
                &mut path,
                &mut self.scratch,
                &mut NullObserver,
                emit,
            );
            path.lost = crossed.err();
        }
        self.put(lane, &path);
    }
}

/// Writes the state of every path at the end of a macro step.
struct WriteStates<'p, 'a> {
    paths: &'p Vectorised<'a>,
    passed: &'p MacroStep,
    columns: &'p mut StateColumns,
}

impl LaneProgram for WriteStates<'_, '_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let scene = &self.paths.noisy.scene;
        for lane in (0..self.paths.count).step_by(L::WIDTH) {
            let now = Border::<L>::get(&self.paths.now, &rows_from(lane));
            let temperature = scene.temperature(self.passed.last.value, now.n);
            let is_slip = now.eps.abs().gt(L::splat(0.0));
            self.columns
                .set_lanes(lane, (now.x, now.v, temperature), !L::bitmask(is_slip));
        }
    }
}

impl PathSet for Vectorised<'_> {
    type Cascade = Noisy;

    fn cascade(&self) -> &Noisy {
        self.noisy
    }

    fn cross(&mut self, macro_steps: &[MacroStep], observer: &SharedObserver<'_>) {
        for macro_step in macro_steps {
            if (self.is_stopped)() {
                return;
            }
            self.cross_macro_step(macro_step, None);
            let mut observer = observer.borrow_mut();
            for (lane, event) in self.events.drain(..) {
                observer.event(lane as usize, event);
            }
        }
    }

    fn cross_observed(&mut self, macro_step: &MacroStep, inside: &mut Inside) {
        self.cross_macro_step(macro_step, Some(inside));
    }

    fn write_states(&self, passed: &MacroStep, columns: &mut StateColumns) {
        self.instructions.run(&mut WriteStates {
            paths: self,
            passed,
            columns,
        });
        for &lane in self.lost.keys() {
            columns.set(lane, LOST);
        }
    }

    fn are_lost(&self) -> bool {
        self.lost.len() == self.count
    }

    fn simulated(&self) -> Simulated {
        let limit = self.noisy.propagation.work_limit;
        Simulated {
            lost: self.lost.keys().copied().collect(),
            why: self.lost.values().next().copied(),
            evaluations: self.spent[..self.count]
                .iter()
                .map(|&spent| spent.min(limit))
                .sum(),
        }
    }
}
