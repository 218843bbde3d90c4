//! The mechanics: the oscillator, dry friction, the temperature, and the types that describe the
//! cascade of phases.
//!
//! There are only pure functions and plain values here; no random number is drawn.
//!
//! ```text
//! m x'' + F(x') = b(x, x', t),   x(0) = x0, x'(0) = v0
//! b = K (beta T(t) - x) - 2 alpha x' + g(x, x', t)
//! T(t) = offset + trend t + sum_i a_i cos(w_i t + phi_i) + S(t) + rho v(t),   dv = -theta v dt + sigma dW
//! ```
//!
//! S is the measured temperature, and g a user-defined force. If the temperature acts as a force, c
//! T replaces K beta T.
//!
//! Bensoussan, Brouste, Cartiaux, Mathey, Mertz, *Mathematical formulation of a dynamical system
//! with dry friction subjected to external forces*, equations (friction1), (engapp), (shaw).

/// The paper in which the model and the scheme `discrete-vi` were published.
pub const PAPER: &str = "A. Bensoussan, A. Brouste, F. B. Cartiaux, C. Mathey, L. Mertz, Mathematical formulation of a \
                         dynamical system with dry friction subjected to external forces.";

mod absorbed;
mod build;
mod cascade;
mod complex;
mod force;
mod friction;
mod harmonic_clock;
mod impulse_response;
mod limits;
mod oscillator;
mod random_input;
mod series;
mod slip_flow;
mod step_response;
mod temperature;
#[cfg(test)]
pub(crate) mod tests;

pub(crate) use absorbed::Absorbed;
pub use cascade::{Event, EventKind, Phase, Sign};
pub use complex::Complex;
pub use force::{
    Expression, ExpressionError, Force, ForceLaw, ForceWarning, Hold, Linear, Scales, Sides,
    Steepest, beyond_hold, force_warnings, steepest,
};
pub use friction::{Friction, let_go, prox};
#[doc(hidden)]
pub use harmonic_clock::HarmonicClock;
#[doc(hidden)]
pub use impulse_response::ImpulseResponse;
pub use limits::{LARGEST, can_be_computed_with};
pub use oscillator::{Drive, Oscillator};
pub use rand_core::Rng;
pub use random_input::{
    InputProcess, InputSpectrum, OwnProcess, ProcessMoments, PulseShape, PulseSize, RandomInput,
    RandomProcess, Realisations,
};
pub use series::{NamedSeries, NoSeries, Series};
pub(crate) use series::{before, fnv1a};
pub use series::{is_jump, usual_spacing};
pub use slip_flow::{ForcedOscillator, ForcingTerm, SlipFlow};
#[doc(hidden)]
pub use step_response::SETTLED;
pub use step_response::StepResponse;
pub use temperature::{Harmonic, InitialNoise, OrnsteinUhlenbeck, Temperature};

use crate::lanes::InstructionSet;
use std::sync::Arc;

/// The physical model: one oscillator, its friction, its temperature and its initial displacement.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Mass, stiffness, damping, and how the temperature drives the body.
    pub oscillator: Oscillator,
    /// The two Coulomb thresholds.
    pub friction: Friction,
    /// The temperature, which drives the oscillator.
    pub temperature: Temperature,
    /// A user-defined force, g(x, x', t), which is added to b.
    pub force: Option<Force>,
    /// The inputs, and the temperature, that are drawn anew for each path. Where the force, the load
    /// of friction or the temperature have samples of their names, these are those of one path.
    pub random: Vec<RandomInput>,
    /// x(0), a length.
    pub initial_displacement: f64,
    /// x'(0), a length per time. A body that moves at t = 0 is in its first dynamic phase, and its
    /// first static phase is empty.
    pub initial_velocity: f64,
}

impl Problem {
    /// Whether paths differ.
    pub fn is_random(&self) -> bool {
        self.temperature.is_random() || !self.random.is_empty()
    }

    /// The problem with these samples for its inputs and its measured temperature, by the names of
    /// their tables, and without random ones.
    pub fn with_inputs(&self, samples: &[(String, Arc<Series>)]) -> Problem {
        let found = |name: &str| {
            let sample = samples.iter().find(|(of, _)| of == name);
            sample.map(|(_, series)| series.clone())
        };
        let of_input = |name: &str| found(&format!("input.{name}"));
        let series = found("temperature.series").or(self.temperature.series.clone());
        Problem {
            temperature: Temperature {
                series,
                ..self.temperature.clone()
            },
            force: self
                .force
                .as_ref()
                .map(|force| force.with_samples(&of_input)),
            random: Vec::new(),
            ..self.clone()
        }
    }

    /// b(x, x', t) at this temperature: the sum of all forces except friction.
    pub fn total_force(
        &self,
        time: f64,
        temperature: f64,
        displacement: f64,
        velocity: f64,
    ) -> f64 {
        let linear = self.oscillator.force(temperature, displacement, velocity);
        self.user_force(time, displacement, velocity)
            .map_or(linear, |own| linear + own)
    }

    /// The direction in which a body at rest at x starts to slip, at this temperature; none if
    /// friction holds it.
    pub fn let_go(&self, time: f64, temperature: f64, displacement: f64) -> Option<Sign> {
        let linear = self.oscillator.force(temperature, displacement, 0.0);
        let hold = self
            .force
            .as_ref()
            .map(|force| force.hold(InstructionSet::detect(), displacement, time));
        let Hold { pull, excess } = hold.unwrap_or_default();
        let_go(linear + pull, self.friction.limits(excess))
    }

    /// g in a slip in this direction, whatever the velocity; 0 without g.
    pub fn sliding_force(
        &self,
        direction: Sign,
        time: f64,
        displacement: f64,
        velocity: f64,
    ) -> f64 {
        self.force.as_ref().map_or(0.0, |force| {
            let own = force.sides().map_or(force, |sides| sides.own(direction));
            own.at(InstructionSet::detect(), displacement, velocity, time)
        })
    }

    /// The force of friction in a slip in this direction.
    pub fn sliding_friction(
        &self,
        direction: Sign,
        time: f64,
        displacement: f64,
        velocity: f64,
    ) -> f64 {
        let sides = self.force.as_ref().and_then(Force::sides);
        let size = sides.map(|sides| sides.dynamic_force(direction, displacement, velocity, time));
        direction.value() * size.unwrap_or(self.friction.dynamic_force)
    }

    /// The same at eight x, x' and t at once, hardly slower than at one.
    pub fn sliding_frictions(&self, direction: Sign, at: [&[f64; 8]; 3]) -> [f64; 8] {
        let sides = self.force.as_ref().and_then(Force::sides);
        let sizes = sides.map_or([self.friction.dynamic_force; 8], |sides| {
            sides.dynamic_forces(direction, at)
        });
        sizes.map(|size| direction.value() * size)
    }

    /// f_s and f_d forward and backward, without a load.
    pub fn friction_by_direction(&self) -> [Friction; 2] {
        self.force
            .as_ref()
            .and_then(Force::sides)
            .map_or([self.friction; 2], Sides::friction)
    }

    /// Whether the force of friction varies in a slip.
    pub fn has_load(&self) -> bool {
        self.force
            .as_ref()
            .is_some_and(|force| force.sides().is_some())
    }

    /// g(x, x', t), the user-defined force, if there is one.
    pub fn user_force(&self, time: f64, displacement: f64, velocity: f64) -> Option<f64> {
        Some(
            self.force
                .as_ref()?
                .at(InstructionSet::detect(), displacement, velocity, time),
        )
    }
}
