//! The cascade under Ornstein-Uhlenbeck noise, exact in law up to the tolerance.
//!
//! A path is taken from macro step to macro step ([`super::macro_step_loop`]); n at the end of the
//! macro step is drawn first.
//!
//! - Stick: the bridge of n between known values may cross a threshold ([`super::law::stick band`]).
//! - Slip: exact steps of (x, x', n) ([`DrivenOscillator`]), given n at their ends, each of which
//!   is searched for the first zero of x' ([`super::law::first_stop`]). Where a slip stops, the
//!   state that was drawn at the end of the step is discarded: what follows depends only on n at
//!   the end of the macro step.
//!
//! A macro step is as long as one step of a slip. Where the body oscillates much faster than
//! forcing and noise change, a macro step is as long as these allow. Then a slip makes many steps
//! in a macro step, and n at their ends is drawn from its bridge to the end of the macro step.

use super::law::{DrivenOscillator, Scene, SlipStep, StepRules, StopSearch};
use super::macro_step_loop;
use super::scalar::{Propagation, ScalarPaths};
use super::vectorised::Vectorised;
use super::work::{OWN_FORCE, Simulated};
use crate::lanes::InstructionSet;
use crate::model::Problem;
use crate::scheme::{Observer, Timeline};
use std::cell::RefCell;

/// The noisy scheme for one scene.
#[derive(Clone, Debug)]
pub struct Noisy {
    pub(super) scene: Scene,
    pub(super) propagation: Propagation,
    pub(super) oscillator: DrivenOscillator,
    /// The slip step of the usual length. It covers a whole macro step where
    /// [`Noisy::has_one_step_a_macro_step`].
    pub(super) step: SlipStep,
    /// The usual step, its half, its quarter and so on, where there is a user-defined force.
    pub(super) halved: Vec<SlipStep>,
    pub(super) rules: StepRules,
    pub(super) search: StopSearch,
}

/// If the fastest rate of the body is more than this multiple of the rates of forcing and noise,
/// the length of a macro step follows from forcing and noise instead.
const TWO_SCALES: f64 = 16.0;

/// The most halvings of a slip step under a user-defined force.
const FINEST_HALVING: u32 = 24;

/// Up to this number of paths are simulated one by one, because they do not fill the lanes. So are
/// those whose motion is followed.
const FEW: usize = 8;

impl Noisy {
    /// The scheme for a scene with noise.
    pub fn new(model: &Problem, timeline: &Timeline, rules: &StepRules) -> Self {
        let mut scene = Scene::new(model);
        scene.friction.static_force += rules.added_gap(&scene);
        let body = scene.oscillator;
        let frequencies: Vec<f64> = scene
            .harmonics
            .iter()
            .map(|h| h.angular_frequency)
            .collect();
        let oscillator = DrivenOscillator::new(
            body.mass,
            body.damping_rate(),
            body.natural_frequency(),
            scene.relaxation_rate,
            scene.diffusion,
            &frequencies,
        );
        let fastest = oscillator.fastest_rate().max(scene.noise_rate());
        let longest = rules.slip_length / fastest;
        let slow = frequencies
            .iter()
            .copied()
            .fold(scene.noise_rate(), f64::max);
        let is_swift = fastest > TWO_SCALES * slow;
        let longest_macro_step = if is_swift {
            rules.slip_length / slow
        } else {
            longest
        };
        // Any oscillation at rest is sampled often enough to be resolved.
        let longest_macro_step =
            longest_macro_step.min(rules.slip_length / scene.own.fastest_rate(timeline.end));
        let cost = if scene.own.is_some() { OWN_FORCE } else { 1 };
        let propagation = Propagation::new(&scene, timeline, rules, longest_macro_step, cost);
        let macro_step_length = propagation.grid.length;
        let length = macro_step_length / (macro_step_length / longest).ceil();
        let step = SlipStep::new(&oscillator, frequencies.len(), length);
        let halvings = if scene.own.is_some() {
            FINEST_HALVING + 1
        } else {
            0
        };
        let halved = |n| {
            SlipStep::new(
                &oscillator,
                frequencies.len(),
                length / f64::from(1u32 << n),
            )
        };
        let halved = (0..halvings).map(halved).collect();
        let search = StopSearch {
            noise: scene.diffusion / body.mass,
            caution: rules.caution,
        };
        Noisy {
            scene,
            propagation,
            oscillator,
            step,
            halved,
            rules: *rules,
            search,
        }
    }

    /// Whether the paths can be simulated vectorised: all macro steps have one length, there is
    /// only one noise, and neither has friction a load nor a force a direction.
    pub fn has_equal_macro_steps(&self) -> bool {
        !self.scene.own.has_load()
            && self.scene.two_noises.is_none()
            && self.propagation.grid.is_even()
    }

    /// Whether slips can be simulated vectorised too: the macro steps have the length of one slip
    /// step, and its transition is a sum of power series without doubling.
    pub fn has_one_step_a_macro_step(&self) -> bool {
        let length = self.step.length();
        self.has_equal_macro_steps()
            && self.propagation.grid.length == length
            && self.oscillator.has_series_for(length)
    }

    /// The best number of paths to simulate together: enough to fill the registers with the flagged
    /// lanes of one macro step, few enough to stay in the cache.
    pub fn vectorised_paths(&self) -> usize {
        if self.has_one_step_a_macro_step() {
            1024
        } else {
            1
        }
    }

    /// Simulates the paths with these numbers.
    pub fn simulate(&self, seed: u64, paths: &[u64], observer: &mut dyn Observer) -> Simulated {
        let (instructions, follows) = (InstructionSet::detect(), observer.follows());
        let observer = RefCell::new(observer);
        let is_stopped = || observer.borrow().is_stopped();
        if paths.len() > FEW && self.has_equal_macro_steps() && !follows {
            let mut all = Vectorised::new(self, instructions, seed, paths, &is_stopped);
            return macro_step_loop::simulate(&mut all, paths.len(), &observer);
        }
        let mut all = ScalarPaths::new(self, seed, paths, &is_stopped, follows);
        macro_step_loop::simulate(&mut all, paths.len(), &observer)
    }
}
