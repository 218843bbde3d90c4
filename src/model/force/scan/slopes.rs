//! The stiffness and damping of a force where the body can be.
//!
//! The slopes are differences of g along the same lines that are searched for jumps. A line in x
//! extends from its middle to where spring and force have absorbed all energy, so that the slope of
//! a wall is found at the wall, and that of a hardening spring only where the body can be.

use super::super::tree::{X, XDOT};
use super::jumps::{INTERVALS, Track, tracks};
use super::probe::Probe;
use crate::model::Oscillator;

/// The number of steepest intervals of a line that are refined.
const CLOSER: usize = 4;
/// The times that the steepest interval is halved.
const HALVINGS: usize = 24;

/// The largest stiffness and damping of a force, each with its place in words.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Steepest {
    /// The largest -dg/dx, or 0.
    pub stiffness: f64,
    /// Where that is.
    pub stiffest: String,
    /// The largest -dg/dx'/2, as a part of alpha, or 0.
    pub damping: f64,
    /// Where that is.
    pub most_damped: String,
}

pub(super) fn found(probe: &mut Probe, body: &Oscillator) -> Steepest {
    let energy = 0.5 * body.mass * probe.scales[XDOT] * probe.scales[XDOT];
    let mut steepest = Steepest::default();
    for track in tracks(probe) {
        let [moves_x, moves_velocity, _] = track.along.map(|along| along != 0.0);
        if moves_x == moves_velocity {
            continue;
        }
        let along = track.along[if moves_x { X } else { XDOT }];
        let g: Vec<f64> = (0..=INTERVALS)
            .map(|i| probe.at(track.point(i as f64 / INTERVALS as f64)))
            .collect();
        let reached = if moves_x {
            within(&g, energy, body.stiffness, &track)
        } else {
            0..INTERVALS
        };
        let mut falls: Vec<(f64, usize)> = reached
            .map(|i| (g[i] - g[i + 1], i))
            .filter(|(fall, _)| *fall > 0.0)
            .collect();
        falls.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, interval) in falls.into_iter().take(CLOSER) {
            let Some((slope, part)) = closer(probe, &track, interval, along) else {
                continue;
            };
            // The place of a slope is known to about a thousandth of the scales.
            let rounded = |i: usize, number: f64| {
                (number / probe.scales[i] * 2e3).round() / 2e3 * probe.scales[i]
            };
            let [x, velocity, t] = track.point(part);
            let place = || probe.words([rounded(X, x), rounded(XDOT, velocity), t]);
            if moves_x && slope > steepest.stiffness {
                (steepest.stiffness, steepest.stiffest) = (slope, place());
            } else if moves_velocity && 0.5 * slope > steepest.damping {
                (steepest.damping, steepest.most_damped) = (0.5 * slope, place());
            }
        }
    }
    steepest
}

/// The intervals of a line in x that a body reaches with this energy in the middle.
fn within(g: &[f64], energy: f64, stiffness: f64, track: &Track) -> std::ops::Range<usize> {
    let x = |i: usize| track.point(i as f64 / INTERVALS as f64)[X];
    // The energy absorbed by spring and force from one end of an interval to the other.
    let taken = |from: usize, to: usize| {
        0.5 * (stiffness * (x(from) + x(to)) - g[from] - g[to]) * (x(to) - x(from))
    };
    let middle = INTERVALS / 2;
    let (mut low, mut high, mut left) = (middle, middle, energy);
    while low > 0 && left >= 0.0 {
        left -= taken(low, low - 1);
        low -= 1;
    }
    left = energy;
    while high < INTERVALS && left >= 0.0 {
        left -= taken(high, high + 1);
        high += 1;
    }
    low..high
}

/// How steeply g falls at the steepest place of an interval, and where; none at a jump.
fn closer(probe: &mut Probe, track: &Track, interval: usize, along: f64) -> Option<(f64, f64)> {
    let [mut low, mut high] = [interval, interval + 1].map(|i| i as f64 / INTERVALS as f64);
    let (mut g_low, mut g_high) = (probe.at(track.point(low)), probe.at(track.point(high)));
    let mut slopes = [0.0; HALVINGS];
    for slope in &mut slopes {
        let middle = 0.5 * (low + high);
        let g = probe.at(track.point(middle));
        if g_low - g >= g - g_high {
            (high, g_high) = (middle, g);
        } else {
            (low, g_low) = (middle, g);
        }
        *slope = (g_low - g_high) / ((high - low) * along);
    }
    // At a jump, and where the slope has no bound, the slope grows as the interval shrinks.
    let slope = slopes[HALVINGS - 5];
    (slope > 0.0 && slope < 2.0 * slopes[HALVINGS - 9]).then_some((slope, low))
}
