//! The first zero of the velocity in a step of a slip.
//!
//! Let V = eps x'. On an interval at whose ends V and V' are known, V is taken to be the cubic with
//! these values. How much V and V' in the middle differ from it bounds the error of the two cubics
//! on the halves, which is 16 times smaller (8 times for what is not symmetric). So V is positive
//! on a half where the Bezier control points of its cubic lie that far above zero. It has one zero
//! where those of its slope lie that far below zero and V changes its sign. Otherwise the interval
//! is divided, down to a length at which the sign at its end decides.

use super::super::super::work::{Resolved, WorkLeft};
use super::super::dense_output::Kinematics;
use super::slip_motion::SlipMotion;

/// The shortest interval, as a fraction of the step.
const FINEST: f64 = 1.0 / (1u64 << 30) as f64;

/// The same for an interval that begins at rest with x'' = 0, up to rounding. A motion with x''' of
/// size 1 has a velocity above its rounding after such a time, and not much sooner.
const FINEST_AT_REST: f64 = 1.0 / (1u64 << 24) as f64;

/// The stairs of an input that pass before it has moved a body that begins at rest with x'' = 0, up
/// to rounding.
const STAIRS_AT_REST: f64 = 16.0;

/// x'' below this fraction of the forces counts as zero.
const BALANCED: f64 = 1e-7;

/// The error of a cubic on a half, as a fraction of the difference in the middle of the whole:
/// twice as much as it is where the fourth derivative is constant.
const ERROR_OF_HALVES: f64 = 0.125;

/// Newton steps and bisections until a zero is known to rounding; a few suffice.
const MOST_STEPS: usize = 200;

/// What is known of V on an interval.
#[derive(Clone, Copy, PartialEq)]
enum Sighting {
    Positive,
    OneZero,
    Unclear,
}

/// V and V' at a time.
#[derive(Clone, Copy)]
struct Knot {
    after: f64,
    velocity: f64,
    acceleration: f64,
}

/// The cubic with V and V' as at two times, by its control points.
fn controls(left: Knot, right: Knot) -> [f64; 4] {
    let third = (right.after - left.after) / 3.0;
    let (c1, c2) = (
        left.velocity + third * left.acceleration,
        right.velocity - third * right.acceleration,
    );
    [left.velocity, c1, c2, right.velocity]
}

/// What is known of V on an interval where its cubic is wrong by at most `error`.
fn sight(left: Knot, right: Knot, error: f64) -> Sighting {
    let [c0, c1, c2, c3] = controls(left, right);
    if c0 >= 0.0 && c1 > error && c2 > error && c3 > 0.0 {
        Sighting::Positive
    } else if c0 > 0.0
        && c3 <= 0.0
        && [c1 - c0, c2 - c1, c3 - c2]
            .iter()
            .all(|rise| *rise < -error)
    {
        Sighting::OneZero
    } else {
        Sighting::Unclear
    }
}

/// The motion at the first zero of eps x' after `from`, at or before `to`; none if there is none.
/// At `from`, eps x' >= 0; if it is zero, this zero does not count.
pub fn first_stop(
    slip: &SlipMotion<'_>,
    eps: f64,
    from: Kinematics,
    to: Kinematics,
    work: &mut WorkLeft,
) -> Resolved<Option<Kinematics>> {
    let knot = |m: &Kinematics| Knot {
        after: m.after,
        velocity: eps * m.velocity,
        acceleration: eps * m.acceleration,
    };
    let length = to.after - from.after;
    let mut left = knot(&from);
    let is_balanced = left.velocity == 0.0
        && left.acceleration <= BALANCED.max(slip.tolerance) * slip.size(&from);
    let mut ends = vec![knot(&to)];
    while let Some(&right) = ends.last() {
        let h = right.after - left.after;
        let (finest, stairs) = if is_balanced && left.after == from.after {
            (FINEST_AT_REST, STAIRS_AT_REST)
        } else {
            (FINEST, 1.0)
        };
        if h <= (finest * length).max(stairs * slip.stairs) {
            if right.velocity <= 0.0 {
                // A motion that does not start in this direction stops immediately.
                let is_at_rest = left.after == from.after && left.velocity == 0.0;
                let stop = if is_at_rest {
                    slip.at(from, right.after, work)
                } else {
                    zero(slip, eps, from, (left, right), work)
                };
                return stop.map(Some);
            }
            left = right;
            ends.pop();
            continue;
        }
        let middle = knot(&slip.at(from, left.after + 0.5 * h, work)?);
        let [c0, c1, c2, c3] = controls(left, right);
        let off = (middle.velocity - 0.125 * (c0 + 3.0 * (c1 + c2) + c3)).abs();
        let turned = (middle.acceleration * h - 0.75 * (c3 + c2 - c1 - c0)).abs();
        let error = ERROR_OF_HALVES * (off + 0.25 * turned);
        let halves = [sight(left, middle, error), sight(middle, right, error)];
        match halves {
            [Sighting::Positive, Sighting::Positive] => {
                left = right;
                ends.pop();
            }
            [Sighting::Positive, Sighting::OneZero] => {
                return zero(slip, eps, from, (middle, right), work).map(Some);
            }
            [Sighting::Positive, Sighting::Unclear] => left = middle,
            [Sighting::OneZero, _] => return zero(slip, eps, from, (left, middle), work).map(Some),
            [Sighting::Unclear, _] => ends.push(middle),
        }
    }
    Ok(None)
}

/// The motion at the zero of eps x' between two times, to rounding, by Newton steps and bisection.
fn zero(
    slip: &SlipMotion<'_>,
    eps: f64,
    from: Kinematics,
    (left, right): (Knot, Knot),
    work: &mut WorkLeft,
) -> Resolved<Kinematics> {
    let (mut low, mut high) = (left.after, right.after);
    let mut u =
        low + (high - low) * (left.velocity / (left.velocity - right.velocity)).clamp(0.01, 1.0);
    for _ in 0..MOST_STEPS {
        let motion = slip.at(from, u, work)?;
        if eps * motion.velocity > 0.0 {
            low = u;
        } else {
            high = u;
        }
        let newton = u - motion.velocity / motion.acceleration;
        let rounding = 2.0 * f64::EPSILON * u;
        if motion.velocity == 0.0 || high - low <= rounding || (newton - u).abs() <= rounding {
            return Ok(motion);
        }
        u = if newton > low && newton < high {
            newton
        } else {
            low + 0.5 * (high - low)
        };
    }
    // Late in a run of a quick force, the rounding of the time is more than that of u.
    slip.at(from, high, work)
}
