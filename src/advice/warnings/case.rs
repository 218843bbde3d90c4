//! A scenario with the numbers on which its warnings depend.

use super::noisy_step::NoisyStep;
use super::slip::Slip;
use super::steepness::Stiffened;
use crate::advice::derived::Derived;
use crate::scenario::Scenario;
use crate::scheme::Discretisation;

/// A scenario with the numbers on which its warnings depend.
pub(super) struct Case<'a> {
    pub scenario: &'a Scenario,
    pub derived: Derived,
    /// The step h, for schemes that have one.
    pub step: Option<f64>,
    /// The body where a user-defined force is steepest, for schemes that have a step.
    pub stiffened: Option<Stiffened>,
    /// The noise in a step, for a scheme that checks for stick exits once per step.
    pub checked: Option<NoisyStep>,
    /// The noise in a step, for a scheme that checks for them once per step and corrects for this.
    pub corrected: Option<NoisyStep>,
    /// A slip of the quasi-static recursion.
    pub slip: Option<Slip>,
}

impl<'a> Case<'a> {
    pub fn new(scenario: &'a Scenario) -> Self {
        let derived = scenario.derived();
        let noisy = |h| NoisyStep::of(&scenario.model, &derived, h);
        let (step, checked, corrected, slip) = match scenario.scheme.discretisation() {
            Discretisation::Step { h } => (Some(h), noisy(h), None, None),
            Discretisation::CorrectedStep { h } => (Some(h), None, noisy(h), None),
            Discretisation::Tolerance { .. } => (None, None, None, None),
            Discretisation::Approximation => (None, None, None, Some(Slip::of(&scenario.model))),
        };
        let stiffened = step.and_then(|_| Stiffened::of(scenario, &derived));
        Case {
            scenario,
            derived,
            step,
            stiffened,
            checked,
            corrected,
            slip,
        }
    }

    /// The noise in a step, whether or not the scheme corrects for it.
    pub fn noisy_step(&self) -> Option<&NoisyStep> {
        self.checked.as_ref().or(self.corrected.as_ref())
    }
}
