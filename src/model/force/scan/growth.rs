//! Growth above linear that does not confine.

use super::super::operation::{Binary, Unary};
use super::super::tree::{Term, X, XDOT};
use super::probe::{Found, Probe, short};
use crate::model::Oscillator;

/// The multiples of the scales at which the force is examined.
const TIMES: [f64; 4] = [10.0, 100.0, 1000.0, 10_000.0];
/// The power of the distance above which growth is not called linear.
const LINEAR: f64 = 1.1;
/// Directions in x and x'.
const DIRECTIONS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [-1.0, 0.0],
    [0.0, 1.0],
    [0.0, -1.0],
    [1.0, 1.0],
    [1.0, -1.0],
    [-1.0, 1.0],
    [-1.0, -1.0],
];
/// The times, as parts of the duration.
const INSTANTS: [f64; 5] = [0.0, 0.13, 0.37, 0.71, 1.0];

/// The first direction in which the force grows and pushes outward, or in which its dependence on
/// the velocity grows and adds energy.
pub(super) fn found(probe: &mut Probe) -> Option<Found> {
    let instants = probe.instants(&INSTANTS);
    for direction in DIRECTIONS {
        for instant in &instants {
            let point = |times: f64| {
                let [x, velocity] = direction.map(|part| part * times);
                [x * probe.scales[X], velocity * probe.scales[XDOT], *instant]
            };
            let points = TIMES.map(point);
            if let Some(found) = in_direction(probe, points, direction[1] != 0.0) {
                return Some(found);
            }
        }
    }
    None
}

fn in_direction(probe: &mut Probe, points: [[f64; 3]; 4], moves: bool) -> Option<Found> {
    // The part that depends on the velocity; a force of x alone adds no net energy.
    let part = |probe: &mut Probe, point: [f64; 3]| {
        let rest = if moves {
            probe.at([point[X], 0.0, point[2]])
        } else {
            0.0
        };
        probe.at(point) - rest
    };
    let values = points.map(|point| part(probe, point));
    let far = points[2];
    let outward = values[2] * if moves { far[XDOT] } else { far[X] };
    // A force that is beyond the largest number has grown faster than any power.
    let grows = |from: usize| {
        let (near, far) = (values[from].abs(), values[from + 1].abs());
        far == f64::INFINITY || (near > 0.0 && libm::log10(far / near) > LINEAR)
    };
    if !(values[0].is_finite() && outward > 0.0 && grows(1) && grows(2)) {
        return None;
    }
    let effect = if moves {
        "adds energy"
    } else {
        "pushes outward"
    };
    let shown = if values[2].is_finite() {
        far
    } else {
        points[0]
    };
    let (value, place) = (short(probe.at(shown)), probe.words(shown));
    let sentence =
        format!("the force {effect} and grows faster than linearly: it is {value} at {place}");
    Some((largest_term(probe), sentence))
}

/// Where the force pushes outward more than the spring holds, or adds more energy than the damping
/// and friction take, at the same instant at ever larger distances and, for the energy, in every
/// direction.
pub(super) fn beyond_hold(
    probe: &mut Probe,
    body: &Oscillator,
    dynamic_force: f64,
) -> Option<String> {
    let instants = &probe.instants(&INSTANTS);
    let at = |probe: &Probe, [x, velocity]: [f64; 2], times: f64, instant: f64| {
        [
            x * times * probe.scales[X],
            velocity * times * probe.scales[XDOT],
            instant,
        ]
    };
    for instant in instants {
        for direction in [[1.0, 0.0], [-1.0, 0.0]] {
            let excess = |probe: &mut Probe, times: f64| {
                let point = at(probe, direction, times, *instant);
                probe.at(point) * direction[0] - body.stiffness * point[X].abs()
            };
            let outward = TIMES.map(|times| excess(probe, times) / times);
            // In proportion to the distance; growth that is faster is a warning of its own.
            if outward
                .iter()
                .all(|excess| *excess > 0.5 * outward[0] && *excess < 2.0 * outward[0])
            {
                let place = probe.words(at(probe, direction, TIMES[0], *instant));
                return Some(format!(
                    "[force] pushes outward more than the spring pulls back, as at {place}"
                ));
            }
        }
    }
    let adds = |probe: &mut Probe, direction: [f64; 2], times: f64, instant: f64| {
        let [x, velocity, t] = at(probe, direction, times, instant);
        let part = probe.at([x, velocity, t]) - probe.at([x, 0.0, t]);
        part * velocity.signum() > 2.0 * body.damping * velocity.abs() + dynamic_force
    };
    let moving = || {
        DIRECTIONS
            .into_iter()
            .filter(|direction| direction[1] != 0.0)
    };
    let always = instants.iter().all(|instant| {
        moving().all(|direction| {
            TIMES
                .into_iter()
                .all(|times| adds(probe, direction, times, *instant))
        })
    });
    always.then(|| {
        let place = probe.words(at(probe, [0.0, 1.0], TIMES[0], instants[0]));
        format!("[force] adds more energy than damping and friction dissipate, as at {place}")
    })
}

/// The term of a sum that is largest at the point that was computed last.
fn largest_term(probe: &Probe) -> usize {
    let mut node = probe.formula.nodes.len() - 1;
    loop {
        let size = |node: usize| probe.values[node].abs();
        node = match probe.formula.nodes[node].term {
            Term::Binary(Binary::Add | Binary::Sub, a, b) if size(a) > size(b) => a,
            Term::Binary(Binary::Add | Binary::Sub, _, b) => b,
            Term::Unary(Unary::Negative, a) => a,
            _ => return node,
        };
    }
}
