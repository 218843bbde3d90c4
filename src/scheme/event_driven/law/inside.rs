//! The state at an instant between two known states.
//!
//! ```text
//! slip                      the conditional law of `first_stop`
//! stick, not left           the bridge of n, accepted if neither half then meets a threshold
//! stick, left at the end    the distance from the threshold is a Bessel bridge of dimension 3,
//!                           accepted if neither half then meets the other threshold
//! ```
//!
//! (A Brownian bridge conditioned to reach a threshold at its end for the first time is a
//! three-dimensional Bessel bridge: Revuz and Yor, *Continuous martingales and Brownian motion*,
//! chapter XI.)

use super::first_stop::{Interval, SlipVelocity, state_inside};
use super::scene::Scene;
use crate::lanes::Lanes;
use crate::noise::{
    AddressedDraws, Distances, TimeChange, bridge_at, meeting_probability, misses_other,
    no_meeting_probability,
};

/// An instant at which the state is observed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObservationTime {
    /// Its time. An instant and an event at the same time are in the order in which they are
    /// reported, so the compared times are those reported to observers.
    pub at: f64,
    /// The time after the start of the macro step.
    pub time: f64,
    /// Whether it is an additional row between those of the run.
    pub is_additional: bool,
    /// B at that time, which is the same for all paths.
    pub forcing: f64,
    /// The place of the random numbers for this instant ([`crate::noise::observation_place`]).
    pub place: u64,
}

/// The motion of a slip step without noise, at a time: the distance since the start of the step,
/// the motion along the direction, and n. The drawn motion is computed as a deviation from it, so
/// that it keeps its precision if the noise is weak.
#[derive(Clone, Copy, Debug)]
pub struct Way<L = f64> {
    pub travel: L,
    pub motion: SlipVelocity<L>,
    pub noise: L,
}

/// A segment of a slip, in any number of paths. It is represented by its deviation from the motion
/// of its step without noise, so that a deviation keeps its precision if the noise is weak.
#[derive(Clone, Copy, Debug)]
pub struct SlipSegment<L = f64> {
    /// The direction, and x at the start of the step.
    pub eps: L,
    pub x0: L,
    /// The times at which the piece begins and ends, after the start of the macro step.
    pub after: L,
    pub until: L,
    /// The deviation of the distance since the start of the step, and of the motion, at the start
    /// of the piece.
    pub travel: L,
    pub start: SlipVelocity<L>,
    /// The length of the piece, and the deviations of its distance and of the motion at its end.
    pub interval: Interval<L>,
}

/// Where the noise moves the forces by less than this fraction of them, n cannot be computed from a
/// balance of forces. Rounding of the distance, 2e-16 of it, changes the acceleration of the
/// quintic by up to 60/h^2 times as much, which is 1e-4 of the noise here.
const ROUNDED: f64 = 1e-10;

/// The state at an instant inside a piece of a slip.
#[derive(Clone, Copy, Debug)]
pub struct Slipping<L = f64> {
    /// The distance since the start of the step, and x' along the direction.
    travel: L,
    velocity: L,
    /// n, computed from a balance of forces.
    pub noise: L,
    /// The fraction of the piece that lies before the instant.
    part: L,
    /// The deviations of the distance since the start of the piece and since the start of the step,
    /// and of the motion.
    passed: L,
    off_travel: L,
    off: SlipVelocity<L>,
}

impl<L: Lanes> SlipSegment<L> {
    /// This piece, of which `travel`, `start` and `interval` are the motion itself, as a deviation
    /// from the motion without noise, which is known at both its ends.
    #[inline(always)]
    pub fn less(self, [before, behind]: [&Way<L>; 2]) -> Self {
        let SlipSegment {
            travel,
            start,
            interval,
            ..
        } = self;
        let off = interval.travel - (behind.travel - before.travel);
        SlipSegment {
            travel: travel - before.travel,
            start: start.less(before.motion),
            interval: interval.with_end(off, interval.end.less(behind.motion)),
            ..self
        }
    }

    /// Draws the state at an instant with three normals. `here` is the motion without noise at the
    /// instant.
    #[inline(always)]
    pub fn state(
        &self,
        scene: &Scene,
        instant: ObservationTime,
        here: &Way<L>,
        normals: [L; 3],
    ) -> Slipping<L> {
        let (zero, one, time) = (L::splat(0.0), L::splat(1.0), L::splat(instant.time));
        let body = &scene.oscillator;
        // In a piece of zero length the state is that at its start.
        let since = (time - self.after) / self.interval.length;
        let part = L::select(time.gt(self.after), since.or_at_most(one), zero);
        let is_inside = part.gt(zero);
        let (way, drawn) = state_inside(self.start, &self.interval, part, normals);
        let passed = L::select(is_inside, way, zero);
        let SlipVelocity {
            velocity,
            acceleration,
        } = SlipVelocity::select(is_inside, drawn, self.start);
        // The velocity is positive in law, but for a probability that the search neglects.
        let velocity = velocity.or_at_least(-here.motion.velocity);
        let off_travel = self.travel + passed;
        let balance = acceleration * body.mass
            + velocity * (2.0 * body.damping)
            + off_travel * body.stiffness;
        Slipping {
            travel: here.travel + off_travel,
            velocity: here.motion.velocity + velocity,
            noise: here.noise + self.eps * balance,
            part,
            passed,
            off_travel,
            off: SlipVelocity {
                velocity,
                acceleration,
            },
        }
    }

    /// Whether the noise in a step of this length is above the rounding of the forces, so that n
    /// can be computed from their balance. Rounding of x acts like a force of m/h^2 times x. This
    /// does not hold for undefined values.
    #[inline(always)]
    pub fn is_felt(
        &self,
        scene: &Scene,
        instant: ObservationTime,
        here: &Way<L>,
        length: L,
    ) -> L::Mask {
        let body = &scene.oscillator;
        let forces = here.motion.acceleration.abs() * body.mass
            + scene.friction.dynamic_force
            + instant.forcing.abs()
            + self.x0.abs() * (L::splat(body.mass) / (length * length) + body.stiffness);
        (length.sqrt() * scene.diffusion).gt(forces * ROUNDED)
    }

    /// x and x' in a state.
    #[inline(always)]
    pub fn seen(&self, state: &Slipping<L>) -> (L, L) {
        (self.x0 + self.eps * state.travel, self.eps * state.velocity)
    }

    /// The parts of the piece before and after a state at an instant.
    #[inline(always)]
    pub fn parted_at(&self, instant: ObservationTime, state: &Slipping<L>) -> [Self; 2] {
        let is_inside = state.part.gt(L::splat(0.0));
        let [first, second] = self.interval.parted(state.part, state.passed, state.off);
        let first = Interval::select(is_inside, &first, &self.interval);
        let second = Interval::select(is_inside, &second, &self.interval);
        let behind = SlipSegment {
            after: L::splat(instant.time),
            travel: state.off_travel,
            start: state.off,
            interval: second,
            ..*self
        };
        [
            SlipSegment {
                until: L::splat(instant.time),
                interval: first,
                ..*self
            },
            behind,
        ]
    }
}

/// A time after the start of the macro step, and n at that time.
pub type Known = (f64, f64);

/// Draws n at a time between two known values of it: from its bridge, or, at and beyond one of
/// their times, that value itself.
#[inline(always)]
pub fn noise_between(
    scene: &Scene,
    [before, behind]: [Known; 2],
    time: f64,
    draws: &mut AddressedDraws,
) -> f64 {
    if time <= before.0 {
        before.1
    } else if time >= behind.0 {
        behind.1
    } else {
        let parts = (time - before.0, behind.0 - time);
        let ends = (before.1, behind.1);
        let (mean, sd) = bridge_at(
            scene.relaxation_rate,
            scene.diffusion,
            parts.0,
            parts.1,
            ends,
        );
        mean + sd * draws.normal()
    }
}

/// A piece of a stick, in any number of paths. The stick lasts at least until the end of the piece.
#[derive(Clone, Copy, Debug)]
pub struct StickSegment<L = f64> {
    /// The times at which it begins and ends, after the start of the macro step.
    pub after: (L, L),
    /// n at both ends.
    pub noise: (L, L),
    /// b at both ends.
    pub force: (L, L),
    /// x, which is constant in a stick.
    pub displacement: L,
}

/// What is known about a segment of a stick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StickEnd {
    /// Neither threshold can be met.
    Clear,
    /// Neither threshold is met.
    Kept,
    /// One of the thresholds is met, at the end of the piece.
    Exit,
}

/// The law of n at an instant inside a piece of a stick, given n at both ends: a bridge.
#[derive(Clone, Copy, Debug)]
pub struct Bridge<L = f64> {
    /// Its mean and its standard deviation.
    pub mean: L,
    pub sd: L,
    /// B - K x, so that b is this and n.
    pub rest: L,
}

/// n and b in a stick at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Stuck<L = f64> {
    pub noise: L,
    pub force: L,
}

impl<L: Lanes> Bridge<L> {
    /// A draw where no threshold can be met.
    #[inline(always)]
    pub fn anywhere(&self, normal: L) -> Stuck<L> {
        let noise = self.mean + self.sd * normal;
        Stuck {
            noise,
            force: self.rest + noise,
        }
    }

    /// A draw where the threshold on this side, 1 or -1, is met at the end of the piece for the
    /// first time, and has this limit at the instant. The distance of b from it ends at zero, and is the
    /// length of a three-dimensional vector whose components are bridges.
    #[inline(always)]
    pub fn before_exit(&self, limit: L, side: L, [one, two, three]: [L; 3]) -> Stuck<L> {
        let along = limit - side * (self.rest + self.mean) + self.sd * one;
        let distance = (along * along + self.sd * self.sd * (two * two + three * three)).sqrt();
        let force = side * (limit - distance);
        Stuck {
            noise: force - self.rest,
            force,
        }
    }
}

impl<L: Lanes> StickSegment<L> {
    /// Whether a bridge through b inside the piece meets neither threshold, decided by a uniform
    /// number. `halves` are the time changes of the parts before and after the instant, and `limits`
    /// those of b and -b at the start, at the instant and at the end.
    #[inline(always)]
    pub fn stays(
        &self,
        limits: [[L; 2]; 3],
        halves: &[TimeChange<L>; 2],
        force: L,
        uniform: L,
    ) -> L::Mask {
        let ([first, last], [start, here, end]) = (halves, limits);
        let before = stay([start, here], first, (self.force.0, force));
        uniform.lt(before * stay([here, end], last, (force, self.force.1)))
    }

    /// The side, 1 or -1, on which the stick band is left at the end of the piece.
    #[inline(always)]
    pub fn exit_side(&self) -> L {
        L::select(
            self.force.1.lt(L::splat(0.0)),
            L::splat(-1.0),
            L::splat(1.0),
        )
    }

    /// Whether a bridge through b inside the piece, which meets the threshold at the end of the
    /// piece for the first time, does not meet the other threshold, decided by a uniform number.
    #[inline(always)]
    pub fn misses_other(
        &self,
        [start, here, end]: [[L; 2]; 3],
        [first, last]: &[TimeChange<L>; 2],
        force: L,
        uniform: L,
    ) -> L::Mask {
        let one = L::splat(1.0);
        let (is_up, [upper, lower]) = (
            self.exit_side().gt(L::splat(0.0)),
            distances([start, here], (self.force.0, force)),
        );
        let this = (
            L::select(is_up, upper.0, lower.0),
            L::select(is_up, upper.1, lower.1),
        );
        let other = (
            L::select(is_up, lower.0, upper.0),
            L::select(is_up, lower.1, upper.1),
        );
        let misses_this = one - meeting_probability(this, first.duration);
        let misses_both = no_meeting_probability(this, other, first.duration);
        // If both round to zero, the other threshold is far away.
        let is_lost = misses_this.lt(L::splat(1e-9));
        let before = L::select(is_lost, one, misses_both / misses_this);
        let width = (here[0] + here[1] + (end[0] + end[1])) * 0.5;
        uniform.lt(before * misses_other(this.1, width, last.duration))
    }

    /// n and b at an instant, as drawn inside the piece, or those of an end on which it lies.
    #[inline(always)]
    pub fn inside(&self, instant: ObservationTime, drawn: Stuck<L>) -> Stuck<L> {
        let time = L::splat(instant.time);
        let (is_first, is_last) = (time.le(self.after.0), time.ge(self.after.1));
        let noise = L::select(is_last, self.noise.1, drawn.noise);
        let force = L::select(is_last, self.force.1, drawn.force);
        Stuck {
            noise: L::select(is_first, self.noise.0, noise),
            force: L::select(is_first, self.force.0, force),
        }
    }

    /// The part of the piece after an instant.
    #[inline(always)]
    pub fn behind(&self, instant: ObservationTime, there: Stuck<L>) -> Self {
        StickSegment {
            after: (L::splat(instant.time), self.after.1),
            noise: (there.noise, self.noise.1),
            force: (there.force, self.force.1),
            ..*self
        }
    }
}

/// The probability that a bridge between two values of b meets neither threshold.
#[inline(always)]
fn stay<L: Lanes>(limits: [[L; 2]; 2], half: &TimeChange<L>, ends: (L, L)) -> L {
    let [upper, lower] = distances(limits, ends);
    no_meeting_probability(upper, lower, half.duration)
}

/// The distances of two values of b from the upper threshold and from the lower one.
#[inline(always)]
fn distances<L: Lanes>([first, last]: [[L; 2]; 2], (from, to): (L, L)) -> [Distances<L>; 2] {
    [
        (first[0] - from, last[0] - to),
        (first[1] + from, last[1] + to),
    ]
}

/// The number of attempts to draw a bridge that stays inside the band. An attempt takes up to
/// three random numbers.
pub const TRIES: usize = 600;
