//! A static phase inside a cell: whether and when b leaves the corridor |b| <= f_s, given n at the
//! end of the cell.
//!
//! Between two known values of n the noise is a bridge. A piece of the bridge
//!
//! - is *clear* if it cannot meet a threshold: the probability that it does, after the threshold
//!   has been moved towards the noise by the most that it bends, is below exp(-35);
//! - is *decided* by [`StickStep::exit`] if it is short enough. A bridge between these two ends
//!   meets first one threshold and then the other with a probability below 2 exp(-4), which is
//!   taken into account: h <= width (width - |b1 - b0|)/(2 s^2), where b1 counts as f_s or -f_s if
//!   it lies beyond. And the threshold is straight enough: |c| h^2/8 <= kappa s sqrt(h) for each
//!   threshold that may be met, where c is the bend of the threshold ([`super::stick_step`]) and
//!   kappa follows from the tolerance;
//! - is otherwise divided: n is drawn in the middle, and the halves are treated from left to right.

use super::cell_loop::Path;
use super::cells::Cell;
use super::scene::Scene;
use super::stick_step::{StickEnds, StickStep};
use super::watch::{StickEnd, StickPiece, Watch};
use super::work::Unresolved;
use crate::lanes::{Choose, Lanes};
use crate::model::Sign;
use crate::noise::bridge_middle;

/// exp(-FAR_EXPONENT) is a probability that is negligible even in 1e10 steps.
const FAR_EXPONENT: f64 = 35.0;

/// The number in the width rule.
const WIDTH_RULE: f64 = 2.0;

/// The number of halvings after which a piece is decided, whatever its bend.
const DEPTH: usize = 60;

/// Finds the exits from sticks.
#[derive(Clone, Debug)]
pub struct Corridor {
    /// The longest piece by the width rule for each unit of width - |b1 - b0|, a time over a force.
    widest: f64,
    /// (8 kappa s)^2, the largest |c|^2 h^3 of a piece that is decided.
    most_bend: f64,
}

/// What is known of a stick at one time.
#[derive(Clone, Copy, Debug)]
pub struct Node<L = f64> {
    /// Time after the start of the cell.
    pub after: L,
    pub noise: L,
    /// b.
    pub force: L,
    /// B''.
    pub curvature: L,
}

/// The right ends of the pieces that remain, the nearest one last. It is kept from stick to stick,
/// so that it need not be initialised again.
#[derive(Clone, Debug)]
pub struct PendingNodes([Node; DEPTH + 1]);

impl PendingNodes {
    /// An empty stack.
    pub fn new() -> Self {
        PendingNodes([Node { after: 0.0, noise: 0.0, force: 0.0, curvature: 0.0 }; DEPTH + 1])
    }
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

impl Corridor {
    pub fn new(scene: &Scene, kappa: f64) -> Self {
        let (width, s) = (2.0 * scene.friction.static_force, scene.diffusion);
        Corridor { widest: width / (WIDTH_RULE * s * s), most_bend: (8.0 * kappa * s) * (8.0 * kappa * s) }
    }

    /// The exit of a path from its static phase before the end of the cell, where n is `end_noise`:
    /// the time after the start of the cell, and the sign of b. None if the path stays inside the
    /// corridor.
    #[inline(always)]
    pub fn exit<M>(
        &self,
        scene: &Scene,
        cell: &Cell,
        path: &mut Path<M>,
        end_noise: f64,
        PendingNodes(pending): &mut PendingNodes,
        watch: &mut impl Watch,
    ) -> Result<Option<(f64, Sign)>, Unresolved> {
        let Path { after, displacement, noise, force, ref mut draws, ref mut work, .. } = *path;
        let spring = scene.oscillator.stiffness * displacement;
        let node = |after: f64, noise: f64| {
            let forcing = cell.forcing(after);
            Node { after, noise, force: forcing.value - spring + noise, curvature: forcing.curvature }
        };
        let piece = |left: &Node, right: &Node, kind| (stick_piece(left, right, displacement), kind);
        let curvature = if after == 0.0 { cell.first.curvature } else { cell.forcing(after).curvature };
        let mut left = Node { after, noise, force, curvature };
        let end_force = cell.last.value - spring + end_noise;
        pending[0] = Node { after: cell.length, noise: end_noise, force: end_force, curvature: cell.last.curvature };
        let mut top = 0;
        loop {
            work.spend()?;
            let right = pending[top];
            let h = right.after - left.after;
            let reach = self.reach(scene, h, &left, &right);
            if reach.is_near {
                if reach.is_long && top < DEPTH {
                    let (weight, sd) = bridge_middle(scene.relaxation_rate, scene.diffusion, h);
                    let middle = weight * (left.noise + right.noise) + sd * draws.normal();
                    top += 1;
                    pending[top] = node(left.after + 0.5 * h, middle);
                    continue;
                }
                let step = StickStep::new(scene, h);
                if let Some((sign, passed)) = step.exit(scene, &ends(&left, &right), draws) {
                    let after = left.after + passed;
                    let force = sign.value() * scene.friction.static_force;
                    let noise = force - cell.forcing(after).value + spring;
                    let right = Node { after, noise, force, curvature: 0.0 };
                    watch.look(scene, || piece(&left, &right, StickEnd::Exit));
                    return Ok(Some((after, sign)));
                }
            }
            let kind = if reach.is_near { StickEnd::Kept } else { StickEnd::Clear };
            watch.look(scene, || piece(&left, &right, kind));
            if top == 0 {
                return Ok(None);
            }
            left = right;
            top -= 1;
        }
    }
}

impl Corridor {
    /// Whether the bridge between two nodes may leave the corridor, and whether the piece is too
    /// long to be decided without halving it.
    #[inline(always)]
    pub fn reach<L: Lanes>(&self, scene: &Scene, h: L, left: &Node<L>, right: &Node<L>) -> Reach<L> {
        let (up, down) = (side(scene, 1.0, h, left, right), side(scene, -1.0, h, left, right));
        let zero = L::splat(0.0);
        let reach = L::select(up.is_near, up.bend, zero).or_at_least(L::select(down.is_near, down.bend, zero));
        let is_bent = (reach * reach * h * h * h).gt(L::splat(self.most_bend));
        let f_s = scene.friction.static_force;
        let way = (right.force.or_at_most(L::splat(f_s)).or_at_least(L::splat(-f_s)) - left.force).abs();
        let is_wide = h.gt((L::splat(2.0 * f_s) - way) * self.widest);
        Reach { is_near: L::or(up.is_near, down.is_near), is_long: L::or(is_wide, is_bent) }
    }
}

/// The piece of a stick between two nodes.
#[inline(always)]
pub fn stick_piece<L: Lanes>(left: &Node<L>, right: &Node<L>, displacement: L) -> StickPiece<L> {
    StickPiece {
        after: (left.after, right.after),
        noise: (left.noise, right.noise),
        force: (left.force, right.force),
        displacement,
    }
}

/// What [`StickStep`] needs to know of a piece between two nodes.
#[inline(always)]
pub fn ends<L: Lanes>(left: &Node<L>, right: &Node<L>) -> StickEnds<L> {
    StickEnds {
        start: left.force,
        end: right.force,
        bend: (left.curvature + right.curvature) * -0.5,
        mean_noise: (left.noise + right.noise) * 0.5,
    }
}

/// One threshold (`side` = 1: upper, -1: lower) over a piece between two nodes.
#[inline(always)]
fn side<L: Lanes>(scene: &Scene, side: f64, h: L, left: &Node<L>, right: &Node<L>) -> Side<L> {
    let (f_s, theta) = (L::splat(scene.friction.static_force), scene.relaxation_rate);
    let (d0, d1) = (f_s - left.force * side, f_s - right.force * side);
    let (bend0, bend1) = (bend(theta, side, left, d0), bend(theta, side, right, d1));
    let bend = bend0.or_at_least(bend1);
    let shift = bend * 0.125 * h * h;
    let y = h * theta;
    let variance = h * (scene.diffusion * scene.diffusion) * (y * y * SINH_BOUND + 1.0);
    let (d0, d1) = (d0 - shift, d1 - shift);
    let zero = L::splat(0.0);
    let is_beyond = (d0 * 2.0 * d1).ge(variance * FAR_EXPONENT);
    let is_far = L::and(L::and(d0.gt(zero), d1.gt(zero)), is_beyond);
    Side { bend, is_near: L::not(is_far) }
}

/// |U'' - theta^2 U| at one end, where `d` is the distance to the threshold.
#[inline(always)]
fn bend<L: Lanes>(theta: f64, side: f64, node: &Node<L>, d: L) -> L {
    (node.curvature * side + (node.noise * side + d) * (theta * theta)).abs()
}

/// sinh y <= y (1 + SINH_BOUND y^2) for 0 <= y <= 1.
const SINH_BOUND: f64 = 0.1753;

#[cfg(test)]
mod tests {
    use super::super::harness::{exits, mean_and_error, noise_alone};
    use super::super::step_rules::{DEFAULT_TOLERANCE, StepRules};
    use crate::model::paper::paper;
    use crate::model::{Harmonic, Sign};

    /// The statistical tests have the null hypothesis that the mean is the exact one. With fixed
    /// seeds, each comparison fails by chance once in 1e4 (3.9 standard errors).
    const FALSE_ALARM: f64 = 3.9;

    /// The chord error at the default tolerance.
    fn kappa() -> f64 {
        StepRules::new(DEFAULT_TOLERANCE).chord_error
    }

    fn assert_mean(name: &str, values: &[f64], exact: f64) {
        let (mean, error) = mean_and_error(values);
        assert!((mean - exact).abs() <= FALSE_ALARM * error, "{name}: {mean} +- {error}, exact {exact}");
    }

    /// Exit of dv = -v dt + dW from (lower, upper), started at `from`. The exact means are
    /// Siegert's integrals, computed by high-precision quadrature. The wide corridor is left rarely
    /// and where its threshold bends most, so it takes more paths.
    #[test]
    fn exit_from_a_fixed_corridor_has_siegert_s_mean_and_side() {
        // (lower, upper, from, mean, probability of the upper side)
        let cases = [
            (-0.25, 0.25, 0.0, 0.063_824_078_626_031_84, 0.5),
            (-0.5, 0.5, 0.0, 0.272_300_063_376_112_1, 0.5),
            (-0.8, 0.8, 0.0, 0.803_432_748_833_375_6, 0.5),
            (-0.8, 0.8, 0.4, 0.634_522_479_697_277_3, f64::NAN),
            (-2.0, 2.0, 0.0, 27.432_739_152_499_77, 0.5),
            (-1.0, 0.5, 0.0, 0.590_704_042_576_515_5, 0.728_543_256_592_702),
            (-0.4, 1.2, 0.0, 0.553_861_940_553_424, 0.164_777_335_275_732_8),
        ];
        for (case, (lower, upper, from, mean, up)) in cases.into_iter().enumerate() {
            // With K = beta = rho = 1 and no harmonics, b = n - x0 and the threshold is (upper -
            // lower)/2.
            let mut model = noise_alone(0.5 * (upper - lower), 1.0);
            model.initial_displacement = 0.5 * (upper + lower);
            let found =
                exits(&model, from, kappa(), 1e4, 100 + case as u64, if mean > 10.0 { 400_000 } else { 100_000 });
            let times: Vec<f64> = found.iter().map(|e| e.0).collect();
            assert_mean("mean exit time", &times, mean);
            if !up.is_nan() {
                let sides: Vec<f64> = found.iter().map(|e| f64::from(u8::from(e.1 == Sign::Positive))).collect();
                assert_mean("share of upward exits", &sides, up);
            }
        }
    }

    /// Exit of dv = -v dt + dW from (-0.25, 0.25), started a fiftieth of the width above the lower
    /// end, as a stick that follows a short slip does. A piece of 1/32 = width^2/(8 s^2) ends
    /// beyond the upper threshold with a probability of 0.003; such a bridge has nearly always met
    /// the lower one before. Null: the share of exits at the upper threshold is the ratio of the
    /// integrals of exp(v^2), the scale function of the process. 4e5 paths give a standard error of
    /// 1.1 %; if pieces of that length were decided for one threshold after the other, the upper
    /// one first, the share would be 16 % too large.
    #[test]
    fn a_stick_that_begins_close_to_one_threshold_is_rarely_left_at_the_other() {
        let (half, from) = (0.25, -0.24);
        let model = noise_alone(half, 1.0);
        let found = exits(&model, from, kappa(), 1e4, 31, 400_000);
        let sides: Vec<f64> = found.iter().map(|e| f64::from(u8::from(e.1 == Sign::Positive))).collect();
        // Midpoint rule.
        let scale = |to: f64| {
            let width = (to + half) / 1000.0;
            (0..1000).map(|i| (-half + width * (f64::from(i) + 0.5)).powi(2).exp() * width).sum::<f64>()
        };
        let (mean, error) = mean_and_error(&sides);
        println!("upward: {mean} +- {error}, exact {}", scale(from) / scale(half));
        assert_mean("share of upward exits", &sides, scale(from) / scale(half));
    }

    #[test]
    fn exit_does_not_depend_on_the_units_of_the_noise() {
        // General theta and sigma scale time by 1/theta and v by sigma/sqrt(theta). The exact
        // values are the survival probabilities P(T > t) of the corridor of half-width 0.8.
        let (theta, sigma) = (3.0, 0.2);
        let mut model = noise_alone(0.8 * sigma / f64::sqrt(theta), theta);
        if let Some(noise) = &mut model.temperature.noise {
            noise.diffusion = sigma;
        }
        let found = exits(&model, 0.0, kappa(), 1e4, 77, 200_000);
        for (t, survival) in
            [(0.25, 0.828_946_889_68), (0.5, 0.577_189_766_468), (1.0, 0.276_890_707_225), (2.0, 0.063_707_309_437)]
        {
            let alive: Vec<f64> = found.iter().map(|e| f64::from(u8::from(e.0 * theta > t))).collect();
            assert_mean("survival", &alive, survival);
        }
    }

    #[test]
    fn first_stick_of_the_paper_s_noisy_scene_has_its_exact_mean() {
        // The corridor moves with the forcing. The exact means are from the backward Kolmogorov
        // equation (12 digits) and, for the two smallest rho, from a Volterra equation
        // (tests/reference/first_stick.py, 7 digits).
        for (rho, mean) in [
            (0.01, 2.571_426),
            (0.02, 2.563_677),
            (0.1, 2.289_610_431_7),
            (0.25, 0.775_576_827_665),
            (1.0, 0.040_539_066_2),
        ] {
            let found = exits(&paper(0.25, rho), 0.0, kappa(), 60.0, (rho * 1000.0) as u64, 200_000);
            let times: Vec<f64> = found.iter().map(|e| e.0).collect();
            assert_mean("first stick", &times, mean);
        }
    }

    #[test]
    fn feeble_noise_costs_few_steps_and_tends_to_the_deterministic_exit() {
        for rho in [1e-4, 1e-6, 1e-9, 1e-12] {
            let found = exits(&paper(0.25, rho), 0.0, kappa(), 60.0, 5, 1_000);
            let times: Vec<f64> = found.iter().map(|e| e.0).collect();
            let (mean, _) = mean_and_error(&times);
            // The exit moves by about sd(n)/B' ~ 6 rho.
            assert!((mean - 2.574_004_435_173_137_6).abs() < 6.0 * rho + 1e-9, "{rho}: {mean}");
        }
    }

    /// A threshold that bends: it lies 1 + 100 (1 - cos((t - 2.5)/10)) above the noise, with theta
    /// = 0.0354 and s = 1, so that the length of a piece follows from its chord error alone. Null:
    /// the probability to leave in the first dip, and the mean time of these exits, are the exact
    /// ones (`tests/reference/first_stick.py`) within the default tolerance, 0.1 %. 8e5 paths give
    /// standard errors of 0.12 and 0.06 %; each of the two comparisons fails by chance once in 1e4.
    /// At four times the chord error the time is 0.3 % too short; with twice the first-order change
    /// of the rate of crossing it is 0.4 % too short at the default.
    #[test]
    fn a_bent_threshold_is_left_when_it_should_be_at_the_default_tolerance() {
        let (amplitude, w): (f64, f64) = (100.0, 0.1);
        let mut model = noise_alone(amplitude + 1.0, 0.0354);
        model.temperature.harmonics = vec![Harmonic { amplitude, angular_frequency: w, phase: -2.5 * w }];
        let found = exits(&model, 0.0, kappa(), 1e6, 9, 800_000);
        let (times, later): (Vec<f64>, Vec<f64>) = found.iter().map(|e| e.0).partition(|t| *t < 8.0);
        let is_early: Vec<f64> = times.iter().map(|_| 1.0).chain(later.iter().map(|_| 0.0)).collect();
        for (what, values, exact) in [("share", &is_early, 0.479_575_06), ("time", &times, 1.894_435_19)] {
            let (mean, error) = mean_and_error(values);
            println!("{what}: {mean} +- {error}, exact {exact}");
            assert!(
                (mean - exact).abs() <= FALSE_ALARM * error + DEFAULT_TOLERANCE * exact,
                "{what}: {mean} +- {error}, exact {exact}"
            );
        }
    }
}
