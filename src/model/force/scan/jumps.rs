//! Points where a force jumps, grows without bound, has no bounded slope, or has no value.
//!
//! They lie where the argument of an operation such as sign or division is zero. Such points are
//! looked for along straight lines through the box of the scales, and g is compared on both sides,
//! closer and closer.

use super::super::operation::{Binary, Unary};
use super::super::tree::{TIME, Term, X, XDOT};
use super::probe::{Found, Probe, short};

/// The intervals of a line.
pub(super) const INTERVALS: usize = 64;
/// The other two coordinates of lines, as parts of the scales.
const OFFSETS: [f64; 4] = [0.0, 0.37, -0.61, 0.97];
const INSTANTS: [f64; 3] = [0.0, 0.29, 0.83];
/// Distances from a point, as parts of a line.
const DISTANCES: [f64; 3] = [1e-6, 1e-8, 1e-10];
/// What counts as zero, as a part of the largest value on a line.
const NEAR: f64 = 1e-6;
/// The operations that may be spent on points between those of the lines.
const WORK: usize = 1_000_000;
/// The times that the interval in which a zero lies is made shorter.
const HALVINGS: usize = 60;
/// The evaluations of g for one zero, at most.
const EVALUATIONS: usize = 2 * HALVINGS + 20;

/// A line that begins at a point, and its difference from the end.
#[derive(Clone, Copy)]
pub(super) struct Track {
    from: [f64; 3],
    pub along: [f64; 3],
}

impl Track {
    /// The point at this part of the line.
    pub fn point(&self, part: f64) -> [f64; 3] {
        [0, 1, 2].map(|i| self.from[i] + part * self.along[i])
    }
}

/// The lines along each axis, and diagonals.
pub(super) fn tracks(probe: &Probe) -> Vec<Track> {
    let scales = probe.scales;
    let mut all = Vec::new();
    for t in probe.instants(&INSTANTS) {
        for offset in OFFSETS {
            let (x, velocity) = (offset * scales[X], offset * scales[XDOT]);
            all.push(Track {
                from: [-scales[X], velocity, t],
                along: [2.0 * scales[X], 0.0, 0.0],
            });
            all.push(Track {
                from: [x, -scales[XDOT], t],
                along: [0.0, 2.0 * scales[XDOT], 0.0],
            });
        }
        for up in [1.0, -1.0] {
            let along = [2.0 * scales[X], up * 2.0 * scales[XDOT], 0.0];
            all.push(Track {
                from: [-scales[X], -up * scales[XDOT], t],
                along,
            });
        }
    }
    if scales[TIME] > 0.0 {
        for x in OFFSETS {
            let others = OFFSETS.map(|velocity| [x * scales[X], velocity * scales[XDOT], 0.0]);
            all.extend(others.map(|from| Track {
                from,
                along: [0.0, 0.0, scales[TIME]],
            }));
        }
    }
    all
}

/// An operation that can be the cause of a warning.
struct Suspect {
    node: usize,
    /// The node of its argument.
    argument: usize,
    /// A function of the argument that must not be zero.
    margin: fn(f64) -> f64,
    /// Whether it can make the slope unbounded where g is continuous.
    can_be_steep: bool,
}

impl Suspect {
    fn new(probe: &Probe, node: usize) -> Option<Suspect> {
        let itself = |argument| argument;
        let (argument, margin, can_be_steep): (usize, fn(f64) -> f64, bool) =
            match probe.formula.nodes[node].term {
                Term::Unary(Unary::Sign, a) => (a, itself, false),
                Term::Unary(Unary::Tan, a) => (a, libm::cos, true),
                Term::Unary(Unary::Sqrt | Unary::Log, a) => (a, itself, true),
                Term::Binary(Binary::Div, _, a) | Term::Binary(Binary::Power, a, _) => {
                    (a, itself, true)
                }
                Term::Whole(a, power) if power < 0 => (a, itself, true),
                _ => return None,
            };
        Some(Suspect {
            node,
            argument,
            margin,
            can_be_steep,
        })
    }

    /// The margin at the point that was computed last.
    fn margin(&self, probe: &Probe) -> f64 {
        (self.margin)(probe.values[self.argument])
    }
}

/// Searches for one warning for each operation that can be the cause.
pub(super) fn found(probe: &mut Probe) -> Vec<Found> {
    let nodes = probe.formula.nodes.len();
    let suspects: Vec<Suspect> = (0..nodes)
        .filter_map(|node| Suspect::new(probe, node))
        .collect();
    let mut all: Vec<Option<String>> = vec![None; nodes];
    let mut no_value: Vec<Option<String>> = vec![None; nodes];
    // Whether there is no value at neighbouring samples with different arguments: on a whole side.
    let mut is_wide = vec![false; nodes];
    let mut work = WORK;
    for track in tracks(probe) {
        let mut margins: Vec<Vec<f64>> = vec![Vec::with_capacity(INTERVALS + 1); suspects.len()];
        let mut largest = 0.0f64;
        let mut before = None;
        for i in 0..=INTERVALS {
            let point = track.point(i as f64 / INTERVALS as f64);
            let g = probe.at(point);
            let node = probe
                .values
                .iter()
                .position(|value| !value.is_finite())
                .filter(|_| !g.is_finite());
            match node {
                None => largest = largest.max(g.abs()),
                Some(node) if no_value[node].is_none() => {
                    let what = if probe.values[node].is_nan() {
                        "has no value"
                    } else {
                        "is infinite"
                    };
                    no_value[node] = Some(format!("the force {what} at {}", probe.words(point)));
                }
                Some(_) => {}
            }
            for (margins, suspect) in margins.iter_mut().zip(&suspects) {
                let margin = suspect.margin(probe);
                let is_same = node == Some(suspect.node) && before == node;
                is_wide[suspect.node] |=
                    is_same && margins.last().is_some_and(|last| *last != margin);
                margins.push(margin);
            }
            before = node;
        }
        for (margins, suspect) in margins.iter().zip(&suspects) {
            for (low, high) in zeros(margins) {
                if all[suspect.node].is_some() || work < EVALUATIONS * nodes {
                    break;
                }
                work -= EVALUATIONS * nodes;
                let part = refined(probe, &track, suspect, low, high);
                // A margin that only comes nearer to zero than elsewhere is not a cause.
                probe.at(track.point(part));
                let size = margins
                    .iter()
                    .fold(0.0, |size: f64, margin| size.max(margin.abs()));
                if suspect.margin(probe).abs() > NEAR * size {
                    continue;
                }
                all[suspect.node] = beside(probe, &track, part, largest, suspect.can_be_steep);
            }
        }
    }
    // What has no value on a whole side is not reported as what happens at the edge of it.
    let told = |(node, (beside, no_value)): (usize, (Option<String>, Option<String>))| {
        Some((
            node,
            if is_wide[node] {
                no_value.or(beside)
            } else {
                beside.or(no_value)
            }?,
        ))
    };
    all.into_iter()
        .zip(no_value)
        .enumerate()
        .filter_map(told)
        .collect()
}

/// The intervals, as parts of a line, in which the margin crosses or may touch zero.
fn zeros(margins: &[f64]) -> Vec<(f64, f64)> {
    let part = |i: usize| i as f64 / INTERVALS as f64;
    let mut all = Vec::new();
    for (i, pair) in margins.windows(2).enumerate() {
        if pair[0] * pair[1] < 0.0 {
            all.push((part(i), part(i + 1)));
        }
    }
    for (i, three) in margins.windows(3).enumerate() {
        let [before, here, after] = [three[0], three[1], three[2]];
        if here == 0.0 && before != 0.0 && after != 0.0 {
            all.push((part(i + 1), part(i + 1)));
        } else if here * before > 0.0
            && here * after > 0.0
            && here.abs() < before.abs()
            && here.abs() <= after.abs()
        {
            all.push((part(i), part(i + 2)));
        }
    }
    all
}

/// The zero of the margin in an interval, or where it is nearest to zero if it does not cross.
fn refined(
    probe: &mut Probe,
    track: &Track,
    suspect: &Suspect,
    mut low: f64,
    mut high: f64,
) -> f64 {
    let mut at = |part: f64| {
        probe.at(track.point(part));
        suspect.margin(probe)
    };
    let (first, last) = (at(low), at(high));
    let crosses = first * last < 0.0;
    for _ in 0..HALVINGS {
        let width = high - low;
        if crosses {
            let middle = low + 0.5 * width;
            let margin = at(middle);
            if margin == 0.0 {
                return middle;
            }
            *if (margin > 0.0) == (first > 0.0) {
                &mut low
            } else {
                &mut high
            } = middle;
        } else {
            let (left, right) = (low + 0.4 * width, high - 0.4 * width);
            if at(left).abs() <= at(right).abs() {
                high = right;
            } else {
                low = left;
            }
        }
    }
    low + 0.5 * (high - low)
}

/// What g does on both sides of a point of a line, if it does not become equal there at a bounded
/// slope. `largest` is the largest |g| that was found on the line.
fn beside(
    probe: &mut Probe,
    track: &Track,
    part: f64,
    largest: f64,
    can_be_steep: bool,
) -> Option<String> {
    let place = probe.words(track.point(part));
    let mut g = |distance: f64| probe.at(track.point(part + distance));
    let sides = DISTANCES.map(|distance| [g(-distance), g(distance)]);
    let gaps = sides.map(|[left, right]| (right - left).abs());
    let slopes = DISTANCES.map(|distance| {
        [-1.0, 1.0].map(|side| (g(2.0 * side * distance) - g(side * distance)).abs() / distance)
    });
    let grows = |side: usize| {
        slopes[1][side] > 2.0 * slopes[0][side] && slopes[2][side] > 2.0 * slopes[1][side]
    };
    let steep = |side: usize| grows(side) && slopes[2][side] > 1e3 * largest;
    let unbounded = |side: usize| steep(side) && sides[2][side].abs() > 10.0 * sides[1][side].abs();
    if [0, 1].into_iter().any(unbounded) {
        return Some(format!("the force grows without bound at {place}"));
    }
    if gaps[2] > 0.5 * gaps[0]
        && gaps[2] > 0.5 * gaps[1]
        && gaps[2] > 1e-9 * largest
        && gaps[2].is_finite()
    {
        return Some(format!("the force jumps by {} at {place}", short(gaps[2])));
    }
    (can_be_steep && [0, 1].into_iter().any(steep))
        .then(|| format!("the slope of the force is unbounded at {place}"))
}
