//! The motion of a slip step of one path without noise. From it a stop is corrected if the noise is
//! weak, and the states inside the step are drawn for an observer.

use super::super::law::{
    FEEBLE, Known, KnownStep, ObservationTime, Scene, SlipPoint, SlipSegment, SlipStep, SlipStop,
    SlipVelocity, Way, force, forcing, forwards, motion, noise_between, resolved_travel,
};
use super::super::noisy::Noisy;
use super::super::work::Resolved;
use super::observation::{ObservedSegment, PathObserver};
use super::path::Path;
use super::slip::Slip;
use super::stop_search::{Passed, PendingIntervals};
use crate::model::Complex;
use crate::noise::AddressedDraws;
use crate::scheme::columns::Seen;
use std::cell::{Cell, RefCell};

/// The part of a step up to an instant, which all paths share that are observed at this instant,
/// and the terms of B there.
#[derive(Debug)]
pub(super) struct FlowBuffers {
    pub part: SlipStep,
    pub terms: Vec<Complex>,
}

/// The motion of a step without noise, from the state at its start.
pub(super) struct StepFlow<'a> {
    slip: &'a Slip<'a>,
    step: &'a SlipStep,
    /// The time at which the step begins, after the start of the macro step.
    after: f64,
    start: SlipPoint,
    /// The drawn motion at both ends of the step, which is searched for a stop.
    searched: KnownStep,
    /// The constant that stands for g in the step; 0 where there is no g.
    push: f64,
    /// The last time at which n was drawn for an observer, and n there: for the rows of the run,
    /// and for the rows between them.
    last_drawn: Cell<[Known; 2]>,
    buffers: &'a RefCell<FlowBuffers>,
}

impl<'a> StepFlow<'a> {
    #[inline(always)]
    pub fn new(
        slip: &'a Slip<'a>,
        step: &'a SlipStep,
        (after, start): (f64, SlipPoint),
        searched: KnownStep,
        push: f64,
        buffers: &'a RefCell<FlowBuffers>,
    ) -> Self {
        StepFlow {
            slip,
            step,
            after,
            start,
            searched,
            push,
            last_drawn: Cell::new([(after, start.n); 2]),
            buffers,
        }
    }

    /// The motion a time after the start of the step.
    #[inline(always)]
    fn since(&self, since: f64) -> Way {
        let Noisy {
            scene, oscillator, ..
        } = self.slip.noisy;
        let (body, eps, friction) = (
            &scene.oscillator,
            self.slip.direction.value(),
            self.slip.friction() - self.push,
        );
        let FlowBuffers { part, terms } = &mut *self.buffers.borrow_mut();
        self.slip.macro_step.set_terms(self.after, terms);
        let mut to = self.start;
        if since == self.step.length() {
            to = self.step.mean(self.start, terms, friction);
        } else if since > 0.0 {
            if part.length() != since {
                part.set_length(oscillator, since);
            }
            to = part.mean(self.start, terms, friction);
        }
        let motion = motion(body, eps, to.v, force(body, forcing(terms), to), friction);
        let travel = resolved_travel(
            eps * self.start.x,
            eps * to.x,
            self.searched.start,
            motion,
            since,
        );
        Way {
            travel,
            motion,
            noise: to.n,
        }
    }

    /// The motion at a time after the start of the macro step.
    #[inline(always)]
    fn at(&self, after: f64) -> Way {
        self.since(after - self.after)
    }

    /// The first stop in the step; none if the body moves on. Where it is observed, `passed`
    /// receives the intervals up to the stop, or to the end of the step.
    #[inline(always)]
    pub fn first_stop(
        &self,
        path: &mut Path<f64>,
        pending: &mut PendingIntervals,
        passed: &mut Vec<Passed>,
        is_observed: bool,
    ) -> Resolved<Option<SlipStop>> {
        let search = &self.slip.noisy.search;
        passed.clear();
        let keep = |interval| {
            if is_observed {
                passed.push(interval);
            }
        };
        let mut stop = search.first(
            &self.searched,
            &mut path.draws,
            pending,
            &mut path.work,
            keep,
        )?;
        // Under g, the motion without noise is not known better than the quintic.
        if let Some(stop) = &mut stop
            && !self.slip.noisy.scene.own.is_some()
            && search.noise * self.searched.root_length < FEEBLE * stop.acceleration.abs()
        {
            *stop = self.on_the_flow(*stop);
            if let Some(last) = passed.last_mut() {
                *last = last.ending_at(stop);
            }
        }
        Ok(stop)
    }

    /// Moves a stop from the quintic of the search to the exact motion without noise; for weak
    /// noise.
    ///
    /// The search replaces the motion without noise by the quintic between the ends of the step.
    /// Given both ends, the conditional laws of a linear system differ only by their means. Let X
    /// be the motion from the start of the step without noise, and Q the quintic through its ends.
    /// The search draws Q + (drawn deviation); the corrected motion is X + (the same deviation). At
    /// the stop that was found it has the velocity V = X' - Q', so its own zero is a time -V/a
    /// away. The first Newton step corrects the error of the quintic, some 1e-6 of a step; the
    /// second one corrects what is left, the square of that. A deviation larger than the noise can
    /// draw is rounding of the quintic, magnified by differentiation, and is bounded.
    #[inline(always)]
    fn on_the_flow(&self, stop: SlipStop) -> SlipStop {
        let StepFlow { slip, searched, .. } = self;
        let Scene {
            oscillator: body,
            relaxation_rate,
            ..
        } = &slip.noisy.scene;
        let eps = slip.direction.value();
        let Way {
            travel,
            motion: end,
            ..
        } = self.since(searched.length);
        let (interpolated_travel, interpolated) = KnownStep {
            end,
            travel,
            ..*searched
        }
        .mean(stop.after);
        let most = MOST_DEVIATIONS * slip.noisy.search.noise * searched.root_length;
        let bounded = |deviation: f64, most: f64| {
            if deviation.abs() > most {
                most.copysign(deviation)
            } else {
                deviation
            }
        };
        let most_velocity = most * searched.length + (searched.end.velocity - end.velocity).abs();
        let most_acceleration = most + (searched.end.acceleration - end.acceleration).abs();
        let off = SlipVelocity {
            velocity: bounded(-interpolated.velocity, most_velocity),
            acceleration: bounded(
                stop.acceleration - interpolated.acceleration,
                most_acceleration,
            ),
        };

        let mut moved = stop;
        for _ in 0..FLOW_STEPS {
            let exact = self.since(moved.after);
            let travel = stop.travel + (exact.travel - interpolated_travel);
            let velocity = exact.motion.velocity + off.velocity;
            let acceleration = exact.motion.acceleration + off.acceleration;
            let slope = slip.noisy.scene.forcing_slope(&self.buffers.borrow().terms);
            let change = slope
                - relaxation_rate * exact.noise
                - body.stiffness * (eps * exact.motion.velocity);
            let jerk = (eps * change - 2.0 * body.damping * acceleration) / body.mass;
            let late = -velocity / acceleration;
            let after = moved.after + late;
            if !(acceleration < 0.0 && after > 0.0 && after <= searched.length) {
                return stop;
            }
            let travel = forwards(travel + late * (velocity + 0.5 * late * acceleration));
            moved = SlipStop {
                after,
                acceleration: acceleration + late * jerk,
                travel,
            };
        }
        moved
    }

    /// Passes the completed intervals to an observer. The last of them ends at the stop, if there
    /// is one. n is known at its end; at a stop it is what the balance of forces requires.
    #[inline(always)]
    pub fn show(
        &self,
        passed: &[Passed],
        stop: Option<&SlipStop>,
        known_end: Known,
        observer: &mut impl PathObserver,
    ) {
        // This is not a closure, because a closure is not compiled for the instruction set.
        for (
            i,
            &Passed {
                after,
                travel,
                start,
                interval,
            },
        ) in passed.iter().enumerate()
        {
            let end = match stop {
                Some(stop) if i + 1 == passed.len() => stop.after,
                _ => after + interval.length,
            };
            let (after, until) = (self.after + after, self.after + end);
            if observer.is_ahead(until) {
                let (eps, x0) = (self.slip.direction.value(), self.start.x);
                let piece = SlipSegment {
                    eps,
                    x0,
                    after,
                    until,
                    travel,
                    start,
                    interval,
                };
                let piece = piece.less([&self.at(after), &self.at(until)]);
                let known = [self.last_drawn.get()[0], known_end];
                observer.observe(&self.slip.noisy.scene, || FlowSegment {
                    flow: self,
                    piece,
                    known,
                });
            }
        }
    }

    /// Draws n at an instant from its bridge between two known times, or between the instant that
    /// was drawn before it and the later of these times.
    #[inline(always)]
    fn noise(
        &self,
        instant: ObservationTime,
        [mut before, behind]: [Known; 2],
        draws: &mut AddressedDraws,
    ) -> f64 {
        let mut last_drawn = self.last_drawn.get();
        let between = &mut last_drawn[usize::from(instant.is_additional)];
        if between.0 > before.0 {
            before = *between;
        }
        let noise = noise_between(
            &self.slip.noisy.scene,
            [before, behind],
            instant.time,
            draws,
        );
        *between = (instant.time, noise);
        self.last_drawn.set(last_drawn);
        noise
    }
}

/// A piece of a slip of one path, with the motion of its step without noise.
struct FlowSegment<'a> {
    flow: &'a StepFlow<'a>,
    piece: SlipSegment,
    /// n at known times before and after, as drawn for the rows of the run.
    known: [Known; 2],
}

impl ObservedSegment for FlowSegment<'_> {
    fn end(&self) -> f64 {
        self.piece.until
    }

    #[inline(always)]
    fn parted(
        &self,
        scene: &Scene,
        instant: ObservationTime,
        draws: &mut AddressedDraws,
    ) -> (Seen, Self, Self) {
        let FlowSegment {
            flow,
            ref piece,
            known,
        } = *self;
        let here = flow.at(instant.time);
        let state = piece.state(scene, instant, &here, draws.three_normals());
        let is_felt = piece.is_felt(scene, instant, &here, flow.step.length());
        let (x, v) = piece.seen(&state);
        let noise = match is_felt {
            // The balance of forces takes the constant that stands for g for g itself.
            true if scene.own.is_some() => {
                let here = scene.own.at(Some(flow.slip.direction), x, v, instant.at);
                state.noise - (here - flow.push)
            }
            true => state.noise,
            false => flow.noise(instant, known, draws),
        };
        let [first, second] = piece.parted_at(instant, &state);
        let now = (instant.time, noise);
        let before = FlowSegment {
            flow,
            piece: first,
            known: [known[0], now],
        };
        let behind = FlowSegment {
            flow,
            piece: second,
            known: [now, known[1]],
        };
        (
            (x, v, scene.temperature(instant.forcing, noise), false),
            before,
            behind,
        )
    }
}

/// No draw is further from its mean than this number of standard deviations. These are at most c
/// sqrt(h) for a and c h^{3/2} for V.
const MOST_DEVIATIONS: f64 = 10.0;

/// Newton steps from the stop of the quintic to that of the exact motion.
const FLOW_STEPS: usize = 3;
