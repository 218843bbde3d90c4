//! Invariants of every path of every scheme, checked by an observer that sees only events and
//! snapshots. Each is given with its tolerance:
//!
//! - events are in time order within [0, t_end], and none is before the last snapshot: exactly
//! - a slip follows only a stick; a turn or a stick follows only a slip: exactly
//! - |b| <= f_s where a stick is entered (not quasi-static, whose recursion does not require it): 4
//!   roundings of f_s
//! - |b| >= f_s where a stick ends, in the direction of the slip (corrected: f_s less its shift,
//!   but at least f_d): rounding of b
//! - |b| > f_s where a sub-phase begins, in its direction (event-driven): exactly
//! - |K (beta T - x)| <= f_s in every static snapshot (event-driven): rounding of b, of each
//!   harmonic and its phase w t, and of x as a sum of ways
//! - x does not change in a stick: exactly
//! - a step of the discrete schemes comes to rest where a friction of at most f_s suffices for it,
//!   and nowhere else: 16 roundings of its forces
//! - x' and every displacement in a sub-phase have its sign: rounding, and 1e-9 of the greatest
//!   velocity; a turn of the corrected scheme is one step late
//! - energy: a step of the discrete schemes balances with its own O(h^2) surplus: 1e-12 of its
//!   terms
//! - T changes between two instants (event-driven) by at most what its harmonics, to the rounding
//!   of t, and twelve standard deviations of its noise allow
//! - energy of the event-driven scheme: T between two instants is known up to its possible change;
//!   the balance holds up to this change times the way, and 1e-12 of its terms
//! - quasi-static: a slip lasts pi/w_d and moves (1 + e^{-pi zeta/sqrt(1 - zeta^2)}) (f_s - f_d)/K:
//!   rounding
//! - quasi-static with zeta >= 1: a slip lasts until 1e-3 of the way (f_s - f_d)/K is left:
//!   rounding, 1e-6
//! - stick time + slip time = t_end: 2 roundings of t_end for each event
//! - discrete schemes have the same events for any output grid (in the survey itself): exactly

use stickslip::lanes::InstructionSet;
use stickslip::model::{Event, EventKind, InitialNoise, Oscillator, Problem, Sign};
use stickslip::scenario::Scenario;
use stickslip::scheme::{Instant, Kind, Observer, Snapshot, monitoring_shift};

const ULP: f64 = f64::EPSILON;

/// Rounding errors that are allowed where a slip ends, relative to the greatest forces so far: the
/// state is moved onto the exact motion there, where b is the sum of some dozens of terms of that
/// size.
const STOP_REST: f64 = 1e-14;

/// Rounding errors that are allowed in an energy between two instants, relative to its terms.
const ROUNDING: f64 = 1e-12;

/// Checks the invariants on the paths of one scenario.
pub struct Watch {
    model: Problem,
    scheme: Kind,
    end: f64,
    step: f64,
    /// f_s, as it is simulated.
    static_force: f64,
    /// The least |b| at which a stick may end.
    exit_force: f64,
    pub lanes: Vec<Lane>,
    /// The events of each lane.
    pub events: Vec<Vec<Event>>,
}

/// The state of the checks on one path, and the first violation that was found.
#[derive(Clone, Debug)]
pub struct Lane {
    pub complaint: Option<String>,
    /// The direction of the current sub-phase; none while static.
    direction: Option<Sign>,
    /// The time at which the present phase began.
    since: f64,
    /// x at the last event.
    origin: f64,
    /// |b| from which the recursion swings: f_s, but for a body that starts outside the band.
    pull: f64,
    /// The rounding error of x as a sum of ways: one rounding at both ends of each way.
    spread: f64,
    /// The greatest forces so far.
    peak: f64,
    looked: f64,
    last: Option<State>,
    pub stick_time: f64,
    pub slip_time: f64,
    pub travel: f64,
    pub ended_sticks: u32,
    pub slips: u32,
    pub sub_phases: u32,
    running: u32,
    events: u32,
    fastest: f64,
    pub energy: Energy,
}

/// The state at an instant: t, x, x' and g = K beta T, with a force of the user's own.
#[derive(Clone, Copy, Debug)]
struct State {
    t: f64,
    x: f64,
    v: f64,
    g: f64,
    /// The sizes of the terms of g.
    size: f64,
}

/// The mismatch of an energy balance, and how large it may be.
#[derive(Clone, Copy, Debug, Default)]
pub struct Energy {
    pub mismatch: f64,
    pub allowed: f64,
}

impl Watch {
    pub fn new(scenario: &Scenario) -> Self {
        let (model, scheme) = (scenario.model.clone(), scenario.scheme.kind());
        let step = scenario.scheme.step().unwrap_or(scenario.time.output_step);
        let static_force = scenario
            .resolution()
            .map_or(model.friction.static_force, |r| r.static_force);
        let shift = if scheme == Kind::CorrectedVi {
            monitoring_shift(&model, step)
        } else {
            0.0
        };
        let exit_force = (static_force - shift).max(model.friction.dynamic_force);
        let lane = Lane {
            complaint: None,
            direction: None,
            since: 0.0,
            origin: model.initial_displacement,
            pull: static_force,
            spread: 0.0,
            peak: 0.0,
            looked: 0.0,
            last: None,
            stick_time: 0.0,
            slip_time: 0.0,
            travel: 0.0,
            ended_sticks: 0,
            slips: 0,
            sub_phases: 0,
            running: 0,
            events: 0,
            fastest: 0.0,
            energy: Energy::default(),
        };
        let lanes = vec![lane; scenario.ensemble.paths as usize];
        let events = vec![Vec::new(); lanes.len()];
        Watch {
            end: scenario.time.end,
            step,
            static_force,
            exit_force,
            model,
            scheme,
            lanes,
            events,
        }
    }

    fn is_event_driven(&self) -> bool {
        self.scheme == Kind::EventDriven
    }

    /// The rounding error of b at a time: of its terms, of each harmonic and its phase w t, and of
    /// x as a sum of ways.
    fn rounding(&self, lane: &Lane, t: f64, x: f64, force: f64) -> f64 {
        let (stiffness, gain) = (
            self.model.oscillator.stiffness,
            self.model.oscillator.force_per_temperature(),
        );
        let phase = (self.model.temperature.harmonics.iter())
            .map(|h| (gain * h.amplitude).abs() * (ULP * (1.0 + h.angular_frequency * t)).min(1.0))
            .sum::<f64>();
        16.0 * (ULP * (force.abs() + 2.0 * (stiffness * x).abs()) + phase + stiffness * lane.spread)
    }

    fn check_event(&self, lane: &mut Lane, event: &Event) -> Result<(), String> {
        let Event {
            kind,
            time,
            displacement: x,
            force,
        } = *event;
        let model = &self.model;
        ensure(
            time.is_finite() && x.is_finite() && force.is_finite(),
            || "not a number".into(),
        )?;
        ensure(
            time >= lane.since && time >= lane.looked && time <= self.end,
            || "out of time order".into(),
        )?;
        let duration = time - lane.since;
        let noise = self.rounding(lane, time, x, force);
        match (kind, lane.direction) {
            (EventKind::SlipStarted(sign), None) => {
                ensure(x == lane.origin, || {
                    format!("moved from {:e} to {x:e} in a stick", lane.origin)
                })?;
                ensure(sign.value() * force >= self.exit_force - noise, || {
                    format!(
                        "slips {sign:?} at b = {force:e}, f_s = {:e}",
                        self.exit_force
                    )
                })?;
                lane.stick_time += duration;
                lane.ended_sticks += 1;
                (lane.direction, lane.running) = (Some(sign), 1);
                lane.pull = if time == 0.0 {
                    force.abs().max(self.static_force)
                } else {
                    self.static_force
                };
            }
            (EventKind::StickEntered | EventKind::SubPhaseBoundary(_), Some(direction)) => {
                let way = direction.value() * (x - lane.origin);
                let turns = kind != EventKind::StickEntered;
                if !(turns && self.scheme == Kind::CorrectedVi) {
                    let allowed = 4.0 * ULP * (x.abs() + lane.origin.abs());
                    ensure(way >= -allowed, || {
                        format!("went {way:e} in direction {direction:?}")
                    })?;
                }
                lane.travel += (x - lane.origin).abs();
                lane.slip_time += duration;
                if self.scheme == Kind::QuasiStatic {
                    self.check_recursion(lane, time, x)?;
                    lane.pull = force.abs();
                }
                if let EventKind::SubPhaseBoundary(sign) = kind {
                    ensure(
                        !self.is_event_driven() || sign.value() * force > self.static_force,
                        || {
                            format!(
                                "turns {sign:?} at b = {force:e}, f_s = {:e}",
                                self.static_force
                            )
                        },
                    )?;
                    lane.running += 1;
                    lane.direction = Some(sign);
                } else {
                    if self.scheme != Kind::QuasiStatic {
                        let most = self.static_force * (1.0 + 4.0 * ULP);
                        ensure(force.abs() <= most, || {
                            format!("sticks at b = {force:e}, f_s = {:e}", self.static_force)
                        })?;
                    }
                    lane.slips += 1;
                    lane.sub_phases += lane.running;
                    lane.direction = None;
                }
            }
            (kind, direction) => return Err(format!("{kind:?} while moving {direction:?}")),
        }
        if self.is_event_driven() {
            let g = force + model.oscillator.stiffness * x;
            self.balance(
                lane,
                State {
                    t: time,
                    x,
                    v: 0.0,
                    g,
                    size: g.abs(),
                },
            )?;
        }
        lane.spread += ULP * (x.abs() + lane.origin.abs());
        (lane.since, lane.origin) = (time, x);
        lane.events += 1;
        Ok(())
    }

    fn check_recursion(&self, lane: &Lane, time: f64, x: f64) -> Result<(), String> {
        let Problem {
            oscillator,
            friction,
            ..
        } = &self.model;
        let (w0, gamma) = (
            oscillator.natural_frequency(),
            oscillator.damping / oscillator.mass,
        );
        let (zeta, lasted, rounding) = (gamma / w0, time - lane.since, 4.0 * ULP * time);
        let overshoot = if zeta < 1.0 {
            let root = ((1.0 - zeta) * (1.0 + zeta)).sqrt();
            let lasts = std::f64::consts::PI / (w0 * root);
            let allowed = rounding + 4.0 * ULP * lasts;
            ensure((lasted - lasts).abs() <= allowed, || {
                format!("a slip of {lasted:e}, not {lasts:e}")
            })?;
            (-std::f64::consts::PI * zeta / root).exp()
        } else {
            // The share of the way that is left: a combination of e^{l1 t} and e^{l2 t} that starts
            // at 1 with zero velocity.
            let fast = gamma + ((gamma - w0) * (gamma + w0)).sqrt();
            let slow = w0 * (w0 / fast);
            let left =
                (fast * (-slow * lasted).exp() - slow * (-fast * lasted).exp()) / (fast - slow);
            let allowed = 1e-6 + 2.0 * slow * rounding;
            ensure((left / 1e-3 - 1.0).abs() <= allowed, || {
                format!("a slip that leaves {left:e} of the way")
            })?;
            0.0
        };
        let jump = (1.0 + overshoot) * (lane.pull - friction.dynamic_force) / oscillator.stiffness;
        let moved = (x - lane.origin).abs();
        ensure((moved - jump).abs() <= 8.0 * ULP * (x.abs() + jump), || {
            format!("moved {moved:e}, not {jump:e}")
        })
    }

    fn check_snapshot(&self, lane: &mut Lane, now: State, is_static: bool) -> Result<(), String> {
        let State { t, x, v, g, size } = now;
        ensure(x.is_finite() && v.is_finite(), || "not a number".into())?;
        // A force that is not a number has not moved the body yet.
        if !g.is_finite() && self.model.force.is_some() {
            return Ok(());
        }
        ensure(g.is_finite(), || "a force that is no number".into())?;
        ensure(t >= lane.since && t >= lane.looked, || {
            "looked at out of order".into()
        })?;
        lane.looked = t;
        // At the row at which a stick ends, a scheme with a step does not hold the body any more,
        // and tells of the event with the next step.
        let has_step = matches!(self.scheme, Kind::DiscreteVi | Kind::CorrectedVi);
        let pull = (g - self.model.oscillator.stiffness * x).abs();
        let leaves =
            has_step && pull >= self.exit_force - self.rounding(lane, t, x, pull.max(size));
        let is_that_of_events = is_static == lane.direction.is_none() || (!is_static && leaves);
        ensure(is_that_of_events, || {
            "the phase is not that of the events".into()
        })?;
        lane.fastest = lane.fastest.max(v.abs());
        match lane.direction {
            None => {
                ensure(x == lane.origin && v == 0.0, || {
                    format!("moves in a stick: x' = {v:e}")
                })?;
                if is_static && self.scheme != Kind::QuasiStatic {
                    let force = g - self.model.oscillator.stiffness * x;
                    let most = self.static_force + self.rounding(lane, t, x, force.abs().max(size));
                    ensure(force.abs() <= most, || {
                        format!("static at b = {force:e}, f_s = {:e}", self.static_force)
                    })?;
                }
            }
            Some(direction) => {
                let eps = direction.value();
                ensure(eps * v >= -1e-9 * lane.fastest, || {
                    format!("x' = {v:e} in direction {direction:?}")
                })?;
                let way = eps * (x - lane.origin);
                let behind = if self.scheme == Kind::CorrectedVi {
                    self.step * lane.fastest
                } else {
                    0.0
                };
                let allowed = behind + 4.0 * ULP * (x.abs() + lane.origin.abs());
                ensure(way >= -allowed, || {
                    format!("went {way:e} in direction {direction:?}")
                })?;
            }
        }
        match (self.scheme, lane.last) {
            (Kind::DiscreteVi | Kind::CorrectedVi, Some(last)) if t > last.t => {
                self.check_step(last, now)?
            }
            (Kind::EventDriven, _) => self.balance(lane, now)?,
            _ => {}
        }
        lane.last = Some(now);
        Ok(())
    }

    /// One step of the discrete schemes. With F the friction of the step, from m (V' - V) = h (b -
    /// F):
    ///
    /// ```text
    /// discrete    E' - E = h V  (K beta T - 2 alpha V - F) + (K h^2 V^2  + m (V' - V)^2)/2
    /// corrected   E' - E = h V' (K beta T - 2 alpha V - F) + (K h^2 V'^2 - m (V' - V)^2)/2
    /// ```
    fn check_step(&self, a: State, b: State) -> Result<(), String> {
        let Oscillator {
            mass: m,
            stiffness: k,
            damping,
            ..
        } = self.model.oscillator;
        let h = self.step;
        let force = a.g - k * a.x - 2.0 * damping * a.v;
        let impulse = a.v + h / m * force;
        // The force that would bring the body to rest in this step is compared with the largest
        // that friction may exert. The body moves if it is larger.
        let needed = (m / h * impulse).abs();
        let most = if a.v == 0.0 {
            self.exit_force
        } else {
            self.static_force
        };
        let rounding = 16.0
            * ULP
            * (a.size + (k * a.x).abs() + 2.0 * (damping * a.v).abs() + m / h * a.v.abs());
        let excess = if b.v == 0.0 {
            needed - most
        } else {
            most - needed
        };
        ensure(!excess.is_finite() || excess <= rounding, || {
            format!(
                "x' = {:e} after a step that friction of {needed:e} would end, f_s = {most:e}",
                b.v
            )
        })?;
        let friction = if b.v == 0.0 {
            m / h * impulse
        } else {
            self.model.friction.dynamic_force.copysign(impulse)
        };
        let (mover, surplus) = match self.scheme {
            Kind::CorrectedVi => (b.v, -m * (b.v - a.v).powi(2)),
            _ => (a.v, m * (b.v - a.v).powi(2)),
        };
        let gained = 0.5 * m * (b.v + a.v) * (b.v - a.v) + 0.5 * k * (b.x + a.x) * (b.x - a.x);
        let way = h * mover;
        let right = way * (a.g - 2.0 * damping * a.v - friction) + 0.5 * (k * way * way + surplus);
        let forces = a.size + (k * a.x).abs() + 2.0 * (damping * a.v).abs() + friction.abs();
        let speeds = a.v.abs() + b.v.abs();
        let scale =
            m * speeds * speeds + k * (a.x * a.x + b.x * b.x) + h * speeds * forces + k * way * way;
        ensure(
            !scale.is_finite()
                || !right.is_finite()
                || (gained - right).abs() <= 1e-12 * scale + f64::MIN_POSITIVE,
            || format!("energy: a step gained {gained:e} where {right:e} was done"),
        )
    }

    /// From one instant to the next of the exact motion: E' - E = int g dx - f_d |dx| - 2 alpha int
    /// x'^2 dt. Between the two instants, g and x' are taken as the means of both ends, up to the
    /// amount by which they can change.
    fn balance(&self, lane: &mut Lane, now: State) -> Result<(), String> {
        let Some(last) = lane.last.replace(now) else {
            return Ok(());
        };
        // How far a force of the user's own changes between two instants is not known, and what is
        // known below takes T to be without a line, and the damping to be positive.
        if self.model.force.is_some()
            || self.model.temperature.has_line()
            || self.model.oscillator.damping < 0.0
        {
            return Ok(());
        }
        let Oscillator {
            mass: m,
            stiffness: k,
            damping,
            ..
        } = self.model.oscillator;
        let (dt, dx) = (now.t - last.t, now.x - last.x);
        let temperature = &self.model.temperature;
        let gain = self.model.oscillator.force_per_temperature().abs();
        // A phase w t is known up to the rounding of t.
        let turn = |w: f64| (w * (dt + ULP * now.t)).min(2.0);
        let harmonics: f64 = temperature
            .harmonics
            .iter()
            .map(|h| gain * h.amplitude.abs() * turn(h.angular_frequency))
            .sum();
        // Six standard deviations of a bridge, and the relaxation towards zero.
        let noise = temperature.noises.first().map_or(0.0, |n| {
            let spread = n.diffusion * dt.min(0.5 / n.relaxation_rate).sqrt();
            let size = spread
                + n.stationary_sd()
                + if let InitialNoise::At(v) = n.initial {
                    v.abs()
                } else {
                    0.0
                };
            gain * n.intensity * (6.0 * spread + (n.relaxation_rate * dt).min(2.0) * size)
        });
        let wander = harmonics + noise;
        // Where a slip ends, the noise is adjusted by the rounding errors of force, place and
        // motion.
        lane.peak = lane
            .peak
            .max(now.g.abs() + last.g.abs() + k * (now.x.abs() + last.x.abs()));
        // T is a multiple of the least double, 5e-324, and each of the two values was rounded to
        // such a multiple.
        let left = STOP_REST * lane.peak + 16.0 * k * lane.spread + gain * f64::from_bits(1);
        let jump = (now.g - last.g).abs();
        ensure(
            jump.is_nan() || jump <= 2.0 * wander + left + f64::MIN_POSITIVE,
            || format!("T jumps by {jump:e} K beta, {wander:e} expected"),
        )?;
        let forces = now.g.abs()
            + last.g.abs()
            + wander
            + k * (now.x.abs() + last.x.abs())
            + self.static_force;
        let speed = now.v.abs() + last.v.abs() + dt / m * forces;
        let gained =
            0.5 * m * (now.v + last.v) * (now.v - last.v) + 0.5 * k * (now.x + last.x) * dx;
        let done = 0.5 * (now.g + last.g) * dx - self.model.friction.dynamic_force * dx.abs();
        // The damping takes between no energy and that at the greatest speed all the way.
        let damped = 2.0 * damping * dx.abs() * speed;
        let size = m * (now.v * now.v + last.v * last.v) + forces * (now.x.abs() + last.x.abs());
        lane.energy.mismatch += gained - done + 0.5 * damped;
        lane.energy.allowed += wander * dx.abs() + 0.5 * damped + ROUNDING * size;
        Ok(())
    }

    fn check_end(&self, lane: &mut Lane) -> Result<(), String> {
        let rest = self.end - lane.since;
        match lane.direction {
            None => lane.stick_time += rest,
            Some(_) => {
                lane.slip_time += rest;
                lane.travel += lane.last.map_or(0.0, |last| (last.x - lane.origin).abs());
            }
        }
        let total = lane.stick_time + lane.slip_time;
        let allowed = 2.0 * ULP * f64::from(lane.events + 2) * self.end;
        ensure((total - self.end).abs() <= allowed, || {
            format!("stick and slip make {total:e} of {:e}", self.end)
        })?;
        let Energy { mismatch, allowed } = lane.energy;
        ensure(
            allowed.is_nan() || mismatch.is_nan() || mismatch.abs() <= allowed,
            || format!("energy off by {mismatch:e}, {allowed:e} allowed"),
        )
    }

    fn complain(
        &mut self,
        lane: usize,
        check: impl FnOnce(&Watch, &mut Lane) -> Result<(), String>,
    ) {
        if self.lanes[lane].complaint.is_none() {
            let mut state = self.lanes[lane].clone();
            state.complaint = check(self, &mut state)
                .err()
                .map(|what| format!("t = {:e}: {what}", state.looked));
            self.lanes[lane] = state;
        }
    }
}

fn ensure(holds: bool, otherwise: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(otherwise()) }
}

impl Observer for Watch {
    fn event(&mut self, lane: usize, event: Event) {
        self.complain(lane, |watch, lane| watch.check_event(lane, &event));
        self.events[lane].push(event);
    }

    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        let gain = self.model.oscillator.force_per_temperature();
        for lane in 0..self.lanes.len() {
            let (t, x, v, driven) = (
                s.time,
                s.displacement[lane],
                s.velocity[lane],
                gain * s.temperature[lane],
            );
            let own = self
                .model
                .force
                .as_ref()
                .map_or(0.0, |force| force.at(InstructionSet::detect(), x, v, t));
            let now = State {
                t,
                x,
                v,
                g: driven + own,
                size: driven.abs() + own.abs(),
            };
            self.complain(lane, |watch, state| {
                watch.check_snapshot(state, now, s.is_static[lane])
            });
            if instant == Instant::End {
                self.complain(lane, Watch::check_end);
            }
        }
    }
}
