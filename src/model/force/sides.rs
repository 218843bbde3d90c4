//! Friction that depends on load, place or direction, as forces by the direction of a slip.
//!
//! Let e = 1 or -1 be the direction in which the body slips, or would slip. With a load L, friction
//! holds up to f_s(e) L, and in a slip it is e f_d(e) L. In a slip e is known, and each of the two
//! thresholds of a stick has its own. So everything except the constants f_s and f_d is expressed
//! by forces:
//!
//! ```text
//! slip    g - e (f_d(e) L - f_d) takes the place of g
//! stick   it is left upwards where b exceeds f_s, with g - (f_s(+) L - f_s) for g,
//!         and downwards where b is below -f_s, with g + (f_s(-) L - f_s)
//! ```
//!
//! f_s and f_d are those of the direction with the smaller f_s ([`Friction::weaker`]), so that a
//! threshold that is never reached does not reduce the precision of the other. A negative load
//! becomes NaN, so it ends a path like a force without a value.

use super::{AnyLaw, Force, ForceLaw};
use crate::lanes::{InstructionSet, Lanes};
use crate::model::{Friction, Sign};
use std::any::Any;
use std::sync::Arc;

/// A force and the friction, by direction: forwards (x' > 0) first, then backwards.
#[derive(Clone, Debug)]
pub struct Sides {
    own: [Force; 2],
    load: Option<[Force; 2]>,
    friction: [Friction; 2],
    slip: [Force; 2],
    stick: [Arc<Held>; 2],
    stick_forces: [Force; 2],
}

/// The forces in a stick that are compared with friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hold {
    /// g at rest; where it depends on the direction, the mean of both.
    pub pull: f64,
    /// How much the limits of b and of -b exceed f_s.
    pub excess: [f64; 2],
}

impl Force {
    /// No force.
    pub fn none() -> Self {
        Force::new(Nothing)
    }

    pub(super) fn is_none(&self) -> bool {
        self.law.as_any().is::<Nothing>()
    }

    /// A user-defined force and friction with a load, each forwards and backwards. The friction of
    /// the model must be [`Friction::weaker`] of both.
    pub fn with_friction(
        own: [Force; 2],
        load: Option<[Force; 2]>,
        friction: [Friction; 2],
    ) -> Self {
        let weaker = Friction::weaker(friction);
        let held = |i: usize, of: fn(Friction) -> f64| {
            let (sign, at_one, base) = ([1.0, -1.0][i], of(friction[i]), of(weaker));
            let load = load.as_ref().map(|load| load[i].clone());
            let own = Some(own[i].clone()).filter(|own| !own.is_none());
            Arc::new(Held {
                own,
                load,
                sign,
                at_one,
                base,
            })
        };
        let force = |held: Arc<Held>| Force::of(held, None);
        let slip = [0, 1].map(|i| force(held(i, |friction| friction.dynamic_force)));
        let stick = [0, 1].map(|i| held(i, |friction| friction.static_force));
        let stick_forces = stick.clone().map(force);
        let law = Arc::new(Facing(own.clone()));
        Force::of(
            law,
            Some(Arc::new(Sides {
                own,
                load,
                friction,
                slip,
                stick,
                stick_forces,
            })),
        )
    }

    /// The forces by direction, if friction has a load, or the force a direction.
    pub fn sides(&self) -> Option<&Sides> {
        self.sides.as_deref()
    }

    /// The replacement of g in a slip in this direction.
    #[inline(always)]
    pub fn in_slip(&self, direction: Sign) -> &Force {
        self.sides
            .as_ref()
            .map_or(self, |sides| &sides.slip[index(direction)])
    }

    /// The replacements of g at the two thresholds of a stick.
    #[inline(always)]
    pub fn in_stick(&self) -> [&Force; 2] {
        self.sides
            .as_ref()
            .map_or([self; 2], |sides| sides.stick_forces.each_ref())
    }

    /// The forces in a stick at x.
    #[inline(always)]
    pub fn hold(&self, instructions: InstructionSet, x: f64, time: f64) -> Hold {
        let Some(sides) = &self.sides else {
            return Hold {
                pull: self.at(instructions, x, 0.0, time),
                excess: [0.0; 2],
            };
        };
        let own = sides
            .own
            .each_ref()
            .map(|force| force.at(instructions, x, 0.0, time));
        let pull = 0.5 * (own[0] + own[1]);
        let excess = [0, 1].map(|i| {
            let held = &sides.stick[i];
            held.excess(held.load(instructions, x, 0.0, time)) - held.sign * (own[i] - pull)
        });
        Hold { pull, excess }
    }
}

impl Sides {
    /// The load, if friction has one.
    pub fn load(&self) -> Option<&Force> {
        self.load.as_ref().map(|[forwards, _]| forwards)
    }

    /// The force of these sides with other forces and loads.
    pub(super) fn map(&self, other: impl Fn(&Force) -> Force) -> Force {
        let both = |forces: &[Force; 2]| forces.each_ref().map(&other);
        Force::with_friction(both(&self.own), self.load.as_ref().map(both), self.friction)
    }

    /// f_s and f_d, forwards and backwards.
    pub fn friction(&self) -> [Friction; 2] {
        self.friction
    }

    /// g in a slip in this direction.
    pub fn own(&self, direction: Sign) -> &Force {
        &self.own[index(direction)]
    }

    /// f_d L in a slip in this direction.
    pub fn dynamic_force(&self, direction: Sign, x: f64, velocity: f64, time: f64) -> f64 {
        let i = index(direction);
        let load = self.load.as_ref().map_or(1.0, |load| {
            load[i].at(InstructionSet::detect(), x, velocity, time)
        });
        self.friction[i].dynamic_force * load
    }

    /// The same at eight places and times.
    pub fn dynamic_forces(&self, direction: Sign, at: [&[f64; 8]; 3]) -> [f64; 8] {
        let i = index(direction);
        let loads = self.load.as_ref().map_or([1.0; 8], |load| {
            load[i].law.at_each(InstructionSet::detect(), at)
        });
        loads.map(|load| self.friction[i].dynamic_force * load)
    }

    /// Whether forces, load and friction are equal.
    pub(super) fn agrees(&self, other: &Self) -> bool {
        self.own == other.own && self.load == other.load && self.friction == other.friction
    }
}

fn index(direction: Sign) -> usize {
    usize::from(direction == Sign::Negative)
}

/// The force 0.
#[derive(Debug)]
struct Nothing;

impl ForceLaw for Nothing {
    #[inline(always)]
    fn value<L: Lanes>(&self, _: L, _: L, _: L) -> L {
        L::splat(0.0)
    }

    fn depends_on_time(&self) -> bool {
        false
    }
}

/// A force in one direction, less what friction differs there from its constant: own - sign (at_one
/// load - base).
#[derive(Debug)]
struct Held {
    own: Option<Force>,
    load: Option<Force>,
    sign: f64,
    at_one: f64,
    base: f64,
}

/// Paths whose loads are computed at once.
const TOGETHER: usize = 256;

impl Held {
    /// The force and the load, where they are given.
    fn both(&self) -> impl Iterator<Item = &Force> {
        self.own.iter().chain(&self.load)
    }

    #[inline(always)]
    fn load(&self, instructions: InstructionSet, x: f64, velocity: f64, time: f64) -> f64 {
        self.load
            .as_ref()
            .map_or(1.0, |load| load.at(instructions, x, velocity, time))
    }

    /// How much friction exceeds its constant. An infinite threshold is infinite under any load.
    #[inline(always)]
    fn excess(&self, load: f64) -> f64 {
        if load >= 0.0 {
            (self.at_one * load).min(Friction::NEVER) - self.base
        } else {
            f64::NAN
        }
    }

    #[inline(always)]
    fn value(&self, own: f64, load: f64) -> f64 {
        own - self.sign * self.excess(load)
    }
}

impl AnyLaw for Held {
    fn at(&self, instructions: InstructionSet, x: f64, velocity: f64, time: f64) -> f64 {
        let own = self
            .own
            .as_ref()
            .map_or(0.0, |own| own.at(instructions, x, velocity, time));
        self.value(own, self.load(instructions, x, velocity, time))
    }

    fn at_each(&self, instructions: InstructionSet, at: [&[f64; 8]; 3]) -> [f64; 8] {
        let load = self
            .load
            .as_ref()
            .map_or([1.0; 8], |load| load.law.at_each(instructions, at));
        let own = self
            .own
            .as_ref()
            .map_or([0.0; 8], |own| own.law.at_each(instructions, at));
        std::array::from_fn(|i| self.value(own[i], load[i]))
    }

    fn fill(
        &self,
        instructions: InstructionSet,
        x: &[f64],
        velocity: &[f64],
        time: f64,
        g: &mut [f64],
    ) {
        match &self.own {
            Some(own) => own.fill(instructions, x, velocity, time, g),
            None => g.fill(0.0),
        }
        let mut loads = [1.0; TOGETHER];
        let groups = x
            .chunks(TOGETHER)
            .zip(velocity.chunks(TOGETHER))
            .zip(g.chunks_mut(TOGETHER));
        for ((x, velocity), g) in groups {
            let loads = &mut loads[..x.len()];
            if let Some(load) = &self.load {
                load.fill(instructions, x, velocity, time, loads);
            }
            for (g, load) in g.iter_mut().zip(loads) {
                *g = self.value(*g, *load);
            }
        }
    }

    fn depends_on_time(&self) -> bool {
        self.both().any(Force::depends_on_time)
    }

    fn fastest_rate(&self, end: f64) -> f64 {
        self.both()
            .map(|force| force.fastest_rate(end))
            .fold(0.0, f64::max)
    }

    fn kinks(&self, end: f64, step: f64) -> Vec<f64> {
        self.both()
            .flat_map(|force| force.kinks(end, step))
            .collect()
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}

/// A force in the direction of the velocity; at rest, the mean of both.
#[derive(Debug)]
struct Facing([Force; 2]);

impl AnyLaw for Facing {
    fn at(&self, instructions: InstructionSet, x: f64, velocity: f64, time: f64) -> f64 {
        let [forwards, backwards] = self
            .0
            .each_ref()
            .map(|force| || force.at(instructions, x, velocity, time));
        match velocity {
            v if v > 0.0 => forwards(),
            v if v < 0.0 => backwards(),
            _ => 0.5 * (forwards() + backwards()),
        }
    }

    fn at_each(
        &self,
        instructions: InstructionSet,
        [x, velocity, time]: [&[f64; 8]; 3],
    ) -> [f64; 8] {
        std::array::from_fn(|i| self.at(instructions, x[i], velocity[i], time[i]))
    }

    fn fill(
        &self,
        instructions: InstructionSet,
        x: &[f64],
        velocity: &[f64],
        time: f64,
        g: &mut [f64],
    ) {
        for ((g, x), v) in g.iter_mut().zip(x).zip(velocity) {
            *g = self.at(instructions, *x, *v, time);
        }
    }

    fn depends_on_time(&self) -> bool {
        self.0[0].depends_on_time()
    }

    fn fastest_rate(&self, end: f64) -> f64 {
        self.0[0].fastest_rate(end)
    }

    fn kinks(&self, end: f64, step: f64) -> Vec<f64> {
        self.0[0].kinks(end, step)
    }

    /// That of the force forwards, whose expression is that of both.
    fn as_any(&self) -> &dyn Any {
        self.0[0].law.as_any()
    }
}
