//! The estimates from slips, and their errors.

use super::bearing::Response;
use super::course::{Course, CourseShape};
use super::fit::SlipFit;
use super::friction::SlipStatistics;
use super::hold::conditioned;
use super::quantity::{Quantity, Values, response_of, values};
use super::question::{CalibrationError, CalibrationQuestion};
use super::slips::DetectedSlips;
use super::steel::Steel;
use super::uncertainty::{Replicates, Workers};
use super::zero::Zero;

/// The estimates from the slips of a record.
pub struct BySlips {
    /// The response at mean friction.
    pub response: Response,
    /// How the zero of the sensor moves.
    pub zero: Zero,
    /// How friction varies over time.
    pub course: Course,
    pub replicates: Replicates,
    /// The standard deviation of each quantity.
    pub deviations: Values,
    pub slips: DetectedSlips,
    /// Further statistics of the slips.
    pub statistics: SlipStatistics,
    /// If the thermometer is slower than the steel: A relative to that with a fast thermometer.
    pub slow_share: Option<f64>,
}

/// A relative change of A below this is harmless.
const HARMLESS: f64 = 0.05;

impl BySlips {
    /// Estimate all quantities from the slips, with some of them fixed. `None` if the slips do not
    /// determine them.
    ///
    /// # Errors
    ///
    /// If the jumps are not the slips of a bearing, or do not determine its parameters.
    pub fn new(
        steel: &mut Steel,
        question: &CalibrationQuestion,
        workers: Workers,
    ) -> Result<Option<Self>, CalibrationError> {
        let Some(slips) = steel.slips.take().map(without_harmless_course) else {
            return Ok(None);
        };
        let Some(mut found) = BySlips::fitted(steel, slips, question, workers)? else {
            return Ok(None);
        };
        let chance = found.replicates.mean_of(|shown| shown.zero_gain);
        let columns = &found.slips.zero;
        if !columns.is_convincing(found.statistics.zero_gain, chance) {
            let mut slips = found.slips;
            slips.zero = slips.zero.none();
            match BySlips::fitted(steel, slips, question, workers)? {
                Some(without) => found = without,
                None => return Ok(None),
            }
        }
        let shear = question.shear_stiffness.unwrap_or(1.0);
        let estimates = values(&found.response, Some(shear));
        let held = conditioned(estimates, &mut found.replicates, &question.held, shear);
        found.response = response_of(&held);
        found.deviations = found.replicates.deviations();
        found.check(question.shear_stiffness)?;
        Ok(Some(found))
    }

    /// The same with all quantities estimated.
    fn fitted(
        steel: &mut Steel,
        slips: DetectedSlips,
        question: &CalibrationQuestion,
        workers: Workers,
    ) -> Result<Option<Self>, CalibrationError> {
        let Some(fit) = slips.fit() else {
            return Ok(None);
        };
        let mut found = BySlips {
            response: fit.response,
            course: fit.course,
            statistics: slips.statistics(&fit),
            slow_share: steel.slow_share,
            zero: fit.zero.clone(),
            replicates: Replicates::default(),
            deviations: [f64::NAN; Quantity::ALL.len()],
            slips,
        };
        found.check(question.shear_stiffness)?;
        let shear = question.shear_stiffness;
        let corrected = Replicates::corrected(steel, (&found.slips, &fit), shear, workers);
        let (response, course, replicates) = corrected.ok_or(found.undetermined([1, 1]))?;
        let [impossible, all] = replicates.impossible();
        if 2 * impossible > all {
            return Err(found.undetermined([impossible, all]));
        }
        found.response = response;
        found.course = course;
        found.replicates = replicates.with_shear(shear.unwrap_or(1.0));
        found.check(shear)?;
        Ok(Some(found))
    }

    /// Check that the jumps are the slips of a bearing.
    fn check(&self, shear_stiffness: Option<f64>) -> Result<(), CalibrationError> {
        let jumps = self.slips.slips.len();
        let not_slips = |(quantity, value)| CalibrationError::NotSlips {
            jumps,
            quantity,
            value,
        };
        let impossible = self.response.impossible(shear_stiffness);
        impossible.map_or(Ok(()), |found| Err(not_slips(found)))
    }

    fn undetermined(&self, [impossible, all]: [usize; 2]) -> CalibrationError {
        CalibrationError::Undetermined {
            jumps: self.slips.slips.len(),
            impossible,
            all,
        }
    }
}

/// The same slips with constant friction, if it changes by little.
fn without_harmless_course(slips: DetectedSlips) -> DetectedSlips {
    let range = slips
        .fit()
        .map(|fit: SlipFit| fit.course.range(&fit.response.motion));
    match range.is_some_and(|[low, high]| high - low > HARMLESS) {
        true => slips,
        false => slips.with_shape(CourseShape::Constant),
    }
}
