//! The motion in a slip by extrapolation of the modified midpoint rule (Gragg 1965; Bulirsch and
//! Stoer 1966; Hairer, Norsett and Wanner, *Solving Ordinary Differential Equations I*, II.9).
//!
//! A step of length h is divided into 2, 4, ..., 16 parts. The errors of these results are series
//! in 1/n^2, and the extrapolation to n = infinity removes a term with each further result. Only
//! the increments of x and x' over the step are computed, so that small ones lose no digits.
//!
//! A step whose results do not converge, for example because g has a kink inside, is shortened.
//! Only the shortest step is accepted in any case; its effect is below the rounding of everything
//! else.

use super::super::super::work::{Resolved, Unresolved, WorkLeft};
use super::super::dense_output::Kinematics;
use super::collocation::{Collocation, ForceScale};
use super::forces::{Forces, LocalTemperature};
use crate::model::Sign;

/// The equation of motion in a slip in one direction, near a time.
#[derive(Clone, Copy, Debug)]
pub struct SlipMotion<'a> {
    /// b.
    pub forces: &'a Forces,
    /// The temperature near the start.
    pub temperature: &'a LocalTemperature,
    pub direction: Sign,
    /// eps f_d.
    pub friction: f64,
    /// m.
    pub mass: f64,
    /// The relative error of a step.
    pub tolerance: f64,
    /// The shortest step.
    pub shortest: f64,
    /// The rounding of the time of inputs, which change in stairs of this length; 0 where there are
    /// none.
    pub stairs: f64,
    /// The rules for a body that is damped strongly.
    pub collocation: &'a Collocation,
}

/// The numbers of parts.
const PARTS: [u32; 8] = [2, 4, 6, 8, 10, 12, 14, 16];

/// The factor from one step to the next, where 1, 2, ... extrapolations were needed.
const GROWTH: [f64; 8] = [4.0, 4.0, 4.0, 3.0, 2.0, 1.5, 1.0, 0.7];

/// A step that does not converge is made shorter by this factor.
const RETREAT: f64 = 0.25;

/// The first result that is compared with the one before to see whether a step converges.
const FIRST_COMPARED: usize = 2;

/// Results from this one on must approach the limit by this factor, each compared with the one
/// before. Otherwise the step is given up.
const APPROACH: (usize, f64) = (4, 0.2);

impl SlipMotion<'_> {
    /// x'' for x and x' a time after the start.
    pub fn acceleration(&self, x: f64, v: f64, after: f64, work: &mut WorkLeft) -> Resolved<f64> {
        work.spend()?;
        Ok((self
            .forces
            .at(self.temperature, Some(self.direction), [x, v], after)
            - self.friction)
            / self.mass)
    }

    /// The sizes of all forces, divided by m.
    pub fn size(&self, from: &Kinematics) -> f64 {
        let Kinematics {
            after,
            displacement,
            velocity,
            ..
        } = *from;
        (self.forces.size(
            self.temperature,
            self.direction,
            [displacement, velocity],
            after,
        ) + self.friction.abs())
            / self.mass
    }

    /// The motion with x and x' a time after the start.
    pub fn with(&self, x: f64, v: f64, after: f64, work: &mut WorkLeft) -> Resolved<Kinematics> {
        let acceleration = self.acceleration(x, v, after, work)?;
        let motion = Kinematics {
            after,
            displacement: x,
            velocity: v,
            acceleration,
        };
        if x.is_finite() && v.is_finite() && acceleration.is_finite() {
            Ok(motion)
        } else {
            Err(Unresolved::NoNumber)
        }
    }

    /// The motion at a later time.
    pub fn at(&self, from: Kinematics, after: f64, work: &mut WorkLeft) -> Resolved<Kinematics> {
        let (mut motion, mut step) = (from, after - from.after);
        while motion.after < after {
            (motion, step) = self.step(motion, step, after, work)?;
        }
        Ok(motion)
    }

    /// The motion after one step of at most a length and up to a time, and the length to try next.
    pub fn step(
        &self,
        from: Kinematics,
        length: f64,
        until: f64,
        work: &mut WorkLeft,
    ) -> Resolved<(Kinematics, f64)> {
        let scale = self.collocation.scale(self, &from, work)?;
        let is_stiff = scale.settling_time.is_finite();
        let mut h = length;
        loop {
            let is_last = h >= until - from.after;
            if is_last {
                h = until - from.after;
            }
            let is_shortest = h <= self.shortest;
            let collocated = if is_stiff {
                self.collocation.increments(self, &from, h, scale, work)?
            } else {
                None
            };
            let found = if collocated.is_some() || (is_stiff && !is_shortest) {
                collocated
            } else {
                self.increments(&from, h, scale, is_shortest, work)?
                    .map(|(found, k)| (found, GROWTH[k]))
            };
            if let Some(([dx, dv], growth)) = found {
                let after = if is_last { until } else { from.after + h };
                let motion = self.with(from.displacement + dx, from.velocity + dv, after, work)?;
                let next = h * growth;
                // A step cut off at `until` does not shorten the next one.
                return Ok((
                    motion,
                    if is_last {
                        next.max(length.min(h / RETREAT))
                    } else {
                        next
                    },
                ));
            }
            h = (h * RETREAT).max(self.shortest);
        }
    }

    /// The increments of x and x' in a step, and the number of extrapolations; none if they do not
    /// converge and need not be taken as they are.
    fn increments(
        &self,
        from: &Kinematics,
        h: f64,
        scale: ForceScale,
        is_shortest: bool,
        work: &mut WorkLeft,
    ) -> Resolved<Option<([f64; 2], usize)>> {
        let mut row = [[0.0; 2]; PARTS.len()];
        let (mut best, mut previous) = ([f64::NAN; 2], f64::INFINITY);
        for (k, &parts) in PARTS.iter().enumerate() {
            best = self.midpoint_rule(from, h, parts, work)?;
            for j in 0..k {
                let ratio = f64::from(parts) / f64::from(PARTS[k - 1 - j]);
                let old = std::mem::replace(&mut row[j], best);
                best = [0, 1].map(|i| best[i] + (best[i] - old[i]) / (ratio * ratio - 1.0));
            }
            row[k] = best;
            if k >= FIRST_COMPARED {
                let error = self.error(from, h, scale, [best, row[k - 1]]);
                if error <= 1.0 {
                    return Ok(Some((best, k)));
                }
                if k >= APPROACH.0
                    && !is_shortest
                    && (error.is_nan() || error > APPROACH.1 * previous)
                {
                    return Ok(None);
                }
                previous = error;
            }
        }
        Ok(is_shortest.then_some((best, PARTS.len() - 1)))
    }

    /// The error of the increments, from the last two of them, over the error that is allowed.
    ///
    /// x' may be wrong by the tolerance times its change, or that under all forces together, whose
    /// rounding cannot be undercut, and by the rounding of x'. Much more than that would come in
    /// where a short step passes a kink, and where many short steps follow each other. x may be
    /// wrong by the tolerance times the distance of the step.
    pub fn error(
        &self,
        from: &Kinematics,
        h: f64,
        scale: ForceScale,
        [best, second]: [[f64; 2]; 2],
    ) -> f64 {
        // The forces change x' only until the damping settles it.
        let acting = h.min(scale.settling_time);
        let (v, change) = (from.velocity.abs(), best[1].abs() + scale.size * acting);
        let allowed = [
            h * self.tolerance * (v + change),
            self.tolerance * change + 0.5 * f64::EPSILON * v,
        ];
        // A sum, because a maximum would hide a NaN.
        (best[0] - second[0]).abs() / allowed[0] + (best[1] - second[1]).abs() / allowed[1]
    }

    /// The increments of x and x' in a step of length h, by the modified midpoint rule.
    fn midpoint_rule(
        &self,
        from: &Kinematics,
        h: f64,
        parts: u32,
        work: &mut WorkLeft,
    ) -> Resolved<[f64; 2]> {
        let Kinematics {
            after,
            displacement: x,
            velocity: v,
            acceleration,
        } = *from;
        let part = h / f64::from(parts);
        let (mut before, mut here) = ([0.0; 2], [part * v, part * acceleration]);
        for i in 1..=parts {
            let a =
                self.acceleration(x + here[0], v + here[1], after + f64::from(i) * part, work)?;
            let slope = [v + here[1], a];
            if i == parts {
                return Ok([0, 1].map(|j| 0.5 * (before[j] + here[j] + part * slope[j])));
            }
            let next = [0, 1].map(|j| before[j] + 2.0 * part * slope[j]);
            (before, here) = (here, next);
        }
        Err(Unresolved::NoNumber)
    }
}
