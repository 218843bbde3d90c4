//! A stick between two times at which n is known: whether b may leave the stick band |b| <= f_s.
//!
//! The noise between the two is a bridge. A piece of the bridge
//!
//! - is *clear* if it cannot meet a threshold: the probability that it does is below exp(-35), even
//!   after the threshold has been moved towards the noise by the most that it bends;
//! - is *decided* by [`super::stick_step`] if it is short enough;
//! - is otherwise divided: n is drawn in the middle, and the halves are treated from left to right.
//!
//! A piece is short enough if it keeps two rules:
//!
//! ```text
//! width    h <= width (width - |b1 - b0|)/(2 s^2), where b1 is f_s or -f_s if it lies beyond
//! bend     |c| h^2/8 <= kappa s sqrt(h), for each threshold that may be met
//! ```
//!
//! In a piece that keeps the first rule, the bridge meets first one threshold and then the other
//! with a probability below 2 exp(-4), which is taken into account. In the second rule, c is the
//! bend of the threshold ([`super::stick_step`]), and kappa follows from the tolerance.

use super::inside::StickSegment;
use super::scene::Scene;
use super::stick_step::StickEnds;
use crate::lanes::Lanes;

/// exp(-FAR_EXPONENT) is a probability that is negligible even in 1e10 steps.
const FAR_EXPONENT: f64 = 35.0;

/// The number in the width rule.
const WIDTH_RULE: f64 = 2.0;

/// The rules for the pieces of a stick.
#[derive(Clone, Copy, Debug)]
pub struct StickBand {
    /// The longest piece by the width rule for each unit of width - |b1 - b0|, a time over a force.
    widest: f64,
    /// (8 kappa s)^2, the largest |c|^2 h^3 of a piece that is decided.
    most_bend: f64,
}

/// The state of a stick at one time.
#[derive(Clone, Copy, Debug)]
pub struct Node<L = f64> {
    /// Time after the start of the macro step.
    pub after: L,
    pub noise: L,
    /// b.
    pub force: L,
    /// B''.
    pub curvature: L,
}

/// The limit of b, or of -b, at one time: f_s, where friction has no load.
#[derive(Clone, Copy, Debug)]
pub struct Limit<L = f64> {
    pub value: L,
    /// Its second derivative.
    pub curvature: L,
}

/// The limits of b and of -b at one time.
pub type Limits<L = f64> = [Limit<L>; 2];

/// The limit of b where the mask holds, that of -b elsewhere.
#[inline(always)]
pub fn on_side<L: Lanes>(is_up: L::Mask, [up, down]: &Limits<L>) -> Limit<L> {
    Limit {
        value: L::select(is_up, up.value, down.value),
        curvature: L::select(is_up, up.curvature, down.curvature),
    }
}

/// The distance between the limits of b and of -b.
#[inline(always)]
pub fn width<L: Lanes>([up, down]: &Limits<L>) -> L {
    up.value + down.value
}

/// One threshold over a piece.
#[derive(Clone, Copy)]
struct Side<L: Lanes> {
    /// The larger |U'' - theta^2 U| of both ends, where U is the value of n at which the threshold
    /// is met.
    bend: L,
    /// Whether the bridge may meet the threshold.
    is_near: L::Mask,
}

/// Both thresholds over a piece.
#[derive(Clone, Copy)]
pub struct Reach<L: Lanes> {
    /// Whether the bridge may meet at least one of them.
    pub is_near: L::Mask,
    /// Whether the piece is too long to be decided.
    pub is_long: L::Mask,
}

impl StickBand {
    pub fn new(scene: &Scene, kappa: f64) -> Self {
        let s = scene.diffusion;
        let most_bend = (8.0 * kappa * s) * (8.0 * kappa * s);
        StickBand {
            widest: 0.0,
            most_bend,
        }
        .of_width(scene, 2.0 * scene.friction.static_force)
    }

    /// The rules where the stick band is this wide.
    #[inline(always)]
    pub fn of_width(self, scene: &Scene, width: f64) -> Self {
        let s = scene.diffusion;
        StickBand {
            widest: width / (WIDTH_RULE * s * s),
            ..self
        }
    }

    /// Whether the bridge between two nodes may leave the band, and whether the piece is too
    /// long to be decided without halving it. The limits are those at the nodes.
    #[inline(always)]
    pub fn reach<L: Lanes>(
        &self,
        scene: &Scene,
        h: L,
        nodes: (&Node<L>, &Node<L>),
        limits: &[Limits<L>; 2],
    ) -> Reach<L> {
        let (left, right) = nodes;
        let (up, down) = (
            side(scene, 0, h, nodes, limits),
            side(scene, 1, h, nodes, limits),
        );
        let zero = L::splat(0.0);
        let reach = L::select(up.is_near, up.bend, zero).or_at_least(L::select(
            down.is_near,
            down.bend,
            zero,
        ));
        let is_bent = (reach * reach * h * h * h).gt(L::splat(self.most_bend));
        let [first, last] = limits;
        let way = (right
            .force
            .or_at_most(last[0].value)
            .or_at_least(-last[1].value)
            - left.force)
            .abs();
        let is_wide = h.gt(((width(first) + width(last)) * 0.5 - way) * self.widest);
        Reach {
            is_near: L::or(up.is_near, down.is_near),
            is_long: L::or(is_wide, is_bent),
        }
    }
}

/// The piece of a stick between two nodes.
#[inline(always)]
pub fn stick_piece<L: Lanes>(left: &Node<L>, right: &Node<L>, displacement: L) -> StickSegment<L> {
    StickSegment {
        after: (left.after, right.after),
        noise: (left.noise, right.noise),
        force: (left.force, right.force),
        displacement,
    }
}

/// What [`StickStep`] needs to know of a piece between two nodes.
#[inline(always)]
pub fn ends<L: Lanes>(left: &Node<L>, right: &Node<L>, limits: [Limits<L>; 2]) -> StickEnds<L> {
    StickEnds {
        limits,
        start: left.force,
        end: right.force,
        bend: (left.curvature + right.curvature) * -0.5,
        mean_noise: (left.noise + right.noise) * 0.5,
    }
}

/// One threshold (0: upper, 1: lower) over a piece between two nodes.
#[inline(always)]
fn side<L: Lanes>(
    scene: &Scene,
    i: usize,
    h: L,
    (left, right): (&Node<L>, &Node<L>),
    limits: &[Limits<L>; 2],
) -> Side<L> {
    let (theta, side, [first, last]) = (
        scene.relaxation_rate,
        [1.0, -1.0][i],
        [&limits[0][i], &limits[1][i]],
    );
    let (d0, d1) = (
        first.value - left.force * side,
        last.value - right.force * side,
    );
    let (bend0, bend1) = (
        bend(theta, side, left, first, d0),
        bend(theta, side, right, last, d1),
    );
    let bend = bend0.or_at_least(bend1);
    let shift = bend * 0.125 * h * h;
    let y = h * theta;
    let variance = h * (scene.diffusion * scene.diffusion) * (y * y * SINH_BOUND + 1.0);
    let (d0, d1) = (d0 - shift, d1 - shift);
    let zero = L::splat(0.0);
    let is_beyond = (d0 * 2.0 * d1).ge(variance * FAR_EXPONENT);
    let is_far = L::and(L::and(d0.gt(zero), d1.gt(zero)), is_beyond);
    Side {
        bend,
        is_near: L::not(is_far),
    }
}

/// |U'' - theta^2 U| at one end, where `d` is the distance to the threshold.
#[inline(always)]
fn bend<L: Lanes>(theta: f64, side: f64, node: &Node<L>, limit: &Limit<L>, d: L) -> L {
    (node.curvature * side - limit.curvature + (node.noise * side + d) * (theta * theta)).abs()
}

/// sinh y <= y (1 + SINH_BOUND y^2) for 0 <= y <= 1.
const SINH_BOUND: f64 = 0.1753;
