//! Files of many runs, and of a fit.

use super::{Again, Arguments};
use crate::arguments::measurements;
use crate::output::failure::Failure;
use crate::output::numbers::grouped;
use std::fmt::Display;
use std::sync::atomic::AtomicBool;
use stickslip::study::sweep::{Point, SweepSimulation};
use stickslip_bearing::calibration::{Calibration, CalibrationQuestion, Quantity, calibrate_again};
use stickslip_files::dataset::Dataset;
use stickslip_files::store::{self, StoreError, StoredCalibration, StoredSweep, StoredTrade};

impl Arguments {
    /// Check a sweep: all points are simulated again. The time that each took is that of the file.
    pub(super) fn sweep(&self, stored: &StoredSweep) -> Result<Again, Failure> {
        let mut again = stored.sweep.clone();
        let count = again.points.len();
        let before = std::mem::replace(&mut again.points, vec![None; count]);
        let simulation = SweepSimulation {
            threads: self.threads.number(),
            stop: &AtomicBool::new(false),
            progress: &mut (),
        };
        simulation
            .run(&mut again, |_| Ok::<_, StoreError>(()))
            .map_err(|end| Failure::Run(end.to_string()))?;
        for (point, before) in again.points.iter_mut().zip(before) {
            let both = point.take().zip(before);
            *point = both.map(|(point, Point { seconds, .. })| Point { seconds, ..point });
        }
        Ok(Again {
            simulated: format!("{} points", grouped(count as u64)),
            compared: "statistics, comparisons between points, attributes, coordinates and units",
            found: store::verify(&self.file, &Dataset::of_sweep(&again))?,
        })
    }

    /// Check a trade: everything that follows from its measurements is computed again.
    pub(super) fn trade(&self, stored: &StoredTrade) -> Result<Again, Failure> {
        let again = Dataset::of_trade(&stored.scenario, &stored.trade);
        Ok(Again {
            simulated: "nothing: times cannot be reproduced, and estimates depend on them".into(),
            compared: "every bias, order and prediction with the stored measurements, attributes, \
                       coordinates and units",
            found: store::verify(&self.file, &again)?,
        })
    }

    /// Check a calibration: the question is read from the scenario again, and the fit is repeated
    /// with the record that is in the file.
    pub(super) fn calibration(&self, stored: &StoredCalibration) -> Result<Again, Failure> {
        let wrong = |error: &dyn Display| Failure::Run(format!("{}: {error}", self.file.display()));
        // A scenario without a title is called by the name of its file.
        let scene =
            measurements::scene_again(&format!("{}.toml", stored.title), &stored.scenario_text)?;
        let Calibration {
            question, record, ..
        } = &stored.calibration;
        let CalibrationQuestion {
            guess,
            shear_stiffness,
            ..
        } = CalibrationQuestion::of(&scene, record);
        let question = CalibrationQuestion {
            guess,
            shear_stiffness,
            held: Vec::new(),
            ..question.clone()
        };
        let is_held = |quantity: &Quantity| {
            stored
                .calibration
                .question
                .held
                .iter()
                .any(|held| held.0 == *quantity)
        };
        let fitted: Vec<Quantity> = Quantity::FITTED
            .into_iter()
            .filter(|quantity| !is_held(quantity))
            .collect();
        let question = question
            .fitting(&fitted, &scene)
            .map_err(|error| wrong(&error))?;
        let asked = Calibration {
            question,
            ..stored.calibration.clone()
        };
        let again = calibrate_again(&asked, self.threads.number(), &AtomicBool::new(false));
        let again = again.map_err(|error| wrong(&error))?;
        let again = StoredCalibration::of(&scene.title, &stored.scenario_text, again);
        Ok(Again {
            simulated: "the fit, with the record in the file".into(),
            compared: "title, question, estimates, intervals, slips, the model, attributes, coordinates and units",
            found: store::verify(&self.file, &Dataset::of_calibration(&again))?,
        })
    }
}
