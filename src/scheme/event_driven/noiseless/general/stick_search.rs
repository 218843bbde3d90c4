//! The first time at which a force exceeds a limit in a stick, where both are any function of time.
//!
//! Let the excess of b be b minus its limit, upwards, and -b minus its limit, downwards. On an
//! interval at whose ends and in whose middle an excess is known, it is taken to be the parabola
//! through these values. How much it differs from the parabola at one more time, which is not at a
//! simple fraction of the interval, bounds the error. An interval on which an excess neither stays
//! below 0 nor crosses it once is divided. A force that oscillates several times within an interval
//! could in principle look like a parabola; the first interval of a search is short, and only clear
//! intervals are followed by longer ones.

use super::super::super::work::Resolved;
use crate::model::Sign;

/// The shortest interval, as a fraction of the first one. A force that exceeds the threshold for
/// less than this does so by less than its rounding.
const FINEST: f64 = 1e-9;

/// The same for an interval at whose start the force is on its limit up to rounding. A force
/// that moves inwards with a slope or a curvature of size 1 is inside after such a time.
const FINEST_ON_LIMIT: f64 = 1.0 / (1u64 << 24) as f64;

/// A force this close to its limit, relatively, counts as on it.
const ON_LIMIT: f64 = 1e-12;

/// The fraction of an interval at which the parabola is compared with the force.
const ASIDE: f64 = 0.29;

/// The largest difference from the parabola, in units of that at `ASIDE`: about 1.1 where the third
/// derivative is constant.
const SAFETY: f64 = 4.0;

/// Secants and bisections until a crossing is known to rounding; a few suffice.
const MOST_STEPS: usize = 200;

/// The lengths of the intervals of a search.
#[derive(Clone, Copy, Debug)]
pub struct SearchSteps {
    /// The length of the first interval.
    pub first: f64,
    /// The length of the longest one.
    pub longest: f64,
}

/// b in a stick, and the limits of b and -b.
#[derive(Clone, Copy, Debug)]
pub struct Held {
    pub b: f64,
    pub limits: [f64; 2],
}

impl Held {
    /// How much b and -b exceed their limits.
    fn excesses(self) -> [f64; 2] {
        [self.b - self.limits[0], -self.b - self.limits[1]]
    }
}

/// The excess on one side at the start, aside, in the middle and at the end of an interval.
struct Excess([f64; 4]);

impl Excess {
    fn rise(&self) -> f64 {
        self.0[3] - self.0[0]
    }

    fn bend(&self) -> f64 {
        self.0[0] - 2.0 * self.0[2] + self.0[3]
    }

    /// How much it differs from its parabola.
    fn error(&self) -> f64 {
        let parabola = self.0[0] + ASIDE * self.rise() + 2.0 * self.bend() * ASIDE * (ASIDE - 1.0);
        SAFETY * (self.0[1] - parabola).abs()
    }

    fn stays_below(&self) -> bool {
        let peak = self.0.into_iter().fold(f64::NEG_INFINITY, f64::max);
        peak + 0.125 * self.bend().abs() + self.error() <= 0.0
    }

    fn crosses_once(&self) -> bool {
        self.0[3] > 0.0 && self.rise() > 2.0 * self.bend().abs() + 4.0 * self.error()
    }
}

/// The first time r > 0 up to `horizon` at which b or -b exceeds its limit, and in which direction;
/// none if neither does. Neither does at r = 0. b has no kink between a time r and r +
/// `until_kink(r)`.
pub fn first_exit(
    mut held: impl FnMut(f64) -> Resolved<Held>,
    horizon: f64,
    steps: SearchSteps,
    until_kink: impl Fn(f64) -> f64,
) -> Resolved<Option<(f64, Sign)>> {
    let start = held(0.0)?;
    let mut at = |r: f64| held(r).map(|held| (r, held.excesses()));
    let mut left = (0.0, start.excesses());
    let is_on_limit = [0, 1]
        .into_iter()
        .any(|i| left.1[i] >= -ON_LIMIT * start.limits[i]);
    let mut step = steps.first;
    let mut ends: Vec<(f64, [f64; 2])> = Vec::new();
    while left.0 < horizon {
        let is_whole = ends.is_empty();
        let right = match ends.last() {
            Some(end) => *end,
            None => {
                // A kink may be closer than the rounding of r.
                let end = (left.0 + step.min(until_kink(left.0))).max(left.0.next_up());
                ends.push(at(end.min(horizon))?);
                ends[0]
            }
        };
        let h = right.0 - left.0;
        let at_start = is_on_limit && left.0 == 0.0;
        if h <= steps.first * if at_start { FINEST_ON_LIMIT } else { FINEST } {
            if let Some(side) = SIDES.into_iter().find(|&side| right.1[index(side)] > 0.0) {
                return crossing(at, side, left, right).map(Some);
            }
            left = right;
            ends.pop();
            continue;
        }
        let (middle, aside) = (at(left.0 + 0.5 * h)?, at(left.0 + ASIDE * h)?);
        let sides = [0, 1].map(|i| Excess([left.1[i], aside.1[i], middle.1[i], right.1[i]]));
        let is_below = sides.each_ref().map(Excess::stays_below);
        if is_below == [true; 2] {
            left = right;
            ends.pop();
            if is_whole {
                step = (2.0 * step).min(steps.longest);
            }
            continue;
        }
        let crossed = SIDES
            .into_iter()
            .find(|&side| sides[index(side)].crosses_once() && is_below[1 - index(side)]);
        match crossed {
            Some(side) if !at_start => return crossing(at, side, left, right).map(Some),
            _ => {
                ends.push(middle);
                step = step.min(h);
            }
        }
    }
    Ok(None)
}

const SIDES: [Sign; 2] = [Sign::Positive, Sign::Negative];

fn index(side: Sign) -> usize {
    usize::from(side == Sign::Negative)
}

/// The time between two times at which the excess on this side passes 0, to rounding, by secants
/// that keep the bracket (the Illinois rule).
fn crossing(
    mut at: impl FnMut(f64) -> Resolved<(f64, [f64; 2])>,
    side: Sign,
    left: (f64, [f64; 2]),
    right: (f64, [f64; 2]),
) -> Resolved<(f64, Sign)> {
    let i = index(side);
    let (mut low, mut high) = ((left.0, left.1[i]), (right.0, right.1[i]));
    let (mut last, mut last_is_high) = (f64::NAN, None);
    for _ in 0..MOST_STEPS {
        let secant = high.0 - high.1 * (high.0 - low.0) / (high.1 - low.1);
        let r = if secant > low.0 && secant < high.0 {
            secant
        } else {
            low.0 + 0.5 * (high.0 - low.0)
        };
        let rounding = 2.0 * f64::EPSILON * r;
        if (r - last).abs() <= rounding || high.0 - low.0 <= rounding {
            return Ok((r, side));
        }
        let here = at(r)?.1[i];
        let is_high = here > 0.0;
        let (moved, other) = if is_high {
            (&mut high, &mut low)
        } else {
            (&mut low, &mut high)
        };
        *moved = (r, here);
        if last_is_high == Some(is_high) {
            other.1 *= 0.5;
        }
        (last, last_is_high) = (r, Some(is_high));
    }
    // Late in a run of a quick force, the rounding of the time is more than that of r.
    Ok((high.0, side))
}
