//! A stick of one path in a macro step: whether and when b leaves the stick band |b| <= f_s, given
//! n at the end of the macro step ([`crate::scheme::event_driven::law::stick band`]). Where
//! friction has a load, the limits are those of [`crate::model::Force::hold`].

use super::super::law::{
    Forcing, Limit, Limits, MacroStep, Node, Scene, StickBand, StickEnd, StickStep, ends,
    stick_piece, width,
};
use super::super::work::{Resolved, Unresolved};
use super::observation::PathObserver;
use super::path::{Cascade, Path};
use crate::model::{Event, EventKind, Sign};
use crate::noise::{AddressedDraws, bridge_middle};

/// The number of halvings after which a piece is decided, whatever its bend.
const HALVINGS: usize = 60;

/// The spacing of the values of g from which its second derivative is computed, as a fraction of a
/// macro step.
const OWN_SPACING: f64 = 1.0 / 64.0;

/// The right ends of the pieces that remain, the nearest one last. It is kept from stick to stick,
/// so that it need not be initialised again.
#[derive(Clone, Debug)]
pub struct PendingNodes([(Node, Limits); HALVINGS + 1]);

impl PendingNodes {
    /// An empty stack.
    pub fn new() -> Self {
        let node = Node {
            after: 0.0,
            noise: 0.0,
            force: 0.0,
            curvature: 0.0,
        };
        PendingNodes(
            [(
                node,
                [Limit {
                    value: 0.0,
                    curvature: 0.0,
                }; 2],
            ); HALVINGS + 1],
        )
    }
}

/// Takes a path in a static phase to the end of the macro step, or to its exit if this comes first.
/// Returns the exit.
#[inline(always)]
pub(super) fn stick<C: Cascade>(
    cascade: &C,
    macro_step: &MacroStep,
    path: &mut Path<C::Memory>,
    end_noise: f64,
    pending: &mut PendingNodes,
    observer: &mut impl PathObserver,
) -> Resolved<Option<Event>> {
    let (scene, displacement) = (cascade.scene(), path.displacement);
    let slip = |direction: Sign, force: f64, after: f64| Event {
        kind: EventKind::SlipStarted(direction),
        time: macro_step.start + after,
        displacement,
        force,
    };
    if scene.own.is_some() && !path.force.is_finite() {
        return Err(Unresolved::NoNumber);
    }
    let [up, down] = scene.limits(displacement, macro_step.start + path.after);
    if path.force >= up || -path.force >= down {
        let direction = if path.force >= up {
            Sign::Positive
        } else {
            Sign::Negative
        };
        return Ok(Some(slip(direction, path.force, path.after)));
    }
    let stick = Stick::new(
        scene,
        &cascade.propagation().band,
        macro_step,
        displacement,
        end_noise,
    );
    let Some((direction, exit)) = stick.exit(path, pending, observer)? else {
        path.force =
            stick.with_own(macro_step.last, macro_step.length).0.value + end_noise - stick.spring;
        return if path.force.is_nan() {
            Err(Unresolved::NoNumber)
        } else {
            Ok(None)
        };
    };
    (path.after, path.noise) = (exit.after, exit.noise);
    Ok(Some(slip(direction, exit.force, exit.after)))
}

/// A stick in a macro step, at whose end n is known.
struct Stick<'a> {
    scene: &'a Scene,
    band: &'a StickBand,
    macro_step: &'a MacroStep,
    displacement: f64,
    /// K x, less g(x, 0, t) where this is a constant.
    spring: f64,
    /// Whether g(x, 0, t), or the limit of b, is not a constant.
    is_moved: bool,
    /// The limits of b and -b where they are constants.
    limits: [f64; 2],
    end_noise: f64,
}

impl<'a> Stick<'a> {
    #[inline(always)]
    fn new(
        scene: &'a Scene,
        band: &'a StickBand,
        macro_step: &'a MacroStep,
        displacement: f64,
        end_noise: f64,
    ) -> Self {
        let is_moved = scene.own.depends_on_time();
        let spring = if is_moved {
            scene.oscillator.stiffness * displacement
        } else {
            scene.spring(displacement, macro_step.start)
        };
        let limits = scene.limits(displacement, macro_step.start);
        Stick {
            scene,
            band,
            macro_step,
            displacement,
            spring,
            is_moved,
            limits,
            end_noise,
        }
    }

    /// B, and what changes of g, with their second derivative, a time after the start of the macro
    /// step where B is `forcing`; and the limits of b and -b.
    #[inline(always)]
    fn with_own(&self, forcing: Forcing, after: f64) -> (Forcing, Limits) {
        if !self.is_moved {
            return (
                forcing,
                self.limits.map(|value| Limit {
                    value,
                    curvature: 0.0,
                }),
            );
        }
        let spacing = self.macro_step.length * OWN_SPACING;
        let at = |after: f64| {
            self.scene
                .own
                .hold(self.displacement, self.macro_step.start + after)
        };
        let all = [at(after - spacing), at(after), at(after + spacing)];
        let curvature =
            |[before, here, behind]: [f64; 3]| (before - 2.0 * here + behind) / (spacing * spacing);
        let pulls = all.map(|hold| hold.pull);
        let moved = Forcing {
            value: forcing.value + pulls[1],
            curvature: forcing.curvature + curvature(pulls),
        };
        let limit = |i: usize| {
            let excesses = all.map(|hold| hold.excess[i]);
            Limit {
                value: self.scene.friction.static_force + excesses[1],
                curvature: curvature(excesses),
            }
        };
        (moved, [limit(0), limit(1)])
    }

    /// The exit of a path before the end of the macro step; none if the path stays inside the band.
    #[inline(always)]
    fn exit<M>(
        &self,
        path: &mut Path<M>,
        PendingNodes(pending): &mut PendingNodes,
        observer: &mut impl PathObserver,
    ) -> Resolved<Option<(Sign, Node)>> {
        let mut left = self.start(path);
        pending[0] = self.end();
        let mut top = 0;
        loop {
            path.work.spend()?;
            let right = pending[top];
            let limits = [left.1, right.1];
            let reach = self.rules(&limits).reach(
                self.scene,
                right.0.after - left.0.after,
                (&left.0, &right.0),
                &limits,
            );
            if reach.is_near && reach.is_long && top < HALVINGS {
                top += 1;
                pending[top] = self.middle(&left.0, &right.0, &mut path.draws);
                continue;
            }
            if reach.is_near
                && let Some((direction, exit)) =
                    self.exit_between(&left.0, &right.0, limits, &mut path.draws)
            {
                observer.observe(self.scene, || {
                    (
                        stick_piece(&left.0, &exit, self.displacement),
                        StickEnd::Exit,
                    )
                });
                return Ok(Some((direction, exit)));
            }
            let kind = if reach.is_near {
                StickEnd::Kept
            } else {
                StickEnd::Clear
            };
            observer.observe(self.scene, || {
                (stick_piece(&left.0, &right.0, self.displacement), kind)
            });
            if top == 0 {
                return Ok(None);
            }
            left = right;
            top -= 1;
        }
    }

    /// The rules for a piece with these limits.
    #[inline(always)]
    fn rules(&self, [first, last]: &[Limits; 2]) -> StickBand {
        let width = 0.5 * (width(first) + width(last));
        if self.scene.own.has_load() {
            self.band.of_width(self.scene, width)
        } else {
            *self.band
        }
    }

    /// Where the path is.
    #[inline(always)]
    fn start<M>(
        &self,
        &Path {
            after,
            noise,
            force,
            ..
        }: &Path<M>,
    ) -> (Node, Limits) {
        let forcing = if after == 0.0 {
            self.macro_step.first
        } else {
            self.macro_step.forcing(after)
        };
        let (forcing, limit) = self.with_own(forcing, after);
        (
            Node {
                after,
                noise,
                force,
                curvature: forcing.curvature,
            },
            limit,
        )
    }

    /// The end of the macro step.
    #[inline(always)]
    fn end(&self) -> (Node, Limits) {
        let ((last, limit), noise) = (
            self.with_own(self.macro_step.last, self.macro_step.length),
            self.end_noise,
        );
        let force = last.value - self.spring + noise;
        (
            Node {
                after: self.macro_step.length,
                noise,
                force,
                curvature: last.curvature,
            },
            limit,
        )
    }

    /// Draws n in the middle between two nodes.
    #[inline(always)]
    fn middle(&self, left: &Node, right: &Node, draws: &mut AddressedDraws) -> (Node, Limits) {
        let h = right.after - left.after;
        let (weight, sd) = bridge_middle(self.scene.relaxation_rate, self.scene.diffusion, h);
        let noise = weight * (left.noise + right.noise) + sd * draws.normal();
        let after = left.after + 0.5 * h;
        let (forcing, limit) = self.with_own(self.macro_step.forcing(after), after);
        (
            Node {
                after,
                noise,
                force: forcing.value - self.spring + noise,
                curvature: forcing.curvature,
            },
            limit,
        )
    }

    /// The exit between two nodes, if there is one.
    #[inline(always)]
    fn exit_between(
        &self,
        left: &Node,
        right: &Node,
        limits: [Limits; 2],
        draws: &mut AddressedDraws,
    ) -> Option<(Sign, Node)> {
        let step = StickStep::new(self.scene, right.after - left.after);
        let (sign, passed) = step.exit(self.scene, &ends(left, right, limits), draws)?;
        let after = left.after + passed;
        let (forcing, [up, down]) = self.with_own(self.macro_step.forcing(after), after);
        let force = if sign == Sign::Positive {
            up.value
        } else {
            -down.value
        };
        let noise = force - forcing.value + self.spring;
        Some((
            sign,
            Node {
                after,
                noise,
                force,
                curvature: 0.0,
            },
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::super::observation::NullObserver;
    use super::*;
    use crate::model::tests::paper;
    use crate::model::{Harmonic, Problem};
    use crate::noise::{AddressedDraws, Transition};
    use crate::scheme::event_driven::law::{
        DEFAULT_TOLERANCE, StepGrid, StepRules, macro_step_length,
        tests::{mean_and_error, noise_alone},
    };
    use crate::scheme::event_driven::work::WorkLeft;

    /// The time and the side of the first exit from the initial stick of each path, started at n =
    /// `noise`.
    fn exits(
        model: &Problem,
        noise: f64,
        kappa: f64,
        horizon: f64,
        seed: u64,
        paths: u64,
    ) -> Vec<(f64, Sign)> {
        let scene = Scene::new(model);
        let band = StickBand::new(&scene, kappa);
        let rates = scene.harmonics.iter().map(|h| h.angular_frequency);
        let length = macro_step_length(
            0.5 / rates.fold(scene.relaxation_rate, f64::max),
            f64::INFINITY,
        );
        let transition = Transition::new(scene.relaxation_rate, scene.diffusion, length);
        let spring_force = scene.oscillator.stiffness * scene.initial_displacement;
        let grid = StepGrid::even(length);
        let (mut macro_step, mut pending) = (MacroStep::new(&scene, &grid, 0), PendingNodes::new());
        (0..paths)
            .map(|number| {
                let draws = AddressedDraws::new(seed, number);
                let mut path = Path::<()>::new(&scene, noise, draws, WorkLeft::new(1_000_000));
                for index in 0..(horizon / length).ceil() as u64 {
                    macro_step.move_to(&scene, &grid, index);
                    let end_noise = transition.next(path.noise, draws.at(index, 0).normal());
                    path.draws = draws.at(index, 2);
                    path.force = macro_step.first.value - spring_force + path.noise;
                    let stick =
                        Stick::new(&scene, &band, &macro_step, path.displacement, end_noise);
                    match stick
                        .exit(&mut path, &mut pending, &mut NullObserver)
                        .expect("bounded work")
                    {
                        Some((direction, exit)) => {
                            return (macro_step.start + exit.after, direction);
                        }
                        None => path.noise = end_noise,
                    }
                }
                panic!("no exit before {horizon}")
            })
            .collect()
    }

    /// The statistical tests have the null hypothesis that the mean is the exact one. With fixed
    /// seeds, each comparison fails by chance once in 1e4 (3.9 standard errors).
    const FALSE_ALARM: f64 = 3.9;

    /// The chord error at the default tolerance.
    fn kappa() -> f64 {
        StepRules::new(DEFAULT_TOLERANCE).chord_error
    }

    fn assert_mean(name: &str, values: &[f64], exact: f64) {
        let (mean, error) = mean_and_error(values);
        assert!(
            (mean - exact).abs() <= FALSE_ALARM * error,
            "{name}: {mean} +- {error}, exact {exact}"
        );
    }

    /// Exit of dv = -v dt + dW from (lower, upper), started at `from`. The exact means are
    /// Siegert's integrals, computed by high-precision quadrature. The wide stick band is left rarely
    /// and where its threshold bends most, so it takes more paths.
    #[test]
    fn exit_from_a_fixed_band_has_siegert_s_mean_and_side() {
        // (lower, upper, from, mean, probability of the upper side)
        let cases = [
            (-0.25, 0.25, 0.0, 0.063_824_078_626_031_84, 0.5),
            (-0.5, 0.5, 0.0, 0.272_300_063_376_112_1, 0.5),
            (-0.8, 0.8, 0.0, 0.803_432_748_833_375_6, 0.5),
            (-0.8, 0.8, 0.4, 0.634_522_479_697_277_3, f64::NAN),
            (-2.0, 2.0, 0.0, 27.432_739_152_499_77, 0.5),
            (
                -1.0,
                0.5,
                0.0,
                0.590_704_042_576_515_5,
                0.728_543_256_592_702,
            ),
            (
                -0.4,
                1.2,
                0.0,
                0.553_861_940_553_424,
                0.164_777_335_275_732_8,
            ),
        ];
        for (case, (lower, upper, from, mean, up)) in cases.into_iter().enumerate() {
            // With K = beta = rho = 1 and no harmonics, b = n - x0 and the threshold is (upper -
            // lower)/2.
            let mut model = noise_alone(0.5 * (upper - lower), 1.0);
            model.initial_displacement = 0.5 * (upper + lower);
            let found = exits(
                &model,
                from,
                kappa(),
                1e4,
                100 + case as u64,
                if mean > 10.0 { 400_000 } else { 100_000 },
            );
            let times: Vec<f64> = found.iter().map(|e| e.0).collect();
            assert_mean("mean exit time", &times, mean);
            if !up.is_nan() {
                let sides: Vec<f64> = found
                    .iter()
                    .map(|e| f64::from(u8::from(e.1 == Sign::Positive)))
                    .collect();
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
    fn a_stick_near_one_threshold_rarely_ends_at_the_other() {
        let (half, from) = (0.25, -0.24);
        let model = noise_alone(half, 1.0);
        let found = exits(&model, from, kappa(), 1e4, 31, 400_000);
        let sides: Vec<f64> = found
            .iter()
            .map(|e| f64::from(u8::from(e.1 == Sign::Positive)))
            .collect();
        // Midpoint rule.
        let scale = |to: f64| {
            let width = (to + half) / 1000.0;
            (0..1000)
                .map(|i| (-half + width * (f64::from(i) + 0.5)).powi(2).exp() * width)
                .sum::<f64>()
        };
        let (mean, error) = mean_and_error(&sides);
        println!(
            "upward: {mean} +- {error}, exact {}",
            scale(from) / scale(half)
        );
        assert_mean("share of upward exits", &sides, scale(from) / scale(half));
    }

    #[test]
    fn exit_does_not_depend_on_the_units_of_the_noise() {
        // General theta and sigma scale time by 1/theta and v by sigma/sqrt(theta). The exact
        // values are the survival probabilities P(T > t) of the stick band of half-width 0.8.
        let (theta, sigma) = (3.0, 0.2);
        let mut model = noise_alone(0.8 * sigma / f64::sqrt(theta), theta);
        for noise in &mut model.temperature.noises {
            noise.diffusion = sigma;
        }
        let found = exits(&model, 0.0, kappa(), 1e4, 77, 200_000);
        for (t, survival) in [
            (0.25, 0.828_946_889_68),
            (0.5, 0.577_189_766_468),
            (1.0, 0.276_890_707_225),
            (2.0, 0.063_707_309_437),
        ] {
            let alive: Vec<f64> = found
                .iter()
                .map(|e| f64::from(u8::from(e.0 * theta > t)))
                .collect();
            assert_mean("survival", &alive, survival);
        }
    }

    #[test]
    fn first_stick_of_the_paper_s_noisy_scene_has_its_exact_mean() {
        // The stick band moves with the forcing. The exact means are from the backward Kolmogorov
        // equation (12 digits) and, for the two smallest rho, from a Volterra equation
        // (tests/reference/first_stick.py, 7 digits).
        for (rho, mean) in [
            (0.01, 2.571_426),
            (0.02, 2.563_677),
            (0.1, 2.289_610_431_7),
            (0.25, 0.775_576_827_665),
            (1.0, 0.040_539_066_2),
        ] {
            let found = exits(
                &paper(0.25, rho),
                0.0,
                kappa(),
                60.0,
                (rho * 1000.0) as u64,
                200_000,
            );
            let times: Vec<f64> = found.iter().map(|e| e.0).collect();
            assert_mean("first stick", &times, mean);
        }
    }

    #[test]
    fn feeble_noise_costs_few_steps() {
        for rho in [1e-4, 1e-6, 1e-9, 1e-12] {
            let found = exits(&paper(0.25, rho), 0.0, kappa(), 60.0, 5, 1_000);
            let times: Vec<f64> = found.iter().map(|e| e.0).collect();
            let (mean, _) = mean_and_error(&times);
            // The exit moves by about sd(n)/B' ~ 6 rho.
            assert!(
                (mean - 2.574_004_435_173_137_6).abs() < 6.0 * rho + 1e-9,
                "{rho}: {mean}"
            );
        }
    }

    /// A threshold that bends: it lies 1 + 100 (1 - cos((t - 2.5)/10)) above the noise, with theta
    /// = 0.0354 and s = 1, so that the length of a piece follows from its chord error alone.
    /// Null: the probability to leave in the first dip, and the mean time of these exits, are the
    /// exact ones (`tests/reference/first_stick.py`) within the default tolerance, 0.1 %. 8e5 paths
    /// give standard errors of 0.12 and 0.06 %; each of the two comparisons fails by chance once in
    /// 1e4. At four times the chord error the time is 0.3 % too short; with twice the first-order
    /// change of the rate of crossing it is 0.4 % too short at the default.
    #[test]
    fn a_bent_threshold_is_left_in_time_at_the_default_tolerance() {
        let (amplitude, w): (f64, f64) = (100.0, 0.1);
        let mut model = noise_alone(amplitude + 1.0, 0.0354);
        model.temperature.harmonics = vec![Harmonic {
            amplitude,
            angular_frequency: w,
            phase: -2.5 * w,
        }];
        let found = exits(&model, 0.0, kappa(), 1e6, 9, 800_000);
        let (times, later): (Vec<f64>, Vec<f64>) =
            found.iter().map(|e| e.0).partition(|t| *t < 8.0);
        let is_early: Vec<f64> = times
            .iter()
            .map(|_| 1.0)
            .chain(later.iter().map(|_| 0.0))
            .collect();
        for (what, values, exact) in [
            ("share", &is_early, 0.479_575_06),
            ("time", &times, 1.894_435_19),
        ] {
            let (mean, error) = mean_and_error(values);
            println!("{what}: {mean} +- {error}, exact {exact}");
            assert!(
                (mean - exact).abs() <= FALSE_ALARM * error + DEFAULT_TOLERANCE * exact,
                "{what}: {mean} +- {error}, exact {exact}"
            );
        }
    }
}
