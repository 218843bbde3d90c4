//! Scheme C: quasi-static, the paper's approximation for slow forcing (its section on the bridge), with
//! damping.
//!
//! While the body slips the temperature is taken to stand still. At the exit |b| = f_s, so the body
//! starts from rest towards an equilibrium that is (f_s - f_d)/K away, and swings beyond it until it
//! is at rest again ([`StepResponse`]). The cascade is then a recursion:
//!
//! ```text
//! tau_{j+1/2} = inf{t > tau_j : |b(x_j, t)| > f_s},      tau_{j+1} = tau_{j+1/2} + pi/w_d,
//! x_{j+1} = x_j + (1 + q) eps_j (f_s - f_d)/K,           eps_j = sign b(x_j, tau_{j+1/2})
//! q = e^{-pi zeta/sqrt(1 - zeta^2)},   zeta = alpha/(m w0),   w_d = w0 sqrt(1 - zeta^2)
//! ```
//!
//! with b = K (beta T - x) at rest. The paper has zeta = 0, where the half-cycle lasts pi/w0 and moves
//! 2 (f_s - f_d)/K. (It prints the integrals of this section from tau_j; they start at tau_{j+1/2}.)
//! In between, for whoever looks, x(t) and x'(t) are those of the swing. With f_s = f_d the body never
//! moves and only the times do.
//!
//! **At critical damping and above** (zeta >= 1) the swing has no overshoot, q = 0, and no end: the
//! slip is taken to last the settling time, until a thousandth of the way is left, and to have made
//! all of the way. A slip must end, or the recursion would stop at the first one; any end at which
//! nearly all of the way is made gives the same sticks and jumps where the forcing is slow, for which
//! alone the recursion is meant. The settling time is also about how long such a slip does last: what
//! ends it is noise, once it moves x' more than the rest of the swing does (docs/event-driven.md).
//!
//! **Where it is not the limit of slow forcing.** A forcing that moves the equilibrium faster than the
//! body would swing back, K |beta| |T'| > (f_s - f_d) w0 [`StepResponse::return_speed`], leaves x' no
//! zero: the body creeps behind the temperature until that turns. Without noise every forcing does so
//! for zeta >= 1, however slow, and close below 1 all but the slowest.
//!
//! Exits are those of the event-driven scheme: first roots without noise, bridge crossings with it.
//! Nothing in the recursion asks whether |b| <= f_s at tau_{j+1}; where it is not, the stick there is
//! empty.

use super::event_driven::{
    self, Cascade, ExactTime, Noiseless, Scene, StepRules, StickSteps, UnfeltNoise, Unresolved, WORK_LIMIT,
    check_friction, forcing,
};
use super::{DEFAULT_TOLERANCE, Discretisation, Look, Method, Misfit, Observer, Parameter, Simulate, Timeline};
use crate::model::{Complex, Event, EventKind, Model, Phase, Sign, StepResponse};

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
    /// What a slip is.
    swing: StepResponse,
    /// (1 + q) (f_s - f_d)/K: how far it moves.
    jump: f64,
}

/// How stick phases end.
#[derive(Clone, Debug)]
enum Exits {
    Noisy(StickSteps),
    /// The noise of the scene is its mean; what fluctuates is left to the observer.
    Noiseless(Box<Noiseless>, UnfeltNoise),
}

/// Where one path is: its displacement is x_j, in the dynamic phase too.
type Path = event_driven::Path<Since>;

/// The phase of a path.
#[derive(Clone, Copy, Debug, Default)]
pub struct Since {
    /// tau_j or tau_{j+1/2}: when it began.
    time: f64,
    /// Without noise: the exit of a static phase, once it has been looked for.
    exit: Option<Option<Event>>,
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
        let Model { oscillator, friction, .. } = model;
        let swing = StepResponse::new(oscillator);
        let jump = (1.0 + swing.overshoot) * (friction.static_force - friction.dynamic_force) / oscillator.stiffness;
        let (model, timeline) = (model.clone(), *timeline);
        QuasiStaticSimulation { model, scene, timeline, exits, work_limit: WORK_LIMIT, swing, jump }
    }

    /// Without noise: the exit of the static phase, if the path comes to it by then.
    fn exit_until(&self, cascade: &Noiseless, path: &mut Path, until: f64) -> Result<Option<Event>, Unresolved> {
        let exit = match path.motion.exit {
            Some(exit) => exit,
            None => {
                let since = ExactTime::ZERO.after(path.motion.time);
                *path.motion.exit.insert(cascade.stick_exit(since, path.displacement, &mut path.work)?)
            }
        };
        let exit = exit.filter(|event| event.time <= until);
        self.let_noise_pass(path, exit.map_or(until, |event| event.time));
        Ok(exit)
    }

    /// The exact transition of the noise to a later time.
    fn let_noise_pass(&self, path: &mut Path, until: f64) {
        self.scene.let_noise_pass(&mut path.noise, until - path.time, &mut path.draws);
        path.time = until;
    }
}

impl Cascade for QuasiStaticSimulation {
    type Motion = Since;
    type Scratch = ();

    fn scene(&self) -> &Scene {
        &self.scene
    }

    fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    fn work_limit(&self) -> u64 {
        self.work_limit
    }

    fn scratch(&self) {}

    fn stick_until(&self, path: &mut Path, terms: &mut [Complex], until: f64) -> Result<Option<Event>, Unresolved> {
        self.scene.set_terms(path.time, terms);
        let exit = match &self.exits {
            Exits::Noisy(steps) => steps.advance_path(&self.scene, path, terms, until)?,
            Exits::Noiseless(cascade, _) => self.exit_until(cascade, path, until)?,
        };
        if exit.is_some() {
            path.work.spend()?;
        }
        Ok(exit)
    }

    fn slip_until(
        &self,
        path: &mut Path,
        terms: &mut [Complex],
        direction: Sign,
        until: f64,
        _: &mut (),
    ) -> Result<Option<Event>, Unresolved> {
        let end = path.motion.time + self.swing.duration;
        self.let_noise_pass(path, end.min(until));
        if end > until {
            return Ok(None);
        }
        path.work.spend()?;
        self.scene.set_terms(end, terms);
        let displacement = path.displacement + direction.value() * self.jump;
        let force = forcing(terms) + path.noise - self.scene.oscillator.stiffness * displacement;
        Ok(Some(Event { kind: EventKind::StickEntered, time: end, displacement, force }))
    }

    fn motion_after(&self, event: &Event) -> Since {
        Since { time: event.time, exit: None }
    }

    fn look(&self, path: &Path, terms: &mut [Complex], time: f64) -> (f64, f64, f64) {
        let temperature = match &self.exits {
            Exits::Noisy(_) => {
                self.scene.set_terms(time, terms);
                self.scene.temperature(terms, path.noise)
            }
            Exits::Noiseless(cascade, _) => cascade.mean_temperature(time),
        };
        let (x, v) = match path.phase {
            Phase::Static => (path.displacement, 0.0),
            Phase::Slip(direction) => {
                let equilibrium = direction.value() * self.jump / (1.0 + self.swing.overshoot);
                let (way, velocity) = self.swing.at(equilibrium, time - path.motion.time);
                (path.displacement + way, velocity)
            }
        };
        (x, v, temperature)
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
            Exits::Noisy(_) => event_driven::simulate(self, seed, paths, observer).lost,
            Exits::Noiseless(_, noise) => {
                event_driven::simulate(self, seed, paths, &mut noise.added_before(observer, seed, paths)).lost
            }
        }
    }

    fn with_work_limit(self, limit: u64) -> Self {
        QuasiStaticSimulation { work_limit: limit, ..self }
    }
}
