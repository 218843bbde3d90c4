//! A static phase inside a cell: whether and when b leaves the corridor |b| <= f_s, given n at the
//! end of the cell.
//!
//! A piece of the bridge between two known values of n
//!
//! - is *clear* if neither threshold can be met: the chance, after the threshold has been moved
//!   towards the noise by all that it bends, is below exp(-35);
//! - is *decided* by [`StickStep::exit`] if it is short enough: h <= width^2/(8 s^2), so that the
//!   chance that one bridge meets both thresholds is below 2 exp(-16), and |c| h^2/8 <= kappa s
//!   sqrt(h) for each threshold in reach, kappa the stick share of the tolerance;
//! - otherwise n is drawn in the middle, and the halves are looked at from the left.

use super::cells::Cell;
use super::scene::Scene;
use super::stick_step::{FAR_EXPONENT, StickStep};
use super::watch::{StickPiece, Watch, look_at_stick};
use super::work::{Unresolved, Work};
use crate::model::Sign;
use crate::noise::{AddressedDraws, bridge_middle};

/// The width rule: pieces of at most width^2 / (this s^2) are decided.
const WIDTH_RULE: f64 = 8.0;

/// Halvings of a piece; it is decided then whatever its bend.
const DEPTH: usize = 60;

/// What decides pieces of sticks.
#[derive(Clone, Debug)]
pub struct Corridor {
    /// The longest piece by the width rule.
    widest: f64,
    /// (8 kappa s)^2, to be held against |c|^2 h^3.
    most_bend: f64,
}

/// What is known of a stick at one time.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Time after the start of the cell.
    after: f64,
    noise: f64,
    /// b.
    force: f64,
    /// B''.
    curvature: f64,
}

/// One threshold over a piece.
struct Side {
    /// The largest |U'' - theta^2 U| at its ends, U the threshold as n sees it.
    bend: f64,
    /// Whether the bridge may meet it.
    is_near: bool,
}

impl Corridor {
    pub fn new(scene: &Scene, kappa: f64) -> Self {
        let (width, s) = (2.0 * scene.friction.static_force, scene.diffusion);
        Corridor { widest: width * width / (WIDTH_RULE * s * s), most_bend: (8.0 * kappa * s) * (8.0 * kappa * s) }
    }

    /// From (time after the start of the cell, n, b) to the end of the cell, where n is `end_noise`:
    /// the exit, as its time and side, if there is one.
    #[inline(always)]
    pub fn exit(
        &self,
        scene: &Scene,
        cell: &Cell,
        displacement: f64,
        (after, noise, force): (f64, f64, f64),
        end_noise: f64,
        draws: &mut AddressedDraws,
        work: &mut Work,
        watch: &mut impl Watch,
    ) -> Result<Option<(f64, Sign)>, Unresolved> {
        let spring = scene.oscillator.stiffness * displacement;
        let node = |after: f64, noise: f64| {
            let forcing = cell.forcing(after);
            Node { after, noise, force: forcing.value - spring + noise, curvature: forcing.curvature }
        };
        let piece = |left: &Node, right: &Node, exit| StickPiece {
            after: (left.after, right.after),
            noise: (left.noise, right.noise),
            force: (left.force, right.force),
            displacement,
            exit,
        };
        let mut left = Node { force, ..node(after, noise) };
        let last = node(cell.length, end_noise);
        let (mut pending, mut top) = ([last; DEPTH + 1], 0);
        loop {
            work.spend()?;
            let right = pending[top];
            let h = right.after - left.after;
            let [up, down] = [1.0, -1.0].map(|side| self.side(scene, side, h, &left, &right));
            if up.is_near || down.is_near {
                let reach = |side: Side| if side.is_near { side.bend } else { 0.0 };
                let bend = reach(up).max(reach(down));
                if (h > self.widest || bend * bend * h * h * h > self.most_bend) && top < DEPTH {
                    let (weight, sd) = bridge_middle(scene.relaxation_rate, scene.diffusion, h);
                    let middle = weight * (left.noise + right.noise) + sd * draws.normal();
                    top += 1;
                    pending[top] = node(left.after + 0.5 * h, middle);
                    continue;
                }
                let step = StickStep::new(scene, h);
                let bend = -0.5 * (left.curvature + right.curvature);
                let mean_noise = 0.5 * (left.noise + right.noise);
                let f_s = scene.friction.static_force;
                if let Some((sign, passed)) =
                    step.exit(scene, f_s, (left.force, right.force), bend, mean_noise, draws)
                {
                    let after = left.after + passed;
                    let force = sign.value() * f_s;
                    let noise = force - cell.forcing(after).value + spring;
                    let right = Node { after, noise, force, curvature: 0.0 };
                    look_at_stick(watch, scene, cell, piece(&left, &right, Some(sign)));
                    return Ok(Some((after, sign)));
                }
            }
            look_at_stick(watch, scene, cell, piece(&left, &right, None));
            if top == 0 {
                return Ok(None);
            }
            left = right;
            top -= 1;
        }
    }

    #[inline(always)]
    fn side(&self, scene: &Scene, side: f64, h: f64, left: &Node, right: &Node) -> Side {
        let (f_s, theta) = (scene.friction.static_force, scene.relaxation_rate);
        let (d0, d1) = (f_s - side * left.force, f_s - side * right.force);
        let bend = |node: &Node, d: f64| (side * node.curvature + theta * theta * (side * node.noise + d)).abs();
        let bend = bend(left, d0).max(bend(right, d1));
        let shift = 0.125 * bend * h * h;
        let y = theta * h;
        let variance = scene.diffusion * scene.diffusion * h * (1.0 + SINH_BOUND * y * y);
        let (d0, d1) = (d0 - shift, d1 - shift);
        let is_far = d0 > 0.0 && d1 > 0.0 && 2.0 * d0 * d1 >= FAR_EXPONENT * variance;
        Side { bend, is_near: !is_far }
    }
}

/// sinh y <= y (1 + this y^2) for 0 <= y <= 1.
const SINH_BOUND: f64 = 0.1753;
