//! The state of a path at instants inside a cell.
//!
//! Events are drawn without regard to the instants at which the state is observed. The state at an
//! instant is drawn given what is known of the path on the piece around it, from random numbers
//! that no event depends on:
//!
//! ```text
//! slip                      between two known states: the conditional law of `first_stop`
//! stick, not left           the bridge of n, accepted if neither half then meets a threshold
//! stick, left at the end    the distance from the threshold is a Bessel bridge of dimension 3,
//!                           accepted if neither half then meets the other threshold
//! ```
//!
//! (A Brownian bridge conditioned to reach a threshold at its end for the first time is a
//! three-dimensional Bessel bridge: Revuz and Yor, *Continuous martingales and Brownian motion*,
//! chapter XI.)
//!
//! The output rows of a run are drawn first. Rows between them, for a closer look at a path, are
//! drawn given those, from other random numbers. So a closer look agrees with everything that the
//! run has recorded.

use super::first_stop::{Interval, Motion, state_inside};
use super::scene::Scene;
use crate::lanes::{Choose, Lanes};
use crate::model::Sign;
use crate::noise::{
    AddressedDraws, Distances, TimeChange, bridge_at, meeting_probability, misses_other, no_meeting_probability,
};
use crate::scheme::columns::Columns;

/// x, x', T and whether the path is static.
pub type Seen = (f64, f64, f64, bool);

/// An instant at which the state is observed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glance {
    /// Its time. An instant and an event at the same time are in the order in which an observer is
    /// told of them, so the times that are compared are those that an observer sees.
    pub at: f64,
    /// The time after the start of the cell.
    pub time: f64,
    /// Whether it is a row between those of the run.
    pub is_closer: bool,
    /// B at that time, which is the same for all paths.
    pub forcing: f64,
    /// The place of the random numbers for this instant ([`crate::noise::looking_place`]).
    pub place: u64,
}

/// An observer of one path inside a cell.
pub trait Watch {
    /// Whether there are instants to observe inside this cell.
    fn is_looking(&self) -> bool;
    /// Whether there are instants to observe before this time after the start of the cell.
    fn is_ahead(&self, end: f64) -> bool;
    /// Observes a piece of the path: draws the state at all instants before the end of the piece.
    /// One at its end belongs to the next piece.
    fn look<P: WatchedPiece>(&mut self, scene: &Scene, piece: impl FnOnce() -> P);
}

/// There are no instants to observe inside this cell.
pub struct Nobody;

impl Watch for Nobody {
    #[inline(always)]
    fn is_looking(&self) -> bool {
        false
    }

    #[inline(always)]
    fn is_ahead(&self, _: f64) -> bool {
        false
    }

    #[inline(always)]
    fn look<P: WatchedPiece>(&mut self, _: &Scene, _: impl FnOnce() -> P) {}
}

/// Observes one path at these times, in order.
pub struct Glances<'a> {
    pub glances: &'a [Glance],
    /// When the cell begins.
    pub cell_start: f64,
    /// The random numbers of the path in this cell.
    pub draws: AddressedDraws,
    /// The lane of the path, and for each time the states of all paths.
    pub lane: usize,
    pub seen: &'a mut [Columns],
    /// The number of times that have been observed so far.
    pub passed: usize,
}

impl Watch for Glances<'_> {
    #[inline(always)]
    fn is_looking(&self) -> bool {
        true
    }

    #[inline(always)]
    fn is_ahead(&self, end: f64) -> bool {
        self.ahead(self.cell_start + end).next().is_some()
    }

    #[inline(always)]
    fn look<P: WatchedPiece>(&mut self, scene: &Scene, piece: impl FnOnce() -> P) {
        let mut rest = piece();
        let end = self.cell_start + rest.end();
        while let Some(row) = self.ahead(end).find(|glance| !glance.is_closer) {
            let (seen, before, behind) = rest.parted(scene, row, &mut self.draws.from(row.place));
            self.look_closer(scene, before, row.at);
            self.put(seen);
            rest = behind;
        }
        self.look_closer(scene, rest, end);
    }
}

impl<'a> Glances<'a> {
    /// The instants that remain before the time `end`.
    fn ahead(&self, end: f64) -> impl Iterator<Item = Glance> + use<'a> {
        self.glances[self.passed..].iter().copied().take_while(move |glance| glance.at < end)
    }

    /// Draws the states at the rows between those of the run, before the time `end`.
    #[inline(always)]
    fn look_closer<P: WatchedPiece>(&mut self, scene: &Scene, mut piece: P, end: f64) {
        while let Some(row) = self.ahead(end).next().filter(|glance| glance.is_closer) {
            let (seen, _, behind) = piece.parted(scene, row, &mut self.draws.from(row.place));
            self.put(seen);
            piece = behind;
        }
    }

    #[inline(always)]
    fn put(&mut self, seen: Seen) {
        self.seen[self.passed].set(self.lane, seen);
        self.passed += 1;
    }
}

/// A piece of a path without an event, except perhaps at its end.
pub trait WatchedPiece: Sized {
    /// The time at which it ends, after the start of the cell.
    fn end(&self) -> f64;
    /// Draws the state at an instant inside the piece. Returns the state and the two parts of the
    /// piece before and after the instant.
    fn parted(&self, scene: &Scene, glance: Glance, draws: &mut AddressedDraws) -> (Seen, Self, Self);
}

/// The motion of a slip step without noise, at a time: the distance since the start of the step,
/// the motion along the direction, and n. The drawn motion is computed as a deviation from it, so
/// that it keeps its digits where the noise is feeble.
#[derive(Clone, Copy, Debug)]
pub struct Way<L = f64> {
    pub travel: L,
    pub motion: Motion<L>,
    pub noise: L,
}

/// A piece of a slip, in any number of paths. It is known by how it deviates from the motion of its
/// step without noise, so that a deviation keeps its digits where the noise is feeble.
#[derive(Clone, Copy, Debug)]
pub struct SlipPiece<L = f64> {
    /// The direction, and x at the start of the step.
    pub eps: L,
    pub x0: L,
    /// The times at which the piece begins and ends, after the start of the cell.
    pub after: L,
    pub until: L,
    /// The deviation of the distance since the start of the step, and of the motion, at the start
    /// of the piece.
    pub travel: L,
    pub start: Motion<L>,
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
    off: Motion<L>,
}

impl<L: Lanes> SlipPiece<L> {
    /// This piece, of which `travel`, `start` and `interval` are the motion itself, as a deviation
    /// from the motion without noise, which is known at both its ends.
    #[inline(always)]
    pub fn less(self, [before, behind]: [&Way<L>; 2]) -> Self {
        let SlipPiece { travel, start, interval, .. } = self;
        let off = interval.travel - (behind.travel - before.travel);
        SlipPiece {
            travel: travel - before.travel,
            start: start.less(before.motion),
            interval: interval.with_end(off, interval.end.less(behind.motion)),
            ..self
        }
    }

    /// Draws the state at an instant with three normals. `here` is the motion without noise at the
    /// instant.
    #[inline(always)]
    pub fn state(&self, scene: &Scene, glance: Glance, here: &Way<L>, normals: [L; 3]) -> Slipping<L> {
        let (zero, one, time) = (L::splat(0.0), L::splat(1.0), L::splat(glance.time));
        let body = &scene.oscillator;
        // In a piece of zero length the state is that at its start.
        let since = (time - self.after) / self.interval.length;
        let part = L::select(time.gt(self.after), since.or_at_most(one), zero);
        let is_inside = part.gt(zero);
        let (way, drawn) = state_inside(self.start, &self.interval, part, normals);
        let passed = L::select(is_inside, way, zero);
        let Motion { velocity, acceleration } = Motion::select(is_inside, drawn, self.start);
        // The velocity is positive in law, but for a probability that the search neglects.
        let velocity = velocity.or_at_least(-here.motion.velocity);
        let off_travel = self.travel + passed;
        let balance = acceleration * body.mass + velocity * (2.0 * body.damping) + off_travel * body.stiffness;
        Slipping {
            travel: here.travel + off_travel,
            velocity: here.motion.velocity + velocity,
            noise: here.noise + self.eps * balance,
            part,
            passed,
            off_travel,
            off: Motion { velocity, acceleration },
        }
    }

    /// Whether the noise in a step of this length is above the rounding of the forces, so that n
    /// can be computed from their balance. Rounding of x acts like a force of m/h^2 times x. This
    /// does not hold for undefined values.
    #[inline(always)]
    pub fn is_felt(&self, scene: &Scene, glance: Glance, here: &Way<L>, length: L) -> L::Mask {
        let body = &scene.oscillator;
        let forces = here.motion.acceleration.abs() * body.mass
            + scene.friction.dynamic_force
            + glance.forcing.abs()
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
    pub fn parted_at(&self, glance: Glance, state: &Slipping<L>) -> [Self; 2] {
        let is_inside = state.part.gt(L::splat(0.0));
        let [first, second] = self.interval.parted(state.part, state.passed, state.off);
        let first = Interval::select(is_inside, &first, &self.interval);
        let second = Interval::select(is_inside, &second, &self.interval);
        let behind = SlipPiece {
            after: L::splat(glance.time),
            travel: state.off_travel,
            start: state.off,
            interval: second,
            ..*self
        };
        [SlipPiece { until: L::splat(glance.time), interval: first, ..*self }, behind]
    }
}

/// The motion of a slip step of one path without noise.
pub trait Flow {
    /// The motion at a time after the start of the cell.
    fn at(&self, after: f64) -> Way;
    /// The length of the step.
    fn length(&self) -> f64;
    /// Draws n at an instant from its bridge between two known times, or between the instant that
    /// was drawn before it and the later of these times.
    fn noise(&self, glance: Glance, known: [Known; 2], draws: &mut AddressedDraws) -> f64;
}

/// A time after the start of the cell, and n at that time.
pub type Known = (f64, f64);

/// Draws n at a time between two known values of it: from its bridge, or, at and beyond one of
/// their times, that value itself.
#[inline(always)]
pub fn noise_between(scene: &Scene, [before, behind]: [Known; 2], time: f64, draws: &mut AddressedDraws) -> f64 {
    if time <= before.0 {
        before.1
    } else if time >= behind.0 {
        behind.1
    } else {
        let parts = (time - before.0, behind.0 - time);
        let ends = (before.1, behind.1);
        let (mean, sd) = bridge_at(scene.relaxation_rate, scene.diffusion, parts.0, parts.1, ends);
        mean + sd * draws.normal()
    }
}

/// A piece of a slip that is too short for the noise to be distinguished from rounding: the body
/// has a uniform acceleration.
#[derive(Clone, Copy)]
pub struct CoastPiece {
    pub direction: Sign,
    /// x, x' and x'' at the start of the piece.
    pub displacement: f64,
    pub velocity: f64,
    pub acceleration: f64,
    /// The times at which the piece begins and ends, and n there.
    pub ends: [Known; 2],
}

impl CoastPiece {
    /// x and x' at a time. The body does not turn.
    #[inline(always)]
    pub fn at(&self, time: f64) -> (f64, f64) {
        let CoastPiece { direction, displacement, velocity, acceleration, ends } = *self;
        let (eps, since) = (direction.value(), (time - ends[0].0).max(0.0));
        let x = displacement + since * (velocity + 0.5 * since * acceleration);
        (x, eps * (eps * (velocity + since * acceleration)).max(0.0))
    }
}

impl WatchedPiece for CoastPiece {
    fn end(&self) -> f64 {
        self.ends[1].0
    }

    fn parted(&self, scene: &Scene, glance: Glance, draws: &mut AddressedDraws) -> (Seen, Self, Self) {
        let noise = noise_between(scene, self.ends, glance.time, draws);
        let ((x, v), here) = (self.at(glance.time), (glance.time, noise));
        let seen = (x, v, scene.temperature(glance.forcing, noise), false);
        let behind = CoastPiece { displacement: x, velocity: v, ends: [here, self.ends[1]], ..*self };
        (seen, CoastPiece { ends: [self.ends[0], here], ..*self }, behind)
    }
}

/// A piece of a slip of one path, with the motion of its step without noise.
pub struct FlowPiece<'a, F> {
    pub flow: &'a F,
    pub piece: SlipPiece,
    /// n at known times before and after, as drawn for the rows of the run.
    pub known: [Known; 2],
}

impl<F: Flow> WatchedPiece for FlowPiece<'_, F> {
    fn end(&self) -> f64 {
        self.piece.until
    }

    #[inline(always)]
    fn parted(&self, scene: &Scene, glance: Glance, draws: &mut AddressedDraws) -> (Seen, Self, Self) {
        let FlowPiece { flow, ref piece, known } = *self;
        let here = flow.at(glance.time);
        let state = piece.state(scene, glance, &here, draws.three_normals());
        let is_felt = piece.is_felt(scene, glance, &here, flow.length());
        let noise = if is_felt { state.noise } else { flow.noise(glance, known, draws) };
        let (x, v) = piece.seen(&state);
        let [first, second] = piece.parted_at(glance, &state);
        let now = (glance.time, noise);
        let before = FlowPiece { flow, piece: first, known: [known[0], now] };
        let behind = FlowPiece { flow, piece: second, known: [now, known[1]] };
        ((x, v, scene.temperature(glance.forcing, noise), false), before, behind)
    }
}

/// A piece of a stick, in any number of paths. The stick lasts at least until the end of the piece.
#[derive(Clone, Copy, Debug)]
pub struct StickPiece<L = f64> {
    /// The times at which it begins and ends, after the start of the cell.
    pub after: (L, L),
    /// n at both ends.
    pub noise: (L, L),
    /// b at both ends.
    pub force: (L, L),
    /// x, which is constant in a stick.
    pub displacement: L,
}

/// What is known of a piece of a stick.
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
        Stuck { noise, force: self.rest + noise }
    }

    /// A draw where the threshold on this side, 1 or -1, is met at the end of the piece for the
    /// first time. The distance of b from it ends at zero, and is the length of a three-dimensional
    /// vector whose components are bridges.
    #[inline(always)]
    pub fn before_exit(&self, scene: &Scene, side: L, [one, two, three]: [L; 3]) -> Stuck<L> {
        let f_s = L::splat(scene.friction.static_force);
        let along = f_s - side * (self.rest + self.mean) + self.sd * one;
        let distance = (along * along + self.sd * self.sd * (two * two + three * three)).sqrt();
        let force = side * (f_s - distance);
        Stuck { noise: force - self.rest, force }
    }
}

impl<L: Lanes> StickPiece<L> {
    /// Whether a bridge through b inside the piece meets neither threshold, decided by a uniform
    /// number. `halves` are the time changes of the parts before and after the instant.
    #[inline(always)]
    pub fn stays(&self, scene: &Scene, halves: &[TimeChange<L>; 2], force: L, uniform: L) -> L::Mask {
        let [first, last] = halves;
        uniform.lt(stay(scene, first, (self.force.0, force)) * stay(scene, last, (force, self.force.1)))
    }

    /// The side, 1 or -1, on which the corridor is left at the end of the piece.
    #[inline(always)]
    pub fn exit_side(&self) -> L {
        L::select(self.force.1.lt(L::splat(0.0)), L::splat(-1.0), L::splat(1.0))
    }

    /// Whether a bridge through b inside the piece, which meets the threshold at the end of the
    /// piece for the first time, does not meet the other threshold, decided by a uniform number.
    #[inline(always)]
    pub fn misses_other(&self, scene: &Scene, [first, last]: &[TimeChange<L>; 2], force: L, uniform: L) -> L::Mask {
        let one = L::splat(1.0);
        let [this, other] = distances(scene, self.exit_side(), (self.force.0, force));
        let misses_this = one - meeting_probability(this, first.duration);
        let misses_both = no_meeting_probability(this, other, first.duration);
        // Where rounding leaves nothing of both, the other threshold is far away.
        let is_lost = misses_this.lt(L::splat(1e-9));
        let before = L::select(is_lost, one, misses_both / misses_this);
        let width = L::splat(2.0 * scene.friction.static_force);
        uniform.lt(before * misses_other(this.1, width, last.duration))
    }

    /// n and b at an instant, as drawn inside the piece, or those of an end on which it lies.
    #[inline(always)]
    pub fn inside(&self, glance: Glance, drawn: Stuck<L>) -> Stuck<L> {
        let time = L::splat(glance.time);
        let (is_first, is_last) = (time.le(self.after.0), time.ge(self.after.1));
        let noise = L::select(is_last, self.noise.1, drawn.noise);
        let force = L::select(is_last, self.force.1, drawn.force);
        Stuck { noise: L::select(is_first, self.noise.0, noise), force: L::select(is_first, self.force.0, force) }
    }

    /// The part of the piece after an instant.
    #[inline(always)]
    pub fn behind(&self, glance: Glance, there: Stuck<L>) -> Self {
        StickPiece {
            after: (L::splat(glance.time), self.after.1),
            noise: (there.noise, self.noise.1),
            force: (there.force, self.force.1),
            ..*self
        }
    }
}

/// The probability that a bridge between two values of b meets neither threshold.
#[inline(always)]
fn stay<L: Lanes>(scene: &Scene, half: &TimeChange<L>, ends: (L, L)) -> L {
    let [upper, lower] = distances(scene, L::splat(1.0), ends);
    no_meeting_probability(upper, lower, half.duration)
}

/// The distances of two values of b from the threshold on this side, 1 or -1, and from the other.
#[inline(always)]
fn distances<L: Lanes>(scene: &Scene, side: L, (from, to): (L, L)) -> [Distances<L>; 2] {
    let f_s = L::splat(scene.friction.static_force);
    [(f_s - side * from, f_s - side * to), (f_s + side * from, f_s + side * to)]
}

impl WatchedPiece for (StickPiece, StickEnd) {
    fn end(&self) -> f64 {
        self.0.after.1
    }

    #[inline(always)]
    fn parted(&self, scene: &Scene, glance: Glance, draws: &mut AddressedDraws) -> (Seen, Self, Self) {
        let (piece, kind) = *self;
        let there = stuck(&piece, kind, scene, glance, draws);
        let seen = (piece.displacement, 0.0, scene.temperature(glance.forcing, there.noise), true);
        let before = StickPiece {
            after: (piece.after.0, glance.time),
            noise: (piece.noise.0, there.noise),
            force: (piece.force.0, there.force),
            ..piece
        };
        let kind_before = if kind == StickEnd::Clear { StickEnd::Clear } else { StickEnd::Kept };
        (seen, (before, kind_before), (piece.behind(glance, there), kind))
    }
}

/// The number of attempts to draw a bridge that stays inside the corridor. An attempt takes up to
/// three random numbers.
pub const TRIES: usize = 600;

/// Draws n and b at an instant inside a piece of a stick of one path.
#[inline(always)]
fn stuck(piece: &StickPiece, kind: StickEnd, scene: &Scene, glance: Glance, draws: &mut AddressedDraws) -> Stuck {
    let (before, behind) = (glance.time - piece.after.0, piece.after.1 - glance.time);
    let rest = glance.forcing - scene.oscillator.stiffness * piece.displacement;
    let (mean, sd) = bridge_at(scene.relaxation_rate, scene.diffusion, before, behind, piece.noise);
    let bridge = Bridge { mean, sd, rest };
    let drawn = match kind {
        _ if before <= 0.0 || behind <= 0.0 => Stuck { noise: mean, force: rest + mean },
        StickEnd::Clear => bridge.anywhere(draws.normal()),
        StickEnd::Kept | StickEnd::Exit => {
            let (theta, sigma) = (scene.relaxation_rate, scene.diffusion);
            let halves = [TimeChange::new(theta, sigma, before), TimeChange::new(theta, sigma, behind)];
            // This is a loop, because closures are not compiled for the instruction set.
            let mut tries = 0;
            loop {
                let (drawn, is_accepted) = if kind == StickEnd::Kept {
                    let drawn = bridge.anywhere(draws.normal());
                    (drawn, piece.stays(scene, &halves, drawn.force, draws.uniform()))
                } else {
                    let drawn = bridge.before_exit(scene, piece.exit_side(), draws.three_normals());
                    (drawn, piece.misses_other(scene, &halves, drawn.force, draws.uniform()))
                };
                if is_accepted {
                    break drawn;
                }
                tries += 1;
                if tries == TRIES {
                    // All attempts fail only where both ends are very close to the threshold.
                    // There, b on the straight line between them is used.
                    let part = before / (before + behind);
                    let force = piece.force.0 + part * (piece.force.1 - piece.force.0);
                    break Stuck { noise: force - rest, force };
                }
            }
        }
    };
    piece.inside(glance, drawn)
}

#[cfg(test)]
mod tests {
    use super::super::harness::{mean_and_error, noise_alone};
    use super::*;

    /// Null: the mean of b at an instant inside a piece of a stick is the exact one. n is Brownian
    /// motion here, which is absorbed at both thresholds; its densities before and after the
    /// instant are sums over images. In the first piece, which begins close to the lower threshold,
    /// the mean would be closer to that threshold by 17 % if it was not looked at. 2e5 draws each;
    /// seed 51; each of the four comparisons fails by chance once in 1e4 (3.9 standard errors).
    #[test]
    fn a_row_inside_a_stick_is_drawn_between_both_thresholds() {
        let (f_s, width) = (0.9, 1.8);
        let scene = Scene::new(&noise_alone(f_s, 1e-9));
        let images = |term: &dyn Fn(f64) -> f64| (-10..=10).map(|k| term(2.0 * width * f64::from(k))).sum::<f64>();
        let normal = |x: f64, t: f64| (-x * x / (2.0 * t)).exp();
        let absorbed = |from: f64, to: f64, t: f64| {
            images(&|shift| normal(to - from + shift, t) - normal(2.0 * f_s - to - from + shift, t))
        };
        let first = |from: f64, t: f64| images(&|shift| (f_s - from + shift) * normal(f_s - from + shift, t));
        for (from, to, kind) in [
            (-0.75, f_s, StickEnd::Exit),
            (0.3, f_s, StickEnd::Exit),
            (-0.75, 0.6, StickEnd::Kept),
            (0.1, -0.2, StickEnd::Kept),
        ] {
            let time = 0.6;
            let density = |b: f64| {
                let after = if kind == StickEnd::Exit { first(b, 1.0 - time) } else { absorbed(b, to, 1.0 - time) };
                absorbed(from, b, time) * after
            };
            let (mut mass, mut moment) = (0.0, 0.0);
            for i in 0..4000 {
                let b = -f_s + width * (f64::from(i) + 0.5) / 4000.0;
                (mass, moment) = (mass + density(b), moment + b * density(b));
            }
            let piece = StickPiece { after: (0.0, 1.0), noise: (from, to), force: (from, to), displacement: 0.0 };
            let glance = Glance { at: time, time, is_closer: false, forcing: 0.0, place: 0 };
            let mut draws = AddressedDraws::new(51, 0);
            let drawn: Vec<f64> = (0..200_000).map(|_| stuck(&piece, kind, &scene, glance, &mut draws).force).collect();
            let (mean, error) = mean_and_error(&drawn);
            println!("{from} to {to}: {mean} +- {error}, exact {}", moment / mass);
            assert!(
                (mean - moment / mass).abs() < 3.9 * error,
                "{from} to {to}: {mean} +- {error}, exact {}",
                moment / mass
            );
        }
    }
}
