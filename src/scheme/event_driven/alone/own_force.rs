//! A slip step under a force g(x, x', t) of the user's own.
//!
//! All other forces are linear, and their step is exact ([`SlipStep`]). g stands in it as a
//! constant, where eps f_d stands, and the end of the step is corrected for what g does in the
//! step:
//!
//! ```text
//! trial        g on the way of the step without noise, and where noise takes it two standard
//!              deviations off to either side; the step is halved until g bends little on each way,
//!              |g0 - 2 g_m + g1| <= most_bend (forces), and has no kink on the first: it is within
//!              most_kink (forces) of a parabola a quarter of the step before and behind the middle
//! draw         the linear step with g = g_m of the trial
//! correct      g at the drawn end, and in the middle of the quintic between both ends; then
//!              x  += (h/6m) (S(h) (g0 - g) + 4 S(h/2) (g_m - g)),
//!              x' += (h/6m) (S'(h) (g0 - g) + 4 S'(h/2) (g_m - g) + (g1 - g))
//! ```
//!
//! S is the response of x to a unit of x', and the sums are Simpson's rule for int S(h - s) (g(s) -
//! g) ds/m and for its derivative. The length follows from the state at the start alone, so that it
//! does not depend on the noise that is then drawn, and the law of what is drawn is not changed. In
//! the middle of a step, the noise moves x and x' off the quintic by a random amount of mean zero.
//! The error of g by this is of order 3/2 in a step, and of order 2 in the law of the path.

use super::path::Path;
use super::slip::Slip;
use crate::scheme::event_driven::law::first_stop::middle;
use crate::scheme::event_driven::law::scene::Scene;
use crate::scheme::event_driven::law::slip_step::{SlipPoint, SlipStep};
use crate::scheme::event_driven::work::Unresolved;

/// g along one slip.
pub(super) struct OwnForce {
    /// g at the start of the step.
    here: f64,
    /// The constant that stands for g in the step.
    pub push: f64,
    /// g at the end of the step, as its trial has it.
    end: f64,
    /// b at the start of the step.
    start_force: f64,
    /// How many times the usual step was halved last.
    halvings: usize,
}

/// The state at the start of a step.
struct Start {
    x: f64,
    v: f64,
    acceleration: f64,
    time: f64,
}

/// g on the way that a step would take without noise, and on the ways that noise may make of it.
#[derive(Clone, Copy)]
struct Trial {
    middle: f64,
    end: f64,
    /// The largest second difference of g on any of the ways.
    bend: f64,
    /// How far g is from the parabola through the ends and the middle, a quarter before and behind.
    kink: f64,
}

impl Start {
    /// The trial of a step of length `h`, at whose end the noise may take x and x' this far off.
    #[inline(always)]
    fn trial(&self, scene: &Scene, here: f64, h: f64, [dx, dv]: [f64; 2]) -> Trial {
        let (mut x, mut v, mut t) = ([0.0; 8], [0.0; 8], [0.0; 8]);
        let mut put = |i: usize, part: f64, side: f64| {
            let after = part * h;
            let [on_x, on_v] = if part < 1.0 { MIDWAY } else { [1.0, 1.0] };
            x[i] = self.x + after * (self.v + 0.5 * after * self.acceleration) + side * on_x * dx;
            v[i] = self.v + after * self.acceleration + side * on_v * dv;
            t[i] = self.time + after;
        };
        let places =
            [(0.5, 0.0), (1.0, 0.0), (0.25, 0.0), (0.75, 0.0), (0.5, 1.0), (1.0, 1.0), (0.5, -1.0), (1.0, -1.0)];
        for (i, (part, side)) in places.into_iter().enumerate() {
            put(i, part, side);
        }
        let [middle, end, before, behind, up, up_end, down, down_end] = scene.own_forces(&x, &v, &t);
        let bends =
            [(middle, end), (up, up_end), (down, down_end)].map(|(middle, end)| (here - 2.0 * middle + end).abs());
        let parabola = |from: f64, to: f64| 0.375 * from + 0.75 * middle - 0.125 * to;
        let kinks = [(before - parabola(here, end)).abs(), (behind - parabola(end, here)).abs()];
        Trial { middle, end, bend: bends.into_iter().fold(0.0, largest), kink: largest(kinks[0], kinks[1]) }
    }
}

/// The larger of two numbers; not a number if one of them is not.
#[inline(always)]
fn largest(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// The number of standard deviations by which the noise may take the end of a step off its way.
const AROUND: f64 = 2.0;

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

impl OwnForce {
    /// g where a path is; none if there is no g.
    #[inline(always)]
    pub fn new(scene: &Scene, time: f64, path: &Path<f64>) -> Option<Self> {
        scene.has_own_force().then(|| {
            let here = scene.own_force(path.displacement, path.motion, time);
            OwnForce { here, push: here, end: here, start_force: path.force, halvings: 0 }
        })
    }

    /// The longest step from here on which g bends little, when this much of the cell remains, and
    /// whether it ends with the cell.
    #[inline(always)]
    pub fn step_towards<'s>(
        &mut self,
        slip: &'s Slip<'_>,
        remaining: f64,
        path: &mut Path<f64>,
        partial: &'s mut SlipStep,
    ) -> Result<(&'s SlipStep, bool), Unresolved> {
        let Scene { oscillator, friction, .. } = &slip.noisy.scene;
        let finest = slip.noisy.halved.len() - 1;
        let mut halvings = self.halvings.saturating_sub(1);
        // Halvings that leave more than what remains of the cell change nothing.
        while halvings < finest && slip.noisy.halved[halvings + 1].length() >= remaining {
            halvings += 1;
        }
        let acceleration = (path.force - slip.friction()) / oscillator.mass;
        let start = Start { x: path.displacement, v: path.motion, acceleration, time: slip.time(path) };
        let forces = friction.static_force + path.force.abs() + self.here.abs();
        loop {
            path.work.spend()?;
            let step = &slip.noisy.halved[halvings];
            let trial = start.trial(&slip.noisy.scene, self.here, step.length().min(remaining), step.spread());
            let is_straight =
                trial.bend <= slip.noisy.most_bend * forces && trial.kink <= slip.noisy.most_kink * forces;
            if is_straight || halvings == finest {
                (self.push, self.end) = (trial.middle, trial.end);
                break;
            }
            halvings += 1;
        }
        (self.halvings, self.start_force) = (halvings, path.force);
        Ok(slip.at_most(&slip.noisy.halved[halvings], remaining, partial))
    }

    /// Corrects the end of a step that was drawn with the constant for g, and b there.
    #[inline(always)]
    pub fn correct(&mut self, slip: &Slip<'_>, step: &SlipStep, start: SlipPoint, path: &mut Path<f64>) {
        let scene = &slip.noisy.scene;
        let (h, time, body) = (step.length(), slip.time(path), &scene.oscillator);
        let (friction, unit) = (slip.friction(), h / (6.0 * body.mass));
        // S and S' after the whole step, and after half of it by the cubic between both ends.
        let (whole, slope) = (step.transition.x[1], step.transition.v[1]);
        let (half, half_slope) = (0.5 * whole + 0.125 * h * (1.0 - slope), 1.5 * whole / h - 0.25 * (1.0 + slope));
        let (drawn, mut end) = ((path.displacement, path.motion, path.force), self.end);
        let (mut dx, mut dv) = (0.0, 0.0);
        for _ in 0..CORRECTIONS {
            let (x1, v1) = (drawn.0 + dx, drawn.1 + dv);
            let force = drawn.2 - body.stiffness * dx - 2.0 * body.damping * dv + end;
            let accelerations = [self.start_force - friction, force - friction].map(|force| force / body.mass);
            let (xm, vm) = middle(h, [start.x, x1], [start.v, v1], accelerations);
            let (mut x, mut v, mut t) = ([xm; 8], [vm; 8], [time - 0.5 * h; 8]);
            (x[1], v[1], t[1]) = (x1, v1, time);
            let middle;
            [middle, end, ..] = scene.own_forces(&x, &v, &t);
            let [on_start, on_middle, on_end] = [self.here, middle, end].map(|g| unit * (g - self.push));
            dx = whole * on_start + 4.0 * half * on_middle;
            dv = slope * on_start + 4.0 * half_slope * on_middle + on_end;
        }
        (path.displacement, path.motion) = (drawn.0 + dx, drawn.1 + dv);
        path.force = drawn.2 - body.stiffness * dx - 2.0 * body.damping * dv + end;
        self.here = end;
    }
}

/// How often the end of a step is corrected. Each correction makes its error smaller by the share
/// of g in the motion of a step.
const CORRECTIONS: usize = 2;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::paper::paper;
    use crate::model::{Expression, Force, Sign};
    use crate::noise::AddressedDraws;
    use crate::scheme::Timeline;
    use crate::scheme::event_driven::law::cells::Cell;
    use crate::scheme::event_driven::law::harness::mean_and_error;
    use crate::scheme::event_driven::law::slip_step::force;
    use crate::scheme::event_driven::law::step_rules::{DEFAULT_TOLERANCE, StepRules};
    use crate::scheme::event_driven::noisy::Noisy;
    use crate::scheme::event_driven::work::WorkLeft;

    const DURATION: f64 = 2.0;
    /// Parts of the duration on which the noise is drawn.
    const PARTS: usize = 256;

    /// m = K = 1 and K beta rho = 1.5, without friction and harmonics, under a force that depends on
    /// x and x'.
    fn scene() -> Noisy {
        let mut model = paper(0.25, 1.0);
        model.temperature.harmonics.clear();
        (model.friction.static_force, model.friction.dynamic_force) = (0.0, 0.0);
        model.initial_displacement = 2.0;
        let law = Expression::parse("-0.3*x^3 + 0.4*(1 - x^2)*xdot", &[]).expect("an expression");
        model.force = Some(Force::new(law));
        let timeline = Timeline { end: DURATION, output_step: DURATION, period: None, after: 0.0 };
        Noisy::new(&model, &timeline, &StepRules::new(DEFAULT_TOLERANCE))
    }

    /// What the noise of a path adds to x, x' and n over each part.
    fn noise(noisy: &Noisy, part: &SlipStep, path: u64) -> Vec<SlipPoint> {
        let mut draws = AddressedDraws::new(1, path);
        let sd = part.transition.covariance[0].sqrt();
        let zero = SlipPoint { x: 0.0, v: 0.0, n: 0.0 };
        assert!(noisy.scene.diffusion > 0.0);
        (0..PARTS).map(|_| part.transition.drawn(zero, sd * draws.normal(), draws.normal_pair())).collect()
    }

    /// x and x' after so many equal steps under this noise.
    fn end(noisy: &Noisy, part: &SlipStep, noise: &[SlipPoint], steps: usize) -> [f64; 2] {
        let scene = &noisy.scene;
        let cell = Cell::new(scene, &noisy.ladder, 0);
        let slip = Slip { noisy, cell: &cell, direction: Sign::Positive, end_noise: 0.0 };
        let step = SlipStep::new(&noisy.oscillator, 0, DURATION / steps as f64);
        let mut path = Path::new(scene, 0.0, AddressedDraws::new(1, 0), WorkLeft::new(0));
        let mut own = OwnForce::new(scene, 0.0, &path).expect("a force");
        for noise in noise.chunks(PARTS / steps) {
            let start = SlipPoint { x: path.displacement, v: path.motion, n: path.noise };
            let from = Start { x: start.x, v: start.v, acceleration: path.force, time: path.after };
            let trial = from.trial(scene, own.here, step.length(), step.spread());
            (own.push, own.end, own.start_force) = (trial.middle, trial.end, path.force);
            let mut drawn = SlipPoint { x: 0.0, v: 0.0, n: 0.0 };
            for more in noise {
                let mean = part.transition.free(drawn, 0.0);
                drawn = SlipPoint { x: mean.x + more.x, v: mean.v + more.v, n: mean.n + more.n };
            }
            let mean = step.mean(start, &mut [], -own.push);
            let drawn = SlipPoint { x: mean.x + drawn.x, v: mean.v + drawn.v, n: mean.n + drawn.n };
            path.after += step.length();
            (path.displacement, path.motion, path.noise) = (drawn.x, drawn.v, drawn.n);
            path.force = force(&scene.oscillator, 0.0, drawn);
            own.correct(&slip, &step, start, &mut path);
        }
        [path.displacement, path.motion]
    }

    /// The steps are of order 2 in law or better: on the same noise, the means of x, x', x^2 and x'^2 of
    /// 4000 paths are off by less than a quarter of as much when the step is halved.
    #[test]
    fn the_steps_of_a_slip_are_of_order_two_in_law() {
        let noisy = scene();
        let part = SlipStep::new(&noisy.oscillator, 0, DURATION / PARTS as f64);
        let noises: Vec<_> = (0..4000).map(|path| noise(&noisy, &part, path)).collect();
        let ends = |steps| -> Vec<_> { noises.iter().map(|noise| end(&noisy, &part, noise, steps)).collect() };
        let exact = ends(PARTS);
        let errors = |steps| {
            let pairs: Vec<_> = ends(steps).into_iter().zip(&exact).collect();
            let of = |of: fn([f64; 2]) -> f64| pairs.iter().map(|(a, b)| of(*a) - of(*b)).collect::<Vec<_>>();
            [of(|[x, _]| x), of(|[_, v]| v), of(|[x, _]| x * x), of(|[_, v]| v * v)]
                .map(|errors| mean_and_error(&errors))
        };
        let (coarse, fine) = (errors(32), errors(64));
        for ((coarse, _), (fine, error)) in coarse.into_iter().zip(fine) {
            println!("{coarse:e} {fine:e} +- {error:e}");
            assert!(fine.abs() < coarse.abs() / 4.0 && fine.abs() > 5.0 * error);
        }
    }
}
