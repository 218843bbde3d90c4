//! The motion of paths between their events ([`Segment`]): the energy that each force gives to the
//! body, and its largest displacement and speed. Nothing here depends on the output grid.
//!
//! x' has one sign on a sub-phase, so the work of friction without a load is f_d times the sliding
//! path, and x is farthest at an event or at the end: both are exact. The other works are integrals
//! over segments,
//!
//! ```text
//! of the temperature  c integral T x' dt         of damping  2 alpha integral x'^2 dt
//! of a user-defined force  integral g x' dt     of friction with a load  integral f_d L |x'| dt
//! ```
//!
//! by Gauss's rule with five nodes, which is exact for the damping of a quintic, or in a step of a
//! scheme with a step by the forces at its start times the way of the step, since these are the
//! forces that move the body. At the end of a quasi-static swing without overshoot, damping takes the
//! energy of the distance that is covered immediately. The residual of the energy balance is then the energy created by the
//! scheme.
//!
//! Under noise T is not smooth within a segment, but its work follows from the balance: it is the
//! change of the kinetic energy and of that of the spring, plus the works of damping and friction,
//! minus that of g. The balance then closes up to rounding, and contains no information. If a
//! scheme keeps T constant during a segment, its work is that of this T.
//!
//! A segment counts as far as it lies in the counted time, whenever it arrives. A step counts whole, if
//! it lies between the states at the end of the burn-in and at the end, which are those at steps.

use super::path::PathFold;
use crate::model::{Problem, Sign};
use crate::scheme::{Along, Instant, Segment, Timeline};

/// The energy that each force gave to the body, or took from it, since the end of the burn-in.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Works {
    pub temperature: f64,
    pub user_force: f64,
    /// These are dissipated. That of friction without a load is known at the end, from the events.
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
    pub fn starting_at(model: &Problem, timeline: &Timeline) -> Self {
        let x = model.initial_displacement;
        let works = Works {
            stored: [stored(model, x, model.initial_velocity); 2],
            ..Works::default()
        };
        let is_counted = timeline.after == 0.0;
        MotionFold {
            start: x,
            is_counted,
            is_balanced: false,
            largest: [0.0; 2],
            works,
            travel: 0.0,
        }
    }

    /// Add an event at this x.
    pub fn event(&mut self, x: f64) {
        self.largest[0] = self.largest[0].max((x - self.start).abs());
    }

    /// Add the part of a segment of the motion that lies on the timeline.
    pub fn segment(&mut self, model: &Problem, timeline: &Timeline, segment: &Segment) {
        let [from, to] = counted_part(timeline, segment);
        if segment.start < timeline.end {
            self.largest[1] = self.largest[1].max(segment.largest_speed(to));
        }
        if !self.counts(segment, [from, to]) {
            return;
        }
        let (body, works) = (&model.oscillator, &mut self.works);
        let own = |time: f64, x: f64, v: f64| model.user_force(time, x, v).unwrap_or(0.0);
        if model.has_load() {
            works.friction += friction_work(model, segment, [from, to]);
        }
        let held = match segment.along {
            Along::Smooth { temperature, .. } => temperature,
            Along::Step { temperature } => {
                let Segment {
                    start,
                    displacement,
                    way,
                    velocity: [v, _],
                    ..
                } = *segment;
                works.temperature += body.force_per_temperature() * temperature * way;
                works.damping += 2.0 * body.damping * v * way;
                works.user_force +=
                    model.sliding_force(Sign::of(way), start, displacement, v) * way;
                return;
            }
        };
        let mut more = Works::default();
        let is_followed = held.is_none() && !model.temperature.is_random();
        for ((until, sign), [node, weight]) in
            integrals([from, to]).flat_map(|of| NODES.map(|node| (of, node)))
        {
            let part = until * node;
            let ([way, v, _], time) = (segment.at(part), segment.start + part * segment.length);
            let weight = sign * weight * until * segment.length * v;
            more.damping += 2.0 * body.damping * v * weight;
            if model.force.is_some() {
                more.user_force += own(time, segment.displacement + way, v) * weight;
            }
            if is_followed {
                more.temperature +=
                    body.force_per_temperature() * model.temperature.mean(time) * weight;
            }
        }
        if let Some(temperature) = held {
            let [start, end] = [from, to].map(|part| segment.at(part)[0]);
            more.temperature += body.force_per_temperature() * temperature * (end - start);
            if segment.length == 0.0 {
                more.damping += rest_of_swing(model, segment, temperature);
            }
        }
        works.temperature += more.temperature;
        works.user_force += more.user_force;
        works.damping += more.damping;
        self.is_balanced |= held.is_none() && !is_followed;
    }

    /// Add only the work of friction with a load of a segment of the motion.
    pub fn friction(&mut self, model: &Problem, timeline: &Timeline, segment: &Segment) {
        let parts = counted_part(timeline, segment);
        if self.counts(segment, parts) {
            self.works.friction += friction_work(model, segment, parts);
        }
    }

    /// Whether a segment of the motion is counted, given its counted part.
    fn counts(&self, segment: &Segment, [from, to]: [f64; 2]) -> bool {
        if let Along::Step { .. } = segment.along {
            self.is_counted
        } else {
            from < to
        }
    }

    /// Add the state (x, x') of a path at an instant. At the end, the path knows the work of friction
    /// without a load, and is given that with one.
    pub fn at(&mut self, model: &Problem, instant: Instant, [x, v]: [f64; 2], path: &mut PathFold) {
        match instant {
            Instant::Counting => {
                (self.is_counted, self.works.stored[0]) = (true, stored(model, x, v))
            }
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

    /// The residual of the balance.
    pub fn residual(&self) -> f64 {
        let Works {
            temperature,
            user_force,
            damping,
            friction,
            ..
        } = self.works;
        temperature + user_force - damping - friction - self.works.change()
    }
}

/// The integrals over a part of a segment, each by its end and its sign: that from the start until
/// `from` is subtracted from that until `to`, so that parts add up to the whole even if Gauss's
/// rule is not exact.
fn integrals([from, to]: [f64; 2]) -> impl Iterator<Item = (f64, f64)> {
    [(to, 1.0), (from, -1.0)]
        .into_iter()
        .filter(|(until, _)| *until > 0.0)
}

/// The work of friction with a load on a part of a segment. All nodes are computed at once.
fn friction_work(model: &Problem, segment: &Segment, parts: [f64; 2]) -> f64 {
    let Segment {
        start,
        length,
        displacement,
        way,
        velocity: [v, _],
        along,
    } = *segment;
    let direction = Sign::of(way);
    if let Along::Step { .. } = along {
        return model.sliding_friction(direction, start, displacement, v) * way;
    }
    let until = |(until, sign): (f64, f64)| -> f64 {
        let (mut x, mut v, mut time, mut ways) = ([0.0; 8], [0.0; 8], [0.0; 8], [0.0; 8]);
        for (i, [node, weight]) in NODES.into_iter().enumerate() {
            let part = until * node;
            let [so_far, velocity, _] = segment.at(part);
            (x[i], v[i], time[i]) = (displacement + so_far, velocity, start + part * length);
            ways[i] = sign * weight * until * length * velocity;
        }
        let forces = model.sliding_frictions(direction, [&x, &v, &time]);
        forces
            .iter()
            .zip(ways)
            .take(NODES.len())
            .map(|(force, way)| force * way)
            .sum()
    };
    integrals(parts).map(until).sum()
}

/// The work of damping in a jump at a constant T, which stands for a motion that goes on forever:
/// what the other forces give and the body loses.
fn rest_of_swing(model: &Problem, segment: &Segment, temperature: f64) -> f64 {
    let Segment {
        start,
        displacement,
        way,
        velocity: [before, after],
        ..
    } = *segment;
    let body = &model.oscillator;
    let middle = displacement + 0.5 * way;
    let push = body.force_per_temperature() * temperature
        - body.stiffness * middle
        - model.sliding_friction(Sign::of(way), start, middle, before);
    push * way + 0.5 * body.mass * (before * before - after * after)
}

/// Kinetic energy and that of the spring.
fn stored(model: &Problem, x: f64, v: f64) -> f64 {
    0.5 * (model.oscillator.mass * v * v + model.oscillator.stiffness * x * x)
}

/// The part of a segment that is counted, as parts of its length; a step is counted or not.
pub(super) fn counted_part(timeline: &Timeline, segment: &Segment) -> [f64; 2] {
    let part = |time: f64| ((time - segment.start) / segment.length).clamp(0.0, 1.0);
    match segment.along {
        _ if segment.start >= timeline.after && segment.end() <= timeline.end => [0.0, 1.0],
        Along::Smooth { .. } => [part(timeline.after), part(timeline.end)],
        Along::Step { .. } => {
            let middle = segment.start + 0.5 * segment.length;
            if middle > timeline.after && middle <= timeline.end {
                [0.0, 1.0]
            } else {
                [0.0; 2]
            }
        }
    }
}
