//! Paths that cross the macro steps one after the other.

use super::super::law::MacroStep;
use super::super::macro_step_loop::{Inside, PathSet, SharedObserver};
use super::super::work::Simulated;
use super::observation::{MotionObserver, NullObserver};
use super::path::{Cascade, Path, cross, start};
use super::stick::PendingNodes;
use crate::lanes::{InstructionSet, LaneProgram, Lanes};
use crate::model::{Event, Phase};
use crate::scheme::Segment;
use crate::scheme::columns::{LOST, Seen, StateColumns};

/// Paths that are simulated one after the other.
pub struct ScalarPaths<'a, C: Cascade> {
    cascade: &'a C,
    instructions: InstructionSet,
    paths: Vec<Path<'a, C::Memory>>,
    is_stopped: &'a dyn Fn() -> bool,
    /// The events of the macro steps that were crossed last, with their lanes.
    events: Vec<(usize, Event)>,
    /// The motion of these macro steps, if it is followed.
    segments: Option<Vec<(usize, Segment)>>,
    scratch: (C::Scratch, PendingNodes),
}

impl<'a, C: Cascade> ScalarPaths<'a, C> {
    /// The paths with these numbers, at t = 0. They are crossed until `is_stopped`. Their motion is
    /// also reported if an observer follows it.
    pub fn new(
        cascade: &'a C,
        seed: u64,
        paths: &[u64],
        is_stopped: &'a dyn Fn() -> bool,
        follows: bool,
    ) -> Self {
        ScalarPaths {
            cascade,
            instructions: InstructionSet::detect(),
            paths: paths
                .iter()
                .map(|&path| start(cascade, seed, path, is_stopped))
                .collect(),
            is_stopped,
            events: Vec::new(),
            segments: follows.then(Vec::new),
            scratch: (cascade.scratch(), PendingNodes::new()),
        }
    }
}

/// Takes one path after the other across macro steps, with or without stops inside. This scalar
/// program is compiled for each instruction set together with everything that it calls often (hence
/// `inline(always)` there), so that a fused multiply-add is an instruction instead of a call. The
/// bits are the same on all instruction sets.
struct CrossOneByOne<'p, 'a, C: Cascade> {
    all: &'p mut ScalarPaths<'a, C>,
    macro_steps: &'p [MacroStep],
    inside: Option<&'p mut Inside>,
}

impl<C: Cascade> LaneProgram for CrossOneByOne<'_, '_, C> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let ScalarPaths {
            cascade,
            paths,
            events,
            segments,
            scratch,
            is_stopped,
            ..
        } = &mut *self.all;
        for (lane, path) in paths.iter_mut().enumerate() {
            let mut macro_steps = self.macro_steps.iter();
            if is_stopped() {
                return;
            }
            while let Some(macro_step) = macro_steps.next().filter(|_| path.lost.is_none()) {
                if let Some(inside) = &mut self.inside {
                    inside.cross(lane, *cascade, macro_step, path, scratch);
                } else {
                    let emit = |event| events.push((lane, event));
                    let mut path_observer = MotionObserver {
                        observer: NullObserver,
                        lane,
                        segments: segments.as_mut(),
                    };
                    path.lost = cross(
                        *cascade,
                        macro_step,
                        path,
                        scratch,
                        &mut path_observer,
                        emit,
                    )
                    .err();
                }
            }
        }
    }
}

impl<C: Cascade> PathSet for ScalarPaths<'_, C> {
    type Cascade = C;

    fn cascade(&self) -> &C {
        self.cascade
    }

    fn cross(&mut self, macro_steps: &[MacroStep], observer: &SharedObserver<'_>) {
        let instructions = self.instructions;
        instructions.run_single(&mut CrossOneByOne {
            all: self,
            macro_steps,
            inside: None,
        });
        let mut observer = observer.borrow_mut();
        for (lane, event) in self.events.drain(..) {
            observer.event(lane, event);
        }
        for (lane, segment) in self
            .segments
            .iter_mut()
            .flat_map(|segments| segments.drain(..))
        {
            observer.segment(lane, &segment);
        }
    }

    fn cross_observed(&mut self, macro_step: &MacroStep, inside: &mut Inside) {
        let macro_steps = std::slice::from_ref(macro_step);
        let instructions = self.instructions;
        instructions.run_single(&mut CrossOneByOne {
            all: self,
            macro_steps,
            inside: Some(inside),
        });
    }

    fn write_states(&self, passed: &MacroStep, columns: &mut StateColumns) {
        for (lane, path) in self.paths.iter().enumerate() {
            columns.set(lane, at_the_end(self.cascade, passed, path));
        }
    }

    fn are_lost(&self) -> bool {
        self.paths.iter().all(|path| path.lost.is_some())
    }

    fn simulated(&self) -> Simulated {
        Simulated {
            lost: (0..self.paths.len())
                .filter(|&lane| self.paths[lane].lost.is_some())
                .collect(),
            why: self.paths.iter().find_map(|path| path.lost),
            evaluations: self
                .paths
                .iter()
                .map(|path| self.cascade.propagation().work_limit - path.work.left())
                .sum(),
        }
    }
}

/// The state that an observer sees of a path at the end of a macro step.
fn at_the_end<C: Cascade>(cascade: &C, macro_step: &MacroStep, path: &Path<C::Memory>) -> Seen {
    if path.lost.is_some() {
        return LOST;
    }
    let (x, v) = cascade.end_state(path, macro_step);
    let temperature = cascade
        .scene()
        .temperature(macro_step.last.value, path.noise);
    (x, v, temperature, path.phase == Phase::Static)
}
