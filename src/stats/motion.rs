//! The motion of paths between their events ([`Glide`]): the energy that each force gives to the
//! body, and the farthest and the fastest it gets. Nothing here depends on the output grid.
//!
//! x' has one sign on a sub-phase, so the work of friction without a load is f_d times the sliding
//! path, and x is farthest at an event or at the end: both are exact. The other works are integrals
//! over glides,
//!
//! ```text
//! of the temperature  c integral T x' dt         of damping  2 alpha integral x'^2 dt
//! of a force of the user's own  integral g x' dt     of friction with a load  integral f_d L |x'| dt
//! ```
//!
//! by Gauss's rule with five nodes, which is exact for the damping of a quintic, or in a step of a
//! scheme with a step by the forces at its start times the way of the step, since these are the
//! forces that move the body. What is left of the energy balance is then what the scheme creates.
//!
//! Under noise T is not smooth within a glide, but its work follows from what it does: it is the
//! change of the kinetic energy and of that of the spring, plus the works of damping and friction,
//! less that of g. The balance then closes up to rounding, and tells nothing more. Where a scheme
//! holds T during a glide, its work is that of the T that is held.
//!
//! A glide counts as far as it lies in the counted time, whenever it arrives. A step counts whole, if
//! it lies between the states at the end of the burn-in and at the end, which are those at steps.

use super::path::PathFold;
use crate::model::{Model, Sign};
use crate::scheme::{Along, Glide, Instant, Timeline};

/// The energy that each force gave to the body, or took from it, since the end of the burn-in.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Works {
    pub temperature: f64,
    pub own_force: f64,
    /// These are taken. That of friction without a load is known at the end, from the events.
    pub damping: f64,
    friction: f64,
    /// Kinetic energy and that of the spring, at the beginning and at the end.
    stored: [f64; 2],
}

impl Works {
    pub fn change(&self) -> f64 {
        self.stored[1] - self.stored[0]
    }
}

/// One path.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotionFold {
    pub start: f64,
    /// Whether the burn-in is over.
    is_counted: bool,
    /// Whether the work of the temperature follows from the balance.
    is_balanced: bool,
    /// The largest |x - x0| at events, and the largest |x'|, so far.
    pub largest: [f64; 2],
    pub works: Works,
    /// The sliding path since the end of the burn-in; known at the end.
    pub travel: f64,
}

/// The nodes of Gauss's rule on [0, 1], and their weights (Abramowitz and Stegun, table 25.4).
const NODES: [[f64; 2]; 5] = [
    [0.046_910_077_030_668_004, 0.118_463_442_528_094_54],
    [0.230_765_344_947_158_45, 0.239_314_335_249_683_23],
    [0.5, 0.284_444_444_444_444_44],
    [0.769_234_655_052_841_5, 0.239_314_335_249_683_23],
    [0.953_089_922_969_332, 0.118_463_442_528_094_54],
];

impl MotionFold {
    /// A path at x0 and x'(0).
    pub fn starting_at(model: &Model, timeline: &Timeline) -> Self {
        let x = model.initial_displacement;
        let works = Works { stored: [stored(model, x, model.initial_velocity); 2], ..Works::default() };
        let is_counted = timeline.after == 0.0;
        MotionFold { start: x, is_counted, is_balanced: false, largest: [0.0; 2], works, travel: 0.0 }
    }

    /// Add an event at this x.
    pub fn event(&mut self, x: f64) {
        self.largest[0] = self.largest[0].max((x - self.start).abs());
    }

    /// Add a piece of the motion, as far as it lies on the timeline.
    pub fn glide(&mut self, model: &Model, timeline: &Timeline, glide: &Glide) {
        let [from, to] = counted_part(timeline, glide);
        if glide.start < timeline.end {
            self.largest[1] = self.largest[1].max(glide.largest_speed(to));
        }
        let is_counted = if let Along::Step { .. } = glide.along { self.is_counted } else { from < to };
        if !is_counted {
            return;
        }
        let (body, works) = (&model.oscillator, &mut self.works);
        let own = |time: f64, x: f64, v: f64| model.own_force(time, x, v).unwrap_or(0.0);
        let has_load = model.has_load();
        let dry = |time: f64, x: f64, v: f64, way: f64| model.sliding_friction(Sign::of(way), time, x, v);
        let held = match glide.along {
            Along::Smooth { temperature, .. } => temperature,
            Along::Step { temperature } => {
                let Glide { start, displacement, way, velocity: [v, _], .. } = *glide;
                works.temperature += body.force_per_temperature() * temperature * way;
                works.damping += 2.0 * body.damping * v * way;
                works.own_force += own(start, displacement, v) * way;
                if has_load {
                    works.friction += dry(start, displacement, v, way) * way;
                }
                return;
            }
        };
        let mut more = Works::default();
        let is_followed = held.is_none() && !model.temperature.is_random();
        // The integral from the start until `from` is taken off, so that parts add up to the whole also
        // where Gauss's rule is not exact.
        let integrals = [(to, 1.0), (from, -1.0)].into_iter().filter(|(until, _)| *until > 0.0);
        for ((until, sign), [node, weight]) in integrals.flat_map(|integral| NODES.map(|node| (integral, node))) {
            let part = until * node;
            let ([way, v, _], time) = (glide.at(part), glide.start + part * glide.length);
            let weight = sign * weight * until * glide.length * v;
            more.damping += 2.0 * body.damping * v * weight;
            if model.force.is_some() {
                more.own_force += own(time, glide.displacement + way, v) * weight;
            }
            if has_load {
                more.friction += dry(time, glide.displacement + way, v, v) * weight;
            }
            if is_followed {
                more.temperature += body.force_per_temperature() * model.temperature.mean(time) * weight;
            }
        }
        if let Some(temperature) = held {
            let [start, end] = [from, to].map(|part| glide.at(part)[0]);
            more.temperature += body.force_per_temperature() * temperature * (end - start);
        }
        works.temperature += more.temperature;
        works.own_force += more.own_force;
        works.damping += more.damping;
        works.friction += more.friction;
        self.is_balanced |= held.is_none() && !is_followed;
    }

    /// Add the state (x, x') of a path at an instant. At the end, the path knows the work of friction
    /// without a load, and is told that with one.
    pub fn at(&mut self, model: &Model, instant: Instant, [x, v]: [f64; 2], path: &mut PathFold) {
        match instant {
            Instant::Counting => (self.is_counted, self.works.stored[0]) = (true, stored(model, x, v)),
            Instant::End => {
                self.event(x);
                self.works.stored[1] = stored(model, x, v);
                self.travel = path.travel;
                if model.has_load() {
                    path.friction_work = self.works.friction;
                } else {
                    self.works.friction = path.friction_work;
                }
                if self.is_balanced {
                    self.works.temperature = -self.residual();
                }
            }
            Instant::Output(_) | Instant::Period(_) => {}
        }
    }

    /// What is left of the balance.
    pub fn residual(&self) -> f64 {
        let Works { temperature, own_force, damping, friction, .. } = self.works;
        temperature + own_force - damping - friction - self.works.change()
    }
}

/// Kinetic energy and that of the spring.
fn stored(model: &Model, x: f64, v: f64) -> f64 {
    0.5 * (model.oscillator.mass * v * v + model.oscillator.stiffness * x * x)
}

/// The part of a glide that is counted, as parts of its length; a step is counted or not.
pub(super) fn counted_part(timeline: &Timeline, glide: &Glide) -> [f64; 2] {
    let part = |time: f64| ((time - glide.start) / glide.length).clamp(0.0, 1.0);
    match glide.along {
        _ if glide.start >= timeline.after && glide.end() <= timeline.end => [0.0, 1.0],
        Along::Smooth { .. } => [part(timeline.after), part(timeline.end)],
        Along::Step { .. } => {
            let middle = glide.start + 0.5 * glide.length;
            if middle > timeline.after && middle <= timeline.end { [0.0, 1.0] } else { [0.0; 2] }
        }
    }
}
