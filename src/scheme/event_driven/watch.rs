//! Looking at a path inside a cell.
//!
//! Events are drawn without anybody looking. Whoever looks draws the state at the instant, given
//! what is known of the path on the piece around it, from numbers that no event depends on:
//!
//! ```text
//! slip                      between two known states: the conditional law of `first_stop`
//! stick, not left           the bridge of n, accepted with the chance that neither half meets a threshold
//! stick, left at the end    the distance from the threshold is a Bessel bridge of dimension 3
//! ```
//!
//! (A Brownian bridge conditioned to reach a threshold at its end for the first time is a
//! three-dimensional Bessel bridge: Revuz and Yor, *Continuous martingales and Brownian motion*,
//! chapter XI.)
//!
//! The rows of a run are drawn first. Rows between them, for somebody who looks more closely, are
//! drawn given those, from other numbers, so that a closer look goes through what was seen before.

use super::cells::Cell;
use super::first_stop::{Interval, Motion, state_inside};
use super::scene::Scene;
use super::stick_step::FAR_EXPONENT;
use crate::model::Sign;
use crate::noise::{AddressedDraws, TimeChange, bridge_at, meeting_probability};

/// x, x', T and whether the path is static.
pub type Seen = (f64, f64, f64, bool);

/// A time to look at, after the start of the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glance {
    pub time: f64,
    /// A row between those of the run.
    pub is_closer: bool,
}

/// Who looks at a path inside a cell.
pub trait Watch {
    /// Whether anybody looks inside this cell.
    fn is_looking(&self) -> bool;
    /// Look at a piece of the path, all times up to its end.
    fn look<P: Piece>(&mut self, scene: &Scene, cell: &Cell, piece: impl FnOnce() -> P);
}

/// Nobody looks inside this cell.
pub struct Nobody;

impl Watch for Nobody {
    #[inline(always)]
    fn is_looking(&self) -> bool {
        false
    }

    #[inline(always)]
    fn look<P: Piece>(&mut self, _: &Scene, _: &Cell, _: impl FnOnce() -> P) {}
}

/// Looks at one path at these times, in order.
pub struct Glances<'a> {
    pub glances: &'a [Glance],
    /// The numbers for the rows of the run, and for those between them.
    pub draws: [AddressedDraws; 2],
    /// What was seen, as far as it has come.
    pub seen: &'a mut Vec<Seen>,
}

impl Watch for Glances<'_> {
    #[inline(always)]
    fn is_looking(&self) -> bool {
        true
    }

    #[inline(always)]
    fn look<P: Piece>(&mut self, scene: &Scene, cell: &Cell, piece: impl FnOnce() -> P) {
        let mut rest = piece();
        while let Some(row) = self.ahead(rest.end()).find(|glance| !glance.is_closer) {
            let (seen, before, behind) = rest.parted(scene, cell, row, &mut self.draws[0]);
            self.look_closer(scene, cell, before, row.time);
            self.seen.push(seen);
            rest = behind;
        }
        let end = rest.end();
        self.look_closer(scene, cell, rest, end);
    }
}

impl<'a> Glances<'a> {
    /// The times still to be looked at, up to `end`.
    fn ahead(&self, end: f64) -> impl Iterator<Item = Glance> + use<'a> {
        self.glances[self.seen.len()..].iter().copied().take_while(move |glance| glance.time <= end)
    }

    /// The rows between those of the run, up to `end`.
    #[inline(always)]
    fn look_closer<P: Piece>(&mut self, scene: &Scene, cell: &Cell, mut piece: P, end: f64) {
        while let Some(row) = self.ahead(end).next().filter(|glance| glance.is_closer) {
            let (seen, _, behind) = piece.parted(scene, cell, row, &mut self.draws[1]);
            self.seen.push(seen);
            piece = behind;
        }
    }
}

/// A piece of a path without an event but for its end.
pub trait Piece: Sized {
    /// When it ends, after the start of the cell.
    fn end(&self) -> f64;
    /// Draw the state at a glance in it, and part it there.
    fn parted(&self, scene: &Scene, cell: &Cell, glance: Glance, draws: &mut AddressedDraws) -> (Seen, Self, Self);
}

/// The motion of a step of a slip without noise: what the drawn motion is told as a deviation from,
/// so that it keeps its digits where the noise is feeble.
pub trait Flow {
    /// Direction of the slip, and x where the step begins.
    fn start(&self) -> (Sign, f64);
    /// The distance from there, the motion along it and n, at a time after the start of the cell.
    fn at(&self, after: f64) -> (f64, Motion, f64);
    /// n at a glance as it was told from a balance of forces of this size, or, where that has lost
    /// its digits, drawn from the bridge of n between what is known of it.
    fn resolved_noise(
        &self,
        glance: Glance,
        noise: f64,
        forces: f64,
        known: [Known; 2],
        draws: &mut AddressedDraws,
    ) -> f64;
}

/// A time after the start of the cell, and n there.
pub type Known = (f64, f64);

/// A piece of a slip.
pub struct SlipPiece<'a, F> {
    pub flow: &'a F,
    /// When it begins, after the start of the cell.
    pub after: f64,
    /// The distance to there since the step began.
    pub travel: f64,
    /// The motion there.
    pub start: Motion,
    /// The rest of it.
    pub interval: Interval,
    /// n before and behind, as the rows of the run know it.
    pub known: [Known; 2],
}

impl<F: Flow> Piece for SlipPiece<'_, F> {
    fn end(&self) -> f64 {
        self.after + self.interval.length()
    }

    #[inline(always)]
    fn parted(&self, scene: &Scene, cell: &Cell, glance: Glance, draws: &mut AddressedDraws) -> (Seen, Self, Self) {
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
        // A piece of no length has its start all along.
        let part = if time > after { ((time - after) / interval.length()).min(1.0) } else { 0.0 };
        let (passed, off) = if part > 0.0 {
            state_inside(less(start, before), &deviation, part, draws.three_normals())
        } else {
            (0.0, less(start, before))
        };
        // In law positive but for a chance that the search neglects.
        let velocity = (here.velocity + off.velocity).max(0.0);
        let motion = Motion { velocity, acceleration: here.acceleration + off.acceleration };
        let passed = passed + (way_here - way_before);
        let total = travel + passed;
        let aside = total - way_here;
        let balance = body.mass * off.acceleration + 2.0 * body.damping * off.velocity + body.stiffness * aside;
        let largest = body.mass * here.acceleration.abs()
            + scene.friction.dynamic_force
            + cell.forcing(time).value.abs()
            + body.stiffness * x0.abs();
        let noise = flow.resolved_noise(glance, noise + eps * balance, largest, known, draws);
        let seen = (x0 + eps * total, eps * velocity, temperature(scene, cell, time, noise), false);
        let [first, second] = if part > 0.0 { interval.parted(part, passed, motion) } else { [interval; 2] };
        let before = SlipPiece { interval: first, known: [known[0], (time, noise)], ..*self };
        let known = [(time, noise), known[1]];
        (seen, before, SlipPiece { after: time, travel: total, start: motion, interval: second, known, ..*self })
    }
}

/// A piece of a stick that is not left before its end.
#[derive(Clone, Copy, Debug)]
pub struct StickPiece {
    /// When it begins and ends, after the start of the cell.
    pub after: (f64, f64),
    /// n at both ends.
    pub noise: (f64, f64),
    /// b at both ends.
    pub force: (f64, f64),
    /// x.
    pub displacement: f64,
    pub kind: StickEnd,
}

/// What is known of the end of a piece of a stick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StickEnd {
    /// Both thresholds are out of reach throughout.
    Clear,
    /// None is met.
    Kept,
    /// This one is met, at the end.
    Exit(Sign),
}

impl Piece for StickPiece {
    fn end(&self) -> f64 {
        self.after.1
    }

    #[inline(always)]
    fn parted(&self, scene: &Scene, cell: &Cell, glance: Glance, draws: &mut AddressedDraws) -> (Seen, Self, Self) {
        let time = glance.time;
        let (noise, force) = self.stuck(scene, cell, time, draws);
        let seen = (self.displacement, 0.0, temperature(scene, cell, time, noise), true);
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

/// So often a bridge that left the corridor is drawn again.
const TRIES: usize = 1000;

impl StickPiece {
    /// n and b at a time in it.
    fn stuck(&self, scene: &Scene, cell: &Cell, time: f64, draws: &mut AddressedDraws) -> (f64, f64) {
        let (before, behind) = (time - self.after.0, self.after.1 - time);
        if before <= 0.0 {
            return (self.noise.0, self.force.0);
        }
        if behind <= 0.0 {
            return (self.noise.1, self.force.1);
        }
        let f_s = scene.friction.static_force;
        let rest = cell.forcing(time).value - scene.oscillator.stiffness * self.displacement;
        let (mean, sd) = bridge_at(scene.relaxation_rate, scene.diffusion, before, behind, self.noise);
        match self.kind {
            StickEnd::Clear => {
                let noise = mean + sd * draws.normal();
                return (noise, rest + noise);
            }
            StickEnd::Exit(sign) => {
                // The distance by which b is inside ends at zero, and is the length of a vector
                // whose components are bridges.
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
            // Usually one threshold is far.
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
        // Both ends all but on the threshold: where the straight line between them is.
        let part = before / (before + behind);
        let force = self.force.0 + part * (self.force.1 - self.force.0);
        (force - rest, force)
    }
}

/// T where n is known.
pub fn temperature(scene: &Scene, cell: &Cell, after: f64, noise: f64) -> f64 {
    (cell.forcing(after).value + noise) / scene.force_per_temperature
}
