//! The steps of a slip of one path under a user-defined force g ([`ForcedStart`]): how long each
//! may be.

use super::super::law::{ForcedStart, SlipPoint, SlipStep, Trial};
use super::super::noisy::Noisy;
use super::super::work::{Resolved, Unresolved};
use super::path::Path;
use super::slip::Slip;

/// g along one slip.
pub(super) struct UserForceSteps {
    /// The start of the step, and its trial.
    start: ForcedStart,
    trial: Trial,
    /// How many times the usual step was halved last.
    halvings: usize,
    /// Whether the next step may be longer than the last one.
    may_grow: bool,
}

impl UserForceSteps {
    /// The steps of a slip that is here; none if there is no g.
    #[inline(always)]
    pub fn new(slip: &Slip<'_>, path: &Path<f64>) -> Option<Self> {
        let own = &slip.noisy.scene.own;
        own.is_some().then(|| {
            let (x, v, time) = (path.displacement, path.motion, slip.time(path));
            let here = own.at(Some(slip.direction), x, v, time);
            UserForceSteps {
                start: slip.forced_start(path, here),
                trial: Trial::none(here),
                halvings: 0,
                may_grow: false,
            }
        })
    }

    /// The constant that stands for g in the step.
    pub fn push(&self) -> f64 {
        self.trial.means[0]
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
        let Noisy {
            scene,
            halved,
            rules,
            ..
        } = slip.noisy;
        let finest = halved.len() - 1;
        let mut halvings = if self.may_grow {
            self.halvings.saturating_sub(1)
        } else {
            self.halvings
        };
        // Halvings that leave more than what remains of the macro step change nothing.
        while halvings < finest && halved[halvings + 1].length() >= remaining {
            halvings += 1;
        }
        self.start = slip.forced_start(path, self.start.here);
        let limits = self.start.limits(scene, rules);
        loop {
            path.work.spend()?;
            let step = &halved[halvings];
            let length = step.length().min(remaining);
            self.trial = self.start.trial(scene, length, step.spread());
            let is_resolved = self.trial.is_resolved(&limits);
            if is_resolved || halvings == finest {
                if self.trial.error.is_nan() {
                    return Err(Unresolved::NoNumber);
                }
                if self.trial.error > limits.forces + self.trial.end.abs() {
                    return Err(Unresolved::TooFine);
                }
                self.may_grow = is_resolved && self.trial.error <= GROWTH * limits.error;
                break;
            }
            halvings += 1;
        }
        self.halvings = halvings;
        Ok(slip.at_most(&halved[halvings], remaining, partial))
    }

    /// Corrects the end of a step that was drawn with the constant for g, and b there.
    #[inline(always)]
    pub fn correct(&mut self, slip: &Slip<'_>, step: &SlipStep, path: &mut Path<f64>) {
        let drawn = SlipPoint {
            x: path.displacement,
            v: path.motion,
            n: path.noise,
        };
        let end = self.start.corrected(
            &slip.noisy.scene,
            &step.transition,
            &self.trial,
            (drawn, path.force, slip.time(path)),
            slip.friction(),
        );
        (path.displacement, path.motion, path.force) = (end.x, end.v, end.force);
        self.start.here = end.own;
    }
}

/// A step twice as long is tried if the error of the last one was below this share of the largest
/// that is allowed: twice the length makes the error 16 to 64 times as large.
const GROWTH: f64 = 1.0 / 32.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::tests::paper;
    use crate::model::{Expression, Force, Sign};
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
        let mut own = UserForceSteps::new(&slip, &path).expect("a force");
        for noise in noise.chunks(PARTS / steps) {
            let start = SlipPoint {
                x: path.displacement,
                v: path.motion,
                n: path.noise,
            };
            own.start = slip.forced_start(&path, own.start.here);
            own.trial = own.start.trial(scene, step.length(), step.spread());
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
            let mean = step.mean(start, &mut [], -own.push());
            let drawn = SlipPoint {
                x: mean.x + drawn.x,
                v: mean.v + drawn.v,
                n: mean.n + drawn.n,
            };
            path.after += step.length();
            (path.displacement, path.motion, path.noise) = (drawn.x, drawn.v, drawn.n);
            path.force = force(&scene.oscillator, 0.0, drawn);
            own.correct(&slip, &step, &mut path);
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
