//! The quasi-static scheme: the paper's approximation for slow forcing (its section on the bridge),
//! with damping.
//!
//! During a slip the temperature is assumed to be constant. At the exit |b| = f_s, so the body
//! starts from rest towards an equilibrium at a distance of (f_s - f_d)/K, and swings beyond it
//! until it is at rest again ([`StepResponse`]). The cascade is then a recursion:
//!
//! ```text
//! tau_{j+1/2} = inf{t > tau_j : |b(x_j, t)| > f_s},      tau_{j+1} = tau_{j+1/2} + pi/w_d,
//! x_{j+1} = x_j + (1 + q) eps_j (f_s - f_d)/K,           eps_j = sign b(x_j, tau_{j+1/2})
//! q = e^{-pi zeta/sqrt(1 - zeta^2)},   zeta = alpha/(m w0),   w_d = w0 sqrt(1 - zeta^2)
//! ```
//!
//! with b = K (beta T - x) at rest. The paper has zeta = 0, where the half-cycle lasts pi/w0 and
//! moves the body by 2 (f_s - f_d)/K. (The paper prints the integrals of this section from tau_j;
//! they start at tau_{j+1/2}.) The states x(t) and x'(t) during a slip are those of the swing. With
//! f_s = f_d the body never moves; slips still take their time.
//!
//! **A body that starts outside the stick band**, |b| > f_s at t = 0, swings from its actual b.
//! This may be due to x(0) or a stationary initial noise. The equilibrium is (|b| - f_d)/K away,
//! and `x_{j+1} = x_j + (1 + q) eps_j (|b| - f_d)/K`. If this swing also ends outside, the body
//! swings back immediately, in a further sub-phase. With f_s for |b| it would come to rest on
//! another lattice, and stay on it. Later b reaches f_s continuously.
//!
//! **At critical damping and above** (zeta >= 1) the swing has no overshoot, q = 0, and never ends.
//! The slip is defined to last the settling time, until a thousandth of the distance is left, and
//! to cover the whole distance. A slip must end, or the recursion would stop at the first one. Any
//! end at which nearly all of the distance is covered gives the same sticks and jumps where the
//! forcing is slow, and the recursion is only meant for slow forcing. The settling time is also
//! about how long such a slip lasts in the model, where noise ends it as soon as the noise moves x'
//! more than the rest of the swing does (docs/event-driven.md).
//!
//! **Limits of the approximation.** If the forcing moves the equilibrium faster than the body would
//! swing back, K |beta| |T'| > (f_s - f_d) w0 [`StepResponse::return_speed`], x' has no zero: the
//! body creeps behind the temperature until the temperature turns. Without noise this holds for
//! every forcing, however slow, if zeta >= 1, and for all but the slowest forcing if zeta is
//! slightly below 1.
//!
//! Exits are those of the event-driven scheme: first roots without noise, crossings of a threshold
//! by a bridge with noise. The recursion does not check whether |b| <= f_s at tau_{j+1}; if this is
//! false because the temperature has changed, the stick that begins there is empty.

use super::columns::Seen;
use super::event_driven::{
    self, Cascade, End, ExactTime, FollowedSlip, Kinematics, Knots, Known, MacroStep, Noiseless,
    ObservationTime, ObservedSegment, Path, PathObserver, PathSegment, PathSegments, Propagation,
    Resolved, ScalarPaths, Scene, SharedObserver, Simulated, StepRules, WithTemperature, WorkLeft,
    check_friction, noise_between, unfelt_noise,
};
use super::{
    Appearance, CheckError, DEFAULT_TOLERANCE, Discretisation, Method, Observer, Parameter,
    Segment, Simulate, Timeline,
};
use crate::model::{Event, EventKind, Oscillator, Phase, Problem, Sign, StepResponse};
use crate::noise::AddressedDraws;
use std::convert::Infallible;

/// The quasi-static scheme with this tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuasiStatic {
    /// Relative error that the discretisation of the exits may leave in the statistics, within
    /// [`super::TOLERANCES`].
    pub tolerance: f64,
}

impl Method for QuasiStatic {
    const NAME: &'static str = "quasi-static";
    const MEANING: &'static str = "the recursion for slow forcing";
    /// One tolerance is enough, because the error is that of the approximation.
    const PARAMETER: Parameter = Parameter::Tolerance {
        grid: &[DEFAULT_TOLERANCE],
    };
    const APPEARANCE: Appearance = Appearance {
        colour: "#CC79A7",
        dash: "2 3",
    };
    type Simulation = QuasiStaticSimulation;

    fn with(tolerance: f64) -> Self {
        QuasiStatic { tolerance }
    }

    fn parameter(self) -> f64 {
        self.tolerance
    }

    fn simulation(self, model: &Problem, timeline: &Timeline) -> QuasiStaticSimulation {
        QuasiStaticSimulation::new(model, timeline, self.tolerance)
    }

    fn discretisation(self) -> Discretisation {
        Discretisation::Approximation
    }

    /// The recursion treats a slip as one swing of the spring, which ends at rest.
    fn check(self, model: &Problem, end: f64) -> Result<(), CheckError> {
        let Oscillator {
            stiffness, damping, ..
        } = model.oscillator;
        let remedy = "choose `scheme.kind = \"event-driven\"`, which follows every slip";
        if model.has_load() {
            let problem = "friction depends on a load or a direction, but the quasi-static recursion needs \
                constant friction";
            return Err(CheckError::new(&[], problem, remedy));
        }
        if let Some(force) = &model.force {
            let problem = format!(
                "`force.expression` = \"{}\" is not supported by the quasi-static recursion, in which the \
                 spring alone drives a slip",
                force.shown()
            );
            return Err(CheckError::new(
                &[("force.expression", f64::NAN)],
                problem,
                remedy,
            ));
        }
        if stiffness == 0.0 {
            let problem =
                "leaves no spring, but the quasi-static recursion needs one to drive slips";
            return Err(CheckError::new(
                &[("oscillator.stiffness", stiffness)],
                problem,
                remedy,
            ));
        }
        if model.initial_velocity != 0.0 {
            let problem = "gives an initial velocity, but in the quasi-static recursion every slip starts from rest";
            return Err(CheckError::new(
                &[("initial.velocity", model.initial_velocity)],
                problem,
                remedy,
            ));
        }
        if damping < 0.0 {
            let problem = "makes oscillations grow, but in the quasi-static recursion every slip ends with \
                its first half-oscillation";
            return Err(CheckError::new(
                &[("oscillator.damping", damping)],
                problem,
                remedy,
            ));
        }
        check_friction(model, end)
    }
}

/// The quasi-static scheme on one model.
#[derive(Clone, Debug)]
pub struct QuasiStaticSimulation {
    model: Problem,
    timeline: Timeline,
    exits: Exits,
}

/// How the ends of stick phases are computed.
#[derive(Clone, Debug)]
enum Exits {
    Noisy(Box<NoisyRecursion>),
    /// Motion with the mean of the noise; its fluctuations are only added to the temperature.
    Noiseless(Box<NoiselessRecursion>),
}

/// The motion of a slip.
#[derive(Clone, Debug)]
struct Swing {
    response: StepResponse,
    knots: Knots,
    /// (1 + q) (f_s - f_d)/K, the distance that a slip from |b| = f_s covers.
    jump: f64,
    /// f_s.
    threshold: f64,
    oscillator: Oscillator,
}

impl Swing {
    /// The excess of |b| over f_s when a slip begins with this event: 0 except in the slip of a
    /// body that starts outside the band, and in its further sub-phases.
    fn excess(&self, event: &Event) -> f64 {
        let is_from_outside = match event.kind {
            EventKind::SlipStarted(_) => event.time == 0.0,
            EventKind::SubPhaseBoundary(_) => true,
            EventKind::StickEntered => false,
        };
        if is_from_outside {
            (event.force.abs() - self.threshold).max(0.0)
        } else {
            0.0
        }
    }

    /// The distance that a slip covers which starts with this excess, with the sign of the
    /// direction.
    fn way(&self, direction: Sign, excess: f64) -> f64 {
        direction.value()
            * (self.jump + (1.0 + self.response.overshoot) * excess / self.oscillator.stiffness)
    }

    /// The motion of a slip that begins at this time and x with this excess, from a time after its
    /// start on, until another or its end.
    fn segments(
        &self,
        began: f64,
        x0: f64,
        direction: Sign,
        excess: f64,
        (from, until): (f64, Option<f64>),
        mut report: impl FnMut(Segment),
    ) -> Resolved<()> {
        let motion = |after: f64| {
            let [displacement, velocity, acceleration] = self.at(0.0, direction, excess, after);
            Kinematics {
                after,
                displacement,
                velocity,
                acceleration,
            }
        };
        // The constant temperature follows from |b| at the start.
        let body = &self.oscillator;
        let pull = direction.value() * (self.threshold + excess) + body.stiffness * x0;
        let temperature = pull / body.force_per_temperature();
        let followed = FollowedSlip {
            start: ExactTime::ZERO.after(began),
            displacement: x0,
            temperature: Some(temperature).filter(|held| held.is_finite()),
        };
        let end = until.unwrap_or(self.response.duration);
        let knots = self.knots.between([from, end]);
        let at = |_, after| Ok(motion(after));
        followed.report(motion(from), knots, at, &mut report)?;
        if until.is_none() && self.response.overshoot == 0.0 {
            // The rest of a swing at critical damping and above, which is covered immediately.
            let rest = Kinematics {
                after: end,
                displacement: self.way(direction, excess),
                velocity: 0.0,
                acceleration: 0.0,
            };
            report(followed.segment(motion(end), rest));
        }
        Ok(())
    }

    /// The event at the end of a swing that began with this excess, where b is `force`: a stick, or
    /// the swing back of a body that swung out of the band.
    fn end(&self, direction: Sign, excess: f64, force: f64) -> EventKind {
        let is_back = excess > 0.0 && force * direction.value() < -self.threshold;
        if is_back {
            EventKind::SubPhaseBoundary(Sign::of(force))
        } else {
            EventKind::StickEntered
        }
    }

    /// x, x' and x'' of a slip that begins at x0 with this excess, a time after its start.
    fn at(&self, x0: f64, direction: Sign, excess: f64, since: f64) -> [f64; 3] {
        let equilibrium = self.way(direction, excess) / (1.0 + self.response.overshoot);
        let [way, mut velocity, acceleration] = self.response.at(equilibrium, since);
        // The body does not turn within the slip; at its ends, rounding decides the sign.
        if velocity * direction.value() < 0.0 {
            velocity = 0.0;
        }
        [x0 + way, velocity, acceleration]
    }
}

impl QuasiStaticSimulation {
    /// The scheme on a model, observed at the stops of a timeline. `tolerance` governs the noisy
    /// exits as in the event-driven scheme.
    pub fn new(model: &Problem, timeline: &Timeline, tolerance: f64) -> Self {
        let Problem {
            oscillator,
            friction,
            ..
        } = model;
        let response = StepResponse::new(oscillator);
        let jump = (1.0 + response.overshoot) * (friction.static_force - friction.dynamic_force)
            / oscillator.stiffness;
        let slip = Swing {
            response,
            knots: Knots::new(oscillator, 0.0),
            jump,
            threshold: friction.static_force,
            oscillator: *oscillator,
        };
        let scene = Scene::new(model);
        let exits = if scene.felt_noise(timeline.end).is_some() {
            Exits::Noisy(Box::new(NoisyRecursion::new(
                scene,
                timeline,
                &StepRules::new(tolerance),
                slip,
            )))
        } else {
            let recursion = NoiselessRecursion {
                exits: Noiseless::new(model, timeline),
                slip,
            };
            Exits::Noiseless(Box::new(recursion))
        };
        QuasiStaticSimulation {
            model: model.clone(),
            timeline: *timeline,
            exits,
        }
    }
}

/// The recursion without noise.
#[derive(Clone, Debug)]
struct NoiselessRecursion {
    /// Finds the exits from sticks.
    exits: Noiseless,
    slip: Swing,
}

/// A phase that begins at this x and, if it is a slip, with this excess of |b|.
type Part = PathSegment<(f64, f64), Infallible>;

impl NoiselessRecursion {
    /// The phase that begins at a time and a place, and the event that ends it.
    fn part(
        &self,
        phase: Phase,
        start: ExactTime,
        (x, excess): (f64, f64),
        work: &mut WorkLeft,
    ) -> Resolved<Part> {
        work.spend()?;
        let end = if let Phase::Slip(direction) = phase {
            let (duration, model) = (self.slip.response.duration, &self.exits.model);
            let (time, displacement) = (
                start.value() + duration,
                x + self.slip.way(direction, excess),
            );
            let force = model.oscillator.force_per_temperature() * model.temperature.mean(time)
                - model.oscillator.stiffness * displacement;
            let kind = self.slip.end(direction, excess, force);
            Some((
                duration,
                End::Event(Event {
                    kind,
                    time,
                    displacement,
                    force,
                }),
            ))
        } else {
            let exit = self.exits.stick_exit(start, x, work)?;
            exit.map(|event| (start.until(event.time), End::Event(event)))
        };
        Ok(Part {
            start,
            phase,
            from: (x, excess),
            end,
        })
    }
}

impl PathSegments for NoiselessRecursion {
    type Motion = (f64, f64);
    type Cut = Infallible;

    fn timeline(&self) -> &Timeline {
        &self.exits.timeline
    }

    fn work_limit(&self) -> u64 {
        self.exits.work_limit
    }

    fn first(&self, work: &mut WorkLeft) -> Resolved<Part> {
        self.part(
            Phase::Static,
            ExactTime::ZERO,
            (self.exits.model.initial_displacement, 0.0),
            work,
        )
    }

    fn next(
        &self,
        _: &Part,
        (_, end): (f64, End<Infallible>),
        work: &mut WorkLeft,
    ) -> Resolved<Part> {
        let End::Event(event) = end;
        let from = (event.displacement, self.slip.excess(&event));
        self.part(
            event.kind.phase(),
            ExactTime::ZERO.after(event.time),
            from,
            work,
        )
    }

    fn state(&self, part: &Part, t: f64, _: &mut WorkLeft) -> Resolved<Seen> {
        let ((x, excess), temperature) = (part.from, self.exits.model.temperature.mean(t));
        Ok(match part.phase {
            Phase::Static => (x, 0.0, temperature, true),
            Phase::Slip(direction) => {
                let [x, v, _] = self.slip.at(x, direction, excess, part.start.until(t));
                (x, v, temperature, false)
            }
        })
    }

    /// The whole slip, so that its segments do not depend on the end of the run.
    fn segments(&self, part: &Part, _: f64, report: impl FnMut(Segment)) -> Resolved<()> {
        if let (Phase::Slip(direction), (x, excess)) = (part.phase, part.from) {
            let whole = (0.0, None);
            self.slip
                .segments(part.start.value(), x, direction, excess, whole, report)?;
        }
        Ok(())
    }
}

/// The recursion under noise, macro step by macro step.
#[derive(Clone, Debug)]
struct NoisyRecursion {
    scene: Scene,
    propagation: Propagation,
    slip: Swing,
}

impl NoisyRecursion {
    fn new(scene: Scene, timeline: &Timeline, rules: &StepRules, slip: Swing) -> Self {
        let rates = scene.harmonics.iter().map(|h| h.angular_frequency);
        let longest = rules.slip_length / rates.fold(scene.noise_rate(), f64::max);
        let propagation = Propagation::new(&scene, timeline, rules, longest, 1);
        NoisyRecursion {
            scene,
            propagation,
            slip,
        }
    }
}

impl Cascade for NoisyRecursion {
    /// The time at which the slip began, and the excess of |b| then. During slip j the displacement
    /// of the path stays x_j.
    type Memory = (f64, f64);
    type Scratch = ();

    fn scene(&self) -> &Scene {
        &self.scene
    }

    fn propagation(&self) -> &Propagation {
        &self.propagation
    }

    fn scratch(&self) {}

    fn slip(
        &self,
        macro_step: &MacroStep,
        path: &mut Path<(f64, f64)>,
        direction: Sign,
        end_noise: f64,
        _: &mut (),
        observer: &mut impl PathObserver,
    ) -> Resolved<Option<Event>> {
        path.work.spend()?;
        let x0 = path.displacement;
        let (began, excess) = (path.motion.0 - macro_step.start, path.motion.1);
        let end = began + self.slip.response.duration;
        let mut piece = SwingSegment {
            slip: &self.slip,
            began,
            displacement: x0,
            excess,
            direction,
            ends: [(path.after, path.noise), (macro_step.length, end_noise)],
        };
        if end < macro_step.length {
            piece.ends[1] = (
                end,
                noise_between(&self.scene, piece.ends, end, &mut path.draws),
            );
        }
        observer.observe(&self.scene, || piece);
        let began_at = path.motion.0;
        if observer.follows() {
            let from = macro_step.start + path.after - began_at;
            let until = (end >= macro_step.length)
                .then_some(macro_step.start + macro_step.length - began_at);
            self.slip
                .segments(began_at, x0, direction, excess, (from, until), |segment| {
                    observer.segment(segment)
                })?;
        }
        (path.after, path.noise) = piece.ends[1];
        if end >= macro_step.length {
            return Ok(None);
        }
        let displacement = x0 + self.slip.way(direction, excess);
        let force = macro_step.forcing(end).value + path.noise
            - self.scene.oscillator.stiffness * displacement;
        Ok(Some(Event {
            kind: self.slip.end(direction, excess, force),
            time: macro_step.start + end,
            displacement,
            force,
        }))
    }

    fn motion_after(&self, event: &Event) -> (f64, f64) {
        (event.time, self.slip.excess(event))
    }

    fn end_state(&self, path: &Path<(f64, f64)>, macro_step: &MacroStep) -> (f64, f64) {
        match path.phase {
            Phase::Static => (path.displacement, 0.0),
            Phase::Slip(direction) => {
                let since = macro_step.start + macro_step.length - path.motion.0;
                let [x, v, _] = self
                    .slip
                    .at(path.displacement, direction, path.motion.1, since);
                (x, v)
            }
        }
    }
}

/// A piece of a slip. The body moves as without noise, and n is a bridge.
#[derive(Clone, Copy)]
struct SwingSegment<'a> {
    slip: &'a Swing,
    /// The time at which the slip began, after the start of the macro step, and x and the excess of
    /// |b| at that time.
    began: f64,
    displacement: f64,
    excess: f64,
    direction: Sign,
    /// The times at which the piece begins and ends, and n there.
    ends: [Known; 2],
}

impl ObservedSegment for SwingSegment<'_> {
    fn end(&self) -> f64 {
        self.ends[1].0
    }

    fn parted(
        &self,
        scene: &Scene,
        instant: ObservationTime,
        draws: &mut AddressedDraws,
    ) -> (Seen, Self, Self) {
        let time = instant.time;
        let noise = noise_between(scene, self.ends, time, draws);
        let [x, v, _] = self.slip.at(
            self.displacement,
            self.direction,
            self.excess,
            time - self.began,
        );
        let seen = (x, v, scene.temperature(instant.forcing, noise), false);
        let ([first, last], here) = (self.ends, (time, noise));
        (
            seen,
            SwingSegment {
                ends: [first, here],
                ..*self
            },
            SwingSegment {
                ends: [here, last],
                ..*self
            },
        )
    }
}

impl Simulate for QuasiStaticSimulation {
    fn model(&self) -> &Problem {
        &self.model
    }

    fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// A path is given up if it exceeds its number of evaluations, or if a value is NaN.
    fn simulate_counting(
        &self,
        seed: u64,
        paths: &[u64],
        observer: &mut dyn Observer,
    ) -> Simulated {
        match &self.exits {
            Exits::Noisy(cascade) => {
                let observer = SharedObserver::new(observer);
                let (is_stopped, follows) = (
                    || observer.borrow().is_stopped(),
                    observer.borrow().follows(),
                );
                let mut all = ScalarPaths::new(cascade.as_ref(), seed, paths, &is_stopped, follows);
                event_driven::simulate(&mut all, paths.len(), &observer)
            }
            Exits::Noiseless(cascade) => cascade.simulate(
                paths.len(),
                &mut WithTemperature::new(observer, unfelt_noise(&self.model, seed, paths)),
            ),
        }
    }

    fn with_work_limit(mut self, limit: u64) -> Self {
        match &mut self.exits {
            Exits::Noisy(cascade) => cascade.propagation.work_limit = limit,
            Exits::Noiseless(cascade) => cascade.exits.work_limit = limit,
        }
        self
    }

    fn with_additional_rows(mut self, row_stride: usize) -> Self {
        if let Exits::Noisy(cascade) = &mut self.exits {
            cascade.propagation.row_stride = row_stride;
        }
        self
    }
}
