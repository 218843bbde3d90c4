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

use super::cells::Cell;
use super::first_stop::{Interval, Motion, state_inside};
use super::scene::Scene;
use super::stick_step::FAR_EXPONENT;
use crate::model::Sign;
use crate::noise::{AddressedDraws, TimeChange, bridge_at, meeting_probability};

/// x, x', T and whether the path is static.
pub type Seen = (f64, f64, f64, bool);

/// Who looks at a path inside a cell.
pub trait Watch {
    /// The next time to look at, after the start of the cell, if it is not after `until`.
    fn next(&self, until: f64) -> Option<f64>;
    /// The numbers to draw with.
    fn draws(&mut self) -> &mut AddressedDraws;
    /// The state at that time.
    fn see(&mut self, seen: Seen);
}

/// Nobody looks inside this cell.
pub struct Nobody(pub AddressedDraws);

impl Watch for Nobody {
    #[inline(always)]
    fn next(&self, _: f64) -> Option<f64> {
        None
    }

    fn draws(&mut self) -> &mut AddressedDraws {
        &mut self.0
    }

    fn see(&mut self, _: Seen) {}
}

/// Looks at one path at these times after the start of the cell, in order.
pub struct Times<'a> {
    pub times: &'a [f64],
    pub draws: AddressedDraws,
    /// What was seen, as far as it has come.
    pub seen: &'a mut Vec<Seen>,
}

impl Watch for Times<'_> {
    fn next(&self, until: f64) -> Option<f64> {
        self.times.get(self.seen.len()).copied().filter(|time| *time <= until)
    }

    fn draws(&mut self) -> &mut AddressedDraws {
        &mut self.draws
    }

    fn see(&mut self, seen: Seen) {
        self.seen.push(seen);
    }
}

/// A piece of a slip without an event in it.
#[derive(Clone, Copy, Debug)]
pub struct SlipPiece {
    /// When it begins, after the start of the cell.
    pub after: f64,
    /// x there.
    pub displacement: f64,
    /// Direction of the slip.
    pub direction: Sign,
    /// The motion along it where it begins.
    pub start: Motion,
    /// The rest of it.
    pub interval: Interval,
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
    pub end: StickEnd,
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

/// Look at a piece of a slip.
#[inline(always)]
pub fn look_at_slip(watch: &mut impl Watch, scene: &Scene, cell: &Cell, piece: impl Fn() -> SlipPiece, until: f64) {
    if watch.next(until).is_none() {
        return;
    }
    let SlipPiece { mut after, mut displacement, direction, mut start, mut interval } = piece();
    let eps = direction.value();
    let Scene { oscillator, friction, .. } = scene;
    while let Some(time) = watch.next(until) {
        let part = ((time - after) / interval.length()).clamp(0.0, 1.0);
        let (way, motion, rest) = state_inside(start, &interval, part, watch.draws().three_normals());
        // In law positive but for a chance that the search neglects.
        let velocity = if motion.velocity > 0.0 { motion.velocity } else { 0.0 };
        let (x, v) = (displacement + eps * way, eps * velocity);
        let force = eps * (friction.dynamic_force + oscillator.mass * motion.acceleration);
        let noise = force - cell.forcing(time).value + oscillator.stiffness * x + 2.0 * oscillator.damping * v;
        watch.see((x, v, temperature(scene, cell, time, noise), false));
        (after, displacement, start, interval) = (time, x, Motion { velocity, ..motion }, rest);
    }
}

/// Look at a piece of a stick.
#[inline(always)]
pub fn look_at_stick(watch: &mut impl Watch, scene: &Scene, cell: &Cell, mut piece: StickPiece) {
    while let Some(time) = watch.next(piece.after.1) {
        let (noise, force) = stuck(watch.draws(), scene, cell, &piece, time);
        watch.see((piece.displacement, 0.0, temperature(scene, cell, time, noise), true));
        piece.after.0 = time;
        piece.noise.0 = noise;
        piece.force.0 = force;
    }
}

/// T where n is known.
#[inline(always)]
pub fn temperature(scene: &Scene, cell: &Cell, after: f64, noise: f64) -> f64 {
    (cell.forcing(after).value + noise) / scene.force_per_temperature
}

/// So often a bridge that left the corridor is drawn again.
const TRIES: usize = 1000;

/// n and b of a stick at a time in a piece of it.
#[inline(always)]
fn stuck(draws: &mut AddressedDraws, scene: &Scene, cell: &Cell, piece: &StickPiece, time: f64) -> (f64, f64) {
    let (before, behind) = (time - piece.after.0, piece.after.1 - time);
    if before <= 0.0 {
        return (piece.noise.0, piece.force.0);
    }
    if behind <= 0.0 {
        return (piece.noise.1, piece.force.1);
    }
    let f_s = scene.friction.static_force;
    let rest = cell.forcing(time).value - scene.oscillator.stiffness * piece.displacement;
    let (mean, sd) = bridge_at(scene.relaxation_rate, scene.diffusion, before, behind, piece.noise);
    if piece.end == StickEnd::Clear {
        let force = rest + mean + sd * draws.normal();
        return (force - rest, force);
    }
    if let StickEnd::Exit(sign) = piece.end {
        // The distance by which b is inside ends at zero, and is the length of a vector whose
        // components are bridges.
        let side = sign.value();
        let inside = f_s - side * (rest + mean);
        let [one, two, three] = draws.three_normals();
        let along = inside + sd * one;
        let distance = (along * along + sd * sd * (two * two + three * three)).sqrt();
        let force = side * (f_s - distance);
        return (force - rest, force);
    }
    let to = TimeChange::new(scene.relaxation_rate, scene.diffusion, before);
    let from = TimeChange::new(scene.relaxation_rate, scene.diffusion, behind);
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
        if draws.uniform() < stays(&to, piece.force.0, force) * stays(&from, force, piece.force.1) {
            return (force - rest, force);
        }
    }
    // Both ends all but on the threshold: where the straight line between them is.
    let part = before / (before + behind);
    let force = piece.force.0 + part * (piece.force.1 - piece.force.0);
    (force - rest, force)
}
