//! The estimates from slips, and their errors.

use super::bearing::Response;
use super::hold::conditioned;
use super::quantity::{Values, response_of, values};
use super::question::{CalibrationError, CalibrationQuestion};
use super::slips::Evidence;
use super::uncertainty::{AroundLag, Replicates};
use super::zero::Zero;

/// What the slips of a record tell.
pub struct BySlips<'a> {
    /// The response; `None` if the slips do not determine it.
    pub response: Option<Response>,
    /// How the zero of the sensor moves.
    pub zero: Zero,
    pub replicates: Replicates,
    /// The standard deviation of each quantity.
    pub deviations: Values,
    evidence: &'a Evidence,
}

impl<'a> BySlips<'a> {
    /// Estimate all quantities from the evidence, with some of them held.
    pub fn of(around: &'a AroundLag, question: &CalibrationQuestion) -> Self {
        let shear = question.shear_stiffness.unwrap_or(1.0);
        let evidence = &around.here;
        let mut replicates = Replicates::new(around, question);
        let fitted = evidence.fit(&evidence.unweighted());
        let response = fitted.as_ref().map(|(fit, _)| {
            response_of(&conditioned(
                values(fit, Some(shear)),
                &mut replicates,
                &question.held,
                shear,
            ))
        });
        let deviations = replicates.deviations();
        let zero = fitted.map_or_else(Zero::default, |(_, zero)| zero);
        BySlips {
            response,
            zero,
            replicates,
            deviations,
            evidence,
        }
    }

    /// Check that the jumps are the slips of a bearing, and that they tell which: more than half of
    /// the random weights have to give a possible bearing.
    pub fn check(&self, shear_stiffness: Option<f64>) -> Result<(), CalibrationError> {
        let jumps = self.evidence.slips.len();
        let found = self
            .response
            .and_then(|response| response.impossible(shear_stiffness));
        if let Some((quantity, value)) = found {
            return Err(CalibrationError::NotSlips {
                jumps,
                quantity,
                value,
            });
        }
        let [impossible, all] = self.replicates.impossible();
        if 2 * impossible > all {
            return Err(CalibrationError::Undetermined {
                jumps,
                impossible,
                all,
            });
        }
        Ok(())
    }

    /// The slips, if they determine the response.
    pub fn evidence(&self) -> Option<&'a Evidence> {
        Some(self.evidence).filter(|_| self.response.is_some())
    }
}
