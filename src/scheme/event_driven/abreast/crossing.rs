//! The crossing of a cell, part by part: the sweep, the tasks of the queues, the states at output
//! times, and the lanes that cross the cell alone.

use super::Abreast;
use super::jobs::Task;
use crate::lanes::{InstructionSet, LaneProgram, Lanes};
use crate::scheme::event_driven::cell_loop::Inside;
use crate::scheme::event_driven::law::cells::Cell;
use std::marker::PhantomData;

/// Where more than one in `MOST_ODD` lanes has to cross the cell again, all paths are simulated
/// alone.
const MOST_ODD: usize = 2;

/// The number of lanes after which the decision for `MOST_ODD` is made.
const SWEPT: usize = 4096;

/// The number of lanes in which paths cross a cell.
pub fn width(instructions: InstructionSet) -> usize {
    let mut width = Width(0);
    instructions.run_paired(&mut width);
    width.0
}

/// See [`width`].
struct Width(usize);

impl LaneProgram for Width {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        self.0 = L::WIDTH;
    }
}

/// A crossing of one cell by all paths, in lanes of one kind.
pub struct Crossing<'p, 'a, L: Lanes> {
    pub paths: &'p mut Abreast<'a>,
    pub cell: &'p Cell,
    lanes: PhantomData<L>,
}

/// A part of a crossing. Each part is compiled as a function of its own, so that the registers of
/// the processor need not hold what other parts use.
trait Part {
    fn run<L: Lanes>(&mut self, crossing: &mut Crossing<'_, '_, L>);
}

/// A part of the crossing of a cell, for any instruction set.
struct InLanes<'p, 'a, P> {
    paths: &'p mut Abreast<'a>,
    cell: &'p Cell,
    part: P,
}

impl<P: Part> LaneProgram for InLanes<'_, '_, P> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        self.part.run(&mut Crossing::<L> { paths: self.paths, cell: self.cell, lanes: PhantomData });
    }
}

/// Takes every lane to the end of the cell.
struct Sweep;

impl Part for Sweep {
    #[inline(always)]
    fn run<L: Lanes>(&mut self, crossing: &mut Crossing<'_, '_, L>) {
        crossing.sweep();
    }
}

/// Draws the states at the stops inside the cell.
struct Look<'i>(&'i mut Inside);

impl Part for Look<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self, crossing: &mut Crossing<'_, '_, L>) {
        crossing.look(self.0);
    }
}

/// Takes the lanes across the cell that have to cross it alone. `inside` are the stops inside the
/// cell.
struct Alone<'i> {
    inside: Option<&'i mut Inside>,
}

impl Part for Alone<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self, crossing: &mut Crossing<'_, '_, L>) {
        while let Some(lane) = crossing.paths.odd.pop() {
            crossing.paths.cross_alone(lane as usize, crossing.cell, self.inside.as_deref_mut());
        }
        crossing.paths.limit_work();
    }
}

impl Abreast<'_> {
    /// Takes all paths across a cell. `inside` are the stops inside the cell.
    pub(super) fn cross_cell(&mut self, cell: &Cell, mut inside: Option<&mut Inside>) {
        let glances = inside.as_ref().map_or(&[][..], |inside| &inside.glances);
        let is_closer = glances.iter().any(|glance| glance.is_closer);
        self.records.begin(cell.start, glances);
        self.spent_before.copy_from_slice(&self.spent);
        self.jobs.clear();
        // A closer look is for few paths.
        let are_odd = self.turned_odd * MOST_ODD > self.swept && self.swept > SWEPT;
        if are_odd || is_closer {
            let Abreast { odd, lost, count, .. } = self;
            odd.extend((0..*count).filter(|lane| !lost.contains(lane)).map(|lane| lane as u32));
        } else {
            self.swept += self.count;
            self.run(cell, Sweep);
            self.work_off(cell);
            if let Some(inside) = &mut inside {
                self.run(cell, Look(inside));
            }
            let Abreast { odd, events, .. } = self;
            if !odd.is_empty() {
                events.retain(|(lane, _)| !odd.contains(lane));
            }
        }
        self.run(cell, Alone { inside: inside.as_deref_mut() });
        if let Some(inside) = inside {
            inside.events.extend(self.events.drain(..).map(|(lane, event)| (lane as usize, event)));
        }
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// Runs a part of the crossing in lanes.
    fn run(&mut self, cell: &Cell, part: impl Part) {
        let instructions = self.instructions;
        instructions.run_paired(&mut InLanes { paths: self, cell, part });
    }

    /// Works on the flagged lanes until all queues are empty.
    fn work_off(&mut self, cell: &Cell) {
        // Each task becomes a part that works on all lanes which were taken out of its queue.
        macro_rules! work {
            ($next:expr, $($task:ident by $method:ident),*) => {
                match $next {
                    $(Task::$task => {
                        struct Work;
                        impl Part for Work {
                            #[inline(always)]
                            fn run<L: Lanes>(&mut self, crossing: &mut Crossing<'_, '_, L>) {
                                while let Some((rows, lanes)) = crossing.paths.jobs.next::<L>() {
                                    crossing.$method(&rows, lanes);
                                }
                            }
                        }
                        self.run(cell, Work)
                    })*
                }
            };
        }
        while let Some(task) = self.jobs.longest() {
            work!(
                task,
                Halve by halve,
                Decide by decide,
                Leave by leave,
                StickOn by stick_on,
                Begin by begin,
                Bisect by bisect,
                SlipOn by slip_on,
                Stop by stop,
                Rest by rest
            );
        }
        let Abreast { odd, turned_odd, jobs, spent, .. } = self;
        for &lane in jobs.flagged() {
            spent[lane as usize] += jobs.spent(lane as usize);
        }
        *turned_odd += odd.len();
    }
}
