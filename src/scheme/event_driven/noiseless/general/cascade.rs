//! The cascade without diffusion for any force, to a tolerance far below the reported precision.
//!
//! - Slip: x and x' are integrated in steps that adapt to the force ([`SlipMotion`]). The state at
//!   a time inside a step, an instant of the timeline or the end of the sub-phase, is that after a
//!   shorter step. The sub-phase ends at the first zero of eps x' ([`first_stop`]).
//! - Stick: the phase ends where b, or -b, first exceeds its limit, f_s. Where g does not depend on time
//!   and there is a spring, b(t) is that of a scene without g at another displacement, and
//!   [`Noiseless::stick_exit`] never misses an exit. Otherwise the function b(t) is searched in
//!   steps ([`first_exit`]).
//!
//! Where friction has a load, the limits are those of [`crate::model::Force::hold`].
//!
//! Steps of slips and of searches end where the force has kinks in t: at the samples of a measured
//! temperature, and of an input of g.
//! Nothing is random, so one path is computed and reported for every lane.

use super::super::super::work::{Resolved, Unresolved, WITHOUT_NOISE, WorkLeft, work_limit};
use super::super::dense_output::{FollowedSlip, Kinematics};
use super::super::exact_time::ExactTime;
use super::super::one_path::Noiseless;
use super::super::path_segment::{End, PathSegment, PathSegments};
use super::collocation::Collocation;
use super::forces::{Forces, LocalTemperature};
use super::slip_motion::SlipMotion;
use super::slip_search::first_stop;
use super::stick_search::{Held, SearchSteps, first_exit};
use crate::model::{Event, EventKind, Phase, Problem, Sign, let_go};
use crate::scheme::columns::Seen;
use crate::scheme::{Segment, Timeline};

/// The relative error of a step of a slip.
const TOLERANCE: f64 = 1e-13;

/// The tolerance where g depends on time, per unit of relative rounding of the time: noise of this
/// size does not converge.
const ROUNDING_OF_TIME: f64 = 8.0 * f64::EPSILON;

/// The stairs of inputs, as a fraction of the time.
const STAIRS: f64 = 4.0 * f64::EPSILON;

/// The shortest step of a slip, as a fraction of the fastest time scale that is known.
const SHORTEST: f64 = 1e-12;

/// Segments in which the motion of a step is reported. A step is up to some three of the fastest time
/// scales long.
const PIECES: u32 = 24;

/// The first interval of a search in a stick, as a fraction of the fastest time scale that is
/// known.
const FIRST: f64 = 0.125;

/// The fewest intervals of a search for t_end.
const FEWEST: f64 = 64.0;

/// The cascade of a general force without noise, to a tolerance far below the reported precision.
#[derive(Clone, Debug)]
pub struct GeneralNoiseless {
    model: Problem,
    timeline: Timeline,
    forces: Forces,
    /// The sticks of a scene without g, for a g that does not depend on time; none if b does not
    /// change with time, so that no stick ends.
    sticks: Option<Box<Noiseless>>,
    /// The longest step of a search in a stick.
    longest: f64,
    /// The fastest time scale that is known.
    span: f64,
    /// The rules for a body that is damped strongly.
    collocation: Collocation,
    /// The fastest time scale, that of a strong damping apart.
    span_of_forces: f64,
    pub tolerance: f64,
    /// The number of evaluations that the path may make.
    pub work_limit: u64,
}

/// A static phase, or one step of a slip. At the end of a step, its cut, the motion is known, and
/// the length of the step to try next.
type GeneralSegment = PathSegment<SegmentStart, (Kinematics, f64)>;

/// The start of a part.
pub struct SegmentStart {
    /// The temperature near it.
    temperature: LocalTemperature,
    motion: Kinematics,
}

impl GeneralNoiseless {
    /// The scheme for a scene whose motion does not depend on noise.
    pub fn new(model: &Problem, timeline: &Timeline) -> Self {
        let oscillator = model.oscillator;
        let forces = Forces::new(model);
        let own = (oscillator.stiffness / oscillator.mass).abs().sqrt();
        let rate = forces.fastest_rate(timeline.end);
        let longest = if rate > 0.0 {
            FIRST / rate
        } else {
            f64::INFINITY
        }
        .min(timeline.end / FEWEST);
        let forces = forces.with_kinks(timeline.end, longest);
        let damping_rate = 2.0 * oscillator.damping / oscillator.mass;
        let collocation = Collocation::new(damping_rate, rate.max(own), timeline.end);
        let span_of = |rate: f64| {
            if rate > 0.0 {
                1.0 / rate
            } else {
                timeline.end.max(f64::MIN_POSITIVE)
            }
        };
        let span = span_of(rate.max(own).max(damping_rate.abs()));
        let span_of_forces = if collocation.is_always_used() {
            span_of(rate.max(own))
        } else {
            span
        };
        let is_searched =
            forces.own.depends_on_time() || forces.own.has_load() || oscillator.stiffness == 0.0;
        let sticks = (!is_searched && forces.depend_on_time()).then(|| {
            let mut undamped = model.clone();
            (undamped.oscillator.damping, undamped.force) = (0.0, None);
            Box::new(Noiseless::new(&undamped, timeline))
        });
        GeneralNoiseless {
            model: model.clone(),
            timeline: *timeline,
            forces,
            sticks,
            longest,
            span,
            collocation,
            span_of_forces,
            tolerance: TOLERANCE,
            work_limit: work_limit(WITHOUT_NOISE),
        }
    }

    /// b in a stick, and the limits of b and -b.
    fn held(
        &self,
        at: &LocalTemperature,
        displacement: f64,
        work: &mut WorkLeft,
    ) -> Resolved<Held> {
        work.spend()?;
        let (b, excess) = self.forces.held(at, displacement, 0.0);
        let limits = self.model.friction.limits(excess);
        let is_known = [b, limits[0], limits[1]]
            .iter()
            .all(|force| force.is_finite());
        if is_known {
            Ok(Held { b, limits })
        } else {
            Err(Unresolved::NoNumber)
        }
    }

    /// A static phase and its exit, the first time at which b or -b exceeds its limit. `force` is b at the start,
    /// if it is known exactly.
    fn stick(
        &self,
        start: ExactTime,
        displacement: f64,
        force: Option<f64>,
        work: &mut WorkLeft,
    ) -> Resolved<GeneralSegment> {
        let (temperature, f_s, has_load) = (
            self.forces.near(start),
            self.model.friction.static_force,
            self.forces.own.has_load(),
        );
        let held = self.held(&temperature, displacement, work)?;
        let force = force.filter(|_| !has_load).unwrap_or(held.b);
        let exit = |r: f64, b: f64, direction: Sign| {
            let (kind, time) = (EventKind::SlipStarted(direction), start.after(r));
            let told = || {
                self.forces
                    .at(&self.forces.near(time), None, [displacement, 0.0], 0.0)
            };
            let force = if has_load { told() } else { b };
            (
                r,
                End::Event(Event {
                    kind,
                    time: time.value(),
                    displacement,
                    force,
                }),
            )
        };
        let end = if let Some(direction) = let_go(force, held.limits) {
            Some(exit(0.0, force, direction))
        } else if let Some(sticks) = &self.sticks {
            // K (beta T - x) + g = K (beta T - (x - g/K)).
            let g = self.forces.own.hold(displacement, start.value()).pull;
            let found = sticks.stick_exit(
                start,
                displacement - g / self.model.oscillator.stiffness,
                work,
            )?;
            found.map(|event| {
                exit(
                    start.until(event.time).max(0.0),
                    event.force,
                    Sign::of(event.force),
                )
            })
        } else if self.forces.depend_on_time() {
            let held = |r: f64| self.held(&self.forces.near(start.after(r)), displacement, work);
            let until_kink = |r: f64| self.forces.near(start.after(r)).until_kink;
            let horizon = start.until(self.timeline.end);
            let found = first_exit(held, horizon, self.search_steps(), until_kink)?;
            found.map(|(r, direction)| exit(r, direction.value() * f_s, direction))
        } else {
            None
        };
        let motion = Kinematics {
            after: 0.0,
            displacement,
            velocity: 0.0,
            acceleration: 0.0,
        };
        Ok(GeneralSegment {
            start,
            phase: Phase::Static,
            from: SegmentStart {
                temperature,
                motion,
            },
            end,
        })
    }

    fn search_steps(&self) -> SearchSteps {
        SearchSteps {
            first: self.longest.min(FIRST * self.span),
            longest: self.longest,
        }
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
    ) -> Resolved<GeneralSegment> {
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
                    let Kinematics {
                        after,
                        displacement,
                        ..
                    } = stop;
                    let (held, excess) = self.forces.held(&temperature, displacement, after);
                    let limits = self.model.friction.limits(excess);
                    let kind = let_go(held, limits)
                        .map_or(EventKind::StickEntered, EventKind::SubPhaseBoundary);
                    let force = self
                        .forces
                        .at(&temperature, None, [displacement, 0.0], after);
                    let time = start.after(after).value();
                    Some((
                        after,
                        End::Event(Event {
                            kind,
                            time,
                            displacement,
                            force,
                        }),
                    ))
                }
                None => (to.after < horizon).then_some((to.after, End::Cut((to, next)))),
            }
        };
        let from = SegmentStart {
            temperature,
            motion: from,
        };
        Ok(GeneralSegment {
            start,
            phase: Phase::Slip(direction),
            from,
            end,
        })
    }

    /// The equation of motion of a sub-phase that begins at x.
    fn motion<'a>(
        &'a self,
        temperature: &'a LocalTemperature,
        direction: Sign,
        x: f64,
    ) -> SlipMotion<'a> {
        let start = temperature.start.value();
        let rounding = if self.forces.own.depends_on_time() {
            ROUNDING_OF_TIME * start / self.span_of_forces
        } else {
            0.0
        };
        let mut motion = SlipMotion {
            forces: &self.forces,
            temperature,
            direction,
            friction: direction.value() * self.model.friction.dynamic_force,
            mass: self.model.oscillator.mass,
            tolerance: self.tolerance.max(rounding),
            shortest: SHORTEST * self.span,
            stairs: 0.0,
            collocation: &self.collocation,
        };
        let of_inputs = self.forces.rounding_of_inputs(x, start);
        if of_inputs > 0.0 {
            let rest = Kinematics {
                after: 0.0,
                displacement: x,
                velocity: 0.0,
                acceleration: 0.0,
            };
            motion.tolerance = motion
                .tolerance
                .max(of_inputs / (motion.mass * motion.size(&rest)));
            motion.stairs = STAIRS * start;
            motion.shortest = motion.shortest.max(motion.stairs);
        }
        motion
    }
}

impl PathSegments for GeneralNoiseless {
    type Motion = SegmentStart;
    type Cut = (Kinematics, f64);

    fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    fn work_limit(&self) -> u64 {
        self.work_limit
    }

    fn first(&self, work: &mut WorkLeft) -> Resolved<GeneralSegment> {
        let displacement = self.model.initial_displacement;
        let velocity = self.model.initial_velocity;
        if velocity == 0.0 {
            return self.stick(ExactTime::ZERO, displacement, None, work);
        }
        // A body that moves at t = 0: its first stick is empty.
        let temperature = self.forces.near(ExactTime::ZERO);
        let force = self
            .forces
            .at(&temperature, None, [displacement, velocity], 0.0);
        let kind = EventKind::SlipStarted(Sign::of(velocity));
        let end = Some((
            0.0,
            End::Event(Event {
                kind,
                time: 0.0,
                displacement,
                force,
            }),
        ));
        let motion = Kinematics {
            after: 0.0,
            displacement,
            velocity: 0.0,
            acceleration: 0.0,
        };
        Ok(GeneralSegment {
            start: ExactTime::ZERO,
            phase: Phase::Static,
            from: SegmentStart {
                temperature,
                motion,
            },
            end,
        })
    }

    fn next(
        &self,
        part: &GeneralSegment,
        (duration, end): (f64, End<Self::Cut>),
        work: &mut WorkLeft,
    ) -> Resolved<GeneralSegment> {
        let start = part.start.after(duration);
        match (end, part.phase) {
            (End::Event(event), _) => match event.kind.phase() {
                Phase::Static => self.stick(start, event.displacement, Some(event.force), work),
                Phase::Slip(direction) => {
                    let velocity = if event.time == 0.0 {
                        self.model.initial_velocity
                    } else {
                        0.0
                    };
                    self.slip(
                        start,
                        (event.displacement, velocity),
                        direction,
                        self.span,
                        work,
                    )
                }
            },
            (End::Cut((motion, next)), Phase::Slip(direction)) => self.slip(
                start,
                (motion.displacement, motion.velocity),
                direction,
                next,
                work,
            ),
            (End::Cut(_), Phase::Static) => Err(Unresolved::NoNumber),
        }
    }

    /// The segments do not count as work of the path, which must not depend on its observation.
    fn segments(
        &self,
        part: &GeneralSegment,
        duration: f64,
        report: impl FnMut(Segment),
    ) -> Resolved<()> {
        let Phase::Slip(direction) = part.phase else {
            return Ok(());
        };
        let SegmentStart {
            temperature,
            motion: from,
        } = &part.from;
        let motion = self.motion(temperature, direction, from.displacement);
        let mut work = WorkLeft::watched(work_limit(WITHOUT_NOISE), &|| false);
        let knots = (1..=PIECES).map(|i| duration * (f64::from(i) / f64::from(PIECES)));
        let followed = FollowedSlip {
            start: part.start,
            displacement: 0.0,
            temperature: None,
        };
        followed.report(
            *from,
            knots,
            |here, after| motion.at(here, after, &mut work),
            report,
        )
    }

    fn state(&self, part: &GeneralSegment, t: f64, work: &mut WorkLeft) -> Resolved<Seen> {
        let temperature = self.model.temperature.mean(t);
        let Kinematics { displacement, .. } = part.from.motion;
        let Phase::Slip(direction) = part.phase else {
            return Ok((displacement, 0.0, temperature, true));
        };
        let after = part.start.until(t).max(0.0);
        let motion = self
            .motion(&part.from.temperature, direction, displacement)
            .at(part.from.motion, after, work)?;
        Ok((motion.displacement, motion.velocity, temperature, false))
    }
}
