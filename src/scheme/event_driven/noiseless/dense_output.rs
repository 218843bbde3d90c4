//! The motion of a slip between its events, for an observer that follows it: knots at which the
//! motion is known, and quintics between them ([`Segment`]).
//!
//! The free motion of a body is a sum of two exponentials e^{l t}. A quintic over a length h leaves
//! (|l| h)^6/46 080 of each. So the knots are as close as the faster one requires, and twice as far
//! apart whenever it has decayed to 2^-6. Then a slip of a strongly damped body, whose rates may
//! differ by any factor, needs about as many knots as one at critical damping.
//!
//! Where x' is largest there is a further knot, so that the largest speed is that of the motion and
//! not that of a quintic.

use super::super::work::Resolved;
use super::exact_time::ExactTime;
use crate::model::{Complex, ImpulseResponse, Oscillator};
use crate::scheme::{Along, Segment};
use std::f64::consts::LN_2;

/// The distance between knots in units of the fastest time scale.
const PIECE: f64 = 0.1;

/// The decay after which knots are twice as far apart.
const DECAY: f64 = 6.0 * LN_2;

/// The most pieces of equal length in a slip.
const MOST_PIECES: f64 = 1e6;

/// x, x' and x'' at a time.
#[derive(Clone, Copy, Debug)]
pub struct Kinematics {
    /// The time since the start of the segment.
    pub after: f64,
    /// x, or its distance from where the segment starts.
    pub displacement: f64,
    /// x'.
    pub velocity: f64,
    /// x''.
    pub acceleration: f64,
}

/// The times of the knots of a slip under forces that are known in closed form.
#[derive(Clone, Debug)]
pub struct Knots {
    /// l of the free motion.
    roots: [Complex; 2],
    /// The fastest rate of what does not decay.
    steady_rate: f64,
}

impl Knots {
    pub fn new(oscillator: &Oscillator, steady_rate: f64) -> Self {
        let w0 = oscillator.natural_frequency();
        Knots {
            roots: ImpulseResponse::new(oscillator.damping_rate(), w0).roots,
            steady_rate,
        }
    }

    /// The knots after one time since the start of the slip, up to another one and with it.
    pub fn between(&self, [from, until]: [f64; 2]) -> impl Iterator<Item = f64> {
        let mut next = from;
        let equal_pieces = std::iter::from_fn(move || {
            let (start, [length, end]) = (next, self.distance(next));
            next = end.min(until);
            (start < until).then_some((start, next, length))
        });
        equal_pieces.flat_map(|(start, end, length)| {
            let count = ((end - start) / length).ceil().clamp(1.0, MOST_PIECES);
            (1..=count as u32).map(move |i| match f64::from(i) / count {
                1.0 => end,
                part => start + (end - start) * part,
            })
        })
    }

    /// The distance between knots from a time on, and how long it stays the same.
    fn distance(&self, from: f64) -> [f64; 2] {
        let mut shortest = [PIECE / self.steady_rate, f64::INFINITY];
        for root in self.roots {
            let decay_rate = -root.re;
            let doublings = (decay_rate * from / DECAY).floor().max(0.0);
            let length = PIECE / root.abs() * libm::exp2(doublings);
            if length < shortest[0] {
                let end = if decay_rate > 0.0 {
                    ((doublings + 1.0) * DECAY / decay_rate).max(from + length)
                } else {
                    f64::INFINITY
                };
                shortest = [length, end];
            }
        }
        shortest
    }
}

/// A slip that an observer follows.
pub struct FollowedSlip {
    /// The time from which those of its motion count.
    pub start: ExactTime,
    /// The place from which displacements of its motion count.
    pub displacement: f64,
    /// T, if the scheme keeps it constant.
    pub temperature: Option<f64>,
}

impl FollowedSlip {
    /// Reports the motion from a state on, up to the last of these knots. `at` is the motion at a
    /// later time than that of a state.
    pub fn report(
        &self,
        mut here: Kinematics,
        knots: impl Iterator<Item = f64>,
        mut at: impl FnMut(Kinematics, f64) -> Resolved<Kinematics>,
        mut report: impl FnMut(Segment),
    ) -> Resolved<()> {
        for after in knots {
            let there = at(here, after)?;
            let whole = self.segment(here, there);
            if let Some(place) = whole.fastest(1.0).filter(|place| *place > 0.0) {
                // The place is nearly right, and x' hardly changes around it.
                let fastest = at(here, here.after + place * whole.length)?;
                report(self.segment(here, fastest));
                here = fastest;
            }
            report(self.segment(here, there));
            here = there;
        }
        Ok(())
    }

    /// The motion from one state to another.
    pub fn segment(&self, here: Kinematics, there: Kinematics) -> Segment {
        Segment {
            start: self.start.after(here.after).value(),
            length: there.after - here.after,
            displacement: self.displacement + here.displacement,
            way: there.displacement - here.displacement,
            velocity: [here.velocity, there.velocity],
            along: Along::Smooth {
                acceleration: [here.acceleration, there.acceleration],
                temperature: self.temperature,
            },
        }
    }
}
