//! The schemes with a step are the four lines of the README, on the same draws:
//!
//! ```text
//! X_{n+1} = X_n + h V_n                                    corrected: V_{n+1} for V_n
//! S_n     = V_n + (h/m) b(X_n, V_n, t_n)
//! V_{n+1} = 0                        if |S_n| <= (h/m) f_s   corrected: f_s less the shift at rest
//!         = S_n - (h/m) f_d sign(S_n)                      otherwise
//! ```
//!
//! The loop below has these lines for one path, with products and sums rounded once together, and a
//! branch for every case. T, g and the load are compared with their formulas to rounding wherever
//! the loop uses them; then every bit of x, x' and of the events is that of the loop.

use super::equivalents::keep;
use super::scene::{Scene, ask};
use crate::common::Keep;
use stickslip::engine::Run;
use stickslip::lanes::InstructionSet;
use stickslip::model::{Event, EventKind, Force, HarmonicClock, Problem, Sign};
use stickslip::noise::{LaneStreams, MIRROR, Transition};
use stickslip::scenario::Scenario;
use stickslip::scheme::Kind;
use stickslip::stats::{PassageLevels, Record, Statistic};

/// What is left of the rounding of a formula.
const ROUNDING: f64 = 1e-12;

#[track_caller]
fn assert_near(what: &str, found: f64, wanted: f64) {
    assert!(
        (found - wanted).abs() <= ROUNDING * (1.0 + wanted.abs()),
        "{what}: {found}, not {wanted}"
    );
}

/// A state of the path at t_n: x, x' and v/unit.
#[derive(Clone, Copy, Debug)]
struct State {
    n: u64,
    x: f64,
    v: f64,
    noise: f64,
}

/// The path of the plain loop.
#[derive(Debug, Default)]
struct Path {
    events: Vec<Event>,
    /// t, x, x', T, and whether it is static, at every step.
    rows: Vec<(f64, f64, f64, f64, bool)>,
    /// The works of friction, temperature, damping and g from the burn-in on, and the largest speed.
    works: [f64; 5],
}

struct Loop<'a> {
    scene: &'a Scene,
    model: Problem,
    h: f64,
    /// T without noise at every step.
    temperature: Vec<f64>,
    /// e^{-theta h}, rho unit, and v(0)/unit or the stationary standard deviation in this unit.
    noise: Option<[f64; 3]>,
    is_stationary: bool,
    is_corrected: bool,
}

impl<'a> Loop<'a> {
    fn new(scene: &'a Scene, scenario: &Scenario) -> Self {
        let model = scenario.model.clone();
        let h = scene.step;
        let steps = (scene.end / h).round() as usize;
        let mut temperature = vec![0.0; steps + 1];
        HarmonicClock::of(&model.temperature, h).fill(0, &mut temperature);
        for (n, found) in temperature.iter().enumerate() {
            assert_near("T", *found, scene.temperature(n as f64 * h));
        }
        let [k, alpha] = scene.body();
        assert_near("K", model.oscillator.stiffness, k);
        assert_near("alpha", model.oscillator.damping, alpha);
        assert_near("c", model.oscillator.force_per_temperature(), scene.gain());
        let written = scene.noises.first().copied().or(scene
            .white
            .map(|[strength, theta]| ([(2.0 * strength).sqrt(), theta, theta], None)));
        let noise = written.map(|([rho, theta, sigma], start)| {
            let Transition {
                decay,
                increment_sd,
            } = Transition::new(theta, sigma, h);
            let sd = sigma * ((1.0 - (-2.0 * theta * h).exp()) / (2.0 * theta)).sqrt();
            assert_near("decay", decay, (-theta * h).exp());
            assert_near("increment", increment_sd / sd, 1.0);
            let unit = increment_sd * std::f64::consts::SQRT_2;
            let start = start.unwrap_or(sigma / (2.0 * theta).sqrt());
            [decay, rho * unit, start / unit]
        });
        Loop {
            scene,
            model,
            h,
            temperature,
            noise,
            is_stationary: written.is_some_and(|(_, start)| start.is_none()),
            is_corrected: scene.scheme == Kind::CorrectedVi,
        }
    }

    fn time(&self, n: u64) -> f64 {
        n as f64 * self.h
    }

    /// b without g.
    fn linear(&self, at: &State) -> f64 {
        let o = &self.model.oscillator;
        let c = o.force_per_temperature();
        let mut b = c * self.temperature[at.n as usize];
        if let Some(force) = self.of_time() {
            b += self.of(force, at, self.own(1.0, at));
        }
        if let Some([_, scale, _]) = self.noise {
            b = (c * scale).mul_add(at.noise, b);
        }
        b = (-o.stiffness).mul_add(at.x, b);
        (-2.0 * o.damping).mul_add(at.v, b)
    }

    /// g, if it is a function of t alone, which is a part of the forcing.
    fn of_time(&self) -> Option<&Force> {
        self.model
            .force
            .as_ref()
            .filter(|force| force.is_of_time_alone())
    }

    /// A force of the program, which must be `wanted` to rounding.
    fn of(&self, force: &Force, at: &State, wanted: f64) -> f64 {
        let found = force.at(InstructionSet::detect(), at.x, at.v, self.time(at.n));
        assert_near("a force", found, wanted);
        found
    }

    /// g in a direction.
    fn own(&self, e: f64, at: &State) -> f64 {
        self.scene.own(e, at.x, at.v, self.time(at.n))
    }

    /// f_s L and f_d L in a direction.
    fn friction(&self, e: f64, at: &State) -> [f64; 2] {
        let side = self.scene.friction[usize::from(e < 0.0)];
        side.map(|force| force * self.scene.load(e, at.x, at.v, self.time(at.n)))
    }

    /// What is added to b where it is compared with f_s upwards and with -f_s downwards, and what
    /// is added to b in a slip upwards and downwards. With a load or a direction this is g, less
    /// what friction exceeds its constant by.
    fn forces(&self, at: &State) -> [[f64; 2]; 2] {
        let force = self.model.force.as_ref();
        let Some(force) = force.filter(|force| !force.is_of_time_alone()) else {
            return [[0.0; 2]; 2];
        };
        let constant = self.model.friction;
        let signs = [(Sign::Positive, 1.0), (Sign::Negative, -1.0)];
        let stick = [0, 1].map(|i| {
            let e = signs[i].1;
            let wanted = self.own(e, at) - e * (self.friction(e, at)[0] - constant.static_force);
            self.of(force.in_stick()[i], at, wanted)
        });
        let slip = signs.map(|(sign, e)| {
            let wanted = self.own(e, at) - e * (self.friction(e, at)[1] - constant.dynamic_force);
            self.of(force.in_slip(sign), at, wanted)
        });
        [stick, slip]
    }

    /// b as an event reports it: at rest, the mean of both directions.
    fn force(&self, at: &State) -> f64 {
        let force = self.model.force.as_ref();
        let own = force
            .filter(|force| !force.is_of_time_alone())
            .map(|force| {
                let [up, down] = [1.0, -1.0].map(|e| self.own(e, at));
                let wanted = match at.v {
                    v if v > 0.0 => up,
                    v if v < 0.0 => down,
                    _ => 0.5 * (up + down),
                };
                self.of(force, at, wanted)
            });
        own.map_or(self.linear(at), |own| self.linear(at) + own)
    }

    /// The force at which a body at rest is let go by the scheme.
    fn exit(&self) -> f64 {
        let friction = self.model.friction;
        if !self.is_corrected {
            return friction.static_force;
        }
        let shift = self.model.temperature.noises.first().map_or(0.0, |noise| {
            0.582_597_157_939_010_7
                * self.model.oscillator.force_per_temperature().abs()
                * (noise.intensity * noise.diffusion)
                * self.h.sqrt()
        });
        (friction.static_force - shift).max(friction.dynamic_force)
    }

    /// The direction in which friction up to a limit lets a body at rest go.
    fn let_go(&self, at: &State, limit: f64) -> Option<Sign> {
        let at = State { v: 0.0, ..*at };
        let h_over_m = self.h / self.model.oscillator.mass;
        let b = self.linear(&at);
        let [[up, down], _] = self.forces(&at);
        if h_over_m * (b + down) < -(h_over_m * limit) {
            Some(Sign::Negative)
        } else {
            (h_over_m * (b + up) > h_over_m * limit).then_some(Sign::Positive)
        }
    }

    /// The four lines.
    fn step(&self, at: &State, chi: f64) -> State {
        let friction = self.model.friction;
        let h_over_m = self.h / self.model.oscillator.mass;
        let b = self.linear(at);
        let [stick, slip] = self.forces(at);
        let [s_up, s_down] = stick.map(|g| h_over_m.mul_add(b + g, at.v));
        let limit = h_over_m
            * if at.v == 0.0 {
                self.exit()
            } else {
                friction.static_force
            };
        let brake = h_over_m * friction.dynamic_force;
        let up = h_over_m.mul_add(b + slip[0], at.v) - brake;
        let down = h_over_m.mul_add(b + slip[1], at.v) + brake;
        // With a load, the corrected scheme may let go a body that friction would still brake.
        let has_sides = self.model.has_load();
        let v = if s_up > limit && (up > 0.0 || !has_sides) {
            up
        } else if s_down < -limit && (down < 0.0 || !has_sides) {
            down
        } else {
            0.0
        };
        State {
            n: at.n + 1,
            x: self
                .h
                .mul_add(if self.is_corrected { v } else { at.v }, at.x),
            v,
            noise: self
                .noise
                .map_or(0.0, |[decay, ..]| decay.mul_add(at.noise, chi)),
        }
    }

    /// Takes a path through all steps, and reads its events.
    fn run(&self, drawn: u64) -> Path {
        let mut streams = LaneStreams::new(self.scene.seed, &[drawn], 1);
        let stationary = if self.is_stationary {
            streams.normals(1, InstructionSet::Portable)[0]
        } else {
            1.0
        };
        let mut normals = streams.take::<f64, 1>(0);
        let mut at = State {
            n: 0,
            x: self.scene.x0,
            v: self.scene.v0,
            noise: self.noise.map_or(0.0, |[.., start]| start * stationary),
        };
        let mut path = Path::default();
        path.works[4] = at.v.abs();
        let f_s = self.model.friction.static_force;
        let start = if at.v == 0.0 {
            self.let_go(&at, f_s)
        } else {
            Some(Sign::of(at.v))
        };
        if let Some(sign) = start {
            path.events
                .push(self.event(EventKind::SlipStarted(sign), &at));
        }
        let mut is_static = start.is_none();
        for _ in 1..self.temperature.len() {
            let chi = if self.noise.is_some() {
                normals.draw()[0]
            } else {
                0.0
            };
            let next = self.step(&at, chi);
            self.push_row(&mut path, &at, is_static && next.v == 0.0);
            self.work(&mut path.works, &at, &next);
            if is_static {
                if next.v != 0.0 {
                    is_static = false;
                    path.events
                        .push(self.event(EventKind::SlipStarted(Sign::of(next.v)), &at));
                }
            } else if next.v == 0.0 {
                let kind = self
                    .let_go(&next, f_s)
                    .map_or(EventKind::StickEntered, EventKind::SubPhaseBoundary);
                is_static = kind == EventKind::StickEntered;
                path.events.push(self.event(kind, &next));
            } else if at.v * next.v < 0.0 {
                path.events
                    .push(self.event(EventKind::SubPhaseBoundary(Sign::of(next.v)), &next));
            }
            at = next;
        }
        let is_held = self.step(&at, 0.0).v == 0.0;
        self.push_row(&mut path, &at, is_static && is_held);
        path
    }

    fn event(&self, kind: EventKind, at: &State) -> Event {
        let (time, displacement, force) = (self.time(at.n), at.x, self.force(at));
        Event {
            kind,
            time,
            displacement,
            force,
        }
    }

    fn temperature(&self, at: &State) -> f64 {
        let noise = self.noise.map_or(0.0, |[_, scale, _]| scale * at.noise);
        self.temperature[at.n as usize] + noise
    }

    fn push_row(&self, path: &mut Path, at: &State, is_static: bool) {
        path.rows
            .push((self.time(at.n), at.x, at.v, self.temperature(at), is_static));
    }

    /// The forces at the start of the step times its way. The body moves in the direction of the
    /// way.
    fn work(&self, works: &mut [f64; 5], at: &State, next: &State) {
        works[4] = works[4].max(at.v.abs());
        let way = next.x - at.x;
        if at.n < (self.scene.after / self.h).round() as u64 || way == 0.0 {
            return;
        }
        let e = way.signum();
        let o = &self.model.oscillator;
        works[0] += self.friction(e, at)[1] * way.abs();
        works[1] += o.force_per_temperature() * self.temperature(at) * way;
        works[2] += 2.0 * o.damping * at.v * way;
        works[3] += self.own(e, at) * way;
    }
}

/// Every bit of every path is that of the plain loop, with every kind of temperature, force, load
/// and input, and of both paths of a pair; so are the works of a path, to rounding. What is left of
/// the energy balance is the energy that the steps create.
#[test]
fn every_step_is_that_of_the_plain_loop() {
    ask(|scene| {
        for scheme in [Kind::DiscreteVi, Kind::CorrectedVi] {
            let scene = scene.in_scheme(scheme).expect("suits");
            let scenario = scene.scenario();
            let plain = Loop::new(&scene, &scenario);
            let every = 7;
            let paths = [0, 1, 5, MIRROR, 5 | MIRROR];
            let kept: Keep = keep(&scene, &paths, every as f64 * scene.step);
            for (lane, path) in paths.iter().enumerate() {
                let wanted = plain.run(*path);
                assert_eq!(
                    kept.events[lane], wanted.events,
                    "{}, path {path}",
                    scene.name
                );
                let rows: Vec<_> = wanted.rows.iter().copied().step_by(every).collect();
                assert_eq!(kept.rows[lane], rows, "{}, path {path}", scene.name);
            }
            assert_works(&scene, scenario, &plain.run(0));
        }
    });
}

fn assert_works(scene: &Scene, mut scenario: Scenario, path: &Path) {
    (scenario.ensemble.paths, scenario.ensemble.antithetic) = (1, false);
    scenario.record = Record {
        energy: true,
        levels: PassageLevels::of(&[1.0]),
        ..Record::NOTHING
    };
    let run = Run::of(&scenario).threads(1).without_bias();
    let summary = run.simulate().expect("no sink fails").summary;
    let value = |statistic| summary.estimate(statistic).estimate;
    let names = [
        Statistic::FrictionWorkMean,
        Statistic::TemperatureWorkMean,
        Statistic::DampingWorkMean,
        Statistic::UserForceWorkMean,
        Statistic::LargestSpeedMean,
    ];
    let first = (scene.after / scene.step).round() as usize;
    let mut works = path.works;
    if !scenario.model.has_load() {
        // Without a load, the way is that from event to event. A turn of the corrected scheme is one
        // step late, when the body has come back a little.
        let later = path
            .events
            .iter()
            .filter(|event| event.time > path.rows[first].0);
        let mut places = vec![path.rows[first].1];
        places.extend(later.map(|event| event.displacement));
        places.extend(path.rows.last().map(|row| row.1));
        let ways = places.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        works[0] = scene.friction[0][1] * ways.sum::<f64>();
    }
    let scale: f64 = works.iter().map(|work| work.abs()).sum();
    for (statistic, wanted) in names.into_iter().zip(works) {
        let off = value(statistic) - wanted;
        assert!(
            off.abs() <= 1e-11 * scale,
            "{}: {} is {}, not {wanted}",
            scene.name,
            statistic.name(),
            value(statistic)
        );
    }
    let o = &scenario.model.oscillator;
    let energy = |row: &(f64, f64, f64, f64, bool)| {
        0.5 * (o.mass * row.2 * row.2 + o.stiffness * row.1 * row.1)
    };
    let gained = energy(path.rows.last().expect("rows")) - energy(&path.rows[first]);
    let [friction, temperature, damping, own, _] = works;
    let left = temperature + own - damping - friction - gained;
    assert!(
        (value(Statistic::EnergyResidualMean) - left).abs() <= 1e-11 * scale,
        "{}",
        scene.name
    );
}
