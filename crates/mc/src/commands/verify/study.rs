//! Files of many runs, and of a fit.

use super::{Arguments, Checked};
use crate::arguments::measurements;
use crate::commands::sweep;
use crate::output::failure::Failure;
use crate::output::numbers::grouped;
use serde_json::json;
use std::collections::{BTreeSet, HashSet};
use std::fmt::Display;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use stickslip::study::sweep::{Sweep, SweepSimulation};
use stickslip_bearing::calibration::{Calibration, CalibrationQuestion, Quantity, calibrate_again};
use stickslip_files::dataset::Dataset;
use stickslip_files::saved::{BlocksAgain, drawn};
use stickslip_files::store::{self, StoreError, StoredCalibration, StoredSweep, StoredTrade};

impl Arguments {
    /// Check a sweep: points are simulated again, and all comparisons are computed again.
    pub(super) fn sweep(&self, stored: &StoredSweep) -> Result<Checked, Failure> {
        let mut again = sweep::stored(&self.file, stored.clone())?;
        let all = again.points.len() as u64;
        let (wanted, limit) = match self.sample() {
            BlocksAgain::All => (all, None),
            BlocksAgain::Some(wanted) => (wanted.min(all), None),
            BlocksAgain::Within(limit) => (all, Some(limit)),
        };
        let (start, mut done) = (Instant::now(), BTreeSet::new());
        // A set with hashes has a random order.
        for point in drawn(&(0..all), wanted).into_iter().collect::<HashSet<_>>() {
            if limit.is_some_and(|limit| !done.is_empty() && start.elapsed() > limit) {
                break;
            }
            self.simulate_point(&mut again, point as usize)?;
            done.insert(point);
        }
        let is_whole = done.len() as u64 == all;
        Ok(Checked {
            simulated: format!("{} of {} points", grouped(done.len() as u64), grouped(all)),
            compared: "statistics, comparisons between points, attributes, coordinates and units"
                .into(),
            not_compared: (!is_whole).then(|| {
                "the other points against a simulation; --blocks all simulates every point"
                    .to_string()
            }),
            fields: json!({ "points": all, "points_checked": done, "statistics_checked": is_whole }),
            found: store::verify_whole(&self.file, &Dataset::of_sweep(&again))?,
            other_program: stored.other_program.clone(),
        })
    }

    /// Simulate a point of the sweep again. The time that it took is that of the file.
    fn simulate_point(&self, sweep: &mut Sweep, point: usize) -> Result<(), Failure> {
        let Some(stored) = sweep.points[point].take() else {
            return Ok(());
        };
        let simulation = SweepSimulation {
            threads: self.threads.number(),
            stop: &AtomicBool::new(false),
            progress: &mut (),
        };
        simulation
            .run(sweep, |_| Ok::<_, StoreError>(()))
            .map_err(|end| Failure::Run(end.to_string()))?;
        if let Some(again) = &mut sweep.points[point] {
            again.seconds = stored.seconds;
        }
        Ok(())
    }

    /// Check a trade: everything that follows from its measurements is computed again.
    pub(super) fn trade(&self, stored: &StoredTrade) -> Result<Checked, Failure> {
        Ok(Checked {
            simulated: "nothing: times cannot be reproduced, and estimates depend on them".into(),
            compared:
                "every bias, order and prediction against the stored measurements, attributes, \
                       coordinates and units"
                    .into(),
            not_compared: Some("the measurements against a simulation".into()),
            fields: json!({ "statistics_checked": false }),
            found: store::verify_whole(
                &self.file,
                &Dataset::of_trade(&stored.scenario, &stored.trade),
            )?,
            other_program: stored.other_program.clone(),
        })
    }

    /// Check a calibration: the question is read from the scenario again, and the fit is repeated
    /// with the record that is in the file.
    pub(super) fn calibration(&self, stored: &StoredCalibration) -> Result<Checked, Failure> {
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
        Ok(Checked {
            simulated: "the fit, with the record in the file".into(),
            compared: "title, question, estimates, intervals, slips, the model, attributes, coordinates and units"
                .into(),
            not_compared: None,
            fields: json!({ "statistics_checked": true }),
            found: store::verify_whole(&self.file, &Dataset::of_calibration(&again))?,
            other_program: stored.other_program.clone(),
        })
    }
}
