//! A slip step under a user-defined force g(x, x', t).
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
//! correct      g at the drawn end, and in the middle of the quintic between both ends; then
//!              x  += (h/6m) (S(h) (g0 - g) + 4 S(h/2) (g_m - g)),
//!              x' += (h/6m) (S'(h) (g0 - g) + 4 S'(h/2) (g_m - g) + (g1 - g))
//! ```
//!
//! S is the response of x to a unit of x', and the sums are Simpson's rule for int S(h - s) (g(s) -
//! g) ds/m and for its derivative. What a step may leave is measured by friction: a force along the
//! whole way that is a share of f_s, so that a slip of any number of steps loses its energy to
//! friction and not to the steps. The length follows from the state at the start alone, so
//! that it does not depend on the noise that is then drawn, and the law of what is drawn is not
//! changed. In the middle of a step, the noise moves x and x' off the quintic by a random amount of
//! mean zero. The error of g by this is of order 3/2 in a step, and of order 2 in the law of the
//! path.

use super::super::law::{Scene, SlipPoint, SlipStep, middle};
use super::super::work::{Resolved, Unresolved};
use super::path::Path;
use super::slip::Slip;
use crate::model::Sign;

/// g along one slip.
pub(super) struct UserForceSteps {
    /// g at the start of the step.
    here: f64,
    /// The constant that stands for g in the step.
    pub push: f64,
    /// How much more than this constant moves x, as the trial of the step has it.
    more: f64,
    /// g at the end of the step, as its trial has it.
    end: f64,
    /// b at the start of the step.
    start_force: f64,
    /// How many times the usual step was halved last.
    halvings: usize,
    /// Whether the next step may be longer than the last one.
    may_grow: bool,
}

/// The state at the start of a step.
struct TrialStart {
    direction: Sign,
    x: f64,
    v: f64,
    acceleration: f64,
    time: f64,
}

/// g on the way that a step would take without noise, and on the ways that noise may make of it.
#[derive(Clone, Copy)]
struct Trial {
    /// The means of g that move x' and x.
    means: [f64; 2],
    /// g at the end.
    end: f64,
    /// What the step may leave of the mean of g, a force.
    error: f64,
    /// How much the last change of a mean of g exceeds half of the change before it, on any way; a
    /// force.
    unsettled: f64,
    /// How much noise usually bends g, a force.
    bend: f64,
}

/// The means of g over a step that move x' and x: of g, and of 2 g (h - s)/h. By Simpson's rule,
/// from g at the start, in the middle and at the end.
#[inline(always)]
fn simpson(start: f64, [middle, end]: [f64; 2]) -> [f64; 2] {
    [
        (start + 4.0 * middle + end) / 6.0,
        (start + 2.0 * middle) / 3.0,
    ]
}

/// The same by Boole's rule, which also has g after a quarter and after three of them.
#[inline(always)]
fn boole(start: f64, [first, middle, third, end]: [f64; 4]) -> [f64; 2] {
    let for_v = (7.0 * start + 32.0 * first + 12.0 * middle + 32.0 * third + 7.0 * end) / 90.0;
    [
        for_v,
        (14.0 * start + 48.0 * first + 12.0 * middle + 16.0 * third) / 90.0,
    ]
}

/// The larger of the differences of both means.
#[inline(always)]
fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    largest((a[0] - b[0]).abs(), (a[1] - b[1]).abs())
}

/// The value a quarter of the way from the first of two ends that are h apart to the second, by the
/// cubic with these slopes.
#[inline(always)]
fn quarter(h: f64, [y0, y1]: [f64; 2], [d0, d1]: [f64; 2]) -> f64 {
    (27.0 * y0 + 5.0 * y1) / 32.0 + h * (9.0 * d0 - 3.0 * d1) / 64.0
}

impl TrialStart {
    /// The trial of a step of length `h`, at whose end the noise may take x and x' this far off.
    /// The linear forces are constant in it.
    #[inline(always)]
    fn trial(&self, scene: &Scene, here: f64, h: f64, [dx, dv]: [f64; 2]) -> Trial {
        let (mut x, mut v, mut t) = ([0.0; 8], [0.0; 8], [self.time + 0.5 * h; 8]);
        for end in [3, 4, 5] {
            t[end] = self.time + h;
        }
        (t[6], t[7]) = (self.time + 0.25 * h, self.time + 0.75 * h);
        let (mut g, mut means, mut changes) = (
            [here; 8],
            [[here; 2]; WAYS.len()],
            [[0.0; WAYS.len()]; PASSES],
        );
        for change in &mut changes {
            for (way, side) in WAYS.into_iter().enumerate() {
                let [for_v, for_x] = means[way]
                    .map(|mean| self.acceleration + (mean - here) / scene.oscillator.mass);
                let end = [self.x + h * (self.v + 0.5 * h * for_x), self.v + h * for_v];
                let accelerations = [
                    self.acceleration,
                    self.acceleration + (g[3 + way] - here) / scene.oscillator.mass,
                ];
                let middle = middle(h, [self.x, end[0]], [self.v, end[1]], accelerations);
                (x[way], v[way]) = (
                    middle.0 + side * MIDWAY[0] * dx,
                    middle.1 + side * MIDWAY[1] * dv,
                );
                (x[3 + way], v[3 + way]) = (end[0] + side * dx, end[1] + side * dv);
                if way == 0 {
                    let (xs, vs, [a0, a1]) = ([self.x, end[0]], [self.v, end[1]], accelerations);
                    (x[6], v[6]) = (quarter(h, xs, vs), quarter(h, vs, accelerations));
                    (x[7], v[7]) = (
                        quarter(-h, [xs[1], xs[0]], [vs[1], vs[0]]),
                        quarter(-h, [vs[1], vs[0]], [a1, a0]),
                    );
                }
            }
            g = scene.own.at_each(self.direction, &x, &v, &t);
            for way in 0..WAYS.len() {
                let mean = simpson(here, [g[way], g[3 + way]]);
                change[way] = distance(mean, means[way]);
                means[way] = mean;
            }
        }
        let mut error = distance(means[0], boole(here, [g[6], g[0], g[7], g[3]]));
        let mut unsettled = 0.0;
        let [firsts, lasts] = changes;
        for ((first, last), share) in firsts.into_iter().zip(lasts).zip([1.0, USUAL, USUAL]) {
            // What the corrections will leave, if the changes go on becoming smaller like this.
            let ratio = if last < first { last / first } else { 1.0 };
            error += share * last * ratio * ratio;
            unsettled = largest(unsettled, last - 0.5 * first);
        }
        let bends = [0, 1, 2].map(|way| here - 2.0 * g[way] + g[3 + way]);
        let bend = USUAL * largest((bends[1] - bends[0]).abs(), (bends[2] - bends[0]).abs());
        Trial {
            means: means[0],
            end: g[3],
            error,
            unsettled,
            bend,
        }
    }
}

/// The larger of two numbers; not a number if one of them is not.
#[inline(always)]
fn largest(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

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
    fn spread(&self) -> [f64; 2] {
        let [.., vv, _, xx] = self.transition.covariance;
        [AROUND * xx.sqrt(), AROUND * vv.sqrt()]
    }
}

impl UserForceSteps {
    /// g where a path is that slips in this direction; none if there is no g.
    #[inline(always)]
    pub fn new(scene: &Scene, direction: Sign, time: f64, path: &Path<f64>) -> Option<Self> {
        scene.own.is_some().then(|| {
            let here = scene
                .own
                .at(Some(direction), path.displacement, path.motion, time);
            UserForceSteps {
                here,
                push: here,
                more: 0.0,
                end: here,
                start_force: path.force,
                halvings: 0,
                may_grow: false,
            }
        })
    }

    /// The longest step from here on in which g is resolved, when this much of the macro step
    /// remains, and whether it ends with the macro step. A path is given up where the shortest step
    /// is too long by far.
    #[inline(always)]
    pub fn step_towards<'s>(
        &mut self,
        slip: &'s Slip<'_>,
        remaining: f64,
        path: &mut Path<f64>,
        partial: &'s mut SlipStep,
    ) -> Resolved<(&'s SlipStep, bool)> {
        let Scene {
            oscillator,
            friction,
            ..
        } = &slip.noisy.scene;
        let finest = slip.noisy.halved.len() - 1;
        let mut halvings = if self.may_grow {
            self.halvings.saturating_sub(1)
        } else {
            self.halvings
        };
        // Halvings that leave more than what remains of the macro step change nothing.
        while halvings < finest && slip.noisy.halved[halvings + 1].length() >= remaining {
            halvings += 1;
        }
        let acceleration = (path.force - slip.friction()) / oscillator.mass;
        let (x, v, time) = (path.displacement, path.motion, slip.time(path));
        let start = TrialStart {
            direction: slip.direction,
            x,
            v,
            acceleration,
            time,
        };
        let forces = friction.static_force + path.force.abs() + self.here.abs();
        let most_error = slip.noisy.rules.most_error * friction.static_force.max(SHARE * forces);
        loop {
            path.work.spend()?;
            let step = &slip.noisy.halved[halvings];
            let trial = start.trial(
                &slip.noisy.scene,
                self.here,
                step.length().min(remaining),
                step.spread(),
            );
            let is_resolved = trial.error <= most_error
                && trial.unsettled <= most_error
                && trial.bend <= slip.noisy.rules.most_bend * forces;
            if is_resolved || halvings == finest {
                if trial.error.is_nan() {
                    return Err(Unresolved::NoNumber);
                }
                if trial.error > forces + trial.end.abs() {
                    return Err(Unresolved::TooFine);
                }
                self.start_from(&trial, path.force);
                self.may_grow = is_resolved && trial.error <= GROWTH * most_error;
                break;
            }
            halvings += 1;
        }
        self.halvings = halvings;
        Ok(slip.at_most(&slip.noisy.halved[halvings], remaining, partial))
    }

    /// Takes over what the trial of a step found, where b at its start is this.
    #[inline(always)]
    fn start_from(&mut self, trial: &Trial, start_force: f64) {
        let [for_v, for_x] = trial.means;
        (self.push, self.more, self.end, self.start_force) =
            (for_v, for_x - for_v, trial.end, start_force);
    }

    /// Corrects the end of a step that was drawn with the constant for g, and b there.
    #[inline(always)]
    pub fn correct(
        &mut self,
        slip: &Slip<'_>,
        step: &SlipStep,
        start: SlipPoint,
        path: &mut Path<f64>,
    ) {
        let scene = &slip.noisy.scene;
        let (h, time, body) = (step.length(), slip.time(path), &scene.oscillator);
        let (friction, unit) = (slip.friction(), h / (6.0 * body.mass));
        // S and S' after the whole step, and after half of it by the cubic between both ends.
        let (whole, slope) = (step.transition.x[1], step.transition.v[1]);
        let (half, half_slope) = (
            0.5 * whole + 0.125 * h * (1.0 - slope),
            1.5 * whole / h - 0.25 * (1.0 + slope),
        );
        let (drawn, mut end) = ((path.displacement, path.motion, path.force), self.end);
        let (mut dx, mut dv) = (3.0 * h * unit * self.more, 0.0);
        for _ in 0..CORRECTIONS {
            let (x1, v1) = (drawn.0 + dx, drawn.1 + dv);
            let force = drawn.2 - body.stiffness * dx - 2.0 * body.damping * dv + end;
            let accelerations =
                [self.start_force - friction, force - friction].map(|force| force / body.mass);
            let (xm, vm) = middle(h, [start.x, x1], [start.v, v1], accelerations);
            let (mut x, mut v, mut t) = ([xm; 8], [vm; 8], [time - 0.5 * h; 8]);
            (x[1], v[1], t[1]) = (x1, v1, time);
            let middle;
            [middle, end, ..] = scene.own.at_each(slip.direction, &x, &v, &t);
            let [on_start, on_middle, on_end] =
                [self.here, middle, end].map(|g| unit * (g - self.push));
            dx = whole * on_start + 4.0 * half * on_middle;
            dv = slope * on_start + 4.0 * half_slope * on_middle + on_end;
        }
        (path.displacement, path.motion) = (drawn.0 + dx, drawn.1 + dv);
        path.force = drawn.2 - body.stiffness * dx - 2.0 * body.damping * dv + end;
        self.here = end;
    }
}

/// The share of the forces that takes the place of f_s in scenes with hardly any friction.
const SHARE: f64 = 3e-4;

/// A step twice as long is tried if the error of the last one was below this share of the largest
/// that is allowed: twice the length makes the error 16 times as large.
const GROWTH: f64 = 1.0 / 32.0;

/// How often the end of a step is corrected. Each correction makes its error smaller by the share
/// of g in the motion of a step.
const CORRECTIONS: usize = 2;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::tests::paper;
    use crate::model::{Expression, Force};
    use crate::noise::AddressedDraws;
    use crate::scheme::Timeline;
    use crate::scheme::event_driven::law::{
        DEFAULT_TOLERANCE, MacroStep, StepRules, force, tests::mean_and_error,
    };
    use crate::scheme::event_driven::noisy::Noisy;
    use crate::scheme::event_driven::work::WorkLeft;

    const DURATION: f64 = 2.0;
    /// Parts of the duration on which the noise is drawn.
    const PARTS: usize = 256;

    /// m = K = 1 and K beta rho = 1.5, without friction and harmonics, under a force that depends
    /// on x and x'.
    fn scene() -> Noisy {
        let mut model = paper(0.25, 1.0);
        model.temperature.harmonics.clear();
        (model.friction.static_force, model.friction.dynamic_force) = (0.0, 0.0);
        model.initial_displacement = 2.0;
        let law = Expression::parse("-0.3*x^3 + 0.4*(1 - x^2)*xdot", &[]).expect("an expression");
        model.force = Some(Force::new(law));
        let timeline = Timeline {
            end: DURATION,
            output_step: DURATION,
            period: None,
            after: 0.0,
        };
        Noisy::new(&model, &timeline, &StepRules::new(DEFAULT_TOLERANCE))
    }

    /// What the noise of a path adds to x, x' and n over each part.
    fn noise(noisy: &Noisy, part: &SlipStep, path: u64) -> Vec<SlipPoint> {
        let mut draws = AddressedDraws::new(1, path);
        let sd = part.transition.covariance[0].sqrt();
        let zero = SlipPoint {
            x: 0.0,
            v: 0.0,
            n: 0.0,
        };
        assert!(noisy.scene.diffusion > 0.0);
        (0..PARTS)
            .map(|_| {
                part.transition
                    .drawn(zero, sd * draws.normal(), draws.normal_pair())
            })
            .collect()
    }

    /// x and x' after this number of equal steps under this noise.
    fn end(noisy: &Noisy, part: &SlipStep, noise: &[SlipPoint], steps: usize) -> [f64; 2] {
        let scene = &noisy.scene;
        let macro_step = MacroStep::new(scene, &noisy.propagation.grid, 0);
        let slip = Slip {
            noisy,
            macro_step: &macro_step,
            direction: Sign::Positive,
            end_noise: 0.0,
        };
        let step = SlipStep::new(&noisy.oscillator, 0, DURATION / steps as f64);
        let mut path = Path::new(scene, 0.0, AddressedDraws::new(1, 0), WorkLeft::new(0));
        let mut own = UserForceSteps::new(scene, slip.direction, 0.0, &path).expect("a force");
        for noise in noise.chunks(PARTS / steps) {
            let start = SlipPoint {
                x: path.displacement,
                v: path.motion,
                n: path.noise,
            };
            let (direction, time) = (slip.direction, path.after);
            let from = TrialStart {
                direction,
                x: start.x,
                v: start.v,
                acceleration: path.force,
                time,
            };
            let trial = from.trial(scene, own.here, step.length(), step.spread());
            own.start_from(&trial, path.force);
            let mut drawn = SlipPoint {
                x: 0.0,
                v: 0.0,
                n: 0.0,
            };
            for more in noise {
                let mean = part.transition.free(drawn, 0.0);
                drawn = SlipPoint {
                    x: mean.x + more.x,
                    v: mean.v + more.v,
                    n: mean.n + more.n,
                };
            }
            let mean = step.mean(start, &mut [], -own.push);
            let drawn = SlipPoint {
                x: mean.x + drawn.x,
                v: mean.v + drawn.v,
                n: mean.n + drawn.n,
            };
            path.after += step.length();
            (path.displacement, path.motion, path.noise) = (drawn.x, drawn.v, drawn.n);
            path.force = force(&scene.oscillator, 0.0, drawn);
            own.correct(&slip, &step, start, &mut path);
        }
        [path.displacement, path.motion]
    }

    /// The steps are of order 2 in law or better: on the same noise, the means of x, x', x^2 and
    /// x'^2 of 4000 paths are off by less than a quarter of as much when the step is halved, within
    /// 4 standard errors.
    #[test]
    fn the_steps_of_a_slip_are_of_order_two_in_law() {
        let noisy = scene();
        let part = SlipStep::new(&noisy.oscillator, 0, DURATION / PARTS as f64);
        let noises: Vec<_> = (0..4000).map(|path| noise(&noisy, &part, path)).collect();
        let ends = |steps| -> Vec<_> {
            noises
                .iter()
                .map(|noise| end(&noisy, &part, noise, steps))
                .collect()
        };
        let exact = ends(PARTS);
        let errors = |steps| {
            let pairs: Vec<_> = ends(steps).into_iter().zip(&exact).collect();
            let of = |of: fn([f64; 2]) -> f64| {
                pairs
                    .iter()
                    .map(|(a, b)| of(*a) - of(**b))
                    .collect::<Vec<_>>()
            };
            [
                of(|[x, _]| x),
                of(|[_, v]| v),
                of(|[x, _]| x * x),
                of(|[_, v]| v * v),
            ]
            .map(|errors| mean_and_error(&errors))
        };
        let (coarse, fine) = (errors(8), errors(16));
        println!("{coarse:?}\n{fine:?}");
        for ((coarse, _), (fine, error)) in coarse.into_iter().zip(fine) {
            assert!(fine.abs() < coarse.abs() / 4.0 + 4.0 * error);
        }
        // The largest error is seen clearly, so that a wrong order would be seen too.
        assert!(
            coarse
                .into_iter()
                .any(|(coarse, error)| coarse.abs() > 10.0 * error)
        );
    }
}
