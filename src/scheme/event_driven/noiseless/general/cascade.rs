//! The cascade without diffusion for any force, to a tolerance far below the digits that are
//! reported.
//!
//! - Slip: x and x' are integrated in steps that adapt to the force ([`SlipMotion`]). The state at
//!   a time inside a step, an instant of the timeline or the end of the sub-phase, is that after a
//!   shorter step. The sub-phase ends at the first zero of eps x' ([`first_stop`]).
//! - Stick: the phase ends at the first zero of f_s - b or f_s + b. Where g does not depend on time
//!   and there is a spring, b(t) is that of a scene without g at another displacement, and
//!   [`Noiseless::stick_exit`] never misses an exit. Otherwise the function b(t) is searched in
//!   steps ([`first_exit`]).
//!
//! Where friction has a load, b and f_s in a stick are those of [`crate::model::Force::hold`], and
//! the b of the model is told at events.
//!
//! Steps of slips and of searches end where the force has kinks in t: at the samples of a measured
//! temperature, and of an input of g.
//! Nothing is random, so one path is computed and reported for every lane.

use super::super::super::work::{Simulated, Unresolved, WITHOUT_NOISE, WorkLeft, work_limit};
use super::super::exact_time::ExactTime;
use super::super::one_path::Noiseless;
use super::forces::{Forces, LocalTemperature};
use super::slip_motion::{Kinematics, SlipMotion};
use super::slip_search::first_stop;
use super::stick_search::{SearchSteps, first_exit};
use crate::model::{Event, EventKind, Model, Phase, Sign};
use crate::scheme::columns::{LOST, Seen, StateColumns};
use crate::scheme::{Along, Glide, Instant, Observer, Timeline};
use std::cell::RefCell;

/// The relative error of a step of a slip.
const TOLERANCE: f64 = 1e-13;

/// The tolerance where g depends on time, per unit of relative rounding of the time: noise of this
/// size does not converge.
const ROUNDING_OF_TIME: f64 = 8.0 * f64::EPSILON;

/// The shortest step of a slip, as a fraction of the fastest time scale that is known.
const SHORTEST: f64 = 1e-12;

/// Pieces in which the motion of a step is told. A step is up to some three of the fastest time
/// scales long.
const PIECES: u32 = 24;

/// The first interval of a search in a stick, as a fraction of the fastest time scale that is
/// known.
const FIRST: f64 = 0.125;

/// The fewest intervals of a search for t_end.
const FEWEST: f64 = 64.0;

/// The cascade of a general force without noise, to a tolerance far below the digits that are
/// reported.
#[derive(Clone, Debug)]
pub struct GeneralNoiseless {
    model: Model,
    timeline: Timeline,
    forces: Forces,
    /// The sticks of a scene without g, for a g that does not depend on time; none if b does not
    /// change with time, so that no stick ends.
    sticks: Option<Box<Noiseless>>,
    /// The longest step of a search in a stick.
    longest: f64,
    /// The fastest time scale that is known.
    span: f64,
    tolerance: f64,
    /// The number of evaluations that the path may make.
    pub work_limit: u64,
}

/// A static phase, or one step of a slip.
struct Stretch {
    phase: Phase,
    /// The temperature near the start.
    temperature: LocalTemperature,
    from: Kinematics,
    /// The duration of the stretch and what ends it; none if it does not end before t_end.
    end: Option<(f64, StretchEnd)>,
}

/// What ends a stretch.
#[derive(Clone, Copy)]
enum StretchEnd {
    Event(Event),
    /// The end of a step: the motion there, and the length of the step to try next.
    Step(Kinematics, f64),
}

impl Stretch {
    /// What ends the stretch, if anything does, and whether it ends at a time or before.
    fn end_by(&self, time: f64) -> Option<(StretchEnd, bool)> {
        let (duration, end) = self.end?;
        let is_due = match end {
            StretchEnd::Event(event) => event.time <= time,
            StretchEnd::Step(..) => duration <= self.temperature.start().until(time),
        };
        Some((end, is_due))
    }
}

impl GeneralNoiseless {
    /// The scheme for a scene whose motion does not depend on noise.
    pub fn new(model: &Model, timeline: &Timeline) -> Self {
        let oscillator = model.oscillator;
        let forces = Forces::new(model);
        let own = (oscillator.stiffness / oscillator.mass).abs().sqrt();
        let rate = forces.fastest_rate(timeline.end);
        let longest = if rate > 0.0 { FIRST / rate } else { f64::INFINITY }.min(timeline.end / FEWEST);
        let forces = forces.with_kinks(timeline.end, longest);
        let fastest = rate.max(own).max((2.0 * oscillator.damping / oscillator.mass).abs());
        let span = if fastest > 0.0 { 1.0 / fastest } else { timeline.end.max(f64::MIN_POSITIVE) };
        let is_searched = forces.is_own_in_time() || forces.have_load() || oscillator.stiffness == 0.0;
        let sticks = (!is_searched && forces.depend_on_time()).then(|| {
            let mut undamped = model.clone();
            (undamped.oscillator.damping, undamped.force) = (0.0, None);
            Box::new(Noiseless::new(&undamped, timeline))
        });
        let tolerance = TOLERANCE;
        let model = model.clone();
        GeneralNoiseless {
            model,
            timeline: *timeline,
            forces,
            sticks,
            longest,
            span,
            tolerance,
            work_limit: work_limit(WITHOUT_NOISE),
        }
    }

    /// Computes the path and reports it to the observer once for each of `lanes` lanes. If the path
    /// cannot be resolved, all lanes are lost.
    pub fn simulate(&self, lanes: usize, observer: &mut dyn Observer) -> Simulated {
        let (mut columns, observer) = (StateColumns::new(lanes), RefCell::new(observer));
        let is_stopped = || observer.borrow().is_stopped();
        let mut work = WorkLeft::watched(self.work_limit, &is_stopped);
        let mut stretch = self.initial_stretch(&mut work);
        let follows = observer.borrow().follows();
        let follow = |stretch: &Stretch, duration: f64| -> Result<(), Unresolved> {
            if !follows {
                return Ok(());
            }
            self.glides(stretch, duration, |glide| {
                (0..lanes).for_each(|lane| observer.borrow_mut().glide(lane, &glide))
            })
        };
        for stop in self.timeline.stops() {
            while let Ok(Some((end, true))) = stretch.as_ref().map(|stretch| stretch.end_by(stop.time)) {
                if let Ok(here) = &stretch
                    && let Err(lost) = follow(here, here.end.map_or(0.0, |(duration, _)| duration))
                {
                    stretch = Err(lost);
                    break;
                }
                if let StretchEnd::Event(event) = end {
                    (0..lanes).for_each(|lane| observer.borrow_mut().event(lane, event));
                }
                stretch = stretch.and_then(|stretch| self.next_stretch(&stretch, &mut work));
            }
            if let (Ok(here), Instant::End) = (&stretch, stop.instant)
                && let Err(lost) = follow(here, here.temperature.start().until(stop.time))
            {
                stretch = Err(lost);
            }
            let seen = stretch.as_ref().map_err(|lost| *lost).and_then(|here| self.state(here, stop.time, &mut work));
            columns.fill(seen.unwrap_or(LOST));
            stretch = seen.and(stretch);
            if is_stopped() {
                break;
            }
            observer.borrow_mut().snapshot(stop.instant, columns.snapshot(stop.time));
        }
        let why = stretch.err();
        let lost = if why.is_some() { (0..lanes).collect() } else { Vec::new() };
        Simulated { lost, why, evaluations: self.work_limit - work.left() }
    }

    fn initial_stretch(&self, work: &mut WorkLeft) -> Result<Stretch, Unresolved> {
        let displacement = self.model.initial_displacement;
        let velocity = self.model.initial_velocity;
        if velocity == 0.0 {
            return self.stick(ExactTime::ZERO, displacement, None, work);
        }
        // A body that moves at t = 0: its first stick is empty.
        let temperature = self.forces.near(ExactTime::ZERO);
        let force = self.forces.at(&temperature, None, [displacement, velocity], 0.0);
        let kind = EventKind::SlipStarted(Sign::of(velocity));
        let end = Some((0.0, StretchEnd::Event(Event { kind, time: 0.0, displacement, force })));
        let from = Kinematics { after: 0.0, displacement, velocity: 0.0, acceleration: 0.0 };
        Ok(Stretch { phase: Phase::Static, temperature, from, end })
    }

    /// The stretch that follows `stretch`.
    fn next_stretch(&self, stretch: &Stretch, work: &mut WorkLeft) -> Result<Stretch, Unresolved> {
        let Some((duration, end)) = stretch.end else { return Err(Unresolved::NoNumber) };
        let start = stretch.temperature.start().after(duration);
        match (end, stretch.phase) {
            (StretchEnd::Event(event), _) => match event.kind.phase() {
                Phase::Static => self.stick(start, event.displacement, Some(event.force), work),
                Phase::Slip(direction) => {
                    let velocity = if event.time == 0.0 { self.model.initial_velocity } else { 0.0 };
                    self.slip(start, (event.displacement, velocity), direction, self.span, work)
                }
            },
            (StretchEnd::Step(motion, next), Phase::Slip(direction)) => {
                self.slip(start, (motion.displacement, motion.velocity), direction, next, work)
            }
            (StretchEnd::Step(..), Phase::Static) => Err(Unresolved::NoNumber),
        }
    }

    /// b in a stick, and its limit.
    fn held(&self, at: &LocalTemperature, displacement: f64, work: &mut WorkLeft) -> Result<[f64; 2], Unresolved> {
        work.spend()?;
        let [b, excess] = self.forces.held(at, displacement, 0.0);
        let limit = self.model.friction.static_force + excess;
        if b.is_finite() && limit.is_finite() { Ok([b, limit]) } else { Err(Unresolved::NoNumber) }
    }

    /// A static phase and its exit, the first time at which |b| > f_s. `force` is b at the start,
    /// if it is known exactly.
    fn stick(
        &self,
        start: ExactTime,
        displacement: f64,
        force: Option<f64>,
        work: &mut WorkLeft,
    ) -> Result<Stretch, Unresolved> {
        let (temperature, f_s, has_load) =
            (self.forces.near(start), self.model.friction.static_force, self.forces.have_load());
        let [held, limit] = self.held(&temperature, displacement, work)?;
        let force = force.filter(|_| !has_load).unwrap_or(held);
        let exit = |r: f64, b: f64, direction: Sign| {
            let (kind, time) = (EventKind::SlipStarted(direction), start.after(r));
            let told = || self.forces.at(&self.forces.near(time), None, [displacement, 0.0], 0.0);
            let force = if has_load { told() } else { b };
            (r, StretchEnd::Event(Event { kind, time: time.value(), displacement, force }))
        };
        let end = if force.abs() > limit {
            Some(exit(0.0, force, Sign::of(force)))
        } else if let Some(sticks) = &self.sticks {
            // K (beta T - x) + g = K (beta T - (x - g/K)).
            let g = self.forces.hold(displacement, start.value()).pull;
            let found = sticks.stick_exit(start, displacement - g / self.model.oscillator.stiffness, work)?;
            found.map(|event| exit(start.until(event.time).max(0.0), event.force, Sign::of(event.force)))
        } else if self.forces.depend_on_time() {
            // A limit that moves is made constant.
            let mut b = |r: f64| {
                let [b, limit] = self.held(&self.forces.near(start.after(r)), displacement, work)?;
                Ok(if has_load { b / limit } else { b })
            };
            let threshold = if has_load { 1.0 } else { f_s };
            let until_kink = |r: f64| self.forces.near(start.after(r)).until_kink;
            let horizon = start.until(self.timeline.end);
            let found = first_exit(&mut b, threshold, horizon, self.search_steps(), until_kink)?;
            match found {
                Some(r) => {
                    let direction = Sign::of(b(r)?);
                    Some(exit(r, direction.value() * f_s, direction))
                }
                None => None,
            }
        } else {
            None
        };
        let from = Kinematics { after: 0.0, displacement, velocity: 0.0, acceleration: 0.0 };
        Ok(Stretch { phase: Phase::Static, temperature, from, end })
    }

    fn search_steps(&self) -> SearchSteps {
        SearchSteps { first: self.longest.min(FIRST * self.span), longest: self.longest }
    }

    /// A step of a sub-phase, or the part of it up to the first time after its start at which eps
    /// x' = 0.
    fn slip(
        &self,
        start: ExactTime,
        (displacement, velocity): (f64, f64),
        direction: Sign,
        step: f64,
        work: &mut WorkLeft,
    ) -> Result<Stretch, Unresolved> {
        let temperature = self.forces.near(start);
        let slip = self.motion(&temperature, direction, displacement);
        let from = slip.with(displacement, velocity, 0.0, work)?;
        let horizon = start.until(self.timeline.end);
        let end = if horizon <= 0.0 {
            None
        } else {
            let (to, next) = slip.step(from, step, horizon.min(temperature.until_kink), work)?;
            match first_stop(&slip, direction.value(), from, to, work)? {
                Some(stop) => {
                    let Kinematics { after, displacement, .. } = stop;
                    let [held, excess] = self.forces.held(&temperature, displacement, after);
                    let limit = self.model.friction.static_force + excess;
                    let kind = EventKind::at_rest(held.abs() <= limit, held);
                    let force = self.forces.at(&temperature, None, [displacement, 0.0], after);
                    let time = start.after(after).value();
                    Some((after, StretchEnd::Event(Event { kind, time, displacement, force })))
                }
                None => (to.after < horizon).then_some((to.after, StretchEnd::Step(to, next))),
            }
        };
        Ok(Stretch { phase: Phase::Slip(direction), temperature, from, end })
    }

    /// The first part of a stretch, of this duration, in pieces that a quintic describes. They do
    /// not count as work of the path, which is the same whether it is followed or not.
    fn glides(&self, stretch: &Stretch, duration: f64, mut tell: impl FnMut(Glide)) -> Result<(), Unresolved> {
        let Phase::Slip(direction) = stretch.phase else { return Ok(()) };
        let (motion, mut work) = (
            self.motion(&stretch.temperature, direction, stretch.from.displacement),
            WorkLeft::watched(work_limit(WITHOUT_NOISE), &|| false),
        );
        let mut here = stretch.from;
        for i in 1..=PIECES {
            let there = motion.at(here, duration * (f64::from(i) / f64::from(PIECES)), &mut work)?;
            tell(Glide {
                start: stretch.temperature.start().after(here.after).value(),
                length: there.after - here.after,
                displacement: here.displacement,
                way: there.displacement - here.displacement,
                velocity: [here.velocity, there.velocity],
                along: Along::Smooth { acceleration: [here.acceleration, there.acceleration] },
            });
            here = there;
        }
        Ok(())
    }

    /// The equation of motion of a sub-phase that begins at x.
    fn motion<'a>(&'a self, temperature: &'a LocalTemperature, direction: Sign, x: f64) -> SlipMotion<'a> {
        let start = temperature.start().value();
        let rounding = if self.forces.is_own_in_time() { ROUNDING_OF_TIME * start / self.span } else { 0.0 };
        let mut motion = SlipMotion {
            forces: &self.forces,
            temperature,
            direction,
            friction: direction.value() * self.model.friction.dynamic_force,
            mass: self.model.oscillator.mass,
            tolerance: self.tolerance.max(rounding),
            shortest: SHORTEST * self.span,
        };
        let of_inputs = self.forces.rounding_of_inputs(x, start);
        if of_inputs > 0.0 {
            let rest = Kinematics { after: 0.0, displacement: x, velocity: 0.0, acceleration: 0.0 };
            motion.tolerance = motion.tolerance.max(of_inputs / (motion.mass * motion.size(&rest)));
        }
        motion
    }

    /// x, x', T and whether the path is static, at a time within the stretch.
    fn state(&self, stretch: &Stretch, t: f64, work: &mut WorkLeft) -> Result<Seen, Unresolved> {
        let temperature = self.model.temperature.mean(t);
        let Kinematics { displacement, .. } = stretch.from;
        let Phase::Slip(direction) = stretch.phase else { return Ok((displacement, 0.0, temperature, true)) };
        let after = stretch.temperature.start().until(t).max(0.0);
        let motion =
            self.motion(&stretch.temperature, direction, stretch.from.displacement).at(stretch.from, after, work)?;
        Ok((motion.displacement, motion.velocity, temperature, false))
    }
}

#[cfg(test)]
impl GeneralNoiseless {
    /// The same scheme with another tolerance, for tests.
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        GeneralNoiseless { tolerance, ..self }
    }
}
