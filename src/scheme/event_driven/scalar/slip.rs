//! A slip of one path in a macro step: steps of (x, x', n), given n at their ends, each of which is
//! searched for the first zero of x'. The steps are exact in law, or follow a user-defined force
//! ([`super::user_force`]).

use super::super::law::{
    ForcedStart, Known, MacroStep, ObservationTime, SAME_LENGTH, SHORTEST, Scene, SlipPoint,
    SlipStep, SlipStop, SlipVelocity, WHOLE_PLACE, force, forcing, motion, noise_between,
};
use super::super::noisy::Noisy;
use super::super::work::{Resolved, Unresolved};
use super::observation::{ObservedSegment, PathObserver};
use super::path::{Cascade, Path, Propagation};
use super::step_flow::{FlowBuffers, StepFlow};
use super::stop_search::{Passed, PendingIntervals};
use super::user_force::UserForceSteps;
use crate::model::{Complex, Event, EventKind, Phase, Sign, let_go};
use crate::noise::AddressedDraws;
use crate::scheme::columns::Seen;
use crate::scheme::{Along, Segment};
use std::cell::RefCell;

/// Buffers for the computation of one path at a time.
#[derive(Debug)]
pub struct SlipBuffers {
    /// A step that is shorter than the usual one.
    partial: SlipStep,
    pending: PendingIntervals,
    /// The terms of B at the end of a step.
    terms: Vec<Complex>,
    flow: RefCell<FlowBuffers>,
    /// The intervals of a step, kept where its state is observed.
    passed: Vec<Passed>,
}

impl Cascade for Noisy {
    /// x'.
    type Memory = f64;
    type Scratch = SlipBuffers;

    fn scene(&self) -> &Scene {
        &self.scene
    }

    fn propagation(&self) -> &Propagation {
        &self.propagation
    }

    fn scratch(&self) -> SlipBuffers {
        let terms = vec![Complex::ZERO; self.scene.harmonics.len()];
        let flow = RefCell::new(FlowBuffers {
            part: self.step.clone(),
            terms: terms.clone(),
        });
        let (partial, pending) = (self.step.clone(), PendingIntervals::new());
        SlipBuffers {
            partial,
            pending,
            terms,
            flow,
            passed: Vec::new(),
        }
    }

    #[inline(always)]
    fn slip(
        &self,
        macro_step: &MacroStep,
        path: &mut Path<f64>,
        direction: Sign,
        end_noise: f64,
        scratch: &mut SlipBuffers,
        observer: &mut impl PathObserver,
    ) -> Resolved<Option<Event>> {
        Slip {
            noisy: self,
            macro_step,
            direction,
            end_noise,
        }
        .go_on(path, scratch, observer)
    }

    fn motion_after(&self, event: &Event) -> f64 {
        match event.kind {
            EventKind::SlipStarted(_) if event.time == 0.0 => self.scene.initial_velocity,
            _ => 0.0,
        }
    }

    fn end_state(&self, path: &Path<f64>, _: &MacroStep) -> (f64, f64) {
        match path.phase {
            Phase::Static => (path.displacement, 0.0),
            Phase::Slip(_) => (path.displacement, path.motion),
        }
    }
}

/// A sub-phase in a macro step, at whose end n is known.
pub(super) struct Slip<'a> {
    pub noisy: &'a Noisy,
    pub macro_step: &'a MacroStep,
    pub direction: Sign,
    pub end_noise: f64,
}

impl Slip<'_> {
    /// Takes a path to the end of the macro step, or to the event that ends the sub-phase if this
    /// comes first. Returns that event.
    #[inline(always)]
    fn go_on(
        &self,
        path: &mut Path<f64>,
        buffers: &mut SlipBuffers,
        observer: &mut impl PathObserver,
    ) -> Resolved<Option<Event>> {
        let SlipBuffers {
            partial,
            pending,
            terms,
            flow,
            passed,
        } = buffers;
        if path.after == 0.0 {
            terms.copy_from_slice(&self.macro_step.terms);
        } else {
            self.macro_step.set_terms(path.after, terms);
        }
        let mut first = self.motion(path);
        let mut own = UserForceSteps::new(self, path);
        loop {
            let remaining = self.macro_step.length - path.after;
            if remaining <= SHORTEST * self.macro_step.length {
                self.coast(path, observer);
                return Ok(None);
            }
            path.work.spend()?;
            let (began, start) = (
                path.after,
                SlipPoint {
                    x: path.displacement,
                    v: path.motion,
                    n: path.noise,
                },
            );
            let (step, is_last) = match &mut own {
                Some(own) => own.step_towards(self, remaining, path, partial)?,
                None => self.at_most(&self.noisy.step, remaining, partial),
            };
            self.take(step, is_last, path, terms, own.as_ref());
            if let Some(own) = &mut own {
                own.correct(self, step, path);
            }
            let last = self.motion(path);
            if !last.is_finite() {
                return Err(Unresolved::NoNumber);
            }
            let searched = step.between(
                self.direction.value(),
                (start.x, first),
                (path.displacement, last),
            );
            let push = own.as_ref().map_or(0.0, UserForceSteps::push);
            let flow = StepFlow::new(self, step, (began, start), searched, push, flow);
            let stop = flow.first_stop(path, pending, passed, observer.is_observing())?;
            let event = stop.map(|stop| self.stopped(path, (began, start.x), &stop));
            if !path.noise.is_finite() {
                return Err(Unresolved::NoNumber);
            }
            flow.show(passed, stop.as_ref(), (path.after, path.noise), observer);
            if observer.follows() {
                passed
                    .iter()
                    .for_each(|piece| observer.segment(self.segment(began, start.x, piece)));
            }
            if event.is_some() || is_last {
                return Ok(event);
            }
            first = last;
        }
    }

    /// The time at which a path is.
    #[inline(always)]
    pub fn time(&self, path: &Path<f64>) -> f64 {
        self.macro_step.start + path.after
    }

    /// The step of the usual length, or what remains of the macro step if this is less, and whether
    /// it ends with the macro step.
    #[inline(always)]
    pub fn at_most<'s>(
        &'s self,
        usual: &'s SlipStep,
        remaining: f64,
        partial: &'s mut SlipStep,
    ) -> (&'s SlipStep, bool) {
        // A remainder that differs from the usual length only by rounding takes the usual step.
        let is_last = remaining <= usual.length() * (1.0 + SAME_LENGTH);
        if is_last && remaining < usual.length() * (1.0 - SAME_LENGTH) {
            partial.set_length(&self.noisy.oscillator, remaining);
            (partial, is_last)
        } else {
            (usual, is_last)
        }
    }

    /// Takes one exact step of (x, x', n), with one normal for x' and one for x, and moves B and b
    /// with it. n at its end is known if the step ends with the macro step, and is drawn otherwise.
    #[inline(always)]
    fn take(
        &self,
        step: &SlipStep,
        is_last: bool,
        path: &mut Path<f64>,
        terms: &mut [Complex],
        own: Option<&UserForceSteps>,
    ) {
        let start = SlipPoint {
            x: path.displacement,
            v: path.motion,
            n: path.noise,
        };
        let is_whole = is_last && path.after == 0.0;
        let mut noise = self.end_noise;
        if !is_last {
            let ends = [
                (0.0, start.n),
                (self.macro_step.length - path.after, self.end_noise),
            ];
            noise = noise_between(&self.noisy.scene, ends, step.length(), &mut path.draws);
        }
        let normals = match is_whole {
            true => path
                .draws
                .at(self.macro_step.index, WHOLE_PLACE)
                .normal_pair(),
            false => path.draws.normal_pair(),
        };
        let friction = own.map_or(self.friction(), |own| self.friction() - own.push());
        let end = step
            .transition
            .drawn(step.mean(start, terms, friction), noise, normals);
        path.after += step.length();
        (path.displacement, path.motion, path.noise) = (end.x, end.v, end.n);
        path.force = force(&self.noisy.scene.oscillator, forcing(terms), end);
    }

    /// eps f_d, the force of friction.
    #[inline(always)]
    pub fn friction(&self) -> f64 {
        self.direction.value() * self.noisy.scene.friction.dynamic_force
    }

    /// Where a path is, at which g is `here`.
    #[inline(always)]
    pub fn forced_start(&self, path: &Path<f64>, here: f64) -> ForcedStart {
        ForcedStart {
            direction: self.direction,
            x: path.displacement,
            v: path.motion,
            force: path.force,
            acceleration: (path.force - self.friction()) / self.noisy.scene.oscillator.mass,
            time: self.time(path),
            here,
        }
    }

    /// eps x' and its derivative.
    #[inline(always)]
    fn motion(&self, path: &Path<f64>) -> SlipVelocity {
        let body = &self.noisy.scene.oscillator;
        motion(
            body,
            self.direction.value(),
            path.motion,
            path.force,
            self.friction(),
        )
    }

    /// Ends the sub-phase at a stop within a step, whose time and x at its start are given. n is
    /// computed from the force at the stop.
    #[inline(always)]
    fn stopped(&self, path: &mut Path<f64>, (began, x0): (f64, f64), stop: &SlipStop) -> Event {
        let eps = self.direction.value();
        path.after = began + stop.after;
        path.displacement = x0 + eps * stop.travel;
        let (scene, x, time) = (&self.noisy.scene, path.displacement, self.time(path));
        let force = scene.held(
            self.direction,
            self.friction() + scene.oscillator.mass * eps * stop.acceleration,
            x,
            time,
        );
        path.noise = force - self.macro_step.forcing(path.after).value + scene.spring(x, time);
        let kind = let_go(force, scene.limits(x, time))
            .map_or(EventKind::StickEntered, EventKind::SubPhaseBoundary);
        Event {
            kind,
            time: self.macro_step.start + path.after,
            displacement: path.displacement,
            force,
        }
    }

    /// The motion on an interval that was passed, of a step that began at this time and x.
    #[inline(always)]
    fn segment(
        &self,
        began: f64,
        x0: f64,
        &Passed {
            after,
            travel,
            start,
            interval,
        }: &Passed,
    ) -> Segment {
        let eps = self.direction.value();
        let SlipVelocity {
            velocity,
            acceleration,
        } = interval.end;
        Segment {
            start: self.macro_step.start + (began + after),
            length: interval.length,
            displacement: x0 + eps * travel,
            way: eps * interval.travel,
            velocity: [eps * start.velocity, eps * velocity],
            along: Along::Smooth {
                acceleration: [eps * start.acceleration, eps * acceleration],
                temperature: None,
            },
        }
    }

    /// Crosses the remainder of the macro step with uniform acceleration, where it is too short for
    /// the noise to be distinguished from rounding.
    fn coast(&self, path: &mut Path<f64>, observer: &mut impl PathObserver) {
        let Slip {
            noisy: Noisy { scene, .. },
            macro_step,
            direction,
            end_noise,
        } = *self;
        let body = &scene.oscillator;
        let piece = CoastSegment {
            direction,
            displacement: path.displacement,
            velocity: path.motion,
            acceleration: (path.force - self.friction()) / body.mass,
            ends: [(path.after, path.noise), (macro_step.length, end_noise)],
        };
        observer.observe(scene, || piece);
        (path.displacement, path.motion) = piece.at(macro_step.length);
        observer.segment(Segment {
            start: macro_step.start + path.after,
            length: macro_step.length - path.after,
            displacement: piece.displacement,
            way: path.displacement - piece.displacement,
            velocity: [piece.velocity, path.motion],
            along: Along::Smooth {
                acceleration: [piece.acceleration; 2],
                temperature: None,
            },
        });
        path.noise = end_noise;
        path.force = macro_step.last.value + end_noise
            - body.stiffness * path.displacement
            - 2.0 * body.damping * path.motion;
        if scene.own.is_some() {
            path.force += scene.own.at(
                Some(direction),
                path.displacement,
                path.motion,
                macro_step.end,
            );
        }
    }
}

/// A piece of a slip that is too short for the noise to be distinguished from rounding: the body
/// has a uniform acceleration.
#[derive(Clone, Copy)]
struct CoastSegment {
    direction: Sign,
    /// x, x' and x'' at the start of the piece.
    displacement: f64,
    velocity: f64,
    acceleration: f64,
    /// The times at which the piece begins and ends, and n there.
    ends: [Known; 2],
}

impl CoastSegment {
    /// x and x' at a time. The body does not turn.
    #[inline(always)]
    fn at(&self, time: f64) -> (f64, f64) {
        let CoastSegment {
            direction,
            displacement,
            velocity,
            acceleration,
            ends,
        } = *self;
        let (eps, since) = (direction.value(), (time - ends[0].0).max(0.0));
        let x = displacement + since * (velocity + 0.5 * since * acceleration);
        (x, eps * (eps * (velocity + since * acceleration)).max(0.0))
    }
}

impl ObservedSegment for CoastSegment {
    fn end(&self) -> f64 {
        self.ends[1].0
    }

    fn parted(
        &self,
        scene: &Scene,
        instant: ObservationTime,
        draws: &mut AddressedDraws,
    ) -> (Seen, Self, Self) {
        let noise = noise_between(scene, self.ends, instant.time, draws);
        let ((x, v), here) = (self.at(instant.time), (instant.time, noise));
        let seen = (x, v, scene.temperature(instant.forcing, noise), false);
        let behind = CoastSegment {
            displacement: x,
            velocity: v,
            ends: [here, self.ends[1]],
            ..*self
        };
        (
            seen,
            CoastSegment {
                ends: [self.ends[0], here],
                ..*self
            },
            behind,
        )
    }
}
