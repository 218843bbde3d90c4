//! One path, crossing a macro step phase by phase.

use super::super::law::{
    EVENT_PLACE, MacroStep, NOISE_PLACE, Scene, StepGrid, StepRules, StickBand, macro_step_length,
};
use super::super::work::{Resolved, Unresolved, WorkLeft, work_limit};
use super::observation::PathObserver;
use super::stick::{PendingNodes, stick};
use crate::model::{Event, EventKind, Phase, Sign};
use crate::noise::AddressedDraws;
use crate::scheme::Timeline;

/// The state of one path.
#[derive(Clone, Debug)]
pub struct Path<'w, M> {
    /// The time up to which it has been simulated, after the start of the macro step.
    pub after: f64,
    /// x, or x at the start of the phase if the scheme computes x from that.
    pub displacement: f64,
    /// n.
    pub noise: f64,
    /// The part of n that is the second noise, at the start of the macro step; 0 where there is
    /// only one noise.
    pub second_noise: f64,
    /// b. Where a phase begins it is the value that is known exactly (the threshold, or the force
    /// at a stop), not a difference of larger forces.
    pub force: f64,
    pub phase: Phase,
    /// Further data of the motion that the scheme needs.
    pub motion: M,
    pub draws: AddressedDraws,
    pub work: WorkLeft<'w>,
    /// Why the path was given up, if it was.
    pub lost: Option<Unresolved>,
}

/// The propagation of the paths of a scheme from macro step to macro step.
#[derive(Clone, Debug)]
pub struct Propagation {
    pub timeline: Timeline,
    /// The division of time into macro steps.
    pub grid: StepGrid,
    /// Finds the exits from sticks.
    pub band: StickBand,
    /// The number of evaluations that a path may make.
    pub work_limit: u64,
    /// Every `row_stride`-th row of the output grid belongs to the run; the rows in between are
    /// additional observation times.
    pub row_stride: usize,
}

impl Propagation {
    /// The propagation through macro steps of at most this length, where an evaluation takes `cost`
    /// times as long as usual.
    pub fn new(
        scene: &Scene,
        timeline: &Timeline,
        rules: &StepRules,
        longest: f64,
        cost: u64,
    ) -> Self {
        Propagation {
            timeline: *timeline,
            grid: scene.grid(
                macro_step_length(longest.min(scene.longest_macro_step()), timeline.end),
                timeline.end,
            ),
            band: StickBand::new(scene, rules.chord_error),
            work_limit: work_limit(cost),
            row_stride: 1,
        }
    }
}

/// The interface of a scheme to the loop.
pub trait Cascade {
    /// What the scheme knows of the motion of a path besides displacement, noise, force and phase.
    type Memory: Default;
    /// Buffers for the computation of one path at a time.
    type Scratch;

    fn scene(&self) -> &Scene;
    fn propagation(&self) -> &Propagation;

    fn scratch(&self) -> Self::Scratch;

    /// Takes a path in a sub-phase to the end of the macro step, where n is `end_noise`, or to the
    /// event that ends the sub-phase if this comes first. Returns that event.
    fn slip(
        &self,
        macro_step: &MacroStep,
        path: &mut Path<Self::Memory>,
        direction: Sign,
        end_noise: f64,
        scratch: &mut Self::Scratch,
        observer: &mut impl PathObserver,
    ) -> Resolved<Option<Event>>;

    /// The motion at the start of the phase that follows an event.
    fn motion_after(&self, event: &Event) -> Self::Memory;

    /// x and x' at the end of the macro step to which the path has been taken.
    fn end_state(&self, path: &Path<Self::Memory>, macro_step: &MacroStep) -> (f64, f64);
}

/// A path at t = 0.
pub fn start<'w, C: Cascade>(
    cascade: &C,
    seed: u64,
    path: u64,
    is_stopped: &'w dyn Fn() -> bool,
) -> Path<'w, C::Memory> {
    let (scene, draws) = (cascade.scene(), AddressedDraws::new(seed, path));
    let (noise, second_noise) = scene.draw_initial_noise(draws);
    Path {
        second_noise,
        ..Path::new(
            scene,
            noise,
            draws,
            WorkLeft::watched(cascade.propagation().work_limit, is_stopped),
        )
    }
}

impl<'w, M: Default> Path<'w, M> {
    /// A path at t = 0, at rest, with this n.
    pub fn new(scene: &Scene, noise: f64, draws: AddressedDraws, work: WorkLeft<'w>) -> Self {
        let displacement = scene.initial_displacement;
        Path {
            after: 0.0,
            displacement,
            noise,
            second_noise: 0.0,
            force: scene.initial_forcing() + noise - scene.spring(displacement, 0.0),
            phase: Phase::Static,
            motion: M::default(),
            draws,
            work,
            lost: None,
        }
    }
}

/// Takes a path across a macro step, phase by phase.
#[inline(always)]
pub fn cross<C: Cascade>(
    cascade: &C,
    macro_step: &MacroStep,
    path: &mut Path<C::Memory>,
    (scratch, pending): &mut (C::Scratch, PendingNodes),
    observer: &mut impl PathObserver,
    mut emit: impl FnMut(Event),
) -> Resolved<()> {
    let end_noise = noise_at_the_end(macro_step, path);
    path.draws = path.draws.at(macro_step.index, EVENT_PLACE);
    path.after = 0.0;
    if macro_step.index == 0 && cascade.scene().initial_velocity != 0.0 {
        let event = first_slip(cascade.scene(), path);
        (path.phase, path.motion) = (event.kind.phase(), cascade.motion_after(&event));
        emit(event);
    }
    loop {
        let event = match path.phase {
            Phase::Static => stick(cascade, macro_step, path, end_noise, pending, observer)?,
            Phase::Slip(direction) => {
                cascade.slip(macro_step, path, direction, end_noise, scratch, observer)?
            }
        };
        let Some(event) = event else { break };
        path.work.spend()?;
        let (
            scene,
            Event {
                displacement: x,
                force,
                time,
                ..
            },
        ) = (cascade.scene(), event);
        path.displacement = x;
        (path.phase, path.motion) = (event.kind.phase(), cascade.motion_after(&event));
        path.force = match path.phase {
            Phase::Static => force,
            Phase::Slip(direction) => scene.slipping(direction, force, x, time),
        };
        emit(event);
    }
    path.noise = end_noise;
    Ok(())
}

/// The start of a path that moves at t = 0.
#[cold]
fn first_slip<M>(scene: &Scene, path: &mut Path<M>) -> Event {
    let (x, v) = (path.displacement, scene.initial_velocity);
    let (direction, free) = (Sign::of(v), path.force - 2.0 * scene.oscillator.damping * v);
    let moving =
        |direction| free + (scene.own.at(direction, x, v, 0.0) - scene.own.hold(x, 0.0).pull);
    path.force = moving(Some(direction));
    let force = moving(None);
    Event {
        kind: EventKind::SlipStarted(direction),
        time: 0.0,
        displacement: x,
        force,
    }
}

/// Draws n at the end of a macro step, given n at its start: the next value of the skeleton.
#[inline(always)]
fn noise_at_the_end<M>(macro_step: &MacroStep, path: &mut Path<M>) -> f64 {
    let mut draws = path.draws.at(macro_step.index, NOISE_PLACE);
    let Some([first, second]) = macro_step.two_transitions else {
        return macro_step.transition.next(path.noise, draws.normal());
    };
    let [for_first, for_second] = draws.normal_pair();
    let first = first.next(path.noise - path.second_noise, for_first);
    path.second_noise = second.next(path.second_noise, for_second);
    first + path.second_noise
}
