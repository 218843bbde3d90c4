//! Finds the phases of the cascade from the velocities of the discrete scheme.
//!
//! V_{n+1} = 0 alone is not a static phase: at a turning point with |b| > f_s the scheme gives a
//! zero velocity for one step. A static phase begins at t_{n+1} if and only if V_{n+1} = 0 and
//! |b(X_{n+1}, 0, t_{n+1})| <= f_s. A zero that does not begin a static phase, or V_n V_{n+1} < 0,
//! is a sub-phase boundary at t_{n+1}. A static phase ends at t_n, the last instant with V_n = 0;
//! this is the paper's convention (its tau_{3/2} = 14.86). So a path that is observed at t_n is
//! static if and only if V_n = V_{n+1} = 0, in its rows as in its events. If every zero counted as
//! a stick, sticks would be 23 % shorter at h = 0.01, and their duration would not
//! converge.

use super::kernel::{Kernel, Paths, State, Turn};
use crate::model::{Event, EventKind, Phase, Sign};
use crate::scheme::Observer;

/// The phase of each path.
pub(super) struct GridReader {
    phases: Vec<Phase>,
    /// The lanes with an event at which b is not a number, or infinite.
    pub forceless: Vec<usize>,
}

impl GridReader {
    /// The phases at t = 0: static at rest where |b| <= f_s; elsewhere the first stick is empty and
    /// a slip starts.
    pub(super) fn start(
        kernel: &Kernel,
        state: &Paths,
        forcing: f64,
        paths: usize,
        observer: &mut dyn Observer,
    ) -> Self {
        let mut forceless = Vec::new();
        let phases = (0..paths).map(|lane| {
            let at = state.point(lane);
            let force = kernel.force(&at, forcing, 0);
            let pulls = kernel.pulls(&State { v: 0.0, ..at }, forcing, 0);
            let let_go = kernel.let_go(pulls, kernel.coefficients.static_impulse);
            let Some(sign) = (if at.v == 0.0 {
                let_go
            } else {
                Some(Sign::of(at.v))
            }) else {
                return Phase::Static;
            };
            let event = Event {
                kind: EventKind::SlipStarted(sign),
                time: 0.0,
                displacement: at.x,
                force,
            };
            if !force.is_finite() {
                forceless.push(lane);
            }
            observer.event(lane, event);
            Phase::Slip(sign)
        });
        GridReader {
            phases: phases.collect(),
            forceless,
        }
    }

    /// Whether each path is in a static phase at t_n, where `forcing` is that at t_n. A static
    /// phase ends at the last instant with V = 0, so that this instant belongs to the slip. It is
    /// the one at which the force no longer holds, and its event is found in the next step.
    pub(super) fn statics(
        &self,
        kernel: &Kernel,
        state: &Paths,
        forcing: f64,
        n: u64,
    ) -> impl Iterator<Item = bool> {
        self.phases.iter().enumerate().map(move |(lane, phase)| {
            let at = State {
                v: 0.0,
                ..state.point(lane)
            };
            *phase == Phase::Static && !kernel.leaves(&at, forcing, n)
        })
    }

    /// Finds the events in the turns of a run that began at step `n`, and passes them to the
    /// observer.
    pub(super) fn read(
        &mut self,
        kernel: &Kernel,
        n: u64,
        forcing: &[f64],
        turns: &[Turn],
        observer: &mut dyn Observer,
    ) {
        for turn in turns {
            let Some(phase) = self.phases.get_mut(turn.lane) else {
                continue;
            };
            let behind = turn.step + 1;
            let at_rest = || {
                let pulls = kernel.pulls(&turn.after, forcing[behind], n + behind as u64);
                // A static phase here means V = 0 at the next step.
                let let_go = kernel.let_go(pulls, kernel.coefficients.static_impulse);
                let_go.map_or(EventKind::StickEntered, EventKind::SubPhaseBoundary)
            };
            let Some(kind) = self::read(*phase, turn, at_rest) else {
                continue;
            };
            *phase = kind.phase();
            // A static phase ends at the beginning of the step; all other events are at its end.
            let (at, step) = match kind {
                EventKind::SlipStarted(_) => (&turn.before, turn.step),
                EventKind::StickEntered | EventKind::SubPhaseBoundary(_) => (&turn.after, behind),
            };
            let event = Event {
                kind,
                time: (n + step as u64) as f64 * kernel.coefficients.h,
                displacement: at.x,
                force: kernel.force(at, forcing[step], n + step as u64),
            };
            if !event.force.is_finite() {
                self.forceless.push(turn.lane);
            }
            observer.event(turn.lane, event);
        }
    }
}

/// The event of a path in this phase in a step from `turn.before` to `turn.after`, if any.
/// `at_rest` is the event if the velocity is zero at the end of the step.
fn read(phase: Phase, turn: &Turn, at_rest: impl Fn() -> EventKind) -> Option<EventKind> {
    let (before, after) = (turn.before.v, turn.after.v);
    match phase {
        Phase::Static => (after != 0.0).then(|| EventKind::SlipStarted(Sign::of(after))),
        Phase::Slip(_) if after == 0.0 => Some(at_rest()),
        // The signs are compared, because the product of the velocities could underflow.
        Phase::Slip(_) if before != 0.0 && Sign::of(before) != Sign::of(after) => {
            Some(EventKind::SubPhaseBoundary(Sign::of(after)))
        }
        // The path leaves a turning point, whose sub-phase boundary was the zero before.
        Phase::Slip(_) => None,
    }
}
