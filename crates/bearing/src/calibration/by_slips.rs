//! The estimates from slips, and their errors.

use super::bearing::Response;
use super::friction::SlipStatistics;
use super::hold::conditioned;
use super::quantity::{Values, response_of, values};
use super::question::{CalibrationError, CalibrationQuestion};
use super::slips::DetectedSlips;
use super::steel::Steel;
use super::uncertainty::{Replicates, Workers};
use super::zero::Zero;

/// The estimates from the slips of a record.
pub struct BySlips {
    pub response: Response,
    /// How the zero of the sensor moves.
    pub zero: Zero,
    pub replicates: Replicates,
    /// The standard deviation of each quantity.
    pub deviations: Values,
    pub slips: DetectedSlips,
    /// What the slips show beyond the estimates.
    pub statistics: SlipStatistics,
}

/// Twice the logarithm of the likelihood that a change of friction over time has to gain. Neighbouring
/// values have errors in common, so chance gains more than it would if they were independent.
const CONVINCING: f64 = 25.0;

/// A smaller change of A than this share of it does no harm.
const HARMLESS: f64 = 0.05;

impl BySlips {
    /// Estimate all quantities from the slips, with some of them held. `None` if no slips determine
    /// them.
    ///
    /// # Errors
    ///
    /// If the jumps are not those of a bearing, or do not determine one.
    pub fn new(
        steel: &mut Steel,
        question: &CalibrationQuestion,
        workers: Workers,
    ) -> Result<Option<Self>, CalibrationError> {
        let Some(slips) = steel.slips.take() else {
            return Ok(None);
        };
        let Some((fit, zero)) = slips.fit() else {
            return Ok(None);
        };
        let jumps = slips.slips.len();
        let check = |response: &Response| match response.impossible(question.shear_stiffness) {
            Some((quantity, value)) => Err(CalibrationError::NotSlips {
                jumps,
                quantity,
                value,
            }),
            None => Ok(()),
        };
        check(&fit)?;
        let shear = question.shear_stiffness.unwrap_or(1.0);
        let corrected = Replicates::corrected(
            steel,
            &slips,
            (fit, slips.noise(&fit, &zero)),
            question.shear_stiffness,
            workers,
        );
        let undetermined = |[impossible, all]: [usize; 2]| CalibrationError::Undetermined {
            jumps,
            impossible,
            all,
        };
        let (response, replicates) = corrected.ok_or(undetermined([1, 1]))?;
        let mut replicates = replicates.with_shear(shear);
        let [impossible, all] = replicates.impossible();
        if 2 * impossible > all {
            return Err(undetermined([impossible, all]));
        }
        check(&response)?;
        let estimates = values(&response, Some(shear));
        let held = conditioned(estimates, &mut replicates, &question.held, shear);
        let response = response_of(&held);
        check(&response)?;
        Ok(Some(BySlips {
            response,
            zero,
            deviations: replicates.deviations(),
            statistics: slips.statistics(&fit),
            replicates,
            slips,
        }))
    }

    /// The smallest and the largest A over the record, as shares of its mean, if it changes.
    pub fn friction_range(&self) -> Option<[f64; 2]> {
        let SlipStatistics { gain, range, .. } = self.statistics;
        let is_convincing = gain > CONVINCING && range[1] - range[0] > HARMLESS;
        (is_convincing && range[0] > 0.0 && range[1].is_finite()).then_some(range)
    }
}
