//! The energy that each force gives to the body, on request.

use super::Statistic;
use super::measure::{Measure, Sampled};
use super::motion::{MotionFold, Works};
use crate::sums::Replicate;
use crate::sums::codec::sums;
use crate::sums::interval::Measured;
use crate::sums::moments::FourMoments;
use crate::sums::rare::{FEWEST, FEWEST_FOR_SPREAD};
use crate::sums::spread::SpreadMoments;

sums! {
    /// Moments over paths of the works.
    #[derive(Clone, Debug, Default, PartialEq)]
    pub(super) struct EnergySums {
        temperature: FourMoments,
        user_force: FourMoments,
        damping: FourMoments,
        change: FourMoments,
        residual: SpreadMoments,
        /// Units that move in the counted time.
        moving: u64,
    }
}

impl EnergySums {
    /// The sums over the paths of a block.
    pub fn of(paths: &[MotionFold], unit: Replicate) -> Self {
        let moments =
            |of: fn(&Works) -> f64| FourMoments::of(&unit.column(paths, |path| of(&path.works)));
        let residuals: Vec<f64> = paths.iter().map(MotionFold::residual).collect();
        EnergySums {
            temperature: moments(|works| works.temperature),
            user_force: moments(|works| works.user_force),
            damping: moments(|works| works.damping),
            change: moments(Works::change),
            residual: SpreadMoments::of(&residuals, unit),
            moving: unit.count(paths, |path| path.travel > 0.0),
        }
    }
}

impl Measure for EnergySums {
    fn measured(&self, statistic: Statistic, _: &Sampled) -> Option<Measured> {
        // Stored energy is a square, whose law has long tails if few bodies move.
        let mean = |of: &FourMoments| {
            Measured::mean_of_four(of).of_few(self.moving, of.two.count, FEWEST_FOR_SPREAD)
        };
        Some(match statistic {
            Statistic::TemperatureWorkMean => mean(&self.temperature),
            Statistic::UserForceWorkMean => mean(&self.user_force),
            Statistic::DampingWorkMean => Measured::mean_of_four(&self.damping).of_few(
                self.moving,
                self.damping.two.count,
                FEWEST,
            ),
            Statistic::StoredEnergyMean => mean(&self.change),
            Statistic::EnergyResidualMean => Measured::mean_of_four(&self.residual.units),
            Statistic::EnergyResidualSd => self.residual.standard_deviation(),
            _ => return None,
        })
    }
}
