//! A slip step that begins with the macro step and has the same length in all lanes.

use super::super::law::{MacroStep, Push, SlipPoint, SlipStep, SlipTransition, splat};
use super::super::noisy::Noisy;
use crate::lanes::Lanes;

/// The transition of (x, x', n) over the step, and the contribution of the forcing.
pub(super) struct SharedStep<L: Lanes> {
    pub transition: SlipTransition<L>,
    pushes: Vec<Push>,
    /// B at the end of the step.
    pub forcing: f64,
}

impl<L: Lanes> SharedStep<L> {
    /// The step from the start of the macro step to a time inside it.
    #[inline(always)]
    pub fn until(noisy: &Noisy, macro_step: &MacroStep, after: f64) -> Self {
        Self::new(
            &SlipStep::new(&noisy.oscillator, noisy.step.harmonics.len(), after),
            macro_step,
        )
    }

    /// A step that begins with this macro step.
    #[inline(always)]
    pub fn new(step: &SlipStep, macro_step: &MacroStep) -> Self {
        let pushes: Vec<Push> = step
            .harmonics
            .iter()
            .zip(&macro_step.terms)
            .map(|(response, term)| response.push(*term))
            .collect();
        let forcing = pushes.iter().map(|push| push.term.re).sum();
        SharedStep {
            transition: splat(&step.transition),
            pushes,
            forcing,
        }
    }

    /// The mean state at the end of the step.
    #[inline(always)]
    pub fn mean(&self, start: SlipPoint<L>, friction: L) -> SlipPoint<L> {
        let mut mean = self.transition.free(start, friction);
        for push in &self.pushes {
            (mean.x, mean.v) = (mean.x + push.x, mean.v + push.v);
        }
        mean
    }
}
