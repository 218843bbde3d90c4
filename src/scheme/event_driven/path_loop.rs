//! The path loop of the schemes that follow noisy paths one by one, from event to event:
//! event-driven and quasi-static.
//!
//! A scheme says how a phase goes on ([`Cascade`]). The loop starts the paths, takes each of them
//! phase by phase to the next stop of the timeline, and shows all of them to the observer there. A
//! step of any phase ends at the stop, so that every observed state is a draw from its law.

use super::scene::Scene;
use super::work::{Simulated, Unresolved, Work};
use crate::model::{Complex, Event, Phase, Sign};
use crate::noise::Stream;
use crate::scheme::columns::Columns;
use crate::scheme::{Observer, Timeline};

/// Where one path is.
#[derive(Clone, Debug)]
pub struct Path<M> {
    /// How far it has been simulated.
    pub time: f64,
    /// x, or where the phase began if the scheme tells from that.
    pub displacement: f64,
    /// n.
    pub noise: f64,
    pub phase: Phase,
    /// What else the scheme knows of the motion.
    pub motion: M,
    pub draws: Stream,
    pub work: Work,
    is_lost: bool,
}

/// A scheme as the loop sees it.
pub trait Cascade {
    /// What it knows of the motion of a path besides place, noise and phase.
    type Motion: Default;
    /// Room for what one path needs at a time.
    type Scratch;

    fn scene(&self) -> &Scene;
    fn timeline(&self) -> &Timeline;
    /// What a path may spend.
    fn work_limit(&self) -> u64;
    fn scratch(&self) -> Self::Scratch;

    /// Take a path in a static phase, and the terms of B with it, to a time or to the event that
    /// ends the phase before.
    fn stick_until(
        &self,
        path: &mut Path<Self::Motion>,
        terms: &mut [Complex],
        until: f64,
    ) -> Result<Option<Event>, Unresolved>;

    /// The same in a sub-phase.
    fn slip_until(
        &self,
        path: &mut Path<Self::Motion>,
        terms: &mut [Complex],
        direction: Sign,
        until: f64,
        scratch: &mut Self::Scratch,
    ) -> Result<Option<Event>, Unresolved>;

    /// The motion with which the phase after an event begins.
    fn motion_after(&self, event: &Event) -> Self::Motion;

    /// x, x' and T at a time to which the path has been taken.
    fn look(&self, path: &Path<Self::Motion>, terms: &mut [Complex], time: f64) -> (f64, f64, f64);
}

/// Simulate the paths with these numbers. Compiled for the instruction set of the caller, hence
/// `inline(always)`.
#[inline(always)]
pub fn simulate<C: Cascade, O: Observer>(cascade: &C, seed: u64, paths: &[u64], observer: &mut O) -> Simulated {
    let harmonics = cascade.scene().harmonics.len();
    let mut lanes: Vec<_> = paths.iter().map(|&path| start(cascade, seed, path)).collect();
    let mut terms = vec![Complex::ZERO; harmonics * paths.len()];
    for terms in terms.chunks_exact_mut(harmonics.max(1)) {
        cascade.scene().set_terms(0.0, terms);
    }
    let mut scratch = cascade.scratch();
    let mut columns = Columns::new(paths.len());
    for stop in cascade.timeline().stops() {
        for (lane, path) in lanes.iter_mut().enumerate() {
            let terms = &mut terms[lane * harmonics..(lane + 1) * harmonics];
            if !path.is_lost {
                let emit = |event| observer.event(lane, event);
                path.is_lost = advance(cascade, path, terms, stop.time, &mut scratch, emit).is_err();
            }
            let nothing = (f64::NAN, f64::NAN, f64::NAN);
            let (x, v, temperature) = if path.is_lost { nothing } else { cascade.look(path, terms, stop.time) };
            columns.set(lane, (x, v, temperature, path.phase == Phase::Static));
        }
        observer.snapshot(stop.instant, columns.snapshot(stop.time));
    }
    Simulated {
        lost: lanes.iter().enumerate().filter(|(_, path)| path.is_lost).map(|(lane, _)| lane).collect(),
        evaluations: lanes.iter().map(|path| cascade.work_limit() - path.work.left()).sum(),
    }
}

fn start<C: Cascade>(cascade: &C, seed: u64, path: u64) -> Path<C::Motion> {
    let mut draws = Stream::new(seed, path);
    let noise = cascade.scene().draw_initial_noise(&mut draws);
    Path {
        time: 0.0,
        displacement: cascade.scene().initial_displacement,
        noise,
        phase: Phase::Static,
        motion: C::Motion::default(),
        draws,
        work: Work::new(cascade.work_limit()),
        is_lost: false,
    }
}

/// Follow a path, phase by phase, to a time.
#[inline(always)]
fn advance<C: Cascade>(
    cascade: &C,
    path: &mut Path<C::Motion>,
    terms: &mut [Complex],
    until: f64,
    scratch: &mut C::Scratch,
    mut emit: impl FnMut(Event),
) -> Result<(), Unresolved> {
    loop {
        let event = match path.phase {
            Phase::Static => cascade.stick_until(path, terms, until)?,
            Phase::Slip(direction) => cascade.slip_until(path, terms, direction, until, scratch)?,
        };
        let Some(event) = event else { return Ok(()) };
        emit(event);
        (path.time, path.displacement) = (event.time, event.displacement);
        (path.phase, path.motion) = (event.kind.phase(), cascade.motion_after(&event));
    }
}
