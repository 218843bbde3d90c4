//! The crossing of a macro step, stage by stage: the sweep, the tasks of the queues, the states at
//! output times, and the lanes that cross the macro step in scalar form.

use super::super::law::{MacroStep, ObservationTime};
use super::super::macro_step_loop::Inside;
use super::Vectorised;
use crate::lanes::{LaneProgram, Lanes};
use std::marker::PhantomData;

/// If more than one in `MOST_FALLBACK` lanes has to cross the macro step again, all paths are simulated
/// in scalar form.
const MOST_FALLBACK: usize = 2;

/// The number of lanes after which the decision for `MOST_FALLBACK` is made.
const SWEPT: usize = 4096;

/// After this number of tasks in one macro step, the scheme asks whether the paths are still
/// wanted.
const CHECK_EVERY: u32 = 64;

/// A crossing of one macro step by all paths, in lanes of one kind.
pub struct Crossing<'p, 'a, L: Lanes> {
    pub paths: &'p mut Vectorised<'a>,
    pub macro_step: &'p MacroStep,
    lanes: PhantomData<L>,
}

/// A stage of a crossing. Each stage is compiled as a separate function, so that the registers of
/// the processor need not hold data of other stages.
trait Stage {
    fn run<L: Lanes>(&mut self, crossing: &mut Crossing<'_, '_, L>);
}

/// A stage of the crossing of a macro step, for any instruction set.
struct InLanes<'p, 'a, S> {
    paths: &'p mut Vectorised<'a>,
    macro_step: &'p MacroStep,
    stage: S,
}

impl<S: Stage> LaneProgram for InLanes<'_, '_, S> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        self.stage.run(&mut Crossing::<L> {
            paths: self.paths,
            macro_step: self.macro_step,
            lanes: PhantomData,
        });
    }
}

/// Takes every lane to the end of the macro step.
struct CrossingStage;

impl Stage for CrossingStage {
    #[inline(always)]
    fn run<L: Lanes>(&mut self, crossing: &mut Crossing<'_, '_, L>) {
        crossing.sweep();
    }
}

/// Defines the tasks, and a stage for each, which works on all lanes taken out of the queue of the
/// task.
macro_rules! tasks {
    ($($(#[$about:meta])* $Task:ident: $work:ident,)*) => {
        /// What remains to be done for a flagged lane.
        #[derive(Clone, Copy, Debug)]
        pub enum Task {
            $($(#[$about])* $Task,)*
        }

        pub const TASKS: &[Task] = &[$(Task::$Task),*];

        $(
            struct $Task;

            impl Stage for $Task {
                #[inline(always)]
                fn run<L: Lanes>(&mut self, crossing: &mut Crossing<'_, '_, L>) {
                    while let Some((rows, lanes)) = crossing.paths.jobs.next::<L>() {
                        crossing.$work(&rows, lanes);
                    }
                }
            }
        )*

        impl Vectorised<'_> {
            /// Works on the lanes that were taken out of the queue of a task.
            fn work_on(&mut self, task: Task, macro_step: &MacroStep) {
                match task {
                    $(Task::$Task => self.run(macro_step, $Task),)*
                }
            }
        }
    };
}

tasks! {
    /// Draw n in the middle of a piece of a stick, and divide the piece.
    Halve: halve,
    /// Decide whether a piece of a stick is left.
    Decide: decide,
    /// Find when a piece of a stick is left.
    Leave: leave,
    /// Go on to the next piece of a stick.
    StickOn: stick_on,
    /// Begin a sub-phase inside the macro step.
    Begin: begin,
    /// Draw the state in the middle of an interval of a slip, and divide the interval.
    Bisect: bisect,
    /// Go on to the next interval of a slip.
    SlipOn: slip_on,
    /// Find the stop of a slip in an interval.
    FindStop: find_stop,
    /// Begin what follows a stop.
    Rest: rest,
}

/// Draws the states at the stops inside the macro step.
struct ObserveInside<'i>(&'i mut Inside);

impl Stage for ObserveInside<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self, crossing: &mut Crossing<'_, '_, L>) {
        crossing.observe(self.0);
    }
}

/// Takes the lanes across the macro step that have to cross it in scalar form. `inside` are the stops
/// inside the macro step.
struct ScalarFallback<'i> {
    inside: Option<&'i mut Inside>,
}

impl Stage for ScalarFallback<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self, crossing: &mut Crossing<'_, '_, L>) {
        while let Some(lane) = crossing.paths.fallback.pop() {
            crossing.paths.cross_scalar(
                lane as usize,
                crossing.macro_step,
                self.inside.as_deref_mut(),
            );
        }
        crossing.paths.limit_work();
    }
}

impl Vectorised<'_> {
    /// Takes all paths across a macro step: first as if they had no event, then, from task to task,
    /// those that may have one, and last, in scalar form, those that meet a rare case. `inside` are the
    /// stops inside the macro step.
    pub(super) fn cross_macro_step(
        &mut self,
        macro_step: &MacroStep,
        mut inside: Option<&mut Inside>,
    ) {
        let instants = inside.as_ref().map_or(&[][..], |inside| &inside.instants);
        self.begin_macro_step(macro_step, instants);
        if self.go_scalar(macro_step, instants) {
            self.mark_all_for_fallback();
        } else {
            self.run(macro_step, CrossingStage);
            for turn in 1_u32.. {
                let Some(task) = self.jobs.longest() else {
                    break;
                };
                self.work_on(task, macro_step);
                if turn.is_multiple_of(CHECK_EVERY) && (self.is_stopped)() {
                    return;
                }
            }
            self.count_work();
            if let Some(inside) = &mut inside {
                self.run(macro_step, ObserveInside(inside));
            }
            self.drop_events_of_fallback();
        }
        self.run(
            macro_step,
            ScalarFallback {
                inside: inside.as_deref_mut(),
            },
        );
        if let Some(inside) = inside {
            inside.events.extend(
                self.events
                    .drain(..)
                    .map(|(lane, event)| (lane as usize, event)),
            );
        }
        std::mem::swap(&mut self.now, &mut self.next);
    }

    /// Runs a stage of the crossing in lanes.
    fn run(&mut self, macro_step: &MacroStep, stage: impl Stage) {
        let instructions = self.instructions;
        instructions.run_paired(&mut InLanes {
            paths: self,
            macro_step,
            stage,
        });
    }

    /// Starts a new macro step, in which the paths are observed at these instants.
    fn begin_macro_step(&mut self, macro_step: &MacroStep, instants: &[ObservationTime]) {
        self.records.begin(macro_step.start, instants);
        self.spent_before.copy_from_slice(&self.spent);
        self.jobs.clear();
    }

    /// Whether all paths cross the macro step in scalar form: if most of them would have to cross
    /// it again in scalar form, if there are additional observation times (only for few paths), or
    /// if they move at t = 0.
    fn go_scalar(&self, macro_step: &MacroStep, instants: &[ObservationTime]) -> bool {
        let falls_back = self.fell_back * MOST_FALLBACK > self.swept && self.swept > SWEPT;
        let have_initial_velocity =
            macro_step.index == 0 && self.noisy.scene.initial_velocity != 0.0;
        falls_back || have_initial_velocity || instants.iter().any(|instant| instant.is_additional)
    }

    /// Marks all lanes to cross the macro step in scalar form.
    fn mark_all_for_fallback(&mut self) {
        let Vectorised {
            fallback,
            lost,
            count,
            ..
        } = self;
        fallback.extend(
            (0..*count)
                .filter(|lane| !lost.contains_key(lane))
                .map(|lane| lane as u32),
        );
    }

    /// Counts the evaluations of the flagged lanes, and the lanes that have to cross the macro step
    /// in scalar form.
    fn count_work(&mut self) {
        let Vectorised {
            fallback,
            swept,
            fell_back,
            jobs,
            spent,
            count,
            ..
        } = self;
        for &lane in jobs.flagged() {
            spent[lane as usize] += jobs.spent(lane as usize);
        }
        *swept += *count;
        *fell_back += fallback.len();
    }

    /// Drops the events of lanes that cross the macro step again in scalar form.
    fn drop_events_of_fallback(&mut self) {
        let Vectorised {
            fallback, events, ..
        } = self;
        if !fallback.is_empty() {
            events.retain(|(lane, _)| !fallback.contains(lane));
        }
    }
}
