//! Quantities determined by the scenario alone, on which all paths must agree.
//!
//! If all paths of a random scenario agree on a number by chance, its interval allows for other
//! paths to differ ([`crate::sums::range`]). If they cannot differ, it is a single point.

use crate::model::{InitialNoise, OrnsteinUhlenbeck, Problem};
use crate::scheme::Timeline;

/// The numbers that are the same for all paths of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Deterministic {
    /// Every number: nothing is random, or the duration is zero.
    pub everything: bool,
    /// Whether a path is static at t = 0, because v(0) is given.
    pub start: bool,
    /// The first stick lasts zero, because |b(0)| > f_s on every path.
    pub first_stick: bool,
    /// Nothing ever sticks, because f_s = 0.
    pub never_sticks: bool,
    /// Friction dissipates no work, because f_d = 0.
    pub frictionless: bool,
    /// The long-term drift velocity, if the spring and the temperature alone determine it.
    pub drift: Option<f64>,
}

impl Deterministic {
    pub fn of(model: &Problem, timeline: &Timeline) -> Self {
        let Problem {
            oscillator,
            friction,
            temperature,
            initial_displacement,
            initial_velocity,
            ..
        } = model;
        let is_given = |noise: OrnsteinUhlenbeck| matches!(noise.initial, InitialNoise::At(_));
        let has_initial_velocity = *initial_velocity != 0.0;
        let start = has_initial_velocity
            || oscillator.force_per_temperature() == 0.0
            || temperature.effective_noises().all(is_given);
        let is_let_go = model
            .let_go(0.0, temperature.mean(0.0), *initial_displacement)
            .is_some();
        let has_load = model.has_load();
        let is_moved = temperature.is_random() && oscillator.force_per_temperature() != 0.0;
        let is_random = is_moved || !model.random.is_empty();
        Deterministic {
            everything: !is_random || timeline.end == 0.0,
            start,
            first_stick: has_initial_velocity || start && is_let_go,
            never_sticks: friction.static_force == 0.0 && !has_load,
            frictionless: friction.dynamic_force == 0.0 && !has_load,
            drift: model.long_run_drift(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Friction, Temperature};
    use crate::stats::Statistic;
    use crate::stats::synthetic::model;

    const TIMELINE: Timeline = Timeline {
        end: 10.0,
        output_step: 10.0,
        period: None,
        after: 0.0,
    };

    /// x0 = 6 and K = beta = 1, so that b(0) = v(0)/4 - 6.
    fn scene(static_force: f64, dynamic_force: f64, initial: InitialNoise) -> Problem {
        let noise = OrnsteinUhlenbeck {
            intensity: 0.25,
            relaxation_rate: 1.0,
            diffusion: 1.0,
            initial,
        };
        Problem {
            friction: Friction {
                static_force,
                dynamic_force,
            },
            temperature: Temperature {
                noises: vec![noise],
                ..Temperature::default()
            },
            ..model()
        }
    }

    fn deterministic(model: &Problem, timeline: &Timeline) -> Vec<Statistic> {
        let deterministic = Deterministic::of(model, timeline);
        Statistic::ALL
            .into_iter()
            .filter(|statistic| statistic.is_decided_by(deterministic))
            .collect()
    }

    #[test]
    fn only_what_the_scene_decides_is_deterministic() {
        let given = InitialNoise::At(0.0);
        assert_eq!(deterministic(&scene(7.0, 2.0, given), &TIMELINE), []);
        assert_eq!(
            deterministic(&scene(7.0, 0.0, given), &TIMELINE),
            [Statistic::FrictionWorkMean]
        );
        assert_eq!(
            deterministic(&scene(5.0, 2.0, given), &TIMELINE),
            [Statistic::FirstStickDurationMean]
        );
        // With v(0) = 8, b(0) is -4, and with a random v(0) it may be anything.
        assert_eq!(
            deterministic(&scene(5.0, 2.0, InitialNoise::At(8.0)), &TIMELINE),
            []
        );
        assert_eq!(
            deterministic(&scene(5.0, 2.0, InitialNoise::Stationary), &TIMELINE),
            []
        );
        let never = [
            Statistic::FirstStickDurationMean,
            Statistic::SticksPerPath,
            Statistic::SlipsPerPath,
            Statistic::StickingFraction,
            Statistic::FrictionWorkMean,
        ];
        assert_eq!(deterministic(&scene(0.0, 0.0, given), &TIMELINE), never);
        let at_once = Timeline {
            end: 0.0,
            ..TIMELINE
        };
        assert_eq!(
            deterministic(&scene(7.0, 2.0, given), &at_once),
            Statistic::ALL
        );
        assert_eq!(deterministic(&model(), &TIMELINE), Statistic::ALL);
    }
}
