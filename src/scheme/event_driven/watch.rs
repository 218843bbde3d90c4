//! The state of a path at instants inside a cell.
//!
//! Events are drawn without regard to the instants at which the state is observed. The state at an
//! instant is drawn given what is known of the path on the piece around it, from random numbers
//! that no event depends on:
//!
//! ```text
//! slip                      between two known states: the conditional law of `first_stop`
//! stick, not left           the bridge of n, accepted if neither half then meets a threshold
//! stick, left at the end    the distance from the threshold is a Bessel bridge of dimension 3
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
use super::stick_step::FAR_EXPONENT;
use crate::model::Sign;
use crate::noise::{AddressedDraws, TimeChange, bridge_at, meeting_probability};

/// x, x', T and whether the path is static.
pub type Seen = (f64, f64, f64, bool);

/// An instant at which the state is observed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glance {
    /// The time after the start of the cell.
    pub time: f64,
    /// Whether it is a row between those of the run.
    pub is_closer: bool,
    /// B at that time, which is the same for all paths.
    pub forcing: f64,
}

/// An observer of one path inside a cell.
pub trait Watch {
    /// Whether there are instants to observe inside this cell.
    fn is_looking(&self) -> bool;
    /// Observes a piece of the path: draws the state at all instants up to the end of the piece.
    fn look<P: Piece>(&mut self, scene: &Scene, piece: impl FnOnce() -> P);
}

/// There are no instants to observe inside this cell.
pub struct Nobody;

impl Watch for Nobody {
    #[inline(always)]
    fn is_looking(&self) -> bool {
        false
    }

    #[inline(always)]
    fn look<P: Piece>(&mut self, _: &Scene, _: impl FnOnce() -> P) {}
}

/// Observes one path at these times, in order.
pub struct Glances<'a> {
    pub glances: &'a [Glance],
    /// The random numbers for the rows of the run, and for the rows between them.
    pub draws: [AddressedDraws; 2],
    /// The states that have been drawn so far.
    pub seen: &'a mut Vec<Seen>,
}

impl Watch for Glances<'_> {
    #[inline(always)]
    fn is_looking(&self) -> bool {
        true
    }

    #[inline(always)]
    fn look<P: Piece>(&mut self, scene: &Scene, piece: impl FnOnce() -> P) {
        let mut rest = piece();
        while let Some(row) = self.ahead(rest.end()).find(|glance| !glance.is_closer) {
            let (seen, before, behind) = rest.parted(scene, row, &mut self.draws[0]);
            self.look_closer(scene, before, row.time);
            self.seen.push(seen);
            rest = behind;
        }
        let end = rest.end();
        self.look_closer(scene, rest, end);
    }
}

impl<'a> Glances<'a> {
    /// The instants that remain, up to `end`.
    fn ahead(&self, end: f64) -> impl Iterator<Item = Glance> + use<'a> {
        self.glances[self.seen.len()..].iter().copied().take_while(move |glance| glance.time <= end)
    }

    /// Draws the states at the rows between those of the run, up to `end`.
    #[inline(always)]
    fn look_closer<P: Piece>(&mut self, scene: &Scene, mut piece: P, end: f64) {
        while let Some(row) = self.ahead(end).next().filter(|glance| glance.is_closer) {
            let (seen, _, behind) = piece.parted(scene, row, &mut self.draws[1]);
            self.seen.push(seen);
            piece = behind;
        }
    }
}

/// A piece of a path without an event, except perhaps at its end.
pub trait Piece: Sized {
    /// The time at which it ends, after the start of the cell.
    fn end(&self) -> f64;
    /// Draws the state at an instant inside the piece. Returns the state and the two parts of the
    /// piece before and after the instant.
    fn parted(&self, scene: &Scene, glance: Glance, draws: &mut AddressedDraws) -> (Seen, Self, Self);
}

/// The motion of a slip step without noise. The drawn motion is computed as a deviation from it, so
/// that it keeps its digits where the noise is feeble.
pub trait Flow {
    /// Direction of the slip, and x at the start of the step.
    fn start(&self) -> (Sign, f64);
    /// The distance since the start of the step, the motion along the direction and n, at a time
    /// after the start of the cell.
    fn at(&self, after: f64) -> (f64, Motion, f64);
    /// n at an instant. `noise` is n as computed from a balance of forces of size `forces`. Where
    /// this has lost its digits, n is drawn from the bridge of n between the two times of `known`
    /// instead.
    fn resolved_noise(
        &self,
        glance: Glance,
        noise: f64,
        forces: f64,
        known: [Known; 2],
        draws: &mut AddressedDraws,
    ) -> f64;
}

/// A time after the start of the cell, and n at that time.
pub type Known = (f64, f64);

/// A piece of a slip.
pub struct SlipPiece<'a, F> {
    pub flow: &'a F,
    /// The time at which it begins, after the start of the cell.
    pub after: f64,
    /// The distance from the start of the step to the start of the piece.
    pub travel: f64,
    /// The motion at the start of the piece.
    pub start: Motion,
    /// The length of the piece, and the distance and motion at its end.
    pub interval: Interval,
    /// n at known times before and after, as drawn for the rows of the run.
    pub known: [Known; 2],
}

impl<F: Flow> Piece for SlipPiece<'_, F> {
    fn end(&self) -> f64 {
        self.after + self.interval.length()
    }

    #[inline(always)]
    fn parted(&self, scene: &Scene, glance: Glance, draws: &mut AddressedDraws) -> (Seen, Self, Self) {
        let time = glance.time;
        let SlipPiece { flow, after, travel, start, interval, known } = *self;
        let (body, (direction, x0)) = (&scene.oscillator, flow.start());
        let eps = direction.value();
        let (way_before, before, _) = flow.at(after);
        let (way_here, here, noise) = flow.at(time);
        let (way_behind, behind, _) = flow.at(self.end());
        let less = |a: Motion, b: Motion| Motion {
            velocity: a.velocity - b.velocity,
            acceleration: a.acceleration - b.acceleration,
        };
        let deviation = interval.with_end(interval.end().0 - (way_behind - way_before), less(interval.end().1, behind));
        // In a piece of zero length the state is that at its start.
        let part = if time > after { ((time - after) / interval.length()).min(1.0) } else { 0.0 };
        let (passed, off) = if part > 0.0 {
            state_inside(less(start, before), &deviation, part, draws.three_normals())
        } else {
            (0.0, less(start, before))
        };
        // The velocity is positive in law, but for a probability that the search neglects.
        let velocity = (here.velocity + off.velocity).max(0.0);
        let motion = Motion { velocity, acceleration: here.acceleration + off.acceleration };
        let passed = passed + (way_here - way_before);
        let total = travel + passed;
        let aside = total - way_here;
        let balance = body.mass * off.acceleration + 2.0 * body.damping * off.velocity + body.stiffness * aside;
        let largest = body.mass * here.acceleration.abs()
            + scene.friction.dynamic_force
            + glance.forcing.abs()
            + body.stiffness * x0.abs();
        let noise = flow.resolved_noise(glance, noise + eps * balance, largest, known, draws);
        let seen = (x0 + eps * total, eps * velocity, temperature(scene, glance, noise), false);
        let [first, second] = if part > 0.0 { interval.parted(part, passed, motion) } else { [interval; 2] };
        let before = SlipPiece { interval: first, known: [known[0], (time, noise)], ..*self };
        let known = [(time, noise), known[1]];
        (seen, before, SlipPiece { after: time, travel: total, start: motion, interval: second, known, ..*self })
    }
}

/// A piece of a stick. The stick lasts at least until the end of the piece.
#[derive(Clone, Copy, Debug)]
pub struct StickPiece {
    /// The times at which it begins and ends, after the start of the cell.
    pub after: (f64, f64),
    /// n at both ends.
    pub noise: (f64, f64),
    /// b at both ends.
    pub force: (f64, f64),
    /// x, which is constant in a stick.
    pub displacement: f64,
    pub kind: StickEnd,
}

/// What is known of a piece of a stick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StickEnd {
    /// Neither threshold can be met.
    Clear,
    /// Neither threshold is met.
    Kept,
    /// The threshold on this side is met, at the end of the piece.
    Exit(Sign),
}

impl Piece for StickPiece {
    fn end(&self) -> f64 {
        self.after.1
    }

    #[inline(always)]
    fn parted(&self, scene: &Scene, glance: Glance, draws: &mut AddressedDraws) -> (Seen, Self, Self) {
        let time = glance.time;
        let (noise, force) = self.stuck(scene, glance, draws);
        let seen = (self.displacement, 0.0, temperature(scene, glance, noise), true);
        let kind = if self.kind == StickEnd::Clear { StickEnd::Clear } else { StickEnd::Kept };
        let before = StickPiece {
            after: (self.after.0, time),
            noise: (self.noise.0, noise),
            force: (self.force.0, force),
            kind,
            ..*self
        };
        let behind = StickPiece {
            after: (time, self.after.1),
            noise: (noise, self.noise.1),
            force: (force, self.force.1),
            ..*self
        };
        (seen, before, behind)
    }
}

/// The number of attempts to draw a bridge that stays inside the corridor.
const TRIES: usize = 1000;

impl StickPiece {
    /// Draws n and b at a time inside the piece.
    #[inline(always)]
    fn stuck(&self, scene: &Scene, glance: Glance, draws: &mut AddressedDraws) -> (f64, f64) {
        let time = glance.time;
        let (before, behind) = (time - self.after.0, self.after.1 - time);
        if before <= 0.0 {
            return (self.noise.0, self.force.0);
        }
        if behind <= 0.0 {
            return (self.noise.1, self.force.1);
        }
        let f_s = scene.friction.static_force;
        let rest = glance.forcing - scene.oscillator.stiffness * self.displacement;
        let (mean, sd) = bridge_at(scene.relaxation_rate, scene.diffusion, before, behind, self.noise);
        match self.kind {
            StickEnd::Clear => {
                let noise = mean + sd * draws.normal();
                return (noise, rest + noise);
            }
            StickEnd::Exit(sign) => {
                // The distance of b from the threshold ends at zero. It is the length of a
                // three-dimensional vector whose components are bridges.
                let side = sign.value();
                let inside = f_s - side * (rest + mean);
                let [one, two, three] = draws.three_normals();
                let along = inside + sd * one;
                let distance = (along * along + sd * sd * (two * two + three * three)).sqrt();
                let force = side * (f_s - distance);
                return (force - rest, force);
            }
            StickEnd::Kept => (),
        }
        let [to, from] = [before, behind].map(|h| TimeChange::new(scene.relaxation_rate, scene.diffusion, h));
        let stays = |half: &TimeChange, from: f64, to: f64| -> f64 {
            // Usually one of the thresholds is out of reach.
            let met = |side: f64| {
                let (d0, d1) = (f_s - side * from, (f_s - side * to) * half.growth);
                let is_far = d0 > 0.0 && d1 > 0.0 && 2.0 * d0 * d1 > FAR_EXPONENT * half.duration;
                if is_far { 0.0 } else { meeting_probability(d0, d1, half.duration) }
            };
            (1.0 - met(1.0)) * (1.0 - met(-1.0))
        };
        for _ in 0..TRIES {
            let force = rest + mean + sd * draws.normal();
            if draws.uniform() < stays(&to, self.force.0, force) * stays(&from, force, self.force.1) {
                return (force - rest, force);
            }
        }
        // All attempts fail only where both ends are very close to the threshold. There, b on the
        // straight line between them is used.
        let part = before / (before + behind);
        let force = self.force.0 + part * (self.force.1 - self.force.0);
        (force - rest, force)
    }
}

/// T at an instant, where n is `noise`.
pub fn temperature(scene: &Scene, glance: Glance, noise: f64) -> f64 {
    (glance.forcing + noise) / scene.force_per_temperature
}
