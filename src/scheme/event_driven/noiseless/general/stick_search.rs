//! The first time at which a force exceeds f_s in a stick, where the force is any function of time.
//!
//! On an interval at whose ends and in whose middle the force is known, it is taken to be the
//! parabola through these values. How much it differs from the parabola at one more time, which is
//! not at a simple fraction of the interval, bounds the error. An interval on which neither the
//! force stays within f_s nor crosses it once is divided. A force that oscillates several times
//! within an interval could in principle look like a parabola; the first interval of a search is
//! short, and only intervals without doubt are followed by longer ones.

use super::super::super::work::{Resolved, Unresolved};

/// The shortest interval, as a fraction of the first one. A force that exceeds the threshold for
/// less than this does so by less than its rounding.
const FINEST: f64 = 1e-9;

/// The same for an interval at whose start the force is on the threshold up to rounding. A force
/// that moves inwards with a slope or a curvature of size 1 is inside after such a time.
const FINEST_ON_THRESHOLD: f64 = 1.0 / (1u64 << 24) as f64;

/// A force this close to the threshold, relatively, counts as on it.
const ON_THRESHOLD: f64 = 1e-12;

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

/// The first time r > 0 up to `horizon` at which |b(r)| exceeds `threshold`; none if it does not.
/// |b(0)| is at most the threshold. b has no kink between a time r and r + `until_kink(r)`.
pub fn first_exit(
    mut b: impl FnMut(f64) -> Resolved<f64>,
    threshold: f64,
    horizon: f64,
    steps: SearchSteps,
    until_kink: impl Fn(f64) -> f64,
) -> Resolved<Option<f64>> {
    let mut left = (0.0, b(0.0)?);
    let is_on_threshold = left.1.abs() >= threshold * (1.0 - ON_THRESHOLD);
    let mut step = steps.first;
    let mut ends: Vec<(f64, f64)> = Vec::new();
    while left.0 < horizon {
        let is_whole = ends.is_empty();
        let right = match ends.last() {
            Some(end) => *end,
            None => {
                let r = (left.0 + step.min(until_kink(left.0))).min(horizon);
                ends.push((r, b(r)?));
                ends[0]
            }
        };
        let h = right.0 - left.0;
        let at_start = is_on_threshold && left.0 == 0.0;
        let exceeds = right.1.abs() > threshold;
        if h <= steps.first * if at_start { FINEST_ON_THRESHOLD } else { FINEST } {
            if exceeds {
                return crossing(b, threshold, left, right).map(Some);
            }
            left = right;
            ends.pop();
            continue;
        }
        let middle = (left.0 + 0.5 * h, b(left.0 + 0.5 * h)?);
        let aside = b(left.0 + ASIDE * h)?;
        let (rise, bend) = (right.1 - left.1, left.1 - 2.0 * middle.1 + right.1);
        let error = SAFETY * (aside - (left.1 + ASIDE * rise + 2.0 * bend * ASIDE * (ASIDE - 1.0))).abs();
        let peak = [left.1, aside, middle.1, right.1].into_iter().fold(0.0, |most: f64, b| most.max(b.abs()));
        if peak + 0.125 * bend.abs() + error <= threshold {
            left = right;
            ends.pop();
            if is_whole {
                step = (2.0 * step).min(steps.longest);
            }
        } else if exceeds && !at_start && rise * right.1.signum() > 2.0 * bend.abs() + 4.0 * error {
            return crossing(b, threshold, left, right).map(Some);
        } else {
            ends.push(middle);
            step = step.min(h);
        }
    }
    Ok(None)
}

/// The time between two times at which |b| passes the threshold, to rounding, by secants that keep
/// the bracket (the Illinois rule).
fn crossing(
    mut b: impl FnMut(f64) -> Resolved<f64>,
    threshold: f64,
    left: (f64, f64),
    right: (f64, f64),
) -> Resolved<f64> {
    let side = right.1.signum();
    let excess = |b: f64| side * b - threshold;
    let (mut low, mut high) = ((left.0, excess(left.1)), (right.0, excess(right.1)));
    let (mut last, mut last_is_high) = (f64::NAN, None);
    for _ in 0..MOST_STEPS {
        let secant = high.0 - high.1 * (high.0 - low.0) / (high.1 - low.1);
        let r = if secant > low.0 && secant < high.0 { secant } else { low.0 + 0.5 * (high.0 - low.0) };
        let rounding = 2.0 * f64::EPSILON * r;
        if (r - last).abs() <= rounding || high.0 - low.0 <= rounding {
            return Ok(r);
        }
        let here = excess(b(r)?);
        if here.is_nan() {
            return Err(Unresolved::NoNumber);
        }
        let is_high = here > 0.0;
        let (moved, other) = if is_high { (&mut high, &mut low) } else { (&mut low, &mut high) };
        *moved = (r, here);
        if last_is_high == Some(is_high) {
            other.1 *= 0.5;
        }
        (last, last_is_high) = (r, Some(is_high));
    }
    // Late in a run of a quick force, the rounding of the time is more than that of r.
    Ok(high.0)
}
