//! Scheme C: quasi-static, the paper's approximation for slow forcing (its section on the bridge).
//!
//! While the body slips the temperature is taken to stand still. Then each dynamic phase is one half-cycle about the
//! equilibrium at its start, and the cascade is a recursion:
//!
//! ```text
//! tau_{j+1/2} = inf{t > tau_j : |b(x_j, t)| > f_s},    tau_{j+1} = tau_{j+1/2} + pi/w0,
//! x_{j+1} = x_j + 2 eps_j (f_s - f_d)/K,               eps_j = sign b(x_j, tau_{j+1/2})
//! ```
//!
//! with b = K (beta T - x). (The paper prints the integrals of this section from tau_j; they start at tau_{j+1/2}.) Damping does
//! not enter. With f_s = f_d the body never moves and only the times do. In between, for whoever looks,
//! x(t) = x_j + eps (f_s - f_d)/K (1 - cos w0 (t - tau_{j+1/2})). Exits are those of the event-driven scheme: first roots
//! without noise, bridge crossings with it. Nothing in the recursion asks whether |b| <= f_s at tau_{j+1}; where it is not, the
//! stick there is empty.

use super::columns::Columns;
use super::event_driven::{
    ExactTime, Noiseless, Scene, StepRules, StickOutcome, StickState, StickSteps, UnfeltNoise, WORK_LIMIT, Work,
    check_friction, forcing,
};
use super::{DEFAULT_TOLERANCE, Discretisation, Look, Method, Misfit, Observer, Parameter, Simulate, Timeline};
use crate::model::{Complex, Event, EventKind, Model, Phase, Sign};
use crate::noise::Stream;

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
    /// One is enough: what it is off by is the approximation.
    const PARAMETER: Parameter = Parameter::Tolerance { ladder: &[DEFAULT_TOLERANCE] };
    const LOOK: Look = Look { colour: "#CC79A7", dash: "2 3" };
    type Simulation = QuasiStaticSimulation;

    fn with(tolerance: f64) -> Self {
        QuasiStatic { tolerance }
    }

    fn parameter(self) -> f64 {
        self.tolerance
    }

    fn simulation(self, model: &Model, timeline: &Timeline) -> QuasiStaticSimulation {
        QuasiStaticSimulation::new(model, timeline, self.tolerance)
    }

    fn discretisation(self) -> Discretisation {
        Discretisation::Approximation
    }

    fn check(self, model: &Model, end: f64) -> Result<(), Misfit> {
        check_friction(model, end)
    }
}

/// The quasi-static scheme on one model.
#[derive(Clone, Debug)]
pub struct QuasiStaticSimulation {
    model: Model,
    scene: Scene,
    timeline: Timeline,
    exits: Exits,
    /// What a path may spend.
    work_limit: u64,
    /// pi / w0.
    slip_duration: f64,
    /// 2 (f_s - f_d)/K: what a slip moves.
    jump: f64,
}

/// How stick phases end.
#[derive(Clone, Debug)]
enum Exits {
    Noisy(StickSteps),
    /// The noise of the scene is its mean; what fluctuates is left to the observer.
    Noiseless(Box<Noiseless>, UnfeltNoise),
}

/// Where one path is.
#[derive(Clone, Debug)]
struct Path {
    /// How far the noise has been simulated.
    time: f64,
    phase: Phase,
    /// tau_{j+1/2} and x_j of the dynamic phase, or tau_j and x_j of the static one.
    since: f64,
    displacement: f64,
    noise: f64,
    draws: Stream,
    /// The exit of the static phase, where it is known in advance: without noise. None before it has been looked for.
    exit: Option<Option<Event>>,
    work: Work,
    failed: bool,
}

impl QuasiStaticSimulation {
    /// For a scene, observed at the stops of a timeline; `tolerance` governs the noisy exits as in the event-driven scheme.
    pub fn new(model: &Model, timeline: &Timeline, tolerance: f64) -> Self {
        let mut scene = Scene::new(model);
        let exits = if scene.felt_noise(timeline.end).is_some() {
            Exits::Noisy(StickSteps::new(&scene, StepRules::new(tolerance).chord_error, timeline.end))
        } else {
            (scene.diffusion, scene.initial_noise.1) = (0.0, 0.0);
            Exits::Noiseless(Box::new(Noiseless::new(model, timeline)), UnfeltNoise::new(model))
        };
        let friction = model.friction;
        QuasiStaticSimulation {
            model: model.clone(),
            scene,
            timeline: *timeline,
            exits,
            work_limit: WORK_LIMIT,
            slip_duration: std::f64::consts::PI / model.oscillator.natural_frequency(),
            jump: 2.0 * (friction.static_force - friction.dynamic_force) / model.oscillator.stiffness,
        }
    }

    fn drive<O: Observer>(&self, seed: u64, paths: &[u64], observer: &mut O) -> Vec<usize> {
        let harmonics = self.scene.harmonics.len();
        let mut lanes: Vec<Path> = paths.iter().map(|&path| self.start(seed, path)).collect();
        let mut terms = vec![Complex::ZERO; harmonics];
        let mut columns = Columns::new(paths.len());
        for stop in self.timeline.stops() {
            for (lane, path) in lanes.iter_mut().enumerate() {
                self.advance(path, &mut terms, stop.time, |event| observer.event(lane, event));
                self.scene.set_terms(stop.time, &mut terms);
                let (x, v) = self.position(path, stop.time);
                let temperature = match &self.exits {
                    Exits::Noisy(_) => (forcing(&terms) + path.noise) / self.scene.force_per_temperature,
                    Exits::Noiseless(cascade, _) => cascade.mean_temperature(stop.time),
                };
                columns.set(lane, (x, v, temperature, path.phase == Phase::Static));
            }
            observer.snapshot(stop.instant, columns.snapshot(stop.time));
        }
        lanes.iter().enumerate().filter(|(_, path)| path.failed).map(|(lane, _)| lane).collect()
    }

    fn start(&self, seed: u64, path: u64) -> Path {
        let mut draws = Stream::new(seed, path);
        let noise = self.scene.draw_initial_noise(&mut draws);
        Path {
            time: 0.0,
            phase: Phase::Static,
            since: 0.0,
            displacement: self.scene.initial_displacement,
            noise,
            draws,
            exit: None,
            work: Work::new(self.work_limit),
            failed: false,
        }
    }

    /// Follow a path, phase by phase, to a time.
    fn advance(&self, path: &mut Path, terms: &mut [Complex], until: f64, mut emit: impl FnMut(Event)) {
        while !path.failed {
            let event = match path.phase {
                Phase::Static => self.stick_until(path, terms, until),
                Phase::Slip(direction) => self.slip_until(path, terms, direction, until),
            };
            let Some(event) = event else { break };
            path.failed |= path.work.spend().is_err();
            emit(event);
            (path.since, path.displacement, path.exit) = (event.time, event.displacement, None);
            path.phase = match event.kind {
                EventKind::StickEntered => Phase::Static,
                EventKind::SlipStarted(sign) | EventKind::SubPhaseBoundary(sign) => Phase::Slip(sign),
            };
        }
        if path.failed {
            (path.displacement, path.noise) = (f64::NAN, f64::NAN);
        }
    }

    fn stick_until(&self, path: &mut Path, terms: &mut [Complex], until: f64) -> Option<Event> {
        let spring_force = self.scene.oscillator.stiffness * path.displacement;
        self.scene.set_terms(path.time, terms);
        match &self.exits {
            Exits::Noisy(steps) => {
                let mut state = StickState { time: path.time, spring_force, noise: path.noise, terms };
                let outcome = steps.advance(&self.scene, &mut state, until, &mut path.draws, &mut path.work);
                (path.time, path.noise) = (state.time, state.noise);
                match outcome {
                    StickOutcome::Exit(force) => {
                        let kind = EventKind::SlipStarted(Sign::of(force));
                        Some(Event { kind, time: path.time, displacement: path.displacement, force })
                    }
                    StickOutcome::Stays => None,
                    StickOutcome::Unresolved => {
                        path.failed = true;
                        None
                    }
                }
            }
            Exits::Noiseless(cascade, _) => {
                let exit = match path.exit {
                    Some(exit) => exit,
                    None => {
                        match cascade.stick_exit(ExactTime::ZERO.after(path.since), path.displacement, &mut path.work) {
                            Ok(exit) => *path.exit.insert(exit),
                            Err(_) => {
                                path.failed = true;
                                None
                            }
                        }
                    }
                };
                let reached = exit.filter(|event| event.time <= until);
                self.let_noise_pass(path, reached.map_or(until, |event| event.time));
                reached
            }
        }
    }

    fn slip_until(&self, path: &mut Path, terms: &mut [Complex], direction: Sign, until: f64) -> Option<Event> {
        let end = path.since + self.slip_duration;
        self.let_noise_pass(path, end.min(until));
        if end > until {
            return None;
        }
        self.scene.set_terms(end, terms);
        let displacement = path.displacement + direction.value() * self.jump;
        let force = forcing(terms) + path.noise - self.scene.oscillator.stiffness * displacement;
        Some(Event { kind: EventKind::StickEntered, time: end, displacement, force })
    }

    /// The exact transition of the noise to a later time.
    fn let_noise_pass(&self, path: &mut Path, until: f64) {
        self.scene.let_noise_pass(&mut path.noise, until - path.time, &mut path.draws);
        path.time = until;
    }

    /// x and x'.
    fn position(&self, path: &Path, t: f64) -> (f64, f64) {
        match path.phase {
            Phase::Static => (path.displacement, 0.0),
            Phase::Slip(direction) => {
                let w0 = self.scene.oscillator.natural_frequency();
                let (sin, cos) = libm::sincos(w0 * (t - path.since));
                let swing = 0.5 * direction.value() * self.jump;
                (path.displacement + swing * (1.0 - cos), swing * w0 * sin)
            }
        }
    }
}

impl Simulate for QuasiStaticSimulation {
    fn model(&self) -> &Model {
        &self.model
    }

    fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// A path is lost where it spends all its work, or meets a value that is not a number.
    fn simulate<O: Observer>(&self, seed: u64, paths: &[u64], observer: &mut O) -> Vec<usize> {
        match &self.exits {
            Exits::Noisy(_) => self.drive(seed, paths, observer),
            Exits::Noiseless(_, noise) => self.drive(seed, paths, &mut noise.added_before(observer, seed, paths)),
        }
    }

    fn with_work_limit(self, limit: u64) -> Self {
        QuasiStaticSimulation { work_limit: limit, ..self }
    }
}
