//! The discrete variational inequality of the paper.
//!
//! Its error is of order 1 in h without randomness. Under noise it is of order 1/2 in every
//! statistic of sticks, because stick exits are checked only once per step h.

use super::limits;
use super::simulation::DiscreteSimulation;
use crate::model::{Oscillator, Problem};
use crate::scheme::{
    Appearance, CheckError, Discretisation, Method, Parameter, Stability, Timeline,
};
use std::f64::consts::PI;

/// The discrete variational inequality with this step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscreteVi {
    /// The time step h > 0.
    pub step: f64,
}

impl Method for DiscreteVi {
    const NAME: &'static str = "discrete-vi";
    const MEANING: &'static str = "the discrete variational inequality";
    const PARAMETER: Parameter = Parameter::Step;
    const APPEARANCE: Appearance = Appearance {
        colour: "#D55E00",
        dash: "8 4",
    };
    type Simulation = DiscreteSimulation;

    fn with(step: f64) -> Self {
        DiscreteVi { step }
    }

    fn parameter(self) -> f64 {
        self.step
    }

    fn simulation(self, model: &Problem, timeline: &Timeline) -> DiscreteSimulation {
        DiscreteSimulation::new(model, timeline, self.step)
    }

    fn discretisation(self) -> Discretisation {
        Discretisation::Step { h: self.step }
    }

    /// A step multiplies (X, V) by 1 + h lambda along each eigenvector, where lambda solves m
    /// lambda^2 + 2 alpha lambda + K = 0.
    ///
    /// ```text
    /// alpha = 0        |1 + i h w0| > 1 for every h: the amplitude grows by exp(pi w0 h/2) per
    ///                  half-cycle while friction takes 2 f_d/K from it; the two balance at
    ///                  A_c = 4 f_d/(pi w0 h K)
    /// alpha^2 < K m    |1 + h lambda| < 1 iff h < 2 alpha/K
    /// alpha^2 >= K m   |1 + h lambda| < 1 for both lambda iff h < 2/|lambda_max|,
    ///                  |lambda_max| = (alpha + sqrt(alpha^2 - K m))/m
    /// alpha < 0        the body itself grows, and the step adds K h/2 to -alpha
    /// K = alpha = 0    nothing grows but by the force
    /// ```
    fn stability(self, model: &Problem) -> Option<Stability> {
        let Oscillator {
            stiffness: k,
            damping: alpha,
            ..
        } = model.oscillator;
        let (w0, gamma) = (
            model.oscillator.natural_frequency(),
            model.oscillator.damping_rate(),
        );
        if alpha < 0.0 {
            let growing = model.runaway_amplitude(0.5 * k * self.step);
            return growing.map(|critical_amplitude| Stability::Growing { critical_amplitude });
        }
        if alpha == 0.0 {
            let critical_amplitude = 4.0 * model.friction.dynamic_force / (PI * w0 * self.step * k);
            return (k > 0.0).then_some(Stability::Undamped { critical_amplitude });
        }
        Some(if gamma < w0 {
            Stability::Underdamped {
                largest_step: 2.0 * alpha / k,
            }
        } else {
            Stability::Overdamped {
                largest_step: 2.0 / (gamma + ((gamma - w0) * (gamma + w0)).sqrt()),
            }
        })
    }

    fn check(self, model: &Problem, end: f64) -> Result<(), CheckError> {
        limits::check_noise(model)?;
        limits::check_step(model, self.step, end)?;
        limits::check_increments(model, self.step)
    }
}
