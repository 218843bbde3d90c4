//! A slip step under a user-defined force g(x, x', t), for one path or for several in lanes.
//!
//! All other forces are linear, and their step is exact ([`SlipStep`]). g stands in it as a
//! constant, where eps f_d stands, and the end of the step is corrected for what g does in the
//! step:
//!
//! ```text
//! trial        the step without noise, and where noise takes it six standard deviations off to
//!              either side, by two evaluations of g in the middle and at the end of each way.
//!              The step is halved until they converge, Simpson's and Boole's rule for the impulse
//!              of g agree, and noise bends g little
//! draw         the linear step with the mean of g of the trial for g
//! correct      g at the drawn end, and at the quarters of the quintic between both ends; then
//!              x  += (h/90m) (7 S(h) (g0 - g) + 32 S(3h/4) (g1 - g) + 12 S(h/2) (g2 - g)
//!                             + 32 S(h/4) (g3 - g)),
//!              x' += the same with S' for S, and (h/90m) 7 (g4 - g)
//! ```
//!
//! S is the response of x to a unit of x', and the sums are Boole's rule for int S(h - s) (g(s) -
//! g) ds/m and for its derivative. What a step may leave is measured by friction: a force along the
//! whole way that is a share of f_s, so that a slip of any number of steps loses its energy to
//! friction and not to the steps. The length follows from the state at the start alone, so
//! that it does not depend on the noise that is then drawn, and the law of what is drawn is not
//! changed. Inside a step, the noise moves x and x' off the quintic by a random amount of
//! mean zero. The error of g by this is of order 3/2 in a step, and of order 2 in the law of the
//! path.

use super::first_stop::middle;
use super::scene::Scene;
use super::slip_step::{SlipPoint, SlipStep};
use super::slip_transition::SlipTransition;
use super::step_rules::StepRules;
use crate::lanes::Lanes;
use crate::model::Sign;

/// The start of a step.
#[derive(Clone, Copy)]
pub struct ForcedStart<L = f64> {
    pub direction: Sign,
    pub x: L,
    pub v: L,
    /// b, and x'' with it.
    pub force: L,
    pub acceleration: L,
    pub time: L,
    /// g.
    pub here: L,
}

/// g on the way that a step would take without noise, and on the ways that noise may make of it.
#[derive(Clone, Copy)]
pub struct Trial<L = f64> {
    /// The means of g that move x' and x. The first one is the constant that stands for g.
    pub means: [L; 2],
    /// g at the end.
    pub end: L,
    /// What the step may leave of the mean of g, a force.
    pub error: L,
    /// How much the last change of a mean of g exceeds half of the change before it, on any way; a
    /// force.
    pub unsettled: L,
    /// How much noise usually bends g, a force.
    pub bend: L,
}

/// What a step may leave of g.
#[derive(Clone, Copy)]
pub struct ForceLimits<L = f64> {
    /// The sum of the sizes of the forces at the start.
    pub forces: L,
    /// The most that `error` and `unsettled` of a [`Trial`] may be, and that its `bend` may be.
    pub error: L,
    bend: L,
}

/// The end of a step.
#[derive(Clone, Copy)]
pub struct ForcedEnd<L = f64> {
    pub x: L,
    pub v: L,
    /// b, with g.
    pub force: L,
    /// g.
    pub own: L,
}

/// The means of g over a step that move x' and x: of g, and of 2 g (h - s)/h. By Simpson's rule,
/// from g at the start, in the middle and at the end.
#[inline(always)]
fn simpson<L: Lanes>(start: L, [middle, end]: [L; 2]) -> [L; 2] {
    [
        (start + middle * 4.0 + end) / L::splat(6.0),
        (start + middle * 2.0) / L::splat(3.0),
    ]
}

/// The same by Boole's rule, which also has g after a quarter and after three of them.
#[inline(always)]
fn boole<L: Lanes>(start: L, [first, middle, third, end]: [L; 4]) -> [L; 2] {
    let for_v = start * 7.0 + first * 32.0 + middle * 12.0 + third * 32.0 + end * 7.0;
    let for_x = start * 14.0 + first * 48.0 + middle * 12.0 + third * 16.0;
    [for_v / L::splat(90.0), for_x / L::splat(90.0)]
}

/// The larger of the differences of both means.
#[inline(always)]
fn distance<L: Lanes>(a: [L; 2], b: [L; 2]) -> L {
    largest((a[0] - b[0]).abs(), (a[1] - b[1]).abs())
}

/// The larger of two numbers; not a number if one of them is not.
#[inline(always)]
fn largest<L: Lanes>(a: L, b: L) -> L {
    L::select(L::or(a.gt(b), L::not(a.ge(a))), a, b)
}

/// last/first, at most 1.
#[inline(always)]
fn share<L: Lanes>(last: L, first: L) -> L {
    L::select(last.lt(first), last / first, L::splat(1.0))
}

/// x and x' a quarter of the way from the first of two ends that are h apart to the second, on the
/// quintic between them.
#[inline(always)]
fn quarter<L: Lanes>(h: L, [x0, x1]: [L; 2], [v0, v1]: [L; 2], [a0, a1]: [L; 2]) -> (L, L) {
    let bend = h * (1.0 / 2048.0) * (a0 * 27.0 + a1 * 9.0);
    let x = (x0 * 459.0 + x1 * 53.0) * (1.0 / 512.0);
    let v = (x1 - x0) / h * (135.0 / 128.0) + (v0 * 81.0 - v1 * 95.0) * (1.0 / 256.0);
    (
        x + h * ((v0 * 189.0 - v1 * 39.0) * (1.0 / 1024.0) + bend),
        v + h * (1.0 / 512.0) * (a0 * 27.0 + a1 * 21.0),
    )
}

/// x and x' a quarter, half and three quarters of the way.
#[inline(always)]
fn inside<L: Lanes>(h: L, xs: [L; 2], vs: [L; 2], accelerations: [L; 2]) -> [(L, L); 3] {
    let [mut back_x, mut back_v, mut back_a] = [xs, vs, accelerations];
    back_x.reverse();
    back_v.reverse();
    back_a.reverse();
    [
        quarter(h, xs, vs, accelerations),
        middle(h, xs, vs, accelerations),
        quarter(-h, back_x, back_v, back_a),
    ]
}

impl<L: Lanes> Trial<L> {
    /// The trial of a step in which g stays as it is.
    pub fn none(here: L) -> Self {
        let zero = L::splat(0.0);
        Trial {
            means: [here; 2],
            end: here,
            error: zero,
            unsettled: zero,
            bend: zero,
        }
    }

    /// Whether g is resolved in the step.
    #[inline(always)]
    pub fn is_resolved(&self, limits: &ForceLimits<L>) -> L::Mask {
        let (error, unsettled) = (self.error.le(limits.error), self.unsettled.le(limits.error));
        L::and(L::and(error, unsettled), self.bend.le(limits.bend))
    }
}

impl<L: Lanes> ForcedStart<L> {
    /// What a step from here may leave of g.
    #[inline(always)]
    pub fn limits(&self, scene: &Scene, rules: &StepRules) -> ForceLimits<L> {
        let f_s = L::splat(scene.friction.static_force);
        let forces = f_s + self.force.abs() + self.here.abs();
        ForceLimits {
            forces,
            error: f_s.or_at_least(forces * SHARE) * rules.most_error,
            bend: forces * rules.most_bend,
        }
    }

    /// The trial of a step of length `h`, at whose end the noise may take x and x' this far off.
    /// The linear forces are constant in it.
    #[inline(always)]
    pub fn trial(&self, scene: &Scene, h: L, [dx, dv]: [L; 2]) -> Trial<L> {
        let (here, mass) = (self.here, L::splat(scene.oscillator.mass));
        let mut at = [[self.x; 8], [self.v; 8], [self.time + h * 0.5; 8]];
        at[2][3..6].fill(self.time + h);
        (at[2][6], at[2][7]) = (self.time + h * 0.25, self.time + h * 0.75);
        let (mut g, mut means, mut changes) = (
            [here; 8],
            [[here; 2]; WAYS.len()],
            [[L::splat(0.0); WAYS.len()]; PASSES],
        );
        for (pass, change) in changes.iter_mut().enumerate() {
            let points = if pass + 1 == PASSES { 8 } else { 6 };
            for (way, side) in WAYS.into_iter().enumerate() {
                let accelerations = [
                    self.acceleration,
                    self.acceleration + (g[3 + way] - here) / mass,
                ];
                let for_v = self.acceleration + (means[way][0] - here) / mass;
                let for_x = self.acceleration + (means[way][1] - here) / mass;
                let xs = [self.x, self.x + h * (self.v + h * 0.5 * for_x)];
                let vs = [self.v, self.v + h * for_v];
                let middle = middle(h, xs, vs, accelerations);
                at[0][way] = middle.0 + dx * (side * MIDWAY[0]);
                at[1][way] = middle.1 + dv * (side * MIDWAY[1]);
                (at[0][3 + way], at[1][3 + way]) = (xs[1] + dx * side, vs[1] + dv * side);
                if way == 0 && points == 8 {
                    let [first, _, third] = inside(h, xs, vs, accelerations);
                    (at[0][6], at[1][6]) = first;
                    (at[0][7], at[1][7]) = third;
                }
            }
            let at = at.each_ref().map(|numbers| &numbers[..points]);
            scene.own.at_points(self.direction, at, &mut g);
            for way in 0..WAYS.len() {
                let mean = simpson(here, [g[way], g[3 + way]]);
                change[way] = distance(mean, means[way]);
                means[way] = mean;
            }
        }
        // What Boole's rule leaves, if it is to Simpson's rule as this is to the trapezium.
        let trapezium = [(here + g[3]) * 0.5, here];
        let coarse = distance(trapezium, means[0]);
        let fine = distance(means[0], boole(here, [g[6], g[0], g[7], g[3]]));
        let mut error = fine * share(fine, coarse).or_at_least(L::splat(LEAST_SHARE));
        let mut unsettled = L::splat(0.0);
        let [firsts, lasts] = changes;
        for ((first, last), usual) in firsts.into_iter().zip(lasts).zip([1.0, USUAL, USUAL]) {
            // What the corrections will leave, if the changes go on becoming smaller like this.
            let ratio = share(last, first);
            error = error + last * usual * ratio * ratio;
            unsettled = largest(unsettled, last - first * 0.5);
        }
        let [mut least, mut up, mut down] = [here; 3];
        for (way, bend) in [&mut least, &mut up, &mut down].into_iter().enumerate() {
            *bend = here - g[way] * 2.0 + g[3 + way];
        }
        Trial {
            means: means[0],
            end: g[3],
            error,
            unsettled,
            bend: largest((up - least).abs(), (down - least).abs()) * USUAL,
        }
    }

    /// Corrects the end of a step with this transition, which was drawn with the constant of the
    /// trial for g. `force` is b at this end without g, and `friction` is eps f_d.
    #[inline(always)]
    pub fn corrected(
        &self,
        scene: &Scene,
        transition: &SlipTransition<L>,
        trial: &Trial<L>,
        (drawn, force, time): (SlipPoint<L>, L, L),
        friction: L,
    ) -> ForcedEnd<L> {
        let (h, body, one) = (transition.length, &scene.oscillator, L::splat(1.0));
        let mass = L::splat(body.mass);
        let unit = h / L::splat(90.0 * body.mass);
        // S and S' after the whole step, and after parts of it by the cubic between both ends.
        let (whole, slope) = (transition.x[1], transition.v[1]);
        let part = h * (1.0 / 64.0);
        let after = [
            whole * (54.0 / 64.0) + part * (one * 3.0 - slope * 9.0),
            whole * 0.5 + part * (one * 8.0 - slope * 8.0),
            whole * (10.0 / 64.0) + part * (one * 9.0 - slope * 3.0),
        ];
        let mean = whole / h;
        let slopes = [
            mean * 1.125 + (slope * 3.0 - one * 5.0) * 0.0625,
            mean * 1.5 - (one + slope) * 0.25,
            mean * 1.125 + (one * 3.0 - slope * 5.0) * 0.0625,
        ];
        let [push, for_x] = trial.means;
        let (mut dx, mut dv) = (h * 45.0 * unit * (for_x - push), L::splat(0.0));
        let mut end = trial.end;
        let mut with_g = force - dx * body.stiffness + end;
        for _ in 0..CORRECTIONS {
            let (x1, v1) = (drawn.x + dx, drawn.v + dv);
            let accelerations = [(self.force - friction) / mass, (with_g - friction) / mass];
            let [first, half, third] = inside(h, [self.x, x1], [self.v, v1], accelerations);
            let at = [
                [first.0, half.0, third.0, x1],
                [first.1, half.1, third.1, v1],
                [time - h * 0.75, time - h * 0.5, time - h * 0.25, time],
            ];
            let mut g = [end; 4];
            let at = at.each_ref().map(|numbers| &numbers[..]);
            scene.own.at_points(self.direction, at, &mut g);
            end = g[3];
            let on_start = unit * 7.0 * (self.here - push);
            (dx, dv) = (
                whole * on_start,
                slope * on_start + unit * 7.0 * (end - push),
            );
            for (i, weight) in [32.0, 12.0, 32.0].into_iter().enumerate() {
                let on_point = unit * weight * (g[i] - push);
                (dx, dv) = (dx + after[i] * on_point, dv + slopes[i] * on_point);
            }
            with_g = force - dx * body.stiffness - dv * (2.0 * body.damping) + end;
        }
        ForcedEnd {
            x: drawn.x + dx,
            v: drawn.v + dv,
            force: with_g,
            own: end,
        }
    }
}

/// The error of Boole's rule is not taken to be less than this share of its difference from
/// Simpson's: on a smooth way, the error of Simpson's rule on both halves.
const LEAST_SHARE: f64 = 1.0 / 16.0;

/// Evaluations of g on each way of a trial.
const PASSES: usize = 2;

/// The ways of a trial: without noise, and to both sides of it.
const WAYS: [f64; 3] = [0.0, 1.0, -1.0];

/// The number of standard deviations by which the noise may take the end of a step off its way. The
/// corrections converge even there, so that no draw sends a body far into a stiff stop and out of
/// it with more energy than it had.
const AROUND: f64 = 6.0;

/// What noise usually does, as a share of this.
const USUAL: f64 = 1.0 / 3.0;

/// The share of this by which x and x' are then off in the middle: their regression on the end for
/// motion under an acceleration that is a Brownian motion.
const MIDWAY: [f64; 2] = [0.161_458, 0.3125];

impl SlipStep {
    /// How far the noise may take x and x' at the end of this step.
    #[inline(always)]
    pub fn spread(&self) -> [f64; 2] {
        let [.., vv, _, xx] = self.transition.covariance;
        [AROUND * xx.sqrt(), AROUND * vv.sqrt()]
    }
}

/// How often the end of a step is corrected. Each correction makes its error smaller by the share
/// of g in the motion of a step.
const CORRECTIONS: usize = 2;

/// The share of the forces that takes the place of f_s in scenes with hardly any friction.
const SHARE: f64 = 3e-4;
