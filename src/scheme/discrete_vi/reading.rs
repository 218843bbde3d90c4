//! How the cascade is read off the discrete scheme.
//!
//! V_{n+1} = 0 is not by itself a static phase: at a turning point with |b| > f_s the scheme gives
//! a zero velocity for one step. Static begins at t_{n+1} iff V_{n+1} = 0 and |b(X_{n+1}, 0,
//! t_{n+1})| <= f_s. A zero that is not static, or V_n V_{n+1} < 0, is a sub-phase boundary at
//! t_{n+1}. A static phase ends at t_n, the last instant with V_n = 0: the paper's own convention
//! (its tau_{3/2} = 14.86). Counting every zero as a stick would make sticks 23 % shorter at h =
//! 0.01 (docs/model.md), and never converge.

use super::kernel::{Coefficients, Kernel, Paths, Point, Turn};
use crate::model::{Event, EventKind, Phase, Sign};
use crate::scheme::Observer;

/// The phase each path is in, and the rule that changes it.
pub(super) struct Reader {
    phases: Vec<Phase>,
}

impl Reader {
    /// At t = 0: static where |b| <= f_s, else the first stick is empty and a slip starts.
    pub(super) fn start(
        kernel: &Kernel,
        state: &Paths,
        forcing: f64,
        paths: usize,
        observer: &mut dyn Observer,
    ) -> Self {
        let phases = (0..paths).map(|lane| {
            let at = Point { displacement: state.displacement[lane], velocity: 0.0, noise: state.noise[lane] };
            let force = kernel.coefficients.force(&at, forcing);
            if holds(&kernel.coefficients, force) {
                return Phase::Static;
            }
            let sign = Sign::of(force);
            let event = Event { kind: EventKind::SlipStarted(sign), time: 0.0, displacement: at.displacement, force };
            observer.event(lane, event);
            Phase::Slip(sign)
        });
        Reader { phases: phases.collect() }
    }

    /// The phase of each path.
    pub(super) fn phases(&self) -> &[Phase] {
        &self.phases
    }

    /// Read the turns of a run that began at step `n`.
    pub(super) fn read(
        &mut self,
        kernel: &Kernel,
        n: u64,
        forcing: &[f64],
        turns: &[Turn],
        observer: &mut dyn Observer,
    ) {
        for turn in turns {
            let Some(phase) = self.phases.get_mut(turn.lane) else { continue };
            let Some((kind, when)) = self::read(*phase, turn, &kernel.coefficients, forcing[turn.step + 1]) else {
                continue;
            };
            *phase = kind.phase();
            let (at, step) = match when {
                When::Before => (&turn.before, turn.step),
                When::After => (&turn.after, turn.step + 1),
            };
            let event = Event {
                kind,
                time: (n + step as u64) as f64 * kernel.coefficients.h,
                displacement: at.displacement,
                force: kernel.coefficients.force(at, forcing[step]),
            };
            observer.event(turn.lane, event);
        }
    }
}

/// At which end of the step an event lies.
enum When {
    Before,
    After,
}

/// What a step from `turn.before` to `turn.after` means to a path in this phase; `forcing` is that
/// of the later instant.
fn read(phase: Phase, turn: &Turn, c: &Coefficients, forcing: f64) -> Option<(EventKind, When)> {
    let (before, after) = (turn.before.velocity, turn.after.velocity);
    match phase {
        Phase::Static if after != 0.0 => Some((EventKind::SlipStarted(Sign::of(after)), When::Before)),
        Phase::Static => None,
        Phase::Slip(_) if after == 0.0 => {
            let force = c.force(&turn.after, forcing);
            Some((EventKind::at_rest(holds(c, force), force), When::After))
        }
        // compared by sign, not by product, which could underflow
        Phase::Slip(_) if before != 0.0 && Sign::of(before) != Sign::of(after) => {
            Some((EventKind::SubPhaseBoundary(Sign::of(after)), When::After))
        }
        // leaving a turning point: the boundary was its zero
        Phase::Slip(_) => None,
    }
}

/// Whether |b| <= f_s at zero velocity, rounded as the step rounds it, so that static here means
/// V = 0 at the next step.
fn holds(c: &Coefficients, force: f64) -> bool {
    (c.h_over_m * force).abs() <= c.static_impulse
}
